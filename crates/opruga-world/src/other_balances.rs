//! Bodies of finite elements that end in an equilibrium other than their own shape.
//!
//! A body may come to rest folded, inverted, contracted to a point or snapped through, although no present force would take it there. The cells do
//! not show this: an arch that has snapped through consists of good cells. The energy shows it. Let fᵢ = ∂U/∂xᵢ be the forces that hold the shape
//! against its cells, and yᵢ the rest shape, moved as a rigid body to its best fit. A convex energy satisfies U ≤ Σ fᵢ·(xᵢ − yᵢ) ≤ Σ |fᵢ| |xᵢ − yᵢ|.
//! The energy of solids that rotate is not convex. Nevertheless, bodies that are bent or stretched from outside have large displacements and satisfy
//! the bound. U is at most half of this bound at small strain, and a small part of it in bending with large rotations. A folded body, in contrast,
//! keeps its energy although the forces on it are small, or act at nodes that have hardly moved.
//!
//! The best fit is the least-squares fit with the weights |fᵢ|: it places the rest shape where something holds the body.
//!
//! Pins that move nodes do work along their whole path, whatever the distance between its ends. A bar that was twisted by three full turns stores the
//! work of its pins, although its ends have the same positions as at rest. The length sᵢ of the path of a node that pins have moved is measured after
//! a rigid motion of all pins is subtracted. If sᵢ is longer than |xᵢ − yᵢ|, the node therefore counts with sᵢ. If the forces grew along the path, U
//! ≤ Σ |fᵢ| sᵢ. Because the forces may also have decreased along it, up to 2 sᵢ is allowed.

use crate::pin_travel::travel_lengths;
use crate::warnings::{Warning, WorldWarning};
use crate::world::World;
use opruga_core::potential::Properties;
use opruga_core::spec::Role;
use opruga_core::state::{Columns, Layout, View};
use opruga_core::system::{Stage, System};
use opruga_core::tile::Tile;
use opruga_math::{Column, Lane, WIDTH, sum_in_fixed_order};
use opruga_solve::dense::symmetric_eigen;
use std::collections::BTreeMap;

/// The kinetic energy beyond a rigid motion below which a body counts as being at rest, relative to the stored energy.
const REST: f64 = 1e-2;

/// A cell counts as strained if its volume, or the distance of two of its nodes, has changed by more than this fraction.
const STRAINED: f64 = 1e-3;

/// The weight of all masses together in the fit, relative to a weight of 1 for all forces. This weight makes the fit unique if the forces do not.
const LITTLE: f64 = 1e-6;

/// The largest ratio of the mean force along the path of a pinned node to the force at its end. The force may decrease along the path if a law
/// softens or a body buckles.
const FALLEN: f64 = 2.0;

/// A vector; in the plane the last number is zero.
type Vector = [f64; 3];

/// A body in another equilibrium.
struct Unaccounted {
    body: usize,
    /// The energy of its cells [J], and the part of it that the forces on the body account for [J].
    energy: f64,
    accounted: f64,
}

/// A node of a body.
struct Node {
    rest: Vector,
    now: Vector,
    velocity: Vector,
    force: Vector,
    mass: f64,
    /// The length of the path along which pins have moved the node [m].
    led: f64,
}

impl<const D: usize> World<D> {
    /// The warnings so far, and warnings about the shapes in the present state: [`World::inverted_cells`] and [`World::other_balances`]. This method
    /// is meant for the end of a run, because every call examines the shapes again.
    pub fn warnings_at_the_end(&self) -> Vec<Warning> {
        let shapes = self.inverted_cells().into_iter().chain(self.other_balances());
        self.warnings().into_iter().chain(self.shape_warnings()).chain(shapes).collect()
    }

