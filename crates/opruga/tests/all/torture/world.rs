//! Rows 73 and 78: bodies that are added and removed, changing numbers of threads.

use super::*;
use opruga::math::Lane;
use opruga::math::message::Message;

/// Row 78: numbers of threads.
#[test]
fn numbers_of_threads() {
    let scene = || plane(&ring(32, BALL, FLOOR));
    for threads in [0, 257, 10_000] {
        let error = World::new(scene(), Options { threads, ..Options::default() }).expect_err("no such number");
        assert_eq!(error.in_full(), format!("`threads`: is {threads}; allowed: a whole number from 1 to 256"));
    }
    let hash = |threads| {
        let mut world = World::new(scene(), Options { threads, ..Options::default() }).expect("a world");
        frames(&mut world, 30);
        world.state_hash()
    };
    assert_eq!(hash(1), hash(256));
}

/// Row 78: the number of threads changes between frames, by means of a snapshot, and the bits stay the same.
#[test]
fn threads_change_in_the_middle_of_a_run() {
    let scene = || plane(&ring(32, BALL, &format!("copies = {{ count = [5], spacing = [2, 0] }}\n{FLOOR}")));
    let mut one = built(scene());
    frames(&mut one, 60);
    let mut bytes = built(scene()).snapshot();
    for threads in [2, 7, 1, 5] {
        let mut world = World::new(scene(), Options { threads, ..Options::default() }).expect("a world");
        world.restore(&bytes).expect("its own snapshot");
        frames(&mut world, 15);
        bytes = world.snapshot();
    }
    let mut last = built(scene());
    last.restore(&bytes).expect("its own snapshot");
    assert_eq!((last.state_hash(), last.energy()), (one.state_hash(), one.energy()));
}

/// Row 73: while a frame runs, nobody can add or remove bodies: a law that tries to do so does not compile (`World::add_force` shows it). Between
/// frames, both work as in a scene.
#[test]
fn bodies_come_and_go_between_frames_without_a_trace_on_others() {
    let scene = || plane(&ring(32, BALL, FLOOR));
    let mut quiet = built(scene());
    frames(&mut quiet, 60);
    let mut busy = built(scene());
    let body = busy.blueprint().bodies[0].clone();
    for k in 0..60 {
        let mut guest = body.clone();
        guest.name = "guest".into();
        guest.translation[0] += 5.0;
        let number = busy.add_body(guest.clone()).expect("a body");
        let handle = busy.handle(number).expect("it is there");
        assert!(busy.add_body(guest).is_err(), "the name is taken");
        assert_eq!(busy.islands(), 2);
        busy.frame().expect("a frame");
        busy.remove_body("guest").expect("it is there");
        assert!(busy.resolve(handle).is_err() && busy.remove_body("guest").is_err(), "{k}");
    }
    for node in 0..24 {
        assert_eq!(busy.position(0, node), quiet.position(0, node));
        assert_eq!(busy.velocity(0, node), quiet.velocity(0, node));
    }
}

/// Bodies that a command adds are drawn from then on, also in a resumed world.
#[test]
fn bodies_that_come_later_are_drawn() {
    let late = "[[command]]\ndo = \"add\"\nat = 0.05\nbody = { name = \"late\", mass = 1, position = [3, 1], \
                shape = { kind = \"ring\", radius = 0.5, vertices = 7 } }\n";
    let scene = || plane(&ring(32, BALL, late));
    let mut world = built(scene());
    let scenery = opruga::pictures::Scenery::new(&world);
    let drawn = |scenery: &opruga::pictures::Scenery, world: &mut World<2>| {
        scenery.picture(&scenery.capture(world, false)).bodies.len()
    };
    assert_eq!(drawn(&scenery, &mut world), 1);
    frames(&mut world, 6);
    assert_eq!(drawn(&scenery, &mut world), 2);
    let bytes = world.snapshot();
    let mut other = built(scene());
    other.restore(&bytes).expect("its own snapshot");
    assert_eq!(drawn(&opruga::pictures::Scenery::new(&other), &mut other), 2);
}

