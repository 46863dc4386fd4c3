//! A world of either dimension behind one face: what a person does to it, as commands of the scene file.

mod arrows;
mod exploded;

pub use exploded::Exploded;

use crate::document::{FOR_EVER, command_table};
use crate::samples::Sample;
use crate::shown::{BodyShown, EnergyShown, Extent, ObstacleShown, Show, Shown};
use opruga::blueprint::{Action, AnyBlueprint, Blueprint, CommandBlueprint, Selector};
use opruga::core::spec::{Value, Values};
use opruga::pictures::Scenery;
use opruga::{Options, Warning, World, WorldError};
use toml_edit::Table;

/// A command that was given: its number in the world, and how the scene file writes it.
pub struct Given {
    /// Its number in the world.
    pub number: usize,
    /// Its table.
    pub table: Table,
}

/// What scenes have in common whatever their nodes are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Common {
    /// The centre of mass of all bodies \[m\].
    pub center: [f64; 3],
    /// What closed outlines and surfaces enclose \[m³, m² in the plane\]; none where there are none.
    pub volume: Option<f64>,
}

/// A running world.
pub trait Engine: Send {
    /// Steps through one frame.
    fn frame(&mut self) -> Result<(), WorldError>;
    /// Begins and ends commands that are due now.
    fn begin_what_is_due(&mut self) -> Result<(), WorldError>;
    /// Frames since the start.
    fn frames(&self) -> u64;
    /// The length of a frame [s].
    fn frame_seconds(&self) -> f64;
    /// The time [s].
    fn time(&self) -> f64;
    /// The dimension.
    fn dimension(&self) -> usize;
    /// Substeps of a frame.
    fn substeps(&self) -> u32;
    /// The whole state.
    fn snapshot(&self) -> Vec<u8>;
    /// Back to a state of the same past.
    fn rewind(&mut self, bytes: &[u8]) -> Result<(), WorldError>;
    /// What attracted attention.
    fn warnings(&self) -> Vec<Warning>;
    /// Frames up to the end of the scene for the command line.
    fn end(&self) -> u64;
    /// What is odd in the present state, also about shapes, which are looked at anew by every call.
    fn warnings_at_the_end(&mut self) -> Vec<Warning>;
    /// The first body that has grown beyond every measure of the scene.
    fn exploded(&mut self) -> Option<Exploded>;
    /// The hash of the state.
    fn hash(&self) -> u64;
    /// Pulls a node of a body toward a pointer that is led.
    fn pull(&mut self, body: usize, node: u32, pointer: [f64; 3]) -> Result<Given, WorldError>;
    /// The stiffness [N/m] and the largest force [N] of such a pull.
    fn usual_pull(&self, body: usize) -> Option<[f64; 2]>;
    /// Leads the pointer of a pull two frames ahead; the row of its path.
    fn lead(&mut self, number: usize, pointer: [f64; 3]) -> Result<Vec<f64>, WorldError>;
    /// Ends a command now; the time of its end [s].
    fn finish(&mut self, number: usize) -> Result<f64, WorldError>;
    /// Pushes a node until it is told otherwise.
    fn push(&mut self, body: usize, node: u32, force: [f64; 3]) -> Result<Given, WorldError>;
    /// Pins a node.
    fn pin(&mut self, body: usize, node: u32) -> Result<Given, WorldError>;
    /// Lets go of a node that is held.
    fn free(&mut self, body: usize, node: u32) -> Result<Given, WorldError>;
    /// Sets a parameter.
    fn set(&mut self, path: &str, value: Value) -> Result<Given, WorldError>;
    /// Takes a body away.
    fn remove(&mut self, name: &str) -> Result<Given, WorldError>;
    /// Gives a body other models or another integrator.
    fn change(
        &mut self,
        body: usize,
        models: Option<Vec<Values>>,
        integrator: Option<Values>,
    ) -> Result<Given, WorldError>;
    /// Gives the last command of a scene that begins now and adds a body, and what is odd about that scene.
    fn add_from(&mut self, scene: AnyBlueprint, odd: Vec<Warning>) -> Result<(), WorldError>;
    /// The node of a body nearest to a point.
    fn nearest(&self, body: usize, point: [f64; 3]) -> Option<u32>;
    /// The node for which the one nearest to a point in the scene beside it stands; none where there is but one scene.
    fn nearest_beside(&self, _body: usize, _point: [f64; 3]) -> Option<u32> {
        None
    }
    /// The position of what stands for a node in the scene beside it [m].
    fn position_beside(&self, _body: usize, _node: u32) -> Option<[f64; 3]> {
        None
    }
    /// What scenes have in common whatever their nodes are.
    fn common(&self) -> Common;
    /// The position of a node [m].
    fn position(&self, body: usize, node: u32) -> Option<[f64; 3]>;
    /// The positions of all nodes of the bodies that are there [m].
    fn positions(&self) -> Vec<[f64; 3]>;
    /// The names of the bodies that are there.
    fn names(&self) -> Vec<String>;
    /// The name of a body.
    fn name(&self, body: usize) -> Option<String>;
    /// The middle of a body's mesh as its shape was turned and scaled, and where that is moved to [m].
    fn rest_center(&self, body: usize) -> Option<([f64; 3], [f64; 3])>;
    /// All there is to see.
    fn shown(&mut self, show: &Show) -> Shown;
    /// The numbers of the curves for the present state.
    fn sample(&mut self) -> Sample;
    /// The columns and the row of a table for the present state.
    fn row(&mut self) -> Vec<(String, f64)>;
    /// What a film needs.
    fn moment(&mut self, show: &Show) -> opruga::draw::Picture;
}

