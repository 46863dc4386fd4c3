//! How wide and tall a picture is that frames a view.

use crate::view::View;

impl View {
    /// The width and the height of what is seen [m].
    fn seen(&self, dimension: u8) -> [f64; 2] {
        match dimension {
            3 => crate::solid::seen_size(self),
            _ => [0, 1].map(|axis| self.high[axis] - self.low[axis]),
        }
    }

    /// How much of the width of a picture most bodies take along their larger side.
    pub(crate) fn share_of_body(&self, dimension: u8) -> f64 {
        let [wide, tall] = self.seen(dimension);
        self.body / (wide + 0.08 * wide.max(tall)).max(tall / self.aspect(dimension)).max(1e-12)
    }

    /// The height of a picture divided by its width which fits the view.
    pub fn aspect(&self, dimension: u8) -> f64 {
        let [wide, tall] = self.seen(dimension);
        let border = 0.08 * wide.max(tall);
        ((tall + border) / (wide + border).max(1e-12)).clamp(0.25, 1.8)
    }
}
