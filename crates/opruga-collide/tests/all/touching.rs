//! Impulses between surfaces, on rings of springs that are stepped here: contact by itself, without a world.
#![allow(missing_docs)]

use opruga_collide::{Laws, PairLaw, Touching, Trouble};
use opruga_core::contacts::Touch;
use opruga_math::Lane;
use opruga_mesh::Mesh;

/// Bodies of springs with some gas, under symplectic Euler.
struct Toy<const D: usize> {
    touching: Touching<D>,
    springs: Vec<([usize; 2], f64)>,
    stiffness: f64,
    damping: f64,
    gas: f64,
    gravity: f64,
    drag: f64,
    /// Planes: axis, position, sign of the normal.
    floor: Vec<(usize, f64, f64)>,
    mass: f64,
}

impl<const D: usize> Toy<D> {
    fn new(meshes: &[(Mesh<D>, [f64; D], [f64; D])], law: PairLaw) -> Toy<D> {
        let mut touching = Touching::<D>::default();
        let (mut springs, mass) = (Vec::new(), 0.02);
        for (number, (mesh, at, velocity)) in meshes.iter().enumerate() {
            let first = touching.surface.points();
            let nodes = touching.surface.add(mesh, number as u32);
            for n in &nodes {
                let x = mesh.positions[*n as usize];
                touching.after[0].push(core::array::from_fn(|k| x[k] + at[k]));
                touching.after[1].push(*velocity);
                touching.before[0].push([0.0; D]);
                touching.before[1].push([0.0; D]);
                touching.inverse_mass.push([1.0 / mass; D]);
            }
            let points = touching.surface.points();
            touching.inverse_mass.resize(points, [0.0; D]);
            touching.before.iter_mut().chain(&mut touching.after).for_each(|vectors| vectors.resize(points, [0.0; D]));
            let mut pairs: Vec<[u32; 2]> = mesh.wires.clone();
            pairs.extend(mesh.facets.iter().filter(|_| D == 2).map(|f| [f[0], f[1]]));
            // Every pair of nodes of a cell.
            for (_, _, cell) in mesh.cells.iter() {
                pairs.extend(cell.iter().enumerate().flat_map(|(k, a)| cell[k + 1..].iter().map(move |b| [*a, *b])));
            }
            pairs.iter_mut().for_each(|pair| pair.sort_unstable());
            pairs.sort_unstable();
            pairs.dedup();
            for [a, b] in &pairs {
                let [p, q] = [a, b].map(|n| mesh.positions[*n as usize]);
                let length = (0..D).map(|k| (p[k] - q[k]) * (p[k] - q[k])).sum::<f64>().sqrt();
                if let [Ok(a), Ok(b)] = [a, b].map(|n| nodes.binary_search(n)) {
                    springs.push(([first + a, first + b], length));
                }
            }
        }
        touching.laws = Laws {
            obstacles: 0,
            class: vec![0; meshes.len()],
            classes: 1,
            table: vec![law],
            itself: vec![true],
            rest_speed: 0.05,
            recovery_speed: 0.5,
            thickest_elsewhere: [0.0; 2],
        };
        touching.margin = 0.5 * springs[0].1;
        touching.most = 10_000_000;
        Toy {
            touching,
            springs,
            stiffness: 1600.0,
            damping: 0.6,
            gas: 0.0,
            gravity: 0.0,
            drag: 0.0,
            floor: Vec::new(),
            mass,
        }
    }

