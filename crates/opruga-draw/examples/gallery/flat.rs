//! Synthetic pictures in two dimensions.

use opruga_draw::{
    ArrowKind, ArrowPicture, BodyPicture, ColliderPicture, ColourMap, Facets, Legend, Picture, PullPicture,
};
use std::f64::consts::TAU;

/// A floor at height zero.
fn floor() -> ColliderPicture {
    ColliderPicture::HalfSpace { point: [0.0; 3], normal: [0.0, 1.0, 0.0] }
}

/// The edges of a closed outline of `count` nodes, starting at `first`.
fn outline(first: u32, count: u32) -> Vec<[u32; 2]> {
    (0..count).map(|node| [first + node, first + (node + 1) % count]).collect()
}

/// A ring that bounces and is flattened at each bounce.
pub(crate) fn bouncing_ring(frames: usize) -> Vec<Picture> {
    let count = 36;
    (0..frames)
        .map(|frame| {
            let time = frame as f64 * 0.01;
            let phase = (time % 1.0) - 0.5;
            let height = 0.5 + 1.1 * (1.0 - 4.0 * phase * phase);
            let squash = 0.32 * (-(phase.abs() - 0.5).powi(2) / 0.012).exp();
            let center = [0.6 * time, (height * (1.0 - squash)).max(0.5 * (1.0 - squash)), 0.0];
            let node = |index: u32| {
                let angle = TAU * f64::from(index) / f64::from(count);
                let wave = 1.0 + 0.05 * (3.0 * angle + 20.0 * time).sin() * (1.0 + 2.0 * squash);
                [
                    center[0] + 0.5 * wave * (1.0 + 0.6 * squash) * angle.cos(),
                    (center[1] + 0.5 * wave * (1.0 - squash) * angle.sin()).max(0.0),
                    0.0,
                ]
            };
            let positions: Vec<[f64; 3]> = (0..count).map(node).collect();
            let scalar = positions.iter().map(|p| 1.0 + 6.0 * squash * (1.5 - p[1]) + 0.3 * p[1]).collect();
            let arrows = (0..count)
                .step_by(3)
                .map(|index| {
                    let angle = TAU * f64::from(index) / f64::from(count);
                    let size = 12.0 * (1.0 + 3.0 * squash);
                    let vector = [size * angle.cos(), size * angle.sin(), 0.0];
                    ArrowPicture { kind: ArrowKind::Pressure, from: positions[index as usize], vector }
                })
                .collect();
            let body = BodyPicture {
                positions,
                facets: Facets::Edges(outline(0, count)),
                segments: (0..count / 2).map(|a| [a, a + count / 2]).collect(),
                scalar,
                nodes_drawn: true,
                ..BodyPicture::default()
            };
            Picture {
                time,
                title: "A ring with gas falls on a floor".to_string(),
                bodies: vec![body],
                colliders: vec![floor()],
                arrows,
                legend: Some(Legend {
                    label: "tension".to_string(),
                    unit: "N".to_string(),
                    range: None,
                    map: ColourMap::Viridis,
                }),
                ..Picture::default()
            }
        })
        .collect()
}

/// A plate with a hole, cells and a pinned side, pulled by a pointer.
pub(crate) fn plate() -> Picture {
    let (columns, rows) = (31_u32, 16_u32);
    let hole = |c: f64, r: f64| ((c - 15.0).powi(2) + (r - 7.5).powi(2)).sqrt() < 4.2;
    let mut positions = Vec::new();
    let mut scalar = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let (x, y) = (0.1 * f64::from(column), 0.1 * f64::from(row));
            positions.push([x, y + 0.6 - 0.09 * x * x, 0.0]);
            let (dx, dy) = (x - 1.5, y - 0.75);
            let r = (dx * dx + dy * dy).sqrt().max(0.4);
            scalar.push(40.0 * (y - 0.75) * (3.2 - x) * (1.0 + 0.5 / (r * r)) / 3.0);
        }
    }
    let mut cells = Vec::new();
    for row in 0..rows - 1 {
        for column in 0..columns - 1 {
            if !hole(f64::from(column) + 0.5, f64::from(row) + 0.5) {
                let a = row * columns + column;
                cells.push([a, a + 1, a + columns + 1]);
                cells.push([a, a + columns + 1, a + columns]);
            }
        }
    }
    let mut edges: Vec<[u32; 2]> = Vec::new();
    for &[a, b, c] in &cells {
        for edge in [[a, b], [b, c], [c, a]] {
            match edges.iter().position(|other| *other == [edge[1], edge[0]]) {
                Some(place) => drop(edges.swap_remove(place)),
                None => edges.push(edge),
            }
        }
    }
    let tip = positions[(rows / 2 * columns + columns - 1) as usize];
    let body = BodyPicture {
        positions,
        facets: Facets::Edges(edges),
        cells,
        scalar,
        pinned: (0..rows).step_by(3).map(|row| row * columns).collect(),
        ..BodyPicture::default()
    };
    Picture {
        time: 1.25,
        title: "A clamped plate with a hole".to_string(),
        bodies: vec![body],
        pulls: vec![PullPicture { node: tip, pointer: [tip[0] + 0.5, tip[1] - 0.5, 0.0] }],
        arrows: vec![ArrowPicture { kind: ArrowKind::Gravity, from: [1.5, 0.2, 0.0], vector: [0.0, -9.81, 0.0] }],
        legend: Some(Legend {
            label: "stress σ".to_string(),
            unit: "kPa".to_string(),
            range: Some([-120.0, 120.0]),
            map: ColourMap::Diverging,
        }),
        ..Picture::default()
    }
}

