//! The barrier: forces are derivatives of its energy, and nothing passes through it.

use opruga_collide::{Barrier, Laws, PairLaw, Pressed, Surface};
use opruga_math::{Lane, Simd};
use opruga_mesh::Mesh;

const REACH: f64 = 0.1;

fn laws(friction: f64) -> Laws {
    let law = PairLaw { touch: true, friction, restitution: 0.0, thickness: 0.01 };
    Laws {
        class: vec![0, 0],
        classes: 1,
        obstacles: 0,
        table: vec![law],
        itself: vec![false],
        rest_speed: 0.0,
        recovery_speed: 0.0,
        thickest_elsewhere: [0.0; 2],
    }
}

/// Numbers between −1 and 1 that look random.
fn random(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

/// Two blocks one above the other at a distance, with all nodes displaced slightly, the upper one rotated about the vertical.
fn blocks<const D: usize>(apart: f64, angle: f64, seed: &mut u64) -> (Surface<D>, Vec<[f64; D]>) {
    let mesh = Mesh::<D>::grid([-0.5; D], [1.0; D], [1; D]).expect("a grid");
    let mut surface = Surface::default();
    let mut x = Vec::new();
    for body in 0..2 {
        for node in surface.add(&mesh, body) {
            let mut at = mesh.positions[node as usize];
            if body == 1 && D == 3 {
                let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
                (at[0], at[2]) = (cosine * at[0] - sine * at[2], sine * at[0] + cosine * at[2]);
            }
            at[1] += if body == 1 { 1.0 + apart } else { 0.0 };
            at.iter_mut().for_each(|c| *c += 0.01 * random(seed));
            x.push(at);
        }
        x.resize(surface.points(), [0.0; D]);
        surface.follow(&mut x);
    }
    (surface, x)
}

fn barrier<const D: usize>(surface: &Surface<D>, x: &[[f64; D]], seed: &mut u64) -> Barrier<D> {
    let mut barrier = Barrier::new(REACH, Simd::best());
    barrier.softness = (0..surface.points()).map(|_| 1e-3 * (2.0 + random(seed))).collect();
    barrier.look(surface, &laws(0.5), [x, x], 1000).expect("few pairs");
    barrier
}

fn pressed<const D: usize>(barrier: &Barrier<D>, surface: &Surface<D>, x: &[[f64; D]]) -> Vec<Pressed<D>> {
    let mut out = Vec::new();
    barrier.press(surface, &laws(0.5), x, &mut out).expect("apart");
    out
}

fn forces_are_the_gradient<const D: usize>(angle: f64) {
    let mut seed = 5;
    for apart in [0.04, 0.06, 0.09] {
        let (surface, x) = blocks::<D>(apart, angle, &mut seed);
        let barrier = barrier(&surface, &x, &mut seed);
        let pairs = pressed(&barrier, &surface, &x);
        assert!(!pairs.is_empty());
        let mut force = vec![[0.0; D]; x.len()];
        for pair in &pairs {
            for k in 0..4 {
                let to = &mut force[pair.points[k] as usize];
                for d in 0..D {
                    to[d] += pair.force * pair.weights[k] * pair.normal[d] - pair.fading[k][d];
                }
            }
        }
        let size = force.iter().flatten().fold(0.0_f64, |most, f| f.abs().larger(most));
        for p in 0..x.len() {
            for d in 0..D {
                let energy = |by: f64| {
                    let mut x = x.clone();
                    x[p][d] += by;
                    pressed(&barrier, &surface, &x).iter().map(|pair| pair.energy).sum::<f64>()
                };
                let step = 1e-6;
                let slope = (energy(step) - energy(-step)) / (2.0 * step);
                assert!((slope + force[p][d]).abs() < 1e-5 * size, "{apart}: {p} {d}: {slope} {}", force[p][d]);
            }
        }
    }
}

#[test]
fn forces_are_the_gradient_of_the_energy_in_the_plane() {
    forces_are_the_gradient::<2>(0.0);
}

/// Tests edges at an angle, and nearly parallel edges, which fade out.
#[test]
fn forces_are_the_gradient_of_the_energy_in_space() {
    forces_are_the_gradient::<3>(0.3);
    forces_are_the_gradient::<3>(0.01);
}

/// At the end of the reach of the barrier, energy, force and curvature are zero. They grow as the gap closes.
#[test]
fn the_barrier_has_two_continuous_derivatives_and_no_bound() {
    let at = |gap: f64| {
        let mut surface = Surface::<2>::default();
        let wire = Mesh::<2>::grid([0.0; 2], [1.0; 2], [1; 2]).expect("a grid");
        surface.add(&wire, 0);
        surface.add(&wire, 1);
        let mut x = wire.positions.clone();
        // A corner over the middle of the upper side.
        x.extend([[0.5, 1.01 + gap], [1.5, 2.5], [-0.5, 2.5], [0.5, 3.5]]);
        let mut barrier = Barrier::new(REACH, Simd::best());
        barrier.softness = vec![1e-3; x.len()];
        barrier.look(&surface, &laws(0.0), [&x, &x], 1000).expect("few pairs");
        let pairs = pressed(&barrier, &surface, &x);
        pairs.iter().fold([0.0; 3], |[e, f, c], pair| [e + pair.energy, f + pair.force, c + pair.curvature])
    };
    assert_eq!(at(1.001 * REACH), [0.0; 3]);
    // Near the end b = (r − g)³/r; both features have a compliance of 1e-3 m/N.
    let (stiffness, left) = (500.0, 0.001 * REACH);
    let wanted = [left * left * left, 3.0 * left * left, 6.0 * left].map(|part| stiffness * part / REACH);
    let now = at(REACH - left);
    assert!((0..3).all(|i| (now[i] / wanted[i] - 1.0).abs() < 0.01), "{now:?} {wanted:?}");
    let mut last = [0.0; 3];
    let mut gap = REACH;
    for k in 1..12 {
        gap *= 0.5;
        let now = at(gap);
        assert!((0..3).all(|i| now[i] > last[i]), "{k}: {now:?} {last:?}");
        last = now;
    }
    assert!(last[2] > 1e5);
}

/// Whatever the motion, points move only so far that no pair meets.
#[test]
fn the_free_part_of_a_motion_keeps_pairs_apart() {
    let mut seed = 3;
    for round in 0..40 {
        let (surface, x) = blocks::<3>(0.05, 0.4, &mut seed);
        let mut barrier = barrier(&surface, &x, &mut seed);
        let y: Vec<[f64; 3]> = x
            .iter()
            .enumerate()
            .map(|(p, at)| {
                let up = if p < 8 { 1.0 } else { -2.0 };
                [at[0] + random(&mut seed), at[1] + up + random(&mut seed), at[2] + random(&mut seed)]
            })
            .collect();
        barrier.look(&surface, &laws(0.5), [&x, &y], 1_000_000).expect("pairs");
        let part = barrier.free_part(&surface, &laws(0.5), [&x, &y]);
        assert!(part > 0.0 && part < 1.0, "{round}: {part}");
        let there: Vec<[f64; 3]> =
            x.iter().zip(&y).map(|(a, b)| std::array::from_fn(|d| a[d] + part * (b[d] - a[d]))).collect();
        assert!(pressed(&barrier, &surface, &there).iter().all(|pair| pair.gap > 0.0), "{round}");
    }
}

/// The friction force is the derivative of its energy, and at most µ N.
#[test]
fn friction_is_the_derivative_of_its_energy() {
    let mut seed = 9;
    let (surface, x) = blocks::<3>(0.04, 0.3, &mut seed);
    let barrier = barrier(&surface, &x, &mut seed);
    for pair in pressed(&barrier, &surface, &x) {
        let most = pair.friction * pair.force;
        let rub = pair.rubbing([0.3 * most, 0.0, 0.2 * most], 1.0);
        for size in [0.1, 5.0] {
            let mut moved = vec![[0.0; 3]; x.len()];
            for p in pair.points {
                moved[p as usize] = std::array::from_fn(|_| size * most / rub.stiffness * random(&mut seed));
            }
            let slip = rub.slip(&moved);
            let force = rub.force(&slip);
            assert!(force.iter().map(|f| f * f).sum::<f64>().sqrt() <= most * (1.0 + 1e-12));
            let step = 1e-6 * most / rub.stiffness;
            for d in 0..3 {
                let mut motion = [0.0; 3];
                motion[d] = step;
                let along: f64 = motion.iter().zip(&pair.normal).map(|(m, n)| m * n).sum();
                let across: [f64; 3] = std::array::from_fn(|i| motion[i] - along * pair.normal[i]);
                let by = |sign: f64| std::array::from_fn(|i| slip[i] + sign * across[i]);
                let slope = (rub.energy(&by(1.0)) - rub.energy(&by(-1.0))) / 2.0;
                let wanted: f64 = -force.iter().zip(&across).map(|(f, a)| f * a).sum::<f64>();
                assert!((slope - wanted).abs() < 1e-6 * most * step, "{slope} {wanted}");
                let change: [f64; 3] =
                    std::array::from_fn(|i| (rub.force(&by(-1.0))[i] - rub.force(&by(1.0))[i]) / 2.0);
                let stiff = rub.stiffen(&slip, &motion);
                let error: f64 = change.iter().zip(&stiff).map(|(a, b)| (a - b).abs()).sum();
                assert!(error < 1e-4 * rub.stiffness * step, "{change:?} {stiff:?}");
            }
        }
    }
}
