//! A world of either dimension behind a common interface, through which actions of the user become commands of the scene file.

mod arrows;
mod exploded;

use crate::document::{FOR_EVER, command_table};
use crate::exploded::Exploded;
use crate::report::Report;
use crate::samples::Sample;
use crate::setting::Setting;
use crate::shown::{BodyShown, EnergyShown, Extent, ObstacleShown, Show, Shown};
use opruga::blueprint::{Action, AnyBlueprint, CommandBlueprint, Selector};
use opruga::core::spec::{Value, Values};
use opruga::pictures::Scenery;
use opruga::world::PathFault;
use opruga::{AnyBody, AnyWorld, Warning, WorldError};
use toml_edit::Table;

/// A command that was given: its number in the world, and its table in the scene file.
pub struct Given {
    /// The number of the command in the world.
    pub number: usize,
    /// The table of the command in the scene file.
    pub table: Table,
}

/// Quantities that can be compared between scenes with different nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Common {
    /// The common centre of mass of all bodies \[m\].
    pub center: [f64; 3],
    /// The volume within closed surfaces \[m³\] or the area within closed outlines \[m²\]; none if there are none.
    pub volume: Option<f64>,
}

/// The state of an engine, to which it can return.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// The snapshot of the world.
    pub world: Vec<u8>,
    /// If two scenes are side by side: the state of the right side, and the reason why it has stopped.
    pub right: Option<(Box<State>, Option<Report>)>,
}

impl State {
    /// The memory of the state [bytes].
    pub fn bytes(&self) -> usize {
        self.world.len() + self.right.as_ref().map_or(0, |(right, _)| right.bytes())
    }
}

impl From<Vec<u8>> for State {
    fn from(world: Vec<u8>) -> State {
        State { world, right: None }
    }
}

