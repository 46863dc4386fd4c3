//! STL: triangles with separate corners, as text or as bytes.
//!
//! A file is binary if it has the size that its header announces, or if it cannot be text. The order of the corners determines which side of a
//! triangle is outside; normals in the file that are not numbers or that contradict this order are counted. Vertices at the same position are merged,
//! because in this format triangles cannot share vertices.
//!
//! # Source
//! 3D Systems, StereoLithography Interface Specification (1989).

use super::obj::number;
use super::surface_errors::{StlError, StlNotice, SurfaceError};
use super::triangles::{Locations, Triangles};
use crate::problem::{SceneError, visible};
use crate::source::Source;

/// Header and count.
const HEAD: usize = 84;
/// A normal, three corners, two spare bytes.
const EACH: usize = 50;

/// Whether the bytes are a binary STL file, complete or truncated.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(HEAD)];
    promised(bytes).is_some_and(|size| size == bytes.len() as u64)
        || !bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        || head.contains(&0)
}

/// The size that the header announces.
fn promised(bytes: &[u8]) -> Option<u64> {
    let count = bytes.get(80..HEAD)?.first_chunk::<4>()?;
    Some(HEAD as u64 + EACH as u64 * u64::from(u32::from_le_bytes(*count)))
}

/// Reads a binary file.
///
/// # Errors
/// `stl.size` before anything is allocated; `scene.not_finite` with the byte.
pub(super) fn read_binary(bytes: &[u8]) -> Result<Triangles, SceneError> {
    match promised(bytes) {
        Some(size) if size == bytes.len() as u64 => {}
        Some(size) => {
            let (triangles, length) = ((size - HEAD as u64) / EACH as u64, bytes.len());
            return Err(SceneError::of(StlError::Promised { triangles, length, promised: size }));
        }
        None => return Err(SceneError::of(StlError::Short { length: bytes.len() })),
    }
    let count = (bytes.len() - HEAD) / EACH;
    let mut found = Triangles {
        soup: true,
        single: true,
        locations: Locations::Bytes { first: HEAD, each: EACH },
        ..Triangles::default()
    };
    found.positions.reserve_exact(3 * count);
    found.triangles.reserve_exact(count);
    let mut normals = Normals::default();
    for (k, record) in bytes[HEAD..].chunks_exact(EACH).enumerate() {
        for (corner, field) in record[12..48].chunks_exact(12).enumerate() {
            let mut position = [0.0; 3];
            for (axis, word) in field.chunks_exact(4).enumerate() {
                let x = f32::from_le_bytes([word[0], word[1], word[2], word[3]]);
                if !x.is_finite() {
                    let byte = HEAD + EACH * k + 12 + 12 * corner + 4 * axis;
                    let error = SceneError::of(SurfaceError::NotFiniteCoordinate { value: x.to_string() });
                    return Err(SceneError { byte: Some(byte), ..error });
                }
                position[axis] = f64::from(x);
            }
            found.positions.push(position);
        }
        let first = 3 * k as u32;
        found.triangles.push([first, first + 1, first + 2]);
        let float =
            |d: usize| f32::from_le_bytes([record[4 * d], record[4 * d + 1], record[4 * d + 2], record[4 * d + 3]]);
        normals.compare([0, 1, 2].map(|d| f64::from(float(d))), &found.positions);
    }
    found.notices.extend(normals.notices());
    Ok(found)
}

/// Normals that contradict the corners.
#[derive(Default)]
struct Normals {
    /// The number of normals that are not numbers.
    broken: usize,
    /// The number of normals on the opposite side.
    against: usize,
}

impl Normals {
    /// Compares a normal with the triangle of the last three corners; a normal of length zero is ignored.
    fn compare(&mut self, normal: [f64; 3], positions: &[[f64; 3]]) {
        let [.., a, b, c] = positions else { return };
        if normal.iter().any(|x| !x.is_finite()) {
            self.broken += 1;
            return;
        }
        let (u, v) = ([0, 1, 2].map(|d| b[d] - a[d]), [0, 1, 2].map(|d| c[d] - a[d]));
        let own = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        self.against += usize::from((0..3).map(|d| own[d] * normal[d]).sum::<f64>() < 0.0);
    }

