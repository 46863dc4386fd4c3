//! Draws a scene in space. The renderer of the command line draws it to a texture, in parallel to the interface. This renderer needs no graphics
//! card, and draws depth, smooth shading and a soft shadow.

use super::arrows::Longest;
use super::look::Look;
use crate::shown::Shown;
use egui::{Color32, ColorImage, Rect, TextureHandle, TextureOptions, Ui, Vec2};
use opruga::draw::{Eye, Image, Lens, View, draw_scene};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The colour of the outline of the selected body.
const OUTLINE: [u8; 3] = [240, 150, 30];

/// The longest side of a picture in pixels; it is stretched for screens with a higher resolution.
const MOST_PIXELS: f64 = 1400.0;

/// The largest fraction of the picture that a scene fills.
const FILLED: f64 = 0.96;

/// A picture, and the scene and camera that it shows.
struct Drawn {
    image: Image,
    shown: Arc<Shown>,
    eye: Eye,
}

struct Order {
    shown: Arc<Shown>,
    view: View,
    background: [u8; 3],
    size: [u32; 2],
    range: [f64; 2],
    eye: Eye,
    selected: Option<String>,
    longest: Longest,
}

/// The contents of a picture: scene, frame, camera, size, theme, display options, selected body.
type Last = (u64, u64, Eye, [u32; 2], bool, u64, Option<String>);

/// The camera, and the pictures drawn for it.
#[derive(Default)]
pub(crate) struct Space {
    eye: Option<Eye>,
    done: Arc<Mutex<Option<Drawn>>>,
    busy: Arc<AtomicBool>,
    texture: Option<TextureHandle>,
    /// The scene and camera of the picture on the screen, to which overlays and presses refer.
    seen: Option<(Arc<Shown>, Eye)>,
    /// The contents of the last picture that was ordered, so that the same picture is not drawn twice.
    last: Option<Last>,
}

impl core::fmt::Debug for Space {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_struct("Space").field("eye", &self.eye).finish_non_exhaustive()
    }
}

impl Space {
    pub(crate) fn eye(&self) -> Option<&Eye> {
        self.eye.as_ref()
    }

    /// Shows all of a view in a picture of this size.
    pub(crate) fn fit(&mut self, view: &View, size: Vec2) {
        self.eye = Some(whole(Eye::of(view), view, size));
        (self.last, self.seen) = (None, None);
    }

