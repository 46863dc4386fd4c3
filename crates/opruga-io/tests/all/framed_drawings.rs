//! Surroundings of the shapes of a drawing: clip paths, style sheets, inner drawings; and shapes that draw nothing.
#![allow(clippy::disallowed_methods, reason = "what tests expect needs no equal bits")]
#![allow(clippy::result_large_err, reason = "errors are what is looked at")]

use crate::common;
use common::shapes::{plane, svg};
use opruga_io::{Notice, SceneError};
use opruga_mesh::{Mesh, signed_volume};
use std::f64::consts::PI;

fn drawing(inside: &str) -> String {
    format!("<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 100 100\">\n{inside}\n</svg>")
}

/// The area of a drawing 2 wide, and the codes of its notices.
fn area_of(inside: &str) -> Result<(f64, Vec<&'static str>), SceneError> {
    let (mesh, notices) = svg(&drawing(inside)).map_err(|mut errors| errors.remove(0))?;
    Ok((signed_volume(&mesh.facets, &mesh.positions), codes(&notices)))
}

fn codes(notices: &[Notice]) -> Vec<&'static str> {
    notices.iter().map(|notice| notice.about.code).collect()
}

/// Width over height, and the area divided by their product.
fn box_of(mesh: &Mesh<2>) -> (f64, f64) {
    let side = |axis: usize| {
        let of = || mesh.positions.iter().map(|p| p[axis]);
        of().fold(f64::MIN, f64::max) - of().fold(f64::MAX, f64::min)
    };
    let (w, h) = (side(0), side(1));
    (w / h, signed_volume(&mesh.facets, &mesh.positions) / (w * h))
}

