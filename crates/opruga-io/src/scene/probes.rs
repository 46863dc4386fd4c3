//! `[[probe]]`: columns of `diagnostics.csv`.

use super::bodies;
use super::body_list::Bodies;
use super::errors::{ReferenceError, Wanted};
use super::names::{Names, What};
use super::reader::{Reader, join, listed};
use super::{location_of, selectors};
use crate::document::{Data, Node};
use crate::problem::{SceneError, visible};
use opruga_core::spec::{Role, Spec, nearest, quoted};
use opruga_world::blueprint::{BodyBlueprint, ProbeBlueprint, Recorded};
use opruga_world::schema;

/// Columns of `diagnostics.csv`.
pub(crate) fn probes<const D: usize>(
    reader: &mut Reader<'_>,
    root: &Node,
    bodies: &Bodies<D>,
) -> Vec<ProbeBlueprint<D>> {
    let mut probes = Vec::new();
    let mut names = Names::of(What::Probes);
    for (node, path) in reader.list(root, "", "probe") {
        let values = reader.fields(node, &path, &schema::PROBE, None);
        let name = values.text("name").unwrap_or("").to_string();
        if let Some(at) = node.get("name").filter(|_| values.text("name").is_some()) {
            bodies::check_name(reader, at, &join(&path, "name"), &name);
            if let Some(error) = names.take(&name, (), |_| None) {
                reader.report(at.location, error.path(join(&path, "name")));
            }
        }
        let record = recorded(reader, node, &path);
        let body = bodies.reference(reader, node, &path);
        let Some(select) = selectors::of_body(reader, node, &path, bodies, body) else { continue };
        if let Some(body) = body {
            refuse_without_cells(reader, root, node, &path, &bodies.list[body], &record);
            probes.push(ProbeBlueprint { name, body, select, record });
        }
    }
    probes
}

/// The words of `record`: at least one, and none twice.
fn recorded(reader: &mut Reader<'_>, node: &Node, path: &str) -> Vec<Recorded> {
    let words = || Recorded::ALL.iter().map(|(w, _)| *w);
    let here = join(path, "record");
    let Some(value) = node.get("record") else { return Vec::new() };
    let Data::Array(items) = &value.data else {
        reader.wrong_type(value, &here, Wanted::Recorded);
        return Vec::new();
    };
    if items.is_empty() {
        let error = SceneError::of(ReferenceError::RecordsNothing {}).path(here.clone()).allowed(listed(words()));
        reader.report(value.location, error);
    }
    let mut out: Vec<Recorded> = Vec::new();
    for (k, item) in items.iter().enumerate() {
        let item_path = join(&here, &k.to_string());
        match item.text().and_then(|text| Recorded::ALL.iter().find(|(w, _)| *w == text)) {
            Some((word, recorded)) if out.contains(recorded) => {
                reader.report(item.location, SceneError::of(ReferenceError::RecordedTwice { word }).path(item_path));
            }
            Some((_, recorded)) => out.push(*recorded),
            None => {
                let closest = nearest(item.text().unwrap_or(""), words());
                let error = SceneError::of(ReferenceError::Records { value: item.shown() }).path(item_path);
                reader.report(item.location, error.allowed(listed(words())).nearest(closest));
            }
        }
    }
    out
}

/// Refuses to record the stress of a body if none of its models computes one, now or after a command.
fn refuse_without_cells<const D: usize>(
    reader: &mut Reader<'_>,
    root: &Node,
    node: &Node,
    path: &str,
    body: &BodyBlueprint<D>,
    record: &[Recorded],
) {
    let Some((word, _)) = Recorded::ALL.iter().find(|(_, what)| what.is_of_cells() && record.contains(what)) else {
        return;
    };
    let knows = |spec: &Spec| spec.has_role(Role::OwnsCells) || spec.has_role(Role::InsideOfBoundary);
    let models = &reader.catalogue.models;
    let commands = match root.get("command").map(|commands| &commands.data) {
        Some(Data::Array(commands)) => &commands[..],
        _ => &[],
    };
    let later = commands.iter().any(|command| match command.get("models").map(|models| &models.data) {
        Some(Data::Array(list)) => {
            let kinds = list.iter().filter_map(|model| model.get("kind")?.text());
            kinds.filter_map(|kind| models.iter().find(|spec| spec.kind == kind)).any(|spec| knows(spec))
        }
        _ => false,
    });
    if later || body.models.iter().any(|model| knows(model.spec())) {
        return;
    }
    let kinds: Vec<&str> = models.iter().filter(|spec| knows(spec)).map(|spec| spec.kind).collect();
    let about = ReferenceError::NoStress { word, body: visible(body.common_name()), kinds: quoted(&kinds) };
    reader.report(location_of(node, "record"), SceneError::of(about).path(join(path, "record")));
}
