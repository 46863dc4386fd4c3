//! Finds scenes by name (a file, or one that comes with the program) and reports all of their errors at once.

use crate::errors::CallError;
use crate::failure::Failure;
use crate::preparation;
use opruga::blueprint::AnyBlueprint;
use opruga::io::problem::{Around, shown, visible};
use opruga::io::refusals::{in_scene, of_command};
use opruga::io::{Files, Notice, SceneError, scene};
use opruga::math::message::{Field, Message};
use opruga::math::words::number;
use opruga::{AnyWorld, Options, Registries, WorldError, catalogue_of};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// The text of a scene and its origin.
pub(crate) struct Source {
    /// The name of the scene: the name of its file without the ending.
    pub(crate) name: String,
    /// The file named in errors.
    pub(crate) file: String,
    /// The file of the scene, or `None` if the scene comes with the program or is stored in another file.
    pub(crate) path: Option<PathBuf>,
    /// The bytes as they were read. The reader refuses invalid UTF-8 and names its location.
    pub(crate) bytes: Vec<u8>,
    /// The location of the files that it names.
    pub(crate) files: Files,
    /// The models and integrators that the scene can name.
    pub(crate) registries: Registries,
}

/// A scene without errors.
pub(crate) struct Whole {
    pub(crate) blueprint: AnyBlueprint,
    pub(crate) notices: Vec<Notice>,
    /// The files that the scene names.
    pub(crate) files: BTreeMap<String, Arc<[u8]>>,
}

impl Source {
    /// The text of a scene that the reader has accepted.
    pub(crate) fn text(&self) -> &str {
        core::str::from_utf8(&self.bytes).unwrap_or_default()
    }

    /// Finds a scene: a file, or one that comes with the program.
    pub(crate) fn find(name: &str, registries: &Registries) -> Result<Source, Failure> {
        let registries = registries.clone();
        let path = Path::new(name);
        let built_in = opruga::scenes::find(name).filter(|_| !path.is_file());
        if let Some(text) = built_in {
            let (file, files) = (format!("scene {name} (built in)"), opruga::scenes::files());
            return Ok(Source { name: name.into(), file, path: None, bytes: text.into(), files, registries });
        }
        let file = path.display().to_string();
        let bytes = scene::bytes_of(path, &scene::Limits::default()).map_err(|error| {
            let absent = std::fs::metadata(path).is_err_and(|e| e.kind() == std::io::ErrorKind::NotFound);
            let error = if absent { opruga::scenes::missing(name) } else { error };
            let beside = format!("{}.toml", name.trim_end_matches(['/', '\\']));
            let error = match path.is_dir() && Path::new(&beside).is_file() {
                true => error.advice(Around::Nearest { word: visible(&beside) }),
                false => error,
            };
            Failure::Scene(vec![SceneError { file: file.clone(), ..error }])
        })?;
        if let Some(shape) = opruga::io::shapes::kind_of_file(name) {
            let named = visible(&path.file_name().map_or(String::new(), |n| n.to_string_lossy().into_owned()));
            let error = SceneError::of(CallError::ShapeFile { kind: shape, file: named });
            return Err(Failure::Scene(vec![SceneError { file, ..error }]));
        }
        let name = path.file_stem().map_or("scene".into(), |s| s.to_string_lossy().into_owned());
        Ok(Source { name, file, path: Some(path.to_path_buf()), bytes, files: Files::beside(path), registries })
    }

    /// Reads as much of the scene as possible.
    pub(crate) fn survey(&self, options: &scene::Options) -> scene::Reading {
        scene::survey(&self.bytes, &self.file, &catalogue_of(&self.registries), options)
    }

    /// Reads the scene. All errors are reported at once: the errors of the reader, and the errors of a world made from the rest.
    pub(crate) fn read(&self, options: &scene::Options, world: &Options) -> Result<Whole, Failure> {
        match self.survey(options) {
            scene::Reading { blueprint: Some(blueprint), errors, notices, files, .. } if errors.is_empty() => {
                Ok(Whole { blueprint, notices, files })
            }
            reading => Err(self.refused(reading, options, world)),
        }
    }