    /// Makes only the free step.
    fn free(&mut self, h: f64) {
        std::mem::swap(&mut self.touching.before, &mut self.touching.after);
        let [x, v] = &self.touching.before;
        let mut force = vec![[0.0; D]; x.len()];
        force.iter_mut().for_each(|f| f[1] = -self.gravity * self.mass);
        for ([a, b], rest) in &self.springs {
            let d: [f64; D] = core::array::from_fn(|k| x[*b][k] - x[*a][k]);
            let length = d.iter().map(|d| d * d).sum::<f64>().sqrt();
            let rate: f64 = (0..D).map(|k| (v[*b][k] - v[*a][k]) * d[k] / length).sum();
            let f = (self.stiffness * (length - rest) + self.damping * rate) / length;
            for k in 0..D {
                force[*a][k] += f * d[k];
                force[*b][k] -= f * d[k];
            }
        }
        if self.gas > 0.0 {
            let bodies = self.touching.laws.class.len();
            let mut area = vec![0.0; bodies];
            for facet in &self.touching.surface.facets {
                let [p, q] = [0, 1].map(|k| x[facet[k] as usize]);
                area[self.touching.surface.body[facet[0] as usize] as usize] += 0.5 * (p[0] * q[1] - p[1] * q[0]);
            }
            for facet in &self.touching.surface.facets {
                let [p, q] = [0, 1].map(|k| x[facet[k] as usize]);
                let pressure = self.gas / area[self.touching.surface.body[facet[0] as usize] as usize];
                for node in facet {
                    force[*node as usize][0] += 0.5 * pressure * (q[1] - p[1]);
                    force[*node as usize][1] -= 0.5 * pressure * (q[0] - p[0]);
                }
            }
        }
        let [x1, v1] = &mut self.touching.after;
        for p in 0..force.len() {
            for k in 0..D {
                v1[p][k] = (1.0 - h * self.drag) * self.touching.before[1][p][k] + h * force[p][k] / self.mass;
                x1[p][k] = self.touching.before[0][p][k] + h * v1[p][k];
            }
            for (k, bound, sign) in &self.floor {
                if sign * (x1[p][*k] - bound) < 0.0 {
                    x1[p][*k] = *bound;
                    v1[p][*k] = 0.0;
                }
            }
        }
    }

    fn step(&mut self, h: f64) {
        self.free(h);
        let floor = &self.floor;
        let obstacles = |_: u32, from: &[f64; D], to: &[f64; D], reach: f64, visit: &mut dyn FnMut(Touch<D>)| {
            for (surface, &(k, bound, sign)) in floor.iter().enumerate() {
                let gap = sign * (to[k] - bound);
                if gap <= reach {
                    let mut normal = [0.0; D];
                    normal[k] = sign;
                    visit(Touch {
                        surface,
                        gap,
                        gap_before: sign * (from[k] - bound),
                        normal,
                        carried: *from,
                        velocity: [0.0; D],
                        friction: 0.0,
                        restitution: 0.0,
                        rest_speed: 0.0,
                        rounding: 0.0,
                    });
                }
            }
        };
        let Touching { surface, after: [x, _], .. } = &mut self.touching;
        surface.follow(x);
        self.touching.step(h, Some(&obstacles)).expect("few pairs");
        let Touching { surface, after: [x, _], .. } = &mut self.touching;
        surface.follow(x);
    }

    /// Position and velocity of all nodes.
    fn nodes(&self) -> impl Iterator<Item = ([f64; D], [f64; D])> + '_ {
        let Touching { surface, after: [x, v], .. } = &self.touching;
        let nodes = (0..surface.points()).filter(|p| surface.carrier_of(*p as u32).is_none());
        nodes.map(|p| (x[p], v[p]))
    }

    fn momentum(&self) -> [f64; D] {
        let mut sum = [0.0; D];
        for (_, v) in self.nodes() {
            (0..D).for_each(|k| sum[k] += self.mass * v[k]);
        }
        sum
    }

    fn kinetic(&self) -> f64 {
        self.nodes().flat_map(|(_, v)| v).map(|v| 0.5 * self.mass * v * v).sum()
    }
}

impl Toy<2> {
    /// Pairs of edges of different bodies that cross.
    fn crossings(&self) -> usize {
        let (x, surface) = (&self.touching.after[0], &self.touching.surface);
        let side =
            |a: [f64; 2], b: [f64; 2], p: [f64; 2]| (b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]);
        let mut count = 0;
        for (j, e) in surface.facets.iter().enumerate() {
            for f in &surface.facets[j + 1..] {
                if e.iter().any(|p| f.contains(p)) {
                    continue;
                }
                let ([a, b], [c, d]) = (e.map(|p| x[p as usize]), f.map(|p| x[p as usize]));
                count += usize::from(side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0);
            }
        }
        count
    }
}