    /// Causes the picture to be uploaded again after its device was lost.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn forget_texture(&mut self) {
        (self.texture, self.last) = (None, None);
    }

    /// Whether a picture is being drawn or waits to be shown.
    pub(crate) fn is_drawing(&self) -> bool {
        self.busy.load(Ordering::Acquire) || self.done.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    /// Uses the camera of another renderer.
    pub(crate) fn share_eye(&mut self, other: &Space) {
        self.eye = other.eye;
    }

    /// Shows all of a view from the same direction.
    pub(crate) fn look_at_all(&mut self, view: &View, size: Vec2) {
        if let Some(eye) = &mut self.eye {
            *eye = whole(Eye { azimuth: eye.azimuth, elevation: eye.elevation, ..Eye::of(view) }, view, size);
        }
    }

    /// Looks at a point from the same direction.
    pub(crate) fn look_at(&mut self, point: [f64; 3]) {
        if let Some(eye) = &mut self.eye {
            eye.target = point;
        }
    }

    pub(crate) fn zoom(&mut self, factor: f64) {
        if let Some(eye) = &mut self.eye {
            eye.radius = (eye.radius / factor).clamp(1e-6, 1e6);
        }
    }

    /// Rotates about the point in the centre of the view. If there is a floor, the camera does not go below it, where nothing
    /// could be seen.
    pub(crate) fn turn(&mut self, delta: Vec2, floor: bool) {
        if let Some(eye) = &mut self.eye {
            eye.azimuth -= f64::from(delta.x) * 0.4;
            eye.elevation = (eye.elevation + f64::from(delta.y) * 0.4).clamp(if floor { 1.0 } else { -85.0 }, 85.0);
        }
    }

    pub(crate) fn pan(&mut self, scales: &View, rect: Rect, delta: Vec2) {
        if let Some(eye) = &mut self.eye {
            let [right, up, _] = eye.axes(scales);
            let metres = 2.0 * eye.radius / f64::from(rect.height().min(rect.width()).max(1.0));
            for d in 0..3 {
                eye.target[d] += metres * (f64::from(delta.y) * up[d] - f64::from(delta.x) * right[d]);
            }
        }
    }

    /// The scene of the picture on the screen.
    pub(crate) fn seen(&self) -> Option<&Arc<Shown>> {
        self.seen.as_ref().map(|(shown, _)| shown)
    }

    /// The distance [m] from the camera of the picture on the screen to the point in the centre of the view. The distance of a held body is stored
    /// relative to this point, so that the body keeps its position when the camera moves closer.
    pub(crate) fn distance(&self, scales: &View, rect: Rect) -> Option<f64> {
        let target = self.seen.as_ref().map(|(_, eye)| *eye).or(self.eye)?.target;
        self.lens(scales, rect)?.see(target).map(|(_, distance)| distance)
    }

    /// The projection of points of space to points of the rectangle, as in the picture on the screen.
    pub(crate) fn lens(&self, scales: &View, rect: Rect) -> Option<Lens> {
        let eye = self.seen.as_ref().map(|(_, eye)| *eye).or(self.eye)?;
        Some(eye.lens(scales, [f64::from(rect.width()), f64::from(rect.height())]))
    }

    /// Receives a finished picture.
    pub(crate) fn receive(&mut self, ui: &Ui) {
        if let Some(Drawn { image, shown, eye }) = self.done.lock().unwrap_or_else(PoisonError::into_inner).take() {
            self.seen = Some((shown, eye));
            let size = [image.width() as usize, image.height() as usize];
            let picture = ColorImage::from_rgba_unmultiplied(size, image.pixels());
            match &mut self.texture {
                Some(texture) => texture.set(picture, TextureOptions::LINEAR),
                None => self.texture = Some(ui.ctx().load_texture("space", picture, TextureOptions::LINEAR)),
            }
        }
    }

    /// Shows the latest picture and orders the next one.
    pub(crate) fn show(
        &mut self,
        ui: &Ui,
        look: &Look<'_>,
        shown: &Arc<Shown>,
        scales: &View,
        (selected, longest): (Option<&str>, &Longest),
    ) {
        let Look { painter, rect, paper, range, .. } = *look;
        let Some(eye) = self.eye else { return };
        let fine = f64::from(ui.ctx().pixels_per_point());
        let shrink = (MOST_PIXELS / (f64::from(rect.width().max(rect.height())) * fine)).min(1.0) * fine;
        let side = |points: f32| ((f64::from(points) * shrink).round() as u32).max(1);
        let size = [side(rect.width()), side(rect.height())];
        // If a scene has only one body, the selected body needs no mark.
        let selected = selected.filter(|_| shown.bodies.len() > 1).map(String::from);
        let wanted: Last = (shown.opened, shown.frames, eye, size, paper.dark, fingerprint(shown), selected.clone());
        if self.last.as_ref() != Some(&wanted) && !self.busy.swap(true, Ordering::AcqRel) {
            self.last = Some(wanted.clone());
            let [r, g, b, _] = paper.background.to_array();
            let order = Order {
                shown: Arc::clone(shown),
                view: eye.view(scales),
                background: [r, g, b],
                size,
                range,
                eye,
                selected,
                longest: longest.clone(),
            };
            let (done, busy, context) = (Arc::clone(&self.done), Arc::clone(&self.busy), ui.ctx().clone());
            drop(crate::work::spawn(async move {
                // If a picture cannot be drawn, the last one stays on the screen.
                if let Some(drawn) = drawn(&order) {
                    *done.lock().unwrap_or_else(PoisonError::into_inner) = Some(drawn);
                }
                busy.store(false, Ordering::Release);
                context.request_repaint();
            }));
        }
        // If the picture shows the present moment, changes since it was ordered, such as a moved pointer of a pull, are drawn over it.
        if self.last.as_ref() == Some(&wanted)
            && !self.is_drawing()
            && let Some((seen, _)) = &mut self.seen
        {
            *seen = Arc::clone(shown);
        }
        if let Some(texture) = &self.texture {
            let all = Rect::from_min_max(egui::pos2(0.0, 0.0), egui::pos2(1.0, 1.0));
            painter.image(texture.id(), rect, all, Color32::WHITE);
        }
    }
}

