//! Bodies whose points respond to impulses together, such as bodies with implicit integrators.
//!
//! An impulse p on one point changes the velocities of all of them: Δv = Y p. Columns of Y are requested when contacts need
//! them, and are kept as long as the body responds with the same matrix.

use crate::spread::Weighted;
use crate::vector::scaled;
use core::ops::Range;

/// The response of the points of a body to impulses.
pub trait Respond<const D: usize> {
    /// Returns a number that identifies the matrix with which a body responds now. Equal numbers mean equal responses. `None`
    /// if the body cannot respond.
    fn matrix(&mut self, body: usize) -> Option<u64>;
    /// Computes the responses of all points of the body to unit impulses along every axis at one point: their mean velocities
    /// over the step [1/kg]. `out[q][d][i]` is the velocity of point q along axis i due to an impulse along axis d. Bodies and
    /// their points are numbered in the order in which they were added. Returns whether the response is known.
    fn respond(&mut self, body: usize, point: usize, out: &mut [[[f64; D]; D]]) -> bool;
}

/// Bodies whose points respond together, and the known columns of their responses.
#[derive(Clone, Debug, Default)]
pub struct Coupled<const D: usize> {
    bodies: Vec<Body<D>>,
    /// The body of every point; `NONE` if the point responds independently.
    of_point: Vec<u32>,
    /// Whether all points respond independently in this step, because the balance of forces and contact disagree.
    pub(crate) apart: bool,
}

#[derive(Clone, Debug)]
struct Body<const D: usize> {
    points: Range<usize>,
    /// The number of the matrix with which the body responds in this solution, if it is already known. Also the number of the matrix to which the
    /// columns belong.
    matrix: Option<u64>,
    matrix_of_columns: Option<u64>,
    /// The column of each point; `NONE` if it is not known.
    column: Vec<u32>,
    /// The columns, one after the other.
    values: Vec<[[f64; D]; D]>,
    /// The points on which contacts act, in the order of requests; the impulses on these points [N s]; and, for every point, its index in this list.
    known: Vec<u32>,
    impulses: Vec<[f64; D]>,
    number: Vec<u32>,
}

const NONE: u32 = u32::MAX;

impl<const D: usize> Coupled<D> {
    /// Adds a body that has these points.
    pub fn add(&mut self, points: Range<usize>) {
        self.of_point.resize(self.of_point.len().max(points.end), NONE);
        self.of_point[points.clone()].fill(self.bodies.len() as u32);
        self.bodies.push(Body {
            matrix: None,
            matrix_of_columns: None,
            column: vec![NONE; points.len()],
            values: Vec::new(),
            known: Vec::new(),
            impulses: Vec::new(),
            number: vec![NONE; points.len()],
            points,
        });
    }

    /// The number of bodies whose points respond together.
    pub fn count(&self) -> usize {
        self.bodies.len()
    }

    /// The points of one of these bodies.
    pub fn points_of(&self, body: usize) -> Range<usize> {
        self.bodies[body].points.clone()
    }

    /// The body of a point.
    #[inline]
    pub(crate) fn body_of(&self, point: u32) -> Option<usize> {
        let body = if self.apart { NONE } else { self.of_point.get(point as usize).copied().unwrap_or(NONE) };
        (body != NONE).then_some(body as usize)
    }

    /// Whether a point belongs to a body of [`Coupled`], even if it responds independently in this step.
    pub(crate) fn has(&self, point: u32) -> bool {
        self.of_point.get(point as usize).is_some_and(|body| *body != NONE)
    }

    /// Whether a row acts on any point that responds together with others.
    pub(crate) fn holds(&self, (points, weights): Weighted<'_>) -> bool {
        !self.bodies.is_empty() && (0..points.len()).any(|k| weights[k] != 0.0 && self.body_of(points[k]).is_some())
    }

    /// Discards all impulses, so that the impulses of a new solution can be added.
    pub(crate) fn begin(&mut self) {
        for body in &mut self.bodies {
            body.matrix = None;
            body.known.drain(..).for_each(|p| body.number[p as usize - body.points.start] = NONE);
            body.impulses.clear();
        }
    }

    /// Adds the points of a row, and requests their missing columns; returns whether all of their bodies respond.
    pub(crate) fn need(&mut self, (points, weights): Weighted<'_>, respond: &mut dyn Respond<D>) -> bool {
        for k in (0..points.len()).filter(|k| weights[*k] != 0.0) {
            let Some(number) = self.body_of(points[k]) else { continue };
            let body = &mut self.bodies[number];
            let local = points[k] as usize - body.points.start;
            if body.number[local] != NONE {
                continue;
            }
            if body.matrix.is_none() {
                body.matrix = respond.matrix(number);
                if body.matrix.is_none() {
                    return false;
                }
                if body.matrix != body.matrix_of_columns {
                    body.matrix_of_columns = body.matrix;
                    body.column.fill(NONE);
                    body.values.clear();
                }
            }
            if body.column[local] == NONE {
                let first = body.values.len();
                body.values.resize(first + body.points.len(), [[0.0; D]; D]);
                if !respond.respond(number, local, &mut body.values[first..]) {
                    body.values.truncate(first);
                    return false;
                }
                body.column[local] = (first / body.points.len()) as u32;
            }
            body.number[local] = body.known.len() as u32;
            body.known.push(points[k]);
            body.impulses.push([0.0; D]);
        }
        true
    }

