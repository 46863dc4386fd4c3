//! The data of cells at rest, in the layout that the lanes read, and the strains of their assumed stresses.

use super::super::group::Group;
use super::hourglass::{
    FIELDS, MOST_MODES, MOST_STRESSES, PAIR, PAIRS, SIGNS, axes_of_field, fields, measures_at, modes, pairs,
    stiffness_numbers, stored,
};
use super::layout::Boxes;
use super::{Modes, Stresses, corners};
use opruga_core::state::Layout;
use opruga_math::matrix::{self, Matrix};
use opruga_math::{Lane, Register, WIDTH};

/// The constant data of one part of a pack of cells.
pub(super) struct Rest<'a, R, const D: usize, const N: usize> {
    boxes: &'a Boxes,
    /// The shares of the functions, either of eight cells side by side or of one cell for eight bodies.
    shares: &'a [f64],
    batch: bool,
    /// The matrix X = H⁻¹ L (see [`super::hourglass`]), and the offset of the part.
    response: &'a [f64],
    offset: usize,
    /// The measures of the points.
    pub(super) measures: [R; N],
    /// The means of the functions of the assumed stresses.
    means: [R; FIELDS],
    /// The axes of the cell, in columns.
    axes: Matrix<R, D>,
    /// The symmetric products of the axes, in the order of [`PAIR`].
    products: [R; PAIRS],
    /// The factor of the trace in the strain of a stress.
    c: R,
    /// λ − λ′ [Pa].
    pub(super) beyond: R,
    /// kₐ [N/m].
    pub(super) guards: [R; MOST_MODES],
}

impl<'a, R: Register, const D: usize, const N: usize> Rest<'a, R, D, N> {
    #[inline(always)]
    pub(super) fn read(group: &Group<'a>, pack: usize, part: usize) -> Self {
        let (boxes, batch) = (group.boxes, group.layout == Layout::Batch);
        let (offset, lanes) = (part * R::NUMBERS, if batch { 1 } else { WIDTH });
        let count = stored::<D, N>() * lanes;
        let from = &boxes.geometry[group.one_or(boxes.one_geometry, pack) * count..][..count];
        let at = |k: usize| if batch { R::splat(from[k]) } else { R::load(&from[k * WIDTH + offset..]) };
        let start = measures_at::<N>();
        let mut measures = [R::zero(); N];
        for q in 0..N {
            measures[q] = at(start + q);
        }
        let mut means = [R::zero(); FIELDS];
        for k in 0..fields::<D>() {
            means[k] = at(start + N + k);
        }
        let start = start + N + fields::<D>();
        let mut axes = matrix::zeros::<R, D>();
        for i in 0..D {
            for j in 0..D {
                axes[i][j] = at(start + i * D + j);
            }
        }
        let mut products = [R::zero(); PAIRS];
        for pair in 0..if D == 2 { D } else { PAIRS } {
            let (a, b) = PAIR[pair];
            for i in 0..D {
                products[pair] += axes[i][a] * axes[i][b];
            }
        }
        let (size, count) = (modes::<D, N>() * D, stiffness_numbers::<D, N>() * WIDTH);
        let response = &boxes.stiffness[group.one_or(boxes.one_stiffness, pack) * count..][..count];
        let at = |k: usize| R::load(&response[(size * size + k) * WIDTH + offset..]);
        let mut guards = [R::zero(); MOST_MODES];
        for mode in 0..modes::<D, N>() {
            guards[mode] = at(2 + mode);
        }
        let (c, beyond) = (at(0), at(1));
        Rest { boxes, shares: from, batch, response, offset, measures, means, axes, products, c, beyond, guards }
    }

    #[inline(always)]
    pub(super) fn measure(&self) -> R {
        let mut sum = self.measures[0];
        for q in 1..N {
            sum += self.measures[q];
        }
        sum
    }

    /// The share of a function in a column of F and g.
    #[inline(always)]
    pub(super) fn share(&self, function: usize, column: usize) -> R {
        let k = function * (N - 1) + column;
        if self.batch { R::splat(self.shares[k]) } else { R::load(&self.shares[k * WIDTH + self.offset..]) }
    }