impl Toy<3> {
    /// The angular momentum about the three axes.
    fn angular_momentum(&self) -> [f64; 3] {
        let mut sum = [0.0; 3];
        for (x, v) in self.nodes() {
            (0..3).for_each(|k| {
                sum[k] += self.mass * (x[(k + 1) % 3] * v[(k + 2) % 3] - x[(k + 2) % 3] * v[(k + 1) % 3])
            });
        }
        sum
    }

    /// Pairs of facets of different bodies that cross; an inverted cell of springs crosses itself.
    fn crossings(&self) -> usize {
        let (positions, facets) = (self.touching.after[0].clone(), self.touching.surface.facets.clone());
        let body = |facet: u32| self.touching.surface.body[facets[facet as usize][0] as usize];
        let pairs = Mesh::<3> { positions, facets: facets.clone(), ..Mesh::default() }.crossing_facets().pairs;
        pairs.iter().filter(|[a, b]| body(*a) != body(*b)).count()
    }

    /// The distance along x between the nodes of two bodies that only carry points [m]; negative if they overlap.
    fn carriers_apart(&self) -> f64 {
        let Touching { surface, after: [x, _], .. } = &self.touching;
        let most = |body: usize, sign: f64| {
            let carriers = surface.points_of(body).start..surface.vertices_of(body).start;
            carriers.map(|p| sign * x[p][0]).fold(f64::NEG_INFINITY, f64::larger)
        };
        -most(1, -1.0) - most(0, 1.0)
    }
}

fn law(friction: f64, restitution: f64) -> PairLaw {
    PairLaw { touch: true, friction, restitution, thickness: 1e-3 }
}

fn ring(vertices: u32, radius: f64) -> Mesh<2> {
    Mesh::ring(radius, vertices, [0.0; 2], 0.3).expect("a ring")
}

#[test]
fn rings_meet_and_keep_momentum() {
    for friction in [0.0, 0.5] {
        let bodies = [(ring(36, 0.5), [-0.6, 0.1], [3.0, 0.0]), (ring(36, 0.5), [0.6, 0.0], [-1.0, 0.5])];
        let mut toy = Toy::new(&bodies, law(friction, 0.0));
        toy.gas = 20.0;
        let before = toy.momentum();
        let (h, mut losses) = (1.0 / 1920.0, [0.0; 4]);
        for _ in 0..1200 {
            toy.step(h);
            for loss in &toy.touching.losses {
                (0..4).for_each(|k| losses[k] += loss[k]);
            }
            assert_eq!(toy.crossings(), 0);
        }
        let after = toy.momentum();
        assert!((0..2).all(|k| (after[k] - before[k]).abs() < 1e-13), "{before:?} {after:?}");
        assert!(losses[0] > 1e-4 && (losses[1] > 1e-5) == (friction > 0.0), "{losses:?}");
        assert!(toy.touching.counts.contacts > 500, "{:?}", toy.touching.counts);
    }
}

/// A thin wire stops bodies at any speed.
#[test]
fn nothing_tunnels() {
    for speed in [1.0, 10.0, 100.0, 1000.0, 3e4, 1e5] {
        let wire = Mesh::<2>::line([0.0, -1.0], [0.0, 1.0], 40).expect("a wire");
        let dot = Mesh::<2>::line([-0.02, 0.0], [0.02, 0.015], 1).expect("a wire");
        let mut toy = Toy::new(&[(wire, [0.0; 2], [0.0; 2]), (dot, [-0.3, 0.013], [speed, 0.0])], law(0.0, 0.0));
        let h = 1e-4;
        let steps = if speed < 10.0 { 5000 } else { 600 };
        for step in 0..steps {
            let before = toy.momentum();
            toy.step(h);
            assert_eq!(toy.crossings(), 0, "{speed} m/s, step {step}");
            let after = toy.momentum();
            assert!((0..2).all(|k| (after[k] - before[k]).abs() < 1e-12 * speed), "{speed} m/s, step {step}");
        }
        let x = &toy.touching.after[0];
        assert!(toy.touching.counts.contacts > 0, "{speed} m/s: they met");
        let behind = (41..43).filter(|p| x[*p][0] > x[20][0] + 0.5).count();
        assert_eq!(behind, 0, "{speed} m/s");
    }
}

