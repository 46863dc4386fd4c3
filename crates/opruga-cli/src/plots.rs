//! Plots of a run and of a benchmark.

use crate::bench::Row;
use opruga::draw::{Axis, Chart, DrawError, Level, Line, Marker, Panel};
use opruga::io::tables::NumberTable;

/// Energy, losses, momentum, volumes, pressures and, from the column `first_probe` on, probes over time.
pub(crate) fn of_run(table: &NumberTable, first_probe: usize, name: &str) -> Result<String, DrawError> {
    let columns = table.columns();
    let line = |place: usize, name: &str| Line {
        name: name.replace('_', " "),
        points: table.rows().map(|row| [row[0], row[place]]).collect(),
        ..Line::default()
    };
    let named = |names: &[&str]| -> Vec<Line> {
        // A channel in which nothing happened says nothing.
        let moved = |p: usize| table.rows().any(|row| row[p] != 0.0);
        let mut lines = Vec::new();
        for name in names {
            if let Some(place) = columns.iter().position(|c| c == name)
                && moved(place)
            {
                lines.push(line(place, name));
            }
        }
        lines
    };
    let ending = |ending: &str| -> Vec<Line> {
        // Probes have a panel of their own.
        let columns = &columns[..first_probe];
        let fits = |c: &&(usize, &String)| c.1.ends_with(ending);
        let all: Vec<(usize, &String)> = columns.iter().enumerate().collect();
        all.iter().filter(fits).take(8).map(|(p, c)| line(*p, c.strip_suffix(ending).unwrap_or(c))).collect()
    };
    let probes: Vec<Line> = (first_probe..columns.len()).take(8).map(|p| line(p, &columns[p])).collect();
    let panel =
        |label: &str, unit: &str, lines: Vec<Line>| Panel { y: Axis::linear(label, unit), lines, ..Panel::default() };
    let panels = vec![
        panel("energy", "J", named(&["kinetic", "elastic", "gas", "gravity"])),
        panel(
            "work and losses",
            "J",
            named(&[
                "work_user",
                "work_gas",
                "work_correction",
                "loss_damping",
                "loss_friction",
                "loss_contact",
                "loss_integrator",
            ]),
        ),
        panel("momentum", "kg m/s", named(&["momentum.x", "momentum.y", "momentum.z"])),
        panel("volume", "m³", ending(".volume")),
        panel("pressure", "Pa", ending(".pressure")),
        panel("probes", "", probes),
    ];
    let chart = Chart {
        title: name.to_string(),
        x: Axis::linear("time", "s"),
        panels: panels.into_iter().filter(|p| !p.lines.is_empty()).collect(),
        ..Chart::default()
    };
    if chart.panels.is_empty() {
        let empty = panel("energy", "J", vec![line(1, "kinetic")]);
        return Chart { panels: vec![empty], ..chart }.to_svg();
    }
    chart.to_svg()
}

/// Frames a second against vertices, with the thesis's 40 FPS: its figure 4.
pub(crate) fn of_bench(rows: &[Row]) -> Result<String, DrawError> {
    let points = |many: bool| -> Vec<[f64; 2]> {
        rows.iter().filter(|r| (r.bodies() > 1) == many).map(|r| [r.point().0, r.point().1]).collect()
    };
    let line = |name: &str, points, marker| Line { name: name.into(), points, marker: Some(marker), ..Line::default() };
    let lines =
        vec![line("one ring", points(false), Marker::Circle), line("many rings of 36", points(true), Marker::Square)];
    Chart {
        title: "speed against the number of vertices".into(),
        x: Axis::logarithmic("vertices", ""),
        panels: vec![Panel {
            height: 360.0,
            y: Axis::logarithmic("frames a second (16 steps each)", "1/s"),
            lines: lines.into_iter().filter(|l| !l.points.is_empty()).collect(),
            levels: vec![Level { value: 40.0, label: "the thesis: 40 FPS at 8 vertices".into() }],
        }],
        ..Chart::default()
    }
    .to_svg()
}
