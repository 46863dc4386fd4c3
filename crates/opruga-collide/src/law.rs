//! The contact laws of deformable bodies: which pairs touch, and with what parameters.

/// The contact law of a pair of bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PairLaw {
    /// Whether they touch at all.
    pub touch: bool,
    /// Coulomb's coefficient µ.
    pub friction: f64,
    /// Ratio of the normal speeds after and before an impact.
    pub restitution: f64,
    /// The distance that contact keeps between the surfaces [m].
    pub thickness: f64,
}

/// The laws of all pairs of classes of bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Laws {
    /// The class of every body.
    pub class: Vec<u32>,
    /// The number of classes.
    pub classes: usize,
    /// The number of classes that are obstacles; they are the last ones.
    pub obstacles: usize,
    /// The law of every pair of classes, row by row.
    pub table: Vec<PairLaw>,
    /// Whether bodies of a class touch themselves.
    pub itself: Vec<bool>,
    /// The approach velocity up to which there is no bounce [m/s].
    pub rest_speed: f64,
    /// The speed at which overlapping bodies are separated [m/s].
    pub recovery_speed: f64,
    /// The largest distances that surfaces of other bodies of the scene keep in contact [m], from bodies and from obstacles.
    /// With these values the bodies behave in the same way whichever other bodies are present.
    pub thickest_elsewhere: [f64; 2],
}

impl Laws {
    /// The law of two bodies, or of a body with itself.
    #[inline]
    pub fn of(&self, a: u32, b: u32) -> &PairLaw {
        &self.table[self.class[a as usize] as usize * self.classes + self.class[b as usize] as usize]
    }
    /// Whether two bodies, or a body and itself, may touch.
    #[inline]
    pub fn meet(&self, a: u32, b: u32) -> bool {
        if a == b { self.itself[self.class[a as usize] as usize] } else { self.of(a, b).touch }
    }
    /// Whether any two bodies, or one with itself, may touch.
    pub fn any_meet(&self) -> bool {
        let bodies = self.class.len() as u32;
        (0..bodies).any(|a| (a..bodies).any(|b| self.meet(a, b)))
    }
    /// The largest distance that surfaces keep in contact [m]: between bodies, and with obstacles.
    pub fn largest_thickness(&self) -> [f64; 2] {
        let bodies = self.classes - self.obstacles;
        let mut most = self.thickest_elsewhere;
        for (k, law) in self.table.iter().enumerate().filter(|(_, law)| law.touch) {
            let obstacle = k / self.classes >= bodies || k % self.classes >= bodies;
            let most = &mut most[usize::from(obstacle)];
            *most = if law.thickness > *most { law.thickness } else { *most };
        }
        most
    }

    /// Returns the laws of some of these bodies and obstacles, whose numbers are given in ascending order.
    pub fn of_some(&self, numbers: &[u32]) -> Laws {
        let class_of = |number: &u32| self.class[*number as usize];
        let mut used: Vec<u32> = numbers.iter().map(class_of).collect();
        used.sort_unstable();
        used.dedup();
        let law_of = |a: u32, b: u32| self.table[a as usize * self.classes + b as usize];
        Laws {
            class: numbers.iter().map(|number| used.binary_search(&class_of(number)).unwrap_or(0) as u32).collect(),
            classes: used.len(),
            obstacles: used.iter().filter(|class| **class as usize >= self.classes - self.obstacles).count(),
            table: used.iter().flat_map(|a| used.iter().map(|b| law_of(*a, *b))).collect(),
            itself: used.iter().map(|class| self.itself[*class as usize]).collect(),
            thickest_elsewhere: self.largest_thickness(),
            ..*self
        }
    }

    /// Adds an obstacle. All bodies touch the obstacle with its law, and half of the thickness of the body is added to the contact distance.
    /// Obstacles do not touch one another.
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
