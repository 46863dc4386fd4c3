//! Zones of points that move rigidly together within a step, because any other motion would let surfaces pass through one
//! another.

use opruga_math::symmetric;

/// Differences of speeds below this number count as rounding. The differences are relative to 1 m/s or to the speeds themselves.
pub(crate) const ROUNDING: f64 = 1e-9;

/// The points of a pair, and their number: at most four points with at most four nodes each.
pub(crate) type PointsOfPair = ([u32; 16], usize);

/// The zones of a step, and the motion that their points would have outside of zones.
#[derive(Clone, Debug, Default)]
pub(crate) struct Zones<const D: usize> {
    /// For each point, another point of its zone, or the point itself; empty if there is no zone.
    parent: Vec<u32>,
    /// The points in zones, ascending, with the velocities of the solution [m/s] and the velocities along prescribed axes.
    points: Vec<(u32, [f64; D], Led<D>)>,
}

/// The velocity along axes that pins or obstacles determine [m/s].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Led<const D: usize>([Option<f64>; D]);

impl<const D: usize> Default for Led<D> {
    fn default() -> Self {
        Led([None; D])
    }
}

impl<const D: usize> Led<D> {
    /// Prescribes the velocity along an axis; `None` if it contradicts an earlier one.
    pub(crate) fn lead(&mut self, axis: usize, speed: f64) -> Option<()> {
        match self.0[axis] {
            Some(known) if (known - speed).abs() > ROUNDING * (1.0 + known.abs()) => None,
            Some(_) => Some(()),
            None => {
                self.0[axis] = Some(speed);
                Some(())
            }
        }
    }
}

/// The motion of a zone: v = c + ω × (x − x̄).
pub(crate) struct Zone<const D: usize> {
    center: [f64; D],
    velocity: [f64; D],
    /// The angular velocity about the three axes; in the plane only about the third.
    spin: [f64; 3],
    pub(crate) led: Led<D>,
}

