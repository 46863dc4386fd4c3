//! A scene that has been read and checked but not built yet: plain data, independent of file format and engine.

use opruga_core::spec::Values;
use opruga_mesh::Mesh;
use std::sync::Arc;

/// A checked scene in the plane or in space.
#[derive(Clone, Debug)]
pub enum AnyBlueprint {
    /// `dimension = 2`.
    Plane(Blueprint<2>),
    /// `dimension = 3`.
    Space(Blueprint<3>),
}

impl TryFrom<AnyBlueprint> for Blueprint<2> {
    type Error = AnyBlueprint;

    /// Returns the scene in the plane, or the unchanged scene if it is in space.
    fn try_from(scene: AnyBlueprint) -> Result<Self, AnyBlueprint> {
        match scene {
            AnyBlueprint::Plane(blueprint) => Ok(blueprint),
            space => Err(space),
        }
    }
}

impl TryFrom<AnyBlueprint> for Blueprint<3> {
    type Error = AnyBlueprint;

    /// Returns the scene in space, or the unchanged scene if it is in the plane.
    fn try_from(scene: AnyBlueprint) -> Result<Self, AnyBlueprint> {
        match scene {
            AnyBlueprint::Space(blueprint) => Ok(blueprint),
            plane => Err(plane),
        }
    }
}

/// A checked scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Blueprint<const D: usize> {
    /// The name of the scene: its file name without the extension.
    pub name: String,
    /// A sentence for lists and pictures.
    pub title: String,
    /// The label of the unit of length in pictures and plots: `m`, unless the scene uses another unit, such as pixels.
    pub length_unit: String,
    /// The authors and licences of the drawings, maps and surfaces in the scene; written under every picture.
    pub credit: String,
    /// What pictures of the scene show.
    pub picture: Pictured<D>,
    /// The seed of all random numbers.
    pub seed: u64,
    /// How time passes.
    pub time: Time,
    /// Forces and limits that apply everywhere.
    pub surroundings: Surroundings<D>,
    /// The integrator and its parameters (`kind`, and the fields of its specification).
    pub integrator: Values,
    /// The bodies, with copies already expanded.
    pub bodies: Vec<BodyBlueprint<D>>,
    /// Rigid obstacles.
    pub colliders: Vec<ColliderBlueprint>,
    /// How bodies touch one another; `None` if they do not.
    pub contact: Option<ContactBlueprint>,
    /// Forces from outside.
    pub loads: Vec<LoadBlueprint<D>>,
    /// What is done to the bodies while they move.
    pub commands: Vec<CommandBlueprint<D>>,
    /// The quantities that are recorded frame by frame.
    pub probes: Vec<ProbeBlueprint<D>>,
}

impl<const D: usize> Blueprint<D> {
    /// The same surroundings with other bodies, obstacles and loads, so that some of them can be examined alone.
    pub(crate) fn part(
        &self,
        bodies: Vec<BodyBlueprint<D>>,
        colliders: Vec<ColliderBlueprint>,
        loads: Vec<LoadBlueprint<D>>,
    ) -> Blueprint<D> {
        Blueprint {
            name: self.name.clone(),
            title: self.title.clone(),
            length_unit: self.length_unit.clone(),
            credit: self.credit.clone(),
            picture: self.picture,
            seed: self.seed,
            time: self.time,
            surroundings: self.surroundings,
            integrator: self.integrator.clone(),
            bodies,
            colliders,
            // The part may lack some of the groups to which the settings for pairs refer.
            contact: self.contact.as_ref().map(|c| ContactBlueprint { values: c.values.clone(), pairs: Vec::new() }),
            loads,
            commands: Vec::new(),
            probes: Vec::new(),
        }
    }
}

