//! Drawings whose outlines cross themselves or one another, and styles that affect outlines.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use crate::common;
use common::shapes::{plane, svg};
use opruga_io::SceneError;
use opruga_mesh::signed_volume;
use std::f64::consts::{PI, TAU};

fn drawing(inside: &str) -> String {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 100\">\n{inside}\n</svg>")
}

/// The area of a drawing whose longer side becomes `size`, and the codes of its notices.
fn area_of(inside: &str, size: f64, more: &str) -> Result<(f64, Vec<&'static str>), Vec<SceneError>> {
    let shape = format!("kind = \"svg\", file = \"a.svg\", spacing = 0.02, size = {size}{more}");
    let (mesh, notices) = plane(&shape, "a.svg", drawing(inside).as_bytes())?;
    let area = signed_volume(&mesh.facets, &mesh.positions);
    Ok((area, notices.into_iter().map(|notice| notice.about.code).collect()))
}

const FILLINGS: [&str; 2] = ["", ", filling = \"triangles\""];

#[test]
fn crossing_outlines_have_their_areas_with_every_filling() {
    let star: String = (0..5)
        .map(|k| TAU * (0.25 + 0.4 * f64::from(k)))
        .map(|a| format!("{:.9},{:.9} ", 50.0 + 40.0 * a.cos(), 50.0 - 40.0 * a.sin()))
        .collect();
    // A star of radius 1 is 2 sin 72° wide; its inner pentagon has the radius (3 − √5)/2.
    let (radius, inner) = (1.0 / (2.0 * 72f64.to_radians().sin()), (3.0 - 5f64.sqrt()) / 2.0);
    let whole = 5.0 * inner * 36f64.to_radians().sin() * radius * radius;
    let tips = whole - 2.5 * inner * inner * 72f64.to_radians().sin() * radius * radius;
    let (odd, wound) = (
        format!("<polygon fill-rule=\"evenodd\" points=\"{star}\"/>"),
        format!("<g fill-rule=\"nonzero\"><polygon points=\"{star}\"/></g>"),
    );
    let discs = "<circle cx=\"40\" cy=\"50\" r=\"20\"/><circle cx=\"60\" cy=\"50\" r=\"20\"/>";
    // Three radii wide, so the radius is 1/3.
    let lens = (2.0 * PI / 3.0 - 0.75f64.sqrt()) / 9.0;
    let uneven = "<path d=\"M10 10L90 90V30L10 90Z\"/>";
    let even = "<path d=\"M10 10L90 90V10L10 90Z\"/>";
    for (name, inside, overlap, wanted, near) in [
        ("a pentagram", &odd[..], "even_odd", tips, 1e-6),
        ("a pentagram", &odd, "union", tips, 1e-6),
        ("a whole star", &wound, "refuse", whole, 1e-6),
        ("a whole star", &wound, "union", whole, 1e-6),
        ("crescents", discs, "even_odd", 2.0 * (PI / 9.0 - lens), 2e-3),
        ("a silhouette", discs, "union", 2.0 * PI / 9.0 - lens, 2e-3),
        ("an uneven bow-tie", uneven, "even_odd", 20_000.0 / 7.0 / 6400.0, 1e-6),
        ("an uneven bow-tie", uneven, "union", 20_000.0 / 7.0 / 6400.0, 1e-6),
        ("an even bow-tie", even, "even_odd", 0.5, 1e-6),
        ("an even bow-tie", even, "union", 0.5, 1e-6),
    ] {
        for filling in FILLINGS {
            let more = format!(", overlap = \"{overlap}\"{filling}");
            let (area, _) = area_of(inside, 1.0, &more).unwrap_or_else(|e| panic!("{name}, {more}: {}", e[0]));
            assert!((area / wanted - 1.0).abs() < near, "{name}, {more}: {area}, not {wanted}");
        }
    }
}

