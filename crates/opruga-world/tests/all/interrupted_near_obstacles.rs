//! A resumed run equals an uninterrupted one for a body that hardly moves near an obstacle: whether obstacles are checked within a frame depends only
//! on data in the snapshot.

use crate::common;

use common::{clamp, solid, text};
use opruga_core::spec::{Value, Values};
use opruga_math::Lane;
use opruga_mesh::{Cut, Mesh};
use opruga_world::blueprint::{Blueprint, ColliderBlueprint};
use opruga_world::{Options, World};

/// A cube that is clamped at x = 0 and bends under its weight, above a floor at a given height [m].
fn above_a_floor(rule: &str, accuracy: &[(&str, Value)], substeps: u32, height: f64) -> Blueprint<3> {
    let mesh = Mesh::grid([0.0; 3], [1.0; 3], [3; 3]).unwrap().into_simplices_by(Cut::Five).unwrap();
    let material = [
        ("youngs_modulus", Value::Number(1e6)),
        ("poissons_ratio", Value::Number(0.4)),
        ("material", text("corotated")),
    ];
    let mut blueprint = solid(mesh, rule, accuracy, &material);
    blueprint.time.substeps = substeps;
    blueprint.surroundings.gravity = [0.0, -9.81, 0.0];
    blueprint.bodies[0].pins = clamp();
    let spec = opruga_collide::all(3).into_iter().find(|spec| spec.kind == "half_space").expect("a floor");
    let mut floor = Values::defaults(spec, 3);
    floor.set(spec, "point", Value::Numbers(vec![0.0, height, 0.0]), 3).expect("a point");
    floor.set(spec, "normal", Value::Numbers(vec![0.0, 1.0, 0.0]), 3).expect("a direction");
    blueprint.colliders.push(ColliderBlueprint { values: floor });
    blueprint
}

/// The lowest position of a node [m].
fn lowest(world: &World<3>) -> f64 {
    (0..world.node_count(0) as u32).map(|node| world.position(0, node)[1]).fold(f64::INFINITY, Lane::smaller)
}

/// The gaps include values inside and outside the margins within which resting, slow and newly built bodies check obstacles.
#[test]
fn a_slow_body_beside_an_obstacle_goes_on_from_a_snapshot_bit_for_bit() {
    let real_time = [("accuracy", text("real_time"))];
    for (rule, accuracy, substeps) in
        [("backward_euler", &real_time[..], 1), ("bdf2", &real_time[..], 2), ("newmark", &[], 1), ("verlet", &[], 64)]
    {
        let build = |height: f64| {
            World::new(above_a_floor(rule, accuracy, substeps, height), Options::default()).expect("a world")
        };
        let mut free = build(-10.0);
        let mut low = 0.0;
        for _ in 0..60 {
            free.frame().unwrap();
            low = lowest(&free).smaller(low);
        }
        for gap in [0.002, 0.01, 0.03, 0.05, 0.08, 0.2] {
            let mut whole = build(low - gap);
            (0..30).for_each(|_| whole.frame().unwrap());
            let mut resumed = build(low - gap);
            resumed.restore(&whole.snapshot()).expect("its own snapshot");
            for frame in 30..60 {
                whole.frame().unwrap();
                resumed.frame().unwrap();
                assert_eq!(resumed.frame_hash(), whole.frame_hash(), "{rule}, {gap} m, frame {frame}");
                assert_eq!(resumed.solver_work(), whole.solver_work(), "{rule}, {gap} m, frame {frame}");
            }
        }
    }
}
