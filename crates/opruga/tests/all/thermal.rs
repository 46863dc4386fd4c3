//! Thermal expansion from the text of a scene: free bodies, clamped bars, slices, temperatures of cells, changes during a run, errors.
//!
//! Expected values are closed forms, given in the comments.

use crate::common;
use common::*;
use opruga::World;
use opruga::core::spec::Value;
use opruga::math::message::Message as _;

const LAWS: [&str; 7] = [
    "linear",
    "st_venant_kirchhoff",
    "corotated",
    "fixed_corotated",
    "neo_hookean",
    "stable_neo_hookean",
    "mooney_rivlin",
];

/// α = 1e-3 1/K, 100 K warmer: g = 1.1.
const HEAT: &str = "thermal_expansion = 1e-3, temperature = 400.0, reference_temperature = 300.0";

fn statics_3d(body: &str) -> String {
    format!(
        "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\nframe = 1.0\nsubsteps = 1\n[integrator]\nkind = \"equilibrium\"\n\
         [[body]]\nname = \"b\"\ndensity = 1000\n{body}"
    )
}

fn statics(body: &str) -> String {
    format!("{}[[body]]\nname = \"b\"\ndensity = 1000\n{body}", head(1.0, 1, 0.0, "equilibrium"))
}

/// The largest error of the displacement of a node relative to its rest position, if pins fix a corner.
fn largest_error<const D: usize>(world: &World<D>, growth: [f64; D]) -> f64 {
    let rest = &world.blueprint().bodies[0].mesh.positions;
    largest((0..rest.len()).flat_map(|node| {
        let x = world.position(0, node as u32);
        let rest = rest[node];
        (0..D).map(move |d| x[d] - growth[d] * rest[d])
    }))
}

fn largest_stress<const D: usize>(world: &World<D>) -> f64 {
    largest(world.cell_states(0).iter().flat_map(|state| state.stress.as_flattened().to_vec()))
}

/// A free body expands by exactly g in every direction and has no stress: every law, every type of cells, in space and as a plate.
#[test]
fn a_free_heated_body_grows_by_exactly_its_expansion_and_has_no_stress() {
    let cells = ["", "simplices = true\norder = 1\n", "simplices = true\n"];
    for law in LAWS {
        for cells in cells {
            let body = |size: &str, number: &str, more: &str, pins: &str| {
                format!(
                    "shape = {{ kind = \"grid\", size = {size}, cells = {number} }}\n{cells}\
                     models = [{{ kind = \"fem\", material = \"{law}\", youngs_modulus = 1e5, poissons_ratio = 0.3, {HEAT}{more} }}]\npin = [{pins}]\n"
                )
            };
            let left =
                "{ select = { side = \"left\" }, axes = \"x\" }, { select = { side = \"bottom\" }, axes = \"y\" }";
            let mut plate = built(plane(&statics(&body("[1, 2]", "[2, 3]", ", plane = \"stress\"", left))));
            frames(&mut plate, 1);
            let error = largest_error(&plate, [1.1, 1.1]);
            assert!(error < 1e-9, "{law}, plate, {cells}: {error:e}");
            assert!(largest_stress(&plate) < 1e-4, "{law}, plate, {cells}: {:e}", largest_stress(&plate));
            assert!(plate.energy().elastic.abs() < 1e-9, "{law}: {:?}", plate.energy());
            let ratio = plate.cell_states(0)[0].volume_ratio;
            assert!((ratio - 1.331).abs() < 1e-8, "{law}, {cells}: the thickness grows too: {ratio}");

            let back = format!("{left}, {{ select = {{ side = \"back\" }}, axes = \"z\" }}");
            let mut block = built(space(&statics_3d(&body("[1, 2, 1]", "[1, 2, 1]", "", &back))));
            frames(&mut block, 1);
            let error = largest_error(&block, [1.1; 3]);
            assert!(error < 1e-9, "{law}, block, {cells}: {error:e}");
            assert!(largest_stress(&block) < 1e-4, "{law}, block, {cells}: {:e}", largest_stress(&block));
        }
    }
}