#[test]
fn a_figure_of_eight_is_two_drops_or_refused_for_its_crossing() {
    let eight = "<path d=\"M50 50C90 10 90 90 50 50C10 10 10 90 50 50Z\"/>";
    // One loop is a cubic curve from and to (0, 0) with the control points (40, −40) and (40, 40): ½ ∫ (x dy − y dx) = 3/10 · 40 · 40 · 1 = 480, and
    // its highest point is at 3 · 40 / 4 = 30.
    let exact = 2.0 * 480.0 / 60.0f64.powi(2);
    for overlap in ["union", "even_odd"] {
        let (area, _) =
            area_of(eight, 1.0, &format!(", overlap = \"{overlap}\"")).unwrap_or_else(|e| panic!("{}", e[0]));
        assert!((area / exact - 1.0).abs() < 1e-2, "{area}, {exact}");
    }
    let error = &area_of(eight, 1.0, "").expect_err("it crosses itself")[0];
    assert_eq!(error.code, "shape.crossing");
    assert!(error.hint.as_deref().is_some_and(|hint| hint.contains("union")), "{error}");
}

#[test]
fn touching_outlines_are_apart_in_a_union() {
    let two = "<circle cx=\"30\" cy=\"50\" r=\"20\"/><circle cx=\"70\" cy=\"50\" r=\"20\"/>";
    for filling in FILLINGS {
        for overlap in ["union", "even_odd"] {
            let more = format!(", overlap = \"{overlap}\"{filling}");
            let (area, _) = area_of(two, 4.0, &more).unwrap_or_else(|e| panic!("{more}: {}", e[0]));
            assert!((area / (2.0 * PI) - 1.0).abs() < 1e-3, "{area}");
        }
    }
}

/// Styles must give what other programs draw: the area beside a square of side 1, and the notices.
#[test]
fn styles_that_change_outlines_are_followed_refused_or_counted() {
    let square = "<rect x=\"60\" y=\"60\" width=\"20\" height=\"20\"/>";
    for (inside, told) in [
        ("<rect width=\"50\" height=\"9\" display=\"none\"/>", &["svg.hidden"][..]),
        ("<rect width=\"50\" height=\"9\" visibility=\"hidden\"/>", &["svg.hidden"]),
        ("<g style=\"visibility: collapse\"><rect width=\"50\" height=\"9\"/></g>", &["svg.hidden"]),
        ("<g opacity=\"0\"><rect width=\"50\" height=\"9\"/></g>", &["svg.hidden"]),
        ("<style>.a { stroke: red } /* .b{display:none} */</style>", &[]),
        ("<style>rect { fill: red }</style>", &[]),
        ("<style>rect:hover { fill: red }</style>", &["svg.style"]),
        ("<switch><g requiredExtensions=\"x\"><circle r=\"9\"/></g><g/><circle r=\"9\"/></switch>", &[]),
    ] {
        let (area, codes) = area_of(&format!("{inside}{square}"), 1.0, "").unwrap_or_else(|e| panic!("{}", e[0]));
        assert!((area - 1.0).abs() < 1e-9 && codes == told, "{inside}: {area}, {codes:?}");
    }
    // A child may be visible again, and markers leave the outline as it is.
    let again = "<g visibility=\"hidden\"><rect width=\"2\" height=\"2\" visibility=\"visible\"/></g>";
    assert_eq!(area_of(again, 1.0, "").map(|(_, told)| told), Ok(vec![]));
    let marked = format!("<g>{}</g>", square.replace("<rect", "<rect marker-start=\"url(#q)\""));
    assert_eq!(area_of(&marked, 1.0, "").map(|(_, told)| told), Ok(vec!["svg.marker"]));
    for (inside, code, line) in [
        ("<style>rect:not(.a){display:none}</style>", "svg.style", 2),
        ("\n<style>@media print { rect { transform: scale(3) } }</style>", "svg.style", 3),
        ("<style>svg > rect{x:0.0}</style>", "svg.unsupported", 2),
        ("<rect width=\"9\" height=\"9\" style=\"fill: red; transform: rotate(3deg)\"/>", "svg.unsupported", 2),
        ("<rect width=\"9\" height=\"9\" transform-origin=\"5 5\" transform=\"rotate(3)\"/>", "svg.unsupported", 2),
        ("<rect width=\"9\" height=\"9\" fill-rule=\"odd\"/>", "svg.unsupported", 2),
        ("<switch><circle r=\"9\" systemLanguage=\"hr\"/><circle r=\"8\"/></switch>", "svg.unsupported", 2),
        ("<rect id=\"a\"/>\n<rect id=\"a\"/><use href=\"#a\"/>", "svg.same_id", 3),
        ("<rect width=\"2em\" height=\"9\"/>", "svg.unsupported", 2),
    ] {
        let error = &area_of(&format!("{inside}{square}"), 1.0, "").expect_err(inside)[0];
        assert_eq!((error.code, error.line), (code, Some(line)), "{error}");
        assert!(error.value.is_some(), "{error}");
    }
}

