//! Random numbers, rotations and the small linear algebra that the checks need.

/// Random numbers by splitmix64 (Steele, Lea, Flood 2014).
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// Makes a generator from a seed.
    pub fn new(seed: u64) -> Random {
        Random(seed)
    }
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
    /// A number in −1 … 1.
    pub fn signed(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
    /// A vector in the cube −1 … 1.
    pub fn vector<const D: usize>(&mut self) -> [f64; D] {
        let mut out = [0.0; D];
        for c in &mut out {
            *c = self.signed();
        }
        out
    }
}

pub(super) type Matrix<const D: usize> = [[f64; D]; D];

/// A random rotation: Gram–Schmidt on random vectors; the last one is chosen so that the determinant is one.
pub(super) fn rotation<const D: usize>(random: &mut Random) -> Matrix<D> {
    let mut q = [[0.0; D]; D];
    for i in 0..D {
        loop {
            let mut v: [f64; D] = random.vector();
            for _ in 0..2 {
                for row in q.iter().take(i) {
                    let along = dot(row, &v);
                    for d in 0..D {
                        v[d] -= along * row[d];
                    }
                }
            }
            let length = dot(&v, &v).sqrt();
            if length > 0.1 {
                q[i] = v.map(|c| c / length);
                break;
            }
        }
    }
    let determinant = if D == 2 {
        q[0][0] * q[1][1] - q[0][1] * q[1][0]
    } else {
        let (a, b, c) = (&q[0], &q[1], &q[D - 1]);
        let (y, z) = (D - 2, D - 1);
        a[0] * (b[y] * c[z] - b[z] * c[y]) - a[y] * (b[0] * c[z] - b[z] * c[0]) + a[z] * (b[0] * c[y] - b[y] * c[0])
    };
    if determinant < 0.0 {
        q[D - 1] = q[D - 1].map(|c| -c);
    }
    q
}

/// A random skew matrix.
pub(super) fn skew<const D: usize>(random: &mut Random) -> Matrix<D> {
    let mut w = [[0.0; D]; D];
    for i in 0..D {
        for j in 0..i {
            w[i][j] = random.signed();
            w[j][i] = -w[i][j];
        }
    }
    w
}

pub(super) fn times<const D: usize>(m: &Matrix<D>, v: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|i| dot(&m[i], v))
}

pub(super) fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::case::difference;

    #[test]
    fn rotations_are_proper() {
        let mut random = Random::new(3);
        for _ in 0..20 {
            let q = rotation::<3>(&mut random);
            let cross = [
                q[0][1] * q[1][2] - q[0][2] * q[1][1],
                q[0][2] * q[1][0] - q[0][0] * q[1][2],
                q[0][0] * q[1][1] - q[0][1] * q[1][0],
            ];
            assert!(difference(&cross, &q[2], 1.0) < 1e-14);
            let q = rotation::<2>(&mut random);
            assert!((q[0][0] * q[1][1] - q[0][1] * q[1][0] - 1.0).abs() < 1e-14);
        }
    }
}
