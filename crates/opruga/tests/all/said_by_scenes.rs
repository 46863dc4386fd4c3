//! Features of scenes for starts, loads and probes: velocity fields, forces per volume, stresses.
//!
//! Expected values are closed forms, given in the comments.

use crate::common;
use common::*;
use opruga::World;
use opruga::io::SceneError;

const SOLID: &str = "models = [{ kind = \"fem\", material = \"linear\", youngs_modulus = 1e5, poissons_ratio = 0.25, plane = \"stress\" }]\n";

fn refusals(text: &str) -> Vec<SceneError> {
    read(text).err().unwrap_or_default()
}

/// A scene in space.
fn head_3d(rule: &str) -> String {
    format!(
        "format = \"opruga-1\"\ndimension = 3\n[time]\nseconds = 1\nframe = 0.01\nsubsteps = 8\n[integrator]\nkind = \"{rule}\"\n"
    )
}

fn velocities<const D: usize>(world: &World<D>) -> Vec<([f64; D], [f64; D])> {
    let nodes = 0..world.node_count(0) as u32;
    nodes.map(|node| (world.position(0, node), world.velocity(0, node))).collect()
}

/// The centre of mass.
fn centre<const D: usize>(world: &World<D>) -> [f64; D] {
    let (mut sum, mut mass) = ([0.0; D], 0.0);
    for node in 0..world.node_count(0) as u32 {
        let (m, x) = (world.node_mass(0, node), world.position(0, node));
        mass += m;
        (0..D).for_each(|d| sum[d] += m * x[d]);
    }
    sum.map(|x| x / mass)
}

#[test]
fn a_velocity_field_is_linear_about_the_centre_of_mass() {
    let body = "[[body]]\nname = \"b\"\nshape = { kind = \"grid\", size = [1, 2], cells = [2, 3] }\nposition = [3, -1]\ndensity = 900\n";
    let field = "velocity = { linear = [0.5, -2], angular = 3, gradient = [[0.1, 0.2], [-0.3, 0.4]] }\n";
    let world = built(plane(&(head(0.01, 8, 0.0, "verlet") + body + field + SOLID)));
    let c = centre(&world);
    for (x, v) in velocities(&world) {
        let (r, s) = (x[0] - c[0], x[1] - c[1]);
        let wanted = [0.5 - 3.0 * s + 0.1 * r + 0.2 * s, -2.0 + 3.0 * r - 0.3 * r + 0.4 * s];
        assert!((0..2).all(|d| (v[d] - wanted[d]).abs() < 1e-12), "{v:?} {wanted:?}");
    }
    // The centre of mass moves with the velocity `linear`.
    let momentum = world.momentum().linear.0;
    assert!((momentum[0] - 900.0).abs() < 1e-9 && (momentum[1] + 3600.0).abs() < 1e-9, "{momentum:?}");

    // In space: a rotation is an antisymmetric gradient, to rounding.
    let body = "[[body]]\nname = \"b\"\nshape = { kind = \"grid\", size = [1, 2, 1], cells = [2, 3, 1] }\nrotation = [0.3, 0, 0.2]\ndensity = 900\n\
                models = [{ kind = \"fem\", youngs_modulus = 1e5 }]\n";
    let start = |said: &str| velocities(&built(space(&(head_3d("verlet") + body + said))));
    let spun = start("angular_velocity = [1, -2, 3]\n");
    for said in
        ["velocity = { angular = [1, -2, 3] }\n", "velocity = { gradient = [[0, -3, -2], [3, 0, -1], [2, 1, 0]] }\n"]
    {
        for ((_, v), (_, wanted)) in start(said).iter().zip(&spun) {
            assert!((0..3).all(|d| (v[d] - wanted[d]).abs() < 1e-12), "{said}: {v:?} {wanted:?}");
        }
    }
    // The plain form is still valid.
    assert!(start("velocity = [1, 2, 3]\n").iter().all(|(_, v)| *v == [1.0, 2.0, 3.0]));
}