    fn notices(&self) -> Vec<SceneError> {
        let broken = (self.broken > 0).then_some(StlNotice::Broken { count: self.broken });
        let against = (self.against > 0).then_some(StlNotice::Against { count: self.against });
        broken.into_iter().chain(against).map(SceneError::of).collect()
    }
}

/// Reads a text file.
///
/// # Errors
/// `stl.syntax` with the line.
pub(super) fn read_text(source: &Source<'_>) -> Result<Triangles, SceneError> {
    let mut found = Triangles { soup: true, ..Triangles::default() };
    let mut lines = Vec::new();
    // The expected sequence: solid, facet, outer loop, three vertices, endloop, endfacet, and facet or endsolid.
    let mut state = "solid";
    let (mut corners, mut begun) = (0u32, 0usize);
    let (mut normals, mut normal) = (Normals::default(), [0.0; 3]);
    let mut start = 0;
    for line in source.text.split_inclusive('\n') {
        let here = start;
        start += line.len();
        let text = line.trim();
        if text.is_empty() {
            continue;
        }
        let mut words = text.split_ascii_whitespace();
        let (first, second) = (words.next().unwrap_or(""), text.split_ascii_whitespace().nth(1).unwrap_or(""));
        let from = here + (text.as_ptr() as usize - line.as_ptr() as usize);
        let refuse = |error: SceneError| source.mark(error, from, from + text.len());
        let lower = first.to_ascii_lowercase();
        let next = match (state, lower.as_str(), second.to_ascii_lowercase().as_str()) {
            ("solid", "solid", _) => "facet",
            ("facet", "facet", _) => {
                begun = here;
                normal = [0.0; 3];
                for (x, part) in normal.iter_mut().zip(text.split_ascii_whitespace().skip(2)) {
                    // A word that is not a number is reported like NaN.
                    *x = part.parse().unwrap_or(f64::NAN);
                }
                "outer loop"
            }
            ("facet", "endsolid", _) => "solid",
            ("outer loop", "outer", "loop") => {
                corners = 0;
                "vertex"
            }
            ("vertex", "vertex", _) if corners < 3 => {
                let mut position = [0.0; 3];
                let mut count = 0;
                for part in words {
                    let at = here + (part.as_ptr() as usize - line.as_ptr() as usize);
                    let x = number(part).map_err(|e| source.mark(e.value(visible(part)), at, at + part.len()))?;
                    if count < 3 {
                        position[count] = x;
                    }
                    count += 1;
                }
                if count != 3 {
                    return Err(refuse(SceneError::of(StlError::Coordinates { count })));
                }
                found.positions.push(position);
                corners += 1;
                if corners == 3 { "endloop" } else { "vertex" }
            }
            ("endloop", "endloop", _) => "endfacet",
            ("endfacet", "endfacet", _) => {
                let n = found.positions.len() as u32;
                found.triangles.push([n - 3, n - 2, n - 1]);
                normals.compare(normal, &found.positions);
                lines.push(begun as u32);
                "facet"
            }
            _ => {
                let line = visible(text);
                return Err(refuse(SceneError::of(match state {
                    "facet" => StlError::NoFacet { line },
                    wanted => StlError::Other { line, wanted },
                })));
            }
        };
        state = next;
    }
    if state != "solid" {
        let end = source.text.trim_end().len();
        let wanted = if state == "facet" { "endsolid" } else { state };
        return Err(source.mark(SceneError::of(StlError::Ends { wanted }), end, end));
    }
    found.notices.extend(normals.notices());
    found.locations = Locations::Lines(lines);
    Ok(found)
}
