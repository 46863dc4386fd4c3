//! Every test of this crate that needs no process of its own, in one program: it is linked once.

mod beside;
mod croatian;
mod kept_scenes;
mod pages;
mod recorded_runs;
mod registered;
mod screen;
mod sessions;
mod windows;
