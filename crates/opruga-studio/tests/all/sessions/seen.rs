//! The picture of a scene: colours, arrows, drawings.

use super::{open, pass};
use opruga::Options;
use opruga::draw::ArrowKind;
use opruga::io::Files;
use opruga_studio::session::{Request, Session};
use opruga_studio::shown::Show;

#[test]
fn the_contact_forces_of_a_body_at_rest_carry_its_weight() {
    let text = opruga::scenes::find("ball").expect("it");
    let end = text.find("[[command]]").expect("its pull");
    let mut session = Session::open("quiet", &text[..end], Files::default(), Options::default()).expect("it opens");
    session.handle(Request::Show(Show { contacts: true, normals: true, ..Show::default() }));
    assert!(session.shown().picture.arrows.iter().all(|a| a.kind != ArrowKind::Contact), "in the air there are none");
    // At rest, obstacles carry its weight of 9.81 N plus the rate of its remaining momentum. Only one substep in thirty-two is sampled, and vertices
    // still vibrate, so a twentieth may be missing.
    pass(&mut session, 600);
    let (mut sum, before) = ([0.0; 2], session.shown().momentum);
    const FRAMES: u32 = 240;
    for _ in 0..FRAMES {
        pass(&mut session, 1);
        let arrows = session.shown().picture.arrows;
        let contacts = arrows.iter().filter(|arrow| arrow.kind == ArrowKind::Contact);
        contacts.for_each(|arrow| (0..2).for_each(|d| sum[d] += arrow.vector[d] / f64::from(FRAMES)));
        // The normals of the ring point away from its centre.
        let normals: Vec<_> = arrows.iter().filter(|arrow| arrow.kind == ArrowKind::Normal).collect();
        let middle = [0, 1].map(|d| normals.iter().map(|n| n.from[d]).sum::<f64>() / normals.len() as f64);
        let out =
            |n: &&&opruga::draw::ArrowPicture| (0..2).map(|d| n.vector[d] * (n.from[d] - middle[d])).sum::<f64>() > 0.0;
        assert_eq!(normals.iter().filter(out).count(), 36);
    }
    let gained = (session.shown().momentum[1] - before[1]) / (f64::from(FRAMES) / 60.0);
    assert!((sum[1] - 9.81 - gained).abs() < 0.4 && sum[0].abs() < 0.05, "{sum:?}, {gained}");
}

#[test]
fn every_scene_of_the_program_opens_moves_and_can_be_seen_in_every_colour() {
    for name in opruga::scenes::names().filter(|n| !["million-vertices", "thousand-balls", "giant-ring"].contains(n)) {
        let mut session = open(name);
        pass(&mut session, 2);
        for quantity in opruga::pictures::Quantity::ALL {
            session.handle(Request::Show(Show {
                quantity,
                arrows: true,
                vertices: true,
                velocities: true,
                normals: true,
                contacts: true,
                own_colours: false,
                ..Show::default()
            }));
            let shown = session.shown();
            assert_eq!(shown.bodies.len(), shown.picture.bodies.len(), "{name}");
            assert!(shown.picture.legend.is_some() != (quantity == opruga::pictures::Quantity::Plain), "{name}");
        }
    }
}

#[test]
fn drawings_are_seen_in_their_own_colours_until_another_colouring_is_chosen() {
    let mut session = open("emoji");
    let coloured = |session: &mut Session| {
        let shown = session.shown();
        assert!(shown.has_drawings);
        shown.picture.bodies.iter().flat_map(|body| &body.areas).any(|area| area.colour.is_some())
    };
    assert!(coloured(&mut session), "by themselves");
    session.handle(Request::Show(Show { own_colours: false, ..Show::default() }));
    assert!(!coloured(&mut session), "told by their strain");
    assert!(!open("ball").shown().has_drawings);
}
