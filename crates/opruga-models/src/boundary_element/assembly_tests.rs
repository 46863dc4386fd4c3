use super::*;
use opruga_mesh::Mesh;

fn report<const D: usize>(name: &str, mesh: &Mesh<D>, exterior: bool) -> (Surface<D>, Stiffness) {
    let surface = Surface::of(mesh, exterior).unwrap();
    let stiffness = Stiffness::new(&surface, 0.3, exterior, &[], &BreakOff::default()).unwrap();
    let changes = &stiffness.changes;
    assert!(changes.rotation < 1e-8 && changes.rigid < 1e-2 && changes.negative < 0.05, "{name}: {changes:?}");
    (surface, stiffness)
}

fn applied(stiffness: &Stiffness, u: &[f64]) -> Vec<f64> {
    let mut x = vec![0.0; stiffness.matrix.padded()];
    x[..u.len()].copy_from_slice(u);
    let mut y = x.clone();
    stiffness.matrix.multiply(opruga_math::Simd::best(), &x, &mut y);
    y.truncate(u.len());
    y
}

/// The rows of H sum to 0 for the interior and to 1 for the exterior, and a rotation has no traction.
#[test]
fn identities_hold() {
    for exterior in [false, true] {
        let ring = Mesh::ring(0.5, 36, [0.2, 2.0], 0.1).unwrap();
        let surface = Surface::of(&ring, exterior).unwrap();
        let break_off = BreakOff::default();
        let mut progress = Progress::new(&break_off, 72);
        let system = System::assemble(&surface, Kelvin { poisson: 0.3 }, exterior, &mut progress).unwrap();
        for d in 0..2 {
            let unit: Vec<f64> = (0..72).map(|k| if k % 2 == d { 1.0 } else { 0.0 }).collect();
            let sum = times(&system.h, system.rows, &unit);
            for (k, sum) in sum.iter().enumerate() {
                let expected = if exterior && k % 2 == d { 1.0 } else { 0.0 };
                assert!((sum - expected).abs() < 1e-13, "{sum}");
            }
        }
    }
    let (_, ring) = report("ring", &Mesh::ring(0.5, 36, [0.2, 2.0], 0.1).unwrap(), false);
    assert!(ring.changes.rotation < 1e-10);
    let square = Mesh::polyline(&[[0.0, 0.0], [1.0, 0.0], [1.0, 0.5], [0.0, 0.5]], true).map(|mut mesh| {
        mesh.facets = std::mem::take(&mut mesh.wires);
        mesh
    });
    let (_, square) = report("four edges", &square.unwrap(), false);
    assert!(square.changes.rotation < 1e-10);
    for subdivisions in 0..3 {
        let (_, sphere) = report("sphere", &Mesh::icosphere(0.5, subdivisions).unwrap(), false);
        assert!(sphere.changes.rotation < 1e-6);
    }
    let block = Mesh::box_surface([0.0; 3], [1.0, 0.6, 0.4], [5, 3, 2]).unwrap();
    let (_, block) = report("block", &block, false);
    assert!(block.changes.rotation < 1e-6);
}

/// A ball under pressure: u = −p (1 − 2ν) R/E.
#[test]
fn a_ball_shrinks_under_pressure() {
    let mut errors = Vec::new();
    for subdivisions in 0..4 {
        let (surface, stiffness) = report("ball", &Mesh::icosphere(1.0, subdivisions).unwrap(), false);
        let u: Vec<f64> = surface.points.iter().flatten().copied().collect();
        let force = applied(&stiffness, &u);
        // With μ = 1 and ε = 1, σ = 3K ε = 2 (1 + ν)/(1 − 2ν), which acts on lumped areas.
        let mut expected = vec![0.0; u.len()];
        for (facet, side) in surface.facets.iter().zip(&surface.sides) {
            for node in facet {
                for d in 0..3 {
                    expected[*node as usize * 3 + d] += side.measure / 3.0 * side.normal[d] * 2.0 * 1.3 / 0.4;
                }
            }
        }
        let error: f64 = force.iter().zip(&expected).map(|(a, b)| (a - b) * (a - b)).sum::<f64>();
        let size: f64 = expected.iter().map(|x| x * x).sum();
        errors.push((error / size).sqrt());
    }
    // The exact tractions belong to the facets. On the coarsest ball each facet is a smooth part of its own (its normals differ
    // by 41.8°); on finer ones the facets at a vertex share one traction, which approximates theirs.
    assert!(
        errors[0] < 1e-10 && errors[1..].windows(2).all(|pair| pair[1] < pair[0]) && errors[3] < 0.01,
        "{errors:?}"
    );
}

#[test]
fn a_preparation_ends_when_somebody_asks() {
    let surface = Surface::of(&Mesh::<2>::ring(0.5, 36, [0.2, 2.0], 0.1).unwrap(), false).unwrap();
    let break_off = BreakOff::default();
    break_off.ask(true);
    let ended = Stiffness::new(&surface, 0.3, false, &[], &break_off).map(|_| ());
    assert_eq!(ended, Err(Refusal::Ended {}));
    assert_eq!(break_off.prepared(), None);
}
