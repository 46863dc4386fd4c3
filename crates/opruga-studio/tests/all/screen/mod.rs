//! A screen without a graphics card: it draws the triangles of the interface one by one, so that pictures of the window can be compared on every
//! machine.

pub(crate) mod window;

use egui::epaint::{ClippedPrimitive, Primitive, Vertex};
use egui::{Color32, ColorImage, TextureId, TexturesDelta};
use egui_kittest::{Harness, TestRenderer};
use std::cell::RefCell;
use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

/// The textures that the interface has made.
#[derive(Clone, Default)]
pub(crate) struct Textures(Rc<RefCell<HashMap<TextureId, ColorImage>>>);

impl TestRenderer for Textures {
    fn handle_delta(&mut self, delta: &mut TexturesDelta) {
        let mut known = self.0.borrow_mut();
        for (id, deltas) in delta.set.drain() {
            for delta in deltas {
                let egui::epaint::ImageData::Color(image) = &delta.image;
                match delta.pos {
                    None => {
                        known.insert(id, (**image).clone());
                    }
                    Some([x, y]) => {
                        let whole = known.get_mut(&id).expect("a patch of a texture that is there");
                        for row in 0..image.size[1] {
                            for column in 0..image.size[0] {
                                whole[(x + column, y + row)] = image[(column, row)];
                            }
                        }
                    }
                }
            }
        }
        delta.free.drain().for_each(|id| {
            known.remove(&id);
        });
    }
}

/// A picture of the window.
pub(crate) struct Screen {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) pixels: Vec<[u8; 4]>,
}

impl Screen {
    /// Draws what a harness shows now.
    pub(crate) fn of<State>(harness: &Harness<'_, State>, textures: &Textures) -> Screen {
        let output = harness.output();
        let size = harness.ctx.content_rect().size() * output.pixels_per_point;
        let (width, height) = (size.x as usize, size.y as usize);
        let mut screen = Screen { width, height, pixels: vec![[0, 0, 0, 255]; width * height] };
        let textures = textures.0.borrow();
        for primitive in harness.ctx.tessellate(output.shapes.clone(), output.pixels_per_point) {
            screen.draw(&primitive, &textures, output.pixels_per_point);
        }
        screen
    }

    fn draw(&mut self, clipped: &ClippedPrimitive, textures: &HashMap<TextureId, ColorImage>, fine: f32) {
        let Primitive::Mesh(mesh) = &clipped.primitive else { return };
        let Some(texture) = textures.get(&mesh.texture_id) else { return };
        let clip = [
            (clipped.clip_rect.min.x * fine).round().max(0.0) as usize,
            (clipped.clip_rect.min.y * fine).round().max(0.0) as usize,
            ((clipped.clip_rect.max.x * fine).round().max(0.0) as usize).min(self.width),
            ((clipped.clip_rect.max.y * fine).round().max(0.0) as usize).min(self.height),
        ];
        for corners in mesh.indices.chunks_exact(3) {
            let triangle = [0, 1, 2].map(|k| mesh.vertices[corners[k] as usize]);
            self.triangle(triangle, texture, clip, fine);
        }
    }

    fn triangle(&mut self, corners: [Vertex; 3], texture: &ColorImage, clip: [usize; 4], fine: f32) {
        let spot = |v: &Vertex| [v.pos.x * fine, v.pos.y * fine];
        let twice = |[a, b, c]: [[f32; 2]; 3]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
        // Triangles of both orientations are drawn; the rule for edges needs one of them.
        let turned = twice([spot(&corners[0]), spot(&corners[1]), spot(&corners[2])]) < 0.0;
        let corners = if turned { [corners[0], corners[2], corners[1]] } else { corners };
        let [a, b, c] = [spot(&corners[0]), spot(&corners[1]), spot(&corners[2])];
        let area = twice([a, b, c]);
        if area == 0.0 || !area.is_finite() {
            return;
        }
        let low = |d: usize| a[d].min(b[d]).min(c[d]).floor().max(0.0) as usize;
        let high = |d: usize| a[d].max(b[d]).max(c[d]).ceil().max(0.0) as usize;
        for y in low(1).max(clip[1])..high(1).min(clip[3]) {
            for x in low(0).max(clip[0])..high(0).min(clip[2]) {
                let p = [x as f32 + 0.5, y as f32 + 0.5];
                let side = |u: [f32; 2], v: [f32; 2]| (v[0] - u[0]) * (p[1] - u[1]) - (v[1] - u[1]) * (p[0] - u[0]);
                let shares = [side(b, c) / area, side(c, a) / area, side(a, b) / area];
                // A pixel on an edge belongs to one of the two triangles that meet there.
                let inside = |share: f32, u: [f32; 2], v: [f32; 2]| {
                    share > 0.0 || share == 0.0 && (u[1] > v[1] || u[1] == v[1] && u[0] < v[0])
                };
                if inside(shares[0], b, c) && inside(shares[1], c, a) && inside(shares[2], a, b) {
                    self.blend(x, y, corners, shares, texture);
                }
            }
        }
    }

