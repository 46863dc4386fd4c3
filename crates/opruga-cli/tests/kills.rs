//! Two hundred kills at random moments of recordings, and two hundred of checkpoints and sweeps: the remaining files can be read, and are right. The
//! cost of a kill for a recording is measured in `opruga/tests/killed_recordings.rs`. Rows 79 and 80 of the torture list.
#![cfg(unix)]
#![allow(clippy::disallowed_methods)] // no physics here

#[path = "all/common/mod.rs"]
mod common;
use common::*;
use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::io::checkpoint::Checkpoint;
use opruga::io::recording::{Ending, Recording};
use opruga::io::scene;
use opruga::recordings::Playback;
use opruga::{Options, World, catalogue, scenes};
use std::io::Cursor;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

const RECORDINGS: u64 = 200;
const CHECKPOINTS: u64 = 120;
const SWEEPS: u64 = 80;

fn blueprint() -> Blueprint<2> {
    let text = scenes::find("pressures").expect("a scene");
    let read = scene::read(text.as_bytes(), "pressures", &catalogue(), &scene::Options::default());
    let Ok((AnyBlueprint::Plane(blueprint), _)) = read else { panic!("a scene of the plane") };
    blueprint
}

/// The hashes and states of a scene in an uninterrupted run, frame by frame, as far as they were needed.
struct Undisturbed(Mutex<(World<2>, Vec<Frame>)>);

/// The hash and the state of a frame.
type Frame = (u64, Vec<u8>);

impl Undisturbed {
    fn new() -> Undisturbed {
        let world = World::new(blueprint(), Options::default()).expect("a world");
        let first = (world.frame_hash(), world.snapshot());
        Undisturbed(Mutex::new((world, vec![first])))
    }

    /// Computes up to a frame; returns whether it has this hash and, if given, this state.
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

    /// The frame whose state is at the end of some bytes.
    fn at_the_end(&self, bytes: &[u8]) -> Option<usize> {
        let guard = self.0.lock().expect("nobody has failed");
        guard.1.iter().position(|(_, state)| bytes.ends_with(state))
    }
}

