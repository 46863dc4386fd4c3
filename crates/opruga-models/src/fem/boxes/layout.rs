//! The constant data of the boxes of a section, laid out in packs.
//!
//! If the cells of a section are equal except for rounding, as in a grid, they are treated as equal, and the data of one pack
//! serve for all packs. Sharing the data saves reading 1.8 kilobytes for every hexahedron in every pass.

use super::super::elements::{Cell, Shape};
use super::super::numbers::{NUMBERS, beyond};
use super::hourglass::{ROUNDING, Rest, fields, measures_at, modes, stiffness_numbers, stored};
use super::pattern::Pattern;
use opruga_core::state::Layout;
use opruga_math::{Column, WIDTH};

/// The boxes of a section.
#[derive(Debug, Default)]
pub(in super::super) struct Boxes {
    /// The data that [`stored`] counts, for every pack, or for a full pack and the last one.
    pub(super) geometry: Column,
    /// The data that [`stiffness_numbers`] counts, laid out in the same way.
    pub(super) stiffness: Column,
    /// Whether the data of one pack serve for all packs.
    pub(in super::super) one_geometry: bool,
    pub(super) one_stiffness: bool,
    /// The pattern of the nonzero shares of the functions in F and g. Rows are functions.
    pub(super) shares: Pattern,
    /// Which entries of the matrix X = H⁻¹ L (see [`super::hourglass`]) are not zero.
    pub(super) response: Pattern,
    /// Whether any function of the stresses has a nonzero mean.
    pub(super) uneven: bool,
}

/// The data from which the boxes of a section are laid out.
pub(in super::super) struct Plan<'a, const D: usize, const N: usize> {
    pub(in super::super) layout: Layout,
    pub(in super::super) positions: &'a [[f64; D]],
    pub(in super::super) thickness: f64,
    pub(in super::super) plane_stress: bool,
    pub(in super::super) cells: &'a [Cell<N>],
    /// Whether the law is also evaluated at the mean deformation gradient.
    pub(in super::super) mean: bool,
}

impl Boxes {
    /// Lays out the boxes. `numbers` gives the material data of a cell of a body.
    pub(in super::super) fn new<E: Shape<D, N>, const D: usize, const N: usize>(
        plan: &Plan<'_, D, N>,
        numbers: &dyn Fn(u32, usize) -> [f64; NUMBERS],
    ) -> Self {
        let Plan { layout, cells, .. } = *plan;
        let single = layout == Layout::Single;
        let (lanes, bodies) = if single { (WIDTH, 1) } else { (1, WIDTH) };
        let packs = cells.len().div_ceil(lanes);
        let corners = |cell: &Cell<N>| cell.nodes.map(|n| plan.positions[n as usize]);
        let first = corners(&cells[0]);
        let alike = cells.iter().all(|cell| alike(&first, &corners(cell)));
        let of_all = alike.then(|| Rest::new::<E>(&first, plan.thickness));

        let (stored, stiffnesses) = (stored::<D, N>(), stiffness_numbers::<D, N>());
        let mut geometry = Column::zeros(packs * stored * lanes);
        let mut stiffness = Column::zeros(packs * stiffnesses * WIDTH);
        // Cells of one material have one response.
        let mut known: Option<(f64, Vec<f64>)> = None;
        for pack in 0..packs {
            for lane in 0..lanes {
                // Lanes that fill up the last pack have no measure and no stiffness.
                let there = pack * lanes + lane < cells.len();
                let cell = &cells[(pack * lanes + lane).min(cells.len() - 1)];
                let own = (!alike).then(|| Rest::new::<E>(&corners(cell), plan.thickness));
                let Some(rest) = own.as_ref().or(of_all.as_ref()) else { continue };
                let measures = rest.measures.map(|measure| if there { measure } else { 0.0 });
                let shares = rest.shares[..N - 1].iter().flat_map(|shares| &shares[..N - 1]);
                let all = shares.chain(&measures).chain(&rest.means[..fields::<D>()]);
                for (k, value) in all.chain(rest.axes.as_flattened()).enumerate() {
                    geometry[(pack * stored + k) * lanes + lane] = *value;
                }
                for body in (0..bodies).filter(|_| there) {
                    let [mu, lambda, ..] = numbers(cell.number, body);
                    let ratio = 0.5 * lambda / (lambda + mu);
                    let across = if D == 2 && !plan.plane_stress { ratio } else { ratio / (1.0 + ratio) };
                    let response = match known.take() {
                        Some((of, response)) if alike && of.to_bits() == across.to_bits() => response,
                        _ => rest.response(across),
                    };
                    let more = [across, if plan.mean { beyond(mu, lambda) } else { 0.0 }];
                    let guards = rest.guards[..modes::<D, N>()].iter().map(|guard| mu * guard);
                    for (k, number) in response.iter().copied().chain(more).chain(guards).enumerate() {
                        stiffness[(pack * stiffnesses + k) * WIDTH + lane + body] = number;
                    }
                    known = Some((across, response));
                }
            }
        }

        // Whether a number of the data is nonzero in any cell.
        let is = |column: &Column, count: usize, width: usize, k: usize| {
            column.chunks(count * width).any(|pack| pack[k * width..(k + 1) * width].iter().any(|x| *x != 0.0))
        };
        let size = modes::<D, N>() * D;
        let shares = Pattern::new(N - 1, |w, c| is(&geometry, stored, lanes, w * (N - 1) + c));
        let response = Pattern::new(size, |s, k| is(&stiffness, stiffnesses, WIDTH, s * size + k));
        let uneven = (0..fields::<D>()).any(|k| is(&geometry, stored, lanes, measures_at::<N>() + N + k));
        let present = if single { (cells.len() - 1) % WIDTH + 1 } else { WIDTH };
        let (geometry, one_geometry) = one(geometry, stored * lanes, lanes, present.min(lanes));
        let (stiffness, one_stiffness) = one(stiffness, stiffnesses * WIDTH, WIDTH, present);
        Boxes { geometry, stiffness, one_geometry, one_stiffness, shares, response, uneven }
    }

