//! A custom model: an elastic bed that attaches every node to its rest position, U = ½ k |x − X|².

use opruga::blueprint::{Blueprint, BodyBlueprint, Mass};
use opruga::extend::*;
use opruga::{Options, Registry, World, mesh::Mesh};

const K: Field = Field::new("stiffness", Allowed::POSITIVE, "N/m", Default::Required, "Stiffness k of every node.");
const SPEC: Spec =
    Spec { kind: "bed", summary: "a bed", documentation: "", dimensions: &[2], fields: &[K], roles: &[] };

struct BedModel;
impl Model<2> for BedModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn views(&self) -> Views {
        // Only forces: implicit integrators would need the Hessian, and the ledger would need the energy.
        Views::default()
    }
    fn build(&self, of: &Ingredients<2>) -> Result<Box<dyn Potential<2>>, BuildError> {
        Ok(Box::new(Bed(of.values[0].number("stiffness").unwrap_or(0.0), of.mesh.positions.clone())))
    }
}

/// The stiffness of a node [N/m] and the rest positions [m].
#[derive(Debug)]
struct Bed(f64, Vec<[f64; 2]>);
impl Potential<2> for Bed {
    fn properties(&self) -> Properties {
        Properties::new(SPEC.kind, BedModel.views())
    }
    fn add_force(&self, _: Simd, view: &View<2>, _: &[f64], tile: &mut Tile<2>) {
        for node in tile.range.start..tile.range.end.min(self.1.len()) {
            for d in 0..2 {
                tile.force[d][node - tile.range.start] -= self.0 * (view.x[d][node] - self.1[node][d]);
            }
        }
    }
}

impl Observe<2> for Bed {}

/// A ring sinks into the bed for half a period; returns how far [m], and the closed form 2 m g / k [m].
pub(crate) fn run() -> Result<[f64; 2], Box<dyn std::error::Error>> {
    let mut registry = Registry::<2>::default();
    registry.add_model(Box::new(BedModel));
    let bed = registry.model_values("bed", &[("stiffness", 246.74.into())])?; // half a swing of 1 kg takes 0.2 s
    let mut scene = Blueprint::new("bed", registry.integrator_values("verlet", &[])?);
    scene.surroundings.gravity = [0.0, -9.81];
    scene.bodies.push(BodyBlueprint::new("ring", Mesh::ring(0.5, 12, [0.0; 2], 0.0)?, Mass::Node(1.0), vec![bed]));
    let mut world = World::with_registry(scene, Options::default(), registry.into())?;
    for _ in 0..12 {
        world.frame()?;
    }
    Ok([-world.position(0, 0)[1], 2.0 * 9.81 / 246.74])
}
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let [sag, expected] = run()?;
    println!("the ring sags by {sag:.5} m; the closed form says {expected:.5} m");
    Ok(())
}
