//! Edits of the scene: parameters, models and integrators; bodies that are added, removed and moved.
//!
//! At the start, an edit is written into the scene itself, and the world is rebuilt. Later, an edit becomes a command. Parameters, models and
//! integrators change while the body moves. A body that is moved, rotated, scaled or given another resolution, however, is replaced by a body at rest
//! in the new form.

use super::Session;
use super::travel::Past;
use crate::document::read;
use crate::document::{add_table, kind_table, numbers, toml};
use crate::report::{Report, Step};
use crate::shown::Severity;
use opruga::core::spec::{Value, Values};
use toml_edit::{InlineTable, Value as Toml};

/// A transformation of a body: displacement [m], rotation about its centre [rad], and scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// The displacement [m].
    pub moved: [f64; 3],
    /// The angle by which the body is rotated about its centre [rad]: counter-clockwise, in space about the y axis.
    pub turned: f64,
    /// The factor by which the lengths of the body are scaled.
    pub scaled: f64,
}

/// A change of the bodies of the scene.
#[derive(Clone, Debug)]
pub enum Edit {
    /// Adds a new body with this table, as in the scene file. Another body may already have its name.
    Add(InlineTable),
    /// Adds a new body with its centre at a point or, if it would intersect another body or an obstacle there, at the nearest free position \[m\].
    Drop(InlineTable, [f64; 3]),
    /// Adds a copy of a body next to it.
    Duplicate(String),
    /// Moves, rotates or scales a body.
    Transform(String, Placed),
    /// Gives a field of the shape of a body another value, such as its number of vertices.
    Shape(String, &'static str, Value),
    /// Removes a field of the shape of a body.
    ShapeWithout(String, &'static str),
    /// Removes a body.
    Delete(String),
    /// Switches contact between bodies on or off.
    Contact(bool),
}

impl Session {
    fn at_start(&self) -> bool {
        self.engine.frames() == 0
    }

    /// Continues with a document whose scene differs from the start on.
    fn begin_with(&mut self, document: crate::document::Document, own_commands: usize) -> Result<(), Report> {
        let had_pins = self.grabbed.is_some() || !self.pins_shown().is_empty();
        self.take(document, own_commands, [0; 2])?;
        self.start.clone_from(&self.document);
        if had_pins {
            self.report(Severity::Done, Report::PinsLetGo, None);
        }
        Ok(())
    }

    /// Sets a parameter. If the user is dragging the slider of the parameter, `press` is the number of the press.
    pub(super) fn set(&mut self, path: &str, value: Value, press: Option<u64>) -> Result<(), Report> {
        self.branch()?;
        let past = Past { press, ..self.past(Step::Set(path.into())) };
        if self.at_start() && self.document.commands() == self.own_commands {
            let mut document = self.document.clone();
            if document.set(path, &value) {
                self.begin_with(document, self.own_commands)?;
                self.remember(past);
                return Ok(());
            }
        }
        let given = self.engine.set(path, value.clone()).map_err(Report::World)?;
        match self.document.last_set(self.engine.time(), path) {
            Some(table) => table["value"] = toml_edit::Item::Value(toml(&value)),
            None => {
                self.write(given);
            }
        }
        self.remember(past);
        Ok(())
    }

    /// Removes a field of an obstacle. At the start, the field is removed from the scene. Later, the field gets the value that is equivalent to its
    /// absence, if there is such a value.
    pub(super) fn unset(&mut self, path: &str) -> Result<(), Report> {
        self.branch()?;
        let past = self.past(Step::Set(path.into()));
        if self.at_start() && self.document.commands() == self.own_commands {
            let mut document = self.document.clone();
            if document.unset(path) {
                self.begin_with(document, self.own_commands)?;
                self.remember(past);
                return Ok(());
            }
        }
        let mut parts = path.split('.').skip(1);
        let number = parts.next().and_then(|number| number.parse::<usize>().ok());
        let field = parts.next().unwrap_or_default();
        let shown = self.engine.shown(&self.show);
        let now = number.and_then(|number| shown.obstacles.get(number)?.values.get(field));
        match now {
            Some(Value::Number(_)) if matches!(field, "spin" | "rotation") => self.set(path, Value::Number(0.0), None),
            Some(Value::Numbers(list)) if matches!(field, "spin" | "rotation") => {
                self.set(path, Value::Numbers(vec![0.0; list.len()]), None)
            }
            _ => Err(Report::AtTheStartAlone(path.into())),
        }
    }

    pub(super) fn change(
        &mut self,
        body: usize,
        models: Option<Vec<Values>>,
        integrator: Option<Values>,
    ) -> Result<(), Report> {
        self.branch()?;
        let past = self.past(if models.is_some() { Step::Models } else { Step::Integrator });
        let name = self.engine.name(body).unwrap_or_default();
        let own =
            self.document.body(&name).filter(|_| self.at_start() && self.document.commands() == self.own_commands);
        let mut document = self.document.clone();
        if let Some(mut table) = own {
            if let Some(models) = &models {
                let table_of = |model| Toml::InlineTable(kind_table(model, document.dimension()));
                let list: toml_edit::Array = models.iter().map(table_of).collect();
                table.insert("models", Toml::Array(list));
            }
            if let Some(integrator) = &integrator {
                table.insert("integrator", Toml::InlineTable(kind_table(integrator, document.dimension())));
            }
            if document.replace_body(&name, &table) {
                self.begin_with(document, self.own_commands)?;
                self.remember(past);
                return Ok(());
            }
        }
        let given = self.engine.change(body, models, integrator).map_err(Report::World)?;
        self.write(given);
        self.remember(past);
        self.report(Severity::Done, Report::GoesOn(name), None);
        Ok(())
    }

    /// Resets the integrator of a body to that of the scene. At the start, the body then has no integrator of its own. Later, the body gets its own
    /// integrator, which is equal to the integrator of the scene.
    pub(super) fn as_the_scene(&mut self, body: usize) -> Result<(), Report> {
        self.branch()?;
        let past = self.past(Step::Integrator);
        let name = self.engine.name(body).unwrap_or_default();
        if self.at_start() && self.document.commands() == self.own_commands {
            let mut document = self.document.clone();
            if let Some(mut table) = document.body(&name)
                && table.remove("integrator").is_some()
                && document.replace_body(&name, &table)
            {
                self.begin_with(document, self.own_commands)?;
                self.remember(past);
                return Ok(());
            }
        }
        match self.engine.shown(&self.show).integrator {
            Some(values) => self.change(body, None, Some(values)),
            None => Ok(()),
        }
    }

    /// Changes the integrator of all bodies that do not have their own.
    pub(super) fn integrator(&mut self, values: &Values) -> Result<(), Report> {
        self.branch()?;
        let past = self.past(Step::Integrator);
        if self.at_start() && self.document.commands() == self.own_commands {
            let mut document = self.document.clone();
            document.set_integrator(values);
            self.begin_with(document, self.own_commands)?;
            self.remember(past);
            return Ok(());
        }
        // Every body gets its own integrator, because commands refer to bodies.
        let shown = self.engine.shown(&self.show);
        let (before, documents) = (self.engine.snapshot(), self.document.clone());
        for body in &shown.bodies {
            match self.engine.change(body.number, None, Some(values.clone())) {
                Ok(given) => {
                    self.write(given);
                }
                Err(error) => {
                    // Either all bodies are changed or none.
                    self.document = documents;
                    self.engine = self.build(&self.document)?;
                    self.engine.rewind(&before).map_err(Report::World)?;
                    return Err(Report::World(error));
                }
            }
        }
        self.remember(past);
        self.report(Severity::Done, Report::AllGoOn(values.kind().into()), None);
        Ok(())
    }

    pub(super) fn edit(&mut self, edit: &Edit) -> Result<(), Report> {
        self.branch()?;
        match edit {
            Edit::Drop(table, at) => {
                let mut table = table.clone();
                self.land(&mut table, *at);
                self.edit(&Edit::Add(table))
            }
            Edit::Add(table) => {
                let mut table = table.clone();
                let like = table.get("name").and_then(Toml::as_str).unwrap_or("body").to_string();
                let name = self.document.free_name(&like);
                table.insert("name", name.as_str().into());
                self.exchange(Step::Add, None, Some(table))?;
                self.made(name);
                Ok(())
            }
            Edit::Duplicate(name) => {
                let mut table = self.table_of(name)?;
                let copy = self.document.free_name(name);
                table.insert("name", copy.as_str().into());
                let (size, displacement) = (self.size_of(name), self.displacement_of(name));
                let by =
                    self.free_displacement(&table, [displacement[0] + 1.15 * size, displacement[1], displacement[2]]);
                shift(&mut table, by, self.dimension());
                self.exchange(Step::Duplicate, None, Some(table))?;
                self.made(copy);
                Ok(())
            }
            Edit::Transform(name, placed) => {
                let mut table = self.table_of(name)?;
                self.transform(name, &mut table, placed)?;
                // Handles rotate and scale a body about its opposite side or its centre. The centre may therefore move with every edit, and its
                // displacement does not show which edit the user meant.
                let step = match placed {
                    Placed { scaled, .. } if *scaled != 1.0 => Step::Scale,
                    Placed { turned, .. } if *turned != 0.0 => Step::Turn,
                    _ => Step::Move,
                };
                self.exchange(step, Some(name), Some(table))
            }
            Edit::Shape(name, field, value) => {
                let mut table = self.table_of(name)?;
                let shape = table.get_mut("shape").and_then(Toml::as_inline_table_mut);
                let shape = shape.ok_or_else(|| Report::NoShape(name.clone()))?;
                shape.insert(*field, toml(value));
                shift(&mut table, self.displacement_of(name), self.dimension());
                self.exchange(Step::Shape(field), Some(name), Some(table))
            }
            Edit::ShapeWithout(name, field) => {
                let mut table = self.table_of(name)?;
                let shape = table.get_mut("shape").and_then(Toml::as_inline_table_mut);
                shape.ok_or_else(|| Report::NoShape(name.clone()))?.remove(field);
                shift(&mut table, self.displacement_of(name), self.dimension());
                self.exchange(Step::Shape(field), Some(name), Some(table))
            }
            Edit::Delete(name) => self.exchange(Step::Delete, Some(name), None),
            Edit::Contact(touch) => {
                if !(self.at_start() && self.document.commands() == self.own_commands) {
                    return Err(Report::ContactAtTheStartAlone);
                }
                let past = self.past(Step::Contact);
                let mut document = self.document.clone();
                document.set_contact(*touch);
                self.begin_with(document, self.own_commands)?;
                self.remember(past);
                Ok(())
            }
        }
    }

    /// Registers a new body, which becomes selected.
    fn made(&mut self, name: String) {
        self.newest = Some((self.newest.as_ref().map_or(1, |(count, _)| count + 1), name));
    }

    pub(super) fn dimension(&mut self) -> usize {
        usize::from(self.engine.shown(&self.show).dimension)
    }

    fn table_of(&self, name: &str) -> Result<InlineTable, Report> {
        self.document.body(name).ok_or_else(|| Report::Copy(name.to_string()))
    }

    /// The displacement [m] of the present centre of a body from its initial position.
    fn displacement_of(&mut self, name: &str) -> [f64; 3] {
        if self.at_start() {
            return [0.0; 3];
        }
        let shown = self.engine.shown(&self.show);
        let number = shown.bodies.iter().find(|body| body.name == name).map(|body| (body.number, body.nodes));
        let Some((number, nodes)) = number else { return [0.0; 3] };
        let Some((middle, at)) = self.engine.rest_center(number) else { return [0.0; 3] };
        let mut mean = [0.0; 3];
        for position in (0..nodes as u32).filter_map(|node| self.engine.position(number, node)) {
            for d in 0..3 {
                mean[d] += position[d] / nodes as f64;
            }
        }
        [0, 1, 2].map(|d| mean[d] - at[d] - middle[d])
    }

    /// The width of a body [m].
    fn size_of(&mut self, name: &str) -> f64 {
        let shown = self.engine.shown(&self.show);
        let index = shown.bodies.iter().position(|body| body.name == name);
        let positions = index.map_or(&[][..], |index| &shown.picture.bodies[index].positions);
        let (low, high) = positions.iter().fold((f64::MAX, f64::MIN), |(a, b), p| (a.min(p[0]), b.max(p[0])));
        if high > low { high - low } else { 1.0 }
    }

    /// Writes a displacement, a rotation about the body's centre and a factor into its table.
    fn transform(&mut self, name: &str, table: &mut InlineTable, placed: &Placed) -> Result<(), Report> {
        let dimension = self.dimension();
        let shown = self.engine.shown(&self.show);
        let number = shown.bodies.iter().find(|body| body.name == name).map(|body| body.number);
        let center = number.and_then(|number| self.engine.rest_center(number));
        let (middle, at) = center.ok_or_else(|| Report::NoBody(name.to_string()))?;
        if !(placed.scaled > 0.0 && placed.scaled.is_finite()) {
            return Err(Report::Scaled(placed.scaled));
        }
        let (sin, cos) = placed.turned.sin_cos();
        // The rotation displaces the centre of the mesh. The position is changed so that the centre stays where it is.
        let turned = match dimension {
            2 => [cos * middle[0] - sin * middle[1], sin * middle[0] + cos * middle[1], 0.0],
            _ => [cos * middle[0] + sin * middle[2], middle[1], cos * middle[2] - sin * middle[0]],
        };
        let displacement = self.displacement_of(name);
        let position =
            [0, 1, 2].map(|d| at[d] + displacement[d] + middle[d] - placed.scaled * turned[d] + placed.moved[d]);
        table.insert("position", Toml::Array(numbers(&position[..dimension])));
        if placed.scaled != 1.0 {
            let scale = number_of(table.get("scale")).unwrap_or(1.0) * placed.scaled;
            table.insert("scale", scale.into());
        }
        if placed.turned != 0.0 {
            let old: Vec<f64> = match table.get("rotation") {
                Some(Toml::Array(list)) => list.iter().filter_map(|x| number_of(Some(x))).collect(),
                value => number_of(value).into_iter().collect(),
            };
            let value = if dimension == 2 {
                Toml::from(old.first().copied().unwrap_or(0.0) + placed.turned)
            } else {
                let old = <[f64; 3]>::try_from(old).unwrap_or([0.0; 3]);
                Toml::Array(numbers(&turn_about_y(placed.turned, old)))
            };
            table.insert("rotation", value);
        }
        Ok(())
    }

    /// Removes a body, adds a body, or does both.
    fn exchange(&mut self, step: Step, old: Option<&str>, new: Option<InlineTable>) -> Result<(), Report> {
        let past = self.past(step);
        let mut document = self.document.clone();
        if self.at_start() && document.commands() == self.own_commands {
            let written = match (old, &new) {
                (Some(name), Some(table)) => document.replace_body(name, table),
                (Some(name), None) => document.remove_body(name),
                (None, Some(table)) => {
                    document.push_body(table);
                    true
                }
                (None, None) => false,
            };
            if written {
                let own = document.commands();
                self.begin_with(document, own)?;
                self.remember(past);
                return Ok(());
            }
        }
        self.release();
        let now = self.engine.time();
        if let Some(name) = old {
            self.forget_later(name)?;
            let given = self.engine.remove(name).map_err(Report::World)?;
            self.write(given);
        }
        if let Some(mut table) = new {
            if old.is_some() {
                let name = table.get("name").and_then(Toml::as_str).unwrap_or("body").to_string();
                let new = self.document.free_name(&name);
                self.renamed.push((name, new.clone()));
                table.insert("name", new.into());
            }
            self.document.push_command(add_table(now, &table));
            let added = match read(&self.document, &self.files, &self.setting.registries) {
                Ok((scene, scene_warnings)) => self.engine.add_from(scene, scene_warnings).map_err(Report::World),
                Err(errors) => Err(Report::Scene(errors)),
            };
            if let Err(refusal) = added {
                // The message names the body that the user wanted to change, and not the new body, which was never made.
                let refusal = self.titled(refusal);
                self.back_to(past)?;
                if old.is_some() {
                    self.renamed.pop();
                }
                return Err(refusal);
            }
            if old.is_some() {
                self.report(Severity::Done, Report::SetDown, None);
            }
        }
        self.remember(past);
        Ok(())
    }

    /// Undoes the first half of an exchange whose second half was refused.
    pub(super) fn back_to(&mut self, past: Past) -> Result<(), Report> {
        let frame = past.frame;
        self.take(past.document, past.own_commands, [frame; 2])?;
        self.pins = past.pins;
        while self.goal.is_some_and(|goal| self.engine.frames() < goal) {
            self.frame().map_err(Report::World)?;
        }
        self.arrive();
        Ok(())
    }
}

fn number_of(value: Option<&Toml>) -> Option<f64> {
    value.and_then(|v| v.as_float().or_else(|| v.as_integer().map(|i| i as f64)))
}

/// Moves the position of a body in its table.
pub(super) fn shift(table: &mut InlineTable, by: [f64; 3], dimension: usize) {
    let old: Vec<f64> = table
        .get("position")
        .and_then(Toml::as_array)
        .map(|list| list.iter().filter_map(|x| number_of(Some(x))).collect())
        .unwrap_or_default();
    let position: Vec<f64> = (0..dimension).map(|d| old.get(d).copied().unwrap_or(0.0) + by[d]).collect();
    table.insert("position", Toml::Array(numbers(&position)));
}

/// Returns the rotation vector of the rotation `first` followed by a rotation about the y axis. The result is computed as the product of the
/// quaternions of both rotations.
fn turn_about_y(angle: f64, first: [f64; 3]) -> [f64; 3] {
    let size = |v: [f64; 3]| v.iter().map(|c| c * c).sum::<f64>().sqrt();
    let half = 0.5 * size(first);
    let unit = if half > 0.0 { half.sin() / (2.0 * half) } else { 0.5 };
    let (w, [x, y, z]) = (half.cos(), first.map(|c| c * unit));
    let (s, c) = (0.5 * angle).sin_cos();
    // (c, 0, s, 0) · (w, x, y, z)
    let (w, v) = (c * w - s * y, [c * x + s * z, c * y + s * w, c * z - s * x]);
    let sine = size(v);
    let angle = 2.0 * sine.atan2(w);
    if sine > 0.0 { v.map(|component| component / sine * angle) } else { [0.0; 3] }
}

#[cfg(test)]
mod tests {
    use super::turn_about_y;

    #[test]
    fn turns_about_one_axis_add_up() {
        let [x, y, z] = turn_about_y(0.4, [0.0, 0.7, 0.0]);
        assert!((y - 1.1).abs() < 1e-12 && x.abs() + z.abs() < 1e-12, "{x} {y} {z}");
        let quarter = core::f64::consts::FRAC_PI_2;
        // A rotation about x followed by one about y is a rotation by 120° about (1, 1, −1)/√3.
        let turn = turn_about_y(quarter, [quarter, 0.0, 0.0]);
        let third = 2.0 * core::f64::consts::FRAC_PI_3 / 3.0_f64.sqrt();
        assert!(turn.iter().zip([third, third, -third]).all(|(a, b)| (a - b).abs() < 1e-12), "{turn:?}");
    }
}