/// A fast wire hits the upper end of a long one, whose lower end thereby reaches a third one in the same step. The two wires at rest are out of reach
/// of one another before the impact.
#[test]
fn what_is_pushed_far_meets_others_in_the_same_step() {
    let fast = Mesh::<2>::line([-0.04, 0.29], [0.0, 0.3], 1).expect("a wire");
    let long = Mesh::<2>::line([0.0, -0.4], [0.0, 0.4], 1).expect("a wire");
    let third = Mesh::<2>::line([0.0, -0.39], [0.0, -0.15], 1).expect("a wire");
    let bodies = [(fast, [-0.05, 0.0], [1000.0, 0.0]), (long, [0.0; 2], [0.0; 2]), (third, [0.004, 0.0], [0.0; 2])];
    let mut toy = Toy::new(&bodies, law(0.0, 0.0));
    for step in 0..10 {
        toy.step(1e-4);
        let x = &toy.touching.after[0];
        let along = |y: f64| x[2][0] + (y - x[2][1]) / (x[3][1] - x[2][1]) * (x[3][0] - x[2][0]);
        assert!((4..6).all(|p| along(x[p][1]) < x[p][0]), "step {step}: {:?} passed through {:?}", &x[2..4], &x[4..6]);
    }
    let pushed = &toy.touching.after[1][4..6];
    assert!(pushed[0][0] + pushed[1][0] > 1.0, "{pushed:?}");
}

/// The same with wires in space, where pairs of edges meet.
#[test]
fn what_is_pushed_far_meets_edges_in_the_same_step() {
    let fast = Mesh::<3>::line([0.0, 0.3, -0.02], [0.0, 0.31, 0.02], 1).expect("a wire");
    let long = Mesh::<3>::line([0.0, -0.4, 0.0], [0.0, 0.4, 0.0], 1).expect("a wire");
    let third = Mesh::<3>::line([0.0, -0.3, -0.05], [0.0, -0.31, 0.05], 1).expect("a wire");
    let at = |x: f64, speed: f64| ([x, 0.0, 0.0], [speed, 0.0, 0.0]);
    let bodies = [(fast, at(-0.05, 1000.0)), (long, at(0.0, 0.0)), (third, at(0.004, 0.0))];
    let bodies = bodies.map(|(mesh, (at, velocity))| (mesh, at, velocity));
    let mut toy = Toy::new(&bodies, law(0.0, 0.0));
    for step in 0..10 {
        toy.step(1e-4);
        let x = &toy.touching.after[0];
        let part = (-0.305 - x[2][1]) / (x[3][1] - x[2][1]);
        let (long, third) = (x[2][0] + part * (x[3][0] - x[2][0]), 0.5 * (x[4][0] + x[5][0]));
        assert!(long < third, "step {step}: {long} is beyond {third}");
    }
    let pushed = &toy.touching.after[1][4..6];
    assert!(pushed[0][0] + pushed[1][0] > 1.0, "{pushed:?}");
}

#[test]
fn a_step_ends_early_when_somebody_asks() {
    let wire = || Mesh::<2>::line([0.0, -1.0], [0.0, 1.0], 8).expect("a wire");
    let mut toy = Toy::new(&[(wire(), [-0.05, 0.03], [1.0, 0.0]), (wire(), [0.05, 0.0], [0.0; 2])], law(0.0, 0.0));
    toy.touching.break_off.ask(true);
    assert_eq!(toy.touching.step(1e-3, None), Err(Trouble::BrokenOff));
    toy.touching.break_off.ask(false);
    assert_eq!(toy.touching.step(1e-3, None), Ok(()));
}

/// Two pinned wires that are moved through one another.
#[test]
fn what_is_led_through_is_refused() {
    let wire = || Mesh::<2>::line([0.0, -1.0], [0.0, 1.0], 8).expect("a wire");
    let mut toy = Toy::new(&[(wire(), [-0.05, 0.03], [1.0, 0.0]), (wire(), [0.05, 0.0], [0.0; 2])], law(0.0, 0.0));
    toy.touching.inverse_mass.fill([0.0; 2]);
    for step in 0..300 {
        std::mem::swap(&mut toy.touching.before, &mut toy.touching.after);
        let [x, v] = toy.touching.before.clone();
        toy.touching.after = [x.iter().zip(&v).map(|(x, v)| [x[0] + 1e-3 * v[0], x[1]]).collect(), v];
        let made = toy.touching.step(1e-3, None);
        if step < 99 {
            assert_eq!(made, Ok(()), "step {step}");
        } else if made.is_err() {
            assert!(matches!(made, Err(Trouble::LedThrough { bodies: [0, 1] | [1, 0] })), "{made:?}");
            return;
        }
    }
    panic!("they passed");
}

