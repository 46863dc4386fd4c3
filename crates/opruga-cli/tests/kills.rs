//! Two hundred kills at random moments of recordings, and two hundred of checkpoints and sweeps: what is left can be read, and is
//! right. What a kill may cost a recording is measured in `opruga/tests/killed_recordings.rs`.
//! Rows 79 and 80 of a list of torments.
#![cfg(unix)]
#![allow(clippy::disallowed_methods)] // no physics here

mod common;
use common::*;
use opruga::blueprint::AnyBlueprint;
use opruga::io::checkpoint::Checkpoint;
use opruga::io::recording::{Ending, Recording};
use opruga::io::scene;
use opruga::{Options, World, catalogue, scenes};
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

const RECORDINGS: u64 = 200;
const CHECKPOINTS: u64 = 120;
const SWEEPS: u64 = 80;

/// The hashes and states of a scene as a run that nobody kills has them, frame by frame, as far as they were asked for.
struct Undisturbed(Mutex<(World<2>, Vec<Frame>)>);

/// The hash and the state of a frame.
type Frame = (u64, Vec<u8>);

impl Undisturbed {
    fn new() -> Undisturbed {
        let text = scenes::find("pressures").expect("a scene");
        let read = scene::read(text.as_bytes(), "pressures", &catalogue(), &scene::Options::default());
        let Ok((AnyBlueprint::Plane(blueprint), _)) = read else { panic!("a scene of the plane") };
        let world = World::new(blueprint, Options::default()).expect("a world");
        let first = (world.frame_hash(), world.snapshot());
        Undisturbed(Mutex::new((world, vec![first])))
    }

    /// Goes as far as a frame; says whether it has this hash and, where there is one, this state.
    fn is(&self, frame: u64, hash: u64, state: Option<&[u8]>) -> bool {
        let mut guard = self.0.lock().expect("nobody has failed");
        let (world, states) = &mut *guard;
        while states.len() as u64 <= frame {
            world.frame().expect("a frame");
            states.push((world.frame_hash(), world.snapshot()));
        }
        let (recorded, all) = &states[frame as usize];
        *recorded == hash && state.is_none_or(|state| state == all)
    }

    /// The frame whose state stands at the end of some bytes.
    fn at_the_end(&self, bytes: &[u8]) -> Option<usize> {
        let guard = self.0.lock().expect("nobody has failed");
        guard.1.iter().position(|(_, state)| bytes.ends_with(state))
    }
}

/// Waits until a file is there (every fourth time it does not), then a time that follows from a number alone, up to the
/// longest [µs], and kills.
fn killed(folder: &Path, arguments: &[&str], file: &str, round: u64, longest: u64) {
    let mut child = program(folder, arguments).spawn().expect("the program runs");
    if !round.is_multiple_of(4) {
        until(file, || folder.join(file).exists() || child.try_wait().is_ok_and(|ended| ended.is_some()));
    }
    // SplitMix64.
    let mut z = (round + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    std::thread::sleep(Duration::from_micros((z ^ (z >> 27)) % longest));
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
}

/// Does something for every round, on two threads.
fn rounds(count: u64, each: impl Fn(u64) + Sync) {
    let next = AtomicU64::new(0);
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                loop {
                    let round = next.fetch_add(1, Ordering::Relaxed);
                    if round >= count {
                        return;
                    }
                    each(round);
                }
            });
        }
    });
}

#[test]
fn a_recording_that_is_killed_at_any_moment_has_right_frames() {
    let folder = tempfile::tempdir().expect("a folder");
    let (folder, undisturbed) = (folder.path(), Undisturbed::new());
    let (begun, most) = (AtomicU64::new(0), AtomicU64::new(0));
    rounds(RECORDINGS, |round| {
        let (out, file) = (format!("o{round}"), format!("r{round}"));
        let every = ["--record-every=1", "--record-every=3", "--record-every=1000"][round as usize % 3];
        let call = ["run", "pressures", "--seconds=1e5", "--no-pictures", "--out", &out, "--record", &file, every];
        killed(folder, &call, &file, round, 60_000);
        // It gets its name with its head.
        let Ok(file) = std::fs::File::open(folder.join(&file)) else { return };
        let mut recording = Recording::open(file).unwrap_or_else(|error| panic!("round {round}: {error}"));
        assert!(matches!(recording.ending(), Ending::Open { .. }), "round {round}: {:?}", recording.ending());
        for frame in recording.frames() {
            let hash = recording.hash(frame).expect("a whole frame");
            let kept = recording.kept(frame) == Ok(frame);
            let state = kept.then(|| recording.read(frame).expect("a whole state"));
            assert!(undisturbed.is(frame, hash, state), "round {round}, frame {frame}");
        }
        begun.fetch_add(1, Ordering::Relaxed);
        most.fetch_max(recording.frames().end, Ordering::Relaxed);
    });
    let (begun, most) = (begun.into_inner(), most.into_inner());
    assert!(begun > RECORDINGS / 2 && most > 3, "{begun} recordings had begun, with up to {most} frames");
}

#[test]
fn a_run_that_is_killed_at_any_moment_leaves_a_checkpoint_to_go_on_from() {
    let folder = tempfile::tempdir().expect("a folder");
    let (folder, undisturbed) = (folder.path(), Undisturbed::new());
    undisturbed.is(4_000, 0, None);
    let found = AtomicU64::new(0);
    rounds(CHECKPOINTS, |round| {
        let out = format!("o{round}");
        let call = [
            "run",
            "pressures",
            "--seconds=1e5",
            "--no-pictures",
            "--checkpoint-every=0.002",
            "--threads=1",
            "--out",
            &out,
        ];
        killed(folder, &call, &format!("{out}/checkpoint"), round, 100_000);
        for name in ["checkpoint", "checkpoint.previous"] {
            let Ok(bytes) = std::fs::read(folder.join(&out).join(name)) else { continue };
            let checkpoint = Checkpoint::read(&bytes).unwrap_or_else(|error| panic!("round {round}, {name}: {error}"));
            let frame = undisturbed.at_the_end(&checkpoint.payload);
            assert!(frame.is_some(), "round {round}, {name}: its state is that of no frame");
            found.fetch_add(1, Ordering::Relaxed);
        }
    });
    let found = found.into_inner();
    assert!(found > CHECKPOINTS / 2, "{found} checkpoints were written");
    // The last that has one goes on.
    let last = (0..CHECKPOINTS).rev().find(|round| folder.join(format!("o{round}/checkpoint")).exists()).expect("one");
    let checkpoint = format!("o{last}/checkpoint");
    let hour = ["run", "--resume", &checkpoint, "--seconds=200", "--no-pictures", "--out=on", "--json"];
    let output = opruga(folder, &hour);
    assert_eq!(code(&output), 0, "{}", said(&output));
}

#[test]
fn a_sweep_that_is_killed_again_and_again_comes_to_its_end() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let call = |out: &'static str| {
        ["sweep", "ball", "--set=body.ball.mass=0.5..2:60", "--metric=bounce_height", "--seconds=2", "--threads=2", out]
    };
    for round in 0..SWEEPS {
        killed(folder, &call("--out=killed"), "killed/results.csv", round, 50_000);
    }
    for out in ["--out=killed", "--out=whole"] {
        let output = opruga(folder, &call(out));
        assert_eq!(code(&output), 0, "{}", said(&output));
    }
    let table = |out: &str| std::fs::read_to_string(folder.join(out).join("results.csv")).expect("a table");
    assert_eq!(table("killed").lines().count(), 61);
    assert_eq!(table("killed"), table("whole"));
}
