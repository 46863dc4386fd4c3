//! Light on the triangles of a surface.

use super::camera::{Camera, Seen, between, cross, dot, unit};
use super::raster::Screen;
use crate::colour::ColourMap;

/// If the larger side of a triangle is shorter than this [samples], the light is computed only at its corners.
const SMALL: f32 = 40.0;

/// An edge is sharp if the cosine of the angle between the normals of its faces is at most this.
const SHARP: f64 = 0.77;
/// If the cosine of the angle between the normal of a face and the mean of the normals at a corner is above this, no edge of the face is sharp at
/// that corner.
const BLUNT: f64 = 0.94;

/// The light of a scene, in the directions of the camera.
pub(crate) struct Light {
    /// The direction towards the light in the world.
    pub(crate) world: [f64; 3],
    /// The direction towards the light, in camera coordinates.
    towards: [f32; 3],
    /// The upward direction, in camera coordinates.
    up: [f32; 3],
    /// The direction halfway between the light and the camera: a mirror with this normal shows the light.
    half: [f32; 3],
}

/// The direction towards the light: from above, from the left and slightly from behind the camera.
pub(crate) fn light_of(axes: &[[f64; 3]; 3]) -> [f64; 3] {
    let flat = unit([axes[2][0], 0.0, axes[2][2]]);
    unit(std::array::from_fn(|axis| [0.0, 1.0, 0.0][axis] - 0.42 * axes[0][axis] - 0.38 * flat[axis]))
}

impl Light {
    /// A light from above, from the left and slightly from behind the camera.
    pub(crate) fn new(camera: &Camera) -> Light {
        let world = light_of(&camera.axes);
        let turned = |direction: [f64; 3]| camera.turn(direction).map(|value| value as f32);
        let towards = camera.turn(world);
        let half = unit([towards[0], towards[1], towards[2] - 1.0]).map(|value| value as f32);
        Light { world, towards: turned(world), up: turned([0.0, 1.0, 0.0]), half }
    }
}

/// A surface to be filled.
pub(crate) struct Surface<'a> {
    /// The corners.
    pub(crate) positions: &'a [[f64; 3]],
    /// The triangles.
    pub(crate) triangles: &'a [[u32; 3]],
    /// Whether the shading is smooth over blunt edges.
    pub(crate) smooth: bool,
}

/// The colour of a surface without light.
pub(crate) enum Colouring<'a> {
    /// The same colour everywhere.
    Plain([u8; 3]),
    /// The colours of a map at the fractions that are given for the corners.
    Mapped {
        /// The colours of the map, followed by the colour for NaN.
        colours: Vec<[u8; 3]>,
        /// The fractions of the corners, from 0 to 1.
        fractions: &'a [f32],
    },
}

impl<'a> Colouring<'a> {
    /// The colours of a map at fractions of it.
    pub(crate) fn mapped(map: ColourMap, fractions: &'a [f32]) -> Colouring<'a> {
        let steps = (0..256).map(|step| f64::from(step) / 255.0).chain([f64::NAN]);
        let colours = steps.map(|fraction| map.colour(fraction)).collect();
        Colouring::Mapped { colours, fractions }
    }
}

/// Fills a surface.
pub(crate) fn fill(screen: &mut Screen, camera: &Camera, light: &Light, surface: &Surface, colouring: &Colouring) {
    let Surface { positions, triangles, smooth } = *surface;
    let seen: Vec<Option<Seen>> = positions.iter().map(|&position| camera.see(position)).collect();
    let faces: Vec<[f64; 3]> = triangles
        .iter()
        .map(|triangle| {
            let [a, b, c] = triangle.map(|node| positions[node as usize]);
            cross(between(a, b), between(a, c))
        })
        .collect();
    let mut normals = vec![[0.0_f64; 3]; positions.len()];
    for (triangle, face) in triangles.iter().zip(&faces) {
        for &node in triangle {
            for axis in 0..3 {
                normals[node as usize][axis] += face[axis];
            }
        }
    }
    normals.iter_mut().for_each(|normal| *normal = unit(*normal));
    let around = Around::new(positions.len(), triangles);
    for (triangle, &face) in triangles.iter().zip(&faces) {
        let [Some(a), Some(b), Some(c)] = triangle.map(|node| seen[node as usize]) else { continue };
        let face = unit(face);
        let towards = between(positions[triangle[0] as usize], camera.position);
        let sign = if dot(face, towards) < 0.0 { -1.0 } else { 1.0 };
        let corners = triangle.map(|node| {
            let chosen = match normals[node as usize] {
                _ if !smooth => face,
                normal if dot(normal, face) > BLUNT => normal,
                // The shading is smooth over the faces on this side of a sharp edge, and changes abruptly at the edge.
                _ => unit(around.faces(node).fold([0.0; 3], |sum: [f64; 3], other| {
                    let other = faces[other as usize];
                    let beside = dot(unit(other), face) > SHARP;
                    if beside { std::array::from_fn(|axis| sum[axis] + other[axis]) } else { sum }
                })),
            };
            camera.turn(chosen).map(|value| (sign * value) as f32)
        });
        let seen = [a, b, c];
        if size([a, b, c]) < SMALL {
            let shines = corners.map(|normal| light.on(normal));
            let shine = |weights: [f32; 3]| [0, 1].map(|part| total(weights, shines.map(|shine| shine[part])));
            paint(screen, seen, triangle, colouring, shine);
        } else {
            let shine =
                |weights: [f32; 3]| light.on([0, 1, 2].map(|axis| total(weights, corners.map(|normal| normal[axis]))));
            paint(screen, seen, triangle, colouring, shine);
        }
    }
}

/// The triangles at every node.
struct Around {
    /// The start of the list of each node; one more entry than nodes.
    starts: Vec<u32>,
    /// The triangles, node by node.
    triangles: Vec<u32>,
}

impl Around {
    /// Finds the triangles at every node.
    fn new(nodes: usize, triangles: &[[u32; 3]]) -> Around {
        let mut starts = vec![0_u32; nodes + 1];
        triangles.iter().flatten().for_each(|node| starts[*node as usize + 1] += 1);
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut free = starts.clone();
        let mut list = vec![0; 3 * triangles.len()];
        for (number, triangle) in triangles.iter().enumerate() {
            for &node in triangle {
                list[free[node as usize] as usize] = number as u32;
                free[node as usize] += 1;
            }
        }
        Around { starts, triangles: list }
    }

