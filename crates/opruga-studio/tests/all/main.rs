//! All tests of this crate that do not need a process of their own, in one program, so that it is linked once.

mod beside;
mod croatian;
mod kept_scenes;
mod pages;
mod recorded_runs;
mod registered;
mod screen;
mod sessions;
mod windows;
