//! Losses between a drawing and its body are reported: parts without an outline, detail finer than the spacing, bad angles.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]

use crate::common;
use common::shapes::{plane, svg};
use opruga_mesh::{Mesh, signed_volume};
use std::f64::consts::PI;

fn area(mesh: &Mesh<2>) -> f64 {
    signed_volume(&mesh.facets, &mesh.positions)
}

fn drawing(inside: &str) -> String {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\">\n{inside}\n</svg>")
}

/// Parts that a drawing program would draw but that have no outline: the contents of the drawing, the notice, its count.
#[test]
fn what_changes_a_drawing_without_an_outline_is_counted() {
    let path = |more: &str| format!("<path d=\"M0 0H4V4H0Z\" {more}/>");
    let moved = "<animate attributeName=\"x\"/><animateTransform/><set attributeName=\"y\"/>";
    for (inside, told) in [
        (path("filter=\"url(#blur)\""), vec![("svg.filter", "1")]),
        (format!("<g style=\"filter: blur(2px)\">{}</g>", path("filter=\"none\"")), vec![("svg.filter", "1")]),
        (format!("{}{}", path("stroke=\"red\""), path("transform=\"translate(9)\"")), vec![("svg.stroke", "1")]),
        (format!("<g stroke=\"#123\">{}</g>", path("stroke-width=\"3\"")), vec![("svg.stroke", "1")]),
        (format!("<g stroke=\"red\">{}</g>", path("stroke=\"none\"")), vec![]),
        (path("stroke=\"red\" stroke-width=\"0\""), vec![]),
        (path("stroke=\"red\" stroke-opacity=\"0\""), vec![]),
        (path("").replace("/>", &format!(">{moved}</path>")), vec![("svg.animation", "3")]),
        (format!("<g>{moved}{}</g><animate/>", path("")), vec![("svg.animation", "4")]),
        (format!("<defs><g>{moved}</g></defs>{}", path("")), vec![]),
        (
            path("").replace("/>", "/><g display=\"none\"/><path visibility=\"hidden\" d=\"\"/>"),
            vec![("svg.hidden", "2")],
        ),
        (
            format!("<symbol id=\"s\"><set/>{}</symbol><use href=\"#s\"><animateMotion/></use>", path("")),
            vec![("svg.animation", "2")],
        ),
    ] {
        let (_, notices) = svg(&drawing(&inside)).unwrap_or_else(|e| panic!("{inside}: {}", e[0]));
        let found: Vec<_> = notices.iter().map(|n| (n.about.code, n.about.value.as_deref().unwrap_or(""))).collect();
        assert_eq!(found, told, "{inside}");
    }
}

/// Inkscape and Illustrator store data of their own in drawings; browsers do not draw them either.
#[test]
fn elements_of_other_languages_are_no_part_of_a_drawing() {
    let document = |inside: &str| {
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\" standalone=\"no\"?>\n<svg width=\"9mm\" height=\"9mm\" \
             viewBox=\"0 0 9 9\" version=\"1.1\" id=\"svg1\" inkscape:version=\"1.3.2\" \
             xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" \
             xmlns:sodipodi=\"http://sodipodi.sourceforge.net/DTD/sodipodi-0.dtd\" xmlns:i=\"http://ns.adobe.com/AdobeIllustrator/10.0/\" \
             xmlns=\"http://www.w3.org/2000/svg\" xmlns:svg=\"http://www.w3.org/2000/svg\">\n\
             <sodipodi:namedview id=\"namedview1\" pagecolor=\"#ffffff\" inkscape:zoom=\"2\"><inkscape:page x=\"0\" \
             y=\"0\" width=\"9\" height=\"9\"/></sodipodi:namedview>\n<defs id=\"defs1\"/>\n\
             <g inkscape:label=\"Layer 1\" inkscape:groupmode=\"layer\" id=\"layer1\">{inside}</g></svg>"
        )
    };
    for inside in [
        "<path id=\"p\" d=\"M1 1H5V5H1Z\"/>",
        "<svg:path id=\"p\" d=\"M1 1H5V5H1Z\"/><i:path d=\"M5 1H9V5H5Z\"/>",
        "<svg:path id=\"p\" d=\"M1 1H5V5H1Z\"/><i:pgf><path d=\"M5 1H9V5H5Z\"/></i:pgf>",
    ] {
        let (mesh, notices) = svg(&document(inside)).unwrap_or_else(|e| panic!("{inside}: {}", e[0]));
        let size = |d: usize| {
            let of = mesh.positions.iter().map(|x| x[d]);
            of.clone().fold(f64::MIN, f64::max) - of.fold(f64::MAX, f64::min)
        };
        assert!((size(0) / size(1) - 1.0).abs() < 1e-12, "{inside}: {} by {}", size(0), size(1));
        assert!(notices.is_empty(), "{inside}: {}", notices[0].about);
    }
}

