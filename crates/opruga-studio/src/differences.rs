//! How the scene on the right differs from the scene on the left, and the scene on the right itself.

use crate::document::read;
use crate::document::{Document, kind_table, toml};
use crate::report::Report;
use opruga::Registries;
use opruga::blueprint::AnyBlueprint;
use opruga::core::spec::{Value, Values};
use opruga::io::Files;
use std::collections::{BTreeMap, BTreeSet};
use toml_edit::Value as Toml;

/// A difference of the right scene from the left one. The difference applies from the start of the run.
#[derive(Clone, Debug, PartialEq)]
pub enum Difference {
    /// A parameter by its path.
    Set(String, Value),
    /// The models of a body.
    Models(String, Vec<Values>),
    /// The integrator of the scene (none) or of a body.
    Integrator(Option<String>, Values),
    /// A field of the shape of a body, such as its number of vertices.
    Shape(String, &'static str, Value),
}

impl Difference {
    /// The subject of the difference. A later difference replaces an earlier one with the same subject.
    pub fn about(&self) -> String {
        match self {
            Difference::Set(path, _) => path.clone(),
            Difference::Models(body, _) => format!("body.{body}.models"),
            Difference::Integrator(None, _) => "integrator".into(),
            Difference::Integrator(Some(body), _) => format!("body.{body}.integrator"),
            Difference::Shape(body, field, _) => format!("body.{body}.shape.{field}"),
        }
    }
}

/// Adds a difference to a list. A difference of the models, or of the integrator, removes the earlier differences of their parameters.
pub fn add_difference(differences: &mut Vec<Difference>, new: Difference) {
    let about = new.about();
    let below = format!("{about}.");
    let whole = !matches!(new, Difference::Set(..));
    differences.retain(|old| old.about() != about && !(whole && old.about().starts_with(&below)));
    differences.push(new);
}

/// The correspondence between the nodes of the left and of the right body: each node corresponds to the node on the other side that is nearest to it
/// at rest. Bodies with the same nodes on both sides are not included.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Twins(BTreeMap<usize, [Vec<u32>; 2]>);

impl Twins {
    /// The node on the right that corresponds to a node on the left.
    pub fn on_right(&self, body: usize, node: u32) -> u32 {
        self.0.get(&body).and_then(|both| both[0].get(node as usize)).copied().unwrap_or(node)
    }

    /// The node on the left that corresponds to a node on the right.
    pub fn on_left(&self, body: usize, node: u32) -> u32 {
        self.0.get(&body).and_then(|both| both[1].get(node as usize)).copied().unwrap_or(node)
    }
}

/// Makes the right scene, which is the left one with the differences written into it. If a body has different nodes on the right, references to its
/// nodes are changed to the nearest nodes at rest.
///
/// # Errors
/// [`Report`] if a difference cannot be written into the scene, or all errors of a shape.
pub fn right_of(
    document: &Document,
    differences: &[Difference],
    files: &Files,
    registries: &Registries,
) -> Result<(Document, Twins), Report> {
    let mut right = document.clone();
    for difference in differences {
        if !write(&mut right, difference) {
            return Err(Report::NoDifference(difference.about()));
        }
    }
    let reshaped: BTreeSet<&str> = differences
        .iter()
        .filter_map(|difference| match difference {
            Difference::Shape(body, ..) => Some(body.as_str()),
            _ => None,
        })
        .collect();
    let mut twins = Twins::default();
    if reshaped.is_empty() {
        return Ok((right, twins));
    }
    let rest = |document: &Document| {
        read(&document.without_nodes(), files, registries).map(|(blueprint, _)| rest_positions(&blueprint))
    };
    let (here, there) = (rest(document)?, rest(&right)?);
    for (number, (name, left)) in here.iter().enumerate() {
        let Some((_, other)) = there.get(number).filter(|_| reshaped.contains(name.as_str())) else { continue };
        let both = [nearest(left, other), nearest(other, left)];
        right.rename_nodes(name, &|node| both[0].get(node as usize).copied().unwrap_or(node));
        twins.0.insert(number, both);
    }
    Ok((right, twins))
}

/// Writes a difference into a scene; `false` if that is not possible.
fn write(scene: &mut Document, difference: &Difference) -> bool {
    let (name, mut table) = match difference {
        Difference::Set(path, value) => return scene.set(path, value),
        Difference::Integrator(None, values) => {
            scene.set_integrator(values);
            return true;
        }
        Difference::Models(name, _) | Difference::Integrator(Some(name), _) | Difference::Shape(name, ..) => {
            let Some(table) = scene.body(name) else { return false };
            (name, table)
        }
    };
    match difference {
        Difference::Models(_, models) => {
            let list = models.iter().map(|m| Toml::InlineTable(kind_table(m, scene.dimension())));
            table.insert("models", Toml::Array(list.collect()));
        }
        Difference::Integrator(_, values) => {
            table.insert("integrator", Toml::InlineTable(kind_table(values, scene.dimension())));
        }
        Difference::Shape(_, field, value) => {
            let Some(shape) = table.get_mut("shape").and_then(Toml::as_inline_table_mut) else { return false };
            shape.insert(*field, toml(value));
        }
        Difference::Set(..) => {}
    }
    scene.replace_body(name, &table)
}

/// The names of the bodies of a scene and the positions of their nodes at rest [m].
fn rest_positions(blueprint: &AnyBlueprint) -> Vec<(String, Vec<[f64; 3]>)> {
    blueprint.scene().bodies().map(|body| (body.name().into(), body.rest_positions())).collect()
}

/// Returns, for every point of `of`, the index of the nearest point of `among`; if several are equally near, the index of the first of them.
fn nearest(of: &[[f64; 3]], among: &[[f64; 3]]) -> Vec<u32> {
    // Points are sorted by x, so the search ends when the difference in x alone exceeds the best distance.
    let mut order: Vec<u32> = (0..among.len() as u32).collect();
    order.sort_by(|a, b| among[*a as usize][0].total_cmp(&among[*b as usize][0]).then(a.cmp(b)));
    let find = |point: &[f64; 3]| {
        let begin = order.partition_point(|k| among[*k as usize][0] < point[0]);
        let mut best = (f64::INFINITY, 0);
        let mut look = |k: u32| {
            let other = &among[k as usize];
            let square: f64 = (0..3).map(|d| (other[d] - point[d]) * (other[d] - point[d])).sum();
            if square < best.0 || square == best.0 && k < best.1 {
                best = (square, k);
            }
            (other[0] - point[0]) * (other[0] - point[0]) <= best.0
        };
        order[begin..].iter().all(|k| look(*k));
        order[..begin].iter().rev().all(|k| look(*k));
        best.1
    };
    of.iter().map(find).collect()
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn the_nearest_of_many_points_is_that_which_trying_all_finds() {
        let mut state = 1_u64;
        let mut random = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        let mut points =
            |count: usize| -> Vec<[f64; 3]> { (0..count).map(|_| [random(), random(), 0.3 * random()]).collect() };
        let (of, mut among) = (points(60), points(80));
        among.push(among[3]);
        let all: Vec<u32> = of
            .iter()
            .map(|p| {
                let far = |k: &u32| -> f64 { (0..3).map(|d| (among[*k as usize][d] - p[d]).powi(2)).sum() };
                (0..81).min_by(|a, b| far(a).total_cmp(&far(b))).expect("one")
            })
            .collect();
        assert_eq!(nearest(&of, &among), all);
    }
}