/// A hanging net of springs.
pub(crate) fn net() -> Picture {
    let side = 24_u32;
    let mut positions = Vec::new();
    for row in 0..side {
        for column in 0..side {
            let (u, v) = (f64::from(column) / 23.0 - 0.5, f64::from(row) / 23.0);
            positions.push([
                2.0 * u * (1.0 - 0.25 * v * (1.0 - v)),
                2.0 - 1.5 * v - (0.5 - 2.0 * u * u) * (0.5 - 0.3 * v),
                0.0,
            ]);
        }
    }
    let mut segments = Vec::new();
    for row in 0..side {
        for column in 0..side {
            let a = row * side + column;
            if column + 1 < side {
                segments.push([a, a + 1]);
            }
            if row + 1 < side {
                segments.push([a, a + side]);
            }
        }
    }
    let scalar = positions.iter().map(|p| 8.0 * (p[1] * p[1] / 4.0) * (0.4 + p[0].abs())).collect();
    let body = BodyPicture {
        positions,
        segments,
        scalar,
        pinned: vec![0, side - 1],
        nodes_drawn: true,
        ..BodyPicture::default()
    };
    Picture {
        title: "A net on two pins".to_string(),
        bodies: vec![body],
        colliders: vec![ColliderPicture::Ball { center: [0.2, -0.45, 0.0], radius: 0.3 }],
        legend: Some(Legend {
            label: "tension".to_string(),
            unit: "N".to_string(),
            range: None,
            map: ColourMap::Viridis,
        }),
        ..Picture::default()
    }
}

/// All kinds of obstacles in a room, with plain bodies and a hole.
pub(crate) fn room() -> Picture {
    let ring = |center: [f64; 2], radius: f64, wave: f64| -> Vec<[f64; 3]> {
        (0..48)
            .map(|node| {
                let angle = TAU * f64::from(node) / 48.0;
                let r = radius * (1.0 + wave * (3.0 * angle).cos());
                [center[0] + r * angle.cos(), center[1] + r * angle.sin(), 0.0]
            })
            .collect()
    };
    let plain = |positions: Vec<[f64; 3]>| BodyPicture {
        positions,
        facets: Facets::Edges(outline(0, 48)),
        ..BodyPicture::default()
    };
    let mut tyre = ring([1.2, 2.0], 0.55, 0.0);
    tyre.extend(ring([1.2, 2.0], 0.33, 0.0));
    let mut edges = outline(0, 48);
    edges.extend(outline(48, 48));
    edges.sort_by_key(|edge| edge[0] * 7 % 13);
    let spokes = (0..48).step_by(4).map(|node| [node, node + 48]).collect();
    let tyre =
        BodyPicture { positions: tyre, facets: Facets::Edges(edges), segments: spokes, ..BodyPicture::default() };
    Picture {
        title: "A room with obstacles".to_string(),
        bodies: vec![plain(ring([2.6, 2.2], 0.4, 0.12)), tyre, plain(ring([3.4, 0.42], 0.4, 0.03))],
        colliders: vec![
            ColliderPicture::Box { min: [0.0; 3], max: [4.0, 3.0, 0.0], inside: true },
            ColliderPicture::Box { min: [0.4, 0.0, 0.0], max: [1.0, 0.5, 0.0], inside: false },
            ColliderPicture::Capsule { a: [1.5, 0.9, 0.0], b: [2.3, 0.6, 0.0], radius: 0.12 },
            ColliderPicture::Polygon(vec![[2.0, 0.0, 0.0], [2.9, 0.0, 0.0], [2.9, 0.45, 0.0]]),
            ColliderPicture::Polyline(vec![[3.1, 1.5, 0.0], [3.5, 1.3, 0.0], [3.9, 1.35, 0.0]]),
        ],
        ..Picture::default()
    }
}

/// Many small rings in a grid.
pub(crate) fn crowd(columns: usize, rows: usize, coloured: bool) -> Picture {
    let count = 36;
    let mut bodies = Vec::new();
    for index in 0..columns * rows {
        let (column, row) = ((index % columns) as f64, (index / columns) as f64);
        let shake = (index as f64 * 12.9898).sin();
        let center = [column + 0.5 + 0.08 * shake, row + 0.5 + 0.08 * (index as f64 * 78.233).sin()];
        let positions: Vec<[f64; 3]> = (0..count)
            .map(|node| {
                let angle = TAU * f64::from(node) / f64::from(count);
                let r = 0.42 * (1.0 + 0.08 * (2.0 * angle + 9.0 * shake).cos());
                [center[0] + r * angle.cos(), center[1] + r * angle.sin(), 0.0]
            })
            .collect();
        let scalar =
            if coloured { vec![(0.2 * column).sin() + 0.1 * row + 0.2 * shake; count as usize] } else { Vec::new() };
        bodies.push(BodyPicture {
            positions,
            facets: Facets::Edges(outline(0, count)),
            scalar,
            ..BodyPicture::default()
        });
    }
    Picture {
        title: format!("{} bodies of {count} nodes", columns * rows),
        bodies,
        colliders: vec![floor()],
        legend: coloured.then(|| Legend {
            label: "pressure".to_string(),
            unit: "kPa".to_string(),
            range: None,
            map: ColourMap::Viridis,
        }),
        ..Picture::default()
    }
}
