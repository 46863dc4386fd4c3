//! The names under which the user knows bodies: a replaced body has another name in the scene.

use crate::exploded::Exploded;
use crate::report::Report;
use opruga::math::message::{IntoField, Replacing, Setting};
use opruga::{Warning, WorldError};

/// The names that bodies have had, and the names of the existing bodies.
#[derive(Debug, Default)]
pub(super) struct Titles {
    /// Old and new names, in the order in which they were given.
    renamed: Vec<(String, String)>,
    /// The names of the existing bodies.
    present: Vec<String>,
}

impl Titles {
    pub(super) fn new(renamed: Vec<(String, String)>, present: Vec<String>) -> Titles {
        Titles { renamed, present }
    }

    /// Whether every body is known by its name in the scene.
    pub(super) fn is_empty(&self) -> bool {
        self.renamed.is_empty()
    }

    /// The name of the body that this one has replaced, directly or through others, unless another existing body has that name.
    pub(super) fn of<'a>(&'a self, name: &'a str) -> &'a str {
        let mut title = name;
        // The list is read from the latest name to the first, because the names may form a cycle after an undo.
        for (old, new) in self.renamed.iter().rev() {
            if new == title {
                title = old;
            }
        }
        if self.present.iter().any(|other| other == title) { name } else { title }
    }

    /// Replaces the name of a body, which may stand alone or in a path such as `body.ball-2.models.0.damping`.
    fn in_path(&self, path: &str) -> String {
        let Some(below) = path.strip_prefix("body.") else { return self.of(path).into() };
        let named = |(_, new): &&(String, String)| {
            below.strip_prefix(new.as_str()).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        match self.renamed.iter().find(named) {
            Some((_, new)) => format!("body.{}{}", self.of(new), &below[new.len()..]),
            None => path.into(),
        }
    }

    /// Replaces the names in a message.
    pub(super) fn in_report(&self, report: Report) -> Report {
        let of = |name: &String| self.of(name).to_string();
        match report {
            Report::World(error) => Report::World(self.replaced(&error)),
            Report::Scene(errors) => {
                Report::Scene(errors.into_iter().map(|error| self.replacing(|by| error.replaced(by))).collect())
            }
            Report::Exploded(exploded) => Report::Exploded(Exploded { body: of(&exploded.body), ..exploded }),
            Report::AtTheEnd(time, list) => {
                Report::AtTheEnd(time, list.into_iter().map(|warning| self.in_warning(warning)).collect())
            }
            Report::GoesOn(name) => Report::GoesOn(of(&name)),
            Report::NoBody(name) => Report::NoBody(of(&name)),
            Report::NoShape(name) => Report::NoShape(of(&name)),
            Report::Copy(name) => Report::Copy(of(&name)),
            Report::NoDifference(about) => Report::NoDifference(self.in_path(&about)),
            report => report,
        }
    }

    /// Replaces the names in a warning.
    pub(super) fn in_warning(&self, warning: Warning) -> Warning {
        self.replacing(|by| warning.replaced(by))
    }

    fn replaced(&self, error: &WorldError) -> WorldError {
        self.replacing(|by| error.replaced(by))
    }

    fn replacing<T>(&self, replace: impl FnOnce(&Replacing<'_>) -> T) -> T {
        replace(&Replacing { setting: &Setting::clone, name: &|name| self.in_path(name) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga::io::SceneError;
    use opruga::world::PathFault;

    fn names(list: &[&str]) -> Vec<String> {
        list.iter().map(|name| name.to_string()).collect()
    }

    fn titles(renamed: &[(&str, &str)], present: &[&str]) -> Titles {
        Titles::new(renamed.iter().map(|(old, new)| (old.to_string(), new.to_string())).collect(), names(present))
    }

    #[test]
    fn names_and_paths_are_those_that_a_person_knows_and_nothing_else_is_touched() {
        let known = titles(&[("ball", "ball-2"), ("ball-2", "ball-3")], &["ball-3", "box"]);
        assert_eq!((known.of("ball-3"), known.of("ball-2"), known.of("box")), ("ball", "ball", "box"));
        assert_eq!(known.in_path("body.ball-3.models.0.damping"), "body.ball.models.0.damping");
        assert_eq!(known.in_path("body.ball-33.models"), "body.ball-33.models");
        let lost = |body: &str| WorldError::Path {
            path: "load".into(),
            about: PathFault::NoBodyCalled { name: body.into(), nearest: None }.into(),
        };
        let (error, told) = (lost("ball-3"), lost("ball"));
        assert_eq!(known.in_report(Report::World(error)), Report::World(told));
        let scene = |body: &str| SceneError::of(PathFault::NoBodyCalled { name: body.into(), nearest: None });
        assert_eq!(known.in_report(Report::Scene(vec![scene("ball-3")])), Report::Scene(vec![scene("ball")]));
        let unnamed = SceneError { hint: Some("its own".into()), ..scene("box") };
        assert_eq!(known.in_report(Report::Scene(vec![unnamed.clone()])), Report::Scene(vec![unnamed]));
        let warning = |body: &str| Warning::new(PathFault::NoBodyCalled { name: body.into(), nearest: None }, 1);
        assert_eq!(known.in_warning(warning("ball-3")), warning("ball"));
        assert_eq!(known.in_report(Report::SetDown), Report::SetDown);
    }

    #[test]
    fn a_name_that_another_body_has_is_not_given_twice_and_names_in_a_circle_come_to_an_end() {
        let known = titles(&[("ball", "ball-2")], &["ball", "ball-2"]);
        assert_eq!(known.of("ball-2"), "ball-2");
        let circle = titles(&[("a", "b"), ("b", "a"), ("a", "b")], &["b"]);
        assert_eq!(circle.of("b"), "a");
        assert_eq!(Titles::default().of("a"), "a");
    }
}
