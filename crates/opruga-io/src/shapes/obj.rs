//! Wavefront OBJ: vertices and polygons, line by line.
//!
//! Read are `v`, `f` (polygons cut into triangles; indices from 1, or negative from the end), `o` and `g` (groups of vertices). `vt`, `vn`, `vp`, `s`, `usemtl`,
//! `mtllib` and comments carry nothing for a body, but the `vt` and `vn` that faces name must be there; lines and points (`l`, `p`), and weights of
//! vertices, are counted and left out; all else is refused. A `\` at the end of a line
//! lets its statement go on in the next one.
//!
//! # Source
//! Wavefront Technologies, Object Files, version 3.0.

use super::surface_errors::{ObjError, ObjNotice, SurfaceNotice};
use super::triangles::{Places, Triangles};
use crate::meshes::NumberHint;
use crate::problem::{SceneError, visible};
use crate::source::Source;
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
                        let error = refuse(word, SceneError::of(ObjError::FewCoordinates {}));
                        return Err(error.value(visible(statement(line).0.trim())));
                    };
                    *x = number(part).map_err(|e| refuse(part, e))?;
                }
                // A weight or a colour may follow.
                let more: Vec<&str> = words.collect();
                if more.len() > 4 {
                    return Err(refuse(more[4], SceneError::of(ObjError::ManyNumbers {})));
                }
                if more.len() == 2 {
                    let error = refuse(more[1], SceneError::of(ObjError::FiveNumbers {}));
                    return Err(error.value(visible(statement(line).0.trim())));
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
                    let corner = || refuse(part, SceneError::of(ObjError::Corner {}));
                    let index: i64 = index.parse().map_err(|_| corner())?;
                    let count = found.positions.len() as i64;
                    if index == 0 || index < -count {
                        let zero = index == 0;
                        let error = if zero { ObjError::Zero { count } } else { ObjError::BeforeFirst { count } };
                        return Err(refuse(part, SceneError::of(error)));
                    }
                    corners.push(if index < 0 { count + index } else { index - 1 });
                    for (k, text) in part.split('/').skip(1).enumerate() {
                        if text.is_empty() && k < 2 {
                            continue;
                        }
                        let index = text.parse::<i64>().ok().filter(|index| k < 2 && *index != 0);
                        let Some(index) = index else { return Err(corner()) };
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
                return Err(refuse(word, SceneError::of(ObjError::Statement { word: visible(word) })));
            }
        }
    }
    if strokes > 0 {
        found.notices.push(SceneError::of(SurfaceNotice::Strokes { count: strokes }));
    }
    if weighed > 0 {
        found.notices.push(SceneError::of(ObjNotice::Weights { count: weighed }));
    }
    for (k, name) in ["vt", "vn"].into_iter().enumerate() {
        let (index, from, to) = largest[k];
        if index > extras[k] {
            let error = match extras[k] {
                0 => ObjError::NoExtras { what: name },
                count => ObjError::NoExtra { what: name, count },
            };
            return Err(source.mark(SceneError::of(error), from, to).value(visible(&source.text[from..to])));
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
            let error = SceneError::of(ObjError::NoVertexOfFile { vertex: far + 1, count });
            return Err(source.mark(error, at, end));
        }
        let own: Vec<u32> = own.iter().map(|c| *c as u32).collect();
        match found.polygon(&own) {
            Ok(n) => lines.extend(std::iter::repeat_n(face.line, n)),
            Err(problem) => {
                let value = visible(source.text[at..end].trim());
                return Err(source.mark(SceneError::of(problem), at, end).value(value));
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
        Ok(_) => Err(SceneError::of(ObjError::NotFiniteNumberOfVertex {})),
        Err(_) if text.contains(',') => Err(SceneError::of(ObjError::NoNumber {}).advice(NumberHint::Comma)),
        Err(_) => Err(SceneError::of(ObjError::NoNumber {})),
    }
}
