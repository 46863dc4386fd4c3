//! Any bytes are a scene or a list of errors with places that can be printed.
#![no_main]

use libfuzzer_sys::fuzz_target;
use opruga_core::spec::{Allowed, Default, Field, Spec};
use opruga_io::Catalogue;
use opruga_io::scene::{Limits, Options, read};

const fn field(name: &'static str, range: Allowed, default: Default) -> Field {
    Field { name, range, unit: "", default, documentation: "" }
}

const fn spec(kind: &'static str, fields: &'static [Field]) -> Spec {
    Spec { kind, summary: "", documentation: "", dimensions: &[2, 3], fields }
}

static MASS_SPRING: Spec = spec(
    "mass_spring",
    &[
        field("stiffness", Allowed::NOT_NEGATIVE, Default::Absent),
        field("damping", Allowed::NOT_NEGATIVE, Default::Number(0.0)),
    ],
);
static PRESSURE: Spec = spec(
    "pressure",
    &[field("nRT", Allowed::POSITIVE, Default::Required), field("temperature", Allowed::Curve, Default::Absent)],
);
static EULER: Spec = spec("symplectic_euler", &[]);
static HALF_SPACE: Spec = spec(
    "half_space",
    &[field("point", Allowed::Vector, Default::Required), field("normal", Allowed::Vector, Default::Required)],
);

fuzz_target!(|bytes: &[u8]| {
    let catalogue =
        Catalogue { models: vec![&MASS_SPRING, &PRESSURE], integrators: vec![&EULER], colliders: vec![&HALF_SPACE] };
    let limits = Limits { nodes: 20_000, bodies: 2_000, memory_bytes: 64 << 20, ..Limits::default() };
    let options = Options { limits, ..Options::default() };
    if let Err(errors) = read(bytes, "fuzz.toml", &catalogue, &options) {
        assert!(!errors.is_empty());
        for error in errors {
            assert!(error.to_string().chars().all(|c| c == '\n' || !c.is_control()));
        }
    }
});
