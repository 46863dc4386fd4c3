//! The description of one moment that a renderer needs.

use crate::colour::ColourMap;
use crate::error::{DrawError, PictureList};

/// Everything that is visible at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// The number of dimensions: 2 (seen along z) or 3 (seen by a camera, with y upwards).
    pub dimension: u8,
    /// The time [s]; if the picture belongs to no moment, this is NaN, and no time is written on the picture.
    pub time: f64,
    /// The title; may be empty.
    pub title: String,
    /// The authors and licences of the drawings that are visible, written in small letters at the bottom; may be empty.
    pub credit: String,
    /// The visible part and the direction of view, if these are not chosen automatically.
    pub sight: Sight,
    /// The deformable bodies.
    pub bodies: Vec<BodyPicture>,
    /// The fixed or moving obstacles.
    pub colliders: Vec<ColliderPicture>,
    /// The arrows of forces and other vectors.
    pub arrows: Vec<ArrowPicture>,
    /// The rubber lines of pointers that pull a node.
    pub pulls: Vec<PullPicture>,
    /// The meaning of the scalars of the bodies.
    pub legend: Option<Legend>,
    /// Whether y points downwards, as on a screen; only in two dimensions.
    pub y_down: bool,
    /// The unit of lengths: metres, unless the scene has another unit.
    pub length_unit: String,
}

impl Default for Picture {
    fn default() -> Picture {
        Picture {
            dimension: 2,
            time: 0.0,
            title: String::new(),
            credit: String::new(),
            sight: Sight::default(),
            bodies: Vec::new(),
            colliders: Vec::new(),
            arrows: Vec::new(),
            pulls: Vec::new(),
            legend: None,
            y_down: false,
            length_unit: "m".into(),
        }
    }
}

/// The visible part and the direction of view of a picture. Values that are not given are chosen from the content.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sight {
    /// The lowest and the highest corner of the box that is shown [m].
    pub region: Option<[[f64; 3]; 2]>,
    /// The angle of the camera around the y axis, from z towards x [degrees]; only in three dimensions.
    pub azimuth: Option<f64>,
    /// The angle of the camera above the horizon [degrees]; only in three dimensions.
    pub elevation: Option<f64>,
}

/// The meaning of the scalars of the bodies.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Legend {
    /// The name of the quantity, such as "stress".
    pub label: String,
    /// The unit of the quantity, such as "kPa"; empty if there is none.
    pub unit: String,
    /// The values at the ends of the colour map; if they are not given, the view measures them.
    pub range: Option<[f64; 2]>,
    /// The colour map.
    pub map: ColourMap,
}

/// The surface of a body.
#[derive(Clone, Debug, PartialEq)]
pub enum Facets {
    /// The edges of closed outlines in two dimensions, in any order. A loop within another loop bounds a hole.
    Edges(Vec<[u32; 2]>),
    /// The triangles of a surface in three dimensions.
    Triangles(Vec<[u32; 3]>),
}

/// An area that is painted on a flat body.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct AreaPicture {
    /// Red, green, blue and opacity. If no colour is given, the area shows the colours of the body, clipped at the border of the area.
    pub colour: Option<[u8; 4]>,
    /// The points that bound the area [m].
    pub positions: Vec<[f64; 3]>,
    /// The indices after the last point of each closed line; a line within another bounds a hole.
    pub ends: Vec<usize>,
    /// The area as triangles between its points, for renderers that cannot fill the inside of lines; may be empty.
    pub triangles: Vec<[u32; 3]>,
}

/// The shape of a body before it was deformed.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct RestPicture {
    /// The points [m].
    pub positions: Vec<[f64; 3]>,
    /// The lines between the points.
    pub segments: Vec<[u32; 2]>,
}

/// One deformable body.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyPicture {
    /// The positions of the nodes [m], with z = 0 in two dimensions.
    pub positions: Vec<[f64; 3]>,
    /// The surface.
    pub facets: Facets,
    /// The triangles within a flat body, filled with the colours of their nodes; may be empty.
    pub cells: Vec<[u32; 3]>,
    /// The springs, drawn as lines.
    pub segments: Vec<[u32; 2]>,
    /// The width of the springs in three dimensions [m]. Springs are drawn as lines too, so that thin ones remain visible.
    pub spring_width: f64,
    /// One scalar per node, which determines its colour; may be empty.
    pub scalar: Vec<f64>,
    /// The colour of a body without scalars; if it is not given, the palette provides one.
    pub colour: Option<[u8; 3]>,
    /// The colour of a line around the visible part of the body, in three dimensions; without a colour there is no line.
    pub outlined: Option<[u8; 3]>,
    /// Whether the nodes are drawn as dots.
    pub nodes_drawn: bool,
    /// The distance of neighbouring nodes at the start [m]. If it is too small for dots in two dimensions, no picture of the run has dots. If this
    /// distance is not given, dots are always drawn.
    pub node_spacing: Option<f64>,
    /// The larger side of the body at the start [m]. It determines which parts of the body are drawn and how thick lines are, equally in all pictures
    /// of a run. If this size is not given, the size in this picture is used.
    pub extent: Option<f64>,
    /// Lines of the rest shape, drawn beneath the body; may be empty.
    pub rest: RestPicture,
    /// The areas that are drawn in two dimensions instead of the outline, one over another; may be empty.
    pub areas: Vec<AreaPicture>,
    /// The pinned nodes.
    pub pinned: Vec<u32>,
    /// A name that is written beside the body; may be empty.
    pub label: String,
}

