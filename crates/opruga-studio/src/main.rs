//! The program `opruga-studio [SCENE]`: the window of Opruga. Compiled for a browser it is what the page
//! `web/index.html` loads.

#[cfg(not(target_arch = "wasm32"))]
fn main() -> std::process::ExitCode {
    opruga_studio::window::main()
}

#[cfg(target_arch = "wasm32")]
fn main() {
    // The page calls `open` of `opruga_studio::page` with the canvas on which the studio shall be.
    opruga_studio::page::ready();
}
