//! The order of layers in pictures, the text around them, and the properties shared by all pictures of a run.
#![allow(clippy::disallowed_methods)] // no physics here

use opruga_draw::{
    ArrowKind, ArrowPicture, BodyPicture, ColliderPicture, Facets, Image, Legend, Picture, Style, View, draw,
};

/// A ring of 24 nodes, squashed and moved.
fn ring(center: f64, squash: f64) -> BodyPicture {
    let node = |k: u32| {
        let angle = std::f64::consts::TAU * f64::from(k) / 24.0;
        [center + angle.cos() / squash, squash * angle.sin(), 0.0]
    };
    BodyPicture {
        positions: (0..24).map(node).collect(),
        facets: Facets::Edges((0..24).map(|k| [k, (k + 1) % 24]).collect()),
        ..BodyPicture::default()
    }
}

fn image(bodies: Vec<BodyPicture>, arrows: Vec<ArrowPicture>, view: &View) -> Image {
    let picture = Picture { bodies, arrows, time: f64::NAN, ..Picture::default() };
    draw(
        &picture,
        view,
        &Style { width: 500, height: 300, header: false, footer: false, legend: false, ..Style::default() },
    )
    .expect("an image")
}

fn fitted(bodies: Vec<BodyPicture>) -> View {
    View::fit([&Picture { bodies, ..Picture::default() }]).expect("a view")
}

/// The pixels at which two images differ.
fn changed(a: &Image, b: &Image) -> Vec<[u32; 2]> {
    let places = (0..a.height()).flat_map(|y| (0..a.width()).map(move |x| [x, y]));
    places.filter(|[x, y]| a.pixel(*x, *y) != b.pixel(*x, *y)).collect()
}

#[test]
fn dots_are_in_all_pictures_of_a_run_or_in_none() {
    let view = fitted(vec![ring(0.0, 0.4)]);
    let dots = |squash: f64, nodes_drawn: bool, node_spacing: Option<f64>| {
        image(vec![BodyPicture { nodes_drawn, node_spacing, ..ring(0.0, squash) }], Vec::new(), &view)
    };
    // Round or flat: there is space for dots at 0.26 m, but not at 0.05 m; dots requested unconditionally are always drawn.
    for squash in [1.0, 0.7, 0.4] {
        let without = dots(squash, false, None);
        assert!(!changed(&dots(squash, true, Some(0.26)), &without).is_empty(), "{squash}");
        assert!(changed(&dots(squash, true, Some(0.05)), &without).is_empty(), "{squash}");
        assert!(!changed(&dots(squash, true, None), &without).is_empty(), "{squash}");
    }
}

#[test]
fn pressure_covers_no_neighbour_and_no_name() {
    let pair = || vec![ring(0.0, 1.0), ring(2.2, 1.0)];
    let arrow = |from: [f64; 2], vector: [f64; 2]| ArrowPicture {
        kind: ArrowKind::Pressure,
        from: [from[0], from[1], 0.0],
        vector: [vector[0], vector[1], 0.0],
    };
    // One metre per pascal: longer than the gap of 0.2 m.
    let mut view = fitted(pair());
    (view.arrow, view.longest) = (1.0, [(ArrowKind::Pressure, 1.0)].into());
    let plain = image(pair(), Vec::new(), &view);
    let first = changed(&plain, &image(vec![ring(2.2, 1.0)], Vec::new(), &view));
    let neighbour = changed(&plain, &image(vec![ring(0.0, 1.0)], Vec::new(), &view));
    let outward = image(pair(), vec![arrow([1.0, 0.0], [1.0, 0.0])], &view);
    let seen = changed(&outward, &plain);
    // The soft border of the neighbour is partly transparent.
    let covered = |[x, y]: &[u32; 2]| neighbour.contains(&[x - 2, *y]) && neighbour.contains(&[*x, *y]);
    assert!(!seen.is_empty() && !seen.iter().any(covered), "over the neighbour");
    // If the pressure outside is larger, arrows are drawn over the body into which they point.
    let inward = changed(&image(pair(), vec![arrow([1.0, 0.0], [-1.0, 0.0])], &view), &plain);
    assert!(inward.iter().filter(|place| first.contains(place)).count() > 20, "within its own body");

    let named = || vec![BodyPicture { label: "hard".into(), ..ring(0.0, 1.0) }, ring(2.2, 1.0)];
    let (plain, name) = (image(pair(), Vec::new(), &view), image(named(), Vec::new(), &view));
    // On all sides, so that no side is free for the name.
    let around = |k: i32| {
        let at = 0.02 * f64::from(k);
        [([at, -1.0], [0.0, -0.4]), ([at, 1.0], [0.0, 0.4]), ([-1.0, at], [-0.4, 0.0]), ([1.0, at], [0.4, 0.0])]
    };
    let arrows: Vec<ArrowPicture> = (-12..=12).flat_map(around).map(|(from, vector)| arrow(from, vector)).collect();
    let (bare, crossed) = (image(pair(), arrows.clone(), &view), image(named(), arrows, &view));
    let light = |image: &Image, [x, y]: [u32; 2]| image.pixel(x, y).iter().map(|c| u32::from(*c)).sum::<u32>();
    let dark: Vec<[u32; 2]> = changed(&name, &plain).into_iter().filter(|at| light(&name, *at) < 330).collect();
    let letters: Vec<[u32; 2]> = dark.into_iter().filter(|at| light(&plain, *at) > 500).collect();
    assert!(letters.len() > 10, "{} dark places of letters", letters.len());
    assert!(letters.iter().all(|at| light(&crossed, *at).abs_diff(light(&name, *at)) < 60), "letters stay dark");
    assert!(letters.iter().any(|[x, y]| bare.pixel(*x, *y) != plain.pixel(*x, *y)), "the arrows cross the name");
}