/// What pictures of a scene show. Values that are not given are chosen from the visible objects. No result of the physics depends on them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pictured<const D: usize> {
    /// The number of moments in a film strip.
    pub panels: Option<u32>,
    /// The lowest and the highest corner of the region that a film strip shows [m].
    pub region: Option<[[f64; D]; 2]>,
    /// The angle of the camera around the y axis, from z towards x [degrees]; only in space.
    pub azimuth: Option<f64>,
    /// The angle of the camera above the horizon [degrees]; only in space.
    pub elevation: Option<f64>,
}

/// How time passes: a frame is divided into substeps of h = frame / substeps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// How long the scene lasts [s].
    pub seconds: f64,
    /// The length of a frame [s].
    pub frame: f64,
    /// The number of substeps of a frame.
    pub substeps: u32,
}

impl Time {
    /// The number of whole frames until the end.
    pub fn frames(&self) -> u64 {
        // Tolerates rounding; NaN gives 0 frames.
        let frames = (self.seconds / self.frame - 1e-9).ceil();
        if frames > 0.0 { frames as u64 } else { 0 }
    }
}

/// Forces and limits that apply everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings<const D: usize> {
    /// Acceleration of gravity [m/s²].
    pub gravity: [f64; D],
    /// Drag per unit of mass [1/s]: a = −drag·v. Drag slows rigid motion too.
    pub drag: f64,
    /// The largest force on a node [N]. Each use of the limit is counted. `None` means no limit.
    pub largest_force: Option<f64>,
    /// The largest speed of a node [m/s]. Each use of the limit is counted. `None` means no limit.
    pub largest_velocity: Option<f64>,
    /// A body is removed if all of its nodes are farther from the origin than this [m]. Removed bodies are counted. `None` means no limit.
    pub largest_distance: Option<f64>,
    /// Whether bodies at rest in a degenerate shape get a random displacement, so that they leave it. Such displacements are counted.
    pub unfold: bool,
}

/// A body of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyBlueprint<const D: usize> {
    /// Its name, unique in the scene; copies are `name[0]`, `name[1]`, …
    pub name: String,
    /// Its rest shape; copies share it.
    pub mesh: Arc<Mesh<D>>,
    /// The translation of its rest shape at the start [m].
    pub translation: [f64; D],
    /// Velocity at the start [m/s].
    pub velocity: [f64; D],
    /// Angular velocity about the centre of mass at the start [rad/s]: one number in 2D, three in 3D.
    pub angular_velocity: Vec<f64>,
    /// Velocity gradient at the start, G = ∂v/∂x, row by row [1/s]. The gradient adds the velocity G (x − c) at the position x, where c is the centre
    /// of mass.
    pub velocity_gradient: [[f64; D]; D],
    /// The additional velocity of every node at the start [m/s], one row per node; empty if there is none.
    pub node_velocities: Arc<[[f64; D]]>,
    /// The mass of the body or of its parts.
    pub mass: Mass,
    /// Depth out of the plane in 2D; in 3D the thickness of a sheet or the width of a wire, used only for a mass given by density [m].
    pub thickness: f64,
    /// The integrator of this body and its parameters; `None` if it uses the integrator of the scene.
    pub integrator: Option<Values>,
    /// Its models and their parameters.
    pub models: Vec<Values>,
    /// Its pinned nodes.
    pub pins: Vec<PinBlueprint<D>>,
    /// How it touches other bodies (`schema::BODY_CONTACT`); `None` if the settings of the scene apply.
    pub contact: Option<Values>,
}

/// The mass of a body.
#[derive(Clone, Debug, PartialEq)]
pub enum Mass {
    /// Mass of the whole body [kg].
    Total(f64),
    /// Mass per volume [kg/m³].
    Density(f64),
    /// Mass per volume of every cell of the mesh [kg/m³].
    DensityOfCells(Arc<[f64]>),
    /// Mass of every node [kg].
    Node(f64),
}

