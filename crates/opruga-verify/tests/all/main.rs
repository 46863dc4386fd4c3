//! All tests of this crate that do not need their own process, in one program, so that it is linked only once.

mod page;
mod quick_cases;
