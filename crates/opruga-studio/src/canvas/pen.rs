//! Converts a line drawn by hand to a body: it is closed, resampled, and refused if it crosses itself.

use toml_edit::InlineTable;

/// The smallest and the largest number of vertices of a drawn body.
const VERTICES: [usize; 2] = [24, 160];

/// Makes the table of the body that a line encloses. `finest` is the shortest length that a hand can draw [m].
///
/// # Errors
/// The keyword of the reason why the line is refused.
pub(crate) fn body(line: &[[f64; 2]], finest: f64) -> Result<InlineTable, &'static str> {
    let length: f64 = sides(line).map(|(a, b)| far(a, b)).sum();
    if line.len() < 3 || length < 16.0 * finest {
        return Err("too_small");
    }
    let count = ((length / finest) as usize / 2).clamp(VERTICES[0], VERTICES[1]);
    let mut points = smooth(&resample(line, length, count));
    if crosses(&points) {
        return Err("crossing");
    }
    let turned = 0.5 * sides(&points).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>();
    let area = turned.abs();
    // Outlines are counter-clockwise, whatever the direction of the drawing was.
    if turned < 0.0 {
        points.reverse();
    }
    if area < 30.0 * finest * finest {
        return Err("too_small");
    }
    // The stiffness of the springs times the number of vertices is the same as for the ball in the thesis. The gas preserves the area against the
    // ambient pressure, whatever the size of the body.
    let stiffness = 57_600.0 / count as f64;
    let pressure = 120.0;
    let rows: Vec<String> = points.iter().map(|p| format!("[{:.5}, {:.5}]", p[0], p[1])).collect();
    let text = format!(
        "{{ name = \"drawn\", shape = {{ kind = \"polygon\", points = [{}] }}, mass = 1.0, models = [\
         {{ kind = \"mass_spring\", stiffness = {stiffness:.1}, damping = 0.5 }}, \
         {{ kind = \"bending\", stiffness = {:.4} }}, \
         {{ kind = \"pressure\", pressure = {pressure:.1}, ambient = {pressure:.1} }}] }}",
        rows.join(", "),
        0.02 * length / core::f64::consts::PI,
    );
    let value = text.parse::<toml_edit::Value>().map_err(|_| "too_small")?;
    value.as_inline_table().cloned().ok_or("too_small")
}

fn far(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The sides of the closed line.
fn sides(line: &[[f64; 2]]) -> impl Iterator<Item = ([f64; 2], [f64; 2])> + '_ {
    (0..line.len()).map(|k| (line[k], line[(k + 1) % line.len()]))
}

/// Points at equal distances along the closed line.
fn resample(line: &[[f64; 2]], length: f64, count: usize) -> Vec<[f64; 2]> {
    let step = length / count as f64;
    let (mut out, mut gone) = (Vec::with_capacity(count), 0.0);
    for (a, b) in sides(line) {
        let side = far(a, b);
        while out.len() < count && out.len() as f64 * step < gone + side {
            let share = (out.len() as f64 * step - gone) / side;
            out.push([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]);
        }
        gone += side;
    }
    out
}

/// Smooths the trembling of the hand: every point moves to the mean of itself and its neighbours.
fn smooth(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let n = points.len();
    (0..n)
        .map(|k| {
            let (a, b, c) = (points[(k + n - 1) % n], points[k], points[(k + 1) % n]);
            [0.25 * (a[0] + 2.0 * b[0] + c[0]), 0.25 * (a[1] + 2.0 * b[1] + c[1])]
        })
        .collect()
}

/// Whether two sides that are not neighbours intersect.
fn crosses(points: &[[f64; 2]]) -> bool {
    let n = points.len();
    let turn = |a: [f64; 2], b: [f64; 2], c: [f64; 2]| (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    for i in 0..n {
        let (a, b) = (points[i], points[(i + 1) % n]);
        for j in i + 2..n {
            if (j + 1) % n == i {
                continue;
            }
            let (c, d) = (points[j], points[(j + 1) % n]);
            // Collinear sides intersect only if they overlap.
            let apart = |k: usize| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]);
            if apart(0) || apart(1) {
                continue;
            }
            if turn(a, b, c) * turn(a, b, d) <= 0.0 && turn(c, d, a) * turn(c, d, b) <= 0.0 {
                return true;
            }
        }
    }
    false
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(point: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 2]> {
        (0..300).map(|k| point(f64::from(k) / 300.0 * core::f64::consts::TAU)).collect()
    }

    #[test]
    fn a_drawn_circle_becomes_a_body_and_an_eight_is_refused() {
        let text = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1.0\nframe = 0.0166\nsubsteps = 32\n[integrator]\nkind = \"verlet\"\n[[body]]\n";
        // Whatever the direction of the drawing, the result is the same.
        for way in [1.0, -1.0] {
            let table = body(&line(|t| [(way * t).cos(), 1.5 + (way * t).sin()]), 0.02).expect("a body");
            let whole = format!("{text}{}", table.into_table());
            let read =
                opruga::io::scene::read(whole.as_bytes(), "drawn.toml", &opruga::catalogue(), &Default::default());
            let (_, notices) = read.expect("a scene");
            assert!(notices.iter().all(|notice| notice.about.code != "shape.flipped"), "{notices:?}");
        }
        assert_eq!(body(&line(|t| [t.sin(), (2.0 * t).sin()]), 0.02).err(), Some("crossing"));
        assert_eq!(body(&line(|t| [0.01 * t.cos(), 0.01 * t.sin()]), 0.02).err(), Some("too_small"));
        assert_eq!(body(&[[0.0, 0.0], [9.0, 0.0]], 0.02).err(), Some("too_small"));
        // There and back on one line.
        assert_eq!(body(&[[0.0, 0.0], [9.0, 0.0], [2.0, 0.0]], 0.02).err(), Some("crossing"));
    }

    #[test]
    fn lines_that_are_straight_to_the_last_bit_do_not_cross_themselves() {
        for corners in [&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]][..], &[[0.0, 0.0], [2.0, 0.0], [1.0, 1.5]]] {
            assert!(body(corners, 0.02).is_ok(), "{corners:?}");
        }
        let step = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [3.0, 1.0], [3.0, 2.0], [0.0, 2.0]];
        assert!(body(&step, 0.02).is_ok());
        let eight = [[0.0, 0.0], [2.0, 0.0], [0.0, 2.0], [2.0, 2.0]];
        assert_eq!(body(&eight, 0.02).err(), Some("crossing"));
    }
}
