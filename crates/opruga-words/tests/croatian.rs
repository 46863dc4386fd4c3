//! The Croatian texts match the messages of the crates exactly.

use opruga_core::error::StepError;
use opruga_core::spec::{Default, Spec};
use opruga_integrators::refusals::StepHint;
use opruga_math::message::{AnyMessage, Message as _, Variant};
use opruga_models::fem::Refusal;
use opruga_words::Translation;
use opruga_world::WorldError;
use opruga_world::schema::{self, Holds, Section};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

#[path = "../../opruga-cli/src/errors.rs"]
mod call_errors;
#[path = "../../opruga-studio/src/start_errors.rs"]
mod start_errors;
#[path = "../../opruga-studio/src/view_errors.rs"]
mod view_errors;

/// The variants of all messages.
fn variants() -> impl Iterator<Item = &'static Variant> {
    let io = opruga_io::messages::MESSAGES.iter().flat_map(|lists| lists.iter());
    let others = [
        opruga_models::MESSAGES,
        opruga_integrators::refusals::MESSAGES,
        opruga_collide::refusals::MESSAGES,
        opruga_world::warnings::MESSAGES,
        opruga::sweep::errors::MESSAGES,
        opruga::recordings::MESSAGES,
        opruga::scenes::MESSAGES,
        &[call_errors::CallError::VARIANTS, call_errors::CallRange::VARIANTS, call_errors::CallFault::VARIANTS],
        &[call_errors::OutputError::VARIANTS, call_errors::CheckFault::VARIANTS],
        &[call_errors::CallWarning::VARIANTS, call_errors::ResumeHint::VARIANTS, call_errors::CallNote::VARIANTS],
        &[call_errors::Shorter::VARIANTS, start_errors::StartError::VARIANTS],
        opruga::draw::MESSAGES,
        &[view_errors::ViewError::VARIANTS],
        &[opruga_video::VideoError::VARIANTS],
    ];
    io.chain(others.into_iter().flatten()).flat_map(|list| list.iter())
}

#[test]
fn every_message_has_a_croatian_text_with_its_fields() {
    let gaps = Translation::croatian().gaps(variants());
    assert!(gaps.is_empty(), "{gaps:#?}");
}

/// `tests/texts.txt` contains the text of every variant of every code, once in each language. `OPRUGA_TABLES=write` writes it again, which shows
/// every change of a text.
#[test]
fn the_text_of_every_code_is_pinned_in_both_languages() {
    let own = Path::new(env!("CARGO_MANIFEST_DIR"));
    let entries = croatian_entries(&own.join("hr"));
    let mut texts = BTreeMap::new();
    for variant in variants() {
        let name = format!("{}-{}", variant.code.replace('.', "-"), variant.name);
        let mut text = format!("{name}\n");
        for (label, english) in ["en", "en allowed", "en hint"].iter().zip(variant.english) {
            // The compiler may break long ones anywhere.
            let words: Vec<&str> = english.split_whitespace().collect();
            if !words.is_empty() {
                text += &format!("  {label}: {}\n", words.join(" "));
            }
        }
        text += entries.get(&name).unwrap_or_else(|| panic!("{name} has no Croatian text"));
        assert!(texts.insert(name.clone(), text).is_none(), "{name} is there twice");
    }
    assert!(texts.len() > 600, "{}", texts.len());
    let (file, all) = (own.join("tests/texts.txt"), texts.into_values().collect::<Vec<_>>().join("\n"));
    if std::env::var("OPRUGA_TABLES").is_ok_and(|what| what == "write") {
        std::fs::write(file, all).expect("tests/texts.txt can be written");
        return;
    }
    let pinned = std::fs::read_to_string(file).expect("tests/texts.txt").replace("\r\n", "\n");
    let other = pinned.lines().zip(all.lines()).find(|(pinned, text)| pinned != text);
    assert!(pinned == all, "texts have changed, first {other:?}: run this test with OPRUGA_TABLES=write");
}

/// The source of the entries of the catalogues, by name.
fn croatian_entries(folder: &Path) -> BTreeMap<String, String> {
    let mut entries: BTreeMap<String, String> = BTreeMap::new();
    for file in std::fs::read_dir(folder).expect("the catalogues").flatten() {
        let text = std::fs::read_to_string(file.path()).expect("a catalogue");
        let mut last = String::new();
        for line in text.lines().filter(|line| !line.is_empty() && !line.starts_with('#')) {
            match line.split_once(" =").filter(|_| !line.starts_with([' ', '}'])) {
                Some((name, text)) => {
                    last = name.into();
                    entries.insert(last.clone(), format!("  hr:{text}\n"));
                }
                None => *entries.entry(last.clone()).or_default() += &format!("  {line}\n"),
            }
        }
    }
    entries
}