/// A set of nodes of one body.
#[derive(Clone, Debug, PartialEq)]
pub enum Selector<const D: usize> {
    /// Nodes whose position at the start lies in a box between two corners [m].
    Box([f64; D], [f64; D]),
    /// Nodes at most a radius from a centre [m].
    Ball {
        /// The centre [m].
        center: [f64; D],
        /// The radius [m].
        radius: f64,
    },
    /// Nodes on the side of a plane to which its normal points, or on it.
    HalfSpace {
        /// A point of the plane [m].
        point: [f64; D],
        /// The normal, which points to the selected side.
        normal: [f64; D],
    },
    /// Nodes on one side of the body's bounding box: `left`, `right`, `bottom`, `top`, `back`, `front`.
    Side(String),
    /// Nodes by number.
    Nodes(Vec<u32>),
    /// A named group of the mesh.
    Group(String),
    /// Nodes of the boundary.
    Boundary,
    /// Every node.
    All,
    /// Nodes in every one of the sets.
    And(Vec<Selector<D>>),
    /// Nodes in any one of the sets.
    Or(Vec<Selector<D>>),
    /// Nodes that are not in the set.
    Not(std::boxed::Box<Selector<D>>),
}

/// Pinned nodes: held at rest, or moved along a given motion.
#[derive(Clone, Debug, PartialEq)]
pub struct PinBlueprint<const D: usize> {
    /// The nodes that are pinned.
    pub select: Selector<D>,
    /// The pinned axes.
    pub axes: [bool; D],
    /// The displacement from the start over time, rows `[t, dx, dy(, dz)]`; empty for a node at rest.
    pub motion: Vec<Vec<f64>>,
}

/// A rigid obstacle: its shape, surface and motion.
#[derive(Clone, Debug, PartialEq)]
pub struct ColliderBlueprint {
    /// `kind` and the fields of its specification, among them `restitution` and `friction`.
    pub values: Values,
}

/// How bodies touch one another.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactBlueprint {
    /// The fields of `schema::CONTACT`.
    pub values: Values,
    /// Settings for pairs of groups (`schema::CONTACT_PAIR`).
    pub pairs: Vec<Values>,
}

/// A force from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadBlueprint<const D: usize> {
    /// The body, by its index in the list.
    pub body: usize,
    /// The nodes on which the force acts.
    pub select: Selector<D>,
    /// The force that acts.
    pub kind: LoadKind<D>,
    /// A factor over time, rows `[t, factor]`; an empty curve means the factor 1.
    pub curve: Vec<Vec<f64>>,
}

/// The kind of a load.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadKind<const D: usize> {
    /// The same force on every selected node [N].
    Force([f64; D]),
    /// A force per area, distributed over the selected part of the boundary (rest area) [Pa].
    Traction([f64; D]),
    /// A pressure on the selected part of the boundary, along its present inner normal [Pa].
    Pressure(f64),
    /// A force per volume at rest [N/m³]. The force acts on the cells whose nodes are all selected, and their shape functions distribute it.
    BodyForce([f64; D]),
    /// A force of the same size on every selected node, towards a fixed point.
    Central {
        /// The size of the force [N]; a negative force points away from the point.
        value: f64,
        /// The point towards which the forces act [m].
        center: [f64; D],
    },
}

/// An action on a body from time `at` to time `until`.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandBlueprint<const D: usize> {
    /// When it begins [s].
    pub at: f64,
    /// When it ends [s]; for an instantaneous action, the same as `at`.
    pub until: f64,
    /// What the command does.
    pub action: Action<D>,
}