    /// A warning (`cells.other_balance`) about bodies of finite elements that are nearly at rest and contain more energy than the forces on them
    /// account for, measured from their own rest shape. Such bodies have snapped through, or are folded, inverted or twisted. None if there is no
    /// such body. Every call computes it again.
    ///
    /// Let fᵢ be the forces that hold the shape [N], and yᵢ the rest shape, moved as a rigid body to the best fit with the present positions xᵢ. A
    /// body is reported if its energy is more than Σ |fᵢ| |xᵢ − yᵢ|. If loads, pins, obstacles or gas have deformed a body and its strain is small,
    /// its energy is at most half of this sum. Bodies of the material `linear`, which has only one shape without energy, are never reported.
    pub fn other_balances(&self) -> Option<Warning> {
        let mut found: Vec<Unaccounted> = Vec::new();
        for island in &self.islands {
            let there = |body: &&usize| self.handle(**body).is_some() && self.is_judged(**body);
            let bodies: Vec<usize> = island.bodies.iter().filter(there).copied().collect();
            if bodies.is_empty() {
                continue;
            }
            let Some((energies, forces)) = elastic(&island.system, self.time()) else { continue };
            for body in bodies {
                let energy = energies[self.locations[body].1];
                let nodes = self.nodes_of(body, &forces);
                if !(energy > 0.0 && beyond_whole(&nodes, D) <= REST * energy) {
                    continue;
                }
                let accounted = accounted(&nodes, D);
                if energy > accounted && self.is_strained(body, &nodes) {
                    found.push(Unaccounted { body, energy, accounted });
                }
            }
        }
        let count = found.len() as u64;
        let Unaccounted { body, energy, accounted } = found.into_iter().min_by_key(|one| one.body)?;
        let cells = self.cell_states(body);
        let (mut volume, mut rest, mut worst) = (0.0, 0.0, (0, 1.0_f64));
        for cell in &cells {
            volume += cell.volume_ratio * cell.measure;
            rest += cell.measure;
            if (cell.smallest_volume_ratio - 1.0).abs() > (worst.1 - 1.0).abs() {
                worst = (cell.cell, cell.smallest_volume_ratio);
            }
        }
        let warning = WorldWarning::OtherBalance {
            time: self.time(),
            count,
            body: self.blueprint.bodies[body].name.clone(),
            energy,
            accounted,
            volume: volume / rest,
            cell: worst.0,
            ratio: worst.1,
            unfold: self.or_unfold(),
        };
        Some(Warning::new(warning, count))
    }

    /// Whether a body has finite elements, or a model whose forces rotate with the body, and no law of small strain. Such a law has a single shape
    /// without energy and no other equilibrium.
    fn is_judged(&self, body: usize) -> bool {
        let models = self.blueprint.bodies[body].models.iter();
        let mut solids = models.filter(|model| model.spec().has_role(Role::OwnsCells)).peekable();
        let members = &self.islands[self.locations[body].0].system.members;
        let turns = members.iter().any(|member| member.potential.properties().acts_between_nodes == Some(true));
        (turns || solids.peek().is_some()) && solids.all(|model| model.text("material") != Some("linear"))
    }

    fn nodes_of(&self, body: usize, forces: &Columns<D>) -> Vec<Node> {
        let (island, lane) = self.locations[body];
        let system = &self.islands[island].system;
        let layout = system.layout;
        let mesh = &self.blueprint.bodies[body].mesh;
        let mut led = vec![0.0; mesh.positions.len()];
        let node_at: BTreeMap<usize, usize> = (0..led.len()).map(|node| (layout.index(node, lane), node)).collect();
        let pins: Vec<_> = system.pins.iter().filter(|pin| node_at.contains_key(&pin.index)).collect();
        for (pin, travel) in pins.iter().zip(travel_lengths(&pins, system.time)) {
            let led = &mut led[node_at[&pin.index]];
            *led = led.larger(travel);
        }
        let of = |node: (usize, &[f64; D])| Node {
            rest: in_space(node.1),
            now: in_space(&self.position(body, node.0 as u32)),
            velocity: in_space(&self.velocity(body, node.0 as u32)),
            force: in_space(&forces.at(layout.index(node.0, lane))),
            mass: self.node_mass(body, node.0 as u32),
            led: led[node.0],
        };
        mesh.positions.iter().enumerate().map(of).collect()
    }

