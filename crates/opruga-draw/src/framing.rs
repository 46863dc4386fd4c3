//! The width and height of a picture that frames a view.

use crate::view::View;

impl View {
    /// The width and the height of the visible part [m].
    fn seen(&self, dimension: u8) -> [f64; 2] {
        match dimension {
            3 => crate::solid::seen_size(self),
            _ => [0, 1].map(|axis| self.high[axis] - self.low[axis]),
        }
    }

    /// The larger side of most bodies, as a fraction of the width of the picture.
    pub(crate) fn share_of_body(&self, dimension: u8) -> f64 {
        let [wide, tall] = self.seen(dimension);
        self.body / (wide + 0.08 * wide.max(tall)).max(tall / self.aspect(dimension)).max(1e-12)
    }

    /// The ratio of height to width of a picture that fits the view.
    pub fn aspect(&self, dimension: u8) -> f64 {
        let [wide, tall] = self.seen(dimension);
        let border = 0.08 * wide.max(tall);
        ((tall + border) / (wide + border).max(1e-12)).clamp(0.25, 1.8)
    }
}