#[test]
fn the_rule_of_filling_is_followed_where_the_file_says_it_and_told_where_it_matters() {
    let hole = |rule: &str| format!("<path {rule} d=\"M10 10H90V90H10ZM30 30H70V70H30Z\"/>");
    let read = |inside: &str, wanted: f64, told: &[&str]| {
        let (area, codes) = area_of(inside, 2.0, "").unwrap_or_else(|e| panic!("{}", e[0]));
        assert!((area - wanted).abs() < 1e-9 && codes == told, "{inside}: {area}, {codes:?}");
    };
    read(&hole("style=\"fill-rule: evenodd\""), 3.0, &[]);
    read(&hole("fill-rule=\"nonzero\""), 4.0, &[]);
    read(&hole(""), 3.0, &["svg.fill_rule"]);
    // A hole with the opposite orientation is a hole by both rules.
    read("<path d=\"M10 10H90V90H10ZM30 30V70H70V30Z\"/>", 3.0, &[]);
}

#[test]
fn lengths_have_the_units_of_the_standard() {
    let ratio = |width: &str, height: &str| {
        let (mesh, _) = svg(&drawing(&format!("<rect width=\"{width}\" height=\"{height}\"/>"))).expect("a rectangle");
        signed_volume(&mesh.facets, &mesh.positions) / 4.0
    };
    for (width, height, wanted) in [
        ("2in", "96", 0.5),
        ("25.4mm", "48px", 0.5),
        ("2.54cm", "24pt", 1.0 / 3.0),
        ("6pc", "96", 1.0),
        ("50%", "25", 0.5),
    ] {
        assert!((ratio(width, height) - wanted).abs() < 1e-9, "{width} × {height}");
    }
    let bare = "<svg width=\"40mm\" height=\"80mm\"><rect width=\"100%\" height=\"100%\"/></svg>";
    let (mesh, _) = svg(bare).expect("the size of the drawing is that of its canvas");
    assert!((signed_volume(&mesh.facets, &mesh.positions) - 2.0).abs() < 1e-9);
    let nothing = "<svg><rect width=\"100%\" height=\"5\"/></svg>";
    assert_eq!(svg(nothing).expect_err("of what?")[0].code, "svg.unsupported");
    let stretched = "<svg width=\"40\" height=\"20\" viewBox=\"0 0 1 1\" preserveAspectRatio=\"none\"><rect width=\"1\" height=\"1\"/></svg>";
    assert_eq!(svg(stretched).expect_err("stretched")[0].code, "svg.unsupported");
}

#[test]
fn most_points_of_an_outline_are_not_left_out_without_a_word() {
    let n = 20_000;
    let points: String = (0..n)
        .map(|k| TAU * f64::from(k) / f64::from(n))
        .map(|a| format!("{:.6},{:.6} ", 100.0 * a.cos(), 100.0 * a.sin()))
        .collect();
    let inside = format!("<polygon points=\"{points}\"/>");
    assert_eq!(area_of(&inside, 2.0, "").map(|(_, told)| told), Ok(vec!["shape.thinned"]));
    assert_eq!(area_of(&inside, 2.0, ", filling = \"lattice\"").map(|(_, told)| told), Ok(vec![]));
}
