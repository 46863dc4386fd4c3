//! The names of integrators, models, shapes, obstacles and their parameters, and their descriptions. In English these come from the specifications.
//! In other languages they come from the translation, to which a program adds the names of its own kinds (`Translation::add_names`). A kind without a
//! name in the translation has its name from the scene file, and its English description is marked as such.

use super::{Language, scene_titles};
use opruga::Warning;
use opruga::core::spec::{Allowed, Condition, Default as Unset, Field, Spec};
use opruga::words::Named;

/// The part of a scene that a kind belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// An integrator.
    Integrator,
    /// A model.
    Model,
    /// A shape.
    Shape,
    /// An obstacle.
    Obstacle,
    /// Contact between bodies.
    Contact,
}

impl Part {
    fn word(self) -> &'static str {
        match self {
            Part::Integrator => "integrator",
            Part::Model => "model",
            Part::Shape => "shape",
            Part::Obstacle => "obstacle",
            Part::Contact => "contact",
        }
    }
}

/// A word of the scene file in readable form.
fn plain(word: &str) -> String {
    word.replace('_', " ")
}

impl Language {
    /// The name of a path in a language with translated names.
    fn named(self, path: &[&str]) -> Option<Named> {
        self.translation().and_then(|known| known.named(path))
    }

    /// The name of a parameter of a kind in such a language.
    fn parameter(self, part: Part, of: &str, word: &str) -> Option<Named> {
        self.translation().and_then(|known| known.named_parameter(part.word(), of, word))
    }

    /// The name of a kind.
    pub fn kind(self, part: Part, word: &str) -> String {
        self.named(&[part.word(), word]).map_or_else(|| plain(word), |known| known.name.into())
    }

    /// One line about a kind.
    pub fn summary(self, part: Part, spec: &Spec) -> String {
        self.named(&[part.word(), spec.kind]).map_or_else(|| self.english(spec.summary), |known| known.about.into())
    }

    /// The name of a field of a kind.
    pub fn field(self, part: Part, of: &str, word: &str) -> String {
        self.parameter(part, of, word).map_or_else(|| plain(word), |known| known.name.into())
    }

    /// The name of a field of which only the last word of its path is known.
    pub(super) fn field_word(self, word: &str) -> String {
        let of_world = match (self, word) {
            (Language::English, _) => return plain(word),
            (_, "gravity") => self.gravity(),
            (_, "drag") => self.drag(),
            (_, "substeps") => self.substeps(),
            (_, "contact") => self.contact(),
            (_, "models") => self.models(),
            (_, "integrator") => self.integrator(),
            _ => "",
        };
        if !of_world.is_empty() {
            return of_world.to_lowercase();
        }
        let known = self.translation().and_then(|known| known.any_parameter(word));
        known.map_or_else(|| plain(word), |known| known.name.into())
    }

    /// The description of a field, with its allowed values and its default.
    pub fn sentence(self, part: Part, of: &str, about: &Field, dimension: usize) -> String {
        let known = self.parameter(part, of, about.name);
        let sentence = known.map_or_else(|| self.english(about.documentation), |known| known.about.into());
        let allowed = self.allowed(&about.range, dimension);
        let default = match about.default {
            Unset::Number(x) => x.to_string(),
            Unset::Integer(x) => x.to_string(),
            Unset::Boolean(x) => self.flag(x).into(),
            Unset::Text(x) => self.choice(x),
            _ => return format!("{sentence}\n{allowed}"),
        };
        format!("{sentence}\n{allowed}; {}: {default}", self.unsaid())
    }

    /// The condition under which a field has an effect.
    pub fn effect_only(self, part: Part, of: &str, condition: &Condition) -> String {
        if self == Language::English {
            return format!("Has an effect only {}.", condition.text());
        }
        let field = |name: &str| self.field(part, of, name);
        let condition = match *condition {
            Condition::Dimension(dimension) => format!("u {dimension}D"),
            Condition::Word(name, words) => {
                let words: Vec<String> = words.iter().map(|word| self.choice(word)).collect();
                format!("gdje je „{}” {}", field(name), words.join(" ili "))
            }
            Condition::Given(name) => format!("uz „{}”", field(name)),
            Condition::GivenOneOf(names) => {
                let names: Vec<String> = names.iter().map(|name| format!("„{}”", field(name))).collect();
                format!("uz {}", names.join(" ili "))
            }
            Condition::NotGiven(name) => format!("bez „{}”", field(name)),
            Condition::NotZero(name) => format!("gdje „{}” nije 0", field(name)),
        };
        format!("Djeluje samo {condition}.")
    }

    /// The name of a word that is a value of a field.
    pub fn choice(self, word: &str) -> String {
        self.named(&["choice", word]).map_or_else(|| plain(word), |known| known.name.into())
    }

    /// The name of a reading of a model.
    pub fn reading(self, word: &str) -> String {
        self.named(&["reading", word]).map_or_else(|| plain(word), |known| known.name.into())
    }

