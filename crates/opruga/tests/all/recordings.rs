//! Recordings of worlds that a program controls: its actions are included.

use opruga::blueprint::{Action, AnyBlueprint, Blueprint, CommandBlueprint, Selector};
use opruga::io::recording::{Header, Recording};
use opruga::io::scene;
use opruga::recordings::{Playback, Tape, TapeError};
use opruga::{Options, World, catalogue, scenes};
use std::path::PathBuf;

fn blueprint(name: &str) -> Blueprint<2> {
    let text = scenes::find(name).expect("a scene");
    let options = scene::Options { files: scenes::files(), ..scene::Options::default() };
    match scene::read(text.as_bytes(), name, &catalogue(), &options) {
        Ok((AnyBlueprint::Plane(blueprint), _)) => blueprint,
        _ => panic!("a scene of the plane"),
    }
}

fn world(name: &str) -> World<2> {
    World::new(blueprint(name), Options::default()).expect("a world")
}

fn header(name: &str) -> Header {
    Header { name: name.into(), frame: 1.0 / 60.0, ..Header::default() }
}

fn file(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("opruga-{}-{name}.rec", std::process::id()))
}

fn command(at: f64, until: f64, action: Action<2>) -> CommandBlueprint<2> {
    CommandBlueprint { at, until, action }
}

/// The actions of a program before some frames.
fn handle(world: &mut World<2>, frame: u64) {
    let drag = Action::Drag {
        body: 0,
        node: None,
        facet: false,
        stiffness: Some(200.0),
        path: vec![vec![0.1, 0.0, 2.0], vec![0.4, 1.0, 3.0]],
        largest_force: Some(80.0),
    };
    match frame {
        3 => world.command(command(0.1, 0.4, drag)).expect("a drag"),
        7 => world.set("world.gravity", opruga::core::spec::Value::Numbers(vec![1.0, -5.0])).expect("set"),
        9 => {
            let push = Action::Push { body: 1, select: Selector::Nodes(vec![0, 4]), force: [3.0, 0.0] };
            world.command(command(0.0, 0.3, push)).expect("a push");
            let pin = Action::Pin { body: 2, select: Selector::Side("bottom".into()), axes: [true, false] };
            world.command(command(0.2, 0.25, pin)).expect("a pin");
        }
        14 => {
            let (x, v) = (world.position(1, 3), world.velocity(1, 3));
            world.set_node(1, 3, [x[0] + 0.01, x[1]], v).expect("placed");
        }
        20 => world.remove_body(&world.blueprint().bodies[3].name.clone()).expect("removed"),
        _ => {}
    }
}

#[test]
fn what_a_program_does_is_in_the_recording_and_is_done_again() {
    for every in [1, 7, 64] {
        is_done_again(every);
    }
}

fn is_done_again(every: u64) {
    let path = file(&format!("handled-{every}"));
    let mut recorded = world("pressures");
    let header = Header { every, ..header("pressures") };
    let mut tape = Tape::begin(&path, true, &header, &mut recorded).expect("a file");
    let mut hashes = vec![recorded.state_hash()];
    let frames = 30;
    for frame in 1..=frames {
        handle(&mut recorded, frame);
        tape.step(&mut recorded).expect("a frame");
        hashes.push(recorded.state_hash());
    }
    tape.finish(&mut recorded).expect("an end");
    let open = || {
        let recording = Recording::open(std::fs::File::open(&path).expect("a file")).expect("a recording");
        Playback::of(recording, frames).expect("whole")
    };
    // Computed again, every frame has the same bits, but not without the actions of the program.
    let (mut playback, mut again) = (open(), world("pressures"));
    for frame in 1..=frames {
        playback.step(&mut again, frame).expect("a frame");
        assert_eq!(again.state_hash(), hashes[frame as usize], "frame {frame}");
        assert_eq!(playback.keeps(frame), frame.is_multiple_of(every) || frame == frames, "frame {frame}");
        assert_eq!(playback.hash(frame), Ok(again.frame_hash()), "frame {frame}");
        if playback.keeps(frame) {
            assert_eq!(playback.state(frame).expect("a state"), again.snapshot(), "frame {frame}");
        }
    }
    let mut alone = world("pressures");
    (0..frames).for_each(|_| alone.frame().expect("a frame"));
    assert_ne!(alone.state_hash(), hashes[frames as usize]);
    // Shown in any order, and continued from any frame.
    let mut shown = world("pressures");
    for frame in [12, 3, 4, 6, 29, 0, 21, 20, 8, 30] {
        playback.show(&mut shown, frame).expect("a frame");
        assert_eq!(shown.state_hash(), hashes[frame as usize], "frame {frame}");
        if frame < frames {
            playback.step(&mut shown, frame + 1).expect("a step");
            assert_eq!(shown.state_hash(), hashes[frame as usize + 1], "after frame {frame}");
        }
    }
    std::fs::remove_file(path).expect("the file is there");
}