/// A clip path around the whole shape changes nothing; for one that cuts, the fraction is reported.
#[test]
fn clip_paths_that_cut_nothing_off_are_taken() {
    let clip = |clip: &str| format!("<defs><clipPath id=\"c\">{clip}</clipPath></defs>");
    let disc = "<circle cx=\"50\" cy=\"50\" r=\"20\"";
    let around = "<rect width=\"100\" height=\"100\"/>";
    let clipped = format!("<g clip-path=\"url(#c)\">{disc}/></g>");
    for (name, inside) in [
        ("a frame", format!("{}{clipped}", clip(around))),
        ("behind it", format!("{clipped}{}", clip(around))),
        ("itself", format!("{}{clipped}", clip(&format!("{disc}/>")))),
        ("quoted, on the shape", format!("{}{disc} style=\"clip-path: url('#c')\"/>", clip(around))),
        ("none", format!("{disc} clip-path=\"none\"/>")),
        ("by a sheet", format!("<style>.k {{ clip-path: url(#c) }}</style>{}{disc} class=\"k\"/>", clip(around))),
        ("just around", format!("{}{clipped}", clip("<path d=\"M30 30H70V70H30Z\"/>"))),
        ("two halves", format!("{}{clipped}", clip("<path d=\"M30 30H50V70H30Z\"/><path d=\"M50 30H70V70H50Z\"/>"))),
        (
            "a star around",
            format!("{}{clipped}", clip("<polygon points=\"0,0 50,20 100,0 80,50 100,100 50,80 0,100 20,50\"/>")),
        ),
        (
            "moved",
            format!(
                "{}<g clip-path=\"url(#c)\" transform=\"translate(30 30)\"><circle cx=\"20\" cy=\"20\" r=\"20\"/></g>",
                clip("<path d=\"M0 0H40V40H0Z\"/>")
            ),
        ),
        (
            "in units of its box",
            format!(
                "<clipPath id=\"c\" clipPathUnits=\"objectBoundingBox\"><rect width=\"1\" height=\"1\"/></clipPath>{clipped}"
            ),
        ),
        (
            "a use",
            format!(
                "<defs>{disc} id=\"d\"/></defs>{}<use href=\"#d\" clip-path=\"url(#c)\"/>",
                clip("<use href=\"#d\"/>")
            ),
        ),
    ] {
        let (area, told) = area_of(&inside).unwrap_or_else(|e| panic!("{name}: {e}"));
        assert!((area / PI - 1.0).abs() < 5e-3 && told.is_empty(), "{name}: {area}, {told:?}");
    }
    let wound = "<path d=\"M20 20H80V80H20ZM25 25H75V75H25Z\"";
    for (name, inside, message) in [
        ("half", format!("{}{clipped}", clip("<rect width=\"50\" height=\"100\"/>")), "cuts off 50 % of what is drawn"),
        ("all", format!("{}{clipped}", clip("")), "cuts off 100 % of what is drawn"),
        // A ring of corners inside a star, one of whose tips reaches into the ring.
        (
            "a notch",
            format!("{}{clipped}", clip("<path d=\"M0 0H100V100H0ZM45 45H55V55H45Z\" clip-rule=\"evenodd\"/>")),
            "cuts off 8 %",
        ),
        (
            "a hole by the even-odd rule",
            format!("{}{clipped}", clip(&format!("{wound} clip-rule=\"evenodd\"/>"))),
            "cuts off 100 %",
        ),
        (
            "in units of its box",
            format!(
                "<clipPath id=\"c\" clipPathUnits=\"objectBoundingBox\"><rect width=\"0.5\" height=\"1\"/></clipPath>{clipped}"
            ),
            "cuts off 50 %",
        ),
        ("a function", format!("{disc} clip-path=\"inset(0)\"/>"), "`clip-path` cannot be read"),
        ("no clip path", format!("<g id=\"c\"/>{clipped}"), "`clip-path` cannot be read"),
    ] {
        let error = area_of(&inside).expect_err(name);
        assert!(error.code == "svg.unsupported" && error.message.contains(message), "{name}: {error}");
        assert!(error.value.is_some() && error.line == Some(2), "{name}: {error}");
    }
    // By the non-zero rule, which is the default for clip paths, the same hole is filled.
    assert!(area_of(&format!("{}{clipped}", clip(&format!("{wound}/>")))).is_ok());
    let nobody = area_of(&clipped).expect_err("no such clip path");
    assert_eq!(nobody.code, "svg.unknown_id");
    let own = "<clipPath id=\"c\"><g clip-path=\"url(#c)\"><rect width=\"9\" height=\"9\"/></g></clipPath>";
    assert_eq!(area_of(&format!("{own}{clipped}")).expect_err("a cycle").code, "svg.cycle");
    // Around an element that is chosen by its id.
    let chosen = |clip: &str| {
        let text =
            drawing(&format!("<clipPath id=\"c\">{clip}</clipPath><g clip-path=\"url(#c)\">{disc} id=\"d\"/></g>"));
        plane("kind = \"svg\", file = \"a.svg\", spacing = 0.1, size = 2.0, path = \"d\"", "a.svg", text.as_bytes())
    };
    assert!(chosen(around).is_ok());
    assert_eq!(chosen("<rect width=\"50\" height=\"50\"/>").expect_err("cut")[0].code, "svg.unsupported");
}

