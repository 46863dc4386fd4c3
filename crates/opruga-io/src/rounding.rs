//! How much of a shape was lost by the rounding of the numbers in its file.
//!
//! Numbers of 4 bytes have seven digits. Ten thousand kilometres from the origin, neighbouring numbers differ by a metre, and a cube of 1.3 m becomes
//! one of 1 m. Bodies may be anywhere once they are read, but what the file has lost cannot be recovered.

use crate::problem::SceneError;
use opruga_math::words::rounded;

opruga_math::messages! {
    /// What is lost in the numbers of a file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum Rounded {
        "mesh.rounded"
        #[error("the file rounds coordinates by up to {rounding} m, {percent} % of the distance between neighbouring nodes: they are stored as numbers of 4 bytes and lie up to {farthest} m from the origin")]
        #[value("{part}")] #[allowed("up to {warned} %; more than {refused} % is an error")]
        #[hint("move the shape to the origin before it is saved, or save it in a format with numbers of 8 bytes")]
        Single { rounding: String, percent: String, farthest: String, part: String, warned: f64, refused: f64 },
        "mesh.rounded"
        #[error("the file rounds coordinates by up to {rounding} m, {percent} % of the distance between neighbouring nodes: they are stored as numbers of 8 bytes and lie up to {farthest} m from the origin")]
        #[value("{part}")] #[allowed("up to {warned} %; more than {refused} % is an error")]
        #[hint("move the shape to the origin before it is saved")]
        Double { rounding: String, percent: String, farthest: String, part: String, warned: f64, refused: f64 },
    }
}

/// Rounding above this fraction of the distance between neighbouring nodes is reported: strains and angles have errors of the same size.
const WARNED: f64 = 1e-3;
/// Above this fraction the file is refused, because the shape has changed.
const REFUSED: f64 = 0.1;

/// Coordinates as stored in a file: their distance from the origin, and the distance between neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stored {
    /// Half of the difference [m] between neighbouring numbers at the largest coordinate.
    rounding: f64,
    /// The largest coordinate [m].
    farthest: f64,
    /// The mean distance between neighbouring nodes [m].
    apart: f64,
    /// Whether numbers have 4 bytes.
    single: bool,
}

impl Stored {
    /// Computes the values for nodes and the elements between them.
    pub(crate) fn of<'e>(positions: &[[f64; 3]], elements: impl Iterator<Item = &'e [u32]>, single: bool) -> Stored {
        let farthest = positions.iter().flatten().fold(0.0, |most: f64, x| if x.abs() > most { x.abs() } else { most });
        let (mut sum, mut count) = (0.0, 0.0);
        for element in elements {
            for (k, node) in element.iter().enumerate().take(if element.len() > 2 { element.len() } else { 1 }) {
                let other = element[(k + 1) % element.len()];
                let (Some(a), Some(b)) = (positions.get(*node as usize), positions.get(other as usize)) else {
                    continue;
                };
                let square: f64 = (0..3).map(|d| (b[d] - a[d]) * (b[d] - a[d])).sum();
                sum += square.sqrt();
                count += 1.0;
            }
        }
        let step = match single {
            true => f64::from((farthest as f32).next_up()) - f64::from(farthest as f32),
            false => farthest.next_up() - farthest,
        };
        let apart = if count > 0.0 { sum / count } else { 0.0 };
        Stored { rounding: 0.5 * step, farthest, apart, single }
    }

    /// The rounding as a fraction of the distance between neighbours; zero if there is no such distance.
    fn part(&self) -> f64 {
        if self.apart > 0.0 && self.apart.is_finite() { self.rounding / self.apart } else { 0.0 }
    }

    /// Returns whichever of two parts of a file has lost more.
    pub(crate) fn worse(self, other: Stored) -> Stored {
        if other.part() > self.part() { other } else { self }
    }

    /// The warning, if one is due.
    ///
    /// # Errors
    /// `mesh.rounded` if the shape has changed.
    pub(crate) fn warning(&self) -> Result<Option<SceneError>, SceneError> {
        let part = self.part();
        if part <= WARNED {
            return Ok(None);
        }
        let (rounding, percent) = (rounded(self.rounding, 2), rounded(100.0 * part, 2));
        let (farthest, warned, refused) = (rounded(self.farthest, 3), 100.0 * WARNED, 100.0 * REFUSED);
        let value = rounded(part, 2);
        let error = SceneError::of(match self.single {
            true => Rounded::Single { rounding, percent, farthest, part: value, warned, refused },
            false => Rounded::Double { rounding, percent, farthest, part: value, warned, refused },
        });
        if part > REFUSED { Err(error) } else { Ok(Some(error)) }
    }
}