/// A running world.
pub trait Engine: Send {
    /// Steps through one frame.
    fn frame(&mut self) -> Result<(), WorldError>;
    /// Begins and ends the commands that are due now.
    fn begin_what_is_due(&mut self) -> Result<(), WorldError>;
    /// The number of frames since the start.
    fn frames(&self) -> u64;
    /// The length of a frame [s].
    fn frame_seconds(&self) -> f64;
    /// The time [s].
    fn time(&self) -> f64;
    /// The dimension.
    fn dimension(&self) -> usize;
    /// The number of substeps per frame.
    fn substeps(&self) -> u32;
    /// The whole state.
    fn snapshot(&self) -> State;
    /// Returns to an earlier state of the same run.
    fn rewind(&mut self, state: &State) -> Result<(), WorldError>;
    /// The warnings so far.
    fn warnings(&self) -> Vec<Warning>;
    /// The number of frames after which a run on the command line ends.
    fn end(&self) -> u64;
    /// Returns the warnings about the present state, including those about shapes. The shapes are checked again at every call.
    fn warnings_at_the_end(&mut self) -> Vec<Warning>;
    /// Returns the first body that has grown to many times its size, if there is one.
    fn exploded(&mut self) -> Option<Exploded>;
    /// The hash of the state.
    fn hash(&self) -> u64;
    /// Pulls a node of a body towards a moving pointer.
    fn pull(&mut self, body: usize, node: u32, pointer: [f64; 3]) -> Result<Given, WorldError>;
    /// The stiffness [N/m] and the largest force [N] of such a pull.
    fn usual_pull(&self, body: usize) -> Option<[f64; 2]>;
    /// Adds a position of the pointer to the path of a pull, for a time two frames ahead. Returns the new row of the path.
    fn lead(&mut self, number: usize, pointer: [f64; 3]) -> Result<Vec<f64>, WorldError>;
    /// Ends a command now; returns the time of its end [s].
    fn finish(&mut self, number: usize) -> Result<f64, WorldError>;
    /// Pushes a node until the command is ended.
    fn push(&mut self, body: usize, node: u32, force: [f64; 3]) -> Result<Given, WorldError>;
    /// Pins a node.
    fn pin(&mut self, body: usize, node: u32) -> Result<Given, WorldError>;
    /// Unpins a node.
    fn free(&mut self, body: usize, node: u32) -> Result<Given, WorldError>;
    /// Sets a parameter.
    fn set(&mut self, path: &str, value: Value) -> Result<Given, WorldError>;
    /// Removes a body.
    fn remove(&mut self, name: &str) -> Result<Given, WorldError>;
    /// Gives a body other models or another integrator.
    fn change(
        &mut self,
        body: usize,
        models: Option<Vec<Values>>,
        integrator: Option<Values>,
    ) -> Result<Given, WorldError>;
    /// Executes the last command of a scene, which adds a body now, and takes over the warnings about that scene.
    fn add_from(&mut self, scene: AnyBlueprint, scene_warnings: Vec<Warning>) -> Result<(), WorldError>;
    /// The node of a body nearest to a point.
    fn nearest(&self, body: usize, point: [f64; 3]) -> Option<u32>;
    /// Finds the node nearest to a point in the scene beside this one, and returns the corresponding node of this scene; none if there is only one
    /// scene.
    fn nearest_beside(&self, _body: usize, _point: [f64; 3]) -> Option<u32> {
        None
    }
    /// The position of the corresponding node in the scene beside this one [m].
    fn position_beside(&self, _body: usize, _node: u32) -> Option<[f64; 3]> {
        None
    }
    /// Quantities that can be compared between scenes with different nodes.
    fn common(&self) -> Common;
    /// The position of a node [m].
    fn position(&self, body: usize, node: u32) -> Option<[f64; 3]>;
    /// The positions of all nodes of the existing bodies [m].
    fn positions(&self) -> Vec<[f64; 3]>;
    /// The names of the existing bodies.
    fn names(&self) -> Vec<String>;
    /// The name of a body.
    fn name(&self, body: usize) -> Option<String>;
    /// The centre of a body's mesh after rotation and scaling, and the displacement that the body then gets [m].
    fn rest_center(&self, body: usize) -> Option<([f64; 3], [f64; 3])>;
    /// Everything that can be displayed.
    fn shown(&mut self, show: &Show) -> Shown;
    /// The values of the curves for the present state.
    fn sample(&mut self) -> Sample;
    /// The columns and the row of a table for the present state.
    fn row(&mut self) -> Vec<(String, f64)>;
    /// The picture of the present state for a film.
    fn moment(&mut self, show: &Show) -> opruga::draw::Picture;
}

/// A world and the data that stay the same from picture to picture.
struct Living {
    world: Box<dyn AnyWorld>,
    scenery: Scenery,
    /// The number of bodies of the world when the scenery was made.
    known: usize,
    /// The warnings about the scene and its files.
    scene_warnings: Vec<Warning>,
    /// The longest side [m] of the box around all bodies at the start.
    size: f64,
}

/// Builds the world of a scene; `scene_warnings` are the warnings about it.
///
/// # Errors
/// The errors of the world.
pub fn build(
    blueprint: AnyBlueprint,
    scene_warnings: Vec<Warning>,
    setting: &Setting,
) -> Result<Box<dyn Engine>, WorldError> {
    let world = blueprint.build_with(setting.options.clone(), &setting.registries)?;
    let (scenery, known) = (Scenery::new(&*world), world.scene().body_count());
    let size = exploded::size_of(&*world);
    Ok(Box::new(Living { world, scenery, known, scene_warnings, size }))
}

/// Whether bodies carry drawings with colours.
fn has_drawings(world: &dyn AnyWorld) -> bool {
    let skins = world.bodies().into_iter().filter_map(|body| world.scene().body(body)?.skin());
    world.scene().dimension() == 2 && skins.flat_map(|skin| &skin.areas).any(|area| area.colour.is_some())
}

fn no_body(body: usize) -> WorldError {
    WorldError::path(format!("body.{body}"), PathFault::NoBody {})
}

