//! The data of a session that the interface shows: one picture and the numbers beside it. The thread of the simulation makes these data.

use crate::differences::Difference;
use crate::report::{Report, Step};
use crate::samples::Samples;
use opruga::Warning;
use opruga::core::potential::Reading;
use opruga::core::spec::Values;
use opruga::draw::{BodyPicture, ColourMap, Picture};
use opruga::pictures::Quantity;
use std::sync::{Arc, RwLock};

/// The quantities and marks that the user wants to see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Show {
    /// The quantity that the colours show.
    pub quantity: Quantity,
    /// Arrows of pressure or force, and of pulls.
    pub arrows: bool,
    /// The springs of bodies that also have a surface.
    pub springs: bool,
    /// The vertices.
    pub vertices: bool,
    /// Arrows of velocity.
    pub velocities: bool,
    /// Arrows of the unit normals of the surface.
    pub normals: bool,
    /// Arrows of the forces of obstacles.
    pub contacts: bool,
    /// The hash of the state.
    pub hash: bool,
    /// The colour map.
    pub map: ColourMap,
    /// Whether bodies that carry a drawing are shown in its colours.
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
    /// Kinetic energy, ½ Σ m v².
    pub kinetic: f64,
    /// Elastic energy of the models.
    pub elastic: f64,
    /// Energy of the gas.
    pub gas: f64,
    /// Potential energy of gravity.
    pub gravity: f64,
    /// Work of pulls, pushes and loads.
    pub work: f64,
    /// The sum of the losses by damping, friction and impacts.
    pub losses: f64,
    /// The numerical dissipation of implicit integrators.
    pub numerical: f64,
    /// The error of the integrator.
    pub error: f64,
}

/// One body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyShown {
    /// The index of the body in the world.
    pub number: usize,
    /// The name of the body.
    pub name: String,
    /// The name under which the user knows the body. A body that replaces another one is shown under the name of the original.
    pub title: String,
    /// The number of nodes.
    pub nodes: usize,
    /// The models of the body; empty if there are many bodies.
    pub models: Vec<Values>,
    /// The body's own integrator, if it has one.
    pub integrator: Option<Values>,
    /// The shape of the body in the scene, if the body has a table of its own.
    pub shape: Option<Values>,
    /// Readings of the body's models, such as volume and pressure.
    pub readings: Vec<Reading>,
}

impl EnergyShown {
    /// The total of stored and kinetic energy [J].
    pub fn total(&self) -> f64 {
        self.kinetic + self.elastic + self.gas + self.gravity
    }
}

/// The right side: the same scene in another configuration, at the same frame.
#[derive(Clone, Debug)]
pub struct Beside {
    /// The data about the right side that the interface shows.
    pub right: Arc<Shown>,
    /// The root mean square and the largest distance between corresponding nodes of the two sides [m]; none if the bodies have different nodes or the
    /// right side has stopped.
    pub distances: Option<[f64; 2]>,
    /// The distance between the centres of mass of both sides \[m\].
    pub center: Option<f64>,
    /// The volume within the surfaces of the right side minus that within the surfaces of the left side \[m³\]; in the plane, the same for the areas
    /// within the outlines \[m²\].
    pub volume: Option<f64>,
    /// The energy of the right side minus that of the left side [J].
    pub energy: Option<f64>,
    /// The differences of the right side.
    pub differences: Vec<Difference>,
    /// The reason why the right side has stopped, if it has.
    pub stopped: Option<Report>,
}

/// One obstacle.
#[derive(Clone, Debug, PartialEq)]
pub struct ObstacleShown {
    /// The kind and the parameters of the obstacle.
    pub values: Values,
}

/// How the simulation keeps up with the clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pace {
    /// The ratio of simulated time to the requested one; 1 if the simulation keeps up.
    pub ratio: f64,
    /// The computing time of a frame of the scene [s].
    pub frame_cost: f64,
}

/// The severity of a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Something was done.
    Done,
    /// Something could not be done; nothing has changed.
    Refused,
}