/// Plane strain: by 1 + (1 + ν) αΔT in the plane, and −EαΔT across it, exactly under the law of small strain (Timoshenko, Goodier).
#[test]
fn a_slice_grows_by_one_plus_poissons_ratio_times_its_expansion() {
    let (modulus, ratio, strain) = (1e5, 0.3, 0.02);
    for cells in ["", "simplices = true\norder = 1\n", "simplices = true\n"] {
        let mut world = built(plane(&statics(&format!(
            "shape = {{ kind = \"grid\", size = [1, 2], cells = [2, 3] }}\n{cells}\
             models = [{{ kind = \"fem\", material = \"linear\", youngs_modulus = {modulus:?}, poissons_ratio = {ratio}, \
             thermal_expansion = 2e-4, temperature = 393.15 }}]\n\
             pin = [{{ select = {{ side = \"left\" }}, axes = \"x\" }}, {{ select = {{ side = \"bottom\" }}, axes = \"y\" }}]\n"
        ))));
        frames(&mut world, 1);
        let growth = 1.0 + (1.0 + ratio) * strain;
        let error = largest_error(&world, [growth, growth]);
        assert!(error < 1e-10, "{cells}: {error:e}");
        for state in world.cell_states(0) {
            let s = state.stress;
            assert!(largest([s[0][0], s[1][1], s[0][1]]) < 1e-5, "{s:?}");
            assert!((s[2][2] + modulus * strain).abs() < 1e-5, "{s:?}");
        }
    }
}

/// A bar between two walls: exactly σ = −EαΔT for the law of small strain; for the others, the stress of their law at 1/g.
#[test]
fn a_bar_held_at_both_ends_has_the_stress_of_its_expansion() {
    let (modulus, strain) = (2e5, 0.01);
    let bar = |law: &str, heat: &str| {
        statics_3d(&format!(
            "shape = {{ kind = \"grid\", size = [4, 1, 1], cells = [4, 1, 1] }}\n\
             models = [{{ kind = \"fem\", material = \"{law}\", youngs_modulus = {modulus:?}, poissons_ratio = 0.25, {heat} }}]\n\
             pin = [{{ select = {{ side = \"left\" }}, axes = \"x\" }}, {{ select = {{ side = \"right\" }}, axes = \"x\" }}, \
             {{ select = {{ side = \"bottom\" }}, axes = \"y\" }}, {{ select = {{ side = \"back\" }}, axes = \"z\" }}]\n"
        ))
    };
    let heat = "thermal_expansion = 1e-4, temperature = 393.15";
    let mut world = built(space(&bar("linear", heat)));
    frames(&mut world, 1);
    for state in world.cell_states(0) {
        assert!((state.stress[0][0] + modulus * strain).abs() < 1e-5, "{:?}", state.stress);
        assert!(largest([state.stress[1][1], state.stress[2][2]]) < 1e-5, "{:?}", state.stress);
    }
    let right = opruga::blueprint::Selector::<3>::Side("right".into());
    let blueprint = &world.blueprint().bodies[0];
    let nodes = right.resolve(&blueprint.mesh, &blueprint.translation);
    let force = world.reaction(0, &nodes)[0];
    assert!((force + modulus * strain).abs() < 1e-5, "{force}");
    // To first order all laws agree.
    for law in LAWS {
        let mut world = built(space(&bar(law, heat)));
        frames(&mut world, 1);
        let stress = world.cell_states(0)[0].stress[0][0];
        assert!((stress / (-modulus * strain) - 1.0).abs() < 0.03, "{law}: {stress}");
    }
    // At the reference temperature nothing changes, to the bit.
    let mut cold = built(space(&bar("neo_hookean", "thermal_expansion = 1e-4, temperature = 293.15")));
    let mut plain = built(space(&bar("neo_hookean", "damping = 0.0")));
    frames(&mut cold, 1);
    frames(&mut plain, 1);
    assert_eq!(cold.state_hash(), plain.state_hash());
}

