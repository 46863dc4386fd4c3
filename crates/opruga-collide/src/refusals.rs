//! Why an obstacle is refused, as messages.

use opruga_core::error::BuildError;
use opruga_math::messages;

/// Which obstacle is refused, and why.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("collider {index} ({}): {}", source.kind, source.about.in_full())]
pub struct Refused {
    /// The index of the obstacle.
    pub index: usize,
    /// What is wrong with it.
    pub source: BuildError,
}

messages! {
    /// Why the parameters of an obstacle are refused.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Refusal {
        /// A kind of collider that does not exist in this dimension.
        "collider.kind" #[error("there is no such collider in {dimension}D")]
        Kind { dimension: usize },
        /// A hollow ball that is filled by its thickness.
        "collider.no_room" #[error("`thickness` is {thickness}")] #[parameters("thickness")] #[allowed("less than the radius {radius}")]
        FilledBall { thickness: f64, radius: f64 },
        /// A hollow box that is filled by its thickness.
        "collider.no_room" #[error("`thickness` is {thickness}")] #[parameters("thickness")] #[allowed("less than half of every side, {half}")]
        FilledBox { thickness: f64, half: f64 },
        /// A normal without a direction.
        "collider.no_direction" #[error("`normal` is {normal}")] #[parameters("normal")] #[allowed("a vector with a length above {least}")]
        NoNormal { normal: String, least: String },
        /// A capsule without a direction.
        "collider.no_direction" #[error("`a` is {a} and `b` is {b}")] #[parameters("a", "b")] #[allowed("two different points (for one point, use a `ball`)")]
        NoAxis { a: String, b: String },
        /// A box that is given twice or not at all.
        "collider.box_fields" #[error("needs either `min` and `max`, or `center` and `size`")] #[parameters("min", "max", "center", "size")]
        BoxFields {},
        /// A box with exchanged corners.
        "collider.empty_box" #[error("`max` is {max} and `min` is {min}")] #[parameters("max", "min")] #[allowed("every coordinate of `max` above that of `min`")]
        EmptyCorners { max: String, min: String },
        /// A box without a size.
        "collider.empty_box" #[error("`size` is {size}")] #[parameters("size")] #[allowed("lengths above 0")]
        EmptySize { size: String },
        /// Points that are too far apart, or no points.
        "collider.points" #[error("`points` has {count} points from {low} to {high}")] #[parameters("points")] #[allowed("at least one, within 1e100 m of each other")]
        FarPoints { count: usize, low: String, high: String },
        /// A curve with too few points.
        "collider.points" #[error("`points` has {count} points")] #[parameters("points")] #[allowed("at least {least}")]
        FewPoints { count: usize, least: usize },
        /// Points without an extent.
        "collider.points" #[error("the points have no extent")]
        NoExtent {},
        /// A hull without an area.
        "collider.flat_hull" #[error("the hull of the {count} `points` has no area")] #[parameters("points")] #[allowed("points that are not all on one line")]
        NoArea { count: usize },
        /// A hull without a volume.
        "collider.flat_hull" #[error("the hull of the {count} `points` has no volume")] #[parameters("points")] #[allowed("points that are not all in one plane")]
        NoVolume { count: usize },
        /// A segment without a length.
        "collider.degenerate_facet" #[error("points {first} and {second} are both at {position}")] #[allowed("segments with a length above 0")]
        SamePoints { first: usize, second: usize, position: String },
        /// A triangle without an area.
        "collider.degenerate_facet" #[error("triangle {triangle} with points {points} has no area")] #[allowed("triangles with an area")]
        FlatTriangle { triangle: usize, points: String },
        /// A list of numbers that does not form triangles.
        "collider.triangles" #[error("`triangles` has {count} numbers")] #[parameters("triangles")] #[allowed("three per triangle, at least one triangle")]
        Triangles { count: usize },
        /// A point that does not exist.
        "collider.triangles" #[error("`triangles` names point {point}")] #[parameters("triangles")] #[allowed("0 to {last}")]
        NoPoint { point: u32, last: usize },
    }
}

/// All messages of this crate, for tests of translations.
pub const MESSAGES: &[&[opruga_math::message::Variant]] = &[Refusal::VARIANTS];
