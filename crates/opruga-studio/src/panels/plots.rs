//! Shows curves over time: energy, gas, momentum and computing time.

use crate::samples::Sample;
use crate::shown::Shown;
use crate::words::Language;
use egui::{Color32, RichText, Ui};
use egui_plot::{AxisHints, GridInput, GridMark, Line, Plot, PlotPoints, VLine};
use opruga::draw::{OKABE_ITO, format_tick, format_value, nice_ticks};
use std::sync::PoisonError;

/// A curve, divided into runs of points. Between two runs the values are unknown.
type Curve = Vec<Vec<[f64; 2]>>;

/// Shows the plots side by side. The curves of gas belong to the selected body.
pub fn show(ui: &mut Ui, shown: &Shown, words: Language, selected: Option<&str>, available: egui::Vec2) {
    let samples = shown.samples.read().unwrap_or_else(PoisonError::into_inner);
    let selected = shown.bodies.iter().find(|body| selected == Some(body.name.as_str()));
    let readings = selected.map_or(&[][..], |body| &body.readings);
    let beside = shown.beside.is_some();
    let volume = shown.beside.as_ref().is_some_and(|beside| beside.volume.is_some());
    let count = 3 + usize::from(!readings.is_empty()) + 2 * usize::from(beside) + usize::from(volume);
    let size = egui::vec2((available.x / count as f32 - 10.0).max(180.0), available.y);
    // After going back in time, the curves extend beyond the displayed moment.
    let now = (shown.frames < shown.latest).then_some(shown.time);
    let curve = |of: &dyn Fn(&Sample) -> Option<f64>| -> Curve {
        let point = |sample: &Sample| Some([sample.time, of(sample).filter(|x| x.is_finite())?]);
        let runs = samples.runs().flat_map(|run| run.split(|sample| point(sample).is_none()));
        runs.map(|run| run.iter().filter_map(point).collect()).filter(|run: &Vec<_>| !run.is_empty()).collect()
    };
    ui.horizontal(|ui| {
        if beside {
            let difference = |k: usize| curve(&|sample| Some(sample.beside?[k]));
            let names = [words.mean_distance(), words.largest_distance(), words.center_distance()];
            let lines = names.into_iter().zip(0..).map(|(name, k)| (name, difference(k)));
            let lines = lines.filter(|(_, runs)| !runs.is_empty()).collect();
            plot(ui, "distance", words.distance_of_sides(), size, now, lines);
            if volume {
                let unit = if shown.dimension == 3 { "m³" } else { "m²" };
                let title = format!("{} [{unit}]", words.volume_of_sides());
                plot(ui, "volume beside", &title, size, now, vec![("", difference(3))]);
            }
            plot(ui, "energy beside", words.energy_of_sides(), size, now, vec![("", difference(4))]);
        }
        let energies = [
            words.kinetic(),
            words.elastic(),
            words.of_gas(),
            words.of_gravity(),
            words.work(),
            words.losses(),
            words.numerical_damping(),
            words.integration_error(),
        ];
        let lines = energies.into_iter().zip(0..).map(|(name, k)| (name, curve(&|s| Some(s.energy[k])))).collect();
        plot(ui, "energy", words.energy(), size, now, lines);
        if let Some(body) = selected.filter(|_| !readings.is_empty()) {
            // Volume and pressure differ in magnitude, so each is shown as a fraction of its largest value.
            let share = |name: &str| {
                let value = |sample: &Sample| {
                    sample.readings_of(body.number).iter().find(|(other, _)| *other == name).map(|(_, x)| *x)
                };
                let values = samples.all().iter().filter_map(value).filter(|x| x.is_finite());
                let most = values.fold(0.0, |most: f64, x| most.max(x.abs()));
                curve(&|sample| value(sample).map(|x| if most > 0.0 { 100.0 * x / most } else { 0.0 }))
            };
            let named: Vec<String> = readings.iter().map(|(name, _)| words.reading(name)).collect();
            let lines = readings.iter().zip(&named).take(4).map(|((name, _), shown)| (shown.as_str(), share(name)));
            let title = format!("{}: {} [% max]", words.gas(), body.title);
            plot(ui, "gas", &title, size, now, lines.collect());
        }
        let axes = ["x", "y", "z"];
        let lines = (0..usize::from(shown.dimension)).map(|d| (axes[d], curve(&|s| Some(s.momentum[d])))).collect();
        plot(ui, "momentum", words.momentum(), size, now, lines);
        plot(ui, "cost", words.step_time(), size, now, vec![("", curve(&|s| Some(s.cost)))]);
    });
}

