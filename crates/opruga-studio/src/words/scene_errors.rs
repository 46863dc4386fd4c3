//! What the readers of scenes and shapes find wrong, in Croatian: what their codes mean, with the places, values and limits that
//! they tell. The English sentence stays beside it where there is no Croatian one.

use super::{Language, details};
use opruga::io::SceneError;

/// Codes and what they mean; of a code that stands alone before its dot, all that begin with it.
const CODES: &[(&str, &str)] = &[
    ("scene.range", "vrijednost izvan dopuštenog"),
    ("scene.shape", "od oblika ne može nastati tijelo"),
    ("scene.missing", "nešto nedostaje"),
    ("scene.not_finite", "broj nije konačan"),
    ("scene.length", "krivi broj vrijednosti"),
    ("scene.duplicate_name", "ime stoji dvaput"),
    ("scene.duplicate_key", "polje stoji dvaput"),
    ("scene.unknown_word", "nepoznata riječ"),
    ("scene.unknown_name", "nepoznato ime"),
    ("scene.unknown_kind", "nepoznata vrsta"),
    ("scene.unknown_field", "nepoznato polje"),
    ("scene.unknown_parameter", "nepoznat parametar"),
    ("scene.type", "vrijednost krive vrste"),
    ("scene.dimension", "kriva dimenzija"),
    ("scene.too_large", "prizor je prevelik"),
    ("scene.syntax", "tekst nije TOML"),
    ("scene.selector", "izbor čvorova ne može se pročitati"),
    ("scene.selects_nothing", "izbor ne pogađa nijedan čvor"),
    ("scene.format", "nepoznata inačica zapisa"),
    ("scene.not_here", "ovdje to ne stoji"),
    ("scene.name", "ime nije dopušteno"),
    ("scene.more", "ima još pogrešaka"),
    ("scene.depth", "tablice su preduboko ugniježđene"),
    ("scene.conflict", "dva zadatka isključuju jedan drugi"),
    ("scene.no_stress", "tijelo ne zna za naprezanje"),
    ("scene.no_values", "mreža nema tih vrijednosti"),
    ("scene.no_effect", "polje ovdje ne djeluje"),
    ("set", "zadana zamjena ne može"),
    ("time.frame", "trajanje sličice ne može"),
    ("command.never", "naredba nikad ne počinje"),
    ("read.failed", "datoteka se ne može pročitati"),
    ("read.not_regular_file", "to nije obična datoteka"),
    ("read.changed", "datoteka se mijenjala dok se čitala"),
    ("shape.too_large", "datoteka oblika je prevelika"),
    ("shape.outside", "datoteka leži izvan mape prizora"),
    ("shape.format", "nepoznat zapis oblika"),
    ("shape.lost_volume", "ispuna mijenja obujam"),
    ("shape.nested", "obris je unutar obrisa drugog elementa"),
    ("shape.thinned", "obris gubi pojedinosti"),
    ("shape.thin_triangles", "ispuna ima uske trokute"),
    ("shape.no_area", "oblik ne obuhvaća površinu"),
    ("shape", "oblik ne može postati tijelo"),
    ("mesh.open", "ploha nije zatvorena"),
    ("mesh.self_intersection", "ploha siječe samu sebe"),
    ("mesh.rounded", "datoteka zaokružuje koordinate"),
    ("mesh.components", "različit broj komponenata"),
    ("mesh.non_manifold", "ploha se grana"),
    ("mesh", "mreža ne može postati tijelo"),
    ("svg", "crtež SVG ne može se pročitati"),
    ("obj", "datoteka OBJ ne može se pročitati"),
    ("ply", "datoteka PLY ne može se pročitati"),
    ("stl", "datoteka STL ne može se pročitati"),
    ("gltf", "datoteka glTF ne može se pročitati"),
    ("map", "karta se ne može pročitati"),
    ("font", "font se ne može pročitati"),
    ("png", "slika se ne može pročitati"),
    ("json", "datoteka nije JSON"),
    ("msh", "datoteka Gmsh ne može se pročitati"),
    ("vtk", "datoteka VTK ne može se pročitati"),
    ("vtu", "datoteka VTK XML ne može se pročitati"),
    ("tetgen", "datoteka TetGen ne može se pročitati"),
    ("medit", "datoteka Medit ne može se pročitati"),
    ("mfem", "datoteka MFEM ne može se pročitati"),
    ("limit.bodies", "prizor je prevelik"),
    ("limit.nodes", "prizor je prevelik"),
    ("limit.memory", "prizor je prevelik"),
    ("limit", "datoteka traži previše"),
];