impl Default for BodyPicture {
    fn default() -> BodyPicture {
        BodyPicture {
            positions: Vec::new(),
            facets: Facets::Edges(Vec::new()),
            cells: Vec::new(),
            segments: Vec::new(),
            spring_width: 0.0,
            scalar: Vec::new(),
            colour: None,
            outlined: None,
            nodes_drawn: false,
            node_spacing: None,
            extent: None,
            rest: RestPicture::default(),
            areas: Vec::new(),
            pinned: Vec::new(),
            label: String::new(),
        }
    }
}

/// One obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum ColliderPicture {
    /// Everything behind a plane, such as a floor.
    HalfSpace {
        /// A point of the plane [m].
        point: [f64; 3],
        /// The direction out of the obstacle.
        normal: [f64; 3],
    },
    /// An axis-aligned box.
    Box {
        /// The lowest corner [m].
        min: [f64; 3],
        /// The highest corner [m].
        max: [f64; 3],
        /// Whether the bodies are inside, as in a room.
        inside: bool,
    },
    /// A disc or a ball.
    Ball {
        /// The centre [m].
        center: [f64; 3],
        /// The radius [m].
        radius: f64,
    },
    /// All points whose distance from a segment is at most a radius.
    Capsule {
        /// One end of the segment [m].
        a: [f64; 3],
        /// The other end of the segment [m].
        b: [f64; 3],
        /// The radius [m].
        radius: f64,
    },
    /// A filled polygon.
    Polygon(Vec<[f64; 3]>),
    /// An open line.
    Polyline(Vec<[f64; 3]>),
    /// A surface of triangles.
    Mesh {
        /// The positions of the corners [m].
        positions: Vec<[f64; 3]>,
        /// The triangles.
        triangles: Vec<[u32; 3]>,
    },
}

/// The quantity that an arrow shows, which determines its colour and its scale.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ArrowKind {
    /// The sum of all forces on a node.
    Force,
    /// The force of the gas within a body.
    Pressure,
    /// The force of a spring or of the material.
    Elastic,
    /// The weight.
    Gravity,
    /// The force of an obstacle or of another body.
    Contact,
    /// The force of a pointer.
    Pull,
    /// A velocity.
    Velocity,
    /// A unit normal of a surface.
    Normal,
}

/// One arrow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArrowPicture {
    /// The quantity that the arrow shows.
    pub kind: ArrowKind,
    /// The start of the arrow [m].
    pub from: [f64; 3],
    /// The vector, in the unit of its kind; the view chooses one scale for each kind.
    pub vector: [f64; 3],
}

/// The rubber line between a node and the pointer that pulls it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PullPicture {
    /// The position of the node [m].
    pub node: [f64; 3],
    /// The position of the pointer [m].
    pub pointer: [f64; 3],
}

impl Picture {
    /// Refuses a picture with inconsistent lists.
    pub fn check(&self) -> Result<(), DrawError> {
        if self.dimension != 2 && self.dimension != 3 {
            return Err(DrawError::Dimension { dimensions: self.dimension });
        }
        self.bodies.iter().enumerate().try_for_each(|(index, body)| body.check(index))
    }
}

impl BodyPicture {
    /// Refuses a body with inconsistent lists; `body` is its index in the picture.
    fn check(&self, body: usize) -> Result<(), DrawError> {
        let nodes = self.positions.len();
        if !self.scalar.is_empty() && self.scalar.len() != nodes {
            return Err(DrawError::Scalars { body, nodes, scalars: self.scalar.len() });
        }
        let wrong = |mut list: Box<dyn Iterator<Item = u32> + '_>| list.find(|&node| node as usize >= nodes);
        let facets: Box<dyn Iterator<Item = u32> + '_> = match &self.facets {
            Facets::Edges(edges) => Box::new(edges.iter().flatten().copied()),
            Facets::Triangles(triangles) => Box::new(triangles.iter().flatten().copied()),
        };
        for area in &self.areas {
            let (points, last) = (area.positions.len(), area.ends.last().copied().unwrap_or(0));
            let beyond = area.triangles.iter().flatten().find(|point| **point as usize >= points);
            if last != points || !area.ends.is_sorted() || beyond.is_some() {
                let node = beyond.copied().unwrap_or(last as u32);
                return Err(DrawError::Node { body, nodes: points, list: PictureList::Areas, node });
            }
        }
        let points = self.rest.positions.len();
        if let Some(&node) = self.rest.segments.iter().flatten().find(|node| **node as usize >= points) {
            return Err(DrawError::Node { body, nodes: points, list: PictureList::LinesAtRest, node });
        }
        let lists: [(PictureList, Option<u32>); 4] = [
            (PictureList::Facets, wrong(facets)),
            (PictureList::Cells, wrong(Box::new(self.cells.iter().flatten().copied()))),
            (PictureList::Segments, wrong(Box::new(self.segments.iter().flatten().copied()))),
            (PictureList::PinnedNodes, wrong(Box::new(self.pinned.iter().copied()))),
        ];
        for (list, node) in lists {
            if let Some(node) = node {
                return Err(DrawError::Node { body, nodes, list, node });
            }
        }
        Ok(())
    }
}