#[test]
fn a_velocity_field_of_the_wrong_shape_is_refused_with_what_is_right() {
    let body = "[[body]]\nname = \"b\"\nshape = { kind = \"grid\", size = [1, 1], cells = [1, 1] }\nmass = 1\n";
    for (said, code, path, part) in [
        (
            "velocity = { gradient = [[1, 0]] }",
            "scene.length",
            "body.0.velocity.gradient",
            "2 rows of 2 finite numbers",
        ),
        ("velocity = { gradient = [[1, 0], [0, 1], [0, 0]] }", "scene.length", "body.0.velocity.gradient", "2 rows"),
        (
            "velocity = { gradient = [[1, 0, 0], [0, 1]] }",
            "scene.length",
            "body.0.velocity.gradient.0",
            "2 finite numbers",
        ),
        ("velocity = { lineal = [1, 0] }", "scene.unknown_field", "body.0.velocity.lineal", "did you mean `linear`?"),
        ("velocity = { angular = [1, 0] }", "scene.type", "body.0.velocity.angular", "rad/s"),
        (
            "angular_velocity = 1\nvelocity = { angular = 2 }",
            "scene.conflict",
            "body.0.velocity.angular",
            "one of them",
        ),
        ("velocity = [1, 2, 3]", "scene.length", "body.0.velocity", "2 finite numbers"),
        ("velocity = \"fast\"", "scene.type", "body.0.velocity", "2 finite numbers"),
    ] {
        let errors = refusals(&(head(0.01, 8, 0.0, "verlet") + body + said + "\n"));
        let [error] = &errors[..] else { panic!("{said}: {errors:?}") };
        assert_eq!((error.code, error.path.as_str()), (code, path), "{said}: {error}");
        assert!(error.to_string().contains(part) && error.line.is_some(), "{said}: {error}");
    }
}

/// Copies are next to one another in eight lanes; the start and the loads of each are those of a single body, to the bit.
#[test]
fn eight_bodies_side_by_side_move_as_one_alone_does() {
    let scene = |copies: &str| {
        head(0.01, 16, -9.81, "verlet")
            + "[[body]]\nname = \"b\"\nshape = { kind = \"grid\", size = [1, 1], cells = [2, 2] }\ndensity = 900\n\
               velocity = { linear = [1, 0], angular = 2, gradient = [[0.1, 0.2], [0.3, 0.4]] }\n"
            + copies
            + SOLID
            + "[[load]]\nkind = \"body_force\"\nbody = \"b\"\nvalue = [100, 2000]\n"
    };
    let mut alone = built(plane(&scene("")));
    let mut many = built(plane(&scene("copies = { count = [8], spacing = [0, 0] }\n")));
    frames(&mut alone, 5);
    frames(&mut many, 5);
    assert!(many.islands() == 1, "all are side by side");
    for body in 0..8 {
        for node in 0..9 {
            assert_eq!(alone.position(0, node), many.position(body, node));
            assert_eq!(alone.velocity(0, node), many.velocity(body, node));
        }
    }
}

/// A column under its own weight as a force per volume: u = b L²/2E at the free end, σ = b (L − y), exactly linear; the ends of a column of boxes are
/// exact (ν = 0). The reaction is b V, and in statics a curve scales all of it.
#[test]
fn a_force_per_volume_makes_the_closed_form_of_a_column() {
    let (force, modulus) = (-2000.0, 1e5);
    for cells in ["", "simplices = true\norder = 1\n", "simplices = true\n"] {
        let mut world = built(plane(&format!(
            "{}[[body]]\nname = \"b\"\nshape = {{ kind = \"grid\", size = [0.5, 2], cells = [2, 8] }}\n{cells}density = 900\nthickness = 0.1\n\
             models = [{{ kind = \"fem\", material = \"linear\", youngs_modulus = {modulus:?}, poissons_ratio = 0.0, plane = \"stress\" }}]\n\
             pin = [{{ select = {{ side = \"bottom\" }}, axes = \"xy\" }}]\n\
             [[load]]\nkind = \"body_force\"\nbody = \"b\"\nvalue = [0, {force:?}]\ncurve = [[0, 0.5], [1, 1]]\n\
             [[probe]]\nname = \"foot\"\nbody = \"b\"\nselect = {{ side = \"bottom\" }}\nrecord = [\"reaction\", \"stress\", \"volume_ratio\"]\n",
            head(1.0, 1, 0.0, "equilibrium")
        )));
        frames(&mut world, 1);
        let top = (0..world.node_count(0) as u32)
            .filter(|n| world.blueprint().bodies[0].mesh.positions[*n as usize][1] > 2.0 - 1e-9);
        let rest = &world.blueprint().bodies[0].mesh.positions;
        let sag: Vec<f64> = top.map(|n| world.position(0, n)[1] - rest[n as usize][1]).collect();
        let mean = sag.iter().sum::<f64>() / sag.len() as f64;
        let wanted = force * 4.0 / (2.0 * modulus);
        let tolerance = if cells.contains("order = 1") { 2e-2 } else { 1e-6 };
        assert!((mean / wanted - 1.0).abs() < tolerance, "{cells}: {mean} {wanted}");
        let probe = world.probe(0);
        let column = |name: &str| probe.iter().find(|(column, _)| column == name).expect("a column").1;
        assert!((column("foot.ry") + force * 0.1).abs() < 1e-6, "{probe:?}");
        // The lowest cells have the stress at their centres: b (L − h/2) if the cells are boxes.
        if cells.is_empty() {
            assert!((column("foot.syy") / (force * (2.0 - 0.125)) - 1.0).abs() < 1e-6, "{probe:?}");
            assert!((column("foot.von_mises") + column("foot.syy")).abs() < 1e-3, "{probe:?}");
            assert!((column("foot.volume_ratio") - 1.0 - column("foot.syy") / modulus).abs() < 1e-6, "{probe:?}");
        }
    }
}

