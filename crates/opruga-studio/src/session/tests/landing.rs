//! Positions of new bodies.

use super::{ask, pass, quiet};
use crate::session::{Edit, Request, Session};

/// The boxes of all bodies, none of which intersects another.
fn assert_apart(session: &mut Session) -> Vec<[[f64; 3]; 2]> {
    let boxes: Vec<_> = session.shown().extents.iter().map(|extent| extent.corners).collect();
    for (place, a) in boxes.iter().enumerate() {
        for b in &boxes[..place] {
            let meet = (0..2).all(|d| a[0][d] < b[1][d] && b[0][d] < a[1][d]);
            assert!(!meet, "{a:?} {b:?}");
        }
        assert!(a[0][1] > 0.0, "in the floor: {a:?}");
    }
    boxes
}

#[test]
fn bodies_that_are_dropped_added_or_copied_come_to_the_pointer_or_beside_what_is_there() {
    let square = |size: f64| {
        let text = format!(
            "{{ name = \"square\", shape = {{ kind = \"grid\", size = [{size}, {size}], cells = [3, 3] }}, mass = 0.5, \
             models = [{{ kind = \"mass_spring\", stiffness = 300.0, damping = 1.0 }}] }}"
        );
        text.parse::<toml_edit::Value>().expect("a table").as_inline_table().expect("a table").clone()
    };
    for frames in [0, 20] {
        let mut session = quiet();
        pass(&mut session, frames);
        let middle = |ends: [[f64; 3]; 2]| [0, 1].map(|d| 0.5 * (ends[0][d] + ends[1][d]));
        ask(&mut session, Request::Edit(Edit::Drop(square(0.5), [2.0, 1.0, 0.0])));
        let [x, y] = middle(assert_apart(&mut session)[1]);
        assert!((x - 2.0).abs() < 0.01 && (y - 1.0).abs() < 0.01, "{x} {y}: where there is room, at the pointer");
        // The bodies are dropped on the ball (two of them at the same point), into the floor, and on one another.
        for at in [[0.0, 2.0], [0.0, 2.0], [0.2, 1.9], [-3.0, -1.0], [2.0, 1.0]] {
            ask(&mut session, Request::Edit(Edit::Drop(square(0.4), [at[0], at[1], 0.0])));
            let [x, y] = middle(*assert_apart(&mut session).last().expect("a body"));
            assert!((x - at[0]).hypot(y - at[1]) < 2.0, "{at:?}: near it, and not at {x} {y}");
        }
        for _ in 0..3 {
            ask(&mut session, Request::Edit(Edit::Duplicate("ball".into())));
            assert_apart(&mut session);
        }
        let svg =
            b"<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 10 10\"><path d=\"M0 0 H10 V10 H0 Z\"/></svg>";
        let folder = std::env::temp_dir().join(format!("opruga-landing-{}-{frames}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        std::fs::write(folder.join("square.svg"), svg).expect("a file");
        let Ok(Request::Take(shape, ..)) = crate::dropping::take(&folder.join("square.svg")) else { panic!("a shape") };
        ask(&mut session, Request::Take(shape, [0.0, 2.0, 0.0], 0.5));
        assert_apart(&mut session);
        std::fs::remove_dir_all(&folder).expect("it goes");
        pass(&mut session, 2);
        if frames > 0 {
            let count = session.shown().bodies.len();
            ask(&mut session, Request::Undo);
            assert_eq!(session.shown().bodies.len(), count - 1);
        }
    }
}
