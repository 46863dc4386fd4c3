//! Curves of the last moments: energy, gas, momentum, computing time.

use crate::differences::Difference;
use crate::shown::Shown;
use crate::words::Language;
use egui::{Color32, RichText, Ui};
use egui_plot::{AxisHints, GridInput, GridMark, Line, Plot, PlotPoints};
use opruga::core::potential::Reading;
use opruga::draw::{OKABE_ITO, format_tick, format_value, nice_ticks};

/// The most moments that are kept.
const MOST: usize = 3_000;

/// One moment.
#[derive(Clone, Debug, Default)]
struct Moment {
    time: f64,
    energy: [f64; 7],
    momentum: [f64; 3],
    cost: f64,
    /// Mean and largest distance of the sides and that of their centres of mass, what the right one has more of volume and of
    /// energy; not a number where the sides have it not in common.
    beside: Option<[f64; 5]>,
    readings: Vec<Reading>,
}

/// What was seen.
#[derive(Debug, Default)]
pub struct Plots {
    moments: Vec<Moment>,
    opened: u64,
    /// What the right side differs in.
    differences: Option<Vec<Difference>>,
    body: Option<String>,
}

impl Plots {
    /// Keeps a moment; one that lies in the past takes those behind it away.
    pub fn remember(&mut self, shown: &Shown, selected: Option<&str>) {
        if self.opened != shown.opened || self.body.as_deref() != selected {
            self.opened = shown.opened;
            if self.body.as_deref() != selected {
                self.moments.iter_mut().for_each(|moment| moment.readings.clear());
            } else {
                self.moments.clear();
            }
            self.body = selected.map(String::from);
        }
        // What has differed from the start is computed from the start: the old curves are those of others.
        let differences = shown.beside.as_ref().map(|beside| beside.differences.clone());
        if self.differences != differences {
            self.differences = differences;
            self.moments.iter_mut().for_each(|moment| moment.beside = None);
        }
        if self.moments.last().is_some_and(|last| last.time == shown.time) {
            return;
        }
        self.moments.retain(|moment| moment.time < shown.time);
        if self.moments.len() >= MOST {
            // Every second of the older half goes: long runs stay whole.
            let half = MOST / 2;
            let mut place = 0;
            self.moments.retain(|_| {
                place += 1;
                place > half || place % 2 == 0
            });
        }
        let e = &shown.energy;
        let body = shown.bodies.iter().find(|body| selected == Some(body.name.as_str()));
        self.moments.push(Moment {
            time: shown.time,
            energy: [e.kinetic, e.elastic, e.gas, e.gravity, e.work, e.losses, e.error],
            momentum: shown.momentum,
            cost: 1e3 * shown.pace.frame_cost,
            beside: shown.beside.as_ref().filter(|beside| beside.stopped.is_none()).map(|beside| {
                let [mean, largest] = beside.distances.unwrap_or([f64::NAN; 2]);
                let [center, volume, energy] =
                    [beside.center, beside.volume, beside.energy].map(|x| x.unwrap_or(f64::NAN));
                [mean, largest, center, volume, energy]
            }),
            readings: body.map_or_else(Vec::new, |body| body.readings.clone()),
        });
    }

