//! Every test of this crate that needs no process of its own, in one program: it is linked once.

mod page;
mod quick_cases;
