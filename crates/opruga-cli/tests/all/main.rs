//! All tests of this crate that do not need a process of their own, in one program, so that it is linked once.

mod checkpoints;
mod command_line;
mod common;
mod faults;
mod first_mistakes;
mod gallery;
mod language;
mod lost_files;
mod material;
mod mesh;
mod newcomer;
mod numbers_beyond_all;
mod recordings;
mod shape_files;
mod stress_tables;
mod sweeps;
mod told_limits;
mod true_words;
mod verify;
