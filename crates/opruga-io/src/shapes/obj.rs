//! Wavefront OBJ: vertices and polygons, line by line.
//!
//! Read are `v`, `f` (polygons as fans; indices from 1, or negative from the end), `o` and `g` (groups of vertices). `vt`, `vn`, `vp`, `s`, `usemtl`,
//! `mtllib` and comments carry nothing for a body; lines and points (`l`, `p`) are counted and left out; all else is refused.
//!
//! # Source
//! Wavefront Technologies, Object Files, version 3.0.

use super::triangles::{Places, Triangles};
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_math::words::counted;

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
    let mut group = None;
    let mut strokes = 0usize;
    let mut start = 0;
    for line in source.text.split_inclusive('\n') {
        let here = start;
        start += line.len();
        let text = line.split('#').next().unwrap_or("");
        let mut words = text.split_ascii_whitespace();
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
                        return Err(refuse(word, error).value(visible(text.trim())).allowed("v x y z"));
                    };
                    *x = number(part).map_err(|e| refuse(part, e))?;
                }
                // A weight or a colour may follow.
                let more: Vec<&str> = words.collect();
                if more.len() > 4 {
                    let error = SceneError::new("obj.syntax", "a vertex has more than seven numbers");
                    return Err(refuse(more[4], error).allowed("v x y z, with a weight or a colour"));
                }
                for part in more {
                    number(part).map_err(|e| refuse(part, e))?;
                }
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
                }
                faces.push(Face { line: here as u32, corners: (from, corners.len()), group });
            }
            "o" | "g" => {
                let name = words.collect::<Vec<_>>().join(" ");
                group = (!name.is_empty()).then(|| {
                    names.iter().position(|n| *n == name).unwrap_or_else(|| {
                        names.push(name);
                        names.len() - 1
                    })
                });
            }
            "l" | "p" => strokes += 1,
            "vt" | "vn" | "vp" | "s" | "usemtl" | "mtllib" | "usemap" | "maplib" => {}
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
                return Err(
                    error.allowed("at least three different corners, around which a fan of triangles turns one way")
                );
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
