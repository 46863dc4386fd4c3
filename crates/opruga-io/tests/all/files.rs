//! Files that are never left half written, checkpoints that are never half read, and tables.

use opruga_io::checkpoint::{Checkpoint, CheckpointError};
use opruga_io::output_folder::{Existing, OutputFolder};
use opruga_io::safe_write::{Failing, Target, safe_write, safe_write_through};
use opruga_io::series::{Format, Shape, write_vtk_series};
use opruga_io::tables::{FinalBody, NumberTable, Summary, write_final};
use opruga_io::tracks::{Track, write_glb};
use opruga_mesh::Mesh;
use opruga_world::blueprint::{BodyBlueprint, Mass};
use std::io::Write;
use std::path::PathBuf;

fn folder(name: &str) -> PathBuf {
    let path = std::env::temp_dir().join(format!("opruga-io-{name}-{}", std::process::id()));
    let _ = std::fs::remove_dir_all(&path);
    std::fs::create_dir(&path).expect("a folder for the test");
    path
}

/// Row 83: wherever the disk fails, the old file stays intact and nothing else is left behind.
#[test]
fn a_failing_disk_leaves_the_old_file_whole() {
    let folder = folder("failing");
    let path = folder.join("summary.json");
    safe_write(&path, false, |w| w.write_all(b"old")).expect("the first");
    let new: Vec<u8> = (0..=255).collect();
    for k in 0..new.len() as u64 {
        let error = safe_write_through(&path, true, |file| Failing::after(k, file), |w| w.write_all(&new))
            .expect_err("the disk is full");
        assert_eq!((error.code(), error.bytes, error.exit_code(), &error.path), ("write.failed", k, 4, &path));
        assert_eq!(std::fs::read(&path).expect("still there"), b"old");
        assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 1, "nothing is left aside");
    }
    assert_eq!(
        safe_write_through(&path, true, |file| Failing::after(256, file), |w| w.write_all(&new)).expect("just enough"),
        256
    );
    assert_eq!(std::fs::read(&path).expect("there"), new);
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// Writes one of the outputs of a run.
type Writer = Box<dyn Fn(&mut dyn Write) -> std::io::Result<()>>;

/// All writers of outputs, with enough contents to be interrupted anywhere.
fn writers() -> Vec<(&'static str, Writer)> {
    let mut table = NumberTable::new(vec!["time".into(), "kinetic".into()]);
    (0..8).for_each(|k| table.push(&[f64::from(k), 1.0 / f64::from(k + 1)]));
    let checkpoint = Checkpoint { scene: "format = \"opruga-1\"\n".into(), payload: (0..200u8).collect() };
    let positions: Vec<[f64; 3]> = (0..6).map(|k| [f64::from(k), 0.1, 0.0]).collect();
    vec![
        ("diagnostics.csv", Box::new(move |out| table.write(out))),
        (
            "final.csv",
            Box::new(move |out| {
                let body = FinalBody { name: "a", positions: &positions, velocities: &positions };
                write_final(out, 2, [body].into_iter())
            }),
        ),
        ("summary.json", Box::new(|out| Summary { scene: "ball".into(), ..Summary::default() }.write(out))),
        ("checkpoint", Box::new(move |out| checkpoint.write(out))),
        ("mine.toml", Box::new(|out| out.write_all(opruga_io::template::commented("mine").as_bytes()))),
    ]
}

/// All writers of meshes, of frames for other programs, and of motions.
fn exports() -> Vec<(String, Writer)> {
    let mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [1; 3]).and_then(Mesh::into_simplices).expect("a cube");
    let mut all: Vec<(String, Writer)> = Vec::new();
    for ending in ["msh", "vtk", "vtu", "mesh", "mfem", "ele"] {
        for (ending, bytes) in opruga_io::meshes::write(&mesh, ending).expect("it is written").files {
            all.push((format!("cube.{ending}"), Box::new(move |out| out.write_all(&bytes))));
        }
    }
    let cube = BodyBlueprint::new("cube", mesh, Mass::Total(1.0), Vec::new());
    for format in [Format::Vtk, Format::Vtu, Format::Obj, Format::Ply] {
        let cube = cube.clone();
        let write = move |out: &mut dyn Write| {
            let velocities = vec![[0.1; 3]; cube.mesh.nodes()];
            let positions = &cube.mesh.positions;
            let shape = Shape { body: &cube, positions, velocities: &velocities, cell_fields: &[] };
            format.write(out, "a cube", 0.5, &[shape])
        };
        all.push((format!("frame.{}", format.ending()), Box::new(write)));
    }
    let mut track = Track::new(&cube);
    (0..2).for_each(|k| track.add(f64::from(k), &cube.mesh.positions));
    let other = track.clone();
    all.push(("motion.pc2".into(), Box::new(move |out| other.write_pc2(out))));
    let other = track.clone();
    all.push(("motion.mdd".into(), Box::new(move |out| other.write_mdd(out))));
    all.push(("motion.glb".into(), Box::new(move |out| write_glb(out, "a cube", std::slice::from_ref(&track)))));
    all.push(("frames.vtk.series".into(), Box::new(|out| write_vtk_series(out, &[("frame.vtk".into(), 0.5)]))));
    all
}

