//! In what a session runs its scenes.

use opruga::{Options, Registries};

/// How worlds are run, and by which models and integrators.
#[derive(Clone, Debug, Default)]
pub struct Setting {
    /// Threads, instructions and limits.
    pub options: Options,
    /// What scenes can name, and what panels offer.
    pub registries: Registries,
}

impl From<Options> for Setting {
    /// With the models and integrators of this library.
    fn from(options: Options) -> Setting {
        Setting { options, ..Setting::default() }
    }
}