/// Rules of a sheet apply to the matching elements and to no others; the strongest rule wins.
#[test]
fn style_sheets_are_followed_where_their_selectors_fit() {
    let square = "<rect x=\"60\" y=\"60\" width=\"20\" height=\"20\"/>";
    let other = "<rect class=\"b\" width=\"50\" height=\"9\"/>";
    for (inside, told) in [
        // No drawn element here has such a class.
        ("<style>.a { display: none; transform: scale(3) }</style>", &[][..]),
        ("<style>.a { transform: scale(3) }</style><defs><rect class=\"a\" width=\"9\" height=\"9\"/></defs>", &[]),
        (
            "<style>.a { clip-path: url(#x) }</style><rect class=\"a\" display=\"none\" width=\"9\" height=\"9\"/>",
            &["svg.hidden"],
        ),
        ("<style>.b { display: none }</style>", &["svg.hidden"]),
        ("<style>g > .b, #none { visibility: hidden }</style>", &["svg.hidden"]),
        ("<style>svg g rect.b { opacity: 0 }</style>", &["svg.hidden"]),
        ("<style>rect { display: inline } g .b { display: none }</style>", &["svg.hidden"]),
        ("<style>.b { display: none } rect { display: inline }</style>", &["svg.hidden"]),
        ("<style>@media print { .c { display: none } }</style><style>.b { display: none }</style>", &["svg.hidden"]),
        ("<style>@font-face { d: none; src: url(x) } .b { display: none }</style>", &["svg.hidden"]),
        ("<style media=\"print\">.c { display: none }</style><style>.b { display: none }</style>", &["svg.hidden"]),
        ("<style><![CDATA[.b { display: none }]]></style>", &["svg.hidden"]),
        ("<style>.b { display: none; d: none /* } */ }</style>", &["svg.hidden"]),
        // For rules with other selectors it is only known that they may apply to the square.
        ("<style>.b { display: none } rect:hover { fill: red }</style>", &["svg.hidden", "svg.style"]),
    ] {
        // The drawing has the hidden element only if the sheet names it.
        let hidden = if inside.contains(".b") { format!("<g>{other}</g>") } else { String::new() };
        let (area, codes) = area_of(&format!("{inside}{hidden}{square}")).unwrap_or_else(|e| panic!("{inside}: {e}"));
        assert!((area - 4.0).abs() < 1e-9 && codes == told, "{inside}: {area}, {codes:?}");
    }
    for (inside, code) in [
        ("<style>rect { transform: scale(3) }</style>", "svg.unsupported"),
        ("<style>.b { width: 9px }</style>", "svg.unsupported"),
        ("<style>.b { mask: url(#m) }</style>", "svg.unsupported"),
        ("<style>@media print { rect { display: none } }</style>", "svg.style"),
        ("<style>rect:first-child { display: none }</style>", "svg.style"),
        ("<style>[class] , rect + rect { d: path('M0 0') }</style>", "svg.style"),
    ] {
        let error = area_of(&format!("{inside}{other}{square}")).expect_err(inside);
        assert!(error.code == code && error.value.is_some() && error.line == Some(2), "{inside}: {error}");
    }
    // Colours: by class, against an attribute, against a weaker rule before or after, against an important one.
    let painted = |inside: &str| {
        let shape = "kind = \"svg\", file = \"a.svg\", spacing = 0.5, size = 4.0, overlap = \"union\", colours = true";
        let (mesh, notices) = plane(shape, "a.svg", drawing(inside).as_bytes()).unwrap_or_else(|e| panic!("{}", e[0]));
        let areas = &mesh.skin.as_ref().expect("areas").areas;
        (areas.iter().filter_map(|area| area.colour).collect::<Vec<_>>(), codes(&notices))
    };
    let disc = "<circle r=\"3\" class=\"a\" id=\"i\" fill=\"blue\"/>";
    let (red, lime) = (vec![[255, 0, 0, 255]], vec![[0, 255, 0, 255]]);
    for (sheet, wanted) in [
        (".a { fill: red }", &red),
        ("circle { fill: red }", &red),
        (".a { fill: red } circle { fill: lime }", &red),
        ("* { fill: lime } .a{fill:red}", &red),
        ("#i { fill: red } .a.a { fill: lime }", &red),
        (".a { fill: red !important } #i { fill: lime }", &red),
        (".a { fill: red } .a { fill: lime; }", &lime),
        (".x, circle.a { fill: lime }", &lime),
    ] {
        assert_eq!(painted(&format!("<style>{sheet}</style>{disc}")), (wanted.clone(), vec![]), "{sheet}");
    }
    let own = disc.replace("/>", " style=\"fill: lime; fill: red\"/>");
    assert_eq!(painted(&format!("<style>#i {{ fill: lime }}</style>{own}")), (red.clone(), vec![]));
    assert_eq!(painted(&format!("<style>#i {{ fill: lime !important }}</style>{own}")), (lime, vec![]));
    // Properties of the whole drawing apply to its contents.
    let root = "<svg fill=\"red\"><circle r=\"3\"/></svg>";
    let shape = "kind = \"svg\", file = \"a.svg\", spacing = 0.5, size = 4.0, colours = true";
    let (mesh, _) = plane(shape, "a.svg", root.as_bytes()).unwrap_or_else(|e| panic!("{}", e[0]));
    assert_eq!(mesh.skin.as_ref().expect("areas").areas[0].colour, Some(red[0]));
}

