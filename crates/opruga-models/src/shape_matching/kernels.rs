//! Moments of clusters, the fitted maps, and the resulting forces, for every set of vector instructions.

use super::layout::Clusters;
use super::shape::MOST_COLUMNS;
use opruga_core::state::{Layout, OrderedSum, Parameter, View, load};
use opruga_core::tile::Tile;
use opruga_math::matrix::{self, Matrix};
use opruga_math::rotation::nearest_rotation;
use opruga_math::{Pack, WIDTH, Work, lanes};

/// The location of the data of the clusters in the scratch: columns with one number per cluster and body, followed by the forces
/// of slots.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stored {
    /// The length of a column.
    pub(super) stride: usize,
    /// The first columns of the goals Gₖ, of the moments cₖ = Σ m p φₖ and of the rotation R. The columns of the centres
    /// precede them.
    pub(super) goal: usize,
    pub(super) moments: usize,
    pub(super) rotation: usize,
    /// The offset of the forces of the slots.
    pub(super) forces: usize,
}

impl Stored {
    pub(super) fn of<const D: usize>(clusters: &Clusters<D>) -> Stored {
        let stride = clusters.layout.index_count(clusters.len());
        let size = D * clusters.columns;
        let (goal, moments, rotation) = (D, D + size, D + 2 * size);
        Stored { stride, goal, moments, rotation, forces: (rotation + D * D) * stride }
    }
    /// The total length.
    pub(super) fn len<const D: usize>(&self, clusters: &Clusters<D>) -> usize {
        let slots = if clusters.is_whole { 0 } else { clusters.slots() * clusters.layout.stride() };
        self.forces + D * slots + WIDTH
    }
    /// Loads a number of a cluster: for one body, the same number eight times; for eight bodies, the number of each body.
    #[inline(always)]
    fn spread<P: Pack>(&self, layout: Layout, scratch: &[f64], column: usize, cluster: usize) -> P {
        match layout {
            Layout::Single => P::splat(scratch[column * self.stride + cluster]),
            Layout::Batch => P::load(&scratch[column * self.stride + cluster * WIDTH..]),
        }
    }
    /// Reads a column of clusters and bodies from an index on.
    #[inline(always)]
    fn read<P: Pack>(&self, scratch: &[f64], column: usize, index: usize) -> P {
        P::load(&scratch[column * self.stride + index..])
    }
    /// Returns a number of a cluster of a body.
    pub(super) fn at<const D: usize>(
        &self,
        clusters: &Clusters<D>,
        scratch: &[f64],
        column: usize,
        cluster: usize,
        body: usize,
    ) -> f64 {
        scratch[column * self.stride + clusters.layout.index(cluster, body)]
    }
}

/// The parameters of a law: κ and β of every body.
#[derive(Debug)]
pub(super) struct Law {
    pub(super) stiffness: Parameter,
    pub(super) share: Parameter,
    /// Whether the fitted map is divided by the D-th root of its determinant.
    pub(super) keeps_volume: bool,
}

/// Returns the positions of the nodes of eight slots, or of one slot of eight bodies.
#[inline(always)]
fn positions<P: Pack, const D: usize>(clusters: &Clusters<D>, view: &View<D>, slot: usize) -> [P; D] {
    match clusters.layout {
        Layout::Single if clusters.is_whole => load(&view.x, slot),
        Layout::Single => lanes!(P, d => P::gather(view.x[d], &clusters.indices[slot..slot + WIDTH])),
        Layout::Batch => load(&view.x, clusters.indices[slot] as usize),
    }
}

/// Computes Σ m p, cₖ = Σ m p φₖ and the centre x̄ of the clusters. Here p is relative to the position of the first node of the
/// cluster.
pub(super) struct Moments<'a, const D: usize, const K: usize> {
    pub(super) clusters: &'a Clusters<D>,
    pub(super) stored: Stored,
    pub(super) view: &'a View<'a, D>,
    pub(super) scratch: &'a mut [f64],
}

