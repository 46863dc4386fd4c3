//! The program `opruga-studio [SCENE]`: the window of Opruga.

use opruga::io::problem::visible;
use opruga::{Options, Registries};
use opruga_studio::app::{FIRST_SCENE, Studio};
use opruga_studio::measure::{self, Measured};
use opruga_studio::preferences::{Store, folders};
use opruga_studio::report::Report;
use opruga_studio::rescue::{self, Rescue};
use opruga_studio::session::Request;
use opruga_studio::setting::Setting;
use opruga_studio::shown::Severity;
use opruga_studio::start_errors::StartError;
use opruga_studio::{wanted, watch};
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// The usage text.
const USAGE: &str = "opruga-studio [SCENE]\n\nSCENE is a scene file, the name of a scene that comes with the program, a recorded run, \
                     or the file of a shape (.svg, .obj, .stl, .ply, .gltf, .glb).";

/// Reports an error in the call, and prints the usage.
fn refuse_call(error: StartError) {
    watch::print(error);
    eprintln!("\n{USAGE}");
}

/// The arguments as texts. An argument that is not text is reported.
fn texts(arguments: impl Iterator<Item = OsString>) -> Result<Vec<String>, ()> {
    let text = |argument: OsString| {
        argument.into_string().map_err(|argument| {
            let shown = argument.to_string_lossy();
            refuse_call(StartError::NotUtf8 { argument: visible(&shown) });
        })
    };
    arguments.map(text).collect()
}

fn main() -> ExitCode {
    let Ok(mut arguments) = texts(std::env::args_os().skip(1)) else { return ExitCode::from(2) };
    // For developers: measures the time of frames of the window.
    let measured = arguments.iter().position(|word| word == "--measure-frames").map(|index| {
        let count = arguments.get(index + 1).and_then(|word| word.parse::<usize>().ok());
        arguments.drain(index..(index + 2).min(arguments.len()));
        count.unwrap_or(600)
    });
    if arguments.iter().any(|word| matches!(word.as_str(), "-h" | "--help")) {
        println!("{USAGE}");
        return ExitCode::SUCCESS;
    }
    if let Some(option) = arguments.iter().find(|word| word.starts_with('-')) {
        refuse_call(StartError::NoOption { option: visible(option) });
        return ExitCode::from(2);
    }
    if arguments.len() > 1 {
        refuse_call(StartError::SeveralScenes { count: arguments.len() });
        return ExitCode::from(2);
    }
    let setting = Setting { options: options(), registries: Registries::default() };
    let kept = std::env::var_os(watch::KEPT);
    if kept.is_none() && measured.is_none() {
        return watch::run(&std::env::args_os().skip(1).collect::<Vec<_>>(), &setting.registries);
    }
    if kept.is_some() {
        watch::end_with_the_watch();
    }
    let kept = kept.filter(|path| !path.is_empty()).map(PathBuf::from);
    let wanted = arguments.pop().unwrap_or_else(|| FIRST_SCENE.into());
    let opened = match kept.as_ref().filter(|kept| kept.exists()).map(|kept| rescue::read(kept)) {
        Some(shared) => shared.and_then(|shared| rescue::resume(&shared, setting)),
        None => wanted::open(&wanted, setting),
    };
    let lost = std::env::var(watch::SAVED).ok();
    let session = match opened {
        Ok(session) => session,
        Err(errors) => {
            eprintln!("{errors}");
            return ExitCode::from(2);
        }
    };
    let viewport = eframe::egui::ViewportBuilder::default()
        .with_title("Opruga Studio")
        .with_app_id("opruga-studio")
        .with_inner_size([1280.0, 720.0])
        .with_min_inner_size([360.0, 320.0]);
    let options = eframe::NativeOptions { viewport, ..Default::default() };
    let report = Arc::new(Mutex::new(String::new()));
    let shared_report = Arc::clone(&report);
    if measured.is_some() {
        measure::listen();
    }
    let opened = Arc::new(AtomicBool::new(false));
    let is_open = Arc::clone(&opened);
    let outcome = eframe::run_native(
        "Opruga Studio",
        options,
        Box::new(move |creation| {
            let mut studio = Studio::new(session, &creation.egui_ctx)?;
            is_open.store(true, Ordering::Relaxed);
            studio.prefer(Store::of_the_person(), &creation.egui_ctx);
            if let Some(folder) = folders::cache(|name| std::env::var_os(name)) {
                studio.keep_pictures_in(folder.join("thumbnails"));
            }
            if let Some(count) = measured {
                return Ok(Box::new(Measured::new(studio, &creation.egui_ctx, count, &report)) as Box<dyn eframe::App>);
            }
            match lost {
                // The new window shows the moment at which the previous window was lost, with time stopped.
                Some(saved) => studio.report(Severity::Refused, Report::WindowLost(saved)),
                None => studio.ask(Request::Play(true)),
            }
            if let Some(kept) = kept {
                studio.keep_at(Rescue::at(kept));
            }
            Ok(Box::new(studio))
        }),
    );
    match outcome {
        Ok(()) => {
            let report = shared_report.lock().unwrap_or_else(PoisonError::into_inner);
            if !report.is_empty() {
                println!("{report}");
            }
            ExitCode::SUCCESS
        }
        // The supervising process saves the work.
        Err(error) if opened.load(Ordering::Relaxed) => {
            eprintln!("the window has failed: {error}");
            ExitCode::from(watch::LOST)
        }
        Err(error) => {
            watch::print(StartError::NoWindow { reason: error.to_string(), scene: wanted });
            ExitCode::from(watch::NO_WINDOW)
        }
    }
}

/// The options of the world. One processor is left for the interface.
fn options() -> Options {
    let threads = std::thread::available_parallelism().map_or(1, |n| n.get().saturating_sub(1).clamp(1, 8));
    let most_bytes = Some(opruga::io::scene::Limits::default().memory_bytes);
    Options { threads, most_bytes, ..Options::default() }
}
