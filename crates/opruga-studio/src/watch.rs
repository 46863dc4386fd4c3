//! Supervises the window. OpenGL cannot provide another device for the same window, and a driver that fails ends the process. The window is therefore
//! a separate process, which this program starts. If the window is lost, this program saves its work, reports the path, and opens another window,
//! which continues from there. If this program is asked to end, it also saves the work and reports the path.

use crate::handing::Folder;
use crate::preferences::Store;
use crate::rescue;
use crate::start_errors::StartError;
use opruga::Registries;
use opruga::io::problem::SceneError;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitCode, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// The environment variable with the file in which the window saves its work.
pub const KEPT: &str = "OPRUGA_STUDIO_KEPT";
/// The environment variable with the path to which the work of the previous, lost window was saved.
pub const SAVED: &str = "OPRUGA_STUDIO_SAVED";
/// The exit code of a window that could not be opened.
pub const NO_WINDOW: u8 = 5;
/// The exit code of a window that was lost.
pub const LOST: u8 = 70;
/// If this many windows are lost within the following time, no other window is opened.
const MOST_LOST: usize = 3;
const WITHIN: Duration = Duration::from_secs(60);

/// The exit code of this program if it was asked to end.
const ENDED: u8 = 130;
/// The interval at which the window is checked.
const EVERY: Duration = Duration::from_millis(30);
/// How long a window may take to end after a request to end.
const PATIENCE: Duration = Duration::from_secs(2);

/// Whether Ctrl-C or a signal has asked the program to end.
static END: AtomicBool = AtomicBool::new(false);
/// Whether the program was asked to end more than once. The window then gets no time to end by itself, but its work is saved anyway.
static AT_ONCE: AtomicBool = AtomicBool::new(false);

/// How a window has ended, which determines the next action.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Next {
    /// The window was closed, or has reported an error.
    End(u8),
    /// The window was asked to end.
    Ended,
    /// The window was lost.
    Lost,
}

/// Prints an error in the language that the user prefers.
pub fn print(error: StartError) {
    let language = Store::of_the_person().read().language;
    eprintln!("{}", SceneError::of(error).text(language.translation()));
}

/// Supervises windows that open what the arguments name.
pub fn run(arguments: &[OsString], registries: &Registries) -> ExitCode {
    let Ok(kept) = Kept::new() else {
        // If the work cannot be saved anywhere, a window without supervision is better than none.
        return window(arguments, None, None).map_or(ExitCode::from(NO_WINDOW), |status| code(status.code()));
    };
    // If the system provides no handler, a signal ends the program as usual.
    let _ = ctrlc::set_handler(|| {
        if END.swap(true, Ordering::SeqCst) {
            AT_ONCE.store(true, Ordering::SeqCst);
        }
    });
    let mut lost: Vec<Instant> = Vec::new();
    let mut saved: Option<String> = None;
    loop {
        let status = match window(arguments, Some(&kept.file()), saved.as_deref()) {
            Ok(status) => status,
            Err(error) => {
                print(StartError::NotStarted { reason: error.to_string() });
                return ExitCode::from(NO_WINDOW);
            }
        };
        if END.load(Ordering::SeqCst) {
            eprintln!("the studio was asked to end");
            if rescue::mark_of(&kept.file()).exists() {
                hint(save_and_report(&kept.file(), registries).as_deref());
            } else {
                eprintln!("  = all work was already saved");
            }
            return ExitCode::from(ENDED);
        }
        let next = next(status.code(), signal(&status));
        if let Next::End(code) = next {
            if code == NO_WINDOW && saved.is_some() {
                hint(saved.as_deref());
            }
            return ExitCode::from(code);
        }
        print(match signal(&status) {
            Some(number) => StartError::Signal { number },
            None => StartError::ExitCode { code: status.code().unwrap_or(-1) },
        });
        saved = save_and_report(&kept.file(), registries);
        lost.retain(|at| at.elapsed() < WITHIN);
        lost.push(Instant::now());
        if next == Next::Ended || lost.len() >= MOST_LOST {
            hint(saved.as_deref());
            return ExitCode::from(NO_WINDOW);
        }
        eprintln!("  = another window continues from there");
    }
}

/// Saves the work, and reports where.
fn save_and_report(kept: &Path, registries: &Registries) -> Option<String> {
    let saved = save(kept, registries);
    match &saved {
        Some(path) => eprintln!("  = your work is saved: {path}"),
        None => eprintln!("  = nothing of it was kept"),
    }
    saved
}

fn hint(saved: Option<&str>) {
    if let Some(path) = saved {
        eprintln!("  = hint: `opruga run {path}` runs it without a window, `opruga studio {path}` opens it again");
    }
}

/// The action after an exit code or a signal.
fn next(code: Option<i32>, signal: Option<i32>) -> Next {
    match (code, signal) {
        (Some(code @ (0 | 2)), _) => Next::End(code as u8),
        (Some(code), _) if code == i32::from(NO_WINDOW) => Next::End(NO_WINDOW),
        // These signals are hangup, interrupt and terminate, which request the end.
        (None, Some(1 | 2 | 15)) => Next::Ended,
        _ => Next::Lost,
    }
}

#[cfg(unix)]
fn signal(status: &ExitStatus) -> Option<i32> {
    std::os::unix::process::ExitStatusExt::signal(status)
}

#[cfg(not(unix))]
fn signal(_: &ExitStatus) -> Option<i32> {
    None
}

fn code(code: Option<i32>) -> ExitCode {
    code.and_then(|code| u8::try_from(code).ok()).map_or(ExitCode::from(LOST), ExitCode::from)
}