fn lift<const D: usize>(x: [f64; D]) -> [f64; 3] {
    core::array::from_fn(|d| if d < D { x[d] } else { 0.0 })
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

impl<const D: usize> Zone<D> {
    /// The rigid motion of a zone. This motion has the momentum of the points along every axis that is not prescribed. If no axis is prescribed, it
    /// also has their angular momentum.
    pub(crate) fn of(
        points: &[u32],
        x: &[[f64; D]],
        v: &[[f64; D]],
        inverse_mass: &[[f64; D]],
        led: &Led<D>,
    ) -> Zone<D> {
        let (mut whole, mut center, mut velocity) = ([0.0; D], [0.0; D], [0.0; D]);
        for p in points {
            let p = *p as usize;
            for d in (0..D).filter(|d| inverse_mass[p][*d] > 0.0) {
                let mass = 1.0 / inverse_mass[p][d];
                whole[d] += mass;
                center[d] += mass * x[p][d];
                velocity[d] += mass * v[p][d];
            }
        }
        for d in 0..D {
            if whole[d] > 0.0 {
                center[d] /= whole[d];
                velocity[d] /= whole[d];
            }
            velocity[d] = led.0[d].unwrap_or(velocity[d]);
        }
        let mut out = Zone { center, velocity, spin: [0.0; 3], led: *led };
        if led.0.iter().all(Option::is_none) {
            out.spin = out.spin_of(points, x, v, inverse_mass);
        }
        out
    }

    /// ω from the angular momentum; its component about an axis through all points is zero.
    fn spin_of(&self, points: &[u32], x: &[[f64; D]], v: &[[f64; D]], inverse_mass: &[[f64; D]]) -> [f64; 3] {
        let (mut inertia, mut momentum) = ([[0.0; 3]; 3], [0.0; 3]);
        for p in points {
            let p = *p as usize;
            let mass = 1.0 / inverse_mass[p][0];
            let arm = lift::<D>(core::array::from_fn(|d| x[p][d] - self.center[d]));
            let own = cross(arm, lift::<D>(core::array::from_fn(|d| v[p][d] - self.velocity[d])));
            let square: f64 = arm.iter().map(|x| x * x).sum();
            for i in 0..3 {
                momentum[i] += mass * own[i];
                for j in 0..3 {
                    inertia[i][j] += mass * (if i == j { square } else { 0.0 } - arm[i] * arm[j]);
                }
            }
        }
        let mut spin = [0.0; 3];
        if D == 2 {
            spin[2] = if inertia[2][2] > 0.0 { momentum[2] / inertia[2][2] } else { 0.0 };
            return spin;
        }
        let (values, vectors) = symmetric::eigen(&inertia);
        let largest = values.iter().fold(0.0, |most, x| if *x > most { *x } else { most });
        for k in (0..3).filter(|k| values[*k] > 1e-12 * largest) {
            let along: f64 = (0..3).map(|i| vectors[i][k] * momentum[i]).sum();
            (0..3).for_each(|i| spin[i] += vectors[i][k] * along / values[k]);
        }
        spin
    }

    /// The velocity of a point at x [m/s].
    pub(crate) fn velocity(&self, x: &[f64; D]) -> [f64; D] {
        let turned = cross(self.spin, lift::<D>(core::array::from_fn(|d| x[d] - self.center[d])));
        core::array::from_fn(|d| self.velocity[d] + turned[d])
    }
}

impl<const D: usize> Zones<D> {
    /// Discards all zones.
    pub(crate) fn clear(&mut self) {
        self.parent.clear();
        self.points.clear();
    }

    /// Makes space for zones among this many points.
    pub(crate) fn resize(&mut self, points: usize) {
        if self.parent.is_empty() {
            self.parent.extend(0..points as u32);
        }
    }

    fn root(&self, mut point: u32) -> u32 {
        while self.parent[point as usize] != point {
            point = self.parent[point as usize];
        }
        point
    }

    /// Whether all points of a pair belong to one zone.
    pub(crate) fn hold(&self, (points, count): &PointsOfPair) -> bool {
        !self.parent.is_empty() && points[..*count].windows(2).all(|pair| self.root(pair[0]) == self.root(pair[1]))
    }

    /// Makes one zone of some points, which have the velocities v [m/s] before they move rigidly.
    pub(crate) fn join(&mut self, points: &[u32], v: &[[f64; D]]) {
        for p in points {
            if let Err(at) = self.points.binary_search_by_key(p, |(point, ..)| *point) {
                self.points.insert(at, (*p, v[*p as usize], Led::default()));
            }
            let (a, b) = (self.root(points[0]), self.root(*p));
            let (low, high) = if a < b { (a, b) } else { (b, a) };
            self.parent[high as usize] = low;
        }
    }

    /// The points of every zone, ascending.
    pub(crate) fn list(&self) -> Vec<Vec<u32>> {
        let mut rooted: Vec<(u32, u32)> = self.points.iter().map(|(p, ..)| (self.root(*p), *p)).collect();
        rooted.sort_unstable();
        rooted.chunk_by(|a, b| a.0 == b.0).map(|zone| zone.iter().map(|(_, p)| *p).collect()).collect()
    }

    /// Sets the prescribed velocities of a point.
    pub(crate) fn set_led(&mut self, point: u32, led: Led<D>) {
        if let Ok(at) = self.points.binary_search_by_key(&point, |(point, ..)| *point) {
            self.points[at].2 = led;
        }
    }

    /// Records the energies that the rigid motion took from the points, and that pins and obstacles gave [J].
    pub(crate) fn book(
        &self,
        before: &[[f64; D]],
        v: &[[f64; D]],
        inverse_mass: &[[f64; D]],
        number: &[u32],
        losses: &mut [[f64; 4]],
    ) {
        for (p, solved, led) in &self.points {
            let p = *p as usize;
            let sum = &mut losses[number[p] as usize];
            for d in (0..D).filter(|d| inverse_mass[p][*d] > 0.0) {
                let impulse = (v[p][d] - solved[d]) / inverse_mass[p][d];
                let carry = led.0[d].unwrap_or(0.0);
                sum[0] -= impulse * (0.5 * (before[p][d] + v[p][d]) - carry);
                sum[2] += impulse * carry;
            }
        }
    }
}
