//! Reads and writes mesh files of other programs: nodes, elements of all kinds, groups, and values of cells and nodes.
//!
//! ```text
//! .msh (Gmsh 2.2, 4.1) ─┐
//! .vtk, .vtu ───────────┤             ┌→ assemble → Mesh: cells, groups, values (a body)
//! .node + .ele (TetGen) ┼→ Found ─────┤
//! .mesh (MFEM, Medit) ──┘             └→ triangles of a surface, as from OBJ
//! ```
//! A reader returns the contents of its file, with nodes in Opruga's order, each with its position in the file. The requirements of bodies are
//! checked once for all formats. Nothing is dropped, merged or flipped unless the caller asks for it; these repairs are counted.

mod assemble;
mod errors;
mod format_errors;
mod found;
mod gmsh;
mod gmsh_2;
mod gmsh_4;
mod medit;
mod mfem;
mod scanner;
mod terms;
mod tetgen;
mod vtk;
mod vtk_errors;
mod vtk_numbers;
mod vtu;
mod write;

pub use assemble::Mending;
pub(crate) use errors::{MeshFileError, NumberHint};
pub(crate) use found::{Found, Kind};
pub(crate) use scanner::cut_line;
pub use write::{LeftOut, NotInFormat, WRITTEN, Written, endings, write};

use crate::problem::{SceneError, visible};
use found::Numbers;
use opruga_mesh::Mesh;
use scanner::Scanner;
use std::sync::Arc;

/// All messages about mesh files.
pub(crate) const MESSAGES: &[&[opruga_math::message::Variant]] = &[
    terms::ElementName::VARIANTS,
    terms::Expected::VARIANTS,
    errors::NumberHint::VARIANTS,
    errors::CornerOrder::VARIANTS,
    errors::NumberRange::VARIANTS,
    errors::Listed::VARIANTS,
    errors::Keyword::VARIANTS,
    errors::ScanError::VARIANTS,
    errors::MeshFileError::VARIANTS,
    errors::MeshFileNotice::VARIANTS,
    errors::EndingError::VARIANTS,
    write::LeftOut::VARIANTS,
    write::NotInFormat::VARIANTS,
    write::MeshWriteError::VARIANTS,
    format_errors::GmshError::VARIANTS,
    format_errors::MeditError::VARIANTS,
    format_errors::MfemError::VARIANTS,
    format_errors::Geometry::VARIANTS,
    format_errors::Counts::VARIANTS,
    format_errors::TetgenError::VARIANTS,
    vtk_errors::ArrayName::VARIANTS,
    vtk_errors::Doubled::VARIANTS,
    vtk_errors::VtkError::VARIANTS,
    vtk_errors::VtuError::VARIANTS,
];

/// Returns the bytes of a file by its name.
pub type Open<'o> = dyn FnMut(&str) -> Result<Arc<[u8]>, SceneError> + 'o;

/// The endings of the files that can be read.
pub const ENDINGS: &str = ".msh, .vtk, .vtu, .mesh, .mfem, .node, .ele";

/// A mesh file that has been read, but not yet made into a body.
#[derive(Debug)]
pub struct MeshFile<'a> {
    found: Found,
    scanner: Scanner<'a>,
    beside: Option<Beside>,
}

/// The second file of a TetGen mesh. Positions in messages may refer to this file.
#[derive(Debug)]
struct Beside {
    name: String,
    bytes: Arc<[u8]>,
    /// Whether this file holds the nodes rather than the elements.
    nodes: bool,
}

/// Whether a file of this name may hold a mesh.
pub fn is_mesh(name: &str) -> bool {
    matches!(ending(name).as_str(), "msh" | "vtk" | "vtu" | "mesh" | "mfem" | "node" | "ele")
}

fn ending(name: &str) -> String {
    name.rsplit_once('.').map_or("", |(_, ending)| ending).to_ascii_lowercase()
}