#[inline(always)]
fn add<P: Pack, const D: usize, const K: usize>(
    clusters: &Clusters<D>,
    at: usize,
    p: [P; D],
    first: &mut [P; D],
    moments: &mut [[P; K]; D],
) {
    let mass = P::load(&clusters.mass[at..]);
    let weighed: [P; D] = lanes!(P, d => mass * p[d]);
    for d in 0..D {
        first[d] += weighed[d];
    }
    for k in 0..K {
        let phi = P::load(&clusters.phi[k][at..]);
        for d in 0..D {
            moments[d][k] += weighed[d] * phi;
        }
    }
}

impl<const D: usize, const K: usize> Work for Moments<'_, D, K> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Moments { clusters, stored, view, scratch } = self;
        for cluster in 0..clusters.len() {
            let range = clusters.range(cluster);
            let index = clusters.indices[range.start] as usize;
            match clusters.layout {
                Layout::Single => {
                    let from: [P; D] = lanes!(P, d => P::splat(view.x[d][index]));
                    let mut first = [P::zero(); D];
                    let mut moments = [[P::zero(); K]; D];
                    for slot in range.step_by(WIDTH) {
                        let x: [P; D] = positions(clusters, view, slot);
                        add(clusters, slot, lanes!(P, d => x[d] - from[d]), &mut first, &mut moments);
                    }
                    for d in 0..D {
                        let mean = first[d].sum() * clusters.inverse_mass[cluster];
                        scratch[d * stored.stride + cluster] = view.x[d][index] + mean;
                        for k in 0..K {
                            scratch[(stored.moments + d * K + k) * stored.stride + cluster] = moments[d][k].sum();
                        }
                    }
                }
                Layout::Batch => {
                    // One body has these partial sums in eight lanes. Here they are computed one after the other.
                    let from: [P; D] = load(&view.x, index);
                    let mut firsts = [[P::zero(); WIDTH]; D];
                    let mut all = [[[P::zero(); WIDTH]; K]; D];
                    for rest in 0..WIDTH {
                        let mut first = [P::zero(); D];
                        let mut moments = [[P::zero(); K]; D];
                        for slot in (range.start + rest..range.end).step_by(WIDTH) {
                            let x: [P; D] = positions(clusters, view, slot);
                            add(clusters, slot * WIDTH, lanes!(P, d => x[d] - from[d]), &mut first, &mut moments);
                        }
                        for d in 0..D {
                            firsts[d][rest] = first[d];
                            for k in 0..K {
                                all[d][k][rest] = moments[d][k];
                            }
                        }
                    }
                    let inverse = P::load(&clusters.inverse_mass[cluster * WIDTH..]);
                    for d in 0..D {
                        let center = from[d] + in_order(&firsts[d]) * inverse;
                        center.store(&mut scratch[d * stored.stride + cluster * WIDTH..]);
                        for k in 0..K {
                            let at = (stored.moments + d * K + k) * stored.stride + cluster * WIDTH;
                            in_order(&all[d][k]).store(&mut scratch[at..]);
                        }
                    }
                }
            }
        }
    }
}

/// Eight partial sums of eight bodies in the order of [`opruga_math::sum_in_fixed_order`].
#[inline(always)]
fn in_order<P: Pack>(a: &[P; WIDTH]) -> P {
    ((a[0] + a[4]) + (a[2] + a[6])) + ((a[1] + a[5]) + (a[3] + a[7]))
}

/// Computes the rotations of all clusters, and the maps Gₖ = β cₖ + (1 − β) R Lₖ from the columns to the goals.
pub(super) struct Fit<'a, const D: usize> {
    pub(super) clusters: &'a Clusters<D>,
    pub(super) stored: Stored,
    pub(super) law: &'a Law,
    pub(super) scratch: &'a mut [f64],
}

/// The fitted map counts as having no volume if its volume is below this fraction of the rest volume.
pub(super) const VOLUME: f64 = 1e-9;

