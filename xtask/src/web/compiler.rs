//! The compiler for browsers. It is that of rustup if the target is installed, otherwise that of Debian, which also builds the standard library.

use std::path::{Path, PathBuf};
use std::process::Command;

const TARGET: &str = "wasm32-unknown-unknown";
/// The folder of Debian's cargo, which finds its compiler only there.
const DEBIAN: &str = "/usr/bin";
const HINT: &str = "`rustup target add wasm32-unknown-unknown` installs one; on Debian `apt-get install rustc-web cargo-web \
                    rust-web-src rust-web-llvm lld-22` does too";

/// Compiles the library of a package for browsers. Returns the file of the program.
///
/// # Errors
/// There is no compiler, or the errors of the compiler.
pub(super) fn compile(root: &Path, package: &str) -> Result<PathBuf, String> {
    let target = super::target()?.join("web");
    let mut cargo = if rustup_has_target() {
        Command::new(env!("CARGO"))
    } else if Path::new("/usr/lib/rustlib/src/rust/library/std").is_dir() && Path::new("/usr/bin/cargo").is_file() {
        debian()
    } else {
        return Err(format!("there is no compiler for {TARGET}: {HINT}"));
    };
    cargo.args(["rustc", "--locked", "--package", package, "--lib", "--crate-type", "cdylib", "--profile", "web"]);
    cargo.args(["--target", TARGET]).arg("--target-dir").arg(&target).current_dir(root);
    let status = cargo.status().map_err(|e| format!("cargo build: {e}"))?;
    if !status.success() {
        return Err(format!("{package} was not compiled for {TARGET}"));
    }
    Ok(target.join(TARGET).join("web").join(format!("{}.wasm", package.replace('-', "_"))))
}

fn rustup_has_target() -> bool {
    let installed = Command::new("rustup").args(["target", "list", "--installed"]).output();
    installed.is_ok_and(|output| String::from_utf8_lossy(&output.stdout).lines().any(|line| line == TARGET))
}

/// Debian's cargo with Debian's compiler, isolated from the cargo that runs this task.
fn debian() -> Command {
    let mut cargo = Command::new(format!("{DEBIAN}/cargo"));
    for (name, _) in std::env::vars_os() {
        let name_text = name.to_string_lossy();
        let own = ["CARGO_HOME", "CARGO_BUILD_JOBS", "CARGO_TERM_COLOR"].contains(&name_text.as_ref());
        let of_cargo = ["CARGO", "RUST", "LD_LIBRARY_PATH"].iter().any(|head| name_text.starts_with(head));
        if of_cargo && !own {
            cargo.env_remove(&name);
        }
    }
    // The standard library is built from its sources, which the compiler does only with explicit permission.
    cargo.env("PATH", format!("{DEBIAN}:/bin")).env("RUSTC_BOOTSTRAP", "1");
    // Browsers show no backtraces, so code that reads debugging information is omitted.
    cargo.args(["-Zbuild-std=std,panic_abort", "-Zbuild-std-features="]);
    cargo
}
