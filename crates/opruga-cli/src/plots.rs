//! Plots of a run and of a benchmark.

use crate::bench::vertices::Row;
use crate::recorder::Columns;
use opruga::blueprint::Recorded;
use opruga::draw::{Axis, Chart, DrawError, Level, Line, Marker, OKABE_ITO, Panel, format_value};
use opruga::io::tables::NumberTable;

/// The largest number of lines in a panel. If there are more bodies, their mean and their range are drawn.
const MOST_LINES: usize = 8;

/// A table and the meanings of its columns.
struct Run<'a> {
    table: &'a NumberTable,
    columns: &'a Columns,
}

/// Energy, losses, momentum, volumes, pressures and probes over time.
pub(crate) fn of_run(table: &NumberTable, columns: &Columns, name: &str) -> Result<String, DrawError> {
    let run = Run { table, columns };
    let length = &columns.length_unit;
    let metres = length == "m";
    let energy = if metres { "J".into() } else { format!("kg {length}²/s²") };
    let force = if metres { "N".into() } else { format!("kg {length}/s²") };
    let panel =
        |label: &str, unit: &str, lines: Vec<Line>| Panel { y: Axis::linear(label, unit), lines, ..Panel::default() };
    let mut panels = vec![
        panel("energy", &energy, run.energies()),
        panel(
            "work and losses",
            &energy,
            run.named(&[
                "work_user",
                "work_gas",
                "work_correction",
                "loss_damping",
                "loss_friction",
                "loss_contact",
                "loss_numerical",
                "loss_integrator",
            ]),
        ),
        panel("momentum", &format!("kg {length}/s"), run.momentum()),
    ];
    // The thesis uses the words volume and pressure for other quantities.
    for published in [false, true] {
        let panel_title = |what: &str| if published { format!("{what} as published") } else { what.to_string() };
        let (what, power) = if columns.dimension == 2 && !published { ("area", "²") } else { ("volume", "³") };
        let power = if published { "²" } else { power };
        let pressure = match (published, metres) {
            (true, _) => String::new(),
            (false, true) => "Pa".into(),
            (false, false) => format!("kg/({length} s²)"),
        };
        panels.push(panel(&panel_title(what), &format!("{length}{power}"), run.readings("volume", published)));
        panels.push(panel(&panel_title("pressure"), &pressure, run.readings("pressure", published)));
    }
    for (what, label, unit) in [
        (Recorded::Position, "position", length.clone()),
        (Recorded::Velocity, "velocity", format!("{length}/s")),
        (Recorded::Reaction, "reaction", force.clone()),
        (Recorded::Contact, "contact", force),
        (Recorded::Stress, "stress", if metres { "Pa".into() } else { format!("kg/({length} s²)") }),
        (Recorded::VolumeRatio, "volume ratio", String::new()),
    ] {
        panels.push(panel(label, &unit, run.probes(what)));
    }
    panels.retain(|panel| !panel.lines.is_empty());
    if panels.is_empty() {
        panels.push(panel("energy", &energy, vec![run.line(1, "kinetic")]));
    }
    let x = Axis::linear("time", "s");
    Chart { title: name.into(), x, panels, credit: columns.credit.clone(), ..Chart::default() }.to_svg()
}

