//! The Croatian texts are those of the messages that the crates have, no more and no fewer.

use opruga_core::error::StepError;
use opruga_integrators::refusals::StepHint;
use opruga_math::message::Message as _;
use opruga_models::fem::Refusal;
use opruga_words::Translation;
use opruga_world::WorldError;
use std::path::Path;

#[path = "../../opruga-cli/src/errors.rs"]
mod call_errors;

#[test]
fn every_message_has_a_croatian_text_with_its_fields() {
    let io = opruga_io::messages::MESSAGES.iter().flat_map(|lists| lists.iter());
    let others = [
        opruga_models::MESSAGES,
        opruga_integrators::refusals::MESSAGES,
        opruga_collide::refusals::MESSAGES,
        opruga_world::warnings::MESSAGES,
        opruga::sweep::errors::MESSAGES,
        opruga::recordings::MESSAGES,
        &[call_errors::CallError::VARIANTS],
        &[opruga_video::VideoError::VARIANTS],
    ];
    let variants = io.chain(others.into_iter().flatten()).flat_map(|list| list.iter());
    let gaps = Translation::croatian().gaps(variants);
    assert!(gaps.is_empty(), "{gaps:#?}");
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
        english.ends_with("; hint: `when_not_converged = \"halve\"`, more `load_steps`, or more `iterations`"),
        "{english}"
    );
}

#[test]
fn every_enum_of_messages_is_listed() {
    let crates = Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crates");
    let mut missing = Vec::new();
    for name in [
        "opruga",
        "opruga-collide",
        "opruga-core",
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

/// The texts of all sources of a folder, without their tests.
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
