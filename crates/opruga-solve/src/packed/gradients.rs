//! Conjugate gradients on packs.

use super::{PACKS, Packed, Piece, load};
use crate::Indefinite;
use opruga_core::threads::{each, each_with};
use opruga_math::{Column, Lane, Pack, ROW, Register, Simd, WIDTH, Work};

/// The outcome of conjugate gradients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// The number of products with the matrix.
    pub iterations: u32,
    /// The remaining residual, in the norm of the preconditioner.
    pub size: f64,
    /// Whether the method ended at a direction without positive curvature; the solution is then incomplete.
    pub indefinite: bool,
}

/// Computes y = A x for the rows of a piece; returns the scalar product x·y.
struct Multiply<'a, const D: usize> {
    piece: &'a mut Piece<D>,
    rows: &'a [f64],
}

impl<const D: usize> Work for Multiply<'_, D> {
    type Output = f64;
    #[inline(always)]
    fn run<P: Pack>(self) -> f64 {
        let Piece { start, column, values, direction, product, .. } = self.piece;
        let mut along = P::zero();
        for pack in 0..start.len() - 1 {
            let (from, until) = (start[pack] as usize, start[pack + 1] as usize);
            let mut whole = [P::zero(); D];
            for part in 0..P::PARTS {
                let offset = part * P::Part::NUMBERS;
                let mut sum = [P::Part::zero(); D];
                let columns = column[from * WIDTH..until * WIDTH].chunks_exact(WIDTH);
                let blocks = values[from * D * D * WIDTH..until * D * D * WIDTH].chunks_exact(D * D * WIDTH);
                for (columns, block) in columns.zip(blocks) {
                    let x = P::Part::gather_rows(self.rows, &columns[offset..offset + P::Part::NUMBERS]);
                    for i in 0..D {
                        let mut share = P::Part::load_single(&block[i * D * WIDTH + offset..]) * x[0];
                        for j in 1..D {
                            share += P::Part::load_single(&block[(i * D + j) * WIDTH + offset..]) * x[j];
                        }
                        sum[i] += share;
                    }
                }
                for i in 0..D {
                    whole[i].set_part(part, sum[i]);
                }
            }
            for i in 0..D {
                let at = (pack * D + i) * WIDTH;
                along += P::load(&direction[at..]) * whole[i];
                whole[i].store(&mut product[at..]);
            }
        }
        along.sum()
    }
}

/// Updates x ← x + s p, r ← r − s A p, z ← B r; returns the scalar product r·z.
struct Advance<'a, const D: usize> {
    piece: &'a mut Piece<D>,
    step: f64,
}

impl<const D: usize> Work for Advance<'_, D> {
    type Output = f64;
    #[inline(always)]
    fn run<P: Pack>(self) -> f64 {
        let Piece { inverse, residual, improved, direction, product, solution, .. } = self.piece;
        let step = P::splat(self.step);
        let mut along = P::zero();
        for pack in 0..residual.len() / (D * WIDTH) {
            let mut r = [P::zero(); D];
            for d in 0..D {
                let at = (pack * D + d) * WIDTH;
                (P::load(&solution[at..]) + step * P::load(&direction[at..])).store(&mut solution[at..]);
                r[d] = P::load(&residual[at..]) - step * P::load(&product[at..]);
                r[d].store(&mut residual[at..]);
            }
            for i in 0..D {
                let mut z = P::zero();
                for j in 0..D {
                    z += P::load(&inverse[((pack * D + i) * D + j) * WIDTH..]) * r[j];
                }
                z.store(&mut improved[(pack * D + i) * WIDTH..]);
                along += r[i] * z;
            }
        }
        along.sum()
    }
}

/// Updates the direction p ← z + t p, which is also stored by seat, for products.
struct Turn<'a, const D: usize> {
    direction: &'a mut Column,
    improved: &'a [f64],
    rows: &'a mut [f64],
    turn: f64,
}

impl<const D: usize> Work for Turn<'_, D> {
    type Output = ();
    #[inline(always)]
    fn run<P: Pack>(self) {
        let turn = P::splat(self.turn);
        for (pack, rows) in self.rows.chunks_exact_mut(ROW * WIDTH).enumerate() {
            let mut numbers = [[0.0; WIDTH]; D];
            for d in 0..D {
                let at = (pack * D + d) * WIDTH;
                let p = P::load(&self.improved[at..]) + turn * P::load(&self.direction[at..]);
                p.store(&mut self.direction[at..]);
                numbers[d] = p.to_array();
            }
            for l in 0..WIDTH {
                for d in 0..D {
                    rows[l * ROW + d] = numbers[d][l];
                }
            }
        }
    }
}

