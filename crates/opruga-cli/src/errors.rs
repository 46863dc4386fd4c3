//! Errors of the command line, in addition to the errors of the library.

use opruga::math::message::AnyMessage;
use opruga::math::words::{counted, number, rounded};
use opruga::world::error::Crossing;

opruga::math::messages! {
    /// Why a call is refused.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CallError {
        "read.failed" #[error("there is no sweep: {file} is missing")]
        NoSweep { file: &'static str },
        "read.failed" #[error("the file cannot be read: {reason}")]
        FileUnreadable { reason: String },
        "read.not_regular_file" #[error("this is not a regular file")]
        NotARegularFile {},
        "scene.no_scene" #[error("this is the file of a shape, not a scene")]
        #[hint("name the file in a scene: shape = {{ kind = \"{kind}\", file = \"{file}\", … }}; `opruga mesh` shows it")]
        ShapeFile { kind: &'static str, file: String },
        "material.gradient" #[error("`--F` contains `{word}`, which is not a finite number")] #[value("{word}")]
        #[allowed("4 finite numbers (2D) or 9 (3D), row by row")]
        #[hint("--F 1.1,0,0,1 stretches the plane by a tenth along x; --F 1,0,0,0,1,0,0,0,1 is the state at rest in space")]
        GradientNumber { word: String },
        "material.gradient" #[error("`--F` has {count} numbers")] #[value("{text}")]
        #[allowed("4 finite numbers (2D) or 9 (3D), row by row")]
        #[hint("--F 1.1,0,0,1 stretches the plane by a tenth along x; --F 1,0,0,0,1,0,0,0,1 is the state at rest in space")]
        GradientCount { count: usize, text: String },
        "scene.unknown_name" #[error("there is no material `{name}`")] #[value("{name}")] #[allowed("{known}")]
        NoMaterialToAsk { name: String, known: String },
        "scene.dimension" #[error("`--plane` applies to the plane, but F is in space")] #[allowed("with 4 numbers in `--F`")]
        PlaneInSpace {},
        "scene.unknown_field" #[error("`{law}` has no field `{field}`")] #[value("{text}")] #[allowed("{known}")]
        NoFieldOfLaw { field: String, law: String, text: String, known: String },
        "scene.unknown_field" #[error("`{law}` has no field `{field}`")] #[value("{text}")] #[allowed("none: the law has only E and ν")]
        NoFields { field: String, law: String, text: String },
        "checkpoint.version" #[error("the checkpoint belongs to another version of the program")]
        OtherVersion {},
    }
}

opruga::math::messages! {
    /// The allowed values of an argument.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CallRange {
        "part.call_range" #[error("{} to {}", number(*least), number(*most))]
        Between { least: f64, most: f64 },
        "part.call_range" #[error("numbers above 0")]
        Positive {},
        "part.call_range" #[error("numbers above 0, at most {}", number(*most))]
        PositiveUpTo { most: f64 },
        "part.call_range" #[error("the name of a file")]
        FileName {},
        "part.call_range" #[error("{names}")]
        OneOf { names: String },
    }
    /// Errors in a call.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CallFault {
        "call" #[error("{text}")] #[hint("--help lists commands and options")]
        Arguments { text: String },
        "call" #[error("{option} is {value}; allowed: {allowed}")]
        OutOfRange { option: &'static str, value: String, allowed: CallRange },
        "call" #[error("OPRUGA_SIMD={name} is unknown; allowed: scalar, sse2, avx2, avx512")]
        NoInstructions { name: String },
        "call" #[error("there is no integrator `{name}`")] #[hint("did you mean `{closest}`?")]
        NoIntegratorNear { name: String, closest: String },
        "call" #[error("there is no integrator `{name}`")] #[hint("the integrators are {known}")]
        NoIntegrator { name: String, known: String },
        "call" #[error("there is no model `{name}`")]
        NoModel { name: &'static str },
        "call" #[error("there is no obstacle `{name}`")]
        NoObstacle { name: &'static str },
        "call" #[error("{path} cannot be written: files ending in `.{ending}` are unknown")] #[hint("known endings: {known}")]
        UnknownEnding { path: String, ending: String, known: &'static str },
        "call" #[error("{path} is not a file name in UTF-8")]
        NotUtf8 { path: String },
        "call" #[error("--size is missing")] #[hint("--size H sets the approximate length of the edges [m]")]
        NoSize {},
        "call" #[error("--scale-to is missing")] #[hint("--scale-to L sets the longer side of the drawing [m]")]
        NoScale {},
        "call" #[error("--set text=… is missing")]
        #[hint("--set text=… gives the text to write in the font, such as --set text=opruga")]
        NoText {},
        "call" #[error("{path} already has cells")] #[hint("leave out --size and --scale-to to show the mesh, or to write it in another format")]
        HasCells { path: String },
        "call" #[error("{path}: files ending in `.{ending}` contain no shape")]
        #[hint("files that can be read end in .obj, .stl, .ply, .gltf, .glb, .svg, .png, .json, .geojson, .topojson, .ttf, .otf, {meshes}")]
        NoShape { path: String, ending: String, meshes: &'static str },
        "call" #[error("{path}: files ending in `.toml` contain no shape")] #[hint("`opruga check` and `opruga run` read scenes")]
        SceneAsShape { path: String },
        "call" #[error("the file contains no cells that could fill a body")]
        NothingFills {},
        "call" #[error("--fps {fps} with frames of {frame} s would give {rate} pictures per second")]
        #[hint("allowed rates are 0.0001 to 10000; --no-pictures writes no film")]
        FilmRate { rate: String, fps: String, frame: String },
        "call" #[error("--gltf, --pc2 and --mdd keep the whole run in memory, here more than {bytes} bytes")]
        #[hint("use a lower --fps, or write only a part with --from and --to")]
        RunTooLong { bytes: usize },
        "call" #[error("there is no frame from {} s to {} s: the recording has frames from {} s to {} s, {} s apart", number(*from), number(*to), number(*first), number(*last), number(*apart))]
        NoFrame { from: f64, to: f64, first: f64, last: f64, apart: f64 },
        "call" #[error("the checkpoint is at t = {} s, and the run ends at {} s: nothing is left to do", number(*time), number(*end))]
        #[hint("--seconds is the simulated time at which the run ends; it must be above {}", number(*time))]
        NothingLeft { time: f64, end: f64 },
        "call" #[error("`{scene}` comes with the program and never changes: --watch needs a file")] #[hint("`opruga new NAME` writes one")]
        NeverChanges { scene: String },
        "call" #[error("there is no screen on which a window could be opened")] #[hint("`opruga run {scene}` runs without a window and writes pictures")]
        NoScreen { scene: String },
        "call" #[error("there is no screen on which a window could be opened")] #[hint("`opruga replay {file}` writes its pictures")]
        NoScreenForRecording { file: String },
        "call" #[error("the program `opruga-studio` is not in the same folder as this one")] #[hint("`cargo install --path crates/opruga-studio` installs it")]
        NoStudio {},
        "call" #[error("the studio cannot be started: {reason}")]
        StudioNotStarted { reason: String },
        "call" #[error("the scene has no body")]
        NoBody {},
        "call" #[error("no case or family is called `{word}`; the families are {families}")] #[hint("did you mean `{closest}`? `opruga verify --list` shows all cases")]
        NoCaseNear { word: String, families: String, closest: String },
        "call" #[error("no case or family is called `{word}`; the families are {families}")] #[hint("`opruga verify --list` shows all cases")]
        NoCase { word: String, families: String },
    }
}

opruga::math::messages! {
    /// Errors of the output of a command.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum OutputError {
        "write.failed" #[error("the program cannot write to stdout: {reason}")]
        Stdout { reason: String },
        "interrupted" #[error("interrupted; the files are closed")]
        Interrupted {},
    }
    /// Why a check of a run has failed.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CheckFault {
        "contact.crossed" #[error("at t = {} s, {crossing}", number(*time))]
        Crossed { time: f64, crossing: Crossing },
        "contact.crossed" #[error("at t = {} s, {crossing}; in all, {pairs} pairs of bodies cross", number(*time))]
        CrossedByPairs { time: f64, crossing: Crossing, pairs: usize },
    }
}

opruga::math::messages! {
    /// Warnings about a call, its machine or its inputs.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CallWarning {
        "threads.above_cores" #[error("{threads} threads on {}: more threads than cores are not faster", counted(*cores as u64, "core", "cores"))]
        AboveCores { threads: usize, cores: usize },
        "simd.other" #[error("OPRUGA_SIMD=scalar: the kernels use {used}, which every processor of this kind has")]
        NeverScalar { used: &'static str },
        "simd.other" #[error("OPRUGA_SIMD={asked}: this processor does not have these instructions; the kernels use {used}")]
        InstructionsLacking { asked: String, used: &'static str },
        "diagnostics.thinned"
        #[error("diagnostics.csv would have about {megabytes} MB, more than the default limit of {most} MB, so only one frame in {apart} has a row; --diagnostics-every 1 writes all rows")]
        Thinned { megabytes: u64, most: u64, apart: u64 },
        "checkpoint.failed" #[error("a checkpoint during the run could not be written: {cause}")]
        CheckpointFailed { cause: AnyMessage },
        "checkpoint.failed" #[error("no checkpoint was written at t = {} s: {path}: {cause}", number(*time))]
        NoCheckpoint { time: f64, path: String, cause: AnyMessage },
        "recording.open"
        #[error("the recording has no end: its run was killed or is still running; {} up to t = {} s {} complete, and {} after {} not a complete frame",
            counted(*frames, "frame", "frames"), number(*until), if *frames == 1 { "is" } else { "are" },
            counted(*lost, "byte", "bytes"), if *lost == 1 { "it is" } else { "them are" })]
        NoEnd { frames: u64, until: f64, lost: u64 },
        "recording.program" #[error("{program} wrote the recording, but this program is {now}")]
        OtherProgram { program: String, now: &'static str },
        "scene.changed" #[error("{file} has changed since the run was recorded; the recording uses its own copy")]
        SceneChanged { file: String },
        "pictures.thinned" #[error("pictures of {nodes} nodes would need {mebibytes} MiB, so only one frame in {every} has a picture")]
        PicturesThinned { nodes: usize, mebibytes: u64, every: u64 },
    }
    /// Notes about a call.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CallNote {
        "run.whole_frames"
        #[error("a run consists of whole frames, so it ends at t = {} s instead of {} s, after {} of {} s",
            number(*reached), number(*asked), counted(*frames, "frame", "frames"), rounded(*frame, 4))]
        WholeFrames { reached: f64, asked: f64, frames: u64, frame: f64 },
        "run.takes_long"
        #[error("the run will take about {duration} more ({} of {} s). To shorten it: {shorter}", counted(*frames, "frame", "frames"), rounded(*each, 2))]
        TakesLong { duration: String, frames: u64, each: f64, shorter: Shorter },
        "pictures.rate"
        #[error("there are {} pictures per second, not {} (--fps): the time between two pictures is a whole number of frames of the scene, here {} of {} s each",
            rounded(*rate, 4), rounded(*asked, 4), counted(*every, "frame", "frames"), rounded(*frame, 4))]
        OtherRate { rate: f64, asked: f64, every: u64, frame: f64 },
        "pictures.none" #[error("no plots: {cause}")]
        NoPlots { cause: AnyMessage },
        "pictures.none" #[error("no strip and no video: {cause}")]
        NoStrip { cause: AnyMessage },
        "pictures.none" #[error("no video, because the run was interrupted; `opruga run --resume` continues from the checkpoint")]
        NoVideo {},
        "threads.shared" #[error("{threads} runs shared the machine; to compare speeds, use --threads 1 (and --force)")]
        SharedMachine { threads: usize },
    }
    /// Ways to make a run shorter.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum Shorter {
        "part.shorter" #[error("--set integrator.accuracy=real_time")]
        RealTime {},
        "part.shorter" #[error("an explicit integrator, --set integrator={integrator} --set time.substeps={substeps}")]
        Explicit { integrator: &'static str, substeps: u32 },
        "part.shorter" #[error("fewer substeps than {substeps}: implicit integrators have no largest stable step")]
        FewerSubsteps { substeps: u32 },
        "part.shorter" #[error("--set time.substeps={substeps}, which is stable for the shapes at rest")]
        Substeps { substeps: u32 },
        "part.shorter" #[error("--threads {threads}")]
        Threads { threads: usize },
        "part.shorter" #[error("fewer nodes, or an earlier end (--seconds)")]
        Less {},
        "part.shorter" #[error("{first}; {rest}")]
        List { first: Box<Shorter>, rest: Box<Shorter> },
    }
    /// What helps if a recording or a checkpoint cannot be used.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ResumeHint {
        "part.resume_hint" #[error("the frames before the damage are complete: --to {} shows them", number(*time))]
        FramesBefore { time: f64 },
        "part.resume_hint" #[error("there is no complete frame before the damage")]
        NoFrameBefore {},
        "part.resume_hint" #[error("the run was killed before its first frame was written")]
        KilledAtStart {},
        "part.resume_hint" #[error("the checkpoint before it is complete, at t = {} s: --resume {file}", number(*time))]
        CheckpointBefore { time: f64, file: String },
        "part.resume_hint" #[error("a run writes it into its output folder, such as out/ball/checkpoint")]
        InOutput {},
        "part.resume_hint" #[error("try an older checkpoint; there is none next to this one")]
        NoneBeside {},
    }
}