    /// Shows the curves side by side.
    pub fn show(&self, ui: &mut Ui, shown: &Shown, words: Language, selected: Option<&str>, room: egui::Vec2) {
        let gas = self.moments.last().is_some_and(|last| !last.readings.is_empty());
        let beside = shown.beside.is_some();
        let volume = shown.beside.as_ref().is_some_and(|beside| beside.volume.is_some());
        let count = 3 + usize::from(gas) + 2 * usize::from(beside) + usize::from(volume);
        let size = egui::vec2((room.x / count as f32 - 10.0).max(180.0), room.y);
        ui.horizontal(|ui| {
            let energies = [
                (words.kinetic(), 0),
                (words.elastic(), 1),
                (words.of_gas(), 2),
                (words.of_gravity(), 3),
                (words.work(), 4),
                (words.losses(), 5),
                (words.integration_error(), 6),
            ];
            let curve = |of: &dyn Fn(&Moment) -> f64| -> Vec<[f64; 2]> {
                self.moments.iter().map(|moment| [moment.time, of(moment)]).collect()
            };
            if beside {
                let difference = |k: usize| -> Vec<[f64; 2]> {
                    let there = |m: &Moment| Some([m.time, m.beside?[k]]).filter(|point| point[1].is_finite());
                    self.moments.iter().filter_map(there).collect()
                };
                let names = [words.mean_distance(), words.largest_distance(), words.center_distance()];
                let lines = names.into_iter().zip(0..).map(|(name, k)| (name, difference(k)));
                let lines = lines.filter(|(_, points)| !points.is_empty()).collect();
                plot(ui, "distance", words.distance_of_sides(), size, lines);
                if volume {
                    let unit = if shown.dimension == 3 { "m³" } else { "m²" };
                    let title = format!("{} [{unit}]", words.volume_of_sides());
                    plot(ui, "volume beside", &title, size, vec![("", difference(3))]);
                }
                plot(ui, "energy beside", words.energy_of_sides(), size, vec![("", difference(4))]);
            }
            let lines = energies.iter().map(|(name, k)| (*name, curve(&|m| m.energy[*k]))).collect();
            plot(ui, "energy", words.energy(), size, lines);
            if gas {
                let names: Vec<&str> =
                    self.moments.last().map_or_else(Vec::new, |m| m.readings.iter().map(|(name, _)| &**name).collect());
                // Volume and pressure differ in size: each is shown as a share of its largest value.
                let share = |name: &str| {
                    let values: Vec<[f64; 2]> = self
                        .moments
                        .iter()
                        .filter_map(|m| m.readings.iter().find(|(n, _)| *n == name).map(|(_, x)| [m.time, *x]))
                        .collect();
                    let most = values.iter().map(|v| v[1].abs()).fold(0.0, f64::max);
                    values.into_iter().map(|[t, x]| [t, if most > 0.0 { 100.0 * x / most } else { 0.0 }]).collect()
                };
                let named: Vec<String> = names.iter().map(|name| words.reading(name)).collect();
                let lines =
                    names.iter().zip(&named).take(4).map(|(name, shown)| (shown.as_str(), share(name))).collect();
                let body = shown.bodies.iter().find(|body| selected == Some(body.name.as_str()));
                let title = format!("{}: {} [% max]", words.gas(), body.map_or("", |body| body.title.as_str()));
                plot(ui, "gas", &title, size, lines);
            }
            let axes = ["x", "y", "z"];
            let lines = (0..usize::from(shown.dimension)).map(|d| (axes[d], curve(&|m| m.momentum[d]))).collect();
            plot(ui, "momentum", words.momentum(), size, lines);
            plot(ui, "cost", words.step_time(), size, vec![("", curve(&|m| m.cost))]);
        });
    }
}

/// About so many round numbers on an axis. Their distance is that of all of them, so that all are seen alike.
fn marks(input: GridInput, count: usize) -> Vec<GridMark> {
    let ticks = nice_ticks(input.bounds.0, input.bounds.1, count);
    let step_size = ticks.windows(2).map(|pair| pair[1] - pair[0]).fold(input.bounds.1 - input.bounds.0, f64::min);
    ticks.into_iter().map(|value| GridMark { value, step_size }).collect()
}

/// The figure of a mark, with as many digits as it takes to tell it from its neighbours.
fn figure(mark: &GridMark) -> String {
    if mark.step_size > 0.0 { format_tick(mark.value, mark.step_size) } else { format_value(mark.value) }
}

/// A curve as so many columns of a screen show it: of those points that share a column the first, the lowest, the highest and the
/// last.
fn thinned(points: Vec<[f64; 2]>, columns: usize) -> Vec<[f64; 2]> {
    let (Some(first), Some(last)) = (points.first(), points.last()) else { return points };
    if points.len() <= 4 * columns || last[0] <= first[0] {
        return points;
    }
    let (start, width) = (first[0], (last[0] - first[0]) / columns as f64);
    let column = |point: &[f64; 2]| ((point[0] - start) / width) as usize;
    let mut kept = Vec::with_capacity(4 * columns + 4);
    for group in points.chunk_by(|a, b| column(a) == column(b)) {
        let ends = group.iter().enumerate().min_by(|a, b| a.1[1].total_cmp(&b.1[1]));
        let ends = ends.into_iter().chain(group.iter().enumerate().max_by(|a, b| a.1[1].total_cmp(&b.1[1])));
        let mut places: Vec<usize> = ends.map(|(place, _)| place).chain([0, group.len() - 1]).collect();
        places.sort_unstable();
        places.dedup();
        kept.extend(places.into_iter().map(|place| group[place]));
    }
    kept
}