impl Living {
    fn give(&mut self, until: f64, action: Action<3>, body: &str) -> Result<Given, WorldError> {
        let at = self.world.time();
        let command = CommandBlueprint { at, until: until.max(at), action };
        let refused = || WorldError::path("command", PathFault::NoForm {});
        let table = command_table(&command, self.dimension(), body).ok_or_else(refused)?;
        let number = self.world.act(&command)?;
        Ok(Given { number, table })
    }

    fn body_name(&self, body: usize) -> Result<String, WorldError> {
        Ok(self.present(body).ok_or_else(|| no_body(body))?.name().to_string())
    }

    /// A body, if it exists now.
    fn present(&self, body: usize) -> Option<&dyn AnyBody> {
        self.world.handle(body).and_then(|_| self.world.scene().body(body))
    }

    /// The time of a future frame [s], as counted by the world.
    fn time_of(&self, frames: u64) -> f64 {
        frames as f64 * self.frame_seconds()
    }

    fn row_of(&self, frames: u64, pointer: [f64; 3]) -> Vec<f64> {
        let mut row = vec![self.time_of(frames)];
        row.extend(&pointer[..self.dimension()]);
        row
    }
}

impl Engine for Living {
    fn frame(&mut self) -> Result<(), WorldError> {
        self.world.frame()?;
        self.world.warn_of_missing_contact();
        Ok(())
    }
    fn begin_what_is_due(&mut self) -> Result<(), WorldError> {
        self.world.begin_what_is_due()
    }
    fn frames(&self) -> u64 {
        self.world.frames()
    }
    fn frame_seconds(&self) -> f64 {
        self.world.scene().time().frame
    }
    fn time(&self) -> f64 {
        self.world.time()
    }
    fn dimension(&self) -> usize {
        self.world.scene().dimension()
    }
    fn substeps(&self) -> u32 {
        self.world.scene().time().substeps
    }
    fn snapshot(&self) -> State {
        self.world.snapshot().into()
    }
    fn rewind(&mut self, state: &State) -> Result<(), WorldError> {
        self.world.rewind(&state.world)
    }
    fn warnings(&self) -> Vec<Warning> {
        self.world.warnings().into_iter().chain(self.scene_warnings.iter().cloned()).collect()
    }
    fn end(&self) -> u64 {
        let time = self.world.scene().time();
        (time.seconds / time.frame).round() as u64
    }
    fn warnings_at_the_end(&mut self) -> Vec<Warning> {
        self.world.look_at_steps_again();
        self.world.warnings_at_the_end().into_iter().chain(self.scene_warnings.iter().cloned()).collect()
    }
    fn exploded(&mut self) -> Option<Exploded> {
        self.first_exploded()
    }
    fn hash(&self) -> u64 {
        self.world.state_hash()
    }

    fn pull(&mut self, body: usize, node: u32, pointer: [f64; 3]) -> Result<Given, WorldError> {
        let name = self.body_name(body)?;
        let now = self.world.frames();
        let path = vec![self.row_of(now, pointer), self.row_of(now + 1, pointer)];
        let action = Action::Drag { body, node: Some(node), facet: false, stiffness: None, path, largest_force: None };
        self.give(FOR_EVER, action, &name)
    }

    fn usual_pull(&self, body: usize) -> Option<[f64; 2]> {
        self.world.usual_pull(body)
    }

    fn lead(&mut self, number: usize, pointer: [f64; 3]) -> Result<Vec<f64>, WorldError> {
        // At the end of the next frame, an integrator may evaluate forces at a time beyond this frame, so the path extends one frame farther.
        let row = self.row_of(self.world.frames() + 2, pointer);
        self.world.lead(number, row.clone())?;
        Ok(row)
    }

    fn finish(&mut self, number: usize) -> Result<f64, WorldError> {
        let until = self.world.time();
        if self.world.finish(number, until).is_ok() {
            return Ok(until);
        }
        // The command has just begun, so it acts for one frame.
        let until = self.time_of(self.world.frames() + 1);
        self.world.finish(number, until).map(|()| until)
    }

