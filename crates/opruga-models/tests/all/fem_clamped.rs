//! Clamped Hessians of finite elements: they equal the exact ones if nothing is negative, whichever code path computes them.

use crate::support;

use crate::support::models::Fem;
use opruga_core::potential::{Definiteness, Model, Sink};
use opruga_core::spec::Values;
use opruga_core::system::Stage;
use opruga_mesh::Mesh;
use opruga_models::materials::NAMES;
use support::system;

/// Blocks in the order of delivery.
struct List<const D: usize>(Vec<[[f64; D]; D]>);
impl<const D: usize> Sink<D> for List<D> {
    fn block(&mut self, _a: usize, _b: usize, value: [[f64; D]; D]) {
        self.0.push(value);
    }
    fn low_rank(&mut self, _c: f64, _u: &[(usize, [f64; D])]) {}
}

/// Both Hessians of a body that is rotated and stretched in every direction.
fn hessians<const D: usize>(mesh: &Mesh<D>, values: Values, turned: bool) -> [Vec<f64>; 2]
where
    Fem: Model<D>,
{
    let mut system = system(mesh, &[(&Fem as &dyn Model<D>, values)]);
    let (c, s) = if turned { (0.6, 0.8) } else { (1.0, 0.0) };
    for (k, p) in mesh.positions.iter().enumerate() {
        let mut q = *p;
        for d in 0..D {
            q[d] = p[d] * (1.1 + 0.05 * d as f64);
        }
        q[0] += 0.03 * p[1];
        let (along, across) = (q[0], q[1]);
        (q[0], q[1]) = (c * along - s * across, s * along + c * across);
        system.state.x.set(k, q);
    }
    system.forces(false).unwrap();
    let view = system.view(Stage::Current, system.time);
    [Definiteness::Exact, Definiteness::Clamped].map(|keep| {
        let mut list = List(Vec::new());
        for member in &system.members {
            member.potential.hessian(&view, &member.scratch, keep, &mut list);
        }
        list.0.into_iter().flatten().flatten().collect()
    })
}

fn check<const D: usize>(mesh: &Mesh<D>, plane: &str)
where
    Fem: Model<D>,
{
    for &material in NAMES {
        let values = values!(fem, material: material, youngs_modulus: 900.0, poissons_ratio: 0.3, plane: plane);
        let [exact, clamped] = hessians(mesh, values, material != "linear");
        let largest = exact.iter().fold(0.0, |most: f64, k| if k.abs() > most { k.abs() } else { most });
        assert!(largest > 0.0 && exact.len() == clamped.len());
        for (exact, clamped) in exact.iter().zip(&clamped) {
            assert!((exact - clamped).abs() <= 1e-12 * largest, "{material}: {exact} {clamped}");
        }
    }
}

#[test]
fn a_stretched_body_has_the_same_hessian_clamped_and_exact() {
    let plane = Mesh::<2>::grid([0.3; 2], [1.1, 0.7], [3, 2]).unwrap();
    let space = Mesh::<3>::grid([0.3; 3], [1.1, 0.7, 0.5], [2, 1, 1]).unwrap();
    for (plane, space) in [
        (plane.clone().into_simplices().unwrap(), space.clone().into_simplices().unwrap()),
        (
            plane.into_simplices().unwrap().into_quadratic().unwrap(),
            space.into_simplices().unwrap().into_quadratic().unwrap(),
        ),
    ] {
        check(&plane, "strain");
        check(&plane, "stress");
        check(&space, "strain");
    }
}
