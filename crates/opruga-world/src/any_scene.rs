//! A scene without a dimension in its type: the queries that do not depend on the dimension.

use crate::blueprint::{
    AnyBlueprint, Blueprint, BodyBlueprint, ColliderBlueprint, ContactBlueprint, Pictured, Recorded, Time,
};
use crate::world::{Options, World};
use crate::{AnyWorld, Registries, WorldError};
use opruga_core::spec::{Role, Values};
use opruga_mesh::{CellQuality, Cells, EdgeSet, Skin};
use std::collections::BTreeMap;
use std::sync::Arc;

/// A scene in the plane or in space.
pub trait AnyScene {
    /// The number of coordinates of a node: 2 or 3.
    fn dimension(&self) -> usize;
    /// The name of the scene.
    fn name(&self) -> &str;
    /// A sentence for lists and pictures.
    fn title(&self) -> &str;
    /// The label of the unit of length in pictures and plots.
    fn length_unit(&self) -> &str;
    /// The authors and licences of the drawings, maps and surfaces in the scene.
    fn credit(&self) -> &str;
    /// What pictures of the scene show; z is 0 in the plane.
    fn pictured(&self) -> Pictured<3>;
    /// The duration of the scene, the length of a frame, and the number of substeps.
    fn time(&self) -> Time;
    /// Acceleration of gravity, one number per coordinate [m/s²].
    fn gravity(&self) -> &[f64];
    /// Drag per unit of mass [1/s].
    fn drag(&self) -> f64;
    /// The integrator and its parameters.
    fn integrator(&self) -> &Values;
    /// Rigid obstacles.
    fn colliders(&self) -> &[ColliderBlueprint];
    /// The contact settings of the bodies; `None` if bodies pass through one another.
    fn contact(&self) -> Option<&ContactBlueprint>;
    /// The length of the list of bodies. All body numbers are below this length; a number may belong to a body that was removed.
    fn body_count(&self) -> usize;
    /// The body with a number, if there is one.
    fn body(&self, number: usize) -> Option<&dyn AnyBody>;
    /// The names of the columns of every probe, in the order of [`AnyWorld::probe`].
    fn probe_columns(&self) -> Vec<Vec<String>>;
    /// What every probe records.
    fn probe_records(&self) -> Vec<&[Recorded]>;
}

impl dyn AnyScene + '_ {
    /// All bodies, in the order of their numbers.
    pub fn bodies(&self) -> impl Iterator<Item = &dyn AnyBody> {
        (0..self.body_count()).filter_map(|number| self.body(number))
    }
}

impl<const D: usize> AnyScene for Blueprint<D> {
    fn dimension(&self) -> usize {
        D
    }
    fn name(&self) -> &str {
        &self.name
    }
    fn title(&self) -> &str {
        &self.title
    }
    fn length_unit(&self) -> &str {
        &self.length_unit
    }
    fn credit(&self) -> &str {
        &self.credit
    }
    fn pictured(&self) -> Pictured<3> {
        let Pictured { panels, region, azimuth, elevation } = self.picture;
        Pictured { panels, region: region.map(|corners| corners.map(three)), azimuth, elevation }
    }
    fn time(&self) -> Time {
        self.time
    }
    fn gravity(&self) -> &[f64] {
        &self.surroundings.gravity
    }
    fn drag(&self) -> f64 {
        self.surroundings.drag
    }
    fn integrator(&self) -> &Values {
        &self.integrator
    }
    fn colliders(&self) -> &[ColliderBlueprint] {
        &self.colliders
    }
    fn contact(&self) -> Option<&ContactBlueprint> {
        self.contact.as_ref()
    }
    fn body_count(&self) -> usize {
        self.bodies.len()
    }
    fn body(&self, number: usize) -> Option<&dyn AnyBody> {
        self.bodies.get(number).map(|body| body as &dyn AnyBody)
    }
    fn probe_columns(&self) -> Vec<Vec<String>> {
        let columns = |probe: &crate::blueprint::ProbeBlueprint<D>| {
            let names = probe.record.iter().flat_map(|what| what.columns(D));
            names.map(|column| format!("{}.{column}", probe.name)).collect()
        };
        self.probes.iter().map(columns).collect()
    }
    fn probe_records(&self) -> Vec<&[Recorded]> {
        self.probes.iter().map(|probe| &*probe.record).collect()
    }
}

