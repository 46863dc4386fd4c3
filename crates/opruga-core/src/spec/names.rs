//! Names that are close to a given word.

/// Names that are common in the field, as letters and digits only, and the names that Opruga uses instead.
const OTHER_NAMES: [(&str, &str); 23] = [
    ("rk4", "runge_kutta"),
    ("rungekutta4", "runge_kutta"),
    ("euler", "symplectic_euler"),
    ("semiimpliciteuler", "symplectic_euler"),
    ("forwardeuler", "explicit_euler"),
    ("impliciteuler", "backward_euler"),
    ("leapfrog", "verlet"),
    ("velocityverlet", "verlet"),
    ("midpoint", "implicit_midpoint"),
    ("rk2", "heun"),
    ("generalizedalpha", "newmark"),
    ("generalisedalpha", "newmark"),
    ("hht", "newmark"),
    ("static", "equilibrium"),
    ("statics", "equilibrium"),
    ("springs", "mass_spring"),
    ("gas", "pressure"),
    ("finiteelements", "fem"),
    ("stvk", "st_venant_kirchhoff"),
    ("circle", "ring"),
    ("plane", "half_space"),
    ("sphere", "icosphere"),
    ("name", "title"),
];

/// The candidate that a word means. If the word is a common name for a candidate, it is this candidate. If there is none, it is the candidate that
/// differs from the word in the fewest letters, if these are few enough.
pub fn nearest<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    let candidates: Vec<&str> = candidates.collect();
    let spelt: String = word.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
    if let Some((_, ours)) = OTHER_NAMES.iter().find(|(name, ours)| *name == spelt && candidates.contains(ours)) {
        return Some((*ours).to_string());
    }
    let limit = word.chars().count() / 3 + 1;
    candidates
        .into_iter()
        .map(|c| (letters_apart(word, c), c))
        // A word that shares no letter is not close.
        .filter(|(distance, c)| *distance <= limit && *distance < c.chars().count())
        .min()
        .map(|(_, c)| c.to_string())
}

/// The largest number of candidates that are offered for a word.
const MOST_OFFERED: usize = 4;

/// All candidates that a word may mean, the closest first. Either the whole candidate or its beginning, up to the end of one of its parts, differs
/// from the word by a few letters. For example, `ballon` may mean `balloon-in-a-box`. Of two equally close candidates, the candidate with the longer
/// common beginning comes first.
pub fn close_matches<'a>(word: &str, candidates: impl Iterator<Item = &'a str>) -> Vec<String> {
    let candidates: Vec<&str> = candidates.collect();
    let limit = word.chars().count() / 3 + 1;
    let mut found: Vec<(usize, usize, &str)> = Vec::new();
    for candidate in &candidates {
        let parts = candidate.match_indices(['-', '_', '.']).map(|(at, _)| &candidate[..at]);
        let part_distances = parts.filter(|part| part.chars().count() > 2).map(|part| letters_apart(word, part) + 1);
        let distance = part_distances.chain([letters_apart(word, candidate)]).min().unwrap_or(usize::MAX);
        let common = word.chars().zip(candidate.chars()).take_while(|(a, b)| a == b).count();
        if distance <= limit && distance < candidate.chars().count() && common > 0 || distance <= 1 {
            found.push((distance, usize::MAX - common, candidate));
        }
    }
    found.sort_unstable();
    let first = nearest(word, candidates.into_iter());
    let closest = found.first().map_or(0, |best| best.0);
    let offered =
        found.into_iter().filter(|(distance, ..)| *distance <= closest + 1).map(|(.., name)| name.to_string());
    let mut offered: Vec<String> = offered.take(MOST_OFFERED).collect();
    if offered.is_empty() {
        offered.extend(first);
    }
    offered
}

/// The number of letters to insert, delete, replace or swap between two words.
fn letters_apart(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().take(64).collect(), b.chars().take(64).collect());
    let mut rows = vec![vec![0usize; b.len() + 1]; a.len() + 1];
    for (i, row) in rows.iter_mut().enumerate() {
        row[0] = i;
    }
    for j in 0..=b.len() {
        rows[0][j] = j;
    }
    for i in 1..=a.len() {
        for j in 1..=b.len() {
            let change = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = change.min(rows[i - 1][j] + 1).min(rows[i][j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            rows[i][j] = best;
        }
    }
    rows[a.len()][b.len()]
}