    pub(in super::super) fn heap_bytes(&self) -> usize {
        self.geometry.heap_bytes() + self.stiffness.heap_bytes() + self.shares.heap_bytes() + self.response.heap_bytes()
    }

    /// The measure of a point of a cell, in a pack with a cell in every lane or with one cell for all lanes.
    pub(in super::super) fn measure<const D: usize, const N: usize>(
        &self,
        pack: usize,
        point: usize,
        [lane, lanes]: [usize; 2],
    ) -> f64 {
        let at = |q: usize| self.geometry[(pack * stored::<D, N>() + measures_at::<N>() + q) * lanes + lane];
        if point < N { at(point) } else { (0..N).map(at).sum() }
    }
}

/// Whether the corners of two cells differ by a translation.
fn alike<const D: usize, const N: usize>(first: &[[f64; D]; N], other: &[[f64; D]; N]) -> bool {
    let (mut size, mut most) = (0.0, 0.0);
    for a in 1..N {
        for d in 0..D {
            let (own, its) = (first[a][d] - first[0][d], other[a][d] - other[0][d]);
            size = if own.abs() > size { own.abs() } else { size };
            most = if (own - its).abs() > most { (own - its).abs() } else { most };
        }
    }
    most <= ROUNDING * size
}

/// Reduces the column to a full pack and the last one if all packs are equal in the lanes that are used.
fn one(column: Column, size: usize, lanes: usize, present: usize) -> (Column, bool) {
    let packs = column.len() / size;
    let (whole, last) = (&column[..size], &column[(packs - 1) * size..]);
    let equal = column.chunks(size).enumerate().all(|(k, pack)| {
        let there = if k + 1 == packs { present } else { lanes };
        pack.chunks(lanes).zip(whole.chunks(lanes)).all(|(own, first)| own[..there] == first[..there])
    });
    if !equal {
        return (column, false);
    }
    (Column::from(&[whole, last].concat()[..]), true)
}

#[cfg(test)]
mod tests {
    use super::super::super::elements::{Hexahedron, Quadrilateral};
    use super::*;
    use opruga_mesh::Mesh;