    /// Whether any cell has a shape that differs from its rest shape.
    fn is_strained(&self, body: usize, nodes: &[Node]) -> bool {
        let strained = |ratio: f64| (ratio - 1.0).abs() > STRAINED;
        let mesh = &self.blueprint.bodies[body].mesh;
        let drawn = mesh.cells.iter().any(|(_, _, cell)| {
            let pairs =
                cell.iter().enumerate().flat_map(|(k, a)| cell[..k].iter().map(move |b| (*a as usize, *b as usize)));
            pairs.into_iter().any(|(a, b)| {
                let (a, b) = (&nodes[a], &nodes[b]);
                strained(length(&less(&a.now, &b.now)) / length(&less(&a.rest, &b.rest)))
            })
        });
        drawn || self.cell_states(body).iter().any(|cell| strained(cell.smallest_volume_ratio))
    }
}

/// The energies [J] of the models by which the bodies of a system are judged, and the forces [N] of these models on all nodes at zero velocity;
/// `None` if these are not defined.
fn elastic<const D: usize>(system: &System<D>, time: f64) -> Option<([f64; WIDTH], Columns<D>)> {
    let still = Columns::<D>::zeros(system.index_count());
    let mut forces = Columns::<D>::zeros(system.index_count());
    let view = View { v: still.slices(), threads: 1, ..system.view(Stage::Current, time) };
    let mut energies = [0.0; WIDTH];
    let is_asked = |properties: Properties| properties.judges_balance || properties.acts_between_nodes == Some(true);
    for member in system.members.iter().filter(|member| is_asked(member.potential.properties())) {
        let mut scratch = Column::zeros(member.potential.properties().scratch_len);
        member.potential.prepare(system.simd, &view, &member.memory, &mut scratch).ok()?;
        let energy = member.potential.energy(system.simd, &view, &scratch);
        match system.layout {
            Layout::Single => energies[0] += sum_in_fixed_order(&energy),
            Layout::Batch => (0..WIDTH).for_each(|lane| energies[lane] += energy[lane]),
        }
        let mut tile = Tile {
            range: 0..system.index_count(),
            force: forces.0.each_mut().map(|column| &mut **column),
            power: &mut [0.0; WIDTH],
            weight: None,
            slots: &mut Column::default(),
        };
        member.potential.add_force(system.simd, &view, &scratch, &mut tile);
    }
    Some((energies, forces))
}

/// Σ |fᵢ| |xᵢ − yᵢ| [J], where yᵢ is the rest shape moved as a rigid body to its best fit; for nodes moved by pins, the length of their path is used
/// if it is longer.
fn accounted(nodes: &[Node], dimension: usize) -> f64 {
    let (mut forces, mut mass) = (0.0, 0.0);
    for node in nodes {
        forces += length(&node.force);
        mass += node.mass;
    }
    let share = |part: f64, whole: f64| if whole > 0.0 { part / whole } else { 0.0 };
    let weight = |node: &Node| share(length(&node.force), forces) + LITTLE * share(node.mass, mass);
    let (mut all, mut rest, mut now) = (0.0, [0.0; 3], [0.0; 3]);
    for node in nodes {
        let w = weight(node);
        all += w;
        add(&mut rest, w, &node.rest);
        add(&mut now, w, &node.now);
    }
    let (rest, now) = (rest.map(|x| x / all), now.map(|x| x / all));
    // Σ w X xᵀ about the centres of mass.
    let mut moments = [[0.0; 3]; 3];
    for node in nodes {
        let (from, to) = (less(&node.rest, &rest), less(&node.now, &now));
        for (row, from) in moments.iter_mut().zip(from) {
            add(row, weight(node) * from, &to);
        }
    }
    let turn = if dimension == 2 { turn_in_plane(&moments) } else { turn_in_space(&moments) };
    let distance = |node: &Node| {
        let (from, to) = (less(&node.rest, &rest), less(&node.now, &now));
        length(&core::array::from_fn(|d| to[d] - dot(&turn[d], &from)))
    };
    nodes.iter().map(|node| length(&node.force) * distance(node).larger(FALLEN * node.led)).sum()
}