    /// The response of point q to an impulse at point p of the same body, whose column is known.
    fn entry(&self, body: usize, p: u32, q: u32) -> &[[f64; D]; D] {
        let body = &self.bodies[body];
        let column = body.column[p as usize - body.points.start] as usize;
        &body.values[column * body.points.len() + q as usize - body.points.start]
    }

    /// Σ wₖ wₗ Yₖₗ over the points of a row: the velocity of its gap due to a unit impulse along every axis.
    pub(crate) fn mobility(&self, (points, weights): Weighted<'_>, inverse_mass: &[[f64; D]]) -> [[f64; D]; D] {
        let mut out = [[0.0; D]; D];
        for k in (0..points.len()).filter(|k| weights[*k] != 0.0) {
            let p = points[k];
            let Some(body) = self.body_of(p) else {
                for d in 0..D {
                    out[d][d] += weights[k] * weights[k] * inverse_mass[p as usize][d];
                }
                continue;
            };
            for l in (0..points.len()).filter(|l| weights[*l] != 0.0 && self.body_of(points[*l]) == Some(body)) {
                let entry = self.entry(body, p, points[l]);
                for d in 0..D {
                    for i in 0..D {
                        out[d][i] += weights[k] * weights[l] * entry[d][i];
                    }
                }
            }
        }
        out
    }

    /// Applies an impulse to the points of a row [N s]: updates the velocities of all points whose columns are known.
    pub(crate) fn give(
        &mut self,
        weighted: Weighted<'_>,
        impulse: &[f64; D],
        inverse_mass: &[[f64; D]],
        v: &mut [[f64; D]],
    ) {
        self.add_answer(weighted, impulse, inverse_mass, v);
        let (points, weights) = weighted;
        for k in (0..points.len()).filter(|k| weights[*k] != 0.0) {
            let Some(body) = self.body_of(points[k]) else { continue };
            let Body { points: range, number, impulses, .. } = &mut self.bodies[body];
            let sum = &mut impulses[number[points[k] as usize - range.start] as usize];
            (0..D).for_each(|d| sum[d] += weights[k] * impulse[d]);
        }
    }

    /// Adds the velocities due to an impulse on the points of a row, without recording it.
    pub(crate) fn add_answer(
        &self,
        (points, weights): Weighted<'_>,
        impulse: &[f64; D],
        inverse_mass: &[[f64; D]],
        v: &mut [[f64; D]],
    ) {
        for k in (0..points.len()).filter(|k| weights[*k] != 0.0) {
            let p = points[k] as usize;
            let own = scaled(impulse, weights[k]);
            let Some(body) = self.body_of(points[k]) else {
                for d in 0..D {
                    v[p][d] += own[d] * inverse_mass[p][d];
                }
                continue;
            };
            let Body { points: range, column, known, values, .. } = &self.bodies[body];
            let values = &values[column[p - range.start] as usize * range.len()..][..range.len()];
            for q in known {
                let (v, entry) = (&mut v[*q as usize], &values[*q as usize - range.start]);
                for d in 0..D {
                    for i in 0..D {
                        v[i] += own[d] * entry[d][i];
                    }
                }
            }
        }
    }

    /// Sets to zero the entries to which [`Coupled::add_answer`] adds.
    pub(crate) fn clear_answer(&self, weighted: Weighted<'_>, v: &mut [[f64; D]]) {
        weighted.0.iter().for_each(|p| v[*p as usize] = [0.0; D]);
        self.followers(weighted, |p| v[p as usize] = [0.0; D]);
    }

    /// Visits all points with contacts that respond together with the points of a row.
    pub(crate) fn followers(&self, (points, weights): Weighted<'_>, mut visit: impl FnMut(u32)) {
        for k in (0..points.len()).filter(|k| weights[*k] != 0.0) {
            if let Some(body) = self.body_of(points[k]) {
                self.bodies[body].known.iter().for_each(|p| visit(*p));
            }
        }
    }

    /// Updates all points of the bodies according to the impulses: `v` becomes the free velocities plus the responses.
    pub(crate) fn finish(&self, free: &[[f64; D]], v: &mut [[f64; D]], touched: &mut [bool]) {
        for body in self.bodies.iter().filter(|_| !self.apart) {
            if body.impulses.iter().all(|impulse| *impulse == [0.0; D]) {
                continue;
            }
            for q in body.points.clone() {
                let mut sum = free[q];
                for (p, impulse) in body.known.iter().zip(&body.impulses) {
                    let column = body.column[*p as usize - body.points.start] as usize;
                    let entry = &body.values[column * body.points.len() + q - body.points.start];
                    for d in 0..D {
                        for i in 0..D {
                            sum[i] += impulse[d] * entry[d][i];
                        }
                    }
                }
                v[q] = sum;
                touched[q] = true;
            }
        }
    }

    /// The nonzero impulses on the points of a body [N s].
    pub fn impulses_on(&self, body: usize) -> impl Iterator<Item = (usize, [f64; D])> + '_ {
        let Body { known, impulses, points, .. } = &self.bodies[body];
        let on = known.iter().zip(impulses).filter(|(_, impulse)| !self.apart && **impulse != [0.0; D]);
        on.map(|(p, impulse)| (*p as usize - points.start, *impulse))
    }

    /// Bytes on the heap.
    pub(crate) fn heap_bytes(&self) -> usize {
        let values: usize = self.bodies.iter().map(|body| body.values.capacity()).sum();
        8 * D * D * values + 4 * self.of_point.capacity()
    }
}