    fn boxes<E: Shape<D, N>, const D: usize, const N: usize>(
        positions: &[[f64; D]],
        nodes: &[[u32; N]],
        moduli: impl Fn(u32) -> f64,
    ) -> Boxes {
        let number = |(k, nodes): (usize, &[u32; N])| Cell { number: k as u32, nodes: *nodes };
        let cells: Vec<Cell<N>> = nodes.iter().enumerate().map(number).collect();
        let (layout, thickness) = (Layout::Single, 1.0);
        let plan = Plan { layout, positions, thickness, plane_stress: false, cells: &cells, mean: false };
        Boxes::new::<E, D, N>(&plan, &|cell, _| [moduli(cell), moduli(cell), 0.0, 1.0, 0.0])
    }
    /// How many entries of the shares, and how many entries of X, may be nonzero.
    fn entries(boxes: &Boxes, shares: usize, response: usize) -> [usize; 2] {
        let count = |pattern: &Pattern, size: usize| (0..size).map(|k| pattern.rows.of(k).count()).sum();
        [count(&boxes.shares, shares), count(&boxes.response, response)]
    }

    #[test]
    fn equal_cells_share_their_numbers_and_have_few() {
        // The mesh is far from the origin, where the rounding of corners is larger.
        let mesh = Mesh::<3>::grid([3.0, -7.0, 0.1], [1.0, 2.0, 3.0], [5, 3, 7]).unwrap();
        let own = boxes::<Hexahedron, 3, 8>(&mesh.positions, &mesh.cells.hexahedra, |_| 2.0);
        assert!(own.one_geometry && own.one_stiffness && !own.uneven);
        assert_eq!(own.geometry.len(), 2 * stored::<3, 8>() * WIDTH);
        assert_eq!(entries(&own, 7, 12), [7, 21]);
        // The last pack has one cell.
        let last = |lane: usize| own.measure::<3, 8>(1, 8, [lane, WIDTH]);
        assert!((last(0) - 6.0 / 105.0).abs() < 1e-14 && last(1) == 0.0);

        let stiffer = boxes::<Hexahedron, 3, 8>(&mesh.positions, &mesh.cells.hexahedra, |cell| f64::from(cell + 1));
        assert!(stiffer.one_geometry && !stiffer.one_stiffness);

        let mesh = Mesh::<2>::grid([0.0; 2], [1.0, 2.0], [9, 4]).unwrap();
        let own = boxes::<Quadrilateral, 2, 4>(&mesh.positions, &mesh.cells.quadrilaterals, |_| 2.0);
        assert_eq!(entries(&own, 3, 2), [3, 2]);
        assert!(own.one_geometry && own.one_stiffness);
    }

    #[test]
    fn cells_that_differ_have_their_own_numbers() {
        let mut mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [3, 3, 3]).unwrap();
        mesh.positions[0][0] -= 1e-9;
        let own = boxes::<Hexahedron, 3, 8>(&mesh.positions, &mesh.cells.hexahedra, |_| 2.0);
        assert!(!own.one_geometry && !own.one_stiffness && own.uneven);
        for p in &mut mesh.positions {
            *p = [p[0] + 0.2 * p[1] * p[2], p[1] - 0.3 * p[0] * p[0], p[2] + 0.1 * p[0] * p[1]];
        }
        let own = boxes::<Hexahedron, 3, 8>(&mesh.positions, &mesh.cells.hexahedra, |_| 2.0);
        assert!(entries(&own, 7, 12)[1] > 100);
        // A parallelepiped has equal cells too.
        let mut mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [3, 3, 3]).unwrap();
        for p in &mut mesh.positions {
            *p = [p[0] + 0.2 * p[1], p[1] - 0.3 * p[2], p[2] + 0.1 * p[0]];
        }
        let own = boxes::<Hexahedron, 3, 8>(&mesh.positions, &mesh.cells.hexahedra, |_| 2.0);
        assert!(own.one_geometry && !own.uneven);
        assert_eq!(entries(&own, 7, 12)[0], 13);
    }
}