/// The rotation in the plane that takes X closest to x, from Σ w X xᵀ.
pub(crate) fn turn_in_plane(moments: &[[f64; 3]; 3]) -> [Vector; 3] {
    let (along, across) = (moments[0][0] + moments[1][1], moments[0][1] - moments[1][0]);
    let size = (along * along + across * across).sqrt();
    let (c, s) = if size > 0.0 { (along / size, across / size) } else { (1.0, 0.0) };
    [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
}

/// The rotation in space that takes X closest to x, from Σ w X xᵀ. Its quaternion is the eigenvector of Horn's matrix with the largest eigenvalue
/// (Horn 1987).
pub(crate) fn turn_in_space(m: &[[f64; 3]; 3]) -> [Vector; 3] {
    let trace = m[0][0] + m[1][1] + m[2][2];
    let mut matrix = [0.0; 16];
    matrix[0] = trace;
    for d in 0..3 {
        let (e, f) = ((d + 1) % 3, (d + 2) % 3);
        matrix[d + 1] = m[e][f] - m[f][e];
        matrix[(d + 1) * 4] = matrix[d + 1];
        for g in 0..3 {
            matrix[(d + 1) * 4 + g + 1] = m[d][g] + m[g][d] - if d == g { trace } else { 0.0 };
        }
    }
    let (_, vectors) = symmetric_eigen(&matrix, 4);
    let Some([w, q @ ..]) = vectors.last().map(Vec::as_slice) else { unreachable!("four vectors") };
    let cross = |d: usize, e: usize| match (e + 3 - d) % 3 {
        0 => 0.0,
        1 => -q[(d + 2) % 3],
        _ => q[(d + 1) % 3],
    };
    let unit = |d: usize, e: usize| if d == e { 1.0 } else { 0.0 };
    let square = q.iter().map(|x| x * x).sum::<f64>();
    // R = (w² − q²) 1 + 2 q qᵀ + 2 w [q]×.
    core::array::from_fn(|d| {
        core::array::from_fn(|e| (w * w - square) * unit(d, e) + 2.0 * q[d] * q[e] + 2.0 * w * cross(d, e))
    })
}

/// The kinetic energy beyond the energy of the rigid motion nearest to the velocities [J].
fn beyond_whole(nodes: &[Node], dimension: usize) -> f64 {
    let (mut mass, mut center, mut speed) = (0.0, [0.0; 3], [0.0; 3]);
    for node in nodes {
        mass += node.mass;
        add(&mut center, node.mass, &node.now);
        add(&mut speed, node.mass, &node.velocity);
    }
    let (center, speed) = (center.map(|x| x / mass), speed.map(|x| x / mass));
    let (mut inertia, mut momentum) = ([0.0; 9], [0.0; 3]);
    for node in nodes {
        let arm = less(&node.now, &center);
        add(&mut momentum, node.mass, &cross(&arm, &less(&node.velocity, &speed)));
        for d in 0..3 {
            inertia[d * 4] += node.mass * dot(&arm, &arm);
            for e in 0..3 {
                inertia[d * 3 + e] -= node.mass * arm[d] * arm[e];
            }
        }
    }
    let (values, vectors) = symmetric_eigen(&inertia, 3);
    // A body whose nodes are on a line has no moment of inertia about that line.
    let least = 1e-9 * values.last().copied().unwrap_or(0.0);
    let mut spin = [0.0; 3];
    for (value, vector) in values.iter().zip(&vectors).filter(|(value, _)| **value > least) {
        let vector: Vector = core::array::from_fn(|d| vector[d]);
        add(&mut spin, dot(&vector, &momentum) / value, &vector);
    }
    if dimension == 2 {
        spin = [0.0, 0.0, spin[2]];
    }
    let mut kinetic = 0.0;
    for node in nodes {
        let whole = cross(&spin, &less(&node.now, &center));
        let own = less(&less(&node.velocity, &speed), &whole);
        kinetic += 0.5 * node.mass * dot(&own, &own);
    }
    kinetic
}

pub(crate) fn in_space<const D: usize>(x: &[f64; D]) -> Vector {
    core::array::from_fn(|d| if d < D { x[d] } else { 0.0 })
}

fn dot(a: &Vector, b: &Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: &Vector) -> f64 {
    dot(a, a).sqrt()
}

fn less(a: &Vector, b: &Vector) -> Vector {
    core::array::from_fn(|d| a[d] - b[d])
}

fn add(to: &mut Vector, times: f64, what: &Vector) {
    (0..3).for_each(|d| to[d] += times * what[d]);
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    core::array::from_fn(|d| a[(d + 1) % 3] * b[(d + 2) % 3] - a[(d + 2) % 3] * b[(d + 1) % 3])
}
