//! What the interface sees of a session: one picture and the numbers beside it, made by the thread of the simulation.

use crate::differences::Difference;
use crate::report::{Report, Step};
use crate::samples::Samples;
use opruga::Warning;
use opruga::core::potential::Reading;
use opruga::core::spec::Values;
use opruga::draw::{BodyPicture, ColourMap, Picture};
use opruga::pictures::Quantity;
use std::sync::{Arc, RwLock};

/// What a person wants to see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Show {
    /// What the colours tell.
    pub quantity: Quantity,
    /// Arrows of pressure or force, and of pulls.
    pub arrows: bool,
    /// The springs of bodies that have a surface too.
    pub springs: bool,
    /// The vertices.
    pub vertices: bool,
    /// Arrows of velocity.
    pub velocities: bool,
    /// Unit normals of the surface.
    pub normals: bool,
    /// Forces of obstacles.
    pub contacts: bool,
    /// The hash of the state.
    pub hash: bool,
    /// The colours of numbers.
    pub map: ColourMap,
    /// Whether bodies that carry a drawing are seen in its colours.
    pub own_colours: bool,
}

impl Default for Show {
    fn default() -> Show {
        Show {
            quantity: Quantity::Strain,
            arrows: false,
            springs: true,
            vertices: false,
            velocities: false,
            normals: false,
            contacts: false,
            hash: false,
            map: ColourMap::default(),
            own_colours: true,
        }
    }
}

/// The energy ledger [J].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyShown {
    /// ½ Σ m v².
    pub kinetic: f64,
    /// Stored by the models.
    pub elastic: f64,
    /// Of the gas.
    pub gas: f64,
    /// Of the weight.
    pub gravity: f64,
    /// Work of pulls, pushes and loads.
    pub work: f64,
    /// Damping, friction and impacts together.
    pub losses: f64,
    /// What implicit rules take by themselves.
    pub numerical: f64,
    /// The error of the integrator.
    pub error: f64,
}

/// One body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyShown {
    /// Its number in the world.
    pub number: usize,
    /// Its name.
    pub name: String,
    /// The name under which a person knows it: a body that was set down anew keeps that of the body it was.
    pub title: String,
    /// How many nodes it has.
    pub nodes: usize,
    /// Its models; empty in a crowd.
    pub models: Vec<Values>,
    /// Its own integrator.
    pub integrator: Option<Values>,
    /// Its shape as the scene tells it, where it has a table of its own.
    pub shape: Option<Values>,
    /// What its models say: volume, pressure.
    pub readings: Vec<Reading>,
}

impl EnergyShown {
    /// What is stored and in motion [J].
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.gas + self.gravity
    }
}

/// The same scene under another configuration, in lock step.
#[derive(Clone, Debug)]
pub struct Beside {
    /// What there is to see of it.
    pub right: Arc<Shown>,
    /// The root of the mean square of the distances between the nodes of both, and the largest one [m]; none where the
    /// bodies differ or the right one has stopped.
    pub distances: Option<[f64; 2]>,
    /// The distance between the centres of mass of both \[m\].
    pub center: Option<f64>,
    /// By how much its outlines or surfaces enclose more than those of the left one \[m³, m² in the plane\].
    pub volume: Option<f64>,
    /// What it has more of energy than the left one [J].
    pub energy: Option<f64>,
    /// In what it differs.
    pub differences: Vec<Difference>,
    /// Why it does not go on.
    pub stopped: Option<Report>,
}

/// One obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleShown {
    /// Its kind and parameters.
    pub values: Values,
}

/// How the simulation keeps up with the clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    /// The simulated time that passes over that which is asked for; 1 keeps up.
    pub ratio: f64,
    /// What a frame of the scene takes [s].
    pub frame_cost: f64,
}

/// How grave a message is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// What was done.
    Done,
    /// What could not be done; all is as it was before.
    Refused,
}

/// What a button beside a message does.
#[derive(Clone, Debug, PartialEq)]
pub enum Offer {
    /// Go back a second and take half the step.
    HalveStep,
    /// Go back a second and take an integrator that has a stable step, for the body of this number or for the scene.
    Steady(Option<usize>, &'static str),
    /// Take so many substeps and try again what was refused.
    Substeps(u32),
    /// Give a field of the shape of a body this value instead of the one that was refused, with as many substeps as that needs.
    Coarser(String, &'static str, i64),
    /// Go on behind the end of a recording.
    GoOn,
    /// Wait for frames up to so long \[s\], and do again what was broken off.
    Wait(f64),
}

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// Counts messages, so that a new one is told from an old one of the same words.
    pub number: u64,
    /// How grave it is.
    pub severity: Severity,
    /// What it says.
    pub report: Report,
    /// The same in English.
    pub text: String,
    /// What would help.
    pub offer: Option<Offer>,
    /// What a frame would take with the substeps that what was refused needs [s], where that is long.
    pub frame_seconds: Option<f64>,
}

/// How far a body reaches. Who makes a picture finds it once: the window asks several times for every one that it draws, and a crowd has
/// tens of thousands of nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The lowest and the highest corner of the box around its nodes [m]; crossed where it has none.
    pub corners: [[f64; 3]; 2],
    /// The least and the largest of what its colours show; crossed where that is nowhere a finite number.
    pub colours: [f64; 2],
}

