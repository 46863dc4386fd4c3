//! A scene after it was read and checked, before it is built: plain data, no file format, no engine.

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

    /// The scene in the plane; as it was where it is in space.
    fn try_from(scene: AnyBlueprint) -> Result<Self, AnyBlueprint> {
        match scene {
            AnyBlueprint::Plane(blueprint) => Ok(blueprint),
            space => Err(space),
        }
    }
}

impl TryFrom<AnyBlueprint> for Blueprint<3> {
    type Error = AnyBlueprint;

    /// The scene in space; as it was where it is in the plane.
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
    /// The name of the scene: that of its file, without the ending.
    pub name: String,
    /// A sentence for lists and pictures.
    pub title: String,
    /// What pictures and plots call the unit of length: `m`, unless the scene counts in something else, such as pixels.
    pub length_unit: String,
    /// Whose drawings, maps and surfaces the scene shows, and under which licence: written under every picture.
    pub credit: String,
    /// What pictures of the scene show.
    pub picture: Pictured<D>,
    /// The seed of everything random.
    pub seed: u64,
    /// How time passes.
    pub time: Time,
    /// What acts everywhere.
    pub surroundings: Surroundings<D>,
    /// The integrator and its parameters (`kind`, and the fields of its specification).
    pub integrator: Values,
    /// The bodies, copies already written out.
    pub bodies: Vec<BodyBlueprint<D>>,
    /// Rigid obstacles.
    pub colliders: Vec<ColliderBlueprint>,
    /// How bodies touch one another; none: they do not.
    pub contact: Option<ContactBlueprint>,
    /// Forces from outside.
    pub loads: Vec<LoadBlueprint<D>>,
    /// What is done to the bodies while they move.
    pub commands: Vec<CommandBlueprint<D>>,
    /// What is written down frame by frame.
    pub probes: Vec<ProbeBlueprint<D>>,
}

impl<const D: usize> Blueprint<D> {
    /// The same surroundings with other bodies, obstacles and loads, to look at some by themselves.
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
            // Of a part its groups may be missing.
            contact: self.contact.as_ref().map(|c| ContactBlueprint { values: c.values.clone(), pairs: Vec::new() }),
            loads,
            commands: Vec::new(),
            probes: Vec::new(),
        }
    }
}

/// What pictures of a scene show; what is absent is chosen by what is seen. No number of the physics depends on it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Pictured<const D: usize> {
    /// How many moments a film strip shows.
    pub panels: Option<u32>,
    /// The lowest and the highest corner of the part that a film strip shows [m].
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
    /// How many whole frames it takes until the end.
    pub fn frames(&self) -> u64 {
        // Rounding apart; what is no number takes none.
        let frames = (self.seconds / self.frame - 1e-9).ceil();
        if frames > 0.0 { frames as u64 } else { 0 }
    }
}

/// What acts everywhere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surroundings<const D: usize> {
    /// Acceleration of gravity [m/s²].
    pub gravity: [f64; D],
    /// Drag per unit of mass [1/s]: a = −drag·v. It brakes rigid motion too.
    pub drag: f64,
    /// The largest force on a node [N]; counted every time it acts. None: no limit.
    pub largest_force: Option<f64>,
    /// The largest speed of a node [m/s]; counted every time it acts. None: no limit.
    pub largest_velocity: Option<f64>,
    /// Bodies all of whose nodes are farther from the origin than this are taken away [m]; each is counted. None: no limit.
    pub largest_distance: Option<f64>,
    /// Whether bodies that rest in a degenerate shape are displaced at random, so that they leave it; counted every time it acts.
    pub unfold: bool,
}

/// One body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyBlueprint<const D: usize> {
    /// Its name, unique in the scene; copies are `name[0]`, `name[1]`, …
    pub name: String,
    /// Its rest shape; copies share it.
    pub mesh: Arc<Mesh<D>>,
    /// Where its rest shape lies at the start [m].
    pub translation: [f64; D],
    /// Velocity at the start [m/s].
    pub velocity: [f64; D],
    /// Angular velocity at the start about the centre of mass [rad/s]: one number in 2D, three in 3D.
    pub angular_velocity: Vec<f64>,
    /// Gradient of the velocity at the start G = ∂v/∂x, row by row [1/s]: what G (x − c) adds about the centre of mass c.
    pub velocity_gradient: [[f64; D]; D],
    /// What every node has besides at the start [m/s], one row per node; empty: nothing.
    pub node_velocities: Arc<[[f64; D]]>,
    /// How much it weighs.
    pub mass: Mass,
    /// Depth out of the plane in 2D; in 3D the thickness of a sheet or the width of a wire, for the mass by density alone [m].
    pub thickness: f64,
    /// Its own integrator and the parameters of that; none: that of the scene.
    pub integrator: Option<Values>,
    /// Its models and their parameters.
    pub models: Vec<Values>,
    /// Its pins.
    pub pins: Vec<PinBlueprint<D>>,
    /// How it touches other bodies (`schema::BODY_CONTACT`); none: as the scene says.
    pub contact: Option<Values>,
}

/// How much a body weighs.
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
        /// The normal.
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