    fn blend(&mut self, x: usize, y: usize, corners: [Vertex; 3], shares: [f32; 3], texture: &ColorImage) {
        let mut tint = [0.0; 4];
        let mut uv = [0.0; 2];
        for (corner, share) in corners.iter().zip(shares) {
            let colour = corner.color.to_array();
            (0..4).for_each(|k| tint[k] += share * f32::from(colour[k]));
            uv = [uv[0] + share * corner.uv.x, uv[1] + share * corner.uv.y];
        }
        let texel = sample(texture, uv);
        let source: [f32; 4] = std::array::from_fn(|k| tint[k] * texel[k] / 255.0);
        let pixel = &mut self.pixels[y * self.width + x];
        for k in 0..3 {
            let below = f32::from(pixel[k]) * (1.0 - source[3] / 255.0);
            pixel[k] = (source[k] + below).round().clamp(0.0, 255.0) as u8;
        }
    }

    /// Compares with the picture of this name in `tests/pictures`; `OPRUGA_UPDATE_PICTURES=1` writes it again. Up to one pixel in a hundred may
    /// differ visibly, because the fonts are drawn by the processor of the present machine.
    pub(crate) fn assert_like(&self, name: &str) {
        let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/pictures");
        let path = folder.join(format!("{name}.png"));
        if std::env::var_os("OPRUGA_UPDATE_PICTURES").is_some() {
            std::fs::write(&path, self.png()).expect("the picture is written");
            return;
        }
        let bytes = std::fs::read(&path).expect("the picture is there: OPRUGA_UPDATE_PICTURES=1 writes it");
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a picture");
        let mut wanted = vec![0; reader.output_buffer_size().expect("a size")];
        let about = reader.next_frame(&mut wanted).expect("a picture");
        assert_eq!((about.width as usize, about.height as usize), (self.width, self.height), "{name}");
        let differs = |(found, wanted): &(&[u8; 4], &[u8])| (0..3).any(|k| found[k].abs_diff(wanted[k]) > 48);
        let different = self.pixels.iter().zip(wanted.chunks_exact(3)).filter(differs).count();
        if different * 100 > self.pixels.len() {
            let found = std::env::temp_dir().join(format!("opruga-studio-{name}.png"));
            std::fs::write(&found, self.png()).expect("the picture is written");
            let share = 100.0 * different as f64 / self.pixels.len() as f64;
            panic!("{name}: {share:.2} % of the pixels differ; see {}", found.display());
        }
    }

    /// The picture as PNG.
    pub(crate) fn png(&self) -> Vec<u8> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        let mut writer = encoder.write_header().expect("a head");
        let pixels: Vec<u8> = self.pixels.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        writer.write_image_data(&pixels).expect("pixels");
        drop(writer);
        bytes
    }
}

/// The colour of a texture, interpolated linearly between its pixels.
fn sample(texture: &ColorImage, uv: [f32; 2]) -> [f32; 4] {
    let [width, height] = texture.size;
    let x = (uv[0] * width as f32 - 0.5).clamp(0.0, width as f32 - 1.0);
    let y = (uv[1] * height as f32 - 0.5).clamp(0.0, height as f32 - 1.0);
    let (x0, y0) = (x as usize, y as usize);
    let (x1, y1) = ((x0 + 1).min(width - 1), (y0 + 1).min(height - 1));
    let (u, v) = (x - x0 as f32, y - y0 as f32);
    let at = |x: usize, y: usize| -> [u8; 4] { Color32::to_array(&texture[(x, y)]) };
    let corners = [at(x0, y0), at(x1, y0), at(x0, y1), at(x1, y1)];
    std::array::from_fn(|k| {
        let [a, b, c, d] = corners.map(|corner| f32::from(corner[k]));
        (a * (1.0 - u) + b * u) * (1.0 - v) + (c * (1.0 - u) + d * u) * v
    })
}
