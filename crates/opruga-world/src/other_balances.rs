//! Bodies of finite elements that end in another balance than that of their own shape.
//!
//! A body may come to rest folded, inside out, drawn together to a point or snapped through, though nothing that acts on it now
//! would take it there. That is no question of its cells: an arch that has snapped through is made of good ones. It is one of
//! energy. With the forces fᵢ = ∂U/∂xᵢ that hold the shape against its cells, and the rest shape moved as a whole to where it fits
//! best, yᵢ, a convex energy is U ≤ Σ fᵢ·(xᵢ − yᵢ) ≤ Σ |fᵢ| |xᵢ − yᵢ|. Solids that turn have no convex energy, but what is bent or
//! drawn from outside has long ways and keeps within that: at small strain U is half of it at most, in bending with large rotations
//! a small part. A folded body holds its energy by itself, by forces that are small or act where its own shape would lie too.
//!
//! The best fit is that of least squares with the weights |fᵢ|: it lays the rest shape to where something holds the body.
//!
//! Pins that lead nodes have done work all along their ways, whatever lies between the ends of these: a bar that they have turned
//! three times round holds what they gave, though its ends lie where those of the bar at rest do. A node that was led counts with the
//! way that it has gone, beyond one of all pins as a whole, where that is longer: U ≤ Σ |fᵢ| sᵢ where the forces grew on the way.

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

/// Kinetic energy beyond a motion as a whole that counts as rest, as a part of the stored energy.
const REST: f64 = 1e-2;

/// Cells are strained where their volume, or the distance of two of their nodes, has changed by more than this part of it.
const STRAINED: f64 = 1e-3;

/// The weight of all masses together in the fit, beside one for all forces: so it is defined where forces leave it open.
const LITTLE: f64 = 1e-6;

/// How many times as large as at its end the mean force of a way may have been along which pins led a node: laws that soften, and
/// bodies that buckle, give way.
const FALLEN: f64 = 2.0;

/// A vector; in the plane the last number is zero.
type Vector = [f64; 3];

/// A body in another balance.
struct Unaccounted {
    body: usize,
    /// What its cells hold [J], and how much of that the forces on it account for [J].
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
    /// How far pins have led it [m].
    led: f64,
}

impl<const D: usize> World<D> {
    /// Warnings so far, and what is odd about the shapes in the present state: [`World::inverted_cells`] and
    /// [`World::other_balances`]. For the end of a run, since shapes are looked at anew by every call.
    pub fn warnings_at_the_end(&self) -> Vec<Warning> {
        let shapes = self.inverted_cells().into_iter().chain(self.other_balances());
        self.warnings().into_iter().chain(self.shape_warnings()).chain(shapes).collect()
    }

    /// A warning (`cells.other_balance`) of bodies of finite elements that are nearly at rest and hold more energy than the
    /// forces on them account for, from their own shape on: they snapped through, are folded, inside out or twisted
    /// round. None where there is no such body. Looked for anew by every call.
    ///
    /// With the forces fᵢ that hold the shape [N] and the rest shape moved as a whole to where it fits the present places
    /// xᵢ best, yᵢ, a body is told of where its energy is more than Σ |fᵢ| |xᵢ − yᵢ|: what loads, pins, obstacles or gas have
    /// deformed holds half of that at most if it is strained a little. Bodies of the material `linear`, which has one shape in
    /// which it holds nothing, are never told of.
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

    /// Whether a body has finite elements or a model whose forces turn with it, and no law of small strain: that has one shape that holds
    /// nothing, and no other balance.
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

    /// Whether any cell has another shape than at rest.
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

/// The energies of the models of a system by which its bodies are judged [J], and the forces of these on all nodes at rest [N]; none where they
/// have no meaning.
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

/// Σ |fᵢ| |xᵢ − yᵢ| with the rest shape moved as a whole to its best fit yᵢ, and the ways of led nodes where these are longer [J].
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
    // Σ w X xᵀ about the centres.
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

/// The rotation in the plane that brings X nearest to x, from Σ w X xᵀ.
pub(crate) fn turn_in_plane(moments: &[[f64; 3]; 3]) -> [Vector; 3] {
    let (along, across) = (moments[0][0] + moments[1][1], moments[0][1] - moments[1][0]);
    let size = (along * along + across * across).sqrt();
    let (c, s) = if size > 0.0 { (along / size, across / size) } else { (1.0, 0.0) };
    [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
}

/// The rotation in space that brings X nearest to x, from Σ w X xᵀ: its quaternion belongs to the largest eigenvalue of Horn's
/// matrix (Horn 1987).
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

/// The kinetic energy beyond that of the motion as a whole that is nearest to the velocities [J].
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
    // A body on a line has no inertia about it.
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
