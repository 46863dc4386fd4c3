//! Errors and warnings while the user works on a scene have a complete Croatian translation.

use opruga::core::error::BuildError;
use opruga::core::spec::{Value, Values};
use opruga::io::Files;
use opruga::math::message::Message;
use opruga::world::error::Part;
use opruga::{Options, WorldError};
use opruga_studio::report::Report;
use opruga_studio::session::{Edit, Request, Session};
use opruga_studio::shown::Severity;
use opruga_studio::words::Language;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

const ENGLISH: &str = "na engleskom";

fn scene(models: &str, shape: &str, rest: &str) -> String {
    format!(
        "format = \"opruga-1\"\ntitle = \"proba\"\ndimension = 2\n[time]\nseconds = 1.0\nframe = 0.02\nsubsteps = 64\n\
         [world]\ngravity = [0.0, -9.81]\n[integrator]\nkind = \"verlet\"\n[[body]]\nname = \"tijelo\"\nshape = {shape}\n\
         mass = 0.5\nmodels = [{models}]\n{rest}"
    )
}

const SPRINGS: &str = "{ kind = \"mass_spring\", stiffness = 200.0, damping = 0.1 }";
const CHAIN: &str = "{ kind = \"line\", from = [0.0, 1.0], to = [1.0, 1.0], segments = 8 }";
const RING: &str = "{ kind = \"ring\", radius = 0.5, vertices = 16, center = [0.0, 1.0] }";

fn open(text: &str) -> Session {
    Session::open("proba", text, Files::default(), Options::default()).unwrap_or_else(|said| panic!("{said}"))
}

fn values(spec: &'static opruga::core::spec::Spec, given: &[(&str, Value)]) -> Values {
    let mut values = Values::defaults(spec, 2);
    for (name, value) in given {
        values.set(spec, name, value.clone(), 2).expect("an allowed value");
    }
    values
}

fn model(kind: &str, given: &[(&str, Value)]) -> Values {
    let registry = opruga::Registry::<2>::default();
    values(registry.models().into_iter().find(|spec| spec.kind == kind).expect("a model"), given)
}

fn integrator(kind: &str, given: &[(&str, Value)]) -> Values {
    let registry = opruga::Registry::<2>::default();
    values(registry.integrators().into_iter().find(|spec| spec.kind == kind).expect("an integrator"), given)
}

/// The Croatian text about a refused request.
fn refused(session: &mut Session, request: Request) -> String {
    session.handle(request.clone());
    let message = session.shown().message.filter(|message| message.severity == Severity::Refused);
    let message = message.unwrap_or_else(|| panic!("{request:?} is not refused"));
    Language::Croatian.report(&message.report)
}

#[test]
fn what_models_integrators_and_the_world_refuse_is_said_in_croatian() {
    let number = Value::Number;
    let text = |word: &str| Value::Text(word.into());
    let springs = || model("mass_spring", &[("stiffness", number(200.0))]);
    let requests: Vec<(&str, Request)> = vec![
        (CHAIN, Request::Models(0, vec![springs(), model("pressure", &[("nRT", number(20.0))])])),
        (CHAIN, Request::Models(0, vec![model("mass_spring", &[("modulus", number(20.0))])])),
        (RING, Request::Models(0, vec![model("mass_spring", &[])])),
        (RING, Request::Models(0, vec![springs(), model("pressure", &[])])),
        (RING, Request::Models(0, vec![springs(), model("bending", &[])])),
        (RING, Request::Models(0, vec![springs(), model("bending", &[("modulus", number(20.0))])])),
        (RING, Request::Models(0, vec![springs(), model("fem", &[("youngs_modulus", number(1e4))])])),
        (
            RING,
            Request::Models(
                0,
                vec![springs(), model("pressure", &[("nRT", number(20.0)), ("inside", text("cavities"))])],
            ),
        ),
        (RING, Request::Integrator(None, integrator("equilibrium", &[]))),
        (RING, Request::Integrator(None, integrator("implicit_midpoint", &[("accuracy", text("real_time"))]))),
        (RING, Request::Set("time.substeps".into(), Value::Integer(0))),
        (RING, Request::Set("body.tijelo.models.0.damping".into(), number(-1.0))),
        (RING, Request::Set("body.nitko.models.0.damping".into(), number(1.0))),
        (RING, Request::Set("world.gravity".into(), number(1.0))),
        (RING, Request::Set("collider.7.friction".into(), number(1.0))),
        (RING, Request::Edit(Edit::Duplicate("nitko".into()))),
    ];
    let mut english = Vec::new();
    for (shape, request) in requests {
        for later in [false, true] {
            let mut session = open(&scene(SPRINGS, shape, ""));
            if later {
                session.handle(Request::Step);
            }
            let said = refused(&mut session, request.clone());
            if said.contains(ENGLISH) || said.contains("body `") {
                english.push(format!("{request:?}: {said}"));
            }
        }
    }
    assert!(english.is_empty(), "{english:#?}");
}