/// Moves the camera back until it sees the whole box of a view, however narrow the picture is.
fn whole(mut eye: Eye, view: &View, size: Vec2) -> Eye {
    let sides = [f64::from(size.x), f64::from(size.y)];
    // When the camera moves back, different parts of the box shrink by different factors, so a few iterations are needed.
    for _ in 0..8 {
        let lens = eye.lens(view, sides);
        let mut most = 0.0_f64;
        for corner in 0..8 {
            let point = std::array::from_fn(|d| if corner >> d & 1 == 0 { view.low[d] } else { view.high[d] });
            // A point behind the camera counts as twice as far outside.
            let far = lens.see(point).map_or(2.0, |(pixel, _)| {
                [0, 1].map(|d| (pixel[d] / sides[d] - 0.5).abs() * 2.0).into_iter().fold(0.0, f64::max)
            });
            most = most.max(far);
        }
        if most <= FILLED {
            break;
        }
        eye.radius *= most / FILLED;
    }
    eye
}

/// A fingerprint of everything that may change the picture of a frame.
fn fingerprint(shown: &Shown) -> u64 {
    let picture = &shown.picture;
    let label = picture.legend.as_ref().map_or(0, |legend| legend.label.len() as u64 * 31 + legend.unit.len() as u64);
    let map = picture.legend.as_ref().map_or(0, |legend| legend.map as u64);
    let lines: usize = picture.bodies.iter().map(|b| b.segments.len() + usize::from(b.nodes_drawn)).sum();
    // If a body is moved at the start, its position changes although the frame is the same.
    let corners = shown.extents.iter().flat_map(|extent| extent.corners).flatten();
    let corner_bits = corners.fold(0_u64, |sum, x| sum.rotate_left(7) ^ x.to_bits());
    let counted = map * 1_000_000_007
        + label * 1_000_003
        + lines as u64 * 1_009
        + picture.arrows.len() as u64 * 7
        + picture.bodies.len() as u64;
    counted ^ corner_bits
}

/// Draws an order.
fn drawn(order: &Order) -> Option<Drawn> {
    let mut picture = order.shown.picture.clone();
    if let Some(legend) = &mut picture.legend {
        legend.range = Some(order.range);
    }
    // The interface itself draws labels and pulls, which are then sharper than in the picture.
    picture.pulls.clear();
    picture.bodies.iter_mut().for_each(|body| body.label.clear());
    let selected = order.shown.bodies.iter().position(|body| Some(&body.name) == order.selected.as_ref());
    if let Some(body) = selected.and_then(|index| picture.bodies.get_mut(index)) {
        body.outlined = Some(OUTLINE);
    }
    let mut view = order.view.clone();
    view.longest.clone_from(&order.longest.0);
    let image = draw_scene(&picture, &view, order.background, order.size).ok()?;
    Some(Drawn { image, shown: Arc::clone(&order.shown), eye: order.eye })
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga::draw::{BodyPicture, Picture};

    #[test]
    fn a_scene_is_seen_whole_on_a_wide_screen_and_on_a_phone_held_upright() {
        let corners = [[-3.0, 0.0, -1.0], [3.0, 0.5, 1.0], [-3.0, 0.0, 1.0], [3.0, 0.0, -1.0]];
        let body = BodyPicture { positions: corners.to_vec(), ..Default::default() };
        let view = View::fit([&Picture { dimension: 3, bodies: vec![body], ..Default::default() }]).expect("a view");
        for size in [Vec2::new(1280.0, 600.0), Vec2::new(390.0, 600.0), Vec2::new(200.0, 700.0)] {
            let mut space = Space::default();
            space.fit(&view, size);
            let rect = Rect::from_min_size(egui::Pos2::ZERO, size);
            let lens = space.lens(&view, rect).expect("an eye");
            let seen = corners.map(|corner| lens.see(corner).expect("before the camera").0);
            let inside =
                |[x, y]: &[f64; 2]| (0.0..=f64::from(size.x)).contains(x) && (0.0..=f64::from(size.y)).contains(y);
            assert!(seen.iter().all(inside), "{size:?}: {seen:?}");
            let wide =
                seen.iter().map(|p| p[0]).fold(f64::MIN, f64::max) - seen.iter().map(|p| p[0]).fold(f64::MAX, f64::min);
            let tall =
                seen.iter().map(|p| p[1]).fold(f64::MIN, f64::max) - seen.iter().map(|p| p[1]).fold(f64::MAX, f64::min);
            let filled = (wide / f64::from(size.x)).max(tall / f64::from(size.y));
            assert!(filled > 0.4, "{size:?}: it fills {filled}");
        }
    }
}
