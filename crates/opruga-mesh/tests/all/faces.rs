//! Faces with many corners, cut into triangles: areas in closed form.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use opruga_mesh::{FaceError, cut_face};

fn subtract(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|d| a[d] - b[d])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|d| a[d] * b[d]).sum()
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Outlines, and their areas in closed form.
fn outlines() -> Vec<(&'static str, Vec<[f64; 2]>, f64, bool)> {
    let star: Vec<[f64; 2]> = (0..10)
        .map(|k| {
            let (s, c) = (std::f64::consts::TAU * f64::from(k) / 10.0).sin_cos();
            let r = if k % 2 == 0 { 1.0 } else { 0.4 };
            [r * c, r * s]
        })
        .collect();
    // Ten triangles, each from the centre to a tip and a notch.
    let of_star = 10.0 * 0.5 * 0.4 * (std::f64::consts::PI / 5.0).sin();
    // A comb: no corner sees all of it.
    let mut comb = vec![[0.0, 0.0], [9.0, 0.0]];
    (0..5).rev().for_each(|k| {
        let x = 2.0 * f64::from(k);
        comb.extend([[x + 1.0, 4.0], [x, 4.0]]);
        if k > 0 {
            comb.extend([[x, 1.0], [x - 1.0, 1.0]]);
        }
    });
    let ring = |n: u32| -> Vec<[f64; 2]> {
        (0..n).map(|k| (std::f64::consts::TAU * f64::from(k) / f64::from(n)).sin_cos()).map(|(s, c)| [c, s]).collect()
    };
    vec![
        ("a square", vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1.0, false),
        ("a dart", vec![[0.0, 0.0], [2.0, 1.0], [0.0, 2.0], [0.7, 1.0]], 1.3, true),
        ("a triangle with a corner on a side", vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [0.0, 2.0]], 2.0, false),
        ("an L", vec![[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]], 4.0, true),
        ("a star", star, of_star, true),
        ("a comb", comb, 9.0 + 15.0, true),
        ("64 corners", ring(64), 32.0 * (std::f64::consts::TAU / 64.0).sin(), false),
    ]
}

/// Cut starting at every corner, in both directions and in every pose: the triangles all have the orientation of the face, and their areas add up to
/// its area.
#[test]
fn faces_are_cut_inside_from_every_corner_and_keep_their_winding() {
    // Rotated about two axes, and far away.
    let poses = [
        |[x, y]: [f64; 2]| [x, y, 0.0],
        |[x, y]: [f64; 2]| [0.0, 1e3 * x, 1e3 * y],
        |[x, y]: [f64; 2]| [0.6 * x - 0.48 * y + 100.0, 0.8 * x + 0.36 * y, 0.8 * y - 40.0],
        |[x, y]: [f64; 2]| [1e-9 * (0.6 * x - 0.48 * y), 1e-9 * (0.8 * x + 0.36 * y), 1e-9 * 0.8 * y],
    ];
    for (name, outline, area, concave) in outlines() {
        for (pose, scale) in poses.into_iter().zip([1.0, 1e3, 1.0, 1e-9]) {
            for start in 0..outline.len() {
                for backward in [false, true] {
                    let mut corners: Vec<[f64; 3]> = outline.iter().map(|p| pose(*p)).collect();
                    corners.rotate_left(start);
                    if backward {
                        corners.reverse();
                    }
                    let [o, x, y] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]].map(pose);
                    let up = cross(subtract(x, o), subtract(y, o));
                    let up = up.map(|u| if backward { -u } else { u } / dot(up, up).sqrt());
                    let cut = cut_face(&corners).unwrap_or_else(|e| panic!("{name} from {start}: {e:?}"));
                    let mut sum = 0.0;
                    for triangle in &cut.triangles {
                        let [a, b, c] = triangle.map(|k| corners[k as usize]);
                        let part = 0.5 * dot(cross(subtract(b, a), subtract(c, a)), up) / (scale * scale);
                        assert!(part > 0.0, "{name} from {start}: {triangle:?} has {part}");
                        sum += part;
                    }
                    assert!((sum - area).abs() < 1e-9, "{name} from {start}: {sum}, not {area}");
                    assert_eq!((cut.triangles.len(), cut.concave), (outline.len() - 2, concave), "{name}");
                    assert!(cut.bent < 1e-9, "{name}: {}", cut.bent);
                }
            }
        }
    }
}

#[test]
fn convex_quadrilaterals_are_cut_along_their_shorter_diagonal() {
    let kite = |half: f64| [[-1.0, 0.0, 0.0], [0.0, -half, 0.0], [1.0, 0.0, 0.0], [0.0, half, 0.0]];
    assert_eq!(cut_face(&kite(2.0)).expect("a kite").triangles, [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(cut_face(&kite(0.5)).expect("a kite").triangles, [[1, 2, 3], [1, 3, 0]]);
    // Both diagonals of a square have the same length.
    assert_eq!(cut_face(&kite(1.0)).expect("a square").triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn faces_that_cross_themselves_or_are_folded_far_are_refused() {
    let flat = |points: &[[f64; 2]]| cut_face(&points.iter().map(|[x, y]| [*x, *y, 1.0]).collect::<Vec<_>>());
    let pentagram: Vec<[f64; 2]> = (0..5)
        .map(|k| {
            let (s, c) = (std::f64::consts::TAU * f64::from(2 * k) / 5.0).sin_cos();
            [c, s]
        })
        .collect();
    for (name, points) in [
        ("a bow", vec![[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]),
        ("a bow of unlike halves", vec![[0.0, 0.0], [3.0, 3.0], [3.0, 0.0], [0.0, 1.0]]),
        ("a pentagram", pentagram),
        ("a line", vec![[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [3.0, 0.0]]),
        ("one point", vec![[1.0, 1.0]; 4]),
        ("two corners at one place", vec![[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]),
        ("a corner on a side", vec![[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0]]),
        ("a loop", vec![[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [1.0, 2.0], [5.0, 2.0], [0.0, 4.0]]),
    ] {
        assert_eq!(flat(&points), Err(FaceError::Crossing), "{name}");
    }
    // A square folded along a diagonal: its corners are a quarter of the height off the mean plane, on either side.
    let folded = |height: f64| cut_face(&[[0.0, 0.0, height], [1.0, 0.0, 0.0], [1.0, 1.0, height], [0.0, 1.0, 0.0]]);
    let bent = folded(0.4).expect("a face").bent;
    assert!((bent - 0.2).abs() < 1e-12, "{bent}");
    assert!(matches!(folded(0.8), Err(FaceError::Folded(x)) if (x - 0.4).abs() < 1e-12), "{:?}", folded(0.8));
    assert_eq!(cut_face(&[[0.0; 3], [f64::MAX; 3], [-f64::MAX; 3]]), Err(FaceError::Crossing));
}