/// Numbers are rounded to a readable number of digits, and the body is named in Croatian.
#[test]
fn places_and_numbers_of_the_world_are_said_in_croatian_as_in_english() {
    let (time, last) = (0.101_041_666_666_666_67, 0.1);
    let diverged = WorldError::Diverged { body: "tijelo".into(), node: 3, time, last, range: Some(12_345_678.9) };
    let unstable = WorldError::UnstableStep {
        integrator: "verlet",
        body: "tijelo".into(),
        h: 1.0 / 1920.0,
        limit: 1.0 / 12_345.0,
        omega: 1.0,
        damping: 0.0,
        substeps: 220,
    };
    for (error, numbers) in
        [(diverged, ["0.101042 s", "0.1 s", "1.23457e7 m"]), (unstable, ["0.000520833 s", "8.10045e-5 s", "220"])]
    {
        let (english, croatian) = (error.in_full(), Language::Croatian.report(&Report::World(error)));
        for number in numbers {
            assert!(english.contains(number) && croatian.contains(number), "{number}: {english}\n{croatian}");
        }
    }
    for (part, wanted) in [
        (Part::body("lopta"), "tijelo `lopta`:"),
        (Part::IntegratorOf { name: "lopta".into() }, "integrator tijela `lopta`:"),
        (Part::Section { path: "integrator" }, "integrator:"),
        (Part::Collider { index: 2 }, "prepreka 2:"),
        (Part::Section { path: "world" }, "svijet:"),
    ] {
        let source = BuildError::new("pressure", "model.no_cavity", "the body has no cavity that nobody has heard of");
        let said = Language::Croatian.report(&Report::World(WorldError::Build { part, source }));
        assert!(said.starts_with(wanted), "{said}");
    }
}

#[test]
fn what_is_wrong_with_a_scene_is_said_in_croatian_with_its_places_values_and_limits() {
    let ball = opruga::scenes::find("ball").expect("a scene");
    let wrong = ball.replace("mass = 1.0", "mass = -1.0").replace("radius = 0.5", "raduis = 0.5");
    let refused = Session::open("ball", &wrong, Files::default(), Options::default()).expect_err("it is wrong");
    let told = Language::Croatian.report(&refused);
    for part in ["greška[scene.range]: `mass` je -1.0", "greška[scene.unknown_field]: nema polja `raduis`"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert!(told.contains("dopušteno: ") && told.contains("savjet: "), "{told}");
    assert_eq!(told.lines().count(), refused.to_string().lines().count());
}

#[test]
fn warnings_are_said_in_croatian() {
    let floor = "[[collider]]\nkind = \"half_space\"\npoint = [0.0, 1.2]\nnormal = [0.0, 1.0]\n";
    let soft = "{ kind = \"mass_spring\", stiffness = 0.01, damping = 0.0 }";
    let mut session = open(&scene(soft, RING, floor));
    session.handle(Request::Step);
    let warnings = session.shown().warnings;
    assert!(warnings.len() >= 2, "{warnings:?}");
    for warning in &warnings {
        let said = Language::Croatian.warning_text(warning);
        assert!(!said.contains(ENGLISH), "{said}");
        assert_ne!(said, warning.message);
    }
}

include!("../../../../fuzz/src/shape_kinds.rs");

/// Samples of mesh files of every format: dimension, name, shape, bytes.
fn meshes() -> Vec<(u8, &'static str, &'static str, Vec<u8>)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/corpus/shape_files");
    let mut paths: Vec<_> = std::fs::read_dir(&folder).expect("a corpus").flatten().map(|entry| entry.path()).collect();
    paths.sort();
    let samples = paths.iter().map(|path| {
        let input = std::fs::read(path).expect("a sample");
        let (which, bytes) = input.split_first().expect("a sample that says what it is");
        let (dimension, name, shape) = SHAPES[usize::from(*which)];
        (dimension, name, shape, bytes.to_vec())
    });
    samples.filter(|(_, _, shape, _)| shape.starts_with("kind = \"mesh\"")).collect()
}