/// Nodes held at their place, or moved in a prescribed way.
#[derive(Clone, Debug, PartialEq)]
pub struct PinBlueprint<const D: usize> {
    /// Which nodes.
    pub select: Selector<D>,
    /// Which axes are held.
    pub axes: [bool; D],
    /// Displacement from the start over time, rows `[t, dx, dy(, dz)]`; empty: at rest.
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
    /// What pairs of groups do (`schema::CONTACT_PAIR`).
    pub pairs: Vec<Values>,
}

/// A force from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadBlueprint<const D: usize> {
    /// The body, by its place in the list.
    pub body: usize,
    /// Which nodes.
    pub select: Selector<D>,
    /// What acts.
    pub kind: LoadKind<D>,
    /// A factor over time, rows `[t, factor]`; empty: always 1.
    pub curve: Vec<Vec<f64>>,
}

/// What a load does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoadKind<const D: usize> {
    /// The same force on every selected node [N].
    Force([f64; D]),
    /// A force per area, spread over the selected part of the boundary (rest area) [Pa].
    Traction([f64; D]),
    /// A pressure on the selected part of the boundary, along its present inner normal [Pa].
    Pressure(f64),
    /// A force per volume at rest, spread over the cells all of whose nodes are selected by their shape functions [N/m³].
    BodyForce([f64; D]),
    /// A force of one size on every selected node, towards a point that stays where it is.
    Central {
        /// Its size [N]; negative: away from the point.
        value: f64,
        /// The point [m].
        center: [f64; D],
    },
}

/// Something done to a body from time `at` to time `until`.
#[derive(Clone, Debug, PartialEq)]
pub struct CommandBlueprint<const D: usize> {
    /// When it begins [s].
    pub at: f64,
    /// When it ends [s]; for what is done at once, the same as `at`.
    pub until: f64,
    /// What is done.
    pub action: Action<D>,
}

/// What a command does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action<const D: usize> {
    /// Pull a node toward a moving pointer by a critically damped spring.
    Drag {
        /// The body, by its place in the list; bodies that commands add are numbered on behind it, in the order of time.
        body: usize,
        /// The node; none: the one nearest to the pointer at the beginning.
        node: Option<u32>,
        /// Whether the nearest point of a facet is held rather than a node.
        facet: bool,
        /// Stiffness of the spring [N/m].
        stiffness: Option<f64>,
        /// The path of the pointer, rows `[t, x, y(, z)]`.
        path: Vec<Vec<f64>>,
        /// The largest force [N]; counted every time it acts.
        largest_force: Option<f64>,
    },
    /// A force on nodes [N].
    Push {
        /// The body.
        body: usize,
        /// Which nodes.
        select: Selector<D>,
        /// The force on every one of them [N].
        force: [f64; D],
    },
    /// Hold nodes where they are at the beginning.
    Pin {
        /// The body.
        body: usize,
        /// Which nodes.
        select: Selector<D>,
        /// Which axes.
        axes: [bool; D],
    },
    /// Let go of nodes that the body's own pins, or commands before this one, hold.
    Free {
        /// The body.
        body: usize,
        /// Which nodes.
        select: Selector<D>,
    },
    /// Change a parameter: its path and its new value.
    Set {
        /// The path, as on the command line.
        path: String,
        /// The new value.
        value: opruga_core::spec::Value,
    },
    /// Give a body other models or another integrator, while it moves.
    Change {
        /// The body.
        body: usize,
        /// Its models from now on; none: as before.
        models: Option<Vec<Values>>,
        /// Its own integrator from now on; none: as before.
        integrator: Option<Values>,
    },
    /// Add a body.
    Add(std::boxed::Box<BodyBlueprint<D>>),
    /// Take a body away.
    Remove {
        /// The name of the body.
        name: String,
    },
}

/// Columns of `diagnostics.csv` that follow nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct ProbeBlueprint<const D: usize> {
    /// Its name, the first part of the columns' names.
    pub name: String,
    /// The body.
    pub body: usize,
    /// Which nodes; their mean is written (of reactions the sum).
    pub select: Selector<D>,
    /// What is written: `position`, `velocity`, `reaction`, `contact`, `stress`, `volume_ratio`.
    pub record: Vec<Recorded>,
}

/// What a probe writes down.
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
    /// Cauchy's stress at the nodes, their mean, and the von Mises stress of that [Pa].
    Stress,
    /// The volume over that at rest J at the nodes, their mean.
    VolumeRatio,
}

impl Recorded {
    /// All of them with their words in scenes.
    pub const ALL: [(&'static str, Recorded); 6] = [
        ("position", Recorded::Position),
        ("velocity", Recorded::Velocity),
        ("reaction", Recorded::Reaction),
        ("contact", Recorded::Contact),
        ("stress", Recorded::Stress),
        ("volume_ratio", Recorded::VolumeRatio),
    ];

    /// The last parts of the names of its columns, behind `NAME.`. In the plane stress has a part across it too.
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

    /// Whether only cells with a stress have it.
    pub fn is_of_cells(self) -> bool {
        matches!(self, Recorded::Stress | Recorded::VolumeRatio)
    }
}