/// The fractions of its area and of its points that an outline loses because of its spacing. Corners and ends of curves count as one point each.
#[test]
fn what_an_outline_loses_to_its_spacing_is_told_in_figures() {
    let of = |inside: &str, spacing: f64| {
        let shape = format!("kind = \"svg\", file = \"a.svg\", size = 2.0, spacing = {spacing}");
        let (mesh, notices) = plane(&shape, "a.svg", drawing(inside).as_bytes()).unwrap_or_else(|e| panic!("{}", e[0]));
        let told =
            notices.iter().map(|n| (n.about.code, n.about.value.clone().unwrap_or_default(), n.about.message.clone()));
        (area(&mesh), told.collect::<Vec<_>>())
    };
    let at = |n: u32, k: u32| (2.0 * PI * f64::from(k) / f64::from(n)).sin_cos();
    let corners: String = (0..1000).map(|k| format!("{:.9},{:.9} ", at(1000, k).1, at(1000, k).0)).collect();
    // A thousand curves, each so flat that it is one line; the last one ends where the first began.
    let curves: String = (0..1000)
        .map(|k| {
            let (s, c) = at(1000, k + 1);
            format!("{}Q{c:.9} {s:.9} {c:.9} {s:.9}", if k == 0 { "M1 0" } else { "" })
        })
        .collect();
    for inside in [format!("<polygon points=\"{corners}\"/>"), format!("<path d=\"{curves}Z\"/>")] {
        let (left, told) = of(&inside, 0.1);
        let [(code, value, message)] = &told[..] else { panic!("{told:?}") };
        assert_eq!((*code, value.as_str()), ("shape.thinned", "1000"));
        assert!(message.starts_with("1000 points of the file become 63 nodes, 0.1 m apart: "), "{message}");
        // A polygon of 63 sides has π²·⅔/63² less than the circle: 0.17 %.
        assert!(message.contains(" m² (0.1") && message.ends_with(" m² are lost"), "{message}");
        assert!((left / PI - 1.0).abs() < 2e-3);
    }
    // Five points are not many, but a triangle made from a circle has lost more than half of its area.
    let (left, told) = of("<circle r=\"1\"/>", 2.0);
    let [(code, value, message)] = &told[..] else { panic!("{told:?}") };
    assert!(*code == "shape.thinned" && message.contains("3 nodes 2 m apart, "), "{message}");
    // The circle was approximated by lines within a fraction of the spacing, which lose a little, too.
    assert!((value.parse::<f64>().expect("a number") - left / PI).abs() < 5e-3, "{value}: {left}");
    assert!(of("<circle r=\"1\"/>", 0.3).1.is_empty(), "{:?}", of("<circle r=\"1\"/>", 0.3).1);
}