    /// Computes the mean gradient and the amplitudes of positions or velocities, column by column.
    #[inline(always)]
    pub(super) fn mean(&self, x: &[[R; D]; N]) -> [[R; D]; N] {
        // Differences from the first corner, so that distant bodies keep all digits of their shape.
        let mut of_functions = [[R::zero(); D]; N];
        for i in 0..D {
            let mut from_first = [R::zero(); N];
            for a in 1..N {
                from_first[a] = x[a][i] - x[0][i];
            }
            let own = corners::sums(&from_first);
            for w in 1..N {
                of_functions[w - 1][i] = own[w];
            }
        }
        let mut out = [[R::zero(); D]; N];
        for (c, out) in out.iter_mut().enumerate().take(N - 1) {
            let mut sum = [R::zero(); D];
            for w in self.boxes.shares.columns.of(c) {
                let share = self.share(w, c);
                for i in 0..D {
                    sum[i] += share * of_functions[w][i];
                }
            }
            *out = sum;
        }
        out
    }

    /// The transpose of [`Rest::mean`].
    #[inline(always)]
    pub(super) fn on_corners<const K: usize>(&self, columns: &[[R; K]; N]) -> [[R; K]; N] {
        let mut of_functions = [[R::zero(); K]; N];
        for w in 0..N - 1 {
            let mut sum = [R::zero(); K];
            for c in self.boxes.shares.rows.of(w) {
                let share = self.share(w, c);
                for i in 0..K {
                    sum[i] += share * columns[c][i];
                }
            }
            of_functions[w + 1] = sum;
        }
        let mut out = [[R::zero(); K]; N];
        for i in 0..K {
            let mut own = [R::zero(); N];
            for w in 1..N {
                own[w] = of_functions[w][i];
            }
            let own = corners::values(&own);
            for a in 0..N {
                out[a][i] = own[a];
            }
        }
        out
    }

    /// An entry of the matrix X.
    #[inline(always)]
    pub(super) fn response(&self, stress: usize, amplitude: usize) -> R {
        R::load(&self.response[(stress * modes::<D, N>() * D + amplitude) * WIDTH + self.offset..])
    }

    /// The amplitudes on which a stress depends.
    #[inline(always)]
    fn amplitudes(&self, stress: usize) -> impl Iterator<Item = usize> {
        self.boxes.response.rows.of(stress)
    }

    /// The stresses that depend on an amplitude.
    #[inline(always)]
    pub(super) fn stresses(&self, amplitude: usize) -> impl Iterator<Item = usize> {
        self.boxes.response.columns.of(amplitude)
    }

    /// β = X q.
    #[inline(always)]
    pub(super) fn factors(&self, q: &Modes<R, D>) -> Stresses<R> {
        let mut out = [R::zero(); MOST_STRESSES];
        for (s, out) in out.iter_mut().enumerate().take(modes::<D, N>() * D) {
            let mut sum = R::zero();
            for k in self.amplitudes(s) {
                sum += self.response(s, k) * q.as_flattened()[k];
            }
            *out = sum;
        }
        out
    }

    /// Xᵀ times forces on β.
    #[inline(always)]
    pub(super) fn on_amplitudes(&self, on: &Stresses<R>) -> Modes<R, D> {
        let mut out = [[R::zero(); D]; MOST_MODES];
        for (k, out) in out.as_flattened_mut().iter_mut().enumerate().take(modes::<D, N>() * D) {
            let mut sum = R::zero();
            for s in self.stresses(k) {
                sum += self.response(s, k) * on[s];
            }
            *out = sum;
        }
        out
    }

    /// The values at all points of a sum over the functions of the stresses, plus a value for the whole cell.
    #[inline(always)]
    pub(super) fn at_points(&self, whole: R, of_fields: &[R; FIELDS]) -> [R; N] {
        let mut c = [R::zero(); N];
        c[0] = whole;
        for field in 0..fields::<D>() {
            c[1 + field] = of_fields[field];
            if self.boxes.uneven {
                c[0] -= self.means[field] * of_fields[field];
            }
        }
        corners::values(&c)
    }

    /// Does the same as [`Rest::at_points`] for matrices, and writes the values entry by entry.
    #[inline(always)]
    pub(super) fn matrices_at_points(
        &self,
        whole: &Matrix<R, D>,
        of_fields: &[Matrix<R, D>; FIELDS],
        mut put: impl FnMut(usize, usize, [R; N]),
    ) {
        for i in 0..D {
            for j in 0..D {
                let mut own = [R::zero(); FIELDS];
                for field in 0..fields::<D>() {
                    own[field] = of_fields[field][i][j];
                }
                put(i, j, self.at_points(whole[i][j], &own));
            }
        }
    }

    /// The functions of the assumed stresses at a point.
    #[inline(always)]
    pub(super) fn functions(&self, q: usize) -> [R; FIELDS] {
        let mut out = [R::zero(); FIELDS];
        for k in 0..fields::<D>() {
            out[k] = R::splat(SIGNS[q][k]) - self.means[k];
        }
        out
    }