/// A world and what stays the same from picture to picture.
struct Living<const D: usize> {
    world: World<D>,
    scenery: Scenery,
    /// How many bodies the scenery knows.
    known: usize,
    /// What was odd about the scene and its files.
    odd: Vec<Warning>,
    /// The longest side of the box around all bodies at the start [m].
    size: f64,
}

/// Builds the world of a scene, about which something was odd.
///
/// # Errors
/// What the world refuses.
pub fn build(blueprint: AnyBlueprint, odd: Vec<Warning>, options: &Options) -> Result<Box<dyn Engine>, WorldError> {
    fn living<const D: usize>(
        blueprint: Blueprint<D>,
        odd: Vec<Warning>,
        options: &Options,
    ) -> Result<Box<dyn Engine>, WorldError> {
        let world = World::new(blueprint, options.clone())?;
        let (scenery, known) = (Scenery::new(&world), world.blueprint().bodies.len());
        let size = exploded::size_of(&world);
        Ok(Box::new(Living { world, scenery, known, odd, size }))
    }
    match blueprint {
        AnyBlueprint::Plane(blueprint) => living(blueprint, odd, options),
        AnyBlueprint::Space(blueprint) => living(blueprint, odd, options),
    }
}

/// Whether bodies carry drawings with colours of their own.
fn has_drawings<const D: usize>(world: &World<D>) -> bool {
    let skins = world.bodies().filter_map(|body| world.blueprint().bodies[body].mesh.skin.as_ref());
    D == 2 && skins.flat_map(|skin| &skin.areas).any(|area| area.colour.is_some())
}

fn cut<const D: usize>(point: [f64; 3]) -> [f64; D] {
    core::array::from_fn(|d| point[d])
}

fn three<const D: usize>(point: [f64; D]) -> [f64; 3] {
    let mut out = [0.0; 3];
    out[..D].copy_from_slice(&point);
    out
}

fn no_body(body: usize) -> WorldError {
    WorldError::Path { path: format!("body {body}"), message: "there is no such body".into() }
}

impl<const D: usize> Living<D> {
    fn give(&mut self, until: f64, action: Action<D>, body: &str) -> Result<Given, WorldError> {
        let at = self.world.time();
        let command = CommandBlueprint { at, until: until.max(at), action };
        let refused = || WorldError::Path { path: "command".into(), message: "it has no form in a scene".into() };
        let table = command_table(&command, body).ok_or_else(refused)?;
        let number = self.world.act(command)?;
        Ok(Given { number, table })
    }

    fn body_name(&self, body: usize) -> Result<String, WorldError> {
        self.world.handle(body).ok_or_else(|| no_body(body))?;
        Ok(self.world.blueprint().bodies[body].name.clone())
    }

    /// The time of a coming frame [s], as the world counts it.
    fn time_of(&self, frames: u64) -> f64 {
        frames as f64 * self.world.blueprint().time.frame
    }

    fn row_of(&self, frames: u64, pointer: [f64; 3]) -> Vec<f64> {
        let mut row = vec![self.time_of(frames)];
        row.extend(cut::<D>(pointer));
        row
    }
}