#[test]
fn every_chamber_is_filled_with_its_own_colour() {
    let (left, right) = (ring(0.0, 1.0), ring(3.0, 1.0));
    let edges = |first: u32| (0..24).map(move |k| [first + k, first + (k + 1) % 24]);
    let body = BodyPicture {
        positions: [left.positions, right.positions].concat(),
        facets: Facets::Edges(edges(0).chain(edges(24)).collect()),
        scalar: [vec![0.0; 24], vec![1.0; 24]].concat(),
        ..BodyPicture::default()
    };
    let picture = Picture {
        bodies: vec![body],
        time: f64::NAN,
        legend: Some(Legend { range: Some([0.0, 1.0]), ..Legend::default() }),
        ..Picture::default()
    };
    let view = View::fit([&picture]).expect("a view");
    let style = Style { width: 500, height: 300, header: false, footer: false, legend: false, ..Style::default() };
    let image = draw(&picture, &view, &style).expect("an image");
    let [left, right] = [100, 400].map(|x| image.pixel(x, 150));
    // The pale ends of the colours: violet and yellow.
    assert!(left[2] > left[1] && right[2] < right[1], "{left:?} {right:?}");
}

#[test]
fn every_kind_of_arrow_that_is_drawn_has_one_of_a_round_value_below_the_scene() {
    let kinds = [ArrowKind::Pressure, ArrowKind::Contact, ArrowKind::Velocity, ArrowKind::Elastic, ArrowKind::Gravity];
    let body = BodyPicture { positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], ..Default::default() };
    let arrow = |kind| ArrowPicture { kind, from: [0.5, 0.5, 0.0], vector: [0.3, 123.0, 0.0] };
    let arrows = kinds.map(arrow).to_vec();
    let picture = Picture { dimension: 2, bodies: vec![body], arrows, ..Default::default() };
    let view = View::fit([&picture]).expect("a view");
    let image = draw(&picture, &view, &Style::default()).expect("an image");
    for kind in kinds {
        let colour = opruga_draw::arrow_colour(kind);
        let below = (560..600).flat_map(|y| (0..800).map(move |x| (x, y)));
        let points = below.filter(|(x, y)| image.pixel(*x, *y) == colour).count();
        assert!(points > 8, "{kind:?}: {points} points below the scene");
    }
}

#[test]
fn where_nothing_has_what_the_colours_tell_there_is_no_bar_of_colours() {
    let of = |scalar: f64, legend: bool| {
        let positions = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let body = BodyPicture { positions, scalar: vec![scalar; 3], ..Default::default() };
        let legend = legend.then(|| Legend { label: "stress".into(), unit: "Pa".into(), ..Default::default() });
        let picture = Picture { dimension: 2, bodies: vec![body], legend, ..Default::default() };
        let view = View::fit([&picture]).expect("a view");
        draw(&picture, &view, &Style::default()).expect("an image")
    };
    assert!(of(f64::NAN, true) == of(f64::NAN, false));
    assert!(of(1.0, true) != of(1.0, false));
}

#[test]
fn a_floor_fades_into_the_background_whatever_lies_over_the_corner_of_the_picture() {
    let background = [24, 26, 32];
    let floor = || ColliderPicture::HalfSpace { point: [0.0; 3], normal: [0.0, 1.0, 0.0] };
    let view = View::fit([&Picture {
        dimension: 3,
        bodies: vec![BodyPicture { positions: vec![[-1.0, 0.0, -1.0], [1.0, 1.0, 1.0]], ..Default::default() }],
        colliders: vec![floor()],
        ..Default::default()
    }]);
    let view = view.expect("a view");
    let (size, seen) = ([320, 200], [320.0, 200.0]);
    let eye = opruga_draw::Eye { target: view.center(), radius: 4.0, azimuth: 0.0, elevation: 8.0 };
    let lens = eye.lens(&view, seen);
    let image = |covered: bool| {
        // A triangle in front of the upper left corner.
        let corner = |x, y| lens.point([x, y], 1.0);
        let positions = vec![corner(-30.0, -30.0), corner(60.0, -30.0), corner(-30.0, 60.0)];
        let facets = Facets::Triangles(vec![[0, 1, 2], [0, 2, 1]]);
        let body = BodyPicture { positions, facets, ..Default::default() };
        let bodies = if covered { vec![body] } else { Vec::new() };
        let picture = Picture { dimension: 3, bodies, colliders: vec![floor()], ..Default::default() };
        opruga_draw::draw_scene(&picture, &eye.view(&view), background, size).expect("an image")
    };
    let (bare, covered) = (image(false), image(true));
    assert_ne!(covered.pixel(2, 2), bare.pixel(2, 2), "it is covered");
    assert_eq!(bare.pixel(2, 2), background);
    let differ = (0..200).filter(|y| covered.pixel(310, *y) != bare.pixel(310, *y)).count();
    assert_eq!(differ, 0, "far from there nothing is another colour");
}