    /// The sum over the points, and the sums weighted by the functions of the stresses.
    #[inline(always)]
    pub(super) fn over_points(&self, at: &[R; N]) -> (R, [R; FIELDS]) {
        let sums = corners::sums(at);
        let mut of_fields = [R::zero(); FIELDS];
        for field in 0..fields::<D>() {
            of_fields[field] = sums[1 + field];
            if self.boxes.uneven {
                of_fields[field] -= self.means[field] * sums[0];
            }
        }
        (sums[0], of_fields)
    }

    /// Σ f g of two functions of the stresses, from the [`corners::sums`] of numbers at the points.
    #[inline(always)]
    pub(super) fn square(&self, sums: &[R; N], f: usize, g: usize) -> R {
        // The product of two functions is again one of them.
        let mut out = sums[Products::<N>::OF[1 + f][1 + g]];
        if self.boxes.uneven {
            let (first, second) = (self.means[f], self.means[g]);
            out += first * second * sums[0] - first * sums[1 + g] - second * sums[1 + f];
        }
        out
    }

    /// A matrix multiplied by the strains of the stresses.
    #[inline(always)]
    pub(super) fn strained(&self, by: &Matrix<R, D>) -> Strained<R, D> {
        let rows = matrix::product(by, &self.axes);
        Strained { by: *by, rows, axes: self.axes, products: self.products, c: self.c }
    }
}

/// The function that is the product of two functions, in the order of [`corners`].
struct Products<const N: usize>;
impl<const N: usize> Products<N> {
    const OF: [[usize; 8]; 8] = {
        // The axes of each function as bits.
        let axes = if N == 4 { [0, 1, 2, 3, 8, 16, 32, 64] } else { [0, 1, 2, 4, 6, 5, 3, 7] };
        let (mut out, mut k) = ([[0; 8]; 8], 0);
        while k < 8 * 8 * 8 {
            let (f, g, h) = (k / 64, k / 8 % 8, k % 8);
            if axes[f] ^ axes[g] == axes[h] {
                out[f][g] = h;
            }
            k += 1;
        }
        out
    };
}

/// A matrix B times the strains D = sym aₖ ⊗ aₗ − c aₖ·aₗ 1 of the stresses, where aₖ are the axes of the cell.
pub(super) struct Strained<R, const D: usize> {
    by: Matrix<R, D>,
    /// B aₖ, in columns.
    rows: Matrix<R, D>,
    axes: Matrix<R, D>,
    products: [R; PAIRS],
    c: R,
}

/// The accumulated forces on the strains of all stresses.
pub(super) struct Pulls<R, const D: usize> {
    /// On β.
    pub(super) on_beta: Stresses<R>,
    /// On B: on B aₖ, and on B itself.
    on_rows: Matrix<R, D>,
    on_whole: Matrix<R, D>,
}

impl<R: Lane, const D: usize> Strained<R, D> {
    /// tr D, as a factor of aₖ·aₗ.
    #[inline(always)]
    fn swells(&self) -> R {
        R::one() - R::splat(D as f64) * self.c
    }

    /// tr Σ β D for every function.
    #[inline(always)]
    pub(super) fn traces(&self, beta: &Stresses<R>) -> [R; FIELDS] {
        let mut out = [R::zero(); FIELDS];
        for field in 0..fields::<D>() {
            out[field] = self.swells() * self.product_of(field, beta);
        }
        out
    }

    /// Σ β aₖ·aₗ for one function.
    #[inline(always)]
    fn product_of(&self, field: usize, beta: &Stresses<R>) -> R {
        let (s, [a, b]) = axes_of_field::<D>(field);
        let mut sum = beta[s] * self.products[a];
        if a != b {
            sum += beta[s + 1] * self.products[b] + beta[s + 2] * self.products[D + a];
        }
        sum
    }

    /// B Σ β D for every function.
    #[inline(always)]
    pub(super) fn fields(&self, beta: &Stresses<R>) -> [Matrix<R, D>; FIELDS] {
        let mut out = [matrix::zeros::<R, D>(); FIELDS];
        out[0] = self.field(0, beta);
        out[1] = self.field(1, beta);
        if D == 3 {
            out[2] = self.field(2, beta);
            out[3] = self.field(3, beta);
            out[4] = self.field(4, beta);
            out[5] = self.field(5, beta);
        }
        out
    }