impl<const D: usize> Engine for Living<D> {
    fn frame(&mut self) -> Result<(), WorldError> {
        self.world.frame()
    }
    fn begin_what_is_due(&mut self) -> Result<(), WorldError> {
        self.world.begin_what_is_due()
    }
    fn frames(&self) -> u64 {
        self.world.frames()
    }
    fn frame_seconds(&self) -> f64 {
        self.world.blueprint().time.frame
    }
    fn time(&self) -> f64 {
        self.world.time()
    }
    fn dimension(&self) -> usize {
        D
    }
    fn substeps(&self) -> u32 {
        self.world.blueprint().time.substeps
    }
    fn snapshot(&self) -> Vec<u8> {
        self.world.snapshot()
    }
    fn rewind(&mut self, bytes: &[u8]) -> Result<(), WorldError> {
        self.world.rewind(bytes)
    }
    fn warnings(&self) -> Vec<Warning> {
        self.world.warnings().into_iter().chain(self.odd.iter().cloned()).collect()
    }
    fn end(&self) -> u64 {
        let time = &self.world.blueprint().time;
        (time.seconds / time.frame).round() as u64
    }
    fn warnings_at_the_end(&mut self) -> Vec<Warning> {
        self.world.look_at_steps_again();
        self.world.warnings_at_the_end().into_iter().chain(self.odd.iter().cloned()).collect()
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
        // Stages at the end of the coming frame look behind it: the path is known a frame farther.
        let row = self.row_of(self.world.frames() + 2, pointer);
        self.world.lead(number, row.clone())?;
        Ok(row)
    }

    fn finish(&mut self, number: usize) -> Result<f64, WorldError> {
        let until = self.world.time();
        if self.world.finish(number, until).is_ok() {
            return Ok(until);
        }
        // It has just begun: it acts for one frame.
        let until = self.time_of(self.world.frames() + 1);
        self.world.finish(number, until).map(|()| until)
    }

    fn push(&mut self, body: usize, node: u32, force: [f64; 3]) -> Result<Given, WorldError> {
        let name = self.body_name(body)?;
        let action = Action::Push { body, select: Selector::Nodes(vec![node]), force: cut(force) };
        self.give(FOR_EVER, action, &name)
    }