impl Run<'_> {
    /// The line of a column.
    fn line(&self, index: usize, name: &str) -> Line {
        let points = self.table.rows().map(|row| [row[0], row[index]]).collect();
        Line { name: name.replace('_', " "), points, ..Line::default() }
    }

    /// The index of a column.
    fn index_of(&self, name: &str) -> Option<usize> {
        self.table.columns().iter().position(|column| column == name)
    }

    /// The lines of columns that are not zero everywhere. The other columns contain no information.
    fn named(&self, names: &[&str]) -> Vec<Line> {
        let indices = names.iter().filter_map(|name| Some((self.index_of(name)?, name)));
        indices
            .filter(|(index, _)| self.table.rows().any(|row| row[*index] != 0.0))
            .map(|(index, name)| self.line(index, name))
            .collect()
    }

    /// The largest number of a column.
    fn largest(&self, index: usize) -> f64 {
        self.table.rows().map(|row| row[index]).fold(0.0, f64::max)
    }

    /// The energies. An energy that hardly changes compared with its size is drawn relative to its initial value, because its zero has no meaning,
    /// and its size would flatten the other lines.
    fn energies(&self) -> Vec<Line> {
        let mut lines = self.named(&["kinetic", "elastic", "gas", "gravity"]);
        for line in &mut lines {
            let values = || line.points.iter().map(|point| point[1]).filter(|value| value.is_finite());
            let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
            let first = values().next().unwrap_or(0.0);
            if first.abs() > 3.0 * (high - low) {
                line.points.iter_mut().for_each(|point| point[1] -= first);
                let sign = if first < 0.0 { '+' } else { '−' };
                line.name = format!("{} {sign} {}", line.name, format_value(first.abs()));
            }
        }
        lines
    }

    /// The momentum along the axes.
    fn momentum(&self) -> Vec<Line> {
        let axes = ["x", if self.columns.y_down { "y (downwards)" } else { "y" }, "z"];
        let mut lines = Vec::new();
        for (axis, name) in ["x", "y", "z"].iter().zip(axes) {
            lines.extend(self.index_of(&format!("momentum.{axis}")).map(|index| self.line(index, name)));
        }
        // A rounding error of forces that cancel is not a momentum. It is negligible compared with √(2 E).
        let kinetic = self.index_of("kinetic").map_or(0.0, |index| self.largest(index));
        lines.retain(|line| line.points.iter().any(|point| point[1].abs() > 1e-9 * (2.0 * kinetic).sqrt()));
        lines
    }

    /// The readings of the models of bodies. In the plane, a volume is drawn as the area of its base.
    fn readings(&self, what: &str, published: bool) -> Vec<Line> {
        let mut lines = Vec::new();
        for (name, thickness, _) in self.columns.bodies.iter().filter(|body| body.2 == published) {
            // For a body with several chambers, each chamber is more informative than their mean.
            let chambers = (1..).map_while(|n| {
                self.index_of(&format!("{name}.chamber{n}.{what}")).map(|index| (index, format!("{name}, chamber {n}")))
            });
            let mut indices: Vec<(usize, String)> = chambers.collect();
            if indices.is_empty() {
                indices.extend(self.index_of(&format!("{name}.{what}")).map(|index| (index, name.clone())));
            }
            for (index, name) in indices {
                let mut line = Line { name, ..self.line(index, "") };
                if what == "volume" && self.columns.dimension == 2 && !published {
                    line.points.iter_mut().for_each(|point| point[1] /= thickness);
                }
                lines.push(line);
            }
        }
        if lines.len() > MOST_LINES { vec![mean_and_range(&lines)] } else { lines }
    }

    /// The probes that record something.
    fn probes(&self, what: Recorded) -> Vec<Line> {
        let names = self.table.columns();
        let first = names.len() - self.columns.probes.len();
        let fits = self.columns.probes.iter().enumerate().filter(|(_, recorded)| **recorded == what);
        let mut lines: Vec<Line> = fits.map(|(probe, _)| self.line(first + probe, &names[first + probe])).collect();
        for (number, line) in lines.iter_mut().enumerate() {
            line.dashed = number / OKABE_ITO.len() % 2 == 1;
            if self.columns.y_down && line.name.ends_with('y') {
                line.name.push_str(" (downwards)");
            }
        }
        lines
    }
}

/// The mean of many lines over the same abscissae, with the band between the lowest and the highest.
fn mean_and_range(lines: &[Line]) -> Line {
    let mut mean = Line { name: format!("mean of {} bodies, and their range", lines.len()), ..Line::default() };
    for index in 0..lines[0].points.len() {
        let values = || lines.iter().map(|line| line.points[index][1]).filter(|value| value.is_finite());
        let (sum, count) = values().fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
        let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
        let x = lines[0].points[index][0];
        mean.points.push([x, sum / count]);
        if count > 0.0 {
            mean.band.push([x, low, high]);
        }
    }
    mean
}

/// Frames per second against vertices, as in figure 4 of the thesis, with the 40 FPS of the thesis.
pub(crate) fn of_bench(rows: &[Row]) -> Result<String, DrawError> {
    let points = |many: bool| -> Vec<[f64; 2]> {
        rows.iter().filter(|r| (r.bodies() > 1) == many).map(|r| [r.point().0, r.point().1]).collect()
    };
    let line = |name: &str, points, marker| Line { name: name.into(), points, marker: Some(marker), ..Line::default() };
    let lines = vec![
        line("one ring", points(false), Marker::Circle),
        line("many rings of 36", points(true), Marker::Square),
        line("the thesis (2012), displayed", vec![[8.0, 40.0]], Marker::Diamond),
    ];
    Chart {
        title: "speed against the number of vertices".into(),
        x: Axis::logarithmic("vertices", ""),
        panels: vec![Panel {
            height: 360.0,
            y: Axis::logarithmic("frames of 16 steps", "1/s"),
            lines: lines.into_iter().filter(|l| !l.points.is_empty()).collect(),
            levels: vec![Level { value: 40.0, label: "40 FPS".into() }],
        }],
        ..Chart::default()
    }
    .to_svg()
}