impl<const D: usize> Packed<D> {
    /// The sum over the pieces, in their order.
    fn sum(&self) -> f64 {
        self.pieces.iter().map(|piece| piece.sum).sum()
    }

    /// Copies the directions to their seats.
    pub(super) fn spread(&mut self, threads: usize) {
        each_with(threads, &mut self.pieces, &mut self.rows, PACKS * WIDTH * ROW, |piece, rows| {
            for (pack, rows) in rows.chunks_exact_mut(ROW * WIDTH).enumerate() {
                for d in 0..D {
                    for l in 0..WIDTH {
                        rows[l * ROW + d] = piece.direction[(pack * D + d) * WIDTH + l];
                    }
                }
            }
        });
    }

    /// Computes the product A p with the direction p; returns the scalar product p·A p.
    pub(super) fn multiply_direction(&mut self, simd: Simd, threads: usize) -> f64 {
        let rows = &*self.rows;
        each(threads, &mut self.pieces, |piece| piece.sum = simd.run(Multiply { piece, rows }));
        let mut along = self.sum();
        for part in &self.rank_one[..self.ranks] {
            let mut dot = 0.0;
            for (seat, u) in &part.entries {
                for d in 0..D {
                    dot += u[d] * rows[*seat as usize * ROW + d];
                }
            }
            for (seat, u) in &part.entries {
                let (pack, lane) = (*seat as usize / WIDTH, *seat as usize % WIDTH);
                let product = &mut self.pieces[pack / PACKS].product;
                for d in 0..D {
                    product[((pack % PACKS) * D + d) * WIDTH + lane] += part.factor * dot * u[d];
                }
            }
            along += part.factor * dot * dot;
        }
        along
    }

    fn advance(&mut self, simd: Simd, threads: usize, step: f64) -> f64 {
        each(threads, &mut self.pieces, |piece| piece.sum = simd.run(Advance { piece, step }));
        self.sum()
    }
    fn turn(&mut self, simd: Simd, threads: usize, turn: f64) {
        each_with(threads, &mut self.pieces, &mut self.rows, PACKS * WIDTH * ROW, |piece, rows| {
            let Piece { direction, improved, .. } = piece;
            simd.run(Turn::<D> { direction, improved, rows, turn });
        });
    }

    /// Takes a right-hand side; returns its size √(b·B b) in the norm of the preconditioner.
    pub fn begin(&mut self, simd: Simd, threads: usize, b: &[f64]) -> f64 {
        let nodes = &self.node;
        each(threads, &mut self.pieces, |piece| {
            load::<D>(nodes, piece.first, b, &mut piece.residual);
            piece.solution.fill(0.0);
            piece.sum = simd.run(Advance { piece, step: 0.0 });
        });
        self.size = self.sum();
        self.size.sqrt()
    }

    /// Solves A x = b for the right-hand side of the last [`Packed::begin`], until the residual in the norm of the
    /// preconditioner is at most `goal`, or after `most` products. Every number of threads and every set of instructions gives
    /// the same bits.
    ///
    /// # Errors
    /// [`Indefinite`] if b is not finite or the first direction has no positive curvature.
    ///
    /// # Source
    /// Hestenes and Stiefel 1952; Steihaug 1983 for the end at a direction of negative curvature.
    pub fn solve(
        &mut self,
        simd: Simd,
        threads: usize,
        goal: f64,
        most: u32,
        x: &mut [f64],
    ) -> Result<Reached, Indefinite> {
        let mut rho = self.size;
        if !(rho.is_finite() && rho >= 0.0) {
            return Err(Indefinite);
        }
        let mut reached = Reached { iterations: 0, size: 0.0, indefinite: false };
        let mut turn = 0.0;
        // Data of earlier systems must not enter: 0 · ∞ is NaN.
        each(threads, &mut self.pieces, |piece| piece.direction.fill(0.0));
        while rho > goal * goal && reached.iterations < most {
            self.turn(simd, threads, turn);
            let curvature = self.multiply_direction(simd, threads);
            reached.iterations += 1;
            if !(curvature > 0.0 && curvature.is_finite()) {
                if reached.iterations == 1 {
                    return Err(Indefinite);
                }
                reached.indefinite = true;
                break;
            }
            let next = self.advance(simd, threads, rho / curvature);
            if !(next.is_finite() && next >= 0.0) {
                return Err(Indefinite);
            }
            (turn, rho) = (next / rho, next);
        }
        reached.size = rho.sqrt();
        self.unload(threads, x, |piece| &piece.solution);
        Ok(reached)
    }
}
