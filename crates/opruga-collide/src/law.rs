//! How deformable bodies answer to touch: which pairs do, and by what numbers.

/// What a pair of bodies does where it touches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairLaw {
    /// Whether they touch at all.
    pub touch: bool,
    /// Coulomb's coefficient µ.
    pub friction: f64,
    /// Ratio of the normal speeds after and before an impact.
    pub restitution: f64,
    /// The distance of the surfaces in contact [m].
    pub thickness: f64,
}

/// The laws of all pairs of classes of bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Laws {
    /// The class of every body.
    pub class: Vec<u32>,
    /// The number of classes.
    pub classes: usize,
    /// The law of every pair of classes, row by row.
    pub table: Vec<PairLaw>,
    /// Whether bodies of a class touch themselves.
    pub itself: Vec<bool>,
    /// Approach up to which nothing bounces [m/s].
    pub rest_speed: f64,
    /// Speed at which bodies that overlap are moved apart [m/s].
    pub recovery_speed: f64,
}

impl Laws {
    /// The law of two bodies, or of a body with itself.
    #[inline]
    pub fn of(&self, a: u32, b: u32) -> &PairLaw {
        &self.table[self.class[a as usize] as usize * self.classes + self.class[b as usize] as usize]
    }
    /// Whether two bodies touch, or a body itself.
    #[inline]
    pub fn meet(&self, a: u32, b: u32) -> bool {
        if a == b { self.itself[self.class[a as usize] as usize] } else { self.of(a, b).touch }
    }
    /// The largest distance that surfaces keep in contact [m].
    pub fn largest_thickness(&self) -> f64 {
        self.table
            .iter()
            .filter(|law| law.touch)
            .fold(0.0, |most, law| if law.thickness > most { law.thickness } else { most })
    }
}
