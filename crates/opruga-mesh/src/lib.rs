//! stopgap
mod stopgap; pub use stopgap::*;