/// A heap of gas balls in a box comes to rest without overlap. A heap of bare springs is crushed and gains no energy.
#[test]
fn heaps_come_to_rest() {
    for (gas, friction) in [(20.0, 0.3), (0.0, 0.3), (0.0, 0.0)] {
        let mut bodies = Vec::new();
        for k in 0..12 {
            let (i, j) = (k % 3, k / 3);
            let at = [0.55 * f64::from(i) + 0.01 * f64::from(j % 2), 0.3 + 0.56 * f64::from(j)];
            bodies.push((ring(24, 0.25), at, [0.0; 2]));
        }
        let mut toy = Toy::new(&bodies, law(friction, 0.0));
        (toy.gas, toy.gravity, toy.floor) = (gas, 9.81, vec![(1, 0.0, 1.0), (0, -0.3, 1.0), (0, 1.42, -1.0)]);
        toy.drag = 4.0;
        let top = toy.mass * 9.81 * 2.5 * toy.touching.surface.points() as f64;
        // Bare springs collapse into many flat layers.
        for step in 0..(if gas > 0.0 { 8000 } else { 4500 }) {
            toy.step(1.0 / 3840.0);
            assert!(toy.kinetic() < top, "{gas}, step {step}: {} J", toy.kinetic());
            if step % 100 == 0 {
                assert_eq!(toy.crossings(), 0, "{gas} {friction}, step {step}");
            }
        }
        assert!(toy.kinetic() < if gas > 0.0 { 0.01 } else { 3.0 }, "{gas}: {} J", toy.kinetic());
    }
}

/// Cubes of springs in space, dropped on one another.
#[test]
fn cubes_stack() {
    let cube = || Mesh::<3>::grid([0.0; 3], [0.5; 3], [2, 2, 2]).expect("a cube");
    let bodies = [
        (cube(), [0.0, 0.0, 0.0], [0.0; 3]),
        (cube(), [0.11, 0.52, 0.07], [0.0; 3]),
        (cube(), [0.02, 1.1, 0.0], [0.0; 3]),
    ];
    let mut toy = Toy::new(&bodies, law(0.5, 0.0));
    (toy.gravity, toy.drag, toy.floor) = (9.81, 2.0, vec![(1, 0.0, 1.0)]);
    (toy.stiffness, toy.damping) = (400.0, 0.5);
    for _ in 0..8000 {
        toy.step(1.0 / 1920.0);
    }
    let low = |b: usize| {
        let all = toy.touching.surface.points_of(b).map(|p| toy.touching.after[0][p][1]);
        all.fold(9.0, |a, y| if y < a { y } else { a })
    };
    assert!(toy.kinetic() < 1e-4, "{} J", toy.kinetic());
    assert!((low(1) - 0.5).abs() < 0.03 && (low(2) - 1.0).abs() < 0.06, "{} {}", low(1), low(2));
}