impl<const D: usize> Work for Fit<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Fit { clusters, stored, law, scratch } = self;
        let columns = clusters.columns;
        for index in (0..stored.stride).step_by(WIDTH) {
            let mut frame = matrix::zeros::<P, D>();
            let mut linear = matrix::zeros::<P, D>();
            for d in 0..D {
                for k in 0..D {
                    frame[d][k] = P::load(&clusters.frame[d * D + k][index..]);
                    linear[d][k] = stored.read::<P>(scratch, stored.moments + d * columns + k, index);
                }
            }
            // A = Σ m p qᵀ = c Lᵀ.
            let rotation = nearest_rotation(&matrix::product_transposed(&linear, &frame));
            let turned = matrix::product(&rotation, &frame);
            let share = law.share.load::<P>(index);
            let rest = P::one() - share;
            let mut factor = P::one();
            let mut there = P::zero().less(P::one());
            if law.keeps_volume {
                // det T of T = c L⁻¹; if the fitted map has no positive volume, the rotation replaces it.
                let at_rest = matrix::determinant(&frame);
                let now = matrix::determinant(&linear);
                there = (P::splat(VOLUME) * at_rest.abs())
                    .less(now * P::select(at_rest.less(P::zero()), -P::one(), P::one()));
                let ratio = P::select(there, now, P::one()) / P::select(there, at_rest, P::one());
                factor = if D == 2 { P::one() / ratio.sqrt() } else { (P::splat(-1.0 / 3.0) * ratio.ln()).exp() };
            }
            for d in 0..D {
                for k in 0..D {
                    let fitted = P::select(there, factor * linear[d][k], turned[d][k]);
                    let goal = share * fitted + rest * turned[d][k];
                    goal.store(&mut scratch[(stored.goal + d * columns + k) * stored.stride + index..]);
                    rotation[d][k].store(&mut scratch[(stored.rotation + d * D + k) * stored.stride + index..]);
                }
                for k in D..columns {
                    let goal = share * stored.read::<P>(scratch, stored.moments + d * columns + k, index);
                    goal.store(&mut scratch[(stored.goal + d * columns + k) * stored.stride + index..]);
                }
            }
        }
    }
}

/// The data that the forces of a cluster need.
#[derive(Clone, Copy)]
struct Goal<P, const D: usize, const K: usize> {
    center: [P; D],
    map: [[P; K]; D],
}

impl<P: Pack, const D: usize, const K: usize> Goal<P, D, K> {
    #[inline(always)]
    fn read(clusters: &Clusters<D>, stored: &Stored, scratch: &[f64], cluster: usize) -> Self {
        let mut out = Goal { center: [P::zero(); D], map: [[P::zero(); K]; D] };
        for d in 0..D {
            out.center[d] = stored.spread(clusters.layout, scratch, d, cluster);
            for k in 0..K {
                out.map[d][k] = stored.spread(clusters.layout, scratch, stored.goal + d * K + k, cluster);
            }
        }
        out
    }
    /// κ m (g − x).
    #[inline(always)]
    fn force(&self, clusters: &Clusters<D>, stiffness: P, at: usize, x: &[P; D]) -> [P; D] {
        let mut out: [P; D] = lanes!(P, d => self.center[d] - x[d]);
        for k in 0..K {
            let phi = P::load(&clusters.phi[k][at..]);
            for d in 0..D {
                out[d] += self.map[d][k] * phi;
            }
        }
        let strength = stiffness * P::load(&clusters.mass[at..]);
        lanes!(P, d => strength * out[d])
    }
}

/// Computes the forces on the slots of all clusters.
pub(super) struct SlotForces<'a, const D: usize, const K: usize> {
    pub(super) clusters: &'a Clusters<D>,
    pub(super) stored: Stored,
    pub(super) law: &'a Law,
    pub(super) view: &'a View<'a, D>,
    pub(super) scratch: &'a mut [f64],
}
impl<const D: usize, const K: usize> Work for SlotForces<'_, D, K> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let SlotForces { clusters, stored, law, view, scratch } = self;
        let stride = clusters.layout.stride();
        let indices = clusters.slots() * stride;
        let (numbers, forces) = scratch.split_at_mut(stored.forces);
        let stiffness = law.stiffness.load::<P>(0);
        for cluster in 0..clusters.len() {
            let goal = Goal::<P, D, K>::read(clusters, &stored, numbers, cluster);
            let range = clusters.range(cluster);
            for slot in range.step_by(WIDTH / stride) {
                let at = slot * stride;
                let force = goal.force(clusters, stiffness, at, &positions(clusters, view, slot));
                for d in 0..D {
                    force[d].store(&mut forces[d * indices + at..]);
                }
            }
        }
    }
}

