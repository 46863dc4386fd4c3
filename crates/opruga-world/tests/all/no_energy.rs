//! Models whose forces do not have an energy.

use opruga_core::spec::Value;
use opruga_mesh::Mesh;
use opruga_world::blueprint::*;
use opruga_world::{Options, Registry, World};

/// A beam that sags under its own weight: the ledger of finite volumes on quadrilaterals lacks the work of their forces, which is not an error of the
/// integrator.
#[test]
fn what_has_no_energy_is_no_error_of_the_integrator() {
    let registry = Registry::<2>::default();
    for (kind, closes) in [("fem", true), ("finite_volume", false)] {
        let fields = [("youngs_modulus", Value::Number(4e4)), ("poissons_ratio", Value::Number(0.3))];
        let models = vec![registry.model_values(kind, &fields).expect("a model")];
        let beam = Mesh::<2>::grid([0.0; 2], [1.2, 0.2], [12, 2]).expect("a beam");
        let mut body = BodyBlueprint::new("beam", beam, Mass::Density(100.0), models);
        let select = Selector::Box([-0.1, -0.1], [0.01, 0.3]);
        body.pins = vec![PinBlueprint { select, axes: [true; 2], motion: Vec::new() }];
        let mut scene = Blueprint::new("beam", registry.integrator_values("symplectic_euler", &[]).expect("a rule"));
        scene.bodies.push(body);
        scene.surroundings.gravity = [0.0, -9.81];
        let mut world = World::new(scene, Options::default()).expect("a world");
        (0..40).for_each(|_| world.frame().expect("a frame"));
        assert_eq!(world.energy().closure < 0.1, closes, "{kind}: {:?}", world.energy());
        assert!(world.warnings().iter().all(|warning| warning.code != "ledger.closure"), "{kind}");
    }
}
