//! Saves the scene, pictures, films and tables. Films and tables are computed again from the scene in the background, so they are the same as those
//! that the command line makes. A desktop window writes files, and a web page offers them as downloads.

use crate::differences::right_of;
use crate::document::Document;
use crate::engine;
use crate::handing;
use crate::pair;
use crate::report::Report;
use crate::runner::{Copied, Link};
use crate::session::Request;
use crate::setting::Setting;
use crate::shown::{Severity, Show};
use crate::work::{self, breathe};
use opruga::draw::{GifWriter, Image, Mp4Writer, Picture, Style, View, draw};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::mpsc::Receiver;

/// The number of pictures of a film per simulated second.
const RATE: f64 = 30.0;
/// The largest number of frames of a GIF animation. With more frames, the file would be too large.
const MOST_GIF_FRAMES: usize = 300;

/// A type of file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum What {
    /// The scene with everything that was done.
    Scene,
    /// A picture of the present moment.
    Picture,
    /// A film as MP4.
    Film,
    /// A film as GIF.
    Animation,
    /// A table with a row for every frame.
    Table,
}

/// The progress of a file.
#[derive(Clone, Debug, Default)]
pub struct Progress(Arc<AtomicU32>);

impl Progress {
    fn set(&self, done: u64, of: u64) {
        let hundredths = 100 * done.min(of) / of.max(1);
        self.0.store(hundredths as u32, Ordering::Relaxed);
    }

    /// The progress in per cent.
    pub fn hundredths(&self) -> u32 {
        self.0.load(Ordering::Relaxed)
    }
}

/// A file that is being made.
#[derive(Debug)]
struct Making {
    what: What,
    progress: Progress,
    stage: Stage,
}

/// The stage of a file.
#[derive(Debug)]
enum Stage {
    /// The scene was requested from the simulation.
    Asked(Show, Receiver<Copied>),
    /// The file is being made in the background, from the text with this fingerprint.
    Made(Receiver<Result<Report, Report>>, u64),
}

/// Files that are being made.
#[derive(Debug, Default)]
pub struct Keeping {
    making: Vec<Making>,
    message: Option<(Report, Severity)>,
    /// The number of messages so far.
    message_count: u64,
    /// The files of the scene that was saved last; none if that failed.
    saved: Option<Vec<String>>,
}

impl Keeping {
    /// Whether a file is being made.
    pub fn is_working(&self) -> bool {
        !self.making.is_empty()
    }

    /// The files that are being made, and their progress.
    pub fn working(&self) -> impl Iterator<Item = (What, u32)> {
        self.making.iter().map(|making| (making.what, making.progress.hundredths()))
    }

    /// Whether the scene is being saved.
    pub fn is_saving(&self) -> bool {
        self.making.iter().any(|making| making.what == What::Scene)
    }

    /// The files of the scene that was saved last; none if that failed.
    pub fn saved(&self) -> Option<&[String]> {
        self.saved.as_deref()
    }

    /// Begins to make a file, in addition to those that are being made.
    pub fn begin(&mut self, what: What, link: &Link, show: Show) {
        self.message = None;
        self.making.push(Making { what, progress: Progress::default(), stage: Stage::Asked(show, link.copy()) });
    }

    /// Checks whether a file is finished.
    pub fn poll(&mut self, link: &Link) {
        let (message, message_count, saved) = (&mut self.message, &mut self.message_count, &mut self.saved);
        self.making.retain_mut(|Making { what, progress, stage }| match stage {
            Stage::Asked(show, copied) => {
                if let Ok(copied) = copied.try_recv() {
                    let (what, show, progress, mark) = (*what, *show, progress.clone(), copied.mark);
                    let file = work::spawn(async move { write(what, &copied, show, &progress).await });
                    *stage = Stage::Made(file, mark);
                }
                true
            }
            Stage::Made(file, mark) => {
                let Ok(outcome) = file.try_recv() else { return true };
                if *what == What::Scene {
                    *saved = match &outcome {
                        Ok(Report::Written(files)) => Some(files.clone()),
                        _ => None,
                    };
                    if outcome.is_ok() {
                        link.ask(Request::Saved(*mark));
                    }
                }
                *message_count += 1;
                *message = Some(match outcome {
                    Ok(written) => (written, Severity::Done),
                    Err(refused) => (refused, Severity::Refused),
                });
                false
            }
        });
    }

    /// The present message.
    pub fn message(&self) -> Option<&(Report, Severity)> {
        self.message.as_ref()
    }

    /// The number of messages so far, which is also the number of the last one.
    pub fn message_count(&self) -> u64 {
        self.message_count
    }

    /// Replaces the present message.
    pub fn report(&mut self, severity: Severity, report: Report) {
        self.message_count += 1;
        self.message = Some((report, severity));
    }

    /// Removes the message after it was read.
    pub fn forget_message(&mut self) {
        self.message = None;
    }
}