/// Row 83 for exports: a full disk leaves the old file intact, at whatever byte it fails.
#[test]
fn a_full_disk_leaves_no_half_export() {
    let folder = folder("exports");
    for (name, writer) in exports() {
        let path = folder.join(&name);
        let mut whole = Vec::new();
        writer(&mut whole).expect("memory does not fail");
        assert!(!whole.is_empty(), "{name}");
        safe_write(&path, false, |w| w.write_all(b"old")).expect("the first");
        for k in 0..whole.len() as u64 {
            let error = safe_write_through(&path, true, |file| Failing::after(k, file), &writer).expect_err("full");
            assert_eq!((error.code(), error.bytes, error.exit_code()), ("write.failed", k, 4), "{name}");
        }
        assert_eq!(std::fs::read(&path).expect("still there"), b"old", "{name}");
        assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 1, "nothing is left aside");
        #[cfg(target_os = "linux")]
        {
            let mut full = std::fs::OpenOptions::new().write(true).open("/dev/full").expect("a device");
            assert!(writer(&mut full).is_err(), "{name}: the error of the device is passed on");
        }
        std::fs::remove_file(&path).expect("the file is there");
    }
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// Rows 83 and 91: a drive that is full, broken, disconnected or over its quota, at any byte of any output.
#[cfg(target_os = "linux")]
#[test]
fn a_drive_that_goes_away_at_any_byte_leaves_the_old_file_whole() {
    const FAULTS: [(i32, &str); 4] =
        [(28, "no space left"), (5, "input/output error"), (116, "stale file handle"), (122, "disk quota exceeded")];
    let folder = folder("gone");
    for (name, writer) in writers() {
        let path = folder.join(name);
        let mut whole = Vec::new();
        writer(&mut whole).expect("memory does not fail");
        safe_write(&path, false, |w| w.write_all(b"old")).expect("the first");
        let refused = |error: opruga_io::safe_write::WriteError, bytes: u64, text: &str| {
            assert_eq!((error.code(), error.bytes, error.exit_code(), &error.path), ("write.failed", bytes, 4, &path));
            assert!(error.about.to_string().contains(text), "{error}");
            assert_eq!(std::fs::read(&path).expect("still there"), b"old", "{name} after {bytes} bytes");
        };
        for (number, text) in FAULTS {
            for k in 0..whole.len() as u64 {
                let error = safe_write_through(&path, true, |file| Failing::with(k, number, file), &writer);
                refused(error.expect_err("the drive is gone"), k, text);
            }
            // Network drives often report errors only when they are synced.
            let error = safe_write_through(&path, true, |file| Failing::at_sync(number, file), &writer);
            refused(error.expect_err("the drive is gone"), whole.len() as u64, text);
        }
        assert_eq!(std::fs::read_dir(&folder).expect("a folder").count(), 1, "nothing is left aside");
        // The data are still in memory, and can be saved once the drive is back.
        safe_write(&path, true, &writer).expect("the drive is back");
        assert_eq!(std::fs::read(&path).expect("there"), whole);
        std::fs::remove_file(&path).expect("the file is there");
    }
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// A writer whose calls are interrupted by signals, and which takes one byte at a time, loses nothing.
#[test]
fn interrupted_and_short_writes_lose_nothing() {
    struct Halting(std::fs::File, bool);
    impl Write for Halting {
        fn write(&mut self, buffer: &[u8]) -> std::io::Result<usize> {
            self.1 = !self.1;
            if self.1 {
                Err(std::io::ErrorKind::Interrupted.into())
            } else {
                self.0.write(&buffer[..buffer.len().min(1)])
            }
        }
        fn flush(&mut self) -> std::io::Result<()> {
            self.0.flush()
        }
    }
    impl Target for Halting {
        fn sync(&self) -> std::io::Result<()> {
            self.0.sync_all()
        }
    }
    let folder = folder("halting");
    for (name, writer) in writers() {
        let mut whole = Vec::new();
        writer(&mut whole).expect("memory does not fail");
        let bytes = safe_write_through(&folder.join(name), false, |file| Halting(file, false), &writer);
        assert_eq!(bytes, Ok(whole.len() as u64));
        assert_eq!(std::fs::read(folder.join(name)).expect("there"), whole, "{name}");
    }
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// Row 79: the next run removes what a killed run was writing, and nothing else.
#[test]
fn what_a_killed_run_was_writing_is_cleared_away() {
    let folder = folder("killed");
    for name in [
        ".checkpoint.4711.writing",
        ".summary.json.1.writing",
        ".mine.writing",
        "x.1.writing",
        ".a.b.writing",
        "trial.opruga-trial",
    ] {
        std::fs::write(folder.join(name), b"half").expect("a file");
    }
    let out = OutputFolder::open(&folder, Existing::Replace).expect("the folder is there");
    let mut left: Vec<String> = std::fs::read_dir(&folder)
        .expect("a folder")
        .map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    left.sort();
    assert_eq!(left, [".a.b.writing", ".mine.writing", ".opruga-lock", "x.1.writing"]);
    drop(out);
    assert!(!folder.join(".opruga-lock").exists(), "the lock goes with its owner");
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// Row 82: the older checkpoint keeps its bytes under its second name, whatever is written under the first.
#[test]
fn a_second_name_keeps_the_older_file() {
    let folder = folder("second");
    let out = OutputFolder::open(&folder.join("o"), Existing::Refuse).expect("new");
    let read = |name: &str| std::fs::read(out.path(name)).ok();
    for k in 0..4u8 {
        let mut together = out.together();
        together.write_keeping("checkpoint", "checkpoint.previous", |w| w.write_all(&[k])).expect("written");
        together.finish().expect("named");
        assert_eq!(read("checkpoint"), Some(vec![k]));
        assert_eq!(read("checkpoint.previous"), k.checked_sub(1).map(|k| vec![k]));
    }
    let full = |w: &mut dyn Write| {
        w.write_all(b"half")?;
        Err(std::io::ErrorKind::StorageFull.into())
    };
    let failed = out.together().write_keeping("checkpoint", "checkpoint.previous", full).expect_err("full");
    assert_eq!(failed.code(), "write.failed");
    assert_eq!(
        (read("checkpoint"), read("checkpoint.previous")),
        (Some(vec![3]), Some(vec![2])),
        "both are as they were"
    );
    out.remove("checkpoint.previous").expect("removed");
    out.remove("checkpoint.previous").expect("it is gone already");
    assert_eq!((read("checkpoint"), read("checkpoint.previous")), (Some(vec![3]), None));
    drop(out);
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// Row 83: files that belong together change all at once or not at all.
#[test]
fn files_that_belong_together_change_together() {
    let folder = folder("together");
    let out = OutputFolder::open(&folder.join("o"), Existing::Refuse).expect("new");
    let names = || {
        let entries = std::fs::read_dir(folder.join("o")).expect("a folder").map(|e| e.expect("an entry"));
        let mut all: Vec<(String, Vec<u8>)> = entries
            .map(|e| (e.file_name().to_string_lossy().into_owned(), std::fs::read(e.path()).expect("a file")))
            .filter(|(name, _)| name != ".opruga-lock")
            .collect();
        all.sort();
        all
    };
    let pair = |name: &str, bytes: &[u8]| (name.to_string(), bytes.to_vec());
    out.write("summary", false, |w| w.write_all(b"old")).expect("written");
    out.write("table", false, |w| w.write_all(b"old")).expect("written");
    let before = names();
    let mut together = out.together();
    together.write("table", |w| w.write_all(b"new")).expect("written");
    together.remove("summary");
    let full = |w: &mut dyn Write| {
        w.write_all(b"half")?;
        Err(std::io::ErrorKind::StorageFull.into())
    };
    assert_eq!(together.write("state", full).expect_err("full").code(), "write.failed");
    drop(together);
    assert_eq!(names(), before, "nothing has changed, and nothing is left aside");
    let mut together = out.together();
    together.write("table", |w| w.write_all(b"newer")).expect("written");
    together.write("table", |w| w.write_all(b"new")).expect("the last one counts");
    together.write("state", |w| w.write_all(b"new")).expect("written");
    together.remove("summary");
    together.finish().expect("named");
    assert_eq!(names(), [pair("state", b"new"), pair("table", b"new")]);
    // A name that cannot be given, because a folder now has it.
    let mut together = out.together();
    together.write("table", |w| w.write_all(b"newest")).expect("written");
    together.write("state", |w| w.write_all(b"newest")).expect("written");
    std::fs::remove_file(out.path("table")).expect("the file is there");
    std::fs::create_dir(out.path("table")).expect("a folder");
    assert_eq!(together.finish().expect_err("a folder").code(), "write.failed");
    assert_eq!(std::fs::read(out.path("state")).expect("a file"), b"new", "what comes behind it is as it was");
    drop(out);
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// Rows 84 to 86.
#[test]
fn output_folders() {
    let folder = folder("output");
    let out = folder.join("out");
    let code = |path: &PathBuf, existing| OutputFolder::open(path, existing).map(|_| ()).expect_err("refused").code();

    let first = OutputFolder::open(&out, Existing::Refuse).expect("new");
    assert_eq!(code(&out, Existing::Replace), "write.locked");
    first.write("final.csv", false, |w| w.write_all(b"x")).expect("written");
    assert_eq!(first.write("final.csv", false, |w| w.write_all(b"y")).expect_err("there").code(), "write.exists");
    drop(first);
    assert_eq!(code(&out, Existing::Refuse), "write.exists");
    let again = OutputFolder::open(&out, Existing::Replace).expect("replaced");
    again.write("final.csv", false, |w| w.write_all(b"y")).expect("replaced");
    drop(again);

    // Parent folders are made, but not within a file.
    drop(OutputFolder::open(&folder.join("around/out"), Existing::Refuse).expect("made"));
    assert_eq!(code(&out.join("final.csv/out"), Existing::Refuse), "write.folder");
    assert_eq!(code(&out.join("final.csv"), Existing::Refuse), "write.folder");
    assert_eq!(code(&folder.join("x".repeat(300)), Existing::Refuse), "write.folder");
    assert_eq!(safe_write(&folder, true, |_| Ok(())).expect_err("a folder").code(), "write.failed");
    std::fs::remove_dir_all(folder).expect("the folder is there");
}

/// Row 82: every flipped byte, every truncation and every addition is refused.
#[test]
fn damaged_checkpoints() {
    let checkpoint = Checkpoint { scene: "format = \"opruga-1\"\n".into(), payload: (0..100u8).collect() };
    let mut bytes = Vec::new();
    checkpoint.write(&mut bytes).expect("memory does not fail");
    assert_eq!(Checkpoint::read(&bytes).expect("whole"), checkpoint);
    for k in 0..bytes.len() {
        for bit in 0..8 {
            let mut flipped = bytes.clone();
            flipped[k] ^= 1 << bit;
            assert!(Checkpoint::read(&flipped).is_err(), "byte {k}, bit {bit}");
        }
        assert!(Checkpoint::read(&bytes[..k]).is_err(), "{k} bytes");
    }
    let mut longer = bytes.clone();
    longer.push(0);
    assert_eq!(Checkpoint::read(&longer), Err(CheckpointError::TooLong { extra: 1 }));
    let mut newer = bytes.clone();
    newer[8] = 9;
    assert_eq!(Checkpoint::read(&newer), Err(CheckpointError::Version { found: 9 }));
    assert_eq!(Checkpoint::read(b"PK\x03\x04"), Err(CheckpointError::NotOne {}));
    // A header that announces more than the memory can hold.
    let mut huge = bytes;
    huge[20..28].copy_from_slice(&u64::MAX.to_le_bytes());
    let sum = crc32fast::hash(&huge[..28]).to_le_bytes();
    huge[28..32].copy_from_slice(&sum);
    assert!(matches!(Checkpoint::read(&huge), Err(CheckpointError::CutOff { .. })));
    // More than one piece.
    let large = Checkpoint { scene: String::new(), payload: vec![7; (1 << 21) + 5] };
    let mut bytes = Vec::new();
    large.write(&mut bytes).expect("memory does not fail");
    assert_eq!(Checkpoint::read(&bytes).expect("whole"), large);
}

#[test]
fn tables_keep_every_bit() {
    let mut out = Vec::new();
    let body = FinalBody { name: "a", positions: &[[0.1, -2.0, 0.0]], velocities: &[[1.0 / 3.0, 0.0, 0.0]] };
    write_final(&mut out, 2, [body].into_iter()).expect("memory does not fail");
    let text = String::from_utf8(out).expect("text");
    assert_eq!(
        text,
        "body,node,x,y,vx,vy\na,0,1.0000000000000001e-1,-2.0000000000000000e0,3.3333333333333331e-1,0.0000000000000000e0\n"
    );

    let mut table = NumberTable::new(vec!["time".into(), "a,b".into()]);
    table.push(&[0.0, 1e300]);
    let mut out = Vec::new();
    table.write(&mut out).expect("memory does not fail");
    assert_eq!(String::from_utf8(out).expect("text"), "time,\"a,b\"\n0.0000000000000000e0,1.0000000000000001e300\n");

    let json = Summary { scene: "ball".into(), dimension: 2, h: f64::NAN, ..Summary::default() }.to_json();
    assert_eq!((&json["schema"], &json["scene"], &json["h"]), (&1.into(), &"ball".into(), &serde_json::Value::Null));
    for key in ["energy", "momentum", "state_hash", "warnings", "files", "nanoseconds_per_node_step", "reproducibility"]
    {
        assert!(json.get(key).is_some(), "{key}");
    }
    let mut out = Vec::new();
    Summary::default().write(&mut out as &mut dyn Write).expect("memory does not fail");
    assert!(out.starts_with(b"{"));
}