/// The stored bounds of pairs save checks in later steps and change no bit: bodies without bounds from previous steps give the
/// same result.
#[test]
fn what_is_known_of_distances_changes_no_bits() {
    fn compare<const D: usize>(make: impl Fn() -> Toy<D>, h: f64, steps: usize) {
        let [mut knowing, mut ignorant] = [make(), make()];
        for step in 0..steps {
            // Neither of the two starts with impulses of the previous step, because the other one would not have them.
            knowing.touching.begin();
            let old = std::mem::take(&mut ignorant.touching);
            let fresh = &mut ignorant.touching;
            (fresh.surface, fresh.laws, fresh.inverse_mass) = (old.surface, old.laws, old.inverse_mass);
            (fresh.before, fresh.after) = (old.before, old.after);
            (fresh.margin, fresh.most) = (old.margin, old.most);
            knowing.step(h);
            ignorant.step(h);
            assert_eq!(knowing.touching.after, ignorant.touching.after, "step {step}");
        }
        let counts = knowing.touching.counts;
        assert!(3 * counts.searches < steps as u64 && counts.contacts > 0, "{counts:?}");
    }
    let heap = || {
        let place = |k: u32| [0.55 * f64::from(k % 3) + 0.01 * f64::from(k / 3), 0.3 + 0.56 * f64::from(k / 3)];
        let bodies: Vec<_> = (0..6).map(|k| (ring(24, 0.25), place(k), [0.0; 2])).collect();
        let mut toy = Toy::new(&bodies, law(0.3, 0.2));
        (toy.gas, toy.gravity, toy.floor) = (8.0, 9.81, vec![(1, 0.0, 1.0), (0, -0.3, 1.0), (0, 1.42, -1.0)]);
        toy
    };
    compare(heap, 1.0 / 1920.0, 1000);
    let stack = || {
        let cube = || Mesh::<3>::grid([0.0; 3], [0.5; 3], [3, 3, 3]).expect("a cube");
        let bodies = [(cube(), [0.0; 3], [0.0; 3]), (cube(), [0.11, 0.52, 0.07], [0.3, -1.0, 0.2])];
        let mut toy = Toy::new(&bodies, law(0.5, 0.0));
        (toy.gravity, toy.stiffness, toy.floor) = (9.81, 120.0, vec![(1, 0.0, 1.0)]);
        toy
    };
    compare(stack, 1.0 / 1920.0, 500);
}

/// Bodies that have come to rest keep no candidates of a motion relative to one another.
#[test]
fn candidates_of_a_flight_are_dropped_at_rest() {
    // The boxes of neighbours overlap, the neighbours do not.
    let speed = |k: u32| if k.is_multiple_of(2) { 40.0 } else { -40.0 };
    let at = |k: u32| [0.4 * f64::from(k); 2];
    let bodies: Vec<_> = (0..5).map(|k| (ring(24, 0.25), at(k), [speed(k), -speed(k)])).collect();
    let mut toy = Toy::new(&bodies, law(0.0, 0.0));
    let candidates = |toy: &mut Toy<2>| {
        let before = toy.touching.counts.candidates;
        toy.step(1e-3);
        toy.touching.counts.candidates - before
    };
    let flying = candidates(&mut toy);
    toy.touching.after[1].iter_mut().for_each(|v| *v = [0.0; 2]);
    let resting = candidates(&mut toy);
    assert!(resting < flying / 2, "{flying} in flight, {resting} at rest");
}

/// A common motion of all bodies requires no further searches and few further candidates.
#[test]
fn bodies_that_fly_together_have_the_candidates_of_bodies_at_rest() {
    let costs = [[0.0; 2], [30.0, -20.0]].map(|common: [f64; 2]| {
        let velocity = |k: u32| [common[0] + if k == 2 { -0.5 } else { 0.0 }, common[1]];
        let bodies: Vec<_> = (0..5).map(|k| (ring(24, 0.25), [0.51 * f64::from(k), 0.0], velocity(k))).collect();
        let mut toy = Toy::new(&bodies, law(0.0, 0.0));
        (0..200).for_each(|_| toy.step(1e-3));
        let counts = toy.touching.counts;
        assert!(counts.candidates > 0 && counts.contacts > 0, "{counts:?}");
        (counts.searches, counts.candidates)
    });
    let [(searches, candidates), (searches_in_flight, candidates_in_flight)] = costs;
    assert!(searches_in_flight <= searches + 2 && candidates_in_flight < 2 * candidates, "{costs:?}");
}

/// The last vertices of a body with so many vertices that several threads measure its motion meet another body.
#[test]
fn the_last_of_many_vertices_meet() {
    let angle = 0.3 + core::f64::consts::TAU * 0.9;
    let direction = [libm::cos(angle), libm::sin(angle)];
    let results = [1, 3].map(|threads| {
        let bodies = [
            (ring(5000, 0.25), [0.0; 2], [0.0; 2]),
            (ring(24, 0.25), direction.map(|c| 0.501 * c), direction.map(|c| -c)),
        ];
        let mut toy = Toy::new(&bodies, law(0.0, 0.0));
        toy.stiffness = 0.0;
        toy.touching.threads = threads;
        (0..40).for_each(|_| toy.step(1e-4));
        assert!(toy.touching.counts.contacts > 0, "{:?}", toy.touching.counts);
        toy.touching.after.clone()
    });
    assert!(results[0] == results[1]);
    let moved = (0..5000).filter(|k| libm::hypot(results[0][1][*k][0], results[0][1][*k][1]) > 0.1);
    let moved: Vec<usize> = moved.collect();
    assert!(!moved.is_empty() && moved.iter().all(|k| (4100..4900).contains(k)), "{moved:?}");
}

