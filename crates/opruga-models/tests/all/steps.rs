//! The forces of a whole step, tile by tile through its buffers, equal those of one tile.

use crate::support;

use crate::support::models::{Bending, MassSpring, Pressure};
use opruga_core::state::{Parameter, View};
use opruga_core::system::{Stage, State, System, Update};
use opruga_core::tile::Tile;
use opruga_math::{Column, Pack, WIDTH};
use opruga_mesh::Mesh;
use std::ops::Range;
use support::{Part, system};

/// Records the forces.
struct Record;

impl<const D: usize> Update<D> for Record {
    fn writes(&self) -> Stage {
        Stage::Work(0)
    }
    fn time(&self) -> f64 {
        0.0
    }
    fn tile<P: Pack>(&self, range: Range<usize>, force: &[&[f64]; D], _: &Parameter, state: &mut State<D>) {
        for place in range.clone().step_by(WIDTH) {
            for d in 0..D {
                P::load(&force[d][place - range.start..]).store(&mut state.work[0][0].0[d][place..]);
            }
        }
    }
}

/// Displaces a mesh at random and compares the forces of a step with those of one tile over all indices.
fn compare<const D: usize>(mesh: &Mesh<D>, parts: &[Part<D>]) {
    let mut system: System<D> = system(mesh, parts);
    let mut random = opruga_core::check::Random::new(5);
    for node in 0..system.nodes {
        let (x, noise) = (system.state.x.at(node), random.vector::<D>());
        system.state.x.set(node, core::array::from_fn(|d| x[d] + 0.003 * noise[d]));
        system.state.v.set(node, random.vector());
    }
    system.plan(1);
    system.advance(Stage::Current, 0.0, 1.0, None, &Record).unwrap();

    let places = system.index_count();
    let mut whole: [Vec<f64>; D] = core::array::from_fn(|_| vec![0.0; places + WIDTH]);
    let (mut power, mut slots) = ([0.0; WIDTH], Column::default());
    let view: View<D> = system.view(Stage::Current, 0.0);
    for member in &system.members {
        let force = whole.each_mut().map(Vec::as_mut_slice);
        let mut tile = Tile { range: 0..places, force, power: &mut power, weight: None, slots: &mut slots };
        member.potential.add_force(system.simd, &view, &member.scratch, &mut tile);
    }
    for d in 0..D {
        let step = &system.state.work[0][0].0[d];
        let wrong = (0..system.nodes).filter(|p| step[*p].to_bits() != whole[d][*p].to_bits()).collect::<Vec<_>>();
        assert!(wrong.is_empty(), "{} of {} nodes, first {:?}", wrong.len(), system.nodes, wrong.first());
    }
    let (of_step, of_tile): (f64, f64) = (system.work.damping.iter().sum(), power.iter().sum());
    assert!((of_step - of_tile).abs() <= 1e-11 * of_tile, "power {of_step} {of_tile}");
}

#[test]
fn a_step_has_the_forces_of_one_tile() {
    let springs = || values!(mass_spring, stiffness: 300.0, damping: 2.0);
    let hinges = || values!(bending, stiffness: 0.001, damping: 0.0001);
    let gas = || values!(pressure, nRT: 7.0);
    for width in [30, 37, 61] {
        compare(&Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [width, 60]).unwrap(), &[(&MassSpring, springs())]);
    }
    let ring = Mesh::ring(1.0, 3001, [0.0; 2], 0.0).unwrap();
    compare(&ring, &[(&MassSpring, springs()), (&Pressure, gas()), (&Bending, hinges())]);
    let cloth = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]], [37, 61]).unwrap();
    compare(&cloth, &[(&MassSpring, springs()), (&Bending, hinges())]);
    compare(&cloth, &[(&MassSpring, values!(mass_spring, stiffness: 300.0, edges: "shear"))]);
    let sphere = Mesh::icosphere(1.0, 4).unwrap();
    compare(&sphere, &[(&MassSpring, springs()), (&Pressure, gas()), (&Bending, hinges())]);
}