    #[inline(always)]
    fn field(&self, field: usize, beta: &Stresses<R>) -> Matrix<R, D> {
        let (s, [a, b]) = axes_of_field::<D>(field);
        let half = R::splat(0.5);
        let less = self.c * self.product_of(field, beta);
        let mut out = matrix::zeros::<R, D>();
        for i in 0..D {
            let (mut first, mut second) = (beta[s] * self.rows[i][a], R::zero());
            if a != b {
                let both = half * beta[s + 2];
                first += both * self.rows[i][b];
                second = beta[s + 1] * self.rows[i][b] + both * self.rows[i][a];
            }
            for j in 0..D {
                out[i][j] = first * self.axes[j][a] - less * self.by[i][j];
                if a != b {
                    out[i][j] += second * self.axes[j][b];
                }
            }
        }
        out
    }

    /// Computes the forces on β and B, given the forces P on B Σ β D and p on tr Σ β D for every function.
    #[inline(always)]
    pub(super) fn pulls(
        &self,
        beta: &Stresses<R>,
        stresses: &[Matrix<R, D>; FIELDS],
        pressures: &[R; FIELDS],
    ) -> Pulls<R, D> {
        let none = matrix::zeros();
        let mut out = Pulls { on_beta: [R::zero(); MOST_STRESSES], on_rows: none, on_whole: none };
        self.pull(0, beta, stresses, pressures, &mut out);
        self.pull(1, beta, stresses, pressures, &mut out);
        if D == 3 {
            self.pull(2, beta, stresses, pressures, &mut out);
            self.pull(3, beta, stresses, pressures, &mut out);
            self.pull(4, beta, stresses, pressures, &mut out);
            self.pull(5, beta, stresses, pressures, &mut out);
        }
        out
    }

    #[inline(always)]
    fn pull(
        &self,
        field: usize,
        beta: &Stresses<R>,
        stresses: &[Matrix<R, D>; FIELDS],
        pressures: &[R; FIELDS],
        out: &mut Pulls<R, D>,
    ) {
        let (s, [a, b]) = axes_of_field::<D>(field);
        let (half, stress) = (R::splat(0.5), &stresses[field]);
        let trace = pressures[field] * self.swells() - self.c * matrix::inner(stress, &self.by);
        let (mut along, mut across, mut mixed) = (R::zero(), R::zero(), R::zero());
        for i in 0..D {
            let (mut first, mut second) = (R::zero(), R::zero());
            for j in 0..D {
                first += stress[i][j] * self.axes[j][a];
                if a != b {
                    second += stress[i][j] * self.axes[j][b];
                }
            }
            along += first * self.rows[i][a];
            out.on_rows[i][a] += beta[s] * first;
            if a != b {
                let both = half * beta[s + 2];
                across += second * self.rows[i][b];
                mixed += first * self.rows[i][b] + second * self.rows[i][a];
                out.on_rows[i][a] += both * second;
                out.on_rows[i][b] += beta[s + 1] * second + both * first;
            }
        }
        out.on_beta[s] = along + trace * self.products[a];
        if a != b {
            out.on_beta[s + 1] = across + trace * self.products[b];
            out.on_beta[s + 2] = half * mixed + trace * self.products[D + a];
        }
        let less = self.c * self.product_of(field, beta);
        out.on_whole = matrix::plus(&out.on_whole, -less, stress);
    }

    /// The force on B.
    #[inline(always)]
    pub(super) fn on_base(&self, pulls: &Pulls<R, D>) -> Matrix<R, D> {
        matrix::plus(&pulls.on_whole, R::one(), &matrix::product_transposed(&pulls.on_rows, &self.axes))
    }

    /// B D for every pair of axes, and tr D.
    #[inline(always)]
    pub(super) fn pairs(&self) -> ([Matrix<R, D>; PAIRS], [R; PAIRS]) {
        let (mut out, mut traces) = ([matrix::zeros::<R, D>(); PAIRS], [R::zero(); PAIRS]);
        let half = R::splat(0.5);
        for pair in 0..pairs::<D>() {
            let (a, b) = PAIR[pair];
            traces[pair] = self.swells() * self.products[pair];
            let less = self.c * self.products[pair];
            for i in 0..D {
                for j in 0..D {
                    out[pair][i][j] = if a == b {
                        self.rows[i][a] * self.axes[j][a]
                    } else {
                        half * (self.rows[i][a] * self.axes[j][b] + self.rows[i][b] * self.axes[j][a])
                    } - less * self.by[i][j];
                }
            }
        }
        (out, traces)
    }
}
