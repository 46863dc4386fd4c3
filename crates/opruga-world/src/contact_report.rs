//! The contact of two bodies in a frame.

use opruga_collide::Report;

/// Whether two bodies touched in the last frame and in the one before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ContactPhase {
    /// The bodies touched only in the last frame.
    Began,
    /// The bodies touched in both frames.
    Persists,
    /// The bodies touched only in the frame before the last.
    Ended,
}

/// The contact of two bodies, or of a body with itself, in a frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact<const D: usize> {
    /// The bodies, by their index in the scene; the lower one is first.
    pub bodies: [usize; 2],
    /// Whether it is new, continues or has ended.
    pub phase: ContactPhase,
    /// The mean position of its points, weighted by the normal impulse at each [m]. For a contact that ended, its last position.
    pub position: [f64; D],
    /// The unit vector along the mean of the normals of the contact, from the second body to the first; zero if the normals cancel. For a contact
    /// that ended, its last normal.
    pub normal: [f64; D],
    /// The impulse on the first body in the frame [N s]; divided by the length of the frame, it is the mean force. Zero for a contact that ended, and
    /// for a body with itself, because the impulses cancel.
    pub impulse: [f64; D],
    /// The sum of the normal impulses λₙ over all its points and substeps [N s]: how hard the surfaces were pressed together. Zero for a contact that
    /// ended.
    pub pressed: f64,
}

impl<const D: usize> Contact<D> {
    pub(crate) fn of(report: &Report<D>, bodies: [usize; 2], phase: ContactPhase) -> Contact<D> {
        let mut square = 0.0;
        for d in 0..D {
            square += report.normal[d] * report.normal[d];
        }
        let over = |size: f64| if size > 0.0 { 1.0 / size } else { 0.0 };
        let (unit, mean) = (over(square.sqrt()), over(report.pressed));
        let own = bodies[0] == bodies[1];
        Contact {
            bodies,
            phase,
            position: report.moment.map(|m| m * mean),
            normal: report.normal.map(|n| n * unit),
            impulse: if own { [0.0; D] } else { report.impulse },
            pressed: report.pressed,
        }
    }

    /// The same contact in space; in the plane, z is 0.
    pub(crate) fn in_space(self) -> Contact<3> {
        let lift = |a: [f64; D]| core::array::from_fn(|d| if d < D { a[d] } else { 0.0 });
        let Contact { bodies, phase, position, normal, impulse, pressed } = self;
        Contact { bodies, phase, position: lift(position), normal: lift(normal), impulse: lift(impulse), pressed }
    }
}