/// The errors of a scene with one body from a file; none if the file is sound.
fn wrong_with(dimension: u8, name: &str, shape: &str, bytes: &[u8]) -> Option<String> {
    let named = name.replace(".node", ".ele");
    let text = format!(
        "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\n[integrator]\nkind = \"symplectic_euler\"\n\
         [[body]]\nname = \"it\"\nmass = 1\nshape = {{ file = \"{named}\", {shape} }}\n"
    );
    let beside = [("a.node", NODES), ("a.ele", CELLS)].into_iter().filter(|(file, _)| *file != name);
    let files = beside.chain([(name, bytes)]).map(|(file, bytes)| (file.to_string(), Arc::from(bytes)));
    let said = Session::open("proba", &text, Files::in_memory(files), Options::default()).err()?;
    Some(Language::Croatian.report(&said))
}

/// Mesh files that are truncated, contain invalid words, or have too many or too few lines.
#[test]
fn what_is_wrong_with_mesh_files_is_said_in_croatian() {
    let samples = meshes();
    for ending in ["msh", "vtk", "vtu", "mesh", "node", "ele"] {
        assert!(samples.iter().any(|(_, name, ..)| name.ends_with(ending)), "a sample of .{ending}");
    }
    let (mut english, mut count) = (BTreeMap::new(), 0);
    for (dimension, name, shape, bytes) in &samples {
        let mut tampered = Vec::new();
        let words: Vec<(usize, usize)> = {
            let blank = |at: &usize| bytes[*at].is_ascii_whitespace();
            let starts = (0..bytes.len()).filter(|at| !blank(at) && (*at == 0 || blank(&(at - 1))));
            starts.map(|from| (from, (from..bytes.len()).find(blank).unwrap_or(bytes.len()))).collect()
        };
        // The same number for a long file as for a short one.
        for &(from, to) in words.iter().step_by(words.len().div_ceil(48)) {
            tampered.push(bytes[..from].to_vec());
            tampered.push([&bytes[..from], &bytes[to..]].concat());
            tampered.push([&bytes[..to], b" ", &bytes[from..]].concat());
            for word in ["x", "-1", "3", "7", "13", "99", "nan", "1,5", "$A"] {
                tampered.push([&bytes[..from], word.as_bytes(), &bytes[to..]].concat());
            }
        }
        // Some as they are, without the repairs.
        let plain = tampered.iter().step_by(4).map(|bytes| (bytes, "kind = \"mesh\""));
        for (bytes, shape) in tampered.iter().map(|bytes| (bytes, *shape)).chain(plain) {
            let Some(said) = wrong_with(*dimension, name, shape, bytes) else { continue };
            count += 1;
            for line in said.lines() {
                // Locations and lines of the file are next to the message.
                let own = line.split_once("]: ").map(|(_, said)| said);
                let own = own.or(line.strip_prefix("  = dopušteno: ")).or(line.strip_prefix("  = savjet: "));
                let Some(own) = own else { continue };
                // Texts of other programs stay as they are, in quotes; `a` is a word of both languages.
                let own: String = own.split(['„', '”']).step_by(2).collect();
                let words = [" the ", " an ", " is ", " are ", " of ", " or ", " in ", " and ", "whole", "only "];
                if own.contains(ENGLISH) || words.iter().any(|word| format!(" {own} ").contains(word)) {
                    english.entry(own.to_string()).or_insert_with(|| format!("{name}: {said}"));
                }
            }
        }
    }
    assert!(count > 2000, "{count} files are refused");
    assert!(english.is_empty(), "{} of {count}: {english:#?}", english.len());
}