    fn push(&mut self, body: usize, node: u32, force: [f64; 3]) -> Result<Given, WorldError> {
        let name = self.body_name(body)?;
        let action = Action::Push { body, select: Selector::Nodes(vec![node]), force };
        self.give(FOR_EVER, action, &name)
    }

    fn pin(&mut self, body: usize, node: u32) -> Result<Given, WorldError> {
        let name = self.body_name(body)?;
        self.give(FOR_EVER, Action::Pin { body, select: Selector::Nodes(vec![node]), axes: [true; 3] }, &name)
    }

    fn free(&mut self, body: usize, node: u32) -> Result<Given, WorldError> {
        let name = self.body_name(body)?;
        self.give(0.0, Action::Free { body, select: Selector::Nodes(vec![node]) }, &name)
    }

    fn set(&mut self, path: &str, value: Value) -> Result<Given, WorldError> {
        self.give(0.0, Action::Set { path: path.into(), value }, "")
    }

    fn remove(&mut self, name: &str) -> Result<Given, WorldError> {
        self.give(0.0, Action::Remove { name: name.into() }, name)
    }

    fn change(
        &mut self,
        body: usize,
        models: Option<Vec<Values>>,
        integrator: Option<Values>,
    ) -> Result<Given, WorldError> {
        let name = self.body_name(body)?;
        self.give(0.0, Action::Change { body, models, integrator }, &name)
    }

    fn add_from(&mut self, scene: AnyBlueprint, scene_warnings: Vec<Warning>) -> Result<(), WorldError> {
        self.world.act_of(&scene)?;
        self.scene_warnings = scene_warnings;
        Ok(())
    }

