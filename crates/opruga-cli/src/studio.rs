//! The window is a separate program, so that it need not be built if it is not used.

use crate::arguments::Run;
use crate::errors::CallFault;
use crate::failure::Failure;
use crate::interrupt;
use opruga::Registries;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How long a program on a busy machine may take to save its work after it was asked to end.
const PATIENCE: Duration = Duration::from_secs(60);

/// The exit code of a studio that found no screen.
const NO_WINDOW: i32 = 5;

/// `opruga` without a command: opens the window if there is a screen, and otherwise runs a scene without a window.
pub(crate) fn first(registries: &Registries) -> Result<u8, Failure> {
    let headless = |why: &str| {
        eprintln!("{why}: running the scene `ball` without a window (`opruga --help` lists the other commands)");
        let out = Some(crate::run::fresh_folder("ball"));
        crate::watch::run(&Run { out, ..Run::default_scene() }, registries)
    };
    if !has_screen(|name| std::env::var_os(name)) {
        return headless("there is no screen here");
    }
    match start(None) {
        Ok(code) if i32::from(code) == NO_WINDOW => headless("no window could be opened"),
        Ok(code) => Ok(code),
        Err(Failure::Call(fault)) => headless(&fault.to_string()),
        Err(other) => Err(other),
    }
}

/// `opruga studio [SCENE]`.
pub(crate) fn studio(scene: Option<&str>) -> Result<u8, Failure> {
    if !has_screen(|name| std::env::var_os(name)) {
        return Err(Failure::call(CallFault::NoScreen { scene: scene.unwrap_or("ball").into() }));
    }
    start(scene)
}

/// `opruga view FILE`. A file that is not a recording is reported before a window opens.
pub(crate) fn view(path: &Path, registries: &Registries) -> Result<u8, Failure> {
    let _ = crate::recordings::open(path, registries)?;
    let shown = path.display().to_string();
    if !has_screen(|name| std::env::var_os(name)) {
        return Err(Failure::call(CallFault::NoScreenForRecording { file: crate::source::argument(&shown) }));
    }
    start(Some(&shown))
}

/// Whether there is a screen to open a window on.
fn has_screen(variable: impl Fn(&str) -> Option<OsString>) -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    ["DISPLAY", "WAYLAND_DISPLAY"].into_iter().any(|name| variable(name).is_some_and(|value| !value.is_empty()))
}

/// Starts the studio and waits for its end.
fn start(scene: Option<&str>) -> Result<u8, Failure> {
    let mut command = match source_tree(|name| std::env::var_os(name)) {
        Some((cargo, root)) => {
            eprintln!("starting the studio; cargo builds it if it has changed, which takes minutes the first time");
            built(&cargo, &root)
        }
        None => {
            let beside = std::env::current_exe().ok().map(|own| beside(&own)).filter(|path| path.is_file());
            Command::new(beside.ok_or_else(|| Failure::call(CallFault::NoStudio {}))?)
        }
    };
    command.args(scene);
    let failed = |e: std::io::Error| Failure::call(CallFault::StudioNotStarted { reason: e.to_string() });
    // This is set before the program is started, so that an early signal is not lost.
    let stop = interrupt::asked_to_stop();
    interrupt::leave_the_word(true);
    let status = command.spawn().and_then(|child| wait(child, stop)).map_err(failed);
    interrupt::leave_the_word(false);
    let status = status?;
    match status.code() {
        Some(code) => Ok(u8::try_from(code).unwrap_or(1)),
        None => Err(Failure::Interrupted),
    }
}

/// The command that builds the studio and starts it. Cargo is not silenced and writes to the output of this program, because nothing else would be
/// seen for minutes.
fn built(cargo: &OsStr, root: &Path) -> Command {
    let mut command = Command::new(cargo);
    command.arg("run").arg("--manifest-path").arg(root.join("Cargo.toml"));
    command.args(["--package", "opruga-studio"]);
    if !cfg!(debug_assertions) {
        command.arg("--release");
    }
    command.arg("--").stderr(Stdio::inherit());
    command
}

/// Waits for the end of another program. As soon as this program is asked to end, it asks the other program to end too. The other program then saves
/// its work even if this program does not wait for it. Ctrl-C may already have reached both programs. If the other program does not end, it is
/// killed. The window of the studio ends by itself with the program that supervises it.
fn wait(mut child: Child, stop: &AtomicBool) -> std::io::Result<ExitStatus> {
    let mut asked: Option<Instant> = None;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status);
        }
        if stop.load(Ordering::SeqCst) {
            if asked.is_none() {
                ask_to_end(&mut child)?;
            }
            if asked.get_or_insert_with(Instant::now).elapsed() > PATIENCE {
                child.kill()?;
                return child.wait();
            }
        }
        std::thread::sleep(Duration::from_millis(30));
    }
}