impl Extent {
    /// That of a body.
    pub fn of(body: &BodyPicture) -> Extent {
        let mut corners = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for p in &body.positions {
            for d in 0..3 {
                (corners[0][d], corners[1][d]) = (corners[0][d].min(p[d]), corners[1][d].max(p[d]));
            }
        }
        let mut colours = [f64::INFINITY, f64::NEG_INFINITY];
        for scalar in body.scalar.iter().filter(|scalar| scalar.is_finite()) {
            colours = [colours[0].min(*scalar), colours[1].max(*scalar)];
        }
        Extent { corners, colours }
    }
}

/// Everything that the interface shows of one moment.
#[derive(Clone, Debug, Default)]
pub struct Shown {
    /// The name of the scene.
    pub name: String,
    /// Its title.
    pub title: String,
    /// 2 or 3; 0 before the first scene.
    pub dimension: u8,
    /// The time [s].
    pub time: f64,
    /// Frames since the start.
    pub frames: u64,
    /// The last frame that was computed in this course of things.
    pub latest: u64,
    /// The moment to which everything is computed again \[s\].
    pub goal: Option<f64>,
    /// The length of a frame [s].
    pub frame: f64,
    /// How long the scene lasts for the command line [s].
    pub seconds: f64,
    /// Substeps of a frame.
    pub substeps: u32,
    /// The largest stable substep [s]; infinite where nothing limits it.
    pub stable_step: f64,
    /// Gravity [m/s²].
    pub gravity: [f64; 3],
    /// Drag [1/s].
    pub drag: f64,
    /// The integrator of the scene.
    pub integrator: Option<Values>,
    /// The hash of the state, where somebody looks at it: that of `opruga run --json`.
    pub hash: Option<u64>,
    /// The bodies, in the order of those of the picture.
    pub bodies: Vec<BodyShown>,
    /// The obstacles.
    pub obstacles: Vec<ObstacleShown>,
    /// How bodies touch one another; none where they pass through one another.
    pub contact: Option<Values>,
    /// Pulls: node, pointer, force [m, m, N].
    pub pulls: Vec<[[f64; 3]; 3]>,
    /// Pushes of the pointer: node, end of the arrow, force [m, m, N].
    pub pushes: Vec<[[f64; 3]; 3]>,
    /// Points that a person has pinned: body, node, position [m].
    pub pins: Vec<(usize, u32, [f64; 3])>,
    /// The energy ledger.
    pub energy: EnergyShown,
    /// The momentum [kg m/s].
    pub momentum: [f64; 3],
    /// The curves of this course of things; those of the scene that is open, also behind this moment.
    pub samples: Arc<RwLock<Samples>>,
    /// What attracted attention.
    pub warnings: Vec<Warning>,
    /// The picture.
    pub picture: Picture,
    /// How far each of its bodies reaches.
    pub extents: Vec<Extent>,
    /// Whether time passes.
    pub playing: bool,
    /// Simulated seconds for every real one that are wanted.
    pub speed: f64,
    /// How the simulation keeps up.
    pub pace: Pace,
    /// What can be undone and redone.
    pub undo: Option<Step>,
    /// What can be redone.
    pub redo: Option<Step>,
    /// The last message.
    pub message: Option<Message>,
    /// How many scenes were opened or built anew: a view is fitted once for each.
    pub opened: u64,
    /// How often another state took the place of the one before at once, as by undo, reset or a way through time: what was
    /// fitted to the states before is fitted anew.
    pub replaced: u64,
    /// How often a person went back to the start and left what was done: a view begins anew with it.
    pub resets: u64,
    /// The same scene under another configuration.
    pub beside: Option<Beside>,
    /// Bodies that were set down anew under another name: old and new.
    pub renamed: Vec<(String, String)>,
    /// The last body that was added or copied, with a number that counts them.
    pub newest: Option<(u64, String)>,
    /// Whether bodies carry drawings with colours of their own.
    pub has_drawings: bool,
    /// The last frame that is as it was recorded, where a recording is viewed.
    pub recorded_until: Option<u64>,
    /// How many commands of a person the scene holds.
    pub recorded: usize,
    /// The last moment that can be gone back to without computing from the start [bytes kept].
    pub kept_bytes: usize,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_extent_of_a_body_is_that_of_its_nodes_and_colours_and_that_of_nothing_is_crossed() {
        let body = BodyPicture {
            positions: vec![[1.0, -2.0, 0.5], [-3.0, 4.0, 0.0]],
            scalar: vec![f64::NAN, 7.0],
            ..BodyPicture::default()
        };
        let Extent { corners, colours } = Extent::of(&body);
        assert_eq!((corners, colours), ([[-3.0, -2.0, 0.0], [1.0, 4.0, 0.5]], [7.0, 7.0]));
        let Extent { corners: [low, high], colours } = Extent::of(&BodyPicture::default());
        assert!(low > high && colours[0] > colours[1]);
    }
}