    fn refused(&self, reading: scene::Reading, options: &scene::Options, world: &Options) -> Failure {
        let refusals = reading.blueprint.as_ref().map_or_else(Vec::new, |rest| rest.problems(world, &self.registries));
        // Statics refuses bodies that can move freely. If another error may have removed a pin, a load or an obstacle that holds a body, such a
        // refusal may be wrong and is omitted.
        let known = reading.knows_what_holds();
        let refusals = refusals.iter().filter(|refusal| known || !refusal.code().starts_with("static."));
        let located: Vec<SceneError> = refusals.map(|refusal| self.locate(refusal, options)).collect();
        let mut errors = reading.errors;
        errors.extend(located);
        // Errors that are only counted come last.
        errors.sort_by_key(|e| (e.code == "scene.more", e.line.unwrap_or(0), e.column.unwrap_or(0)));
        Failure::Scene(shown(errors))
    }

    fn locate(&self, error: &WorldError, options: &scene::Options) -> SceneError {
        in_scene(SceneError::from(error), self.text(), &self.file, &options.overrides)
    }

    /// Builds the world of a scene that was read with these options. All errors of the scene are reported at once.
    pub(crate) fn build(
        &self,
        blueprint: AnyBlueprint,
        options: &scene::Options,
        world: &Options,
    ) -> Result<Box<dyn AnyWorld>, Failure> {
        let build = || blueprint.build_with(world.clone(), &self.registries);
        let built = preparation::watched(&world.break_off, build).map_err(|first| {
            if first == (WorldError::BrokenOff {}) {
                return Failure::Interrupted;
            }
            // The scene is read again, so that it need not be kept just in case its world is refused.
            let reading = self.survey(options);
            match self.refused(reading, options, world) {
                Failure::Scene(all) if !all.is_empty() => Failure::Scene(all),
                _ => Failure::Scene(vec![self.locate(&first, options)]),
            }
        })?;
        let warnings = built.warnings();
        if options.strict && !warnings.is_empty() {
            let error = |w| in_scene(SceneError::from(w), self.text(), &self.file, &options.overrides);
            return Err(Failure::Scene(warnings.iter().map(error).collect()));
        }
        Ok(built)
    }

    /// An error that ends a run at some time. It does not belong to a line of the scene.
    pub(crate) fn run_error(&self, error: &WorldError, time: f64) -> Failure {
        let scene_error = SceneError { file: self.file.clone(), ..SceneError::from(error) };
        Failure::Run(Box::new(timed(scene_error, error, time)))
    }

    /// The failure of a run that an error ends at a frame. If a command was refused, or a pin or an obstacle leads a body through another, the error
    /// names its line.
    pub(crate) fn frame_error(&self, error: &WorldError, world: &dyn AnyWorld, options: &scene::Options) -> Failure {
        if *error == (WorldError::BrokenOff {}) {
            return Failure::Interrupted;
        }
        let Some(command) = world.refused_command() else {
            return match error {
                // The path of a pin or of an obstacle in the scene is the cause.
                WorldError::LedThrough { .. } | WorldError::LedThroughObstacle { .. } => {
                    Failure::Run(Box::new(timed(self.locate(error, options), error, world.time())))
                }
                _ => self.run_error(error, world.time()),
            };
        };
        let scene_error = of_command(error, &command, (self.text(), self.file.as_str()), &options.overrides);
        Failure::Run(Box::new(timed(scene_error, error, world.time())))
    }
}

/// Adds the time to an error, unless the message of the error already contains it.
fn timed(scene_error: SceneError, error: &WorldError, time: f64) -> SceneError {
    if matches!(error, WorldError::Snapshot { .. }) || has_time(error) {
        return scene_error;
    }
    let message = format!("at t = {} s: {}", number(time), scene_error.message);
    let about = scene_error.about.clone().map(|about| Around::AtTime { time, about }.into());
    SceneError { message, about, ..scene_error }
}

/// Whether a message, or a part of it, contains the time or the time of the last good frame.
fn has_time(message: &dyn Message) -> bool {
    message.fields().iter().any(|(name, value)| match value {
        Field::Message(part) => has_time(&**part),
        _ => matches!(*name, "time" | "last"),
    })
}

/// The name of a file as it must be typed on the command line.
pub(crate) fn argument(path: &str) -> String {
    // Without `./` in front, such a path would look like an option.
    let path = if path.starts_with('-') { format!("./{path}") } else { path.to_string() };
    if path.chars().all(|c| c.is_alphanumeric() || "._-/\\:".contains(c)) {
        path
    } else {
        format!("'{}'", visible(&path).replace('\'', "'\\''"))
    }
}

/// Splits the overrides of a call.
pub(crate) fn overrides(set: &[String]) -> Result<Vec<(String, String)>, Failure> {
    set.iter().map(|s| opruga::io::overrides::split(s).map_err(|e| Failure::Scene(vec![e]))).collect()
}