    /// The triangles at a node.
    fn faces(&self, node: u32) -> impl Iterator<Item = u32> + '_ {
        let (from, to) = (self.starts[node as usize], self.starts[node as usize + 1]);
        self.triangles[from as usize..to as usize].iter().copied()
    }
}

/// The weighted sum of the values of corners.
#[inline(always)]
fn total(weights: [f32; 3], values: [f32; 3]) -> f32 {
    weights[0] * values[0] + weights[1] * values[1] + weights[2] * values[2]
}

/// The larger side of the bounding box of a triangle on the screen.
fn size(corners: [Seen; 3]) -> f32 {
    let side = |axis: usize| {
        let [a, b, c] = corners.map(|corner| corner.pixel[axis]);
        a.max(b).max(c) - a.min(b).min(c)
    };
    side(0).max(side(1))
}

/// Fills one triangle with the light computed for each of its samples.
#[inline(always)]
fn paint(
    screen: &mut Screen,
    seen: [Seen; 3],
    triangle: &[u32; 3],
    colouring: &Colouring,
    shine: impl Fn([f32; 3]) -> [f32; 2],
) {
    match colouring {
        Colouring::Plain(colour) => screen.triangle(seen, |weights| lit(*colour, shine(weights))),
        Colouring::Mapped { colours, fractions } => {
            let fractions = triangle.map(|node| fractions[node as usize]);
            screen.triangle(seen, |weights| {
                let fraction = total(weights, fractions);
                let step = if fraction.is_nan() { 256 } else { (fraction.clamp(0.0, 1.0) * 255.0 + 0.5) as usize };
                lit(colours[step.min(256)], shine(weights))
            });
        }
    }
}

impl Light {
    /// The brightness and the gloss for a normal in camera coordinates.
    #[inline(always)]
    fn on(&self, normal: [f32; 3]) -> [f32; 2] {
        let product = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let scale = 1.0 / product(normal, normal).sqrt().max(1e-12);
        let sun = (product(normal, self.towards) * scale).max(0.0);
        let sky = 0.5 + 0.5 * product(normal, self.up) * scale;
        let mirror = (product(normal, self.half) * scale).max(0.0);
        let mut gloss = mirror * mirror;
        gloss *= gloss;
        gloss *= gloss;
        gloss *= gloss;
        [0.56 + 0.18 * sky + 0.34 * sun, 0.16 * gloss * gloss]
    }
}

/// A colour under some light.
#[inline(always)]
fn lit(colour: [u8; 3], [brightness, gloss]: [f32; 2]) -> [u8; 3] {
    colour.map(|channel| {
        let value = f32::from(channel) * brightness;
        (value + (255.0 - value) * gloss).clamp(0.0, 255.0) as u8
    })
}