/// Asks a program to end.
#[cfg(unix)]
fn ask_to_end(child: &mut Child) -> std::io::Result<()> {
    let number = rustix::process::Pid::from_child(child);
    Ok(rustix::process::kill_process(number, rustix::process::Signal::TERM)?)
}

/// Does nothing: on systems without a way to ask a program to end, Ctrl-C has already asked it.
#[cfg(not(unix))]
fn ask_to_end(_: &mut Child) -> std::io::Result<()> {
    Ok(())
}

/// The cargo that runs this program, and the root of the source tree if it contains the studio.
fn source_tree(variable: impl Fn(&str) -> Option<OsString>) -> Option<(OsString, PathBuf)> {
    let own = PathBuf::from(variable("CARGO_MANIFEST_DIR")?);
    let root = own.parent()?.parent()?.to_path_buf();
    root.join("crates/opruga-studio/Cargo.toml").is_file().then_some((variable("CARGO")?, root))
}

/// The path of the studio that was installed with this program.
fn beside(own: &Path) -> PathBuf {
    own.with_file_name(format!("opruga-studio{}", std::env::consts::EXE_SUFFIX))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_screen_is_one_that_the_environment_names() {
        let with =
            |name: &'static str, value: &'static str| move |asked: &str| (asked == name).then(|| OsString::from(value));
        if cfg!(target_os = "linux") {
            assert!(has_screen(with("DISPLAY", ":0")) && has_screen(with("WAYLAND_DISPLAY", "wayland-0")));
            assert!(!has_screen(with("DISPLAY", "")) && !has_screen(with("HOME", "/")));
        }
    }

    #[test]
    #[cfg(unix)]
    fn the_studio_ends_with_the_program_that_has_started_it() {
        let begun = |seconds: &str| Command::new("sleep").arg(seconds).spawn().expect("a program");
        let status = wait(begun("0"), &AtomicBool::new(false)).expect("its end");
        assert!(status.success());
        let (child, stop) = (begun("600"), AtomicBool::new(false));
        let asked = std::time::Instant::now();
        std::thread::scope(|scope| {
            let ended = scope.spawn(|| wait(child, &stop));
            std::thread::sleep(Duration::from_millis(100));
            stop.store(true, Ordering::SeqCst);
            let status = ended.join().expect("no panic").expect("its end");
            assert_eq!(status.code(), None, "a signal has ended it");
        });
        assert!(asked.elapsed() < Duration::from_secs(300));
        // The program is asked to end instead of being killed, because it has something to save. It prints a line when it is
        // ready.
        let words = ["-c", "trap 'exit 7' TERM; echo; while :; do sleep 0.1; done"];
        let mut child = Command::new("sh").args(words).stdout(std::process::Stdio::piped()).spawn().expect("a shell");
        let mut listens = [0];
        std::io::Read::read_exact(&mut child.stdout.take().expect("its words"), &mut listens).expect("a line");
        assert_eq!(wait(child, &AtomicBool::new(true)).expect("its end").code(), Some(7));
    }

    #[test]
    fn cargo_is_not_told_to_be_quiet_while_it_builds_the_studio() {
        let command = built(OsStr::new("cargo"), Path::new("/source"));
        let arguments: Vec<&str> = command.get_args().filter_map(OsStr::to_str).collect();
        assert_eq!(arguments[..2], ["run", "--manifest-path"]);
        assert_eq!(arguments[3..5], ["--package", "opruga-studio"]);
        assert!(!arguments.iter().any(|word| matches!(*word, "--quiet" | "-q")), "{arguments:?}");
        assert_eq!(arguments.last(), Some(&"--"));
    }

    #[test]
    fn the_studio_is_built_from_the_source_tree_that_cargo_runs_in() {
        let own = env!("CARGO_MANIFEST_DIR");
        let cargo = |asked: &str| match asked {
            "CARGO" => Some(OsString::from("cargo")),
            "CARGO_MANIFEST_DIR" => Some(OsString::from(own)),
            _ => None,
        };
        let (_, root) = source_tree(cargo).expect("this is the source tree");
        assert!(root.join("crates/opruga-studio").is_dir());
        assert!(source_tree(|_| None).is_none(), "an installed program");
        assert!(source_tree(|asked| (asked != "CARGO_MANIFEST_DIR").then(|| OsString::from("x"))).is_none());
        assert!(beside(Path::new("/usr/bin/opruga")).starts_with("/usr/bin"));
    }
}
