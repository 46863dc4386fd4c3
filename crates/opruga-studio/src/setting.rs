//! The options with which a session runs its scenes, and the models that it offers.

use opruga::{Options, Registries};

/// The options of worlds, and the available models and integrators.
#[derive(Clone, Debug, Default)]
pub struct Setting {
    /// Threads, instruction set and limits.
    pub options: Options,
    /// The models and integrators that scenes can name and panels offer.
    pub registries: Registries,
}

impl From<Options> for Setting {
    /// Makes a setting with these options and with the models and integrators of this library.
    fn from(options: Options) -> Setting {
        Setting { options, ..Setting::default() }
    }
}
