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
    /// How many of them, the last ones, are obstacles.
    pub obstacles: usize,
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
    /// The largest distance that surfaces keep in contact [m]: of bodies, and where obstacles are among them.
    pub fn largest_thickness(&self) -> [f64; 2] {
        let bodies = self.classes - self.obstacles;
        let mut most: [f64; 2] = [0.0; 2];
        for (k, law) in self.table.iter().enumerate().filter(|(_, law)| law.touch) {
            let obstacle = k / self.classes >= bodies || k % self.classes >= bodies;
            let most = &mut most[usize::from(obstacle)];
            *most = if law.thickness > *most { law.thickness } else { *most };
        }
        most
    }

    /// Adds an obstacle: all bodies touch it by its law, at half of their own distance more, and no obstacle touches another one.
    pub fn add_obstacle(&mut self, law: PairLaw) {
        let (before, bodies) = (self.classes, self.classes - self.obstacles);
        let apart = PairLaw { touch: false, ..law };
        let mut table = Vec::with_capacity((before + 1) * (before + 1));
        for a in 0..=before {
            for b in 0..=before {
                table.push(match (a < before, b < before) {
                    (true, true) => self.table[a * before + b],
                    _ if a < bodies || b < bodies => {
                        let body = if a < bodies { a } else { b };
                        let own = self.table[body * before + body].thickness;
                        PairLaw { thickness: law.thickness + 0.5 * own, ..law }
                    }
                    _ => apart,
                });
            }
        }
        self.table = table;
        self.class.push(before as u32);
        self.itself.push(false);
        (self.classes, self.obstacles) = (before + 1, self.obstacles + 1);
    }
}
