//! All cells of one kind at rest, in packs of eight cells of one body or of one cell of eight bodies.

use super::cell::{Cell, dual_faces, inverse, side, volume};
use super::refusals::Refusal;
use core::marker::PhantomData;
use opruga_core::state::Layout;
use opruga_math::{Column, WIDTH, fetch_early};

/// A cell counts as having no volume if det ∂X/∂ξ is below this fraction of the cube (in the plane, the square) of the longest
/// edge.
const NO_VOLUME: f64 = 1e-12;

/// Cells of one kind.
#[derive(Debug)]
pub(super) struct Cells<C, const D: usize, const N: usize> {
    pub(super) kind: PhantomData<C>,
    pub(super) layout: Layout,
    /// The number of the first cell in the mesh.
    pub(super) first: usize,
    pub(super) list: Vec<[u32; N]>,
    /// The nodes of every pack, `[corner][lane]`.
    pub(super) nodes: Vec<u32>,
    /// ∂ξ/∂X [1/m] at every point, row by row. For a simplex, ∇Nₐ of all corners except the first. The last pack is filled up
    /// with copies of the last cell.
    pub(super) inverse: Column,
    /// The area vectors of the dual faces [m²; in 2D, length times thickness]. Empty for simplices, where Wₐ = −V ∇Nₐ. Copies
    /// that fill up the last pack have zero area and volume.
    pub(super) areas: Column,
    /// Volume [m³].
    pub(super) volume: Column,
}

impl<C: Cell<D, N>, const D: usize, const N: usize> Cells<C, D, N> {
    pub(super) fn new(
        layout: Layout,
        list: &[[u32; N]],
        first: usize,
        positions: &[[f64; D]],
        thickness: f64,
    ) -> Result<Self, Refusal> {
        let packs = if layout == Layout::Single { list.len().div_ceil(WIDTH) } else { list.len() };
        let column = |each: usize| Column::zeros((packs * each + 1) * WIDTH);
        let mut out = Cells {
            kind: PhantomData,
            layout,
            first,
            list: list.to_vec(),
            nodes: vec![0; packs * N * WIDTH],
            inverse: column(C::POINTS * D * D),
            areas: if C::SIMPLEX { Column::zeros(0) } else { column(C::POINTS * D) },
            volume: column(1),
        };
        for pack in 0..packs {
            for lane in 0..WIDTH {
                let (number, is_there) = match layout {
                    Layout::Single => ((pack * WIDTH + lane).min(list.len() - 1), pack * WIDTH + lane < list.len()),
                    Layout::Batch => (pack, true),
                };
                for a in 0..N {
                    out.nodes[(pack * N + a) * WIDTH + lane] = list[number][a];
                }
                let x: [[f64; D]; N] = list[number].map(|node| positions[node as usize]);
                out.write(pack, lane, number, &x, if is_there { thickness } else { 0.0 })?;
            }
        }
        Ok(out)
    }

    fn write(&mut self, pack: usize, lane: usize, number: usize, x: &[[f64; D]; N], depth: f64) -> Result<(), Refusal> {
        let mut size: f64 = 0.0;
        for a in x {
            for b in x {
                let length = (0..D).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum::<f64>().sqrt();
                size = if length > size { length } else { size };
            }
        }
        let faces = dual_faces::<C, D, N>(x);
        let measure = volume::<C, D, N>(x, &faces);
        self.volume[pack * WIDTH + lane] = depth * measure;
        let least = NO_VOLUME * (0..D).map(|_| size).product::<f64>();
        for (q, slopes) in C::SLOPES.iter().enumerate() {
            let (inverse, determinant) = inverse(&side(x, slopes));
            if !(determinant.is_finite() && determinant > least) {
                return Err(Refusal::InvertedCell { cell: self.first + number, determinant, size });
            }
            for k in 0..D * D {
                self.inverse[((pack * C::POINTS + q) * D * D + k) * WIDTH + lane] = inverse[k / D][k % D];
            }
        }
        if C::SIMPLEX {
            // Around a corner, the sum of all dual faces of the cell is Wₐ, so by the divergence theorem ∇Nₐ = −Wₐ/V.
            for a in 1..=D {
                for d in 0..D {
                    let mut around = 0.0;
                    for (&[i, j], face) in C::EDGES.iter().zip(&faces) {
                        around += (f64::from(u8::from(i == a)) - f64::from(u8::from(j == a))) * face[d];
                    }
                    self.inverse[(pack * D * D + (a - 1) * D + d) * WIDTH + lane] = -around / measure;
                }
            }
            return Ok(());
        }
        for (k, face) in faces.iter().enumerate() {
            for d in 0..D {
                self.areas[((pack * C::POINTS + k) * D + d) * WIDTH + lane] = depth * face[d];
            }
        }
        Ok(())
    }

    /// Prefetches the data that a pass reads from a pack of one body, because each pass reads more than fits into a cache.
    #[inline(always)]
    pub(super) fn fetch(&self, pack: usize) {
        if self.layout == Layout::Single {
            let of = |each: usize| pack * each * WIDTH..(pack + 1) * each * WIDTH;
            fetch_early(&self.nodes, of(N));
            fetch_early(&self.inverse, of(C::POINTS * D * D));
            fetch_early(&self.areas, of(C::POINTS * D));
            fetch_early(&self.volume, of(1));
        }
    }
    pub(super) fn packs(&self) -> usize {
        self.nodes.len() / (N * WIDTH)
    }
    /// The cell and the body in a lane of a pack, if there is one.
    pub(super) fn item(&self, pack: usize, lane: usize) -> Option<(usize, usize)> {
        match self.layout {
            Layout::Single => Some((pack * WIDTH + lane, 0)).filter(|(cell, _)| *cell < self.list.len()),
            Layout::Batch => Some((pack, lane)),
        }
    }
    pub(super) fn heap_bytes(&self) -> usize {
        self.inverse.heap_bytes()
            + self.areas.heap_bytes()
            + self.volume.heap_bytes()
            + 4 * (self.nodes.capacity() + N * self.list.capacity())
    }
}