/// Writes a file; returns a report with its path.
///
/// # Errors
/// The message for the user.
async fn write(what: What, copied: &Copied, show: Show, progress: &Progress) -> Result<Report, Report> {
    let ending = match what {
        What::Scene => "toml",
        What::Picture => "png",
        What::Film => "mp4",
        What::Animation => "gif",
        What::Table => "csv",
    };
    if what != What::Scene {
        let bytes = made(what, copied, show, progress).await?;
        return Ok(Report::Written(vec![handing::file(&copied.name, ending, &bytes)?]));
    }
    let mut written = handing::scene_with_files(&copied.name, &copied.text, &copied.files, &copied.registries)?;
    // If two scenes are side by side, both are saved.
    if let Some(differences) = &copied.differences {
        let right =
            right_of(&Document::new(&copied.name, &copied.text)?, differences, &copied.files, &copied.registries)?.0;
        let name = format!("{}-right", copied.name);
        written.extend(handing::scene_with_files(&name, &right.text(), &copied.files, &copied.registries)?);
    }
    Ok(Report::Written(written))
}

/// The bytes of a file.
///
/// # Errors
/// The message for the user.
#[cfg(not(target_arch = "wasm32"))]
pub fn content(what: What, copied: &Copied, show: Show) -> Result<Vec<u8>, Report> {
    work::finish(made(what, copied, show, &Progress::default()))
}

async fn made(what: What, copied: &Copied, show: Show, progress: &Progress) -> Result<Vec<u8>, Report> {
    match what {
        What::Scene => Ok(copied.text.clone().into_bytes()),
        What::Table => table(copied, progress).await,
        What::Picture | What::Film | What::Animation => film(what, copied, show, progress).await,
    }
}

/// The engine of the scene at its start.
fn again(copied: &Copied) -> Result<Box<dyn engine::Engine>, Report> {
    let document = Document::new(&copied.name, &copied.text)?;
    let setting = Setting { registries: copied.registries.clone(), ..Setting::default() };
    pair::build(&document, copied.differences.as_deref(), &copied.files, &setting)
}

async fn table(copied: &Copied, progress: &Progress) -> Result<Vec<u8>, Report> {
    let mut engine = again(copied)?;
    let mut rows = Vec::new();
    rows.push(engine.row());
    for frame in 0..copied.frames {
        breathe().await;
        progress.set(frame, copied.frames);
        engine.frame()?;
        rows.push(engine.row());
    }
    // Bodies may be added and removed during the run, so the table has columns for everything that existed at any time.
    let mut names: Vec<String> = Vec::new();
    for (name, _) in rows.iter().flatten() {
        if !names.contains(name) {
            names.push(name.clone());
        }
    }
    let mut text = names.join(",") + "\n";
    for row in rows {
        let cell = |name: &String| row.iter().find(|(n, _)| n == name).map_or(String::new(), |(_, x)| x.to_string());
        text += &(names.iter().map(cell).collect::<Vec<_>>().join(",") + "\n");
    }
    Ok(text.into_bytes())
}

async fn film(what: What, copied: &Copied, show: Show, progress: &Progress) -> Result<Vec<u8>, Report> {
    let mut engine = again(copied)?;
    let every = ((1.0 / RATE / engine.frame_seconds()).round() as u64).max(1);
    let mut pictures: Vec<Picture> = Vec::new();
    if what != What::Picture {
        pictures.push(engine.moment(&show));
    }
    // Computing the scene counts as one half of the work, drawing it as the other half.
    for frame in 0..copied.frames {
        breathe().await;
        progress.set(frame, 2 * copied.frames);
        engine.frame()?;
        if what != What::Picture && engine.frames().is_multiple_of(every) {
            pictures.push(engine.moment(&show));
        }
    }
    if what == What::Picture {
        pictures.push(engine.moment(&show));
    }
    let view = View::fit(pictures.iter())?;
    let dimension = pictures.first().map_or(2, |picture| picture.dimension);
    let style = Style::film(&view, dimension, if what == What::Picture { 1600 } else { 800 });
    let image = |picture: &Picture| draw(picture, &view, &style);
    let rate = 1.0 / (every as f64 * engine.frame_seconds());
    match what {
        What::Picture => pictures
            .last()
            .map_or_else(|| Err(Report::NothingToDraw), |picture| image(picture)?.to_png().map_err(Report::NotDrawn)),
        What::Film => {
            let mut writer = Mp4Writer::new(Vec::new(), [style.width, style.height], rate)?;
            let count = pictures.len();
            for (number, picture) in pictures.iter().enumerate() {
                breathe().await;
                progress.set((count + number) as u64, 2 * count as u64);
                writer.push(&image(picture)?)?;
            }
            writer.finish().map_err(Report::NotDrawn)
        }
        _ => {
            let step = pictures.len().div_ceil(MOST_GIF_FRAMES).max(1);
            let mut images: Vec<Image> = Vec::new();
            let count = pictures.len();
            for (number, picture) in pictures.iter().enumerate().step_by(step) {
                breathe().await;
                progress.set((count + number) as u64, 2 * count as u64);
                images.push(image(picture)?);
            }
            let samples: Vec<Image> = images.iter().step_by((images.len() / 8).max(1)).cloned().collect();
            let mut bytes = Vec::new();
            let mut writer = GifWriter::new(&mut bytes, rate / step as f64, &samples)?;
            for image in &images {
                breathe().await;
                writer.push(image)?;
            }
            drop(writer);
            Ok(bytes)
        }
    }
}