/// A body of a scene in the plane or in space.
pub trait AnyBody: core::fmt::Debug {
    /// The number of coordinates of a node: 2 or 3.
    fn dimension(&self) -> usize;
    /// Its name.
    fn name(&self) -> &str;
    /// Its models and their parameters.
    fn models(&self) -> &[Values];
    /// The body's own integrator; if there is none, the body uses the integrator of the scene.
    fn integrator(&self) -> Option<&Values>;
    /// Depth out of the plane in 2D; in 3D the thickness of a sheet or the width of a wire [m].
    fn thickness(&self) -> f64;
    /// Its own contact settings; `None` if it has none.
    fn contact(&self) -> Option<&Values>;
    /// The number of nodes of its rest shape.
    fn nodes(&self) -> usize;
    /// The rest positions of its nodes, before the body is moved to its position in the scene [m]; z is 0 in the plane.
    fn rest_positions(&self) -> Vec<[f64; 3]>;
    /// The translation of its rest shape at the start [m]; z is 0 in the plane.
    fn translation(&self) -> [f64; 3];
    /// The node numbers of the boundary facets of the rest shape. Each row has as many numbers as a node has coordinates.
    fn facets(&self) -> &[u32];
    /// The triangles of an open surface.
    fn sheets(&self) -> &[[u32; 3]];
    /// The wires of the body. Wires are drawn as lines even if the body has a surface.
    fn wires(&self) -> &[[u32; 2]];
    /// The filled interior.
    fn cells(&self) -> &Cells;
    /// Values of the cells by name.
    fn cell_values(&self) -> &BTreeMap<String, Vec<f64>>;
    /// Numbers of cells by the name of their group.
    fn cell_groups(&self) -> &BTreeMap<String, Vec<u32>>;
    /// The surface or drawing that is shown instead of the boundary, if there is one.
    fn skin(&self) -> Option<&Skin>;
    /// The signed volume that its facets enclose when its nodes are at the given positions [m³, m² in the plane]; `None` without facets.
    fn enclosed_volume(&self, positions: &[[f64; 3]]) -> Option<f64>;
    /// The pairs of nodes that its elements join.
    fn edges(&self) -> Vec<[u32; 2]>;
    /// The nodes that its own pins hold or move, in ascending order.
    fn pinned_nodes(&self) -> Vec<u32>;
    /// Whether one of its own pins holds nodes at rest.
    fn is_pinned_at_rest(&self) -> bool;
    /// The smallest and largest angles and edges of its cells; `None` if it has no cells.
    fn cell_quality(&self) -> Option<CellQuality>;
}

impl dyn AnyBody + '_ {
    /// Whether one of its models has the given role.
    pub fn has_role(&self, role: Role) -> bool {
        self.models().iter().any(|model| model.spec().has_role(role))
    }
}

