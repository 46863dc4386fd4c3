//! Finds outputs that would destroy an input or one another. Such outputs are refused before anything is computed, even with `--force`.
//!
//! `--force` lets a call replace the output of an earlier call. The option does not let a call replace an input, because the lost file may be a
//! drawing or a scene that cannot be computed again.

use crate::aside::is_aside;
use crate::safe_write::WriteError;
pub use crate::write_faults::Use;
use crate::write_faults::WriteFault;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// The files that a call reads and writes.
#[derive(Default)]
#[allow(missing_debug_implementations, reason = "it holds functions")]
pub struct Uses {
    inputs: Vec<Used>,
    outputs: Vec<Used>,
    folders: Vec<Folder>,
}

/// A file of a call.
struct Used {
    /// The role of the file in the call.
    what: Use,
    named: PathBuf,
    file: Found,
}

/// Whether a command writes a file of this name into its folder.
type Writes = Box<dyn Fn(&str) -> bool>;

/// A folder that a command writes to.
struct Folder {
    named: PathBuf,
    real: PathBuf,
    writes: Writes,
}

/// A file identified independently of its name.
#[derive(Clone, Debug, PartialEq)]
struct Found {
    /// The path of the file without links, `.` and `..`, as far as the path exists.
    real: PathBuf,
    /// The numbers of the file and its device, which are the same for hard links; none if the file does not exist.
    number: Option<(u64, u64)>,
}

impl Uses {
    /// Adds a file that the call reads.
    pub fn input(&mut self, what: Use, path: &Path) {
        self.inputs.push(Used { what, named: path.to_path_buf(), file: Found::of(path) });
    }

    /// Adds a file that the call will write, with the option that names it.
    pub fn output(&mut self, option: &'static str, path: &Path) {
        let what = Use::Option { option };
        self.outputs.push(Used { what, named: path.to_path_buf(), file: Found::of(path) });
    }

    /// Adds a folder that the call will write to, and a test of the names that its files may have.
    pub fn folder(&mut self, path: &Path, writes: impl Fn(&str) -> bool + 'static) {
        let writes: Writes = Box::new(move |name| name == crate::output_folder::LOCK || is_aside(name) || writes(name));
        self.folders.push(Folder { named: path.to_path_buf(), real: Found::of(path).real, writes });
    }

    /// Checks that every output is a separate file.
    ///
    /// # Errors
    /// `write.input` for an output that is an input, `write.twice` for two outputs that are the same file.
    pub fn check(&self) -> Result<(), WriteError> {
        for (place, output) in self.outputs.iter().enumerate() {
            if let Some(input) = self.inputs.iter().find(|input| input.file.is(&output.file)) {
                return Err(replaces(&output.named, &output.what, &input.what));
            }
            if let Some(other) = self.outputs[..place].iter().find(|other| other.file.would_be(&output.file)) {
                return Err(twice(&output.named, &other.what, &output.what));
            }
        }
        for folder in &self.folders {
            for input in &self.inputs {
                if let Some(path) = folder.goal(&input.file) {
                    return Err(replaces(&path, &Use::OfOutput {}, &input.what));
                }
            }
            for output in &self.outputs {
                if let Some(path) = folder.goal(&output.file) {
                    return Err(twice(&path, &output.what, &Use::OfFolder {}));
                }
            }
        }
        Ok(())
    }
}

fn replaces(path: &Path, output: &Use, input: &Use) -> WriteError {
    WriteError::of(path, WriteFault::ReplacesInput { output: output.clone(), input: input.clone() })
}

fn twice(path: &Path, one: &Use, other: &Use) -> WriteError {
    WriteError::of(path, WriteFault::OneFile { one: one.clone(), other: other.clone() })
}

impl Folder {
    /// The path under which the command would write this file; none if the command would not write the file.
    fn goal(&self, file: &Found) -> Option<PathBuf> {
        if let (Some(folder), Some(name)) = (file.real.parent(), file.real.file_name().and_then(|name| name.to_str()))
            && folder == self.real
        {
            // On systems that ignore case, a name in capitals is the same as one in small letters.
            let small = name.to_lowercase();
            let same = || file.number.is_none() || Found::of(&self.real.join(&small)).is(file);
            if (self.writes)(name) || (self.writes)(&small) && same() {
                return Some(self.named.join(name));
            }
        }
        // A link in the folder may point to the file.
        let number = file.number?;
        let entries = fs::read_dir(&self.real).into_iter().flatten().flatten();
        let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
        let mut written = names.filter(|name| (self.writes)(name));
        let name = written.find(|name| number_of(&self.real.join(name)) == Some(number))?;
        Some(self.named.join(name))
    }
}

impl Found {
    fn of(path: &Path) -> Found {
        let real = real(path, &mut 0);
        let number = number_of(&real);
        Found { real, number }
    }

    /// Whether two names mean the same file.
    fn is(&self, other: &Found) -> bool {
        self.real == other.real || self.number.is_some() && self.number == other.number
    }

    /// Whether two names mean the same file, or will mean the same file once they are written. On many systems, names that do not exist yet and
    /// differ only by case or by the Unicode form of their letters are the same file. Whether a system is of this kind would be known too late, so
    /// such names count as the same file.
    fn would_be(&self, other: &Found) -> bool {
        let form = |found: &Found| crate::canonical::decomposed(&found.real.to_string_lossy().to_lowercase());
        self.is(other) || self.number.is_none() && other.number.is_none() && form(self) == form(other)
    }
}

