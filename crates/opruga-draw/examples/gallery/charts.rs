//! Synthetic plots.

use opruga_draw::{Axis, Chart, Level, Line, Marker, Panel};

/// A line through the values of a function of time.
fn line(name: &str, value: impl Fn(f64) -> f64) -> Line {
    let points = (0..=800).map(|step| f64::from(step) * 0.005).map(|time| [time, value(time)]).collect();
    Line { name: name.to_string(), points, ..Line::default() }
}

/// The ledger of energies, the volume and the pressure of a bouncing body.
pub(crate) fn ledger() -> Chart {
    let bounce = |time: f64| 1.0 - 4.0 * ((time % 1.0) - 0.5).powi(2);
    let lost = |time: f64| 3.0 * (1.0 - (-0.25 * time).exp());
    let height = move |time: f64| 9.0 * bounce(time) * (-0.2 * time).exp();
    let spring = |time: f64| 5.0 * (-(((time + 0.5) % 1.0) - 0.5).powi(2) / 0.004).exp() * (-0.2 * time).exp();
    Chart {
        title: "Energy ledger of a bouncing ball".to_string(),
        x: Axis::linear("time", "s"),
        panels: vec![
            Panel {
                height: 240.0,
                y: Axis::linear("energy", "J"),
                lines: vec![
                    line("height", height),
                    line("springs", spring),
                    line("motion", move |time| 12.0 - height(time) - spring(time) - lost(time)),
                    line("lost to damping", lost),
                    Line { dashed: true, colour: Some([0, 0, 0]), ..line("sum", |_| 12.0) },
                ],
                ..Panel::default()
            },
            Panel {
                height: 120.0,
                y: Axis::linear("volume", "m²"),
                lines: vec![line("", move |time| 0.785 - 0.03 * spring(time))],
                levels: vec![Level { value: 0.785, label: "at rest".to_string() }],
            },
            Panel {
                height: 120.0,
                y: Axis::linear("pressure", "kPa"),
                lines: vec![Line { colour: Some([213, 94, 0]), ..line("", move |time| 101.3 + 1.4 * spring(time)) }],
                ..Panel::default()
            },
        ],
        ..Chart::default()
    }
}

/// Frames per second against the number of vertices.
pub(crate) fn speed() -> Chart {
    let curve = |name: &str, rate: f64, marker: Marker| Line {
        name: name.to_string(),
        points: (4..=20).map(|power| 2_f64.powi(power)).map(|n| [n, rate / (n + 40.0) / (1.0 + n / 3e5)]).collect(),
        marker: Some(marker),
        ..Line::default()
    };
    Chart {
        title: "Speed over the number of vertices".to_string(),
        x: Axis::logarithmic("vertices", ""),
        panels: vec![Panel {
            height: 340.0,
            y: Axis::logarithmic("frames per second", "1/s"),
            lines: vec![
                curve("explicit Euler", 2.5e7, Marker::Circle),
                curve("midpoint & <Heun>", 1.2e7, Marker::Square),
                curve("Runge–Kutta 4", 6e6, Marker::Triangle),
                curve("implicit", 9e5, Marker::Diamond),
            ],
            levels: vec![Level { value: 40.0, label: "40 frames per second".to_string() }],
        }],
        ..Chart::default()
    }
}
