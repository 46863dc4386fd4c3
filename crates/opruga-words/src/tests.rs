use super::*;
use opruga_math::message::AnyMessage;
use opruga_math::messages;

messages! {
    /// A part.
    #[derive(Clone, Debug, PartialEq)]
    enum Owner {
        "part.owner" #[error("body `{name}`")]
        Body { name: String },
        "part.owner" #[error("the world")]
        World {},
    }
    /// Messages of this test.
    #[derive(Clone, Debug, PartialEq)]
    enum Refusal {
        "test.left_out" #[error("{count} nodes of {owner} are left out{}", opruga_math::message::if_any(time))]
        #[allowed("at most {most}")] #[hint("leave them out")]
        LeftOut { count: u32, owner: AnyMessage, most: f64, time: Option<f64> },
        "test.unknown" #[error("nobody knows this")]
        Unknown {},
    }
}

const ENTRIES: &str = r#"
part-owner-Body = tijela `{ $name }`
test-left_out-LeftOut = { $count ->
        [0] ništa
        [one] izostavljen je { $count } čvor
        [few] izostavljena su { $count } čvora
       *[other] izostavljeno je { $count } čvorova
    } { $owner ->
        [World] svijeta
       *[other] { $owner }
    }{ $time ->
        [none] {""}
       *[other] {" "}u { NUMBER($time, maximumSignificantDigits: 2) } s
    }
    .allowed = najviše { $most }
"#;

#[test]
fn counts_parts_and_what_is_not_there_choose_the_words() {
    let (translation, problems) = Translation::new(&[ENTRIES]);
    assert_eq!(problems, [""; 0]);
    let texts = |count, owner: Owner, time| {
        let message = Refusal::LeftOut { count, owner: owner.into(), most: 0.1 + 0.2, time };
        (translation.text(&message).expect("it is known"), translation.allowed(&message), translation.hint(&message))
    };
    let body = || Owner::Body { name: "ball".into() };
    assert_eq!(texts(0, body(), None).0, "ništa tijela `ball`");
    for (count, wanted) in
        [(1, "je 1 čvor"), (22, "su 22 čvora"), (12, "je 12 čvorova"), (5, "je 5 čvorova"), (101, "je 101 čvor")]
    {
        assert!(texts(count, body(), None).0.contains(wanted), "{count}");
    }
    let (text, allowed, hint) = texts(2, Owner::World {}, Some(0.123));
    assert_eq!(text, "izostavljena su 2 čvora svijeta u 0.12 s");
    assert_eq!((allowed.as_deref(), hint.as_deref()), (Some("najviše 0.3"), Some("leave them out")));
    let full =
        translation.in_full(&Refusal::LeftOut { count: 0, owner: Owner::World {}.into(), most: 1.0, time: None });
    assert_eq!(full.as_deref(), Some("ništa svijeta; dopušteno: najviše 1; savjet: leave them out"));
    assert_eq!(translation.text(&Refusal::Unknown {}), None);
    assert_eq!(translation.text_or_english(&Owner::World {}), "the world");
}

#[test]
fn what_is_wrong_with_a_translation_is_found() {
    let twice = "a = 1\na = 2\n} = 3\n";
    let (_, problems) = Translation::new(&[twice]);
    assert_eq!(problems.len(), 2, "{problems:?}");
    let (translation, _) =
        Translation::new(&["test-unknown-Unknown = { $what }\npart-owner-Body = tijelo\nold = staro\n"]);
    let gaps = translation.gaps(Refusal::VARIANTS.iter().chain(Owner::VARIANTS));
    let wanted = [
        "`test-left_out-LeftOut` is missing",
        "`test-unknown-Unknown` has the fields {\"what\"} in `text`, and the English text {}",
        "`part-owner-Body` has the fields {} in `text`, and the English text {\"name\"}",
        "`part-owner-World` is missing",
        "no variant is called `old`",
    ];
    assert_eq!(gaps, wanted);
}

#[test]
fn the_croatian_files_can_be_read() {
    assert_eq!(Translation::new(&CROATIAN_FILES).1, [""; 0]);
}

#[test]
fn names_are_found_by_their_path_and_those_of_a_program_beside_them() {
    assert_eq!(names::Names::default().add(CROATIAN_NAMES), [""; 0]);
    let translation = Translation::default();
    let own =
        "model-bed = krevet\n    .about = krevet od opruga\nmodel-bed-size = širina\nmodel-every-size = veličina\n";
    assert_eq!(translation.add_names(own), Ok(()));
    let name = |path: &[&str]| translation.named(path).map(|known| (known.name, known.about));
    assert_eq!(name(&["model", "bed"]), Some(("krevet", "krevet od opruga")));
    assert_eq!(name(&["model", "sofa"]), None);
    let parameter = |kind| translation.named_parameter("model", kind, "size").map(|known| known.name);
    assert_eq!((parameter("bed"), parameter("sofa")), (Some("širina"), Some("veličina")));
    assert_eq!(translation.any_parameter("size").map(|known| known.name), Some("širina"), "the first line");
    // Entries with errors are skipped, and valid ones next to them are added.
    let problems = translation.add_names("model-bed = ležaj\nmodel-sofa = { $x }\nmodel-chair = stolac\n").unwrap_err();
    assert_eq!(problems, ["`model-bed` is named already", "`model-sofa` is not one plain line"]);
    assert_eq!(name(&["model", "chair"]), Some(("stolac", "")));
    assert_eq!(translation.paths(), ["model-bed", "model-bed-size", "model-chair", "model-every-size"]);
}