/// The number of links that are followed before they count as a loop.
const MOST_LINKS: u32 = 40;

/// A path without links, `.` and `..`; parts that do not exist stay as they are named.
fn real(path: &Path, links: &mut u32) -> PathBuf {
    let whole = match path.is_absolute() {
        true => path.to_path_buf(),
        false => std::env::current_dir().unwrap_or_default().join(path),
    };
    let mut out = PathBuf::new();
    for part in whole.components() {
        match part {
            Component::Prefix(_) | Component::RootDir => out.push(part),
            Component::CurDir => {}
            Component::ParentDir => drop(out.pop()),
            Component::Normal(name) => {
                let here = out.join(name);
                out = match (here.canonicalize(), fs::read_link(&here)) {
                    (Ok(there), _) => there,
                    // A link to a file that does not exist yet; writing to the link creates that file.
                    (Err(_), Ok(goal)) if *links < MOST_LINKS => {
                        *links += 1;
                        real(&out.join(goal), links)
                    }
                    _ => here,
                };
            }
        }
    }
    out
}

#[cfg(unix)]
fn number_of(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt as _;
    fs::metadata(path).ok().map(|about| (about.dev(), about.ino()))
}
// Without file numbers, hard links cannot be detected; all other cases are detected by the paths without links.
#[cfg(not(unix))]
fn number_of(_: &Path) -> Option<(u64, u64)> {
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let path = std::env::temp_dir().join(format!("opruga-apart-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(path.join("a/b")).expect("a folder");
        path
    }

    fn code(fill: impl FnOnce(&mut Uses)) -> &'static str {
        let mut uses = Uses::default();
        fill(&mut uses);
        uses.check().map_or_else(|error| error.code(), |()| "")
    }

    #[test]
    fn an_output_that_is_an_input_is_found_by_every_name_of_the_file() {
        let at = folder("input");
        let scene = at.join("a/s.toml");
        fs::write(&scene, "scene").expect("a file");
        let mut names = vec![scene.clone(), at.join("a/./s.toml"), at.join("a/b/../s.toml"), at.join("a/no/../s.toml")];
        #[cfg(unix)]
        {
            std::os::unix::fs::symlink("../s.toml", at.join("a/b/link")).expect("a link");
            std::os::unix::fs::symlink("a", at.join("c")).expect("a link");
            fs::hard_link(&scene, at.join("hard")).expect("a link");
            names.extend([at.join("a/b/link"), at.join("c/s.toml"), at.join("hard")]);
        }
        for name in names {
            let found = code(|uses| {
                uses.input(Use::Input {}, &scene);
                uses.output("--record", &name);
            });
            assert_eq!(found, "write.input", "{}", name.display());
        }
        for other in ["a/S2.toml", "s.toml", "a/b/s.toml"] {
            let found = code(|uses| {
                uses.input(Use::Input {}, &scene);
                uses.output("--record", &at.join(other));
            });
            assert_eq!(found, "", "{other}");
        }
        // Names that are written to a folder.
        let into = |path: &Path| {
            code(|uses| {
                uses.input(Use::Input {}, &at.join("a/s.toml"));
                uses.folder(path, |name| name.ends_with(".toml"));
            })
        };
        assert_eq!((into(&at.join("a/b/..")), into(&at.join("a/b"))), ("write.input", ""));
        #[cfg(unix)]
        {
            fs::hard_link(&scene, at.join("a/b/other.toml")).expect("a link");
            assert_eq!((into(&at.join("c")), into(&at.join("a/b"))), ("write.input", "write.input"));
        }
        fs::remove_dir_all(&at).expect("it goes");
    }

    #[test]
    fn two_outputs_of_one_file_are_found_before_it_is_there() {
        let at = folder("twice");
        let two = |one: &str, other: &str| {
            code(|uses| {
                uses.output("-o", &at.join(one));
                uses.output("--picture", &at.join(other));
            })
        };
        for other in ["q.msh", "./q.msh", "a/../q.msh", "a/b/../../q.msh", "Q.MSH", "q.Msh"] {
            assert_eq!(two("q.msh", other), "write.twice", "{other}");
        }
        assert_eq!(two("caf\u{e9}.msh", "cafe\u{301}.msh"), "write.twice");
        assert_eq!(two("q.msh", "q.png"), "");
        assert_eq!(two("q.msh", "a/q.msh"), "");
        #[cfg(unix)]
        {
            // A link to a file that does not exist yet.
            std::os::unix::fs::symlink("q.msh", at.join("link")).expect("a link");
            assert_eq!((two("q.msh", "link"), two("link", "a/../link")), ("write.twice", "write.twice"));
            std::os::unix::fs::symlink("circle", at.join("circle")).expect("a link");
            assert_eq!(two("q.msh", "circle"), "");
        }
        let recorded = |name: &str| {
            code(|uses| {
                uses.output("--record", &at.join(name));
                uses.folder(&at.join("a/b/.."), |name| name == "final.csv");
            })
        };
        for name in ["a/final.csv", "a/.opruga-lock", "a/FINAL.csv"] {
            assert_eq!(recorded(name), "write.twice", "{name}");
        }
        assert_eq!(recorded("a/run.rec"), "");
        fs::remove_dir_all(&at).expect("it goes");
    }
}