/// Heating during the run: the bar expands to its new length, and the added energy is work of the user.
#[test]
fn the_temperature_changes_while_the_scene_runs_and_its_work_is_in_the_ledger() {
    let text = head(0.05, 4, 0.0, "backward_euler")
        + "[[body]]\nname = \"b\"\ndensity = 1000\nshape = { kind = \"grid\", size = [1, 1], cells = [2, 2] }\n\
           models = [{ kind = \"fem\", youngs_modulus = 1e5, plane = \"stress\", damping = 0.1, thermal_expansion = 1e-3 }]\n\
           pin = [{ select = { side = \"left\" }, axes = \"x\" }, { select = { side = \"bottom\" }, axes = \"y\" }]\n\
           [[command]]\ndo = \"set\"\nat = 0.1\npath = \"body.b.models.fem.temperature\"\nvalue = 393.15\n";
    let mut world = built(plane(&text));
    frames(&mut world, 2);
    assert!(largest_error(&world, [1.0, 1.0]) < 1e-12);
    let kept = world.snapshot();
    frames(&mut world, 60);
    assert!(largest_error(&world, [1.1, 1.1]) < 1e-4, "{:e}", largest_error(&world, [1.1, 1.1]));
    let energy = world.energy();
    assert!(energy.work_user > 1.0 && energy.closure < 0.7, "{energy:?}");
    // Rewound and continued: the same bits.
    let hash = world.state_hash();
    let mut again = built(plane(&text));
    again.restore(&kept).expect("a snapshot of this scene");
    frames(&mut again, 60);
    assert_eq!(again.state_hash(), hash);
    // Back to the reference temperature.
    world.set("body.b.models.fem.temperature", Value::Number(293.15)).expect("a parameter");
    frames(&mut world, 60);
    assert!(largest_error(&world, [1.0, 1.0]) < 1e-4);
}

/// Eight adjacent bodies of different temperatures: each moves as it does alone, to the bit.
#[test]
fn eight_bodies_of_different_temperatures_move_as_each_alone_does() {
    let scene = |only: Option<usize>| {
        let mut text = head(0.01, 16, -9.81, "verlet");
        for k in (0..8).filter(|k| only.is_none_or(|only| *k == only)) {
            text += &format!(
                "[[body]]\nname = \"b{k}\"\ndensity = 900\nshape = {{ kind = \"grid\", size = [1, 1], cells = [2, 2] }}\n\
                 models = [{{ kind = \"fem\", youngs_modulus = 1e5, thermal_expansion = 1e-3, temperature = {:?} }}]\n",
                293.15 + 20.0 * k as f64
            );
        }
        text
    };
    let copies = head(0.01, 16, -9.81, "verlet")
        + "[[body]]\nname = \"b\"\ndensity = 900\nshape = { kind = \"grid\", size = [1, 1], cells = [2, 2] }\n\
           copies = { count = [8], spacing = [0, 0] }\n\
           models = [{ kind = \"fem\", youngs_modulus = 1e5, thermal_expansion = 1e-3, temperature = 293.15 }]\n";
    let mut many = built(plane(&copies));
    for k in 0..8 {
        let path = format!("body.b[{k}].models.fem.temperature");
        many.set(&path, Value::Number(293.15 + 20.0 * k as f64)).expect("a parameter");
    }
    assert_eq!(many.islands(), 1, "all are side by side");
    frames(&mut many, 5);
    for k in [0, 1, 7] {
        let mut alone = built(plane(&scene(Some(k))));
        frames(&mut alone, 5);
        for node in 0..9 {
            assert_eq!(alone.position(0, node), many.position(k, node), "body {k}");
        }
    }
}