impl<const D: usize> AnyBody for BodyBlueprint<D> {
    fn dimension(&self) -> usize {
        D
    }
    fn name(&self) -> &str {
        &self.name
    }
    fn models(&self) -> &[Values] {
        &self.models
    }
    fn integrator(&self) -> Option<&Values> {
        self.integrator.as_ref()
    }
    fn thickness(&self) -> f64 {
        self.thickness
    }
    fn nodes(&self) -> usize {
        self.mesh.nodes()
    }
    fn rest_positions(&self) -> Vec<[f64; 3]> {
        self.mesh.positions.iter().map(|position| three(*position)).collect()
    }
    fn translation(&self) -> [f64; 3] {
        three(self.translation)
    }
    fn facets(&self) -> &[u32] {
        self.mesh.facets.as_flattened()
    }
    fn contact(&self) -> Option<&Values> {
        self.contact.as_ref()
    }
    fn sheets(&self) -> &[[u32; 3]] {
        &self.mesh.sheets
    }
    fn wires(&self) -> &[[u32; 2]] {
        &self.mesh.wires
    }
    fn cells(&self) -> &Cells {
        &self.mesh.cells
    }
    fn cell_values(&self) -> &BTreeMap<String, Vec<f64>> {
        &self.mesh.cell_values
    }
    fn cell_groups(&self) -> &BTreeMap<String, Vec<u32>> {
        &self.mesh.cell_groups
    }
    fn skin(&self) -> Option<&Skin> {
        self.mesh.skin.as_ref()
    }
    fn enclosed_volume(&self, positions: &[[f64; 3]]) -> Option<f64> {
        let positions: Vec<[f64; D]> = positions.iter().map(|position| core::array::from_fn(|d| position[d])).collect();
        (!self.mesh.facets.is_empty()).then(|| opruga_mesh::signed_volume(&self.mesh.facets, &positions))
    }
    fn edges(&self) -> Vec<[u32; 2]> {
        self.mesh.edges(EdgeSet::All)
    }
    fn pinned_nodes(&self) -> Vec<u32> {
        let pins = self.pins.iter();
        let mut nodes: Vec<u32> = pins.flat_map(|pin| pin.select.resolve(&self.mesh, &self.translation)).collect();
        nodes.sort_unstable();
        nodes.dedup();
        nodes
    }
    fn is_pinned_at_rest(&self) -> bool {
        self.pins.iter().any(|pin| pin.motion.is_empty())
    }
    fn cell_quality(&self) -> Option<CellQuality> {
        self.mesh.cell_quality()
    }
}

impl AnyBlueprint {
    /// The scene as seen by callers that do not depend on the dimension.
    pub fn scene(&self) -> &dyn AnyScene {
        match self {
            AnyBlueprint::Plane(blueprint) => blueprint,
            AnyBlueprint::Space(blueprint) => blueprint,
        }
    }

    /// Gives the scene another name.
    pub fn rename(&mut self, name: &str) {
        let own = match self {
            AnyBlueprint::Plane(blueprint) => &mut blueprint.name,
            AnyBlueprint::Space(blueprint) => &mut blueprint.name,
        };
        *own = name.to_string();
    }

    /// First the integrators of bodies that have their own, then the integrator of the scene.
    pub fn integrators_mut(&mut self) -> Vec<&mut Values> {
        fn of<const D: usize>(blueprint: &mut Blueprint<D>) -> Vec<&mut Values> {
            let own = blueprint.bodies.iter_mut().filter_map(|body| body.integrator.as_mut());
            own.chain([&mut blueprint.integrator]).collect()
        }
        match self {
            AnyBlueprint::Plane(blueprint) => of(blueprint),
            AnyBlueprint::Space(blueprint) => of(blueprint),
        }
    }

    /// Builds the world of the scene with the models and integrators of this library.
    ///
    /// # Errors
    /// The errors of [`World::new`].
    pub fn build(self, options: Options) -> Result<Box<dyn AnyWorld>, WorldError> {
        self.build_with(options, &Registries::default())
    }

    /// Builds the world of the scene.
    ///
    /// # Errors
    /// The errors of [`World::new`].
    pub fn build_with(self, options: Options, registries: &Registries) -> Result<Box<dyn AnyWorld>, WorldError> {
        let Registries { plane, space } = registries;
        Ok(match self {
            AnyBlueprint::Plane(blueprint) => Box::new(World::with_registry(blueprint, options, Arc::clone(plane))?),
            AnyBlueprint::Space(blueprint) => Box::new(World::with_registry(blueprint, options, Arc::clone(space))?),
        })
    }

    /// All errors that a world of the scene would return.
    pub fn problems(&self, options: &Options, registries: &Registries) -> Vec<WorldError> {
        let Registries { plane, space } = registries;
        match self {
            AnyBlueprint::Plane(blueprint) => World::problems(blueprint, options, plane),
            AnyBlueprint::Space(blueprint) => World::problems(blueprint, options, space),
        }
    }
}

/// The vector in space, with 0 for coordinates that it does not have.
pub(crate) fn three<const D: usize>(vector: [f64; D]) -> [f64; 3] {
    core::array::from_fn(|d| vector.get(d).copied().unwrap_or(0.0))
}