fn plot(ui: &mut Ui, id: &str, title: &str, size: egui::Vec2, lines: Vec<(&str, Vec<[f64; 2]>)>) {
    let dark = ui.visuals().dark_mode;
    let ink = |number: usize| {
        let [r, g, b] = OKABE_ITO[number % OKABE_ITO.len()];
        // Black is the seventh of these colours.
        if dark && (r, g, b) == (0, 0, 0) { Color32::from_gray(200) } else { Color32::from_rgb(r, g, b) }
    };
    ui.vertical(|ui| {
        let top = ui.cursor().top();
        ui.set_width(size.x);
        // One line: a second one would push the curve down. The pointer on it shows all of it.
        ui.add(egui::Label::new(RichText::new(title).size(12.0).strong()).truncate());
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = egui::vec2(8.0, 0.0);
            for (number, (name, _)) in lines.iter().enumerate().filter(|(_, (name, _))| !name.is_empty()) {
                ui.label(RichText::new(*name).size(11.0).color(ink(number)));
            }
        });
        // Short words, which may stand close to one another.
        let seconds = AxisHints::new_x().label_spacing(24.0..=32.0);
        let seconds = seconds.formatter(|mark, _| format!("{} s", figure(&mark)));
        let plot = Plot::new(id)
            .width(size.x)
            .height((size.y - (ui.cursor().top() - top) - 12.0).max(40.0))
            .allow_scroll(false)
            .allow_drag(false)
            .allow_zoom(false)
            .allow_boxed_zoom(false)
            .x_grid_spacer(|input| marks(input, 3))
            .y_grid_spacer(|input| marks(input, 4))
            .custom_x_axes(vec![seconds])
            .y_axis_formatter(|mark, _| figure(&mark))
            .y_axis_min_width(30.0);
        // What the screen cannot tell apart is not drawn: a minute has thousands of moments.
        let columns = size.x.max(1.0) as usize;
        let owned: Vec<(String, Vec<[f64; 2]>)> =
            lines.into_iter().map(|(n, l)| (n.to_string(), thinned(l, columns))).collect();
        plot.show(ui, move |plot| {
            for (number, (name, points)) in owned.into_iter().enumerate() {
                plot.line(Line::new(name, PlotPoints::from(points)).color(ink(number)).width(1.6));
            }
        });
    });
}

#[cfg(test)]
mod tests {
    use super::{figure, thinned};
    use egui_plot::GridMark;

    #[test]
    fn neighbours_on_an_axis_have_different_figures() {
        let of = |value, step_size| figure(&GridMark { value, step_size });
        assert_eq!([of(110.2, 0.2), of(110.4, 0.2)], ["110.2", "110.4"]);
        assert_eq!([of(109.75, 0.25), of(110.0, 0.25)], ["109.75", "110.00"]);
        assert_eq!([of(0.0, 5.0), of(5.0, 5.0), of(10.0, 5.0)], ["0", "5", "10"]);
        assert_eq!(of(0.25, 0.0), "0.25");
    }

    #[test]
    fn curves_of_many_moments_keep_their_ends_and_extremes_and_lose_what_nobody_sees() {
        let mut curve: Vec<[f64; 2]> = (0..3000).map(|k| [f64::from(k) / 60.0, f64::from(k % 7)]).collect();
        curve[1234][1] = 90.0;
        curve[2345][1] = -80.0;
        let kept = thinned(curve.clone(), 180);
        assert!(kept.len() <= 4 * 181, "{}", kept.len());
        assert_eq!((kept[0], kept[kept.len() - 1]), (curve[0], curve[2999]));
        assert!(kept.contains(&curve[1234]) && kept.contains(&curve[2345]));
        assert!(kept.windows(2).all(|pair| pair[0][0] < pair[1][0]), "in the order of time");
        // Few points, and those of one moment, stay as they are.
        assert_eq!(thinned(curve[..700].to_vec(), 180).len(), 700);
        assert_eq!(thinned(vec![[1.0, 2.0]; 900], 180).len(), 900);
        assert!(thinned(Vec::new(), 180).is_empty());
    }
}