/// Reads a file according to its ending and its first words; `open` provides the second file of TetGen.
///
/// # Errors
/// `msh.…`, `vtk.…`, `vtu.…`, `tetgen.…`, `mfem.…`, `medit.…`, `mesh.…` with line or byte.
pub fn read<'a>(name: &'a str, bytes: &'a [u8], open: &mut Open<'_>) -> Result<MeshFile<'a>, SceneError> {
    let mut scanner = Scanner::new(name, bytes, None);
    if scanner.clone().is_done() {
        return Err(scanner.error(MeshFileError::Empty {}, 0));
    }
    let mut beside = None;
    let found = match ending(name).as_str() {
        "msh" => gmsh::read(&mut scanner)?,
        "vtk" => vtk::read(&mut scanner)?,
        "vtu" => {
            let found = vtu::read(name, bytes)?;
            // Positions in the text before the appended data are the same as in the file.
            scanner.binary = core::str::from_utf8(bytes).is_err();
            found
        }
        "mesh" | "mfem" => {
            scanner.comment = Some(b'#');
            match scanner.peek() {
                Some(("MFEM", _)) => mfem::read(&mut scanner)?,
                Some(("MeshVersionFormatted", _)) => medit::read(&mut scanner)?,
                other => {
                    let (word, from) = other.unwrap_or(("", 0));
                    return Err(scanner.error(MeshFileError::NeitherMfemNorMedit { word: visible(word) }, from));
                }
            }
        }
        kind @ ("node" | "ele") => {
            let (stem, _) = name.rsplit_once('.').unwrap_or((name, ""));
            let other = format!("{stem}.{}", if kind == "node" { "ele" } else { "node" });
            let more = open(&other)?;
            let (node_bytes, element_bytes) = if kind == "node" { (bytes, &*more) } else { (&*more, bytes) };
            let names = if kind == "node" { (name, other.as_str()) } else { (other.as_str(), name) };
            let mut nodes = Scanner::new(names.0, node_bytes, Some(b'#'));
            let mut elements = Scanner::new(names.1, element_bytes, Some(b'#'));
            let mut found = tetgen::nodes(&mut nodes)?;
            let numbers = Numbers::of(&found, &nodes)?;
            tetgen::elements(&mut elements, &mut found, &numbers)?;
            beside = Some(Beside { name: other, bytes: more, nodes: kind == "ele" });
            found
        }
        other => {
            let about = errors::EndingError::Unreadable { name: visible(name), ending: visible(other) };
            return Err(SceneError { file: name.to_string(), ..SceneError::of(about) });
        }
    };
    Ok(MeshFile { found, scanner, beside })
}

impl MeshFile<'_> {
    /// The dimension of the elements that fill the body: 1, 2 or 3; 0 without elements.
    pub fn dimension(&self) -> usize {
        self.found.items.iter().map(|item| item.kind.dimension()).max().unwrap_or(0)
    }

    /// Whether all nodes lie in one plane z = constant.
    pub fn is_plane(&self) -> bool {
        self.found.positions.windows(2).all(|pair| pair[0][2] == pair[1][2])
    }

    /// Makes the body; nodes keep their order. Also returns what was dropped or repaired, with counts.
    ///
    /// # Errors
    /// `mesh.empty`, `mesh.dimension`, `mesh.mixed_dimension`, `mesh.degenerate_element`, `mesh.duplicate_element`, `mesh.inverted`,
    /// `mesh.unreferenced`, `mesh.non_manifold`, with the position of the element or node.
    pub fn assemble<const D: usize>(self, mending: Mending) -> Result<(Mesh<D>, Vec<SceneError>), SceneError> {
        let other = self.beside.as_ref().map(|beside| Scanner::new(&beside.name, &beside.bytes, None));
        let (nodes, items) = match (&other, &self.beside) {
            (Some(other), Some(Beside { nodes: true, .. })) => (other, &self.scanner),
            (Some(other), _) => (&self.scanner, other),
            (None, _) => (&self.scanner, &self.scanner),
        };
        assemble::assemble(self.found, nodes, items, mending)
    }

    /// The contents of the file, for callers that need only its triangles.
    pub(crate) fn into_found(self) -> Found {
        self.found
    }
}