/// Runs a window until its end. When this program ends, the input of the window is closed, and the window ends, too.
fn window(arguments: &[OsString], kept: Option<&Path>, saved: Option<&str>) -> std::io::Result<ExitStatus> {
    let mut command = Command::new(std::env::current_exe()?);
    command.args(arguments).stdin(Stdio::piped()).env(KEPT, kept.map_or(OsString::new(), |path| path.into()));
    match saved {
        Some(path) => command.env(SAVED, path),
        None => command.env_remove(SAVED),
    };
    wait(command.spawn()?, &END)
}

/// Waits for the end of a window. A window that does not end on request is killed.
fn wait(mut child: Child, end: &AtomicBool) -> std::io::Result<ExitStatus> {
    // The input is taken out first, because waiting for the child would close its input and thus end it.
    let mut input = child.stdin.take();
    let mut asked: Option<Instant> = None;
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(status);
        }
        if end.load(Ordering::SeqCst) {
            drop(input.take());
            let waited = asked.get_or_insert_with(Instant::now).elapsed();
            if waited > PATIENCE || AT_ONCE.load(Ordering::SeqCst) {
                child.kill()?;
                return child.wait();
            }
        }
        std::thread::sleep(EVERY);
    }
}

/// Saves the work to the folder of the studio or, if that fails, leaves it where it is; returns the path.
fn save(kept: &Path, registries: &Registries) -> Option<String> {
    let shared = rescue::read(kept).ok()?;
    let beside = kept.parent().map(Folder::at);
    let written = Folder::default()
        .scene(&shared.name, &shared.text, &shared.files, registries)
        .or_else(|_| beside.unwrap_or_default().scene(&shared.name, &shared.text, &shared.files, registries));
    written.ok()?.first().map(|path| path.display().to_string())
}

/// A new folder that this process has made, for the saved work. When this value is dropped, the folder is removed if it contains nothing else.
struct Kept(PathBuf);

impl Kept {
    fn new() -> std::io::Result<Kept> {
        let name = |number: u32| format!("opruga-studio-{}-{number}", std::process::id());
        let folders = (0..100).map(|number| std::env::temp_dir().join(name(number)));
        let made = |folder: &PathBuf| std::fs::create_dir(folder).is_ok();
        folders.into_iter().find(made).map(Kept).ok_or_else(|| std::io::ErrorKind::AlreadyExists.into())
    }

    fn file(&self) -> PathBuf {
        self.0.join("kept.opruga-studio")
    }
}

impl Drop for Kept {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(self.file());
        let _ = std::fs::remove_file(rescue::mark_of(&self.file()));
        // Files whose writing the end of the window interrupted are removed.
        for left in std::fs::read_dir(&self.0).into_iter().flatten().flatten() {
            if left.file_name().to_string_lossy().starts_with(".kept.") {
                let _ = std::fs::remove_file(left.path());
            }
        }
        let _ = std::fs::remove_dir(&self.0);
    }
}

/// Ends this process when the supervising one has ended.
pub fn end_with_the_watch() {
    std::thread::spawn(|| {
        use std::io::Read as _;
        let mut rest = Vec::new();
        // Nothing is ever sent through this input. It ends when the supervising process no longer exists.
        let _ = std::io::stdin().lock().read_to_end(&mut rest);
        std::process::exit(0);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::share::Shared;

    #[test]
    fn a_window_that_was_closed_ends_the_watch_and_one_that_was_lost_does_not() {
        for (code, signal, wanted) in [
            (Some(0), None, Next::End(0)),
            (Some(2), None, Next::End(2)),
            (Some(5), None, Next::End(5)),
            // In these cases the screen is gone, the program panics, a driver aborts, or a driver reads an invalid address.
            (Some(1), None, Next::Lost),
            (Some(101), None, Next::Lost),
            (Some(i32::from(LOST)), None, Next::Lost),
            (None, Some(6), Next::Lost),
            (None, Some(11), Next::Lost),
            (None, Some(15), Next::Ended),
        ] {
            assert_eq!(next(code, signal), wanted, "{code:?} {signal:?}");
        }
    }

    #[test]
    #[cfg(unix)]
    fn a_window_ends_where_the_program_is_asked_to_end_by_itself_or_not() {
        let begun =
            |words: &[&str]| Command::new(words[0]).args(&words[1..]).stdin(Stdio::piped()).spawn().expect("a program");
        let end = AtomicBool::new(false);
        let status = wait(begun(&["true"]), &end).expect("its end");
        assert_eq!((status.code(), signal(&status)), (Some(0), None));
        end.store(true, Ordering::SeqCst);
        // The first process ends with its input, as windows do. The second one ignores its input.
        let status = wait(begun(&["cat"]), &end).expect("its end");
        assert_eq!((status.code(), signal(&status)), (Some(0), None));
        let status = wait(begun(&["sleep", "600"]), &end).expect("its end");
        assert_eq!(signal(&status), Some(9));
    }

    #[test]
    fn what_was_kept_is_read_as_it_was_and_the_folder_goes_with_the_watch() {
        let kept = Kept::new().expect("a folder");
        let shared = Shared { name: "ball".into(), text: "format = 1".into(), files: opruga::scenes::files() };
        rescue::write(&kept.file(), &shared).expect("written");
        rescue::write(&kept.file(), &Shared { text: "format = 2".into(), ..shared.clone() }).expect("written again");
        assert_eq!(rescue::read(&kept.file()).expect("read").text, "format = 2");
        std::fs::write(kept.file(), b"cut").expect("written");
        assert!(rescue::read(&kept.file()).is_err());
        let folder = kept.0.clone();
        std::fs::write(rescue::mark_of(&kept.file()), []).expect("written");
        std::fs::write(folder.join(".kept.opruga-studio.7.writing"), b"cut").expect("written");
        drop(kept);
        assert!(!folder.exists());
    }
}