/// A number below `below` that depends only on the round (SplitMix64).
fn random(round: u64, below: u64) -> u64 {
    let mut z = (round + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    (z ^ (z >> 27)) % below.max(1)
}

/// Waits until a file exists (except every fourth time), then a random time up to `longest` [µs], and kills the process.
fn killed(folder: &Path, arguments: &[&str], file: &str, round: u64, longest: u64) {
    let mut child = program(folder, arguments).spawn().expect("the program runs");
    if !round.is_multiple_of(4) {
        until(file, || folder.join(file).exists() || child.try_wait().is_ok_and(|ended| ended.is_some()));
    }
    std::thread::sleep(Duration::from_micros(random(round, longest)));
    child.kill().expect("it is killed");
    child.wait().expect("it ends");
}

/// Calls a function for every round, on four threads: most of the time of a round is spent waiting, for the disk or for the run.
fn rounds(count: u64, each: impl Fn(u64) + Sync) {
    let next = AtomicU64::new(0);
    std::thread::scope(|scope| {
        for _ in 0..4 {
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

/// A run of a tenth of a second that records, from its first file to its last.
struct Recorded {
    every: &'static str,
    /// The recording of an uninterrupted run.
    whole: Vec<u8>,
    /// The duration of that run.
    takes: Duration,
}

impl Recorded {
    fn call<'a>(every: &'a str, out: &'a str, file: &'a str) -> [&'a str; 8] {
        ["run", "pressures", "--seconds=3", "--no-pictures", every, "--out", out, file]
    }

    /// Makes it with an uninterrupted run.
    fn new(folder: &Path, every: &'static str) -> Recorded {
        let name = format!("whole{every}");
        let begun = Instant::now();
        let output = opruga(folder, &Recorded::call(every, &format!("o{name}"), &format!("--record={name}")));
        let takes = begun.elapsed();
        assert_eq!(code(&output), 0, "{}", said(&output));
        Recorded { every, whole: std::fs::read(folder.join(name)).expect("a recording"), takes }
    }

    /// The size of the chunk that begins at an offset: 48 bytes of its head, which gives the number of bytes that follow. The last chunk includes the
    /// end of the file, which is written with it.
    fn chunk_at(&self, place: u64) -> u64 {
        let head = &self.whole[place as usize..];
        let payload = head[24..32].iter().rev().fold(0, |all, byte| all << 8 | u64::from(*byte));
        let behind = 48 + payload;
        if head.starts_with(b"INDX") { head.len() as u64 } else { behind }
    }

    /// Kills the run: in half of the rounds at any moment, in a quarter of them when a number of bytes has been written, and in a quarter of them
    /// while the end is written or shortly after. Returns whether it was still running.
    fn killed(&self, folder: &Path, round: u64) -> bool {
        let (out, file) = (format!("o{round}"), format!("r{round}"));
        let call = Recorded::call(self.every, &out, &format!("--record={file}")).map(String::from);
        let call: Vec<&str> = call.iter().map(String::as_str).collect();
        let mut child = program(folder, &call).spawn().expect("the program runs");
        let length = self.whole.len() as u64;
        let (bytes, pause) = match round % 4 {
            0 | 1 => (0, random(round, self.takes.as_micros() as u64)),
            2 => (random(round, length), 0),
            _ => (length - random(round, 400), random(!round, 10_000)),
        };
        let there = || std::fs::metadata(folder.join(&file)).map_or(0, |about| about.len());
        let begun = Instant::now();
        while there() < bytes && child.try_wait().is_ok_and(|ended| ended.is_none()) {
            assert!(begun.elapsed() < Duration::from_secs(60), "round {round}: {bytes} bytes are never there");
            // Without a pause, this loop would take the processor from the run.
            std::thread::sleep(Duration::from_micros(100));
        }
        std::thread::sleep(Duration::from_micros(pause));
        child.kill().expect("it is killed, or has ended");
        !child.wait().expect("it ends").success()
    }
}

/// A killed recording is a prefix of the complete one, byte by byte. All of its chunks except an incomplete one can be read, and are right; and its
/// last frame can be replayed.
#[test]
fn a_recording_that_is_killed_at_any_moment_has_right_frames() {
    recordings_survive(40);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn a_recording_that_is_killed_at_any_moment_has_right_frames_whole_sweep() {
    recordings_survive(RECORDINGS);
}

fn recordings_survive(kills: u64) {
    let folder = tempfile::tempdir().expect("a folder");
    let (folder, undisturbed) = (folder.path(), Undisturbed::new());
    let ways = ["--record-every=1", "--record-every=3", "--record-every=1000"];
    let ways = ways.map(|every| Recorded::new(folder, every));
    let counts: [AtomicU64; 4] = Default::default();
    rounds(kills, |round| {
        let way = &ways[round as usize % ways.len()];
        let at_work = way.killed(folder, round);
        let count = |which: usize| counts[which].fetch_add(1, Ordering::Relaxed);
        // It gets its name with its header: before that, no file of this name exists.
        let Ok(bytes) = std::fs::read(folder.join(format!("r{round}"))) else {
            assert!(at_work, "round {round}: a run that has ended has left no recording");
            count(0);
            return;
        };
        assert!(way.whole.starts_with(&bytes), "round {round}: {} bytes are not those of the whole run", bytes.len());
        let mut recording = Recording::open(Cursor::new(&bytes)).unwrap_or_else(|e| panic!("round {round}: {e}"));
        match recording.ending() {
            Ending::Closed => {
                assert_eq!(bytes.len(), way.whole.len(), "round {round}");
                count(if at_work { 3 } else { 2 });
            }
            Ending::Open { lost } => {
                assert!(at_work, "round {round}: a run that has ended has not closed its recording");
                let chunk = way.chunk_at(bytes.len() as u64 - lost);
                assert!(*lost < chunk, "round {round}: {lost} bytes are lost, of a chunk of {chunk}");
                count(1);
            }
            Ending::Damaged(error) => panic!("round {round}: {error}"),
        }
        for frame in recording.frames() {
            let hash = recording.hash(frame).expect("a whole frame");
            let kept = recording.kept(frame) == Ok(frame);
            let state = kept.then(|| recording.read(frame).expect("a whole state"));
            assert!(undisturbed.is(frame, hash, state), "round {round}, frame {frame}");
        }
        let Some(last) = recording.frames().next_back() else { return };
        let mut playback = Playback::<_>::of(recording, last).expect("what the program did");
        let mut world = World::new(blueprint(), Options::default()).expect("a world");
        playback.show(&mut world, last).unwrap_or_else(|error| panic!("round {round}: {error}"));
        assert!(undisturbed.is(last, world.frame_hash(), Some(&world.snapshot())), "round {round}, frame {last}");
    });
    let [before, within, after, closed] = counts.map(AtomicU64::into_inner);
    println!("{before} before the file had its name, {within} within it, {closed} behind its end, {after} had ended");
    assert_eq!(before + within + after + closed, kills);
    assert!(within > kills / 4, "{before} {within} {closed} {after}");
}

#[test]
fn a_run_that_is_killed_at_any_moment_leaves_a_checkpoint_to_go_on_from() {
    checkpoints_survive(24);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn a_run_that_is_killed_at_any_moment_leaves_a_checkpoint_to_go_on_from_whole_sweep() {
    checkpoints_survive(CHECKPOINTS);
}

fn checkpoints_survive(kills: u64) {
    let folder = tempfile::tempdir().expect("a folder");
    let (folder, undisturbed) = (folder.path(), Undisturbed::new());
    undisturbed.is(4_000, 0, None);
    let found = AtomicU64::new(0);
    rounds(kills, |round| {
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
    assert!(found > kills / 2, "{found} checkpoints were written");
    // The last one with a checkpoint is resumed.
    let last = (0..kills).rev().find(|round| folder.join(format!("o{round}/checkpoint")).exists()).expect("one");
    let checkpoint = format!("o{last}/checkpoint");
    let hour = ["run", "--resume", &checkpoint, "--seconds=200", "--no-pictures", "--out=on", "--json"];
    let output = opruga(folder, &hour);
    assert_eq!(code(&output), 0, "{}", said(&output));
}

#[test]
fn a_sweep_that_is_killed_again_and_again_comes_to_its_end() {
    sweeps_survive(16);
}

#[test]
#[ignore = "a sweep: cargo test -- --ignored whole_sweep"]
fn a_sweep_that_is_killed_again_and_again_comes_to_its_end_whole_sweep() {
    sweeps_survive(SWEEPS);
}

fn sweeps_survive(kills: u64) {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    let call = |out: &'static str| {
        ["sweep", "ball", "--set=body.ball.mass=0.5..2:60", "--metric=bounce_height", "--seconds=2", "--threads=2", out]
    };
    for round in 0..kills {
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