/// Adds the forces on the nodes of a tile if the body is one cluster.
pub(super) struct Push<'a, 'b, 'c, const D: usize, const K: usize> {
    pub(super) clusters: &'a Clusters<D>,
    pub(super) stored: Stored,
    pub(super) law: &'a Law,
    pub(super) view: &'a View<'a, D>,
    pub(super) scratch: &'a [f64],
    pub(super) tile: &'b mut Tile<'c, D>,
    /// Whether the power of the forces is requested.
    pub(super) works: bool,
}
impl<const D: usize, const K: usize> Work for Push<'_, '_, '_, D, K> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let Push { clusters, stored, law, view, scratch, tile, works } = self;
        tile.settle_by::<P>();
        let goal = Goal::<P, D, K>::read(clusters, &stored, scratch, 0);
        let stiffness = law.stiffness.load::<P>(0);
        let start = tile.range.start;
        let mut power = P::from_array(*tile.power);
        for index in tile.range.clone().step_by(WIDTH) {
            let force = goal.force(clusters, stiffness, index, &load(&view.x, index));
            for d in 0..D {
                let k = index - start;
                (P::load(&tile.force[d][k..]) + force[d]).store(&mut tile.force[d][k..]);
                if works {
                    power += force[d] * P::load(&view.v[d][index..]);
                }
            }
        }
        power.store(tile.power);
    }
}

/// ½ κ Σ m ((1 − β)|p − R q|² + β |p − Σ cₖ φₖ|²).
pub(super) struct Energy<'a, const D: usize> {
    pub(super) clusters: &'a Clusters<D>,
    pub(super) stored: Stored,
    pub(super) law: &'a Law,
    pub(super) view: &'a View<'a, D>,
    pub(super) scratch: &'a [f64],
}
impl<const D: usize> Work for Energy<'_, D> {
    type Output = [f64; WIDTH];
    #[inline(always)]
    fn run<P: Pack>(self) -> [f64; WIDTH] {
        let Energy { clusters, stored, law, view, scratch } = self;
        let (columns, stride) = (clusters.columns, clusters.layout.stride());
        let share = law.share.load::<P>(0);
        let mut sum = OrderedSum::<P>::new(clusters.layout);
        for cluster in 0..clusters.len() {
            let (mut rotation, mut frame) = (matrix::zeros::<P, D>(), matrix::zeros::<P, D>());
            let mut moments = [[P::zero(); MOST_COLUMNS]; D];
            let center: [P; D] = lanes!(P, d => stored.spread(clusters.layout, scratch, d, cluster));
            for d in 0..D {
                for k in 0..D {
                    rotation[d][k] = stored.spread(clusters.layout, scratch, stored.rotation + d * D + k, cluster);
                    frame[d][k] = match clusters.layout {
                        Layout::Single => P::splat(clusters.frame[d * D + k][cluster]),
                        Layout::Batch => P::load(&clusters.frame[d * D + k][cluster * WIDTH..]),
                    };
                }
                for k in 0..columns {
                    moments[d][k] = stored.spread(clusters.layout, scratch, stored.moments + d * columns + k, cluster);
                }
            }
            let turned: Matrix<P, D> = matrix::product(&rotation, &frame);
            for slot in clusters.range(cluster).step_by(WIDTH / stride) {
                let at = slot * stride;
                let x: [P; D] = positions(clusters, view, slot);
                let mut rigid: [P; D] = lanes!(P, d => x[d] - center[d]);
                let mut fitted = rigid;
                for k in 0..columns {
                    let phi = P::load(&clusters.phi[k][at..]);
                    for d in 0..D {
                        fitted[d] -= moments[d][k] * phi;
                        if k < D {
                            rigid[d] -= turned[d][k] * phi;
                        }
                    }
                }
                let (mut of_rigid, mut of_fitted) = (P::zero(), P::zero());
                for d in 0..D {
                    of_rigid += rigid[d] * rigid[d];
                    of_fitted += fitted[d] * fitted[d];
                }
                let density = (P::one() - share) * of_rigid + share * of_fitted;
                let half = P::splat(0.5) * law.stiffness.load::<P>(0);
                sum.add(at, clusters.slots() * stride, half * P::load(&clusters.mass[at..]) * density);
            }
        }
        let mut out = [0.0; WIDTH];
        match clusters.layout {
            Layout::Single => out[0] = sum.total().to_array()[0],
            Layout::Batch => sum.total().store(&mut out),
        }
        out
    }
}
