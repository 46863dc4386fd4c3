//! A model that only this test knows: once it is registered, all layers above support it.

use opruga::extend::*;
use opruga::io::{reference, scene, schema};
use opruga::pictures::Scenery;
use opruga::sweep::{Status, Sweep};
use opruga::{Options, Registries, Registry, World, WorldError, catalogue, catalogue_of};
use std::sync::Arc;

const K: Field = Field::new("tightness", Allowed::POSITIVE, "N/m", Default::Required, "Stiffness k of every node.");
const SPEC: Spec = Spec {
    kind: "bed_of_a_test",
    summary: "a bed that only a test knows",
    documentation: "",
    dimensions: &[2, 3],
    fields: &[K],
    roles: &[],
};

/// U = ½ k |x − X|² for every node.
struct BedModel;
impl<const D: usize> Model<D> for BedModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn views(&self) -> Views {
        Views::default()
    }
    fn build(&self, of: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        if of.mesh.nodes() > 100 {
            return Err(BuildError::new(SPEC.kind, "bed.too_large", "the bed is too small for the body"));
        }
        Ok(Box::new(Bed(of.values[0].number("tightness").unwrap_or(0.0), of.mesh.positions.clone())))
    }
}

/// The stiffness of a node [N/m] and the rest positions [m].
#[derive(Debug)]
struct Bed<const D: usize>(f64, Vec<[f64; D]>);
impl<const D: usize> Potential<D> for Bed<D> {
    fn properties(&self) -> Properties {
        Properties::new(SPEC.kind, Views::default())
    }
    fn add_force(&self, _: Simd, view: &View<D>, _: &[f64], tile: &mut Tile<D>) {
        for node in tile.range.start..tile.range.end.min(self.1.len()) {
            for d in 0..D {
                tile.force[d][node - tile.range.start] -= self.0 * (view.x[d][node] - self.1[node][d]);
            }
        }
    }
}

impl<const D: usize> Observe<D> for Bed<D> {}

fn registries() -> Registries {
    let (mut plane, mut space) = (Registry::default(), Registry::default());
    plane.add_model(Box::new(BedModel));
    space.add_model(Box::new(BedModel));
    Registries { plane: Arc::new(plane), space: Arc::new(space) }
}

/// A single node of 1 kg on the bed, pulled down by gravity.
fn text(dimension: usize, model: &str) -> String {
    let gravity = if dimension == 2 { "[0, -10]" } else { "[0, -10, 0]" };
    let shape =
        if dimension == 2 { "ring\", radius = 1, vertices = 12" } else { "icosphere\", radius = 1, subdivisions = 1" };
    format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\nframe = 0.01\nsubsteps = 8\n[world]\ngravity = {gravity}\n\
         [integrator]\nkind = \"verlet\"\n[[body]]\nname = \"b\"\nnode_mass = 1\nshape = {{ kind = \"{shape} }}\n\
         models = [{{ kind = \"{model}\", tightness = 1000 }}]\n"
    )
}

#[test]
fn a_registered_model_is_listed_described_and_paired_with_integrators() {
    let (registries, known) = (registries(), catalogue_of(&registries()));
    let count = |specs: &[&Spec]| specs.iter().filter(|spec| spec.kind == SPEC.kind).count();
    assert_eq!((count(&known.models), count(&catalogue().models)), (1, 0));
    assert_eq!(known.models.len(), catalogue().models.len() + 1, "kinds of both dimensions are listed once");
    assert_eq!(known.integrators.len(), catalogue().integrators.len());
    let pairs = [registries.plane.pairs(), registries.space.pairs()];
    for pairs in pairs {
        let fits = |rule| pairs.contains(&(SPEC.kind, rule, true));
        assert!(fits("verlet") && !fits("backward_euler"), "it has forces and no second derivatives");
    }
    let page = reference::markdown(&known);
    assert!(page.contains(SPEC.kind) && page.contains(K.name) && page.contains(K.documentation), "{page}");
    let schema = schema::json_schema(&known).to_string();
    assert!(schema.contains(SPEC.kind) && schema.contains(K.name));
    assert!(!reference::markdown(&catalogue()).contains(SPEC.kind));
}

