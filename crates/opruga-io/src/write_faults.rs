//! Why a file or a folder could not be written.

use opruga_math::message::AnyMessage;
use opruga_math::{messages, terms};

terms! {
    /// The operation on a folder that failed.
    pub enum Doing = "part.doing" { Made = "made", Written = "written", Locked = "locked", Read = "read" }
}

messages! {
    /// Why a file or a folder could not be written.
    #[derive(Clone, Debug, PartialEq)]
    pub enum WriteFault {
        "write.exists" #[error("the file already exists")] #[hint("--force replaces it")]
        FileExists {},
        "write.exists" #[error("the folder already contains {file}")] #[hint("use --force to replace it, or choose another folder")]
        HoldsFile { file: String },
        "write.exists" #[error("the folder already contains {count} files, among them {file}")]
        #[hint("use --force to replace them, or choose another folder")]
        HoldsFiles { count: usize, file: String },
        "write.failed" #[error("writing stopped after {bytes} bytes: {reason}")]
        Stopped { bytes: u64, reason: String },
        "write.failed" #[error("this is a folder")]
        IsFolder {},
        "write.failed" #[error("this is not a regular file")]
        NoRegularFile {},
        "write.failed" #[error("the path has no file name")]
        NoFileName {},
        "write.failed" #[error("the file cannot be created: {reason}")]
        FileNotMade { reason: String },
        "write.failed" #[error("the file cannot be created: {reason}")] #[hint("its parent folder is missing")]
        NoFolderAround { reason: String },
        "write.failed" #[error("its parent folder cannot be created: {reason}")]
        FolderAroundNotMade { reason: String },
        "write.failed" #[error("the recording has already ended")]
        RecordingEnded {},
        "write.locked" #[error("another process is writing this file")] #[hint("wait for it, or choose another name")]
        FileLocked {},
        "write.locked" #[error("another process is writing into this folder")] #[hint("wait for it, or choose another folder")]
        FolderLocked {},
        "write.folder" #[error("the folder cannot be {doing}: {reason}")]
        Folder { doing: Doing, reason: String },
        "write.folder" #[error("this is a file, not a folder")]
        IsFile {},
        "write.folder" #[error("{problem}")] #[hint("{}", problem.hint().unwrap_or_default())]
        Unwritable { problem: AnyMessage },
        "write.input" #[error("{output} would replace {input}, which is an input of this call")]
        #[hint("choose another name; --force replaces outputs only, never an input")]
        ReplacesInput { output: Use, input: Use },
        "write.twice" #[error("{one} and {other} are the same file: only the last one would remain")] #[hint("choose another name for one of them")]
        OneFile { one: Use, other: Use },
    }
    /// The role of a file in a call.
    #[derive(Clone, Debug, PartialEq)]
    pub enum Use {
        "part.use" #[error("the input")]
        Input {},
        "part.use" #[error("the scene {path}")]
        Scene { path: String },
        "part.use" #[error("`{name}`, which the scene names")]
        NamedByScene { name: String },
        "part.use" #[error("`{name}`, which the input names")]
        NamedByInput { name: String },
        "part.use" #[error("the recording")]
        Recording {},
        "part.use" #[error("the checkpoint of --resume")]
        Checkpoint {},
        "part.use" #[error("{option}")]
        Option { option: &'static str },
        "part.use" #[error("a file of the output")]
        OfOutput {},
        "part.use" #[error("a file of the output folder")]
        OfFolder {},
    }
}