/// The action of a command.
#[derive(Clone, Debug, PartialEq)]
pub enum Action<const D: usize> {
    /// Pull a node toward a moving pointer by a critically damped spring.
    Drag {
        /// The body, by its index in the list. Bodies that commands add are numbered after the others, in order of time.
        body: usize,
        /// The node; `None` if it is the node, or the point of a facet, that is nearest to the pointer when the drag begins.
        node: Option<u32>,
        /// Whether the drag grabs the nearest point of a facet rather than a node.
        facet: bool,
        /// Stiffness of the spring [N/m].
        stiffness: Option<f64>,
        /// The path of the pointer, rows `[t, x, y(, z)]`.
        path: Vec<Vec<f64>>,
        /// The largest force [N]. Each use of the limit is counted.
        largest_force: Option<f64>,
    },
    /// A force on nodes [N].
    Push {
        /// The body, by its index in the list.
        body: usize,
        /// The nodes that are pushed.
        select: Selector<D>,
        /// The force on each node [N].
        force: [f64; D],
    },
    /// Pin nodes at the positions that they have at the beginning of the command.
    Pin {
        /// The body, by its index in the list.
        body: usize,
        /// The nodes to be pinned.
        select: Selector<D>,
        /// The axes along which the nodes are to be pinned.
        axes: [bool; D],
    },
    /// Release nodes that the body's own pins or earlier commands hold.
    Free {
        /// The body, by its index in the list.
        body: usize,
        /// The nodes to be released.
        select: Selector<D>,
    },
    /// Change a parameter: its path and its new value.
    Set {
        /// The path, as on the command line.
        path: String,
        /// The new value.
        value: opruga_core::spec::Value,
    },
    /// Give a moving body other models or another integrator.
    Change {
        /// The body, by its index in the list.
        body: usize,
        /// The models of the body from now on; `None` if they do not change.
        models: Option<Vec<Values>>,
        /// The body's own integrator from now on; `None` if it does not change.
        integrator: Option<Values>,
    },
    /// Add a body.
    Add(std::boxed::Box<BodyBlueprint<D>>),
    /// Remove a body.
    Remove {
        /// The name of the body.
        name: String,
    },
}

/// Columns of `diagnostics.csv` that record quantities of nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeBlueprint<const D: usize> {
    /// Its name, the first part of the columns' names.
    pub name: String,
    /// The body, by its index in the list.
    pub body: usize,
    /// Selects the nodes. The columns contain the mean over them (for reactions, the sum).
    pub select: Selector<D>,
    /// The recorded quantities: `position`, `velocity`, `reaction`, `contact`, `stress`, `volume_ratio`.
    pub record: Vec<Recorded>,
}

/// A quantity that a probe records.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recorded {
    /// Mean position [m].
    Position,
    /// Mean velocity [m/s].
    Velocity,
    /// Sum of the forces that the pins exert [N].
    Reaction,
    /// Sum of the forces that obstacles exert [N].
    Contact,
    /// The mean Cauchy stress at the nodes, and the von Mises stress of this mean [Pa].
    Stress,
    /// Mean volume ratio J at the nodes.
    VolumeRatio,
}

impl Recorded {
    /// All recorded quantities, with their names in scene files.
    pub const ALL: [(&'static str, Recorded); 6] = [
        ("position", Recorded::Position),
        ("velocity", Recorded::Velocity),
        ("reaction", Recorded::Reaction),
        ("contact", Recorded::Contact),
        ("stress", Recorded::Stress),
        ("volume_ratio", Recorded::VolumeRatio),
    ];

    /// The last parts of the names of its columns, after `NAME.`. In the plane, stress also has a component out of the plane.
    pub fn columns(self, dimension: usize) -> &'static [&'static str] {
        match (self, dimension) {
            (Recorded::Position, _) => &["x", "y", "z"][..dimension],
            (Recorded::Velocity, _) => &["vx", "vy", "vz"][..dimension],
            (Recorded::Reaction, _) => &["rx", "ry", "rz"][..dimension],
            (Recorded::Contact, _) => &["cx", "cy", "cz"][..dimension],
            (Recorded::Stress, 2) => &["sxx", "syy", "szz", "sxy", "von_mises"],
            (Recorded::Stress, _) => &["sxx", "syy", "szz", "sxy", "syz", "szx", "von_mises"],
            (Recorded::VolumeRatio, _) => &["volume_ratio"],
        }
    }

    /// Whether this quantity exists only if cells have a stress.
    pub fn is_of_cells(self) -> bool {
        matches!(self, Recorded::Stress | Recorded::VolumeRatio)
    }
}
