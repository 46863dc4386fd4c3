//! Wavefront OBJ: vertices and polygons, line by line.
//!
//! Read are `v`, `f` (polygons cut into triangles; indices from 1, or negative from the end), `o` and `g` (groups of vertices). `vt`, `vn`, `vp`, `s`, `usemtl`,
//! `mtllib` and comments carry nothing for a body, but the `vt` and `vn` that faces name must be there; lines and points (`l`, `p`), and weights of
//! vertices, are counted and left out; all else is refused. A `\` at the end of a line
//! lets its statement go on in the next one.
//!
//! # Source
//! Wavefront Technologies, Object Files, version 3.0.

use super::triangles::{CORNERS, Places, Triangles};
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_math::words::counted;
use std::collections::BTreeMap;

/// A polygon as it stands in the file, before all vertices are known.
struct Face {
    line: u32,
    corners: (usize, usize),
    group: Option<usize>,
}

/// Reads the file.
///
/// # Errors
/// `obj.syntax`, `mesh.index`, `mesh.degenerate_face` with the line.
pub(super) fn read(source: &Source<'_>) -> Result<Triangles, SceneError> {
    let mut found = Triangles::default();
    let (mut faces, mut corners, mut names): (Vec<Face>, Vec<i64>, Vec<String>) = Default::default();
    // The number of each name of a group.
    let mut numbers: BTreeMap<String, usize> = BTreeMap::new();
    let mut group = None;
    let (mut strokes, mut weighed) = (0usize, 0usize);
    // How many `vt` and `vn` there are, and the largest that a face names with its place.
    let mut extras = [0i64; 2];
    let mut largest = [(0i64, 0usize, 0usize); 2];
    let mut start = 0;
    while start < source.text.len() {
        let (here, mut goes_on) = (start, true);
        while goes_on && start < source.text.len() {
            let piece = source.text[start..].split_inclusive('\n').next().unwrap_or("");
            start += piece.len();
            goes_on = statement(piece).1;
        }
        let line = &source.text[here..start];
        let mut words = line.split_inclusive('\n').flat_map(|piece| statement(piece).0.split_ascii_whitespace());
        let Some(word) = words.next() else { continue };
        let refuse = |part: &str, error: SceneError| {
            let from = here + (part.as_ptr() as usize - line.as_ptr() as usize);
            source.mark(error.value(visible(part)), from, from + part.len())
        };
        match word {
            "v" => {
                let mut position = [0.0; 3];
                for x in &mut position {
                    let Some(part) = words.next() else {
                        let error = SceneError::new("obj.syntax", "a vertex has fewer than three coordinates");
                        return Err(refuse(word, error).value(visible(statement(line).0.trim())).allowed("v x y z"));
                    };
                    *x = number(part).map_err(|e| refuse(part, e))?;
                }
                // A weight or a colour may follow.
                let more: Vec<&str> = words.collect();
                if more.len() > 4 {
                    let error = SceneError::new("obj.syntax", "a vertex has more than seven numbers");
                    return Err(refuse(more[4], error).allowed("v x y z, with a weight or a colour"));
                }
                if more.len() == 2 {
                    let error = SceneError::new("obj.syntax", "a vertex has five numbers");
                    let allowed = "3 numbers, 4 with a weight, 6 with a colour, 7 with both";
                    return Err(refuse(more[1], error).value(visible(statement(line).0.trim())).allowed(allowed));
                }
                let mut numbers = Vec::with_capacity(more.len());
                for part in more {
                    numbers.push(number(part).map_err(|e| refuse(part, e))?);
                }
                // Three more numbers are a colour.
                weighed += usize::from(numbers.len() % 3 == 1 && numbers[0] != 1.0);
                found.positions.push(position);
            }
            "f" => {
                let from = corners.len();
                for part in words {
                    let index = part.split('/').next().unwrap_or("");
                    let index: i64 = index.parse().map_err(|_| {
                        let error = SceneError::new("obj.syntax", "a corner of a face is no whole number");
                        refuse(part, error).allowed("v, v/vt, v//vn or v/vt/vn")
                    })?;
                    let count = found.positions.len() as i64;
                    if index == 0 || index < -count {
                        let message =
                            if index == 0 { "indices begin at 1" } else { "the index is before the first vertex" };
                        let error = SceneError::new("mesh.index", message);
                        return Err(refuse(part, error).allowed(format!("1 to {count}, or -{count} to -1")));
                    }
                    corners.push(if index < 0 { count + index } else { index - 1 });
                    for (k, text) in part.split('/').skip(1).enumerate() {
                        if text.is_empty() && k < 2 {
                            continue;
                        }
                        let index = text.parse::<i64>().ok().filter(|index| k < 2 && *index != 0);
                        let Some(index) = index else {
                            let error = SceneError::new("obj.syntax", "a corner of a face is no whole number");
                            return Err(refuse(part, error).allowed("v, v/vt, v//vn or v/vt/vn"));
                        };
                        // Those before the first cannot come any more.
                        let wanted = if index < -extras[k] { i64::MAX } else { index };
                        if wanted > largest[k].0 {
                            let from = here + (part.as_ptr() as usize - line.as_ptr() as usize);
                            largest[k] = (wanted, from, from + part.len());
                        }
                    }
                }
                faces.push(Face { line: here as u32, corners: (from, corners.len()), group });
            }
            "o" | "g" => {
                let name = words.collect::<Vec<_>>().join(" ");
                group = (!name.is_empty()).then(|| {
                    *numbers.entry(name).or_insert_with_key(|name| {
                        names.push(name.clone());
                        names.len() - 1
                    })
                });
            }
            "l" | "p" => strokes += 1,
            "vt" => extras[0] += 1,
            "vn" => extras[1] += 1,
            "vp" | "s" | "usemtl" | "mtllib" | "usemap" | "maplib" => {}
            _ => {
                let error =
                    SceneError::new("obj.syntax", format!("`{}` is no statement that is read here", visible(word)));
                return Err(refuse(word, error).allowed("v, vt, vn, vp, f, l, p, o, g, s, usemtl, mtllib, # comments"));
            }
        }
    }
    if strokes > 0 {
        let notice = SceneError::new(
            "mesh.strokes",
            format!("{} left out", counted(strokes as u64, "line or point is", "lines and points are")),
        );
        found.notices.push(notice.value(strokes.to_string()));
    }
    if weighed > 0 {
        let what = if weighed == 1 { "vertex has a weight" } else { "vertices have weights" };
        let message = format!("{weighed} {what} other than 1, which triangles do not have");
        found.notices.push(SceneError::new("obj.weight", message).value(weighed.to_string()));
    }
    for (k, name) in ["vt", "vn"].into_iter().enumerate() {
        let (index, from, to) = largest[k];
        if index > extras[k] {
            let error = SceneError::new("mesh.index", format!("a face names a `{name}` that is not there"));
            let error = source.mark(error, from, to).value(visible(&source.text[from..to]));
            let count = extras[k];
            let allowed = if count == 0 {
                format!("no `{name}`: the file has none")
            } else {
                format!("1 to {count}, or -{count} to -1")
            };
            return Err(error.allowed(allowed));
        }
    }
    let mut lines = Vec::with_capacity(faces.len());
    let mut groups: Vec<Vec<u32>> = vec![Vec::new(); names.len()];
    let count = found.positions.len();
    for face in faces {
        let at = face.line as usize;
        let end = source.text[at..].find(['\n', '\r', '#']).map_or(source.text.len(), |k| at + k);
        let own = &corners[face.corners.0..face.corners.1];
        if let Some(far) = own.iter().find(|c| **c >= count as i64) {
            let error =
                SceneError::new("mesh.index", format!("there is no vertex {}", far + 1)).value((far + 1).to_string());
            return Err(source.mark(error, at, end).allowed(format!("1 to {count}")));
        }
        let own: Vec<u32> = own.iter().map(|c| *c as u32).collect();
        match found.polygon(&own) {
            Ok(n) => lines.extend(std::iter::repeat_n(face.line, n)),
            Err(why) => {
                let value = visible(source.text[at..end].trim());
                let error = source.mark(SceneError::new("mesh.degenerate_face", why), at, end).value(value);
                return Err(error.allowed(CORNERS));
            }
        }
        if let Some(group) = face.group {
            groups[group].extend(own);
        }
    }
    for (name, mut nodes) in names.into_iter().zip(groups) {
        nodes.sort_unstable();
        nodes.dedup();
        if !nodes.is_empty() {
            found.groups.insert(name, nodes);
        }
    }
    found.places = Places::Lines(lines);
    Ok(found)
}

/// A line without its comment, and whether a `\` says that its statement goes on in the next one.
fn statement(line: &str) -> (&str, bool) {
    let Some((before, _)) = line.split_once('#') else {
        let text = line.trim_end_matches(['\n', '\r']);
        return text.strip_suffix('\\').map_or((text, false), |before| (before, true));
    };
    (before, false)
}

/// A finite number with a decimal point, whatever the language of the machine.
pub(super) fn number(text: &str) -> Result<f64, SceneError> {
    match text.parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        Ok(_) => Err(SceneError::new("scene.not_finite", "a coordinate is not finite").allowed("a finite number")),
        Err(_) => {
            let error = SceneError::new("shape.number", "this is no number").allowed("a number such as 1.5 or -2e-3");
            Err(if text.contains(',') { error.hint("write a point, not a comma") } else { error })
        }
    }
}