/// By the standard, a path without commands or a polygon without points draws nothing and is not an error.
#[test]
fn shapes_that_draw_nothing_are_counted() {
    let square = "<rect width=\"20\" height=\"20\"/>";
    let empty =
        "<path/><path d=\"\"/><path d=\" \n\"/><path d=\"none\"/><polygon/><polyline points=\"\" stroke=\"red\"/>";
    let (mesh, notices) = svg(&drawing(&format!("{empty}{square}"))).unwrap_or_else(|e| panic!("{}", e[0]));
    assert!((signed_volume(&mesh.facets, &mesh.positions) - 4.0).abs() < 1e-9);
    assert_eq!(codes(&notices), ["svg.empty"]);
    assert_eq!(notices[0].about.value.as_deref(), Some("6"));
    assert_eq!(area_of(empty).expect_err("nothing").code, "shape.no_area");
}

/// An `<svg>` or `<symbol>` inside the drawing, four tenths of it wide and two tenths high: the position of a square of half its box.
#[test]
fn drawings_inside_a_drawing_have_their_place_and_scale() {
    // A frame around the whole canvas makes sizes visible: the square beside it is measured by its area and its centre.
    let measured = |inside: &str| -> Result<[f64; 3], SceneError> {
        let text = drawing(&format!("<path d=\"M0 0H100V100H0Z\"/>{inside}"));
        let shape = "kind = \"svg\", file = \"a.svg\", spacing = 0.2, size = 100.0, overlap = \"even_odd\"";
        let (mesh, _) = plane(shape, "a.svg", text.as_bytes()).map_err(|mut errors| errors.remove(0))?;
        // The hole has the nodes that are not on the frame.
        let hole: Vec<[f64; 2]> = mesh
            .positions
            .iter()
            .copied()
            .filter(|p| p.iter().all(|x| x.abs() < 50.0 - 1e-6))
            .map(|[x, y]| [x + 50.0, 50.0 - y])
            .collect();
        let range = |axis: usize| {
            let of = || hole.iter().map(|p| p[axis]);
            (of().fold(f64::MAX, f64::min), of().fold(f64::MIN, f64::max))
        };
        let ((left, right), (top, bottom)) = (range(0), range(1));
        assert!((1e4 - signed_volume(&mesh.facets, &mesh.positions) - (right - left) * (bottom - top)).abs() < 1e-6);
        Ok([left, top, right - left])
    };
    let square = "<rect x=\"2\" y=\"3\" width=\"4\" height=\"4\"/>";
    let svg = |more: &str| format!("<svg x=\"10\" y=\"20\" width=\"40\" height=\"20\" {more}>{square}</svg>");
    let view = "viewBox=\"0 0 10 10\"";
    for (name, inside, wanted) in [
        ("moved alone", svg(""), [12.0, 23.0, 4.0]),
        ("in the middle", svg(view), [10.0 + 10.0 + 4.0, 20.0 + 6.0, 8.0]),
        ("at the left", svg(&format!("{view} preserveAspectRatio=\"xMinYMid meet\"")), [14.0, 26.0, 8.0]),
        ("at the right", svg(&format!("{view} preserveAspectRatio=\"xMaxYMin\"")), [34.0, 26.0, 8.0]),
        ("another corner", svg("viewBox=\"1 2 20 10\""), [12.0, 22.0, 8.0]),
        (
            "cut to fill",
            svg(&format!("{view} overflow=\"visible\" preserveAspectRatio=\"xMidYMid slice\"")),
            [18.0, 20.0 - 10.0 + 12.0, 16.0],
        ),
        (
            "in per cent",
            "<svg width=\"50%\" height=\"50%\" viewBox=\"0 0 20 20\"><rect width=\"50%\" height=\"50%\" x=\"10%\" y=\"5\"/></svg>".to_string(),
            [5.0, 12.5, 25.0],
        ),
        ("the whole", format!("<svg viewBox=\"0 0 50 50\">{square}</svg>"), [4.0, 6.0, 8.0]),
        (
            "twice",
            format!("<svg viewBox=\"0 0 50 50\"><svg x=\"10\" width=\"20\" height=\"20\" {view}>{square}</svg></svg>"),
            [28.0, 12.0, 16.0],
        ),
        (
            "a symbol",
            format!(
                "<symbol id=\"s\" {view}>{square}</symbol><use href=\"#s\" x=\"10\" y=\"20\" width=\"40\" height=\"20\"/>"
            ),
            [24.0, 26.0, 8.0],
        ),
        (
            "a symbol as large as all",
            format!("<symbol id=\"s\" {view}>{square}</symbol><use href=\"#s\"/>"),
            [20.0, 30.0, 40.0],
        ),
    ] {
        let found = measured(&inside).unwrap_or_else(|e| panic!("{name}: {e}"));
        let near = found.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-6);
        assert!(near, "{name}: {found:?}, not {wanted:?}");
    }
    // Stretched in one direction.
    let text = drawing(
        "<svg width=\"40\" height=\"20\" viewBox=\"0 0 10 10\" preserveAspectRatio=\"none\"><circle cx=\"5\" cy=\"5\" r=\"4\"/></svg>",
    );
    let (mesh, told) = common::shapes::svg(&text).expect("an ellipse");
    let (ratio, part) = box_of(&mesh);
    assert!((ratio - 2.0).abs() < 1e-2 && (part - PI / 4.0).abs() < 5e-3 && told.is_empty(), "{ratio}, {part}");
    // An element chosen by its id keeps the scale around it.
    let text = drawing(
        "<svg width=\"40\" height=\"20\" viewBox=\"0 0 10 10\" preserveAspectRatio=\"none\"><circle id=\"d\" cx=\"5\" cy=\"5\" r=\"4\"/></svg>",
    );
    let shape = "kind = \"svg\", file = \"a.svg\", spacing = 0.1, size = 2.0, path = \"d\"";
    let (mesh, _) = plane(shape, "a.svg", text.as_bytes()).expect("an ellipse");
    assert!((box_of(&mesh).0 - 2.0).abs() < 1e-2);
    for (inside, code, message) in [
        (
            svg("viewBox=\"4 0 10 10\" preserveAspectRatio=\"xMinYMin\""),
            "svg.unsupported",
            "<svg> has a frame that cuts off 50 %",
        ),
        (svg("viewBox=\"0 0 0 10\""), "svg.syntax", "`viewBox` cannot be read"),
        (svg("viewBox=\"0 0 1 1\" preserveAspectRatio=\"middle\""), "svg.syntax", "`preserveAspectRatio`"),
        ("<svg width=\"-1\" height=\"2\"><circle r=\"1\"/></svg>".into(), "svg.number", "`width` is negative"),
        (
            format!("<svg id=\"s\">{square}</svg><use href=\"#s\" width=\"4\"/>"),
            "svg.unsupported",
            "a <use> cannot give",
        ),
    ] {
        let error = area_of(&inside).expect_err(&inside);
        assert!(error.code == code && error.message.contains(message), "{inside}: {error}");
        assert!(error.value.is_some() && error.line == Some(2), "{error}");
    }
    let unknown = "<svg><svg viewBox=\"0 0 1 1\"><circle r=\"1\"/></svg></svg>";
    assert_eq!(common::shapes::svg(unknown).expect_err("no size")[0].code, "svg.unsupported");
    // One of zero size draws nothing.
    let none = format!("<svg width=\"0\">{square}</svg><rect width=\"9\" height=\"9\"/>");
    assert_eq!(area_of(&none).expect("a square").1, ["svg.hidden"]);
}