/// A model that does not say that it handles batches may take indices for nodes.
#[test]
fn alike_bodies_with_a_registered_model_move_alike() {
    let (registries, known) = (registries(), catalogue_of(&registries()));
    let text = text(2, SPEC.kind) + "copies = { count = [5, 1], spacing = [9, 9] }\n";
    let read = scene::read(text.as_bytes(), "a.toml", &known, &scene::Options::default()).expect("a scene");
    let opruga::blueprint::AnyBlueprint::Plane(mut blueprint) = read.0 else { panic!("a scene of the plane") };
    // The bed attaches bodies to their rest positions.
    blueprint.bodies.iter_mut().for_each(|body| body.translation = [0.0; 2]);
    let mut world = World::with_registry(blueprint, Options::default(), registries.plane).expect("a world");
    (0..3).for_each(|_| world.frame().expect("a frame"));
    let positions = |body| (0..12).map(|node| world.position(body, node)).collect::<Vec<_>>();
    assert!(positions(0)[0][1] < 0.0, "it sinks");
    for body in 1..5 {
        assert_eq!(positions(body), positions(0));
    }
}

/// If a scene misspells the name of the model, the error suggests the name. If the model is not registered, the scene is refused.
#[test]
fn a_registered_model_is_offered_where_a_scene_misspells_it() {
    let known = catalogue_of(&registries());
    let options = scene::Options::default();
    let refused =
        |text: &str, catalogue| scene::read(text.as_bytes(), "a.toml", catalogue, &options).err().unwrap_or_default();
    let errors = refused(&text(2, "bed_of_a_tset"), &known);
    let said: Vec<String> = errors.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|said| said.contains("scene.unknown_kind") && said.contains("bed_of_a_test")), "{said:?}");
    let range = refused(&text(2, SPEC.kind).replace("1000", "-1000"), &known);
    assert_eq!(range.iter().map(|error| error.code).collect::<Vec<_>>(), ["scene.range"]);
    let field = refused(&text(2, SPEC.kind).replace("tightness", "tihgtness"), &known);
    let said: Vec<String> = field.iter().map(ToString::to_string).collect();
    assert!(said.iter().any(|said| said.contains("scene.unknown_field") && said.contains(K.name)), "{said:?}");
    assert!(!refused(&text(2, SPEC.kind), &catalogue()).is_empty());
}

/// Also together with other errors, in which case the world is built part by part.
#[test]
fn what_a_registered_model_refuses_is_among_the_problems_of_the_scene() {
    let (registries, known) = (registries(), catalogue_of(&registries()));
    let large = text(2, SPEC.kind).replace("vertices = 12", "vertices = 101");
    let read =
        |text: &str| scene::read(text.as_bytes(), "a.toml", &known, &scene::Options::default()).expect("a scene").0;
    let codes = |text: &str| -> Vec<&'static str> {
        read(text).problems(&Options::default(), &registries).iter().map(WorldError::code).collect()
    };
    assert_eq!((codes(&large), codes(&text(2, SPEC.kind))), (vec!["bed.too_large"], Vec::new()));
    let refused = read(&large).build_with(Options::default(), &registries).err();
    assert_eq!(refused.map(|error| error.code()), Some("bed.too_large"));
}

#[test]
fn a_sweep_runs_a_scene_with_a_registered_model() {
    let mut sweep =
        Sweep::new("bed", &text(2, SPEC.kind), &["body.b.models.bed_of_a_test.tightness=500,1000"], &["energy_drift"])
            .expect("a sweep");
    assert!(sweep.points().is_err(), "the library does not have it");
    sweep.registries = registries();
    let rows = sweep.run().expect("rows");
    assert_eq!(rows.iter().map(|row| &row.status).collect::<Vec<_>>(), [&Status::Done, &Status::Done]);
}

/// Half a period about the equilibrium m g/k below: after it the node is 2 m g/k = 0.02 m lower.
#[test]
fn a_scene_with_a_registered_model_runs_in_both_dimensions() {
    let (registries, known) = (registries(), catalogue_of(&registries()));
    for dimension in [2, 3] {
        let read = scene::read(text(dimension, SPEC.kind).as_bytes(), "a.toml", &known, &scene::Options::default());
        let (blueprint, _) = read.expect("a scene");
        assert!(blueprint.clone().build(Options::default()).is_err(), "the library does not have it");
        let mut world = blueprint.build_with(Options::default(), &registries).expect("a world");
        let start = world.positions(0).at(0)[1];
        let scenery = Scenery::new(&*world);
        // π √(m/k) = 0.0993 s.
        for _ in 0..10 {
            world.frame().expect("a frame");
        }
        let sag = start - world.positions(0).at(0)[1];
        assert!((sag - 0.02).abs() < 1e-4, "{sag}");
        let picture = scenery.picture(&scenery.capture(&mut *world, true));
        assert_eq!((picture.bodies.len(), picture.arrows.is_empty()), (1, false), "the forces of the bed are drawn");
    }
}
