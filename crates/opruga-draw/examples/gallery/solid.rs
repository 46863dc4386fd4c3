//! Synthetic pictures in three dimensions.

use opruga_draw::{
    ArrowKind, ArrowPicture, BodyPicture, ColliderPicture, ColourMap, Facets, Legend, Picture, PullPicture,
};
use std::f64::consts::{PI, TAU};

/// A floor at height zero.
fn floor() -> ColliderPicture {
    ColliderPicture::HalfSpace { point: [0.0; 3], normal: [0.0, 1.0, 0.0] }
}

/// A legend with the range of the run.
fn legend(label: &str, unit: &str) -> Option<Legend> {
    Some(Legend { label: label.to_string(), unit: unit.to_string(), range: None, map: ColourMap::Viridis })
}

/// The triangles of nodes in rows; `closed` joins the last column to the first.
fn rows_of_triangles(columns: u32, rows: u32, closed: bool) -> Vec<[u32; 3]> {
    let mut triangles = Vec::new();
    for row in 0..rows - 1 {
        for column in 0..if closed { columns } else { columns - 1 } {
            let next = (column + 1) % columns;
            let (a, b) = (row * columns + column, row * columns + next);
            triangles.push([a, a + columns, b + columns]);
            triangles.push([a, b + columns, b]);
        }
    }
    triangles
}

/// A ball with waves, `columns` nodes around, whose lower end is cut off at the floor.
fn balloon(center: [f64; 3], radius: f64, waves: [f64; 2], columns: u32) -> BodyPicture {
    let rows = columns / 2;
    let mut positions = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let down = PI * (f64::from(row) / f64::from(rows - 1) - 0.5);
            let turn = TAU * f64::from(column) / f64::from(columns);
            let r = radius * (1.0 + waves[0] * (4.0 * down).cos() + waves[1] * (3.0 * turn).sin() * down.cos());
            positions.push([
                center[0] + r * down.cos() * turn.cos(),
                (center[1] + r * down.sin()).max(0.0),
                center[2] - r * down.cos() * turn.sin(),
            ]);
        }
    }
    let facets = Facets::Triangles(rows_of_triangles(columns, rows, true));
    BodyPicture { positions, facets, ..BodyPicture::default() }
}

/// Balloons and obstacles on a floor.
pub(crate) fn balloons(columns: u32) -> Picture {
    let mut first = balloon([0.0, 0.4, 0.0], 0.5, [0.0, 0.02], columns);
    first.scalar = first.positions.iter().map(|p| 2.4 - 0.9 * p[0] - 1.2 * (p[1] - 0.5) + 0.6 * p[2]).collect();
    let mut second = balloon([1.1, 0.75, -0.4], 0.4, [0.12, 0.0], columns);
    second.scalar = second.positions.iter().map(|p| 1.4 + 0.5 * (p[1] - 0.35)).collect();
    let arrows = [[0.0, 1.0, 0.0], [-0.7, 0.5, 0.3], [0.5, 0.2, 0.8]].map(|vector| ArrowPicture {
        kind: ArrowKind::Pressure,
        from: [0.5 * vector[0], 0.4 + 0.5 * vector[1], 0.5 * vector[2]],
        vector,
    });
    Picture {
        dimension: 3,
        time: 0.84,
        title: "Balloons on a floor".to_string(),
        bodies: vec![first, second],
        colliders: vec![
            floor(),
            ColliderPicture::Ball { center: [0.8, 0.2, 0.8], radius: 0.2 },
            ColliderPicture::Box { min: [-0.9, 0.0, -0.9], max: [-0.5, 0.35, -0.5], inside: false },
            ColliderPicture::Capsule { a: [-0.8, 0.12, 0.1], b: [-0.7, 0.12, 0.5], radius: 0.12 },
        ],
        arrows: arrows.to_vec(),
        pulls: vec![PullPicture { node: [1.1, 1.18, -0.4], pointer: [1.4, 1.4, -0.4] }],
        legend: legend("stretch", "%"),
        ..Picture::default()
    }
}

/// A cloth or a net over a ball, with `side` nodes along each side.
pub(crate) fn cloth(side: u32, net: bool) -> Picture {
    let mut positions = Vec::new();
    let mut segments = Vec::new();
    for row in 0..side {
        for column in 0..side {
            let share = |place: u32| 2.0 * f64::from(place) / f64::from(side - 1) - 1.0;
            let (x, z) = (share(column), share(row));
            let r = (x * x + z * z).sqrt();
            let ball = (0.26 - r * r).max(0.0).sqrt();
            let hang = 0.6 - 0.32 * r + 0.03 * (9.0 * x).sin() * (7.0 * z).cos() * r;
            positions.push([x, hang.max(0.5 + ball), z]);
            let a = row * side + column;
            if column + 1 < side {
                segments.push([a, a + 1]);
            }
            if row + 1 < side {
                segments.push([a, a + side]);
            }
        }
    }
    let mut body = BodyPicture { positions, ..BodyPicture::default() };
    if net {
        body.scalar = body.positions.iter().map(|p| 1.0 + 3.5 * p[1]).collect();
        body.segments = segments;
        body.nodes_drawn = true;
        body.pinned = vec![0, side - 1];
    } else {
        body.facets = Facets::Triangles(rows_of_triangles(side, side, false));
        body.colour = Some([222, 122, 92]);
    }
    let ball = ColliderPicture::Ball { center: [0.0, 0.5, 0.0], radius: 0.48 };
    Picture {
        dimension: 3,
        title: if net { "A net over a ball" } else { "A cloth over a ball" }.to_string(),
        bodies: vec![body],
        colliders: vec![floor(), ball],
        legend: legend("tension", "N").filter(|_| net),
        ..Picture::default()
    }
}

/// Many small bodies in a room.
pub(crate) fn room() -> Picture {
    let place = |index: u32, step: f64| (f64::from(index) * step).fract();
    let body = |index: u32| {
        let center = [
            4.0 * place(index, 0.754_88) - 2.0,
            0.3 + 1.7 * place(index, 0.569_84),
            3.0 * place(index, 0.430_16) - 1.5,
        ];
        balloon(center, 0.25, [0.03, 0.06], 32)
    };
    Picture {
        dimension: 3,
        title: "A room".to_string(),
        bodies: (0..50).map(body).collect(),
        colliders: vec![ColliderPicture::Box { min: [-2.3, 0.0, -1.8], max: [2.3, 2.3, 1.8], inside: true }],
        ..Picture::default()
    }
}
