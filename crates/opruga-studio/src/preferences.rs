//! The user's preferences, stored between starts: a desktop window stores them in a file of the user, a web page in the browser.

use crate::words::Language;
use egui::Theme;
use toml_edit::{DocumentMut, value};

/// The preferences.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Preferences {
    /// The language of the interface.
    pub language: Language,
    /// The theme: dark or light.
    pub theme: Theme,
}

impl Default for Preferences {
    fn default() -> Preferences {
        Preferences { language: Language::English, theme: Theme::Dark }
    }
}

/// Where preferences are stored.
#[derive(Clone, Debug, Default)]
pub enum Store {
    /// The preferences are not stored, and are lost with the window.
    #[default]
    Nowhere,
    /// In this file.
    #[cfg(not(target_arch = "wasm32"))]
    File(std::path::PathBuf),
    /// In the browser.
    #[cfg(target_arch = "wasm32")]
    Browser,
}

impl Preferences {
    /// Reads the preferences in a text. Missing or unknown preferences get their defaults.
    pub fn of(text: &str) -> Preferences {
        let mut preferences = Preferences::default();
        let Ok(document) = text.parse::<DocumentMut>() else { return preferences };
        let entry = |key: &str| document.get(key).and_then(|item| item.as_str());
        if let Some(language) = Language::EVERY.into_iter().find(|language| entry("language") == Some(language.code()))
        {
            preferences.language = language;
        }
        if entry("theme") == Some("light") {
            preferences.theme = Theme::Light;
        }
        preferences
    }

    /// Writes these preferences into a text, whose other parts do not change.
    fn written_into(self, text: &str) -> String {
        let mut document = text.parse::<DocumentMut>().unwrap_or_default();
        document["language"] = value(self.language.code());
        document["theme"] = value(if self.theme == Theme::Light { "light" } else { "dark" });
        document.to_string()
    }
}

impl Store {
    /// The store of the user on this machine, or `Nowhere` if the system names no folder for it.
    #[cfg(not(target_arch = "wasm32"))]
    pub fn of_the_person() -> Store {
        let folder = folders::preferences(|name| std::env::var_os(name));
        folder.map_or(Store::Nowhere, |folder| Store::File(folder.join("studio.toml")))
    }

    /// The stored preferences.
    pub fn read(&self) -> Preferences {
        Preferences::of(&self.text())
    }

    /// Stores preferences. If that fails, they are lost with the window; no work of the user depends on them.
    pub fn write(&self, preferences: Preferences) {
        let text = preferences.written_into(&self.text());
        match self {
            Store::Nowhere => {}
            #[cfg(not(target_arch = "wasm32"))]
            Store::File(path) => {
                let _ = path.parent().map(std::fs::create_dir_all);
                let _ = opruga::io::safe_write::safe_write(path, true, |file| file.write_all(text.as_bytes()));
            }
            #[cfg(target_arch = "wasm32")]
            Store::Browser => crate::browser::store(KEY, &text),
        }
    }

    fn text(&self) -> String {
        match self {
            Store::Nowhere => String::new(),
            #[cfg(not(target_arch = "wasm32"))]
            Store::File(path) => std::fs::read_to_string(path).unwrap_or_default(),
            #[cfg(target_arch = "wasm32")]
            Store::Browser => crate::browser::stored(KEY).unwrap_or_default(),
        }
    }
}

/// The key under which a browser stores the preferences.
#[cfg(target_arch = "wasm32")]
const KEY: &str = "opruga-studio";

/// The folders in which the system lets programs store data of the user.
#[cfg(not(target_arch = "wasm32"))]
pub mod folders {
    use std::ffi::OsString;
    use std::path::PathBuf;

    /// The folder for preferences.
    pub fn preferences(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
        own(&variable, "XDG_CONFIG_HOME", &[".config"], "APPDATA", &["Library", "Application Support"])
    }

    /// The folder for data that can be made again.
    pub fn cache(variable: impl Fn(&str) -> Option<OsString>) -> Option<PathBuf> {
        own(&variable, "XDG_CACHE_HOME", &[".cache"], "LOCALAPPDATA", &["Library", "Caches"])
    }

    fn own(
        variable: &dyn Fn(&str) -> Option<OsString>,
        named: &str,
        at_home: &[&str],
        on_windows: &str,
        on_macos: &[&str],
    ) -> Option<PathBuf> {
        // The specification of these environment variables requires that relative paths are ignored.
        let absolute = |name: &str| variable(name).map(PathBuf::from).filter(|path| path.is_absolute());
        let below_home = |parts: &[&str]| absolute("HOME").map(|home| home.join(parts.iter().collect::<PathBuf>()));
        let folder = if cfg!(windows) {
            absolute(on_windows)
        } else if cfg!(target_os = "macos") {
            below_home(on_macos)
        } else {
            absolute(named).or_else(|| below_home(at_home))
        };
        folder.map(|folder| folder.join("opruga"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::ffi::OsString;
    use std::path::PathBuf;

    #[test]
    fn what_was_kept_is_read_and_what_cannot_be_kept_is_no_failure() {
        let chosen = Preferences { language: Language::Croatian, theme: Theme::Light };
        let folder = std::env::temp_dir().join(format!("opruga-preferences-{}", std::process::id()));
        let store = Store::File(folder.join("below").join("studio.toml"));
        assert_eq!(store.read(), Preferences::default(), "nobody has chosen yet");
        store.write(chosen);
        assert_eq!(store.read(), chosen);
        store.write(Preferences::default());
        assert_eq!(store.read(), Preferences::default());
        // There is a file where the folder should be.
        std::fs::remove_dir_all(&folder).expect("it goes");
        std::fs::write(&folder, b"").expect("a file");
        store.write(chosen);
        assert_eq!(store.read(), Preferences::default());
        std::fs::remove_file(&folder).expect("it goes");
        Store::Nowhere.write(chosen);
        assert_eq!(Store::Nowhere.read(), Preferences::default());
    }

    #[test]
    fn a_text_that_nobody_understands_is_as_none_and_what_else_stands_in_one_stays() {
        for text in ["", "language = ", "language = \"tlh\"\ntheme = 3", "\u{0}"] {
            assert_eq!(Preferences::of(text), Preferences::default(), "{text}");
        }
        let own = "# mine\nlater = 7\ntheme = \"dark\"\n";
        let written = Preferences { theme: Theme::Light, ..Preferences::default() }.written_into(own);
        assert!(
            written.contains("# mine\nlater = 7\ntheme = \"light\"") && written.contains("language = \"en\""),
            "{written}"
        );
    }

    #[test]
    fn the_folders_are_those_that_the_system_names() {
        let with = |pairs: &'static [(&'static str, &'static str)]| {
            move |name: &str| pairs.iter().find(|(known, _)| *known == name).map(|(_, value)| OsString::from(*value))
        };
        assert_eq!(folders::preferences(with(&[])), None);
        if cfg!(target_os = "linux") {
            let home = with(&[("HOME", "/home/ana"), ("XDG_CONFIG_HOME", "config"), ("XDG_CACHE_HOME", "/tmp/cache")]);
            assert_eq!(folders::preferences(home), Some(PathBuf::from("/home/ana/.config/opruga")));
            assert_eq!(folders::cache(home), Some(PathBuf::from("/tmp/cache/opruga")));
        }
    }
}
