//! A model that only this test knows: a program that registers it finds it in the studio, with its initial value and its texts.

use super::screen::window::{SIZE, Window};
use egui_kittest::kittest::Queryable;
use opruga::extend::*;
use opruga::io::Files;
use opruga::words::Translation;
use opruga::{Options, Registries, Registry};
use opruga_studio::session::{Request, Session};
use opruga_studio::setting::Setting;
use opruga_studio::shown::Severity;
use opruga_studio::words::{Language, Part};
use std::sync::Arc;

const K: Field =
    Field::new("tightness", Allowed::POSITIVE, "N/m", Default::Required, "Stiffness k of every node.").starts_at(250.0);
const SPEC: Spec = Spec {
    kind: "bed_of_a_test",
    summary: "a bed that only a test knows",
    documentation: "",
    dimensions: &[2],
    fields: &[K],
    roles: &[],
};

/// U = ½ k |x − X|² for every node; the bed refuses bodies with more than 100 nodes.
struct BedModel;
impl Model<2> for BedModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn views(&self) -> Views {
        Views::default()
    }
    fn build(&self, of: &Ingredients<2>) -> Result<Box<dyn Potential<2>>, BuildError> {
        if of.mesh.nodes() > 100 {
            return Err(BuildError::new(SPEC.kind, "bed.too_large", "the bed is too small for the body"));
        }
        Ok(Box::new(Bed(of.values[0].number("tightness").unwrap_or(0.0), of.mesh.positions.clone())))
    }
}

/// The stiffness of a node [N/m] and the rest positions [m].
#[derive(Debug)]
struct Bed(f64, Vec<[f64; 2]>);
impl Potential<2> for Bed {
    fn properties(&self) -> Properties {
        Properties::new(SPEC.kind, Views::default())
    }
    fn add_force(&self, _: Simd, view: &View<2>, _: &[f64], tile: &mut Tile<2>) {
        for node in tile.range.start..tile.range.end.min(self.1.len()) {
            for d in 0..2 {
                tile.force[d][node - tile.range.start] -= self.0 * (view.x[d][node] - self.1[node][d]);
            }
        }
    }
}

impl Observe<2> for Bed {}

fn session(vertices: u32) -> Session {
    let text = format!(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1\nframe = 0.01\nsubsteps = 32\n[integrator]\nkind = \"verlet\"\n\
         [[body]]\nname = \"it\"\nmass = 1\nshape = {{ kind = \"ring\", radius = 1, vertices = {vertices} }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 100 }}]\n"
    );
    let mut plane = Registry::default();
    plane.add_model(Box::new(BedModel));
    let registries = Registries { plane: Arc::new(plane), ..Registries::default() };
    Session::open("it", &text, Files::default(), Setting { options: Options::default(), registries }).expect("it opens")
}

fn bed() -> Values {
    let mut values = Values::defaults(&SPEC, 2);
    values.set(&SPEC, K.name, 250.0.into(), 2).expect("allowed");
    values
}

#[test]
fn a_registered_model_is_offered_by_the_panel_and_begins_with_its_start_value() {
    let mut window = Window::on(session(12), SIZE, 1.0);
    window.click("Add a model");
    assert!(window.harness.query_by_label("bed of a test").is_some(), "it is called as in the scene");
    window.click("bed of a test");
    window.until("a bed", |shown| shown.bodies[0].models.last() == Some(&bed()));
    let sliders = window.harness.query_all_by_role_and_label(egui::Role::Slider, "tightness [N/m]").count();
    assert_eq!(sliders, 1, "its field has a slider");
    let text = window.studio().link().copy_now().recv().expect("a copy").text;
    assert!(text.contains("kind = \"bed_of_a_test\"") && text.contains("tightness = 250.0"), "{text}");
}

#[test]
fn a_registered_model_has_its_own_words_in_both_languages() {
    assert_eq!(Language::English.kind(Part::Model, SPEC.kind), "bed of a test");
    assert_eq!(Language::English.summary(Part::Model, &SPEC), SPEC.summary);
    assert_eq!(Language::Croatian.summary(Part::Model, &SPEC), format!("{} (na engleskom)", SPEC.summary));
    let sentence = Language::English.sentence(Part::Model, SPEC.kind, &K, 2);
    assert!(sentence.starts_with(K.documentation) && sentence.contains("a number > 0"), "{sentence}");
    // Its program provides the names in the other language.
    let names = "model-bed_of_a_test = ležaj\n    .about = ležaj koji zna samo test\n\
                 model-bed_of_a_test-tightness = napetost\n    .about = Krutost k svakog čvora.\n";
    assert_eq!(Translation::croatian().add_names(names), Ok(()));
    let language = Language::Croatian;
    assert_eq!(language.kind(Part::Model, SPEC.kind), "ležaj");
    assert_eq!(language.summary(Part::Model, &SPEC), "ležaj koji zna samo test");
    assert_eq!(language.field(Part::Model, SPEC.kind, K.name), "napetost");
    let sentence = language.sentence(Part::Model, SPEC.kind, &K, 2);
    assert!(sentence.starts_with("Krutost k svakog čvora.\nbroj > 0"), "{sentence}");
    assert_eq!(Language::English.kind(Part::Model, SPEC.kind), "bed of a test");
}

#[test]
fn what_a_registered_model_refuses_is_told_and_the_scene_goes_on_with_what_it_takes() {
    let mut large = session(101);
    large.handle(Request::Models(0, vec![bed()]));
    let message = large.shown().message.expect("a message");
    assert!(message.severity == Severity::Refused && message.text.contains("the bed is too small"), "{}", message.text);
    let mut small = session(12);
    small.handle(Request::Models(0, vec![bed()]));
    assert!(small.shown().message.is_none());
    let before = small.hash();
    small.handle(Request::Step);
    assert_eq!((small.shown().frames, small.shown().bodies[0].models.clone()), (1, vec![bed()]));
    // The saved scene is opened again, next to the recorded one.
    small.handle(Request::Reset);
    assert_eq!(small.hash(), before);
}