/// A wedge is filled with thin triangles, because nothing else fits into it; this is reported with the angle and the reason.
#[test]
fn thin_triangles_of_fillings_are_told() {
    let of = |inside: &str| {
        let shape = "kind = \"svg\", file = \"a.svg\", size = 2.0, spacing = 0.1, filling = \"triangles\"";
        let (mesh, notices) = plane(shape, "a.svg", drawing(inside).as_bytes()).unwrap_or_else(|e| panic!("{}", e[0]));
        (mesh.cell_quality().expect("triangles").smallest_angle.to_degrees(), notices)
    };
    let (angle, notices) = of("<path d=\"M0 0L10 0L10 2.6794919Z\"/>");
    let about = &notices[0].about;
    assert!(angle <= 15.0 + 1e-6 && about.code == "shape.thin_triangles", "{angle}: {}", notices[0]);
    assert!((about.value.as_deref().and_then(|v| v.parse::<f64>().ok()).expect("an angle") / angle - 1.0).abs() < 0.01);
    assert!(about.message.contains("the outline itself has a corner of 15° there"), "{}", about.message);
    // Two squares, and a neck between them whose width is a fifth of the spacing.
    let (angle, notices) = of("<path d=\"M0 0H4V4.95H6V0H10V10H6V5.05H4V10H0Z\"/>");
    assert!(
        angle < 25.0 && notices[0].about.message.contains("the outline is finer there than `spacing`"),
        "{}",
        notices[0]
    );
    let (angle, notices) = of("<circle r=\"1\"/>");
    assert!(angle >= 25.0 && notices.is_empty(), "{angle}");
}

/// A disc that another element paints on a square looks like a disc on a square, but is read as a hole. This is reported, unless the scene says which
/// of the two is meant. It does not apply to a ring with its own hole, or to an island in a hole of another element.
#[test]
fn an_element_painted_within_another_is_a_hole_and_counted() {
    let square = "<rect width=\"10\" height=\"10\"/>";
    let disc = |x: f64| format!("<circle cx=\"{x}\" cy=\"5\" r=\"1\"/>");
    let ring = "<path fill-rule=\"evenodd\" d=\"M0 0h10v10h-10z M1 1h8v8h-8z\"/>";
    let dot = "<circle cx=\"3\" cy=\"5\" r=\"0.4\"/>";
    for (inside, told) in [
        (format!("{square}{}", disc(5.0)), Some(("1", "1 outline lies within an outline of another element"))),
        (
            format!("{}{square}\n{}", disc(3.0), disc(7.0)),
            Some(("2", "2 outlines lie within outlines of other elements")),
        ),
        // A dot on the disc is an area again.
        (format!("{square}{}{dot}", disc(3.0)), Some(("1", "1 outline lies"))),
        (ring.to_string(), None),
        (format!("{ring}{}", disc(5.0)), None),
        (format!("{square}<circle cx=\"15\" cy=\"5\" r=\"1\"/>"), None),
    ] {
        let shape = "kind = \"svg\", file = \"a.svg\", spacing = 0.05, size = 2.0";
        let read = |more: &str| {
            let (mesh, notices) = plane(&format!("{shape}{more}"), "a.svg", drawing(&inside).as_bytes())
                .unwrap_or_else(|e| panic!("{inside}: {}", e[0]));
            let nested = notices.into_iter().map(|n| n.about).filter(|about| about.code == "shape.nested");
            (area(&mesh), nested.collect::<Vec<_>>())
        };
        let (holed, found) = read("");
        match told {
            Some((count, message)) => {
                let about = &found[0];
                assert!(found.len() == 1 && about.value.as_deref() == Some(count), "{inside}: {about}");
                assert!(about.message.contains(message) && about.line.is_some() && about.hint.is_some(), "{about}");
                assert!(read(", overlap = \"union\"").0 > holed + 0.01, "{inside}");
            }
            None => assert!(found.is_empty(), "{inside}: {}", found[0]),
        }
        assert!(read(", overlap = \"even_odd\"").1.is_empty() && read(", overlap = \"union\"").1.is_empty());
    }
}
