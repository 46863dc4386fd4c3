//! Measures what a recording loses if its process is killed. The process reports every finished frame through a pipe, and it is killed at an
//! arbitrary moment.
#![cfg(unix)]
#![allow(clippy::disallowed_methods)] // no physics here

use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::io::recording::{Ending, Header, Recording};
use opruga::io::scene;
use opruga::recordings::{Playback, Tape, frames_together};
use opruga::{Options, World, catalogue, scenes};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// The environment variable that makes this test record instead, with its arguments.
const CHILD: &str = "OPRUGA_TEST_RECORDS";

fn blueprint() -> Blueprint<2> {
    let text = scenes::find("pressures").expect("a scene");
    match scene::read(text.as_bytes(), "pressures", &catalogue(), &scene::Options::default()) {
        Ok((AnyBlueprint::Plane(blueprint), _)) => blueprint,
        _ => panic!("a scene of the plane"),
    }
}

/// Records until it is killed. The number of each added frame is written to the pipe. Every hundredth frame takes long.
fn record(path: &Path, every: u64, pause: Duration) -> ! {
    let mut world = World::new(blueprint(), Options::default()).expect("a world");
    let header = Header { name: "pressures".into(), frame: world.blueprint().time.frame, every, ..Header::default() };
    let mut tape = Tape::begin(path, false, &header, &mut world).expect("a file");
    let mut pipe = std::io::stderr();
    loop {
        world.frame().expect("a frame");
        std::thread::sleep(if world.frames() % 100 == 0 { Duration::from_millis(300) } else { pause });
        tape.push(&mut world).expect("written");
        pipe.write_all(&world.frames().to_le_bytes()).expect("told");
    }
}

/// The last frame that was reported as finished.
fn last_told(bytes: &[u8]) -> Option<u64> {
    bytes.as_chunks::<8>().0.last().map(|number| u64::from_le_bytes(*number))
}

#[test]
fn a_kill_costs_no_more_frames_than_go_to_the_system_together() {
    if let Ok(call) = std::env::var(CHILD) {
        let mut words = call.split(' ');
        let mut word = || words.next().expect("a word");
        let (every, pause) = (word().parse().expect("a number"), word().parse().expect("a number"));
        record(&PathBuf::from(word()), every, Duration::from_micros(pause));
    }
    let folder = std::env::temp_dir().join(format!("opruga-killed-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("a folder");
    let together = frames_together(&World::new(blueprint(), Options::default()).expect("a world"));
    let mut most = 0;
    // States of every frame, far apart, and only the first; fast frames and slow ones.
    let ways = [(1, 0), (32, 0), (1_000_000, 0), (1_000_000, 7_000), (4, 20_000)];
    for round in 0..20u64 {
        let (every, pause) = ways[round as usize % ways.len()];
        let path = folder.join(format!("{round}"));
        let mut child = Command::new(std::env::current_exe().expect("this test"))
            .args(["--exact", "a_kill_costs_no_more_frames_than_go_to_the_system_together", "--nocapture", "--quiet"])
            .env(CHILD, format!("{every} {pause} {}", path.display()))
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .expect("this test runs again");
        let mut pipe = child.stderr.take().expect("a pipe");
        // A full pipe would block the run.
        let reader = std::thread::spawn(move || {
            let mut bytes = Vec::new();
            pipe.read_to_end(&mut bytes).map(|_| bytes)
        });
        let begun = Instant::now();
        while !path.exists() && begun.elapsed() < Duration::from_secs(30) {
            std::thread::sleep(Duration::from_millis(2));
        }
        std::thread::sleep(Duration::from_micros(60_000 + round * 7_919_777 % 90_000));
        child.kill().expect("it is killed");
        child.wait().expect("it ends");
        let told = last_told(&reader.join().expect("read").expect("read"));
        let recording = Recording::open(std::fs::File::open(&path).expect("a file")).expect("a recording");
        assert!(matches!(recording.ending(), Ending::Open { .. }), "{:?}", recording.ending());
        let last = recording.frames().end - 1;
        let finished = told.unwrap_or(0);
        assert!(
            last < finished + 2 && finished < last + together,
            "round {round}: {finished} frames were finished, {last} are there; {together} go to the system together"
        );
        most = most.max(last);
        // Everything that is there is right.
        let mut world = World::new(blueprint(), Options::default()).expect("a world");
        let mut playback = Playback::of(recording, last).expect("whole");
        for frame in 1..=last.min(60) {
            playback.step(&mut world, frame).expect("a frame");
            assert_eq!(playback.hash(frame), Ok(world.frame_hash()), "round {round}, frame {frame}");
        }
    }
    assert!(most > 30, "kills found runs at work: {most}");
    std::fs::remove_dir_all(folder).expect("the folder is there");
}
