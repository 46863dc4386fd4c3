//! Limits on the work that a file may ask for, in cases where a small file can ask for a lot.
//!
//! The time and memory for most files are proportional to their size in bytes, which is itself limited. The items listed here can grow faster: points
//! of curves, elements and triangles that are named repeatedly, short texts that expand to long ones, and compressed data. Each limit is far above
//! what people draw, and small enough that a file at the limit is read within seconds. A file above a limit is refused with the count before memory
//! is allocated for it.

use crate::problem::SceneError;
use opruga_math::{messages, terms};

terms! {
    /// What is counted.
    pub(crate) enum Counted = "part.counted" {
        Outlines = "closed outlines",
        Points = "points of outlines",
        Pixels = "pixels",
        Elements = "elements of a drawing",
        Text = "bytes of repeated text",
        Rules = "comparisons of style rules with elements",
        Vertices = "repeated vertices",
        Numbers = "numbers in arrays",
        Values = "values or memberships in groups",
    }
}

terms! {
    /// What helps if a file asks for too much.
    pub(crate) enum LimitHint = "part.limit_hint" {
        Picture = "use a picture with fewer spots: one that is smoothed, or drawn with fewer colours",
        Entities = "write the drawing without entities, or with `use`",
        Letters = "the letters of this font are composed of too many others",
        Instances = "use fewer instances of a mesh, or leave out what the body does not need",
        Compression = "save the file without compression",
    }
}

messages! {
    /// A request of a file that exceeds a limit. The error has the code of the limit.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum LimitError {
        "part.limit" #[error("the file requires {count} {what} or more")] #[value("{count}")] #[allowed("at most {most} {what}")]
        Above { count: u64, what: Counted, most: u64 },
    }
}

/// The largest number of something that one file may ask for.
#[derive(Debug)]
pub(crate) struct Limit {
    /// The code of the error: `limit.…`.
    code: &'static str,
    /// The largest number.
    pub(crate) most: u64,
    /// What is counted.
    what: Counted,
}

/// Closed curves of a drawing, a map, a text or a picture, each of which is a part of a body. A picture of a chessboard of pixels, or of noise, has a
/// million of them.
pub(crate) const OUTLINES: Limit = Limit { code: "limit.outlines", most: 1 << 16, what: Counted::Outlines };

/// Points of these curves. If points are repeated by `use`, by arcs of a topology or by letters, they count every time. A curve counts as the points
/// into which it is divided.
pub(crate) const POINTS: Limit = Limit { code: "limit.points", most: 1 << 21, what: Counted::Points };

/// Pixels of a picture. The pixels are read row by row; only contours are kept.
pub(crate) const PIXELS: Limit = Limit { code: "limit.pixels", most: 1 << 26, what: Counted::Pixels };

/// Elements of a drawing, counted as often as `use` draws them: in a chain of 61 elements, each of which uses the next one twice, the last one is
/// drawn 2⁶⁰ times.
pub(crate) const ELEMENTS: Limit = Limit { code: "limit.elements", most: 1 << 19, what: Counted::Elements };

/// Bytes to which the entities of an XML file, or the parts of composite letters, expand.
pub(crate) const EXPANSION: Limit = Limit { code: "limit.expansion", most: 1 << 24, what: Counted::Text };

/// Comparisons of style sheet rules with elements.
pub(crate) const RULES: Limit = Limit { code: "limit.rules", most: 1 << 26, what: Counted::Rules };

/// Vertices, or corners of triangles, that a glTF file draws beyond those that it contains, because it draws some of them repeatedly. The parts of
/// the meshes of the file count, too.
pub(crate) const INSTANCES: Limit = Limit { code: "limit.instances", most: 1 << 22, what: Counted::Vertices };

/// Numbers in the arrays of a compressed file, in addition to [`NUMBERS_PER_BYTE`] numbers for each of its bytes.
pub(crate) const NUMBERS: Limit = Limit { code: "limit.numbers", most: 1 << 20, what: Counted::Numbers };

/// The numbers that a file may have for each of its bytes. A compressed mesh has about one or two numbers per byte, or about a thousand if the
/// numbers are zero.
pub(crate) const NUMBERS_PER_BYTE: u64 = 8;

/// Values of cells and nodes, and cells in groups. The count is the number of names times the number of cells, even if a file omits most values.
pub(crate) const VALUES: Limit = Limit { code: "limit.values", most: 1 << 25, what: Counted::Values };

/// The largest number of omitted parts that are listed; the rest are only counted.
pub(crate) const NOTICES: usize = 50;

impl Limit {
    /// Refuses a count that is too large.
    pub(crate) fn check(&self, count: u64) -> Result<(), SceneError> {
        self.check_beside(count, 0)
    }

    /// Refuses a count that exceeds the limit by more than `more`.
    pub(crate) fn check_beside(&self, count: u64, more: u64) -> Result<(), SceneError> {
        let Limit { code, what, .. } = *self;
        let most = self.most.saturating_add(more);
        if count <= most {
            return Ok(());
        }
        Err(SceneError { code, ..SceneError::of(LimitError::Above { count, what, most }) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_of_limits_has_every_limit() {
        let page = include_str!("../../../docs/limits.md");
        for limit in [OUTLINES, POINTS, PIXELS, ELEMENTS, EXPANSION, RULES, INSTANCES, NUMBERS, VALUES] {
            let row = page.lines().find(|line| line.starts_with(&format!("| `{}` |", limit.code)));
            let row = row.unwrap_or_else(|| panic!("`{}` is missing", limit.code));
            assert!(row.contains(&format!("| {} |", limit.most)), "{row}");
        }
    }

    #[test]
    fn a_count_at_the_limit_is_allowed_and_one_more_is_told() {
        assert_eq!(OUTLINES.check(OUTLINES.most), Ok(()));
        let error = OUTLINES.check(OUTLINES.most + 1).expect_err("one more");
        assert_eq!((error.code, error.value.as_deref()), ("limit.outlines", Some("65537")));
        assert_eq!(error.allowed.as_deref(), Some("at most 65536 closed outlines"));
        assert_eq!(NUMBERS.check_beside(NUMBERS.most + 5, 5), Ok(()));
    }
}
