//! What the command line refuses beside what the library refuses.

opruga::math::messages! {
    /// Why a call is refused.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum CallError {
        "read.failed" #[error("there is no sweep: {file} is missing")]
        NoSweep { file: &'static str },
        "read.failed" #[error("the file cannot be read: {reason}")]
        FileUnreadable { reason: String },
        "read.failed" #[error("there is no such file, and no such scene comes with the program")] #[hint("scenes that come with the program: {scenes}")]
        NoScene { scenes: String },
        "read.failed" #[error("there is no such file, and no such scene comes with the program")] #[hint("did you mean {closest}?")]
        NoSceneNear { closest: String },
        "read.failed" #[error("there is no such file, and no such scene comes with the program")] #[hint("did you mean {closest} or {last}?")]
        NoSceneNearOf { closest: String, last: String },
        "read.not_regular_file" #[error("this is not a regular file")]
        NotARegularFile {},
        "scene.no_scene" #[error("this is the file of a shape, not a scene")]
        #[hint("a scene names it: shape = {{ kind = \"{kind}\", file = \"{file}\", … }}; `opruga mesh` looks at it")]
        ShapeFile { kind: &'static str, file: String },
        "material.gradient" #[error("`--F` has `{word}`, which is not a finite number")] #[value("{word}")]
        #[allowed("4 finite numbers (2D) or 9 (3D), row by row")]
        #[hint("--F 1.1,0,0,1 stretches the plane by a tenth along x; --F 1,0,0,0,1,0,0,0,1 is rest in space")]
        GradientNumber { word: String },
        "material.gradient" #[error("`--F` has {count} numbers")] #[value("{text}")]
        #[allowed("4 finite numbers (2D) or 9 (3D), row by row")]
        #[hint("--F 1.1,0,0,1 stretches the plane by a tenth along x; --F 1,0,0,0,1,0,0,0,1 is rest in space")]
        GradientCount { count: usize, text: String },
        "scene.unknown_name" #[error("there is no material `{name}`")] #[value("{name}")] #[allowed("{known}")]
        NoMaterialToAsk { name: String, known: String },
        "scene.dimension" #[error("`--plane` is about the plane, and F is of space")] #[allowed("with 4 numbers in `--F`")]
        PlaneInSpace {},
        "scene.unknown_field" #[error("`{law}` has no field `{field}`")] #[value("{text}")] #[allowed("{known}")]
        NoFieldOfLaw { field: String, law: String, text: String, known: String },
        "scene.unknown_field" #[error("`{law}` has no field `{field}`")] #[value("{text}")] #[allowed("none: E and ν are all")]
        NoFields { field: String, law: String, text: String },
        "checkpoint.version" #[error("the checkpoint belongs to another version of the program")]
        OtherVersion {},
    }
}
