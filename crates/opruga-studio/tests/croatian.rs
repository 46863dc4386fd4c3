//! What is refused and warned of while somebody works on a scene is said in Croatian too, to the last word.

use opruga::Options;
use opruga::core::spec::{Value, Values};
use opruga::io::Files;
use opruga_studio::session::{Edit, Request, Session};
use opruga_studio::shown::Severity;
use opruga_studio::words::Language;

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

/// What is said in Croatian of what is refused.
fn refused(session: &mut Session, request: Request) -> String {
    session.handle(request.clone());
    let message = session.shown().message.filter(|message| message.severity == Severity::Refused);
    let message = message.unwrap_or_else(|| panic!("{request:?} is not refused"));
    Language::Croatian.said(&message.said)
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
            if said.contains(ENGLISH) {
                english.push(format!("{request:?}: {said}"));
            }
        }
    }
    assert!(english.is_empty(), "{english:#?}");
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
        let said = Language::Croatian.detail(&warning.message);
        assert!(!said.contains(ENGLISH), "{said}");
        assert_ne!(said, warning.message);
    }
}
