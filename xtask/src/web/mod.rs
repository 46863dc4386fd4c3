//! Makes the web page of the studio: compiles the studio for browsers, and writes the files of the page to a folder for any static server.

#[cfg(feature = "web")]
mod bindings;
mod browser;
#[cfg(feature = "web")]
mod compiler;
#[cfg(feature = "web")]
mod pages;
mod server;
mod trial;

use crate::workspace::{root, target};
use std::path::PathBuf;

/// `cargo xtask web [--serve] [--port N]`.
pub(crate) fn build(arguments: &[String]) -> Result<(), String> {
    let mut port = None;
    let mut rest = arguments.iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--serve" => port = port.or(Some(8080)),
            "--port" => {
                let number = rest.next().and_then(|number| number.parse::<u16>().ok());
                port = Some(number.ok_or("--port wants a number between 0 and 65535")?);
            }
            other => return Err(format!("cargo xtask web does not know `{other}`; allowed: --serve, --port NUMBER")),
        }
    }
    let folder = page()?;
    match port {
        Some(port) => server::serve(folder, port)?.run(),
        None => Ok(()),
    }
}

/// `cargo xtask web-trial [PROFILE] [--built]`: tests the page in Chromium, together with the native program that was built with this profile. With
/// `--built`, the page is not built again.
pub(crate) fn trial(arguments: &[String]) -> Result<(), String> {
    let (options, rest): (Vec<_>, Vec<_>) = arguments.iter().partition(|argument| argument.starts_with("--"));
    let profile = rest.first().map_or("debug", |profile| profile.as_str());
    let native = target()?.join(profile).join("opruga");
    if !native.is_file() {
        return Err(format!("{} is missing: `cargo build` builds it", native.display()));
    }
    trial::run(&if options.is_empty() { page()? } else { folder()? }, native)
}

/// `cargo xtask web-measure [PICTURES]`: measures how long pictures of the page take in Chromium.
pub(crate) fn measure(arguments: &[String]) -> Result<(), String> {
    let pictures = match arguments.first() {
        None => 100,
        Some(word) => {
            word.parse::<u32>().ok().filter(|n| *n > 0).ok_or("web-measure wants a number of pictures above 0")?
        }
    };
    trial::measure(&page()?, pictures)
}

/// Builds the page, and returns its folder. Only this task needs the translator between the languages of the page, so xtask is built again with it.
#[cfg(not(feature = "web"))]
fn page() -> Result<PathBuf, String> {
    let mut cargo = std::process::Command::new(env!("CARGO"));
    cargo.args(["run", "--quiet", "--package", "xtask", "--features", "web", "--", "web"]);
    let status = cargo.current_dir(root()?).status().map_err(|e| format!("cargo run: {e}"))?;
    if status.success() { Ok(folder()?) } else { Err("the page was not built".into()) }
}

/// Builds the page, and returns its folder.
#[cfg(feature = "web")]
fn page() -> Result<PathBuf, String> {
    let root = root()?;
    let made = |package| bindings::make(&compiler::compile(&root, package)?);
    let folder = folder()?;
    pages::lay_out(&root, &made("opruga-studio")?, &made("opruga-unpack")?, &folder)?;
    Ok(folder)
}

/// The folder of the page.
fn folder() -> Result<PathBuf, String> {
    Ok(target()?.join("page"))
}