/// An error in the words of a language.
pub(super) fn text(language: Language, error: &SceneError) -> String {
    match error.about {
        Some(_) => error.text(language.translation()),
        None if language == Language::English => error.to_string(),
        None => croatian(&error.to_string()).unwrap_or_else(|| language.english(&error.to_string())),
    }
}

/// An error of a reader in Croatian; none where the text is not theirs.
fn croatian(text: &str) -> Option<String> {
    let mut known = false;
    let lines: Vec<String> = text
        .lines()
        .map(|line| {
            let told = error(line).or_else(|| beside(line, "  = allowed: ", "  = dopušteno: "));
            let told = told.or_else(|| beside(line, "  = hint: ", "  = savjet: "));
            known |= told.is_some();
            told.unwrap_or_else(|| line.into())
        })
        .collect();
    known.then(|| lines.join("\n"))
}

/// `scene.toml:3:4: error[scene.range]: sentence`.
fn error(line: &str) -> Option<String> {
    let (place, rest) = line.split_once("error[")?;
    let (code, sentence) = rest.split_once("]: ")?;
    let meaning = |wanted: &str| CODES.iter().find(|(known, _)| *known == wanted).map(|(_, meaning)| *meaning);
    let meaning = meaning(code).or_else(|| meaning(code.split('.').next()?))?;
    Some(match details::croatian(sentence) {
        Some(own) => format!("{place}greška[{code}]: {own}"),
        None => format!("{place}greška[{code}]: {meaning} (na engleskom: {sentence})"),
    })
}

/// A line below an error.
fn beside(line: &str, english: &str, croatian: &str) -> Option<String> {
    let rest = line.strip_prefix(english)?;
    Some(format!("{croatian}{}", details::part(rest).unwrap_or_else(|| rest.into())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Session;
    use opruga::Options;
    use opruga::io::Files;

    #[test]
    fn what_is_wrong_with_a_scene_is_told_in_croatian_with_its_places_values_and_limits() {
        let ball = opruga::scenes::find("ball").expect("a scene");
        let wrong = ball.replace("mass = 1.0", "mass = -1.0").replace("radius = 0.5", "raduis = 0.5");
        let refused = Session::open("ball", &wrong, Files::default(), Options::default()).expect_err("it is wrong");
        let told = croatian(&refused.to_string()).expect("it is known");
        for part in ["greška[scene.range]: `mass` je -1.0", "greška[scene.unknown_field]: nema polja `raduis`"] {
            assert!(told.contains(part), "{part}: {told}");
        }
        assert!(told.contains("-1.0") && told.contains("dopušteno: ") && told.contains("savjet: "), "{told}");
        assert_eq!(told.lines().count(), refused.to_string().lines().count());
        assert_eq!(croatian("no space left on device"), None);
    }

    #[test]
    fn every_code_of_the_readers_has_a_meaning() {
        let crates = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).parent().expect("the crates");
        let mut missing = std::collections::BTreeSet::new();
        let mut folders = vec![crates.join("opruga-io/src")];
        let mut count = 0;
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).expect("a folder").flatten() {
                if entry.path().is_dir() {
                    folders.push(entry.path());
                    continue;
                }
                let text = std::fs::read_to_string(entry.path()).unwrap_or_default();
                // Where an error is made, where a reader names its codes, and where a limit is passed.
                let named = ["SceneError::new(", ": &str =", "scanner.error(", "over("];
                let told = named.iter().flat_map(|before| text.split(before).skip(1));
                for rest in told {
                    let Some(code) = rest.trim_start().strip_prefix('"').and_then(|rest| rest.split('"').next()) else {
                        continue;
                    };
                    let letters =
                        |part: &str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_lowercase() || b == b'_');
                    if !code.split_once('.').is_some_and(|(kind, what)| letters(kind) && letters(what)) && code != "set"
                    {
                        continue;
                    }
                    count += 1;
                    let line = format!("error[{code}]: words");
                    if error(&line).is_none() {
                        missing.insert(code.to_string());
                    }
                }
            }
        }
        assert!(count > 100, "the sources are read: {count}");
        assert!(missing.is_empty(), "{missing:?}");
    }
}