    fn pin(&mut self, body: usize, node: u32) -> Result<Given, WorldError> {
        let name = self.body_name(body)?;
        self.give(FOR_EVER, Action::Pin { body, select: Selector::Nodes(vec![node]), axes: [true; D] }, &name)
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

    fn add_from(&mut self, scene: AnyBlueprint, odd: Vec<Warning>) -> Result<(), WorldError> {
        let any: Box<dyn core::any::Any> = match scene {
            AnyBlueprint::Plane(blueprint) => Box::new(blueprint),
            AnyBlueprint::Space(blueprint) => Box::new(blueprint),
        };
        let refuse = |message: &str| WorldError::Path { path: "add".into(), message: message.into() };
        let blueprint = any.downcast::<Blueprint<D>>().map_err(|_| refuse("the scene has another dimension"))?;
        let now = self.world.time();
        let due = blueprint.commands.into_iter().rfind(|c| c.at <= now && matches!(c.action, Action::Add(_)));
        self.world.act(due.ok_or_else(|| refuse("the scene adds nothing now"))?)?;
        self.odd = odd;
        Ok(())
    }

    fn nearest(&self, body: usize, point: [f64; 3]) -> Option<u32> {
        self.world.handle(body)?;
        let point = cut::<D>(point);
        let far = |node: &u32| -> f64 {
            self.world.position(body, *node).iter().zip(&point).map(|(a, b)| (a - b) * (a - b)).sum()
        };
        (0..self.world.node_count(body) as u32).min_by(|a, b| far(a).total_cmp(&far(b)))
    }

    fn common(&self) -> Common {
        let (mut mass, mut moment, mut volume) = (0.0, [0.0; D], None);
        for body in self.world.bodies() {
            let mesh = &self.world.blueprint().bodies[body].mesh;
            let positions: Vec<[f64; D]> =
                (0..mesh.nodes() as u32).map(|node| self.world.position(body, node)).collect();
            for (node, position) in positions.iter().enumerate() {
                let m = self.world.node_mass(body, node as u32);
                mass += m;
                (0..D).for_each(|d| moment[d] += m * position[d]);
            }
            if !mesh.facets.is_empty() {
                *volume.get_or_insert(0.0) += opruga::mesh::signed_volume(&mesh.facets, &positions);
            }
        }
        Common { center: three(moment.map(|m| m / mass)), volume }
    }

    fn position(&self, body: usize, node: u32) -> Option<[f64; 3]> {
        self.world.handle(body)?;
        ((node as usize) < self.world.node_count(body)).then(|| three(self.world.position(body, node)))
    }

    fn positions(&self) -> Vec<[f64; 3]> {
        let nodes = |body| (0..self.world.node_count(body) as u32).map(move |node| (body, node));
        self.world.bodies().flat_map(nodes).map(|(body, node)| three(self.world.position(body, node))).collect()
    }

    fn names(&self) -> Vec<String> {
        self.world.bodies().map(|body| self.world.blueprint().bodies[body].name.clone()).collect()
    }

    fn name(&self, body: usize) -> Option<String> {
        self.body_name(body).ok()
    }

    fn rest_center(&self, body: usize) -> Option<([f64; 3], [f64; 3])> {
        self.world.handle(body)?;
        let body = &self.world.blueprint().bodies[body];
        let mut middle = [0.0; D];
        for point in &body.mesh.positions {
            for d in 0..D {
                middle[d] += point[d] / body.mesh.positions.len() as f64;
            }
        }
        Some((three(middle), three(body.translation)))
    }

    fn shown(&mut self, show: &Show) -> Shown {
        let picture = self.picture(show);
        let numbers: Vec<usize> = self.world.bodies().collect();
        let mut bodies = Vec::with_capacity(numbers.len());
        for &number in &numbers {
            // What a crowd says of itself is read by nobody.
            let readings = if numbers.len() <= 64 { self.world.readings(number) } else { Vec::new() };
            let blueprint = &self.world.blueprint().bodies[number];
            bodies.push(BodyShown {
                number,
                name: blueprint.name.clone(),
                title: blueprint.name.clone(),
                nodes: blueprint.mesh.nodes(),
                models: if numbers.len() <= 64 { blueprint.models.clone() } else { Vec::new() },
                integrator: blueprint.integrator.clone(),
                shape: None,
                readings,
            });
        }
        let blueprint = self.world.blueprint();
        let obstacles =
            blueprint.colliders.iter().map(|collider| ObstacleShown { values: collider.values.clone() }).collect();
        let estimates = self.world.stability();
        let limit = estimates.iter().filter_map(|(_, s)| s.largest_stable_step).fold(f64::INFINITY, f64::min);
        let (e, m) = (self.world.energy(), self.world.momentum());
        Shown {
            dimension: D as u8,
            title: blueprint.title.clone(),
            time: self.world.time(),
            frames: self.world.frames(),
            frame: blueprint.time.frame,
            seconds: blueprint.time.seconds,
            substeps: blueprint.time.substeps,
            stable_step: limit,
            gravity: three(blueprint.surroundings.gravity),
            drag: blueprint.surroundings.drag,
            integrator: Some(blueprint.integrator.clone()),
            pulls: self.world.pulls().into_iter().map(|(a, b, f)| [three(a), three(b), three(f)]).collect(),
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
            momentum: three(m.linear.0),
            warnings: self.warnings(),
            bodies,
            obstacles,
            has_drawings: has_drawings(&self.world),
            extents: picture.bodies.iter().map(Extent::of).collect(),
            picture,
            ..Shown::default()
        }
    }

    fn sample(&mut self) -> Sample {
        let numbers: Vec<usize> = self.world.bodies().collect();
        let told = if numbers.len() <= 64 { &numbers[..] } else { &[] };
        let readings = told.iter().map(|body| (*body, self.world.readings(*body)));
        let readings = readings.filter(|(_, list)| !list.is_empty()).map(|(body, list)| (body, list.into())).collect();
        let (e, m) = (self.world.energy(), self.world.momentum());
        let losses = e.loss_damping + e.loss_friction + e.loss_contact;
        Sample {
            frame: self.world.frames(),
            time: self.world.time(),
            energy: [e.kinetic, e.elastic, e.gas, e.gravity, e.work_user, losses, e.loss_numerical, e.loss_integrator],
            momentum: three(m.linear.0),
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
        let bodies: Vec<usize> = self.world.bodies().take(64).collect();
        for body in bodies {
            let name = self.world.blueprint().bodies[body].name.clone();
            row.extend(self.world.readings(body).into_iter().map(|(what, x)| (format!("{name}.{what}"), x)));
        }
        row
    }

    fn moment(&mut self, show: &Show) -> opruga::draw::Picture {
        self.picture(show)
    }
}
