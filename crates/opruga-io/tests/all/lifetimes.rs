//! Commands on bodies that do not exist when the commands begin are errors at the line of their time.

use crate::common;
use common::*;

/// A command with its fields, in four lines.
fn command(at: f64, what: &str) -> String {
    format!("[[command]]\nat = {at:?}\n{what}\n\n")
}

const REMOVE: &str = "do = \"remove\"\nbody = \"ball\"";
const PUSH: &str = "do = \"push\"\nbody = \"ball\"\nforce = [0, 1]\nuntil = 9";
const ADD: &str =
    "do = \"add\"\nbody = { name = \"late\", shape = { kind = \"ring\", radius = 1, vertices = 4 }, mass = 1 }";

/// Codes, lines (relative to the end of the scene) and values of the errors of a scene with these commands.
fn said(head: &str, commands: &[String]) -> Vec<(&'static str, usize, String)> {
    let text = format!("{head}{}", commands.concat());
    let lines = head.lines().count();
    let all = read_text(&text).err().unwrap_or_default();
    all.into_iter().map(|e| (e.code, e.line.unwrap_or(0) - lines, e.value.unwrap_or_default())).collect()
}

#[test]
fn a_command_on_a_body_that_was_taken_away_is_an_error_at_its_time() {
    let head = format!("{HEAD}{BALL}");
    let set = "do = \"set\"\npath = \"body.ball.models.mass_spring.stiffness\"\nvalue = 3.0";
    let change = "do = \"change\"\nbody = \"ball\"\nintegrator = \"newton\"";
    for after in [REMOVE, PUSH, set, change, "do = \"pin\"\nbody = \"ball\"\nuntil = 9", "do = \"free\"\nbody = 0"] {
        let late = [command(0.1, REMOVE), command(0.15, after)];
        let errors = said(&head, &late);
        let line = late[0].lines().count() + 2;
        assert_eq!(errors, [("scene.range", line, "0.15".to_string())], "{after}");
        // The order of time matters, not that of the file.
        let [removed, used] = late;
        assert_eq!(said(&head, &[used, removed]), [("scene.range", 2, "0.15".to_string())], "{after}");
        if after != REMOVE {
            assert_eq!(said(&head, &[command(0.1, after), command(0.15, REMOVE)]), [], "{after}");
        }
    }
    // Commands with the same time run in the order of the file.
    assert_eq!(said(&head, &[command(0.1, PUSH), command(0.1, REMOVE)]), []);
    assert_eq!(said(&head, &[command(0.1, REMOVE), command(0.1, PUSH)]).len(), 1);
}

#[test]
fn a_command_on_a_body_that_is_yet_to_come_is_an_error_at_its_time() {
    let head = format!("{HEAD}{BALL}");
    let of_late = |what: &str| what.replace("\"ball\"", "\"late\"");
    let set = "do = \"set\"\npath = \"body.late.models.mass_spring.stiffness\"\nvalue = 3.0";
    for early in [of_late(REMOVE), of_late(PUSH)] {
        let errors = said(&head, &[command(2.0, ADD), command(1.0, &early)]);
        assert_eq!(errors.len(), 1, "{early}: {errors:?}");
        assert_eq!((errors[0].0, errors[0].2.as_str()), ("scene.range", "1"), "{early}");
        assert_eq!(said(&head, &[command(2.0, ADD), command(2.0, &early)]), [], "{early}");
    }
    let models = ADD.replace("mass = 1", "mass = 1, models = [{ kind = \"mass_spring\", stiffness = 1.0 }]");
    assert_eq!(said(&head, &[command(2.0, &models), command(1.0, set)]).len(), 1);
    assert_eq!(said(&head, &[command(2.0, &models), command(3.0, set)]), []);
    // A body that was added may be removed, once.
    let life = [command(2.0, ADD), command(3.0, &of_late(REMOVE)), command(4.0, &of_late(PUSH))];
    assert_eq!(said(&head, &life[..2]), []);
    assert_eq!(said(&head, &life).len(), 1);
}

#[test]
fn copies_go_one_by_one() {
    let head = format!("{HEAD}{BALL}copies = {{ count = [2], spacing = [3, 0] }}\n");
    let remove = |k: usize| REMOVE.replace("ball", &format!("ball[{k}]"));
    let set = "do = \"set\"\npath = \"body.ball.models.mass_spring.stiffness\"\nvalue = 3.0";
    // A parameter of the remaining copies can be set, but a push on all copies cannot act on the removed one.
    assert_eq!(said(&head, &[command(1.0, &remove(0)), command(2.0, set)]), []);
    assert_eq!(said(&head, &[command(1.0, &remove(0)), command(2.0, PUSH)]).len(), 1);
    assert_eq!(said(&head, &[command(1.0, &remove(0)), command(1.0, &remove(1)), command(2.0, set)]).len(), 1);
}