/// Points that nodes carry pass impulses on to these nodes: momentum and angular momentum are conserved, and nothing crosses.
#[test]
fn carried_points_meet() {
    let ball = || Mesh::<3>::icosphere(0.5, 2).expect("a ball").lattice_filling(0.25).expect("a lattice");
    let cube = || Mesh::<3>::grid([-0.5; 3], [1.0; 3], [2; 3]).expect("a cube");
    for (name, bodies, h) in [
        ("cubes", [cube(), cube()], 1.0 / 960.0),
        ("skins", [ball(), ball()], 1.0 / 960.0),
        ("a cube and a skin", [cube(), ball()], 1.0 / 960.0),
        ("long steps", [ball(), ball()], 1.0 / 120.0),
    ] {
        let [a, b] = bodies;
        let mut toy = Toy::new(
            &[(a, [-0.7, 0.13, 0.05], [1.0, 0.1, 0.0]), (b, [0.7, 0.0, 0.0], [-2.0, 0.0, 0.2])],
            law(0.0, 0.0),
        );
        (toy.stiffness, toy.damping) = if h < 0.002 { (40.0, 0.02) } else { (10.0, 0.02) };
        toy.step(h);
        let (before, turning) = (toy.momentum(), toy.angular_momentum());
        let mut nearest = f64::INFINITY;
        for step in 0..(0.6 / h) as usize {
            toy.step(h);
            assert_eq!(toy.crossings(), 0, "{name}, step {step}");
            nearest = nearest.smaller(toy.carriers_apart());
        }
        assert!(toy.touching.counts.contacts > 0, "{name}: they met");
        let after = toy.momentum();
        assert!((0..3).all(|k| (after[k] - before[k]).abs() < 1e-13), "{name}: {before:?} {after:?}");
        let turned = toy.angular_momentum();
        // Overlaps are removed by positions only, which rotates moving bodies; pairs that move far get their impulse where they
        // meet.
        let exact = if h < 0.002 { 1e-5 } else { f64::INFINITY };
        assert!((0..3).all(|k| (turned[k] - turning[k]).abs() < exact), "{name}: {turning:?} {turned:?}");
        // The nodes that carry a skin extend beyond it.
        assert!(name == "cubes" || nearest < -0.01 || name == "a cube and a skin", "{name}: {nearest} m");
    }
}

/// Candidates, gaps, sets of contacts, contacts with walls and passages of many rings that fill a box are divided among threads.
#[test]
fn threads_change_no_bit_of_many_rings() {
    let run = |threads: usize| {
        let at = |k: i32| [0.51 * f64::from(k % 20) + 0.005 * f64::from(k / 20 % 3), 0.3 + 0.51 * f64::from(k / 20)];
        let bodies: Vec<_> = (0..480).map(|k| (ring(36, 0.25), at(k), [0.0; 2])).collect();
        let mut toy = Toy::new(&bodies, law(0.3, 0.0));
        (toy.gas, toy.gravity, toy.touching.threads) = (60.0, 9.81, threads);
        toy.floor = vec![(1, 0.0, 1.0), (0, -0.26, 1.0), (0, 0.51 * 19.0 + 0.27, -1.0)];
        (0..200).for_each(|_| toy.step(1.0 / 1920.0));
        let counts = toy.touching.counts;
        assert!(counts.candidates > 4096 * counts.steps && counts.contacts > 2048 * counts.steps, "{counts:?}");
        toy.touching.after.iter().flatten().flatten().map(|c| c.to_bits()).collect::<Vec<_>>()
    };
    let one = run(1);
    assert!(run(2) == one && run(5) == one);
}