    fn nearest(&self, body: usize, point: [f64; 3]) -> Option<u32> {
        self.world.handle(body)?;
        let axes = 0..self.dimension();
        let far = |at: [f64; 3]| axes.clone().map(|d| (at[d] - point[d]) * (at[d] - point[d])).sum::<f64>();
        let distances = self.world.positions(body).iter().map(far).zip(0..);
        distances.min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, node)| node)
    }

    fn common(&self) -> Common {
        let (mut mass, mut moment, mut volume) = (0.0, [0.0; 3], None);
        for body in self.world.bodies() {
            let positions: Vec<[f64; 3]> = self.world.positions(body).iter().collect();
            for (node, position) in positions.iter().enumerate() {
                let m = self.world.node_mass(body, node as u32);
                mass += m;
                (0..3).for_each(|d| moment[d] += m * position[d]);
            }
            if let Some(enclosed) = self.world.scene().body(body).and_then(|body| body.enclosed_volume(&positions)) {
                *volume.get_or_insert(0.0) += enclosed;
            }
        }
        Common { center: moment.map(|m| m / mass), volume }
    }

    fn position(&self, body: usize, node: u32) -> Option<[f64; 3]> {
        self.world.handle(body)?;
        let positions = self.world.positions(body);
        ((node as usize) < positions.len()).then(|| positions.at(node as usize))
    }

    fn positions(&self) -> Vec<[f64; 3]> {
        self.world.bodies().into_iter().flat_map(|body| self.world.positions(body).iter()).collect()
    }

    fn names(&self) -> Vec<String> {
        self.world.bodies().into_iter().filter_map(|body| self.name(body)).collect()
    }

    fn name(&self, body: usize) -> Option<String> {
        self.body_name(body).ok()
    }

    fn rest_center(&self, body: usize) -> Option<([f64; 3], [f64; 3])> {
        let body = self.present(body)?;
        let (positions, mut middle) = (body.rest_positions(), [0.0; 3]);
        for point in &positions {
            for d in 0..3 {
                middle[d] += point[d] / positions.len() as f64;
            }
        }
        Some((middle, body.translation()))
    }

    fn shown(&mut self, show: &Show) -> Shown {
        let picture = self.picture(show);
        let numbers = self.world.bodies();
        let mut bodies = Vec::with_capacity(numbers.len());
        for &number in &numbers {
            // With many bodies, the values of single ones are not of interest.
            let readings = if numbers.len() <= 64 { self.world.readings(number) } else { Vec::new() };
            let Some(body) = self.world.scene().body(number) else { continue };
            bodies.push(BodyShown {
                number,
                name: body.name().to_string(),
                title: body.name().to_string(),
                nodes: body.nodes(),
                models: if numbers.len() <= 64 { body.models().to_vec() } else { Vec::new() },
                integrator: body.integrator().cloned(),
                shape: None,
                readings,
            });
        }
        let (scene, time) = (self.world.scene(), self.world.scene().time());
        let obstacles =
            scene.colliders().iter().map(|collider| ObstacleShown { values: collider.values.clone() }).collect();
        let estimates = self.world.stability();
        let limit = estimates.iter().filter_map(|(_, s)| s.largest_stable_step).fold(f64::INFINITY, f64::min);
        let (e, [momentum, _]) = (self.world.energy(), self.world.momentum());
        Shown {
            dimension: scene.dimension() as u8,
            title: scene.title().to_string(),
            time: self.world.time(),
            frames: self.world.frames(),
            frame: time.frame,
            seconds: time.seconds,
            substeps: time.substeps,
            stable_step: limit,
            gravity: core::array::from_fn(|d| scene.gravity().get(d).copied().unwrap_or(0.0)),
            drag: scene.drag(),
            integrator: Some(scene.integrator().clone()),
            pulls: self.world.pulls(),
            energy: EnergyShown {
                kinetic: e.kinetic,
                elastic: e.elastic,
                gas: e.gas,
                gravity: e.gravity,
                work: e.work_user,
                losses: e.loss_damping + e.loss_friction + e.loss_contact,
                numerical: e.loss_numerical,
                error: e.loss_integrator,
            },
            momentum,
            warnings: self.warnings(),
            bodies,
            obstacles,
            contact: scene.contact().map(|contact| contact.values.clone()),
            has_drawings: has_drawings(&*self.world),
            extents: picture.bodies.iter().map(Extent::of).collect(),
            picture,
            ..Shown::default()
        }
    }

    fn sample(&mut self) -> Sample {
        let numbers = self.world.bodies();
        let sampled = if numbers.len() <= 64 { &numbers[..] } else { &[] };
        let readings = sampled.iter().map(|body| (*body, self.world.readings(*body)));
        let readings = readings.filter(|(_, list)| !list.is_empty()).map(|(body, list)| (body, list.into())).collect();
        let (e, [momentum, _]) = (self.world.energy(), self.world.momentum());
        let losses = e.loss_damping + e.loss_friction + e.loss_contact;
        Sample {
            frame: self.world.frames(),
            time: self.world.time(),
            energy: [e.kinetic, e.elastic, e.gas, e.gravity, e.work_user, losses, e.loss_numerical, e.loss_integrator],
            momentum,
            readings,
            ..Sample::default()
        }
    }

    fn row(&mut self) -> Vec<(String, f64)> {
        let e = self.world.energy();
        let mut row: Vec<(String, f64)> = [
            ("time", self.world.time()),
            ("kinetic", e.kinetic),
            ("elastic", e.elastic),
            ("gas", e.gas),
            ("gravity", e.gravity),
            ("work_user", e.work_user),
            ("loss_damping", e.loss_damping),
            ("loss_friction", e.loss_friction),
            ("loss_contact", e.loss_contact),
            ("loss_numerical", e.loss_numerical),
            ("loss_integrator", e.loss_integrator),
        ]
        .map(|(name, x)| (name.to_string(), x))
        .to_vec();
        for body in self.world.bodies().into_iter().take(64) {
            let name = self.name(body).unwrap_or_default();
            row.extend(self.world.readings(body).into_iter().map(|(what, x)| (format!("{name}.{what}"), x)));
        }
        row
    }

    fn moment(&mut self, show: &Show) -> opruga::draw::Picture {
        self.picture(show)
    }
}