/// Returns about `count` round numbers on an axis. All marks get the spacing of the whole grid, so that they look alike.
fn marks(input: GridInput, count: usize) -> Vec<GridMark> {
    let ticks = nice_ticks(input.bounds.0, input.bounds.1, count);
    let step_size = ticks.windows(2).map(|pair| pair[1] - pair[0]).fold(input.bounds.1 - input.bounds.0, f64::min);
    ticks.into_iter().map(|value| GridMark { value, step_size }).collect()
}

/// The number at a mark, with as many digits as needed to distinguish it from its neighbours.
fn figure(mark: &GridMark) -> String {
    if mark.step_size > 0.0 { format_tick(mark.value, mark.step_size) } else { format_value(mark.value) }
}

/// Thins a curve for a number of screen columns. Of the points in one column, the first, the lowest, the highest and the last are kept.
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
        let mut indices: Vec<usize> = ends.map(|(index, _)| index).chain([0, group.len() - 1]).collect();
        indices.sort_unstable();
        indices.dedup();
        kept.extend(indices.into_iter().map(|index| group[index]));
    }
    kept
}

/// Shows one plot, with a vertical line at `now`.
fn plot(ui: &mut Ui, id: &str, title: &str, size: egui::Vec2, now: Option<f64>, lines: Vec<(&str, Curve)>) {
    let dark = ui.visuals().dark_mode;
    let ink = |number: usize| {
        let [r, g, b] = OKABE_ITO[number % OKABE_ITO.len()];
        // One of these colours is black, which is not visible on a dark background.
        if dark && (r, g, b) == (0, 0, 0) { Color32::from_gray(200) } else { Color32::from_rgb(r, g, b) }
    };
    ui.vertical(|ui| {
        let top = ui.cursor().top();
        ui.set_width(size.x);
        // The title has one line, because a second line would push the curve down. Hovering over it shows the whole text.
        ui.add(egui::Label::new(RichText::new(title).size(12.0).strong()).truncate());
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = egui::vec2(8.0, 0.0);
            for (number, (name, _)) in lines.iter().enumerate().filter(|(_, (name, _))| !name.is_empty()) {
                ui.label(RichText::new(*name).size(11.0).color(ink(number)));
            }
        });
        // The labels are short, so they may be close to one another.
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
        let weak = ui.visuals().weak_text_color();
        // Points that the screen cannot distinguish are not drawn, because a minute of simulated time has thousands of points.
        let ends = lines.iter().flat_map(|(_, curve)| curve).flat_map(|run| run.first().into_iter().chain(run.last()));
        let (first, last) = ends.fold((f64::MAX, f64::MIN), |(a, b), point| (a.min(point[0]), b.max(point[0])));
        let columns = |run: &[[f64; 2]]| {
            let share = if last > first { (run[run.len() - 1][0] - run[0][0]) / (last - first) } else { 1.0 };
            ((share * f64::from(size.x)) as usize).max(1)
        };
        let mut owned: Vec<(usize, String, Vec<[f64; 2]>)> = Vec::new();
        for (number, (name, curve)) in lines.into_iter().enumerate() {
            owned.extend(curve.into_iter().map(|run| {
                let columns = columns(&run);
                (number, name.to_string(), thinned(run, columns))
            }));
        }
        plot.show(ui, move |plot| {
            if let Some(now) = now {
                plot.vline(VLine::new("", now).color(weak).width(1.0));
            }
            for (number, name, points) in owned {
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
        // Curves with few points are not changed.
        assert_eq!(thinned(curve[..700].to_vec(), 180).len(), 700);
        assert_eq!(thinned(vec![[1.0, 2.0]; 900], 180).len(), 900);
        assert!(thinned(Vec::new(), 180).is_empty());
    }
}