    /// The title of a scene that comes with the program.
    pub fn scene_title(self, name: &str) -> String {
        let known = scene_titles::SCENE_TITLES.iter().find(|(known, _)| self == Language::Croatian && *known == name);
        let own = || self.english(opruga::scenes::find(name).map_or("", opruga::scenes::title));
        known.map_or_else(own, |(_, title)| (*title).into())
    }

    fn flag(self, flag: bool) -> &'static str {
        if flag { self.yes() } else { self.no() }
    }

    /// The allowed values.
    fn allowed(self, range: &Allowed, dimension: usize) -> String {
        if let Allowed::Choice(choices) = range {
            return choices.iter().map(|word| self.choice(word)).collect::<Vec<_>>().join(", ");
        }
        let range = range.describe(dimension);
        self.translation().map_or_else(|| range.to_string(), |known| known.text_or_english(&range))
    }

    /// A warning.
    pub fn warning_text(self, warning: &Warning) -> String {
        warning.about.as_ref().map_or_else(|| warning.message.clone(), |about| self.in_full(&**about))
    }

    /// English words without a translation, marked as such.
    pub(crate) fn english(self, text: &str) -> String {
        match self {
            Language::English => text.into(),
            Language::Croatian => format!("{text} (na engleskom)"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga::core::spec::Bound;
    use std::collections::BTreeSet;

    /// All kinds that the program knows, in both dimensions.
    fn all() -> Vec<(Part, &'static Spec)> {
        let registry = opruga::Registry::<2>::default();
        let space = opruga::Registry::<3>::default();
        let of = |part, list: Vec<&'static Spec>| list.into_iter().map(move |spec| (part, spec));
        of(Part::Integrator, registry.integrators())
            .chain(of(Part::Integrator, space.integrators()))
            .chain(of(Part::Model, registry.models()))
            .chain(of(Part::Model, space.models()))
            .chain(of(Part::Shape, opruga::shapes::all()))
            .chain(of(Part::Obstacle, opruga::collide::all(2)))
            .chain(of(Part::Obstacle, opruga::collide::all(3)))
            .chain(of(Part::Contact, vec![opruga::world::schema::CONTACT.spec]))
            .collect()
    }

    #[test]
    fn every_registered_kind_parameter_and_choice_has_a_croatian_name_and_sentence() {
        let language = Language::Croatian;
        let mut missing = BTreeSet::new();
        for (part, spec) in all() {
            let path = format!("{}-{}", part.word(), spec.kind);
            if language.named(&[part.word(), spec.kind]).is_none_or(|known| known.about.is_empty()) {
                missing.insert(path.clone());
            }
            for about in spec.fields {
                if language.parameter(part, spec.kind, about.name).is_none_or(|known| known.about.len() < 5) {
                    missing.insert(format!("{path}-{}", about.name));
                }
                let Allowed::Choice(words) = about.range else { continue };
                let unknown = words.iter().filter(|word| language.named(&["choice", word]).is_none());
                missing.extend(unknown.map(|word| format!("choice-{word} of {path}-{}", about.name)));
            }
        }
        let titled = |name: &&str| scene_titles::SCENE_TITLES.iter().any(|(known, _)| known == name);
        missing.extend(opruga::scenes::names().filter(|name| !titled(name)).map(|name| format!("the scene {name}")));
        assert!(missing.is_empty(), "without a Croatian name: {missing:#?}");
    }

    #[test]
    fn no_name_is_one_of_what_there_is_not() {
        let there: BTreeSet<String> = all()
            .into_iter()
            .flat_map(|(part, spec)| {
                let kind = format!("{}-{}", part.word(), spec.kind);
                let fields = spec.fields.iter().flat_map(|about| {
                    [spec.kind, "every"].map(|kind| format!("{}-{kind}-{}", part.word(), about.name))
                });
                fields.chain([kind]).collect::<Vec<_>>()
            })
            .collect();
        let paths = Language::Croatian.translation().expect("it has names").paths();
        let others = ["choice-", "reading-", "scene-"];
        let of_kinds = paths.into_iter().filter(|path| !others.iter().any(|other| path.starts_with(other)));
        let stale: Vec<&str> = of_kinds.filter(|path| !there.contains(*path)).collect();
        assert!(stale.is_empty(), "they name nothing: {stale:?}");
    }

    #[test]
    fn what_a_program_has_added_is_called_as_in_the_scene_and_its_sentence_is_told_to_be_english() {
        let range = Allowed::Number { least: Bound::Open(0.0), greatest: Bound::None };
        let about = Field::new("own_rate", range, "1/s", Unset::Number(2.0), "A rate of its own.");
        assert_eq!(Language::Croatian.field(Part::Model, "own_model", "own_rate"), "own rate");
        let sentence = Language::Croatian.sentence(Part::Model, "own_model", &about, 2);
        assert_eq!(sentence, "A rate of its own. (na engleskom)\nbroj > 0; inače: 2");
        assert_eq!(
            Language::English.sentence(Part::Model, "own_model", &about, 2),
            "A rate of its own.\na number > 0; default: 2"
        );
    }
}
