//! Colours that people with any colour vision can distinguish.

/// A colour map for scalars.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColourMap {
    /// From dark violet to yellow, with evenly increasing lightness: for quantities from low to high.
    #[default]
    Viridis,
    /// From dark blue to yellow: for quantities from low to high, and for people who cannot distinguish red from green.
    Cividis,
    /// From dark to light grey, for people who see no colours, and for print.
    Grey,
    /// From a pale grey through yellow and red to dark violet: for quantities that are mostly small, such as stress, on lit
    /// bodies.
    Embers,
    /// From blue through a light grey to red: for quantities around a middle value.
    Diverging,
}

/// The stops of the viridis map of matplotlib (CC0).
const VIRIDIS: [[u8; 3]; 17] = [
    [68, 1, 84],
    [72, 24, 106],
    [71, 45, 123],
    [66, 64, 134],
    [59, 82, 139],
    [51, 99, 141],
    [44, 114, 142],
    [38, 130, 142],
    [33, 145, 140],
    [31, 159, 136],
    [39, 173, 129],
    [61, 188, 116],
    [92, 200, 99],
    [129, 211, 77],
    [170, 220, 50],
    [213, 226, 26],
    [253, 231, 37],
];

/// The stops of the cividis map of matplotlib (CC0).
const CIVIDIS: [[u8; 3]; 10] = [
    [0, 32, 77],
    [0, 51, 111],
    [57, 72, 107],
    [87, 92, 109],
    [112, 113, 115],
    [138, 135, 121],
    [166, 157, 117],
    [196, 181, 108],
    [228, 207, 91],
    [255, 234, 70],
];

/// The dark and the light end of the grey map.
const GREY: [[u8; 3]; 2] = [[28, 30, 34], [244, 245, 247]];

/// The stops of a map from a pale grey to dark violet, with evenly decreasing lightness.
const EMBERS: [[u8; 3]; 9] = [
    [233, 236, 239],
    [244, 227, 183],
    [250, 205, 124],
    [249, 171, 85],
    [238, 131, 70],
    [214, 90, 75],
    [176, 55, 88],
    [128, 33, 92],
    [74, 20, 76],
];

/// The stops of a map from blue to red through a light grey.
const DIVERGING: [[u8; 3]; 11] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [240, 240, 240],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];

/// The colours of Okabe and Ito, in the order in which lines of a plot use them.
pub const OKABE_ITO: [[u8; 3]; 8] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [0, 0, 0],
    [240, 228, 66],
];

/// The soft colours that are used in turn for bodies without a given colour.
pub const BODIES: [[u8; 3]; 6] =
    [[122, 174, 214], [240, 178, 122], [122, 196, 168], [218, 166, 196], [238, 206, 124], [164, 172, 186]];

/// The colour of text.
pub(crate) const INK: [u8; 3] = [38, 42, 50];
/// The colour of secondary text, frames and ticks.
pub(crate) const SOFT_INK: [u8; 3] = [108, 114, 124];
/// The colour of the frame around a scene.
pub(crate) const FRAME: [u8; 3] = [206, 210, 216];
/// The fill colour of an obstacle.
pub(crate) const OBSTACLE: [u8; 3] = [226, 228, 232];
/// The edge colour of an obstacle.
pub(crate) const OBSTACLE_EDGE: [u8; 3] = [116, 122, 132];
/// The colour of the rubber line from a node to the pointer that pulls it.
pub(crate) const RUBBER: [u8; 3] = [196, 40, 90];

impl ColourMap {
    /// All maps, in the order of menus.
    pub const ALL: [ColourMap; 5] =
        [ColourMap::Viridis, ColourMap::Cividis, ColourMap::Embers, ColourMap::Grey, ColourMap::Diverging];

    /// Whether the low end of the map is light, so that lines over it must be dark.
    pub(crate) fn is_light_below(self) -> bool {
        self == ColourMap::Embers
    }

    /// The colour at a fraction of the map from 0 (low) to 1 (high). Fractions outside this range get the colour of the nearest end.
    pub fn colour(self, fraction: f64) -> [u8; 3] {
        let stops: &[[u8; 3]] = match self {
            ColourMap::Viridis => &VIRIDIS,
            ColourMap::Cividis => &CIVIDIS,
            ColourMap::Embers => &EMBERS,
            ColourMap::Grey => &GREY,
            ColourMap::Diverging => &DIVERGING,
        };
        if fraction.is_nan() {
            return [128; 3];
        }
        let position = fraction.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
        let index = (position as usize).min(stops.len() - 2);
        mix(stops[index], stops[index + 1], position - index as f64)
    }
}

/// A mixture of two colours: `share` 0 gives the first, 1 the second.
pub(crate) fn mix(first: [u8; 3], second: [u8; 3], share: f64) -> [u8; 3] {
    std::array::from_fn(|channel| {
        let (a, b) = (f64::from(first[channel]), f64::from(second[channel]));
        (a + (b - a) * share).round().clamp(0.0, 255.0) as u8
    })
}

/// A darker colour, for outlines.
pub(crate) fn darker(colour: [u8; 3]) -> [u8; 3] {
    mix(colour, [20, 26, 40], 0.5)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_reach_their_ends() {
        assert_eq!(ColourMap::Viridis.colour(-1.0), [68, 1, 84]);
        assert_eq!(ColourMap::Viridis.colour(2.0), [253, 231, 37]);
        assert_eq!(ColourMap::Diverging.colour(0.5), [240, 240, 240]);
        assert_eq!(ColourMap::Viridis.colour(f64::NAN), [128; 3]);
    }

    #[test]
    fn maps_from_low_to_high_grow_or_fall_in_lightness() {
        for map in [ColourMap::Viridis, ColourMap::Cividis, ColourMap::Grey, ColourMap::Embers] {
            let light = |fraction: f64| {
                let [red, green, blue] = map.colour(fraction).map(f64::from);
                let light = 0.2126 * red + 0.7152 * green + 0.0722 * blue;
                if map.is_light_below() { -light } else { light }
            };
            assert!((0..50).all(|step| light(step as f64 / 50.0) < light((step + 1) as f64 / 50.0)), "{map:?}");
        }
    }
}