/// In free fall under a force per volume of ρ g, the ledger enters the equivalent of gravity as work: ½ m v².
#[test]
fn the_work_of_a_force_per_volume_is_in_the_ledger() {
    let text = head_3d("verlet")
        + "[[body]]\nname = \"b\"\nshape = { kind = \"grid\", size = [1, 1, 1], cells = [2, 1, 1] }\nsimplices = true\ndensity = 800\n\
           models = [{ kind = \"fem\", youngs_modulus = 1e6 }]\n\
           [[load]]\nkind = \"body_force\"\nbody = \"b\"\nvalue = [0, -7848, 0]\n";
    let mut world = built(space(&text));
    frames(&mut world, 10);
    let (energy, speed) = (world.energy(), 9.81 * 0.1);
    // The consistent force of quadratic cells makes them oscillate slightly, because the masses of their nodes differ.
    assert!((world.momentum().linear.0[1] / (-800.0 * speed) - 1.0).abs() < 1e-9, "{:?}", world.momentum());
    assert!((energy.work_user - energy.kinetic - energy.elastic).abs() < 1e-3 * energy.work_user, "{energy:?}");
    assert!((energy.work_user / (0.5 * 800.0 * speed * speed) - 1.0).abs() < 0.02, "{energy:?}");
}

#[test]
fn a_force_per_volume_without_cells_is_refused_with_a_hint() {
    let load = "[[load]]\nkind = \"body_force\"\nbody = \"b\"\nvalue = [0, 1]\n";
    let ring = "[[body]]\nname = \"b\"\nshape = { kind = \"ring\", radius = 0.5, vertices = 12 }\nmass = 1\n";
    let grid = "[[body]]\nname = \"b\"\nshape = { kind = \"grid\", size = [1, 1], cells = [2, 2] }\nmass = 1\n";
    for (text, path, part) in [
        (ring.to_string() + load, "load.0.kind", "`kind = \"force\"` acts on nodes"),
        (grid.to_string() + load + "select = { side = \"left\" }\n", "load.0.select", "all nodes of at least one cell"),
    ] {
        let errors = refusals(&(head(0.01, 8, 0.0, "verlet") + &text));
        let [error] = &errors[..] else { panic!("{errors:?}") };
        assert_eq!((error.code, error.path.as_str()), ("scene.selects_nothing", path), "{error}");
        assert!(error.to_string().contains(part), "{error}");
    }
}