/// Records up to `most` first frames of a world, and compares the frames that the recording shows, and those computed again in a new world, with the
/// bits of the run. Returns the number of frames.
pub(crate) fn first_frames_are_replayed<const D: usize>(
    name: &str,
    run: &mut World<D>,
    new: impl Fn() -> World<D>,
    most: usize,
) -> u64 {
    // One state in three, so that some frames are computed; for scenes with slow frames, every state.
    let nodes: usize = run.blueprint().bodies.iter().map(|body| body.mesh.nodes()).sum();
    let work = nodes * run.blueprint().time.substeps as usize;
    let much = if run.blueprint().contact.is_some() { 10_000 } else { 100_000 };
    let frames = if work > much { 1 } else { 4.min(most) };
    let path = file(&format!("scene-{name}"));
    let mut tape = Tape::begin(&path, true, &Header { every: 3, ..header(name) }, run).expect("a file");
    let mut hashes = vec![run.state_hash()];
    for _ in 0..frames {
        tape.step(run).unwrap_or_else(|error| panic!("{name}: {error}"));
        hashes.push(run.state_hash());
    }
    tape.finish(run).expect("an end");
    let recording = Recording::open(std::fs::File::open(&path).expect("a file")).expect("a recording");
    let mut playback = Playback::of(recording, frames as u64).expect("whole");
    let mut again = new();
    for frame in (0..=frames).rev() {
        playback.show(&mut again, frame as u64).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(again.state_hash(), hashes[frame], "{name}, frame {frame}");
    }
    for (frame, hash) in hashes.iter().enumerate().skip(1) {
        playback.step(&mut again, frame as u64).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(again.state_hash(), *hash, "{name}, frame {frame}");
    }
    assert_eq!(again.snapshot(), run.snapshot(), "{name}");
    std::fs::remove_file(path).expect("the file is there");
    frames as u64
}

/// The hash of a frame depends only on positions and velocities, on each of them, and not on their layout in memory.
#[test]
fn the_hash_of_a_frame_sees_every_number_and_no_layout() {
    for name in ["pressures", "integrators", "ball"] {
        let new = |batches| World::new(blueprint(name), Options { batches, ..Options::default() }).expect("a world");
        let (mut together, mut apart) = (new(true), new(false));
        for _ in 0..3 {
            together.frame().and_then(|()| apart.frame()).expect("a frame");
            assert_eq!(together.frame_hash(), apart.frame_hash(), "{name}");
        }
        let mut seen = std::collections::HashSet::from([together.frame_hash()]);
        let mut changes = 0;
        for body in 0..together.bodies().count() {
            for node in 0..together.node_count(body) as u32 {
                for number in 0..4 {
                    let (x, v) = (together.position(body, node), together.velocity(body, node));
                    let (mut near, mut like) = (x, v);
                    let changed = if number < 2 { &mut near[number] } else { &mut like[number - 2] };
                    // Only the last bit.
                    *changed = f64::from_bits(changed.to_bits() ^ 1);
                    together.set_node(body, node, near, like).expect("placed");
                    seen.insert(together.frame_hash());
                    changes += 1;
                    together.set_node(body, node, x, v).expect("back");
                }
            }
        }
        assert_eq!(together.frame_hash(), apart.frame_hash(), "{name}: all is as it was");
        assert_eq!(seen.len(), changes + 1, "{name}: every change has another hash");
    }
}

