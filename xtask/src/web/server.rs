//! A minimal static server, which is sufficient for the page.

use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A folder that is served on this machine.
pub(super) struct Server {
    listener: TcpListener,
    folder: Arc<PathBuf>,
    /// Its address.
    pub(super) address: String,
    /// Whether it answers. Tests switch the answers off to see how the page works offline.
    pub(super) answers: Arc<AtomicBool>,
}

/// Serves a folder at a port of this machine. If the port is 0, any free port is used.
///
/// # Errors
/// A port that is in use.
pub(super) fn serve(folder: PathBuf, port: u16) -> Result<Server, String> {
    let failed = |e: std::io::Error| format!("127.0.0.1:{port}: {e}; `--port` takes another");
    let listener = TcpListener::bind(("127.0.0.1", port)).map_err(failed)?;
    let address = format!("http://{}/", listener.local_addr().map_err(failed)?);
    Ok(Server { listener, folder: Arc::new(folder), address, answers: Arc::new(AtomicBool::new(true)) })
}

impl Server {
    /// Answers for ever.
    ///
    /// # Errors
    /// None: it ends with the program.
    pub(super) fn run(self) -> Result<(), String> {
        println!("{} serves {}; Ctrl C ends it", self.address, self.folder.display());
        for stream in self.listener.incoming().flatten() {
            let (folder, answers) = (Arc::clone(&self.folder), Arc::clone(&self.answers));
            std::thread::spawn(move || {
                if answers.load(Ordering::Relaxed) {
                    // The client may have closed the connection.
                    let _ = answer(stream, &folder);
                }
            });
        }
        Ok(())
    }

    /// Answers on a thread until the program ends.
    pub(super) fn start(self) -> (String, Arc<AtomicBool>) {
        let (address, answers) = (self.address.clone(), Arc::clone(&self.answers));
        std::thread::spawn(move || self.run());
        (address, answers)
    }
}

fn answer(mut stream: TcpStream, folder: &Path) -> std::io::Result<()> {
    stream.set_read_timeout(Some(Duration::from_secs(10)))?;
    let mut lines = BufReader::new(stream.try_clone()?).lines();
    let first = lines.next().transpose()?.unwrap_or_default();
    // The other headers of the browser are ignored.
    while lines.next().transpose()?.is_some_and(|line| !line.is_empty()) {}
    let asked = first.split(' ').nth(1).unwrap_or("/").split(['?', '#']).next().unwrap_or("/");
    let name = if asked == "/" { "index.html" } else { asked.trim_start_matches('/') };
    // The folder has no subfolders, so a name that contains a path is refused.
    let bytes =
        if name.contains(['/', '\\']) || name.contains("..") { None } else { std::fs::read(folder.join(name)).ok() };
    let Some(bytes) = bytes else {
        return stream.write_all(b"HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\nConnection: close\r\n\r\n");
    };
    let kind = match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript",
        Some("svg") => "image/svg+xml",
        Some("wasm") => "application/wasm",
        Some("webmanifest") => "application/manifest+json",
        // The credits, and licences without a file name extension.
        Some("md" | "txt") => "text/plain; charset=utf-8",
        Some(whole) if whole == name => "text/plain; charset=utf-8",
        _ => "application/octet-stream",
    };
    let length = bytes.len();
    write!(stream, "HTTP/1.1 200 OK\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\nConnection: close\r\n\r\n")?;
    stream.write_all(&bytes)
}