/// A block under a pressure p on all sides but the lowest, on a floor without friction: σ = −p along the load; the floor carries its weight and the
/// load.
#[test]
fn probes_tell_the_stress_and_the_force_of_the_floor() {
    let mut world = built(plane(&format!(
        "{}[[body]]\nname = \"b\"\nshape = {{ kind = \"grid\", size = [1, 1], cells = [4, 4] }}\ndensity = 1000\n{SOLID}\
         [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\n\
         [[load]]\nkind = \"traction\"\nbody = \"b\"\nselect = {{ side = \"top\" }}\nvalue = [0, -500]\n\
         [[probe]]\nname = \"all\"\nbody = \"b\"\nrecord = [\"contact\", \"stress\", \"volume_ratio\"]\n",
        head(0.1, 4, -10.0, "backward_euler")
    )));
    frames(&mut world, 60);
    let probe = world.probe(0);
    let names: Vec<&str> = probe.iter().map(|(name, _)| name.as_str()).collect();
    let wanted = ["all.cx", "all.cy", "all.sxx", "all.syy", "all.szz", "all.sxy", "all.von_mises", "all.volume_ratio"];
    assert_eq!(names, wanted);
    let number = |name: &str| probe.iter().find(|(column, _)| column == name).expect("a column").1;
    // ρ g V + p A = 1000·10·1 + 500.
    assert!((number("all.cy") / 10_500.0 - 1.0).abs() < 1e-6, "{probe:?}");
    assert!(number("all.szz").abs() < 1e-9 && number("all.sxy").abs() < 1.0, "{probe:?}");
    let middle = -(500.0 + 0.5 * 10_000.0);
    assert!((number("all.syy") / middle - 1.0).abs() < 0.01, "{probe:?}");
    assert!(number("all.volume_ratio") < 1.0 && number("all.von_mises") > 5000.0, "{probe:?}");
    // In space.
    let text = head_3d("verlet")
        + "[[body]]\nname = \"b\"\nshape = { kind = \"grid\", size = [1, 1, 1], cells = [1, 1, 1] }\nmass = 1\nmodels = [{ kind = \"fem\", youngs_modulus = 1e3 }]\n\
           [[probe]]\nname = \"p\"\nbody = \"b\"\nrecord = [\"stress\"]\n";
    let columns: Vec<String> = built(space(&text)).probe(0).into_iter().map(|(name, _)| name).collect();
    assert_eq!(columns, ["p.sxx", "p.syy", "p.szz", "p.sxy", "p.syz", "p.szx", "p.von_mises"]);
}

#[test]
fn stresses_of_a_body_that_knows_none_are_refused() {
    let body = "[[body]]\nname = \"b\"\nshape = { kind = \"ring\", radius = 0.5, vertices = 12 }\nmass = 1\n\
                models = [{ kind = \"mass_spring\", stiffness = 100.0 }]\n[[probe]]\nname = \"p\"\nbody = \"b\"\n";
    for word in ["stress", "volume_ratio"] {
        let text = format!("{}{body}record = [\"position\", \"{word}\"]\n", head(0.01, 8, 0.0, "verlet"));
        let errors = refusals(&text);
        let [error] = &errors[..] else { panic!("{errors:?}") };
        assert_eq!((error.code, error.path.as_str()), ("scene.no_stress", "probe.0.record"), "{error}");
        assert!(error.hint.is_some() && error.allowed.is_some(), "{error}");
    }
    // Obstacles act on every body.
    let text = format!("{}{body}record = [\"contact\"]\n", head(0.01, 8, 0.0, "verlet"));
    assert_eq!(built(plane(&text)).probe(0), [("p.cx".to_string(), 0.0), ("p.cy".to_string(), 0.0)]);
    // A command may give it finite elements; there are no numbers until then.
    let text = format!(
        "{}[[body]]\nname = \"b\"\nshape = {{ kind = \"grid\", size = [1, 1], cells = [1, 1] }}\nmass = 1\n\
         models = [{{ kind = \"mass_spring\", stiffness = 100.0 }}]\n[[probe]]\nname = \"p\"\nbody = \"b\"\nrecord = [\"volume_ratio\"]\n\
         [[command]]\ndo = \"change\"\nat = 0.01\nbody = \"b\"\nmodels = [{{ kind = \"fem\", youngs_modulus = 100.0 }}]\n",
        head(0.01, 8, 0.0, "verlet")
    );
    let mut world = built(plane(&text));
    assert!(world.probe(0)[0].1.is_nan());
    frames(&mut world, 2);
    assert!((world.probe(0)[0].1 - 1.0).abs() < 1e-12);
}

/// A run continued from a snapshot in the middle has the same bits.
#[test]
fn runs_with_fields_and_loads_go_on_with_the_same_bits() {
    let text = head(0.01, 8, -9.81, "verlet")
        + "[[body]]\nname = \"b\"\nshape = { kind = \"grid\", size = [1, 1], cells = [2, 2] }\ndensity = 900\n\
           velocity = { angular = 2, gradient = [[0.1, 0.2], [0.3, 0.4]] }\n"
        + SOLID
        + "[[load]]\nkind = \"body_force\"\nbody = \"b\"\nvalue = [100, 2000]\ncurve = [[0, 0], [0.1, 1]]\n";
    let mut whole = built(plane(&text));
    frames(&mut whole, 4);
    let kept = whole.snapshot();
    frames(&mut whole, 4);
    let mut resumed = built(plane(&text));
    resumed.restore(&kept).expect("a snapshot of this scene");
    frames(&mut resumed, 4);
    assert_eq!(whole.state_hash(), resumed.state_hash());
}