#[test]
fn what_cannot_be_recorded_is_an_error_and_the_frames_before_stay() {
    let path = file("law");
    let mut world = world("ball");
    let mut tape = Tape::begin(&path, true, &header("ball"), &mut world).expect("a file");
    tape.step(&mut world).expect("a frame");
    world.add_force(0, std::sync::Arc::new(|_, _, _, _| [0.0, 1.0])).expect("a law");
    let error = tape.step(&mut world).expect_err("only the program knows the law");
    assert!(matches!(&error, TapeError::Write(e) if e.code() == "recording.input"), "{error}");
    drop(tape);
    let recording = Recording::open(std::fs::File::open(&path).expect("a file")).expect("a recording");
    assert_eq!(recording.frames(), 0..2);
    std::fs::remove_file(path).expect("the file is there");
}

/// The distance of kept states depends on the speed of a run: it is large for the crowd, one for a slow scene, and four times as large with a quarter
/// of the steps. The work from one state to the next is the same, so that a frame between two is soon computed.
#[test]
fn states_of_fast_scenes_are_kept_farther_apart() {
    let apart = |name: &str, substeps: Option<u32>| {
        let mut blueprint = blueprint(name);
        blueprint.time.substeps = substeps.unwrap_or(blueprint.time.substeps);
        let options = Options { allow_unstable: true, ..Options::default() };
        let world = World::new(blueprint, options).expect("a world");
        (opruga::recordings::states_apart(&world), opruga::recordings::frames_together(&world))
    };
    let [(many, _), (few, _)] = [32, 8].map(|substeps| apart("thousand-balls", Some(substeps)));
    assert!(many > 8 && few.abs_diff(4 * many) <= 4, "{many} {few}");
    assert_eq!(apart("heart-solid", None), (1, 1));
    for name in ["ball", "heart", "giant-ring"] {
        let (apart, together) = apart(name, None);
        assert!((1..=64).contains(&apart) && (1..=20).contains(&together), "{name}: {apart} {together}");
    }
    // The cost of a kill is limited for the smallest frames as well.
    assert!((2..=25).contains(&apart("ball", Some(1)).1));
}

/// A state that differs only in motion is restored into the existing islands, with the same bits as in rebuilt islands.
#[test]
fn a_snapshot_goes_into_the_islands_that_are_there() {
    for (name, frames) in [("pressures", 40), ("leaking-tyre", 30), ("two-chambers", 20), ("ball", 60)] {
        let mut run = world(name);
        let mut states = vec![run.snapshot()];
        for _ in 0..frames {
            run.frame().expect("a frame");
            states.push(run.snapshot());
        }
        let mut reused = world(name);
        let built = reused.islands_built();
        for (number, state) in states.iter().enumerate().rev() {
            reused.restore(state).expect("a state");
            assert_eq!(&reused.snapshot(), state, "{name}, frame {number}");
            let mut fresh = world(name);
            fresh.restore(state).expect("a state");
            assert_eq!((fresh.energy(), fresh.momentum()), (reused.energy(), reused.momentum()), "{name}, {number}");
            if number + 1 < states.len() && number % 7 == 0 {
                reused.frame().expect("a frame");
                assert_eq!(reused.snapshot(), states[number + 1], "{name}, after frame {number}");
            }
        }
        if name != "ball" {
            assert_eq!(reused.islands_built(), built, "{name}: nothing was built anew");
        }
        // A state that does not fit changes nothing.
        let before = reused.snapshot();
        for bad in [&states[3][..states[3].len() - 1], &[&states[3][..], &[0; 8]].concat(), &before[8..]] {
            assert!(reused.restore(bad).is_err());
            assert_eq!(reused.snapshot(), before, "{name}");
        }
    }
}
