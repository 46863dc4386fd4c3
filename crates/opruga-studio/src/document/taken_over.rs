//! Ends the drags that a scene contains when the user grabs the same body.

use super::{Document, tables};
use toml_edit::{Item, Table};

impl Document {
    /// Ends the drags of a body among the first `kept` commands. Active drags end now, or with the next frame if they have just begun; later drags
    /// are removed. `now` and `next` are the times of the present and of the next frame \[s\]. Returns the number of removed commands; none if there
    /// was nothing to end.
    pub fn take_over(&mut self, kept: usize, body: &str, [now, next]: [f64; 2]) -> Option<usize> {
        let commands = tables(self.text.get_mut("command")?)?;
        let seconds = |table: &Table, key: &str| {
            table.get(key).and_then(|item| item.as_float().or_else(|| item.as_integer().map(|whole| whole as f64)))
        };
        let has = |table: &Table, key: &str, word: &str| table.get(key).and_then(Item::as_str) == Some(word);
        // Decimal times may differ from those of frames by rounding.
        let rounding = 1e-9 * (next - now);
        let (mut gone, mut ended) = (0, 0);
        for number in (0..kept.min(commands.len())).rev() {
            let Some(table) = commands.get_mut(number) else { continue };
            let over = seconds(table, "until").is_some_and(|until| until <= now + rounding);
            if !(has(table, "do", "drag") && has(table, "body", body)) || over {
                continue;
            }
            match seconds(table, "at").unwrap_or(0.0) {
                at if at > now + rounding => {
                    commands.remove(number);
                    gone += 1;
                }
                at => {
                    table["until"] = toml_edit::value(if at < now - rounding { now } else { next });
                    ended += 1;
                }
            }
        }
        (gone + ended > 0).then_some(gone)
    }

    /// Of the first `kept` commands, removes those that begin after a time \[s\] and act on a body that no longer exists at that time. Returns the
    /// number of removed commands.
    pub fn forget_later(&mut self, kept: usize, body: &str, time: f64) -> usize {
        let Some(commands) = self.text.get_mut("command").and_then(tables) else { return 0 };
        let before = commands.len();
        for number in (0..kept.min(before)).rev() {
            let Some(table) = commands.get(number) else { continue };
            let text = |key: &str| table.get(key).and_then(Item::as_str).unwrap_or_default();
            let below = text("path").strip_prefix("body.").and_then(|path| path.strip_prefix(body));
            let names_it = text("body") == body || below.is_some_and(|rest| rest.starts_with('.'));
            let at = table.get("at").and_then(|at| at.as_float().or_else(|| at.as_integer().map(|whole| whole as f64)));
            if names_it && at.is_some_and(|at| at > time) {
                commands.remove(number);
            }
        }
        before - commands.len()
    }
}

#[cfg(test)]
mod tests {
    use super::Document;

    const TEXT: &str = "[[command]]\nat = 1\nuntil = 4.0\ndo = \"drag\"\nbody = \"ball\"\nnode = 0\npath = []\n\
                        [[command]]\nat = 0.5\nuntil = 1.5\ndo = \"drag\"\nbody = \"ball\"\nnode = 1\npath = []\n\
                        [[command]]\nat = 3.0\nuntil = 4.0\ndo = \"drag\"\nbody = \"ball\"\nnode = 2\npath = []\n\
                        [[command]]\nat = 3.0\nuntil = 4.0\ndo = \"drag\"\nbody = \"other\"\nnode = 3\npath = []\n\
                        [[command]]\nat = 3.0\nuntil = 4.0\ndo = \"drag\"\nbody = \"ball\"\nnode = 4\npath = []\n";

    #[test]
    fn drags_of_the_body_that_act_end_and_those_to_come_go_and_all_others_stay() {
        let inline = "command = [{ at = 1.0, until = 4.0, do = \"drag\", body = \"ball\", node = 0, path = [] }]\n";
        let mut document = Document::new("it", TEXT).expect("a text");
        assert_eq!(document.take_over(4, "ball", [2.0, 2.1]), Some(1));
        let text = document.text();
        assert!(text.contains("at = 1\nuntil = 2.0\n") && !text.contains("node = 2\n"), "{text}");
        assert!(text.contains("until = 1.5\n"), "what is over stays as it was: {text}");
        assert!(
            text.contains("node = 3\n") && text.contains("node = 4\n"),
            "another body, and what was recorded: {text}"
        );
        let before = document.text();
        assert_eq!(document.take_over(3, "ball", [2.0, 2.1]), None, "nothing acts any more");
        assert_eq!(document.text(), before);
        // A drag that has just begun acts for one frame.
        let mut document = Document::new("it", inline).expect("a text");
        assert_eq!(document.commands(), 1);
        assert_eq!(document.take_over(1, "ball", [1.0, 1.1]), Some(0));
        assert!(document.text().contains("until = 1.1"), "{}", document.text());
    }
}
