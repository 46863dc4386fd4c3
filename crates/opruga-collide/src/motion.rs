//! The motion of a collider: displaced along a path, and rotating about a pivot at a constant rate.

use crate::vector::{add, identity, product, rotation, subtract, turned, turned_back};
use opruga_core::system::along_path;
use opruga_math::{Lane, lanes};

/// A prescribed rigid motion.
#[derive(Clone, Debug)]
pub(crate) struct Motion<const D: usize> {
    /// Displacement over time, rows `[t, dx, dy(, dz)]`.
    pub(crate) path: Vec<Vec<f64>>,
    /// The matrix Ω of the angular velocity [rad/s].
    pub(crate) omega: [[f64; D]; D],
    /// Whether it rotates.
    pub(crate) turns: bool,
    /// The centre of rotation [m].
    pub(crate) pivot: [f64; D],
}

/// The pose of a collider at a time, in which a point with the rest position X is at x = R (X − pivot) + centre.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pose<const D: usize> {
    /// The rotation R, by its rows.
    pub(crate) turn: [[f64; D]; D],
    /// Whether R is the unit matrix.
    pub(crate) upright: bool,
    /// The position of the pivot at rest [m].
    pub(crate) pivot: [f64; D],
    /// The position of the pivot [m].
    pub(crate) center: [f64; D],
    /// Displacement of the pivot [m].
    pub(crate) shift: [f64; D],
    /// Velocity of the pivot [m/s].
    pub(crate) velocity: [f64; D],
    /// The matrix Ω of the angular velocity [rad/s].
    pub(crate) omega: [[f64; D]; D],
}

/// The motion of a point that is fixed to a collider during a step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Carry<const D: usize> {
    turn: [[f64; D]; D],
    turns: bool,
    from: [f64; D],
    to: [f64; D],
}

/// The pose of a collider at the end of a step, and its motion during the step.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<const D: usize> {
    pub(crate) pose: Pose<D>,
    pub(crate) carry: Carry<D>,
}

impl<const D: usize> Frame<D> {
    /// The frame of the step of length `h` that ends at `time`.
    pub(crate) fn new(motion: &Motion<D>, time: f64, h: f64) -> Frame<D> {
        let pose = motion.pose(time);
        Frame { carry: motion.pose(time - h).carry_to(&pose), pose }
    }
}

impl<const D: usize> Motion<D> {
    /// Whether there is no motion.
    pub(crate) fn is_still(&self) -> bool {
        self.path.is_empty() && !self.turns
    }
    /// The pose of the collider at a time.
    pub(crate) fn pose(&self, time: f64) -> Pose<D> {
        let (shift, velocity) = along_path::<D>(&self.path, time);
        Pose {
            turn: if self.turns { rotation(&self.omega, time) } else { identity() },
            upright: !self.turns,
            pivot: self.pivot,
            center: add(&self.pivot, &shift),
            shift,
            velocity,
            omega: self.omega,
        }
    }
    /// The smallest and largest displacement along each axis within an interval of time.
    pub(crate) fn shifts(&self, from: f64, to: f64) -> [[f64; D]; 2] {
        let (first, _) = along_path::<D>(&self.path, from);
        let mut range = [first, first];
        let mut include = |shift: &[f64]| {
            for d in 0..D {
                range[0][d] = shift[d].smaller(range[0][d]);
                range[1][d] = shift[d].larger(range[1][d]);
            }
        };
        include(&along_path::<D>(&self.path, to).0);
        for row in self.path.iter().filter(|row| row[0] > from && row[0] < to) {
            include(&row[1..]);
        }
        range
    }
}

impl<const D: usize> Pose<D> {
    /// The present position of a point of the shape, given its position at rest.
    pub(crate) fn transform(&self, x: &[f64; D]) -> [f64; D] {
        if self.upright {
            add(x, &self.shift)
        } else {
            add(&turned(&self.turn, &subtract(x, &self.pivot)), &self.center)
        }
    }
    /// The present direction of a vector that is fixed to the shape, given its direction at rest.
    pub(crate) fn direct(&self, n: &[f64; D]) -> [f64; D] {
        if self.upright { *n } else { turned(&self.turn, n) }
    }
    /// The inverse of [`Pose::transform`].
    pub(crate) fn inverse_transform(&self, x: &[f64; D]) -> [f64; D] {
        if self.upright {
            subtract(x, &self.shift)
        } else {
            add(&turned_back(&self.turn, &subtract(x, &self.center)), &self.pivot)
        }
    }
    /// The velocity of the collider at a point [m/s].
    #[inline(always)]
    pub(crate) fn velocity_at<S: Lane>(&self, x: &[S; D]) -> [S; D] {
        if self.upright {
            return lanes!(S, d => S::splat(self.velocity[d]));
        }
        let arm = lanes!(S, d => x[d] - S::splat(self.center[d]));
        let swirl = turned(&self.omega, &arm);
        lanes!(S, d => S::splat(self.velocity[d]) + swirl[d])
    }
    /// The motion from one pose to a later one.
    pub(crate) fn carry_to(&self, later: &Pose<D>) -> Carry<D> {
        if self.upright {
            return Carry { turn: self.turn, turns: false, from: self.center, to: later.center };
        }
        let mut back = self.turn;
        for i in 0..D {
            for j in 0..D {
                back[i][j] = self.turn[j][i];
            }
        }
        Carry { turn: product(&later.turn, &back), turns: true, from: self.center, to: later.center }
    }
}

impl<const D: usize> Carry<D> {
    /// The position to which a point moves.
    #[inline(always)]
    pub(crate) fn along<S: Lane>(&self, x: &[S; D]) -> [S; D] {
        if self.turns {
            let arm = turned(&self.turn, &lanes!(S, d => x[d] - S::splat(self.from[d])));
            lanes!(S, d => arm[d] + S::splat(self.to[d]))
        } else {
            lanes!(S, d => x[d] + S::splat(self.to[d] - self.from[d]))
        }
    }
}