#[test]
fn what_a_model_refuses_in_a_step_comes_with_what_helps_under_the_settings_of_the_rule() {
    let (about, helps) = (Refusal::NoThicknessLeft { cell: 3, time: 0.75 }.into(), Some(StepHint::LoadSteps {}.into()));
    let cause = StepError::Model { model: "fem", about, helps };
    let error = WorldError::Step { body: "b".into(), cause: Box::new(cause) };
    let croatian = Translation::croatian().in_full(&error).expect("it is known");
    assert!(croatian.starts_with("tijelo `b`: fem: ćelija 3 u t = 0.75 s nema pozitivnu debljinu"), "{croatian}");
    let hint = "`when_not_converged = \"halve\"`, više `load_steps`, ili više `iterations`";
    assert!(croatian.ends_with(&format!("; savjet: {hint}")), "{croatian}");
    let english = error.in_full();
    assert!(
        english.ends_with("; hint: use `when_not_converged = \"halve\"`, more `load_steps`, or more `iterations`"),
        "{english}"
    );
}

/// A missing field of a scene is explained by its documentation. Croatian has a line about it; for a kind that a program adds without names, English
/// is used.
#[test]
fn a_missing_field_is_explained_in_both_languages() {
    let hints = |text: &str| {
        let text = format!("format = \"opruga-1\"\ndimension = 2\nintegrator = \"verlet\"\n{text}");
        let options = opruga_io::scene::Options::default();
        let read = opruga_io::scene::read(text.as_bytes(), "s.toml", &opruga::catalogue(), &options);
        let error = read.expect_err("a field is missing").remove(0);
        let croatian = Translation::croatian().text(&*error.advice.expect("an advice"));
        (error.hint.expect("a hint"), croatian.expect("a hint"))
    };
    let wanted = [
        ("[time]", "How long the scene lasts.", "Koliko prizor traje."),
        (
            "time = { seconds = 1 }\n[[collider]]\nkind = \"half_space\"\npoint = [0, 0]",
            "Direction out of the solid.",
            "Smjer iz krutine.",
        ),
    ];
    for (text, english, croatian) in wanted {
        assert_eq!(hints(text), (english.into(), croatian.into()), "{text}");
    }
    let added: AnyMessage = Added::Purpose { field: "model-own_model-own_rate".into() }.into();
    assert_eq!(Translation::croatian().text(&*added), None);
    assert_eq!(Translation::croatian().text_or_english(&*added), "A rate of its own.");
}

opruga_math::messages! {
    /// The explanation of a field of a kind that a program adds.
    #[derive(Clone, Debug, PartialEq)]
    enum Added {
        "part.scene_hint" #[error("A rate of its own.")]
        Purpose { field: String },
    }
}

/// Every field without a default in the sections of a scene has a line in Croatian, and no other field has one.
#[test]
fn what_a_scene_cannot_leave_out_has_a_croatian_line() {
    let mut named = BTreeSet::new();
    let mut missing = Vec::new();
    let mut check = |spec: &Spec| {
        let kind = spec.kind.replace('.', "_");
        for field in spec.fields.iter().filter(|field| field.default == Default::Required) {
            named.extend([&*kind, "every"].map(|kind| format!("scene-{kind}-{}", field.name)));
            if Translation::croatian().named_parameter("scene", &kind, field.name).is_none_or(|it| it.about.is_empty())
            {
                missing.push(format!("{kind}-{}", field.name));
            }
        }
    };
    schema::SELECTORS.iter().for_each(&mut check);
    of_section(&schema::SCENE, &mut check);
    assert!(missing.is_empty(), "{missing:?}");
    let paths = Translation::croatian().paths();
    let stale: Vec<_> = paths.iter().filter(|path| path.starts_with("scene-") && !named.contains(**path)).collect();
    assert!(stale.is_empty(), "{stale:?}");
}

/// A section and its subsections.
fn of_section(section: &'static Section, check: &mut impl FnMut(&Spec)) {
    check(section.spec);
    for child in section.children {
        match child.holds {
            Holds::Table(inner) | Holds::List(inner) | Holds::VectorOr(inner) => of_section(inner, check),
            Holds::Tagged { sections, .. } => sections.iter().for_each(|inner| of_section(inner, check)),
            _ => {}
        }
    }
}

#[test]
fn every_enum_of_messages_is_listed() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crates");
    let mut missing = Vec::new();
    for name in [
        "opruga",
        "opruga-collide",
        "opruga-core",
        "opruga-draw",
        "opruga-integrators",
        "opruga-io",
        "opruga-mesh",
        "opruga-models",
        "opruga-world",
    ] {
        let sources = sources(&crates.join(name).join("src"));
        let listed = |enumeration: &str| sources.iter().any(|text| text.contains(&format!("{enumeration}::VARIANTS")));
        for text in &sources {
            for declared in text.split("messages! {").skip(1).chain(text.split("terms! {").skip(1)) {
                let block = declared.split("\n}\n").next().unwrap_or_default();
                let names = block.split("enum ").skip(1).filter_map(|rest| rest.split([' ', '{']).next());
                missing.extend(names.filter(|name| !listed(name)).map(String::from));
            }
        }
    }
    assert!(missing.is_empty(), "{missing:?}");
}

/// The texts of all source files in a folder, without their tests.
fn sources(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder").flatten().map(|entry| entry.path());
    entries
        .flat_map(|path| match path.is_dir() {
            true => sources(&path),
            false => {
                let text = std::fs::read_to_string(path).unwrap_or_default();
                vec![text.split("#[cfg(test)]").next().unwrap_or_default().to_string()]
            }
        })
        .collect()
}