/// A push moves the body unless the reader reports that it never acts: both convert times to frames in the same way.
#[test]
fn commands_act_unless_it_is_told_that_they_never_will() {
    let sixtieth = 1.0 / 60.0;
    let (mut moved, mut still) = (0, 0);
    for (at, until) in [
        (0.0, 0.01),
        (0.005, 0.012),
        (0.016, 0.017),
        (0.017, 0.03),
        (sixtieth, 1.5 * sixtieth),
        (7.0 * sixtieth, 7.1 * sixtieth),
        (7.1 * sixtieth, 8.0 * sixtieth),
        (59.0 * sixtieth, 5.0),
        (0.99, 5.0),
        (1.0, 5.0),
    ] {
        let push = format!(
            "[[command]]\ndo = \"push\"\nat = {at:?}\nuntil = {until:?}\nbody = \"b\"\nselect = {{ node = 0 }}\nforce = [1, 0]\n"
        );
        let text = ring(16, BALL, &push);
        let options = opruga::io::scene::Options::default();
        let (_, notices) = opruga::io::scene::read(text.as_bytes(), "test.toml", &opruga::catalogue(), &options)
            .unwrap_or_else(|errors| panic!("{errors:?}"));
        let mut world = built(plane(&text));
        frames(&mut world, 60);
        let acts = world.momentum().linear.0[0] > 1e-3;
        assert_eq!(acts, notices.is_empty(), "{at} to {until}: {notices:?}");
        if acts { moved += 1 } else { still += 1 }
    }
    assert_eq!((moved, still), (5, 5));
}

/// Row 57: the estimate of `units.sag` for boundary-element solids, compared with their sag in statics, on coarse and fine boundaries: the quantity
/// that warns of mixed units has the right order of magnitude and does not depend on the mesh.
#[test]
fn the_sag_of_a_boundary_is_estimated_by_its_statics() {
    let ball = |s: u32| format!("{{ kind = \"icosphere\", radius = 0.5, subdivisions = {s} }}");
    let block = |n: u32| {
        format!("{{ kind = \"box\", corner = [-0.5, -0.5, -0.5], size = [1, 1, 1], cells = [{n}, {n}, {n}] }}")
    };
    let outline = |n: u32| format!("{{ kind = \"ring\", radius = 0.5, vertices = {n} }}");
    let bodies = [(3, ball(1)), (3, ball(2)), (3, block(2)), (3, block(5)), (2, outline(16)), (2, outline(64))];
    let mut found = Vec::new();
    for (dimension, shape) in bodies {
        let down = |g: f64| if dimension == 3 { format!("[0, {g:?}, 0]") } else { format!("[0, {g:?}]") };
        let below = if dimension == 3 { "[0, -1, 0]" } else { "[0, -1]" };
        let point = if dimension == 3 { "[0, -0.35, 0]" } else { "[0, -0.35]" };
        let scene = |g: f64, young: f64, rule: &str, pin: &str| {
            format!(
                "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1\nframe = 0.1\nsubsteps = 1\n\
                 [integrator]\nkind = \"{rule}\"\n[world]\ngravity = {}\n\
                 [[body]]\nname = \"b\"\nmass = 500\nshape = {shape}\n\
                 models = [{{ kind = \"boundary_element\", youngs_modulus = {young:?} }}]\n{pin}\n",
                down(g)
            )
        };
        let build =
            |text: &str| read(text).unwrap_or_else(|e| panic!("{}", e[0])).build(Options::default()).expect("a world");
        // The sag is proportional to 1/E: one with a small sag, and one large enough for the warning.
        let pin = format!("pin = [{{ select = {{ half_space = {{ point = {point}, normal = {below} }} }} }}]");
        let mut world = build(&scene(-9.81, 1e8, "equilibrium", &pin));
        let top = |world: &dyn opruga::AnyWorld| {
            (0..world.positions(0).len()).map(|node| world.positions(0).at(node)[1]).fold(-1.0, Lane::larger)
        };
        let before = top(&*world);
        world.frame().expect("a frame");
        let sag = (before - top(&*world)) * 1e8;
        let soft = build(&scene(-9.81, 10.0, "backward_euler", ""));
        let warnings = soft.warnings();
        let warning = warnings.iter().find(|warning| warning.code == "units.sag").expect("a warning");
        let said = warning.message.split("by about ").nth(1).and_then(|rest| rest.split(' ').next()).expect("a number");
        found.push((shape, said.parse::<f64>().expect("a number") * 10.0 / sag));
    }
    assert!(found.iter().all(|(_, ratio)| (0.3..3.0).contains(ratio)), "{found:#?}");
}