/// The action of a button beside a message.
#[derive(Clone, Debug, PartialEq)]
pub enum Offer {
    /// Go back one second and halve the step.
    HalveStep,
    /// Go back one second and use an integrator with a stable step, for the body of this index or for the scene.
    Steady(Option<usize>, &'static str),
    /// Use this number of substeps and repeat the refused request.
    Substeps(u32),
    /// Give a field of the body's shape this value instead of the refused one, and use as many substeps as needed.
    Coarser(String, &'static str, i64),
    /// Continue after the end of a recording.
    GoOn,
    /// Allow this time for a frame \[s\], and repeat the interrupted request.
    Wait(f64),
}

/// A message.
#[derive(Clone, Debug, PartialEq)]
pub struct Message {
    /// A running number, which distinguishes a new message from an earlier one with the same text.
    pub number: u64,
    /// The severity of the message.
    pub severity: Severity,
    /// The contents of the message.
    pub report: Report,
    /// The text of the message in English.
    pub text: String,
    /// The offered remedy.
    pub offer: Option<Offer>,
    /// The computing time of a frame with the number of substeps that the refused request needs [s]; none if it is short.
    pub frame_seconds: Option<f64>,
}

/// The extent of a body. The extent is computed once per picture, because the window needs it several times, and the bodies may have tens of
/// thousands of nodes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// The lowest and the highest corner of the box around the nodes [m]; interchanged if the body has no nodes.
    pub corners: [[f64; 3]; 2],
    /// The smallest and the largest value that the colours show; interchanged if no value is finite.
    pub colours: [f64; 2],
}

impl Extent {
    /// Computes the extent of a body.
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
    /// The title of the scene.
    pub title: String,
    /// 2 or 3; 0 before the first scene.
    pub dimension: u8,
    /// The time [s].
    pub time: f64,
    /// The number of frames since the start.
    pub frames: u64,
    /// The number of the last frame of this run that was computed.
    pub latest: u64,
    /// The time up to which the run is being computed again \[s\]; none if the run is not being computed again.
    pub goal: Option<f64>,
    /// The length of a frame [s].
    pub frame: f64,
    /// The duration of the scene on the command line [s].
    pub seconds: f64,
    /// The number of substeps per frame.
    pub substeps: u32,
    /// The largest stable substep [s]; infinite if there is no limit.
    pub stable_step: f64,
    /// Gravity [m/s²].
    pub gravity: [f64; 3],
    /// Drag [1/s].
    pub drag: f64,
    /// The integrator of the scene.
    pub integrator: Option<Values>,
    /// The hash of the state, if it is displayed; `opruga run --json` prints the same hash.
    pub hash: Option<u64>,
    /// The bodies, in the same order as in the picture.
    pub bodies: Vec<BodyShown>,
    /// The obstacles.
    pub obstacles: Vec<ObstacleShown>,
    /// The parameters of contact between bodies; none if bodies pass through one another.
    pub contact: Option<Values>,
    /// For each pull: the position of the node [m], the position of the pointer [m], and the force [N].
    pub pulls: Vec<[[f64; 3]; 3]>,
    /// For each push of the pointer: the position of the node [m], the end of the arrow [m], and the force [N].
    pub pushes: Vec<[[f64; 3]; 3]>,
    /// For each point that the user has pinned: the body, the node and the position [m].
    pub pins: Vec<(usize, u32, [f64; 3])>,
    /// The energy ledger.
    pub energy: EnergyShown,
    /// The momentum [kg m/s].
    pub momentum: [f64; 3],
    /// The curves of this run; they may extend beyond this moment.
    pub samples: Arc<RwLock<Samples>>,
    /// The warnings.
    pub warnings: Vec<Warning>,
    /// The picture.
    pub picture: Picture,
    /// The extent of each body in the picture.
    pub extents: Vec<Extent>,
    /// Whether time passes.
    pub playing: bool,
    /// The requested number of simulated seconds per real second.
    pub speed: f64,
    /// How the simulation keeps up.
    pub pace: Pace,
    /// The action that can be undone.
    pub undo: Option<Step>,
    /// The action that can be redone.
    pub redo: Option<Step>,
    /// The last message.
    pub message: Option<Message>,
    /// The number of scenes that were opened or rebuilt so far. The view is fitted once for each of these scenes.
    pub opened: u64,
    /// How often the state was suddenly replaced by a different one, for example by undo, a reset or the time slider. Everything that was fitted to
    /// the earlier states is then fitted again.
    pub replaced: u64,
    /// How often the user has reset the scene to its start. Each time, the view is reset, too.
    pub resets: u64,
    /// The same scene in another configuration.
    pub beside: Option<Beside>,
    /// Bodies that were renamed when they were replaced: old and new names.
    pub renamed: Vec<(String, String)>,
    /// The last body that was added or copied, with a running number.
    pub newest: Option<(u64, String)>,
    /// Whether bodies carry drawings with colours.
    pub has_drawings: bool,
    /// The last frame that still agrees with the recording; none if no recording is viewed.
    pub recorded_until: Option<u64>,
    /// The number of commands of the user in the scene.
    pub recorded: usize,
    /// The memory that the kept states occupy [bytes]. The session can return to these states without computing from the start.
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
