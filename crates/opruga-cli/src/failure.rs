//! Why a command failed, as text for people and as data for programs, and the exit code of the command.

use crate::errors::{CallFault, CallNote, CallRange, CheckFault, OutputError};
use crate::language::translation;
use opruga::Warning;
use opruga::draw::DrawError;
use opruga::io::problem::{Label, SceneError, count_of, in_words, shown, warning_text};
use opruga::io::safe_write::WriteError;
use opruga::math::message::{AnyMessage, Message};
use serde_json::{Value, json};

/// Why a command failed.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The scene has errors.
    Scene(Vec<SceneError>),
    /// A run diverged, or cannot be resumed from a checkpoint.
    Run(Box<SceneError>),
    /// A file cannot be written.
    Write(WriteError),
    /// A picture cannot be drawn or encoded.
    Draw(DrawError),
    /// stdout cannot be written.
    Output(OutputError),
    /// A check has failed.
    Check(CheckFault),
    /// The call is invalid.
    Call(AnyMessage),
    /// Ctrl-C or a termination signal stopped the work, and the files are closed.
    Interrupted,
    /// The reader of the output has closed the pipe.
    ClosedPipe,
}

impl From<DrawError> for Failure {
    fn from(error: DrawError) -> Self {
        Failure::Draw(error)
    }
}

impl From<WriteError> for Failure {
    fn from(error: WriteError) -> Self {
        Failure::Write(error)
    }
}

impl From<opruga::recordings::TapeError> for Failure {
    fn from(error: opruga::recordings::TapeError) -> Self {
        use opruga::recordings::TapeError;
        match error {
            TapeError::Write(error) => Failure::Write(error),
            TapeError::Read(error) => Failure::Run(Box::new(SceneError::from(&error))),
            TapeError::World(error) => Failure::Run(Box::new(SceneError::from(&error))),
        }
    }
}

impl From<Vec<SceneError>> for Failure {
    fn from(errors: Vec<SceneError>) -> Self {
        Failure::Scene(errors)
    }
}

impl Failure {
    /// Makes the failure for an argument that is out of its range.
    pub(crate) fn range(option: &'static str, value: impl core::fmt::Display, allowed: CallRange) -> Failure {
        Failure::call(CallFault::OutOfRange { option, value: value.to_string(), allowed })
    }

    /// Makes the failure for an invalid call.
    pub(crate) fn call(fault: impl Into<AnyMessage>) -> Failure {
        Failure::Call(fault.into())
    }

    /// Returns the exit code: 1 if a check failed, 2 for an invalid call or invalid contents, 3 if the run diverged, 4 if reading or writing failed,
    /// 130 if the run was interrupted.
    pub(crate) fn exit_code(&self) -> u8 {
        match self {
            Failure::Scene(errors) => errors.first().map_or(2, |e| e.exit_code() as u8),
            Failure::Run(error) if error.code.starts_with("run.") => 3,
            Failure::Run(error) => error.exit_code() as u8,
            Failure::Check(_) => 1,
            Failure::Call(_) => 2,
            Failure::Write(_) | Failure::Draw(_) | Failure::Output(_) => 4,
            Failure::Interrupted => 130,
            Failure::ClosedPipe => 0,
        }
    }

    fn to_json(&self) -> Value {
        let plain = |code: &str, message: String, hint: Option<String>| {
            json!({"code": code, "message": message, "file": null, "line": null, "column": null,
                   "path": null, "value": null, "allowed": null, "hint": hint})
        };
        let of = |about: &dyn Message| plain(about.code(), about.to_string(), about.hint());
        match self {
            Failure::Scene(errors) => {
                let errors = shown(errors.clone());
                let mut first = errors.first().map_or(Value::Null, SceneError::to_json);
                if let Some(object) = first.as_object_mut() {
                    let rest: Vec<Value> = errors.iter().skip(1).map(SceneError::to_json).collect();
                    object.insert("more".into(), Value::Array(rest));
                }
                first
            }
            Failure::Run(error) => error.to_json(),
            Failure::Write(error) => error.to_json(),
            Failure::Draw(error) => of(error),
            Failure::Output(error) => of(error),
            Failure::Check(fault) => of(fault),
            Failure::Call(fault) => plain("call", fault.to_string(), fault.hint()),
            Failure::Interrupted => of(&OutputError::Interrupted {}),
            Failure::ClosedPipe => Value::Null,
        }
    }

    /// Prints the failure on stderr.
    pub(crate) fn print(&self, json: bool) {
        use std::io::Write as _;
        let mut err = std::io::stderr().lock();
        if json {
            let _ = writeln!(err, "{}", self.to_json());
            return;
        }
        let _ = match self {
            Failure::Scene(errors) => {
                for error in shown(errors.clone()) {
                    let _ = writeln!(err, "{}", error.text(translation()));
                }
                if count_of(errors) > 1 { writeln!(err, "{} errors", count_of(errors)) } else { Ok(()) }
            }
            Failure::Run(error) => writeln!(err, "{}", error.text(translation())),
            Failure::Write(error) => writeln!(err, "{}", error.text(translation())),
            Failure::Draw(error) => writeln!(err, "{}", with_code(Label::Error, error)),
            Failure::Output(error) => writeln!(err, "{}", with_code(Label::Error, error)),
            Failure::Check(fault) => writeln!(err, "{}", with_code(Label::Error, fault)),
            Failure::Call(fault) => {
                let own = translation();
                let _ = writeln!(err, "{}: {}", in_words(own, &Label::Error), in_words(own, &**fault));
                let hint = own.map_or_else(|| fault.hint(), |own| own.hint(&**fault));
                hint.map_or(Ok(()), |hint| writeln!(err, "  = {}: {hint}", in_words(own, &Label::Hint)))
            }
            Failure::Interrupted => writeln!(err, "{}", in_words(translation(), &OutputError::Interrupted {})),
            Failure::ClosedPipe => Ok(()),
        };
    }
}

/// `error[code]: text`, in the language of the call.
pub(crate) fn with_code(label: Label, about: &dyn Message) -> String {
    let own = translation();
    format!("{}[{}]: {}", in_words(own, &label), about.code(), in_words(own, about))
}

/// Prints a note on stderr.
pub(crate) fn print_note(note: &CallNote) {
    eprintln!("{}", with_code(Label::Note, note));
}

/// Prints a warning on stderr, in the language of the user.
pub(crate) fn print_warning(warning: &Warning) {
    eprintln!("{}", warning_text(warning, translation()));
}

/// Prints data on stdout. A closed pipe is not an error.
pub(crate) fn print_data(text: &str) -> Result<(), Failure> {
    use std::io::Write as _;
    let mut out = std::io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Err(Failure::ClosedPipe),
        Err(e) => Err(Failure::Output(OutputError::Stdout { reason: e.to_string() })),
    }
}