#[test]
fn what_cannot_be_a_temperature_is_refused_with_a_hint() {
    let scene = |fields: &str, more: &str| {
        head(0.01, 16, 0.0, "verlet")
            + &format!(
                "[[body]]\nname = \"b\"\ndensity = 900\nshape = {{ kind = \"grid\", size = [1, 1], cells = [2, 2] }}\n{more}\
                 models = [{{ kind = \"fem\", youngs_modulus = 1e5, {fields} }}]\n"
            )
    };
    let error = refused(&scene("thermal_expansion = 0.1, temperature = 200.0", "")).in_full();
    assert!(error.contains("cell 0 would be") && error.contains("hint: steel"), "{error}");
    let nodal = scene(
        "thermal_expansion = 1e-3, temperature = 300.0, poissons_ratio = 0.49, locking = \"nodal_volume\"",
        "simplices = true\norder = 1\n",
    );
    assert!(refused(&nodal).in_full().contains("hint: bodies with `order = 2`"), "{}", refused(&nodal));
    let unknown = refused(&scene("thermal_expansion = 1e-3, temperature_of_cells = \"T\"", "")).in_full();
    assert!(
        unknown.contains("`temperature_of_cells` is \"T\"") && unknown.contains("`temperature` gives one"),
        "{unknown}"
    );
    let errors = read(&scene("thermal_expansion = 1e-3, temperature = -5.0", "")).expect_err("below absolute zero");
    assert!(errors.iter().any(|error| error.code == "scene.range"), "{errors:?}");
    // Without expansion a temperature has no effect, which is reported.
    let options = opruga::io::scene::Options::default();
    let text = scene("temperature = 400.0", "");
    let (_, notices) =
        opruga::io::scene::read(text.as_bytes(), "test.toml", &opruga::catalogue(), &options).expect("a scene");
    assert!(notices.iter().any(|notice| notice.about.message.contains("with `thermal_expansion` or")), "{notices:?}");
}

/// Temperatures of cells of a mesh: of two layers, the warmer one bends the strip like Timoshenko's bimetal, κ = 3/2 αΔT/h for layers of equal
/// thickness and stiffness (total height h), so that its end rises by ½ κ L².
#[test]
fn temperatures_of_cells_bend_a_strip_as_timoshenko_says() {
    let mut text = statics(
        "shape = { kind = \"grid\", size = [10, 1], cells = [40, 4] }\n\
         models = [{ kind = \"fem\", material = \"linear\", youngs_modulus = 1e5, poissons_ratio = 0.0, plane = \"stress\", \
         thermal_expansion = 1e-4, temperature_of_cells = \"T\" }]\n\
         pin = [{ select = { side = \"left\" }, axes = \"x\" }, { select = { node = 0 }, axes = \"y\" }]\n",
    );
    // The reader makes no values of cells for grids, so they are added to the blueprint like those of a mesh file.
    text = text.replace("temperature_of_cells = \"T\"", "temperature = 293.15");
    let mut blueprint = plane(&text);
    let body = &mut blueprint.bodies[0];
    let mut mesh = (*body.mesh).clone();
    let middles = mesh.cells.iter().map(|(_, _, nodes)| {
        nodes.iter().map(|node| mesh.positions[*node as usize][1]).sum::<f64>() / nodes.len() as f64
    });
    let temperatures: Vec<f64> = middles.map(|y| if y < 0.5 { 303.15 } else { 293.15 }).collect();
    mesh.cell_values.insert("T".into(), temperatures);
    body.mesh = mesh.into();
    let registry = opruga::Registry::<2>::default();
    let spec = registry.models().into_iter().find(|spec| spec.kind == "fem").expect("a model");
    body.models[0].set(spec, "temperature_of_cells", Value::Text("T".into()), 2).expect("a field");
    let mut world = built(blueprint);
    frames(&mut world, 1);
    let tip = world.node_count(0) as u32 - 1;
    let rise = world.position(0, tip)[1] - world.blueprint().bodies[0].mesh.positions[tip as usize][1];
    let wanted = 0.5 * 1.5 * 1e-3 * 100.0;
    assert!((rise / wanted - 1.0).abs() < 0.01, "{rise} {wanted}");
}
