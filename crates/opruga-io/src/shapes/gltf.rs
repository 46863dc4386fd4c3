//! glTF 2.0: the triangles of a scene, from a .gltf with its buffers or from one .glb.
//!
//! The reader takes meshes of triangles with positions in 32-bit numbers, from the node tree of one scene with its transforms. Materials, normals and
//! cameras are irrelevant for a body. Everything that would move the vertices (skins, morph targets and animations) is omitted, and so are other
//! scenes; all omissions are counted. Compressed or sparse data and other primitives are refused. Named nodes and meshes become groups.
//!
//! # Source
//! The Khronos Group, glTF 2.0 Specification (2021).

use super::Open;
use super::gltf_errors::{GltfError, GltfNotice};
use super::gltf_json::{Accessor, Asset, Buffer, Mesh, Node, Primitive, Root, View};
use super::json::{Raw, parse, refuse, span};
use super::surface_errors::{SurfaceError, SurfaceNotice};
use super::triangles::{Locations, Triangles};
use crate::base64;
use crate::budget::{INSTANCES, LimitHint};
use crate::problem::{SceneError, visible};
use crate::rounding::Stored;
use crate::source::Source;
use opruga_math::message::AnyMessage;
use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

/// The deepest nesting of nodes.
const DEEPEST: usize = 128;

/// The least number of bytes of a vertex or a triangle in a file.
const LEAST_BYTES: u64 = 3;

/// A mesh as it is drawn: its name, and its primitives with their locations.
struct Parts<'a> {
    name: Option<String>,
    primitives: Vec<(Raw<'a>, Primitive<'a>)>,
}

/// A row-major map of space: x′ = A x + b.
type Map = [[f64; 4]; 3];

const IDENTITY: Map = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0]];

fn after(outer: &Map, inner: &Map) -> Map {
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let moved = if j == 3 { outer[i][3] } else { 0.0 };
            (0..3).map(|k| outer[i][k] * inner[k][j]).sum::<f64>() + moved
        })
    })
}

struct Reader<'a, 's, 'o, 'f> {
    source: &'s Source<'s>,
    root: Root<'a>,
    buffers: Vec<Option<Arc<[u8]>>>,
    binary: Option<&'a [u8]>,
    open: &'o mut Open<'f>,
    found: Triangles,
    /// For every triangle, the byte of the text at which its primitive begins.
    starts: Vec<u32>,
    /// For every node, whether it has already occurred in the tree.
    placed: Vec<bool>,
    /// Meshes that have been read.
    meshes: BTreeMap<usize, Rc<Parts<'a>>>,
    /// The work so far: the number of rows of accessors that have been drawn, plus a share for texts that have been parsed again.
    drawn: u64,
    others: usize,
    /// Number of nodes whose vertices would follow bones.
    skinned: usize,
    /// Number of primitives with morph targets.
    morphed: usize,
}

/// Reads the triangles of the default scene, or of all meshes if there is no scene.
///
/// # Errors
/// `json.syntax`, `gltf.syntax`, `gltf.index`, `gltf.size`, `gltf.tree`, `gltf.unsupported`, `limit.instances` with the location in the JSON;
/// `mesh.index`; `scene.not_finite`.
pub(super) fn read<'a>(
    source: &'a Source<'a>,
    binary: Option<&'a [u8]>,
    open: &mut Open<'_>,
) -> Result<Triangles, SceneError> {
    let root: Root<'a> = parse(source, source.text)?;
    let asset: Asset = parse(source, root.asset.get())?;
    if asset.version != "2.0" {
        let version = visible(&asset.version);
        return Err(refuse(source, root.asset.get(), SceneError::of(GltfError::Version { version })));
    }
    if let Some(extension) =
        root.extensions.iter().find(|e| !e.starts_with("KHR_materials") && *e != "KHR_texture_transform")
    {
        let extension = visible(extension);
        return Err(refuse(source, root.asset.get(), SceneError::of(GltfError::Extension { extension })));
    }
    let buffers = vec![None; root.buffers.len()];
    let (nodes, meshes) = (root.nodes.len(), root.meshes.len());
    let start = match (root.scene, root.scenes.first()) {
        (Some(k), _) => root.scenes.get(k).map(|s| s.nodes.clone()),
        (None, Some(first)) => Some(first.nodes.clone()),
        (None, None) => None,
    };
    let (scenes, animations) = (root.scenes.len(), root.animations.len());
    let mut reader = Reader {
        source,
        root,
        buffers,
        binary,
        open,
        found: Triangles::default(),
        starts: Vec::new(),
        placed: vec![false; nodes],
        meshes: BTreeMap::new(),
        drawn: 0,
        others: 0,
        skinned: 0,
        morphed: 0,
    };
    match start {
        Some(start) => {
            for node in start {
                reader.node(node, &IDENTITY, 0)?;
            }
        }
        None if nodes > 0 => {
            return Err(refuse(source, reader.root.asset.get(), SceneError::of(GltfError::NoScene {})));
        }
        None => {
            for mesh in 0..meshes {
                reader.mesh(mesh, None, &IDENTITY)?;
            }
        }
    }
    let mut report = |count: usize, notice: fn(usize) -> AnyMessage| {
        if count > 0 {
            reader.found.notices.push(SceneError::of(notice(count)));
        }
    };
    report(reader.others, |count| SurfaceNotice::Strokes { count }.into());
    report(scenes.saturating_sub(1), |count| GltfNotice::Scenes { count }.into());
    report(reader.skinned, |count| GltfNotice::Skins { count }.into());
    report(reader.morphed, |count| GltfNotice::Morphs { count }.into());
    report(animations, |count| GltfNotice::Animations { count }.into());
    reader.found.locations = Locations::Lines(reader.starts);
    Ok(reader.found)
}

impl<'a> Reader<'a, '_, '_, '_> {
    /// An entry of a list, by number.
    fn entry(&self, list: &[Raw<'a>], index: usize, what: &'static str) -> Result<Raw<'a>, SceneError> {
        list.get(index).copied().ok_or_else(|| {
            let error = SceneError::of(GltfError::NoEntry { what, index, count: list.len() });
            refuse(self.source, self.root.asset.get(), error)
        })
    }

    /// An error at an object.
    fn refuse(&self, raw: Raw<'_>, error: impl Into<AnyMessage>) -> SceneError {
        refuse(self.source, raw.get(), SceneError::of(error))
    }

    fn node(&mut self, index: usize, map: &Map, depth: usize) -> Result<(), SceneError> {
        let raw = self.entry(&self.root.nodes, index, "node")?;
        // Otherwise a short list of nodes could represent an endless tree.
        if std::mem::replace(&mut self.placed[index], true) {
            return Err(self.refuse(raw, GltfError::Parents { node: index }));
        }
        if depth > DEEPEST {
            return Err(self.refuse(raw, GltfError::Depth { deepest: DEEPEST, node: index }));
        }
        let node: Node = parse(self.source, raw.get())?;
        let own = match node.matrix {
            // Matrices are stored column by column.
            Some(m) => core::array::from_fn(|i| core::array::from_fn(|j| m[4 * j + i])),
            None => {
                let t = node.translation.unwrap_or([0.0; 3]);
                let s = node.scale.unwrap_or([1.0; 3]);
                let [x, y, z, w] = node.rotation.unwrap_or([0.0, 0.0, 0.0, 1.0]);
                let r = [
                    [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
                    [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
                    [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
                ];
                core::array::from_fn(|i| core::array::from_fn(|j| if j == 3 { t[i] } else { r[i][j] * s[j] }))
            }
        };
        let map = after(map, &own);
        if let Some(mesh) = node.mesh {
            self.skinned += usize::from(node.skin.is_some());
            self.mesh(mesh, node.name.as_deref(), &map)?;
        }
        for child in node.children {
            self.node(child, &map, depth + 1)?;
        }
        Ok(())
    }

    fn mesh(&mut self, index: usize, name: Option<&str>, map: &Map) -> Result<(), SceneError> {
        let mesh = self.parts(index)?;
        let first = self.found.positions.len() as u32;
        for (raw, primitive) in &mesh.primitives {
            self.primitive(raw, primitive, map)?;
        }
        let nodes = first..self.found.positions.len() as u32;
        if let Some(name) = name.or(mesh.name.as_deref()).filter(|_| !nodes.is_empty()) {
            self.found.groups.entry(name.to_string()).or_default().extend(nodes);
        }
        Ok(())
    }

    /// A mesh, which is parsed only once.
    fn parts(&mut self, index: usize) -> Result<Rc<Parts<'a>>, SceneError> {
        if let Some(known) = self.meshes.get(&index) {
            return Ok(Rc::clone(known));
        }
        let raw = self.entry(&self.root.meshes, index, "mesh")?;
        let mesh: Mesh<'a> = parse(self.source, raw.get())?;
        let read = |raw: Raw<'a>| Ok((raw, parse::<Primitive<'a>>(self.source, raw.get())?));
        let primitives = mesh.primitives.into_iter().map(read).collect::<Result<_, SceneError>>()?;
        let parts = Rc::new(Parts { name: mesh.name, primitives });
        self.meshes.insert(index, Rc::clone(&parts));
        Ok(parts)
    }

    /// Counts rows that are drawn. The limit is the number of rows that the file can contain, plus an allowance for rows that are drawn repeatedly.
    fn draw(&mut self, more: u64, at: Raw<'_>) -> Result<(), SceneError> {
        self.drawn = self.drawn.saturating_add(more);
        let available: usize = self.buffers.iter().flatten().map(|bytes| bytes.len()).sum();
        let available = (available + self.source.text.len()) as u64 / LEAST_BYTES;
        INSTANCES
            .check_beside(self.drawn, available)
            .map_err(|e| refuse(self.source, at.get(), e.advice(LimitHint::Instances)))
    }

    fn primitive(&mut self, raw: Raw<'a>, primitive: &Primitive<'a>, map: &Map) -> Result<(), SceneError> {
        self.draw(1, raw)?;
        match primitive.mode {
            None | Some(4) => {}
            Some(0..=3) => {
                self.others += 1;
                return Ok(());
            }
            Some(mode) => {
                return Err(self.refuse(raw, GltfError::Mode { mode }));
            }
        }
        self.morphed += usize::from(!primitive.targets.is_empty());
        let Some(index) = primitive.attributes.get("POSITION") else {
            return Err(self.refuse(raw, GltfError::NoPosition {}));
        };
        let first = self.found.positions.len();
        let rows = self.accessor(*index, "VEC3", &[5126])?;
        for p in &rows {
            let q = core::array::from_fn(|i| (0..3).map(|k| map[i][k] * p[k]).sum::<f64>() + map[i][3]);
            if q.iter().any(|x: &f64| !x.is_finite()) {
                let (vertex, position) = (self.found.positions.len() - first, format!("{q:?}"));
                return Err(self.refuse(raw, GltfError::NotFinitePosition { vertex, position }));
            }
            self.found.positions.push(q);
        }
        let count = self.found.positions.len() - first;
        let indices: Vec<u32> = match primitive.indices {
            Some(index) => {
                self.accessor(index, "SCALAR", &[5121, 5123, 5125])?.into_iter().map(|row| row[0] as u32).collect()
            }
            None => (0..count as u32).collect(),
        };
        if !indices.len().is_multiple_of(3) {
            return Err(self.refuse(raw, GltfError::Corners { corners: indices.len() }));
        }
        // The rounding is estimated before the transforms of nodes are applied, because the file does not round their results.
        let stored = Stored::of(&rows, indices.chunks_exact(3), true);
        self.found.stored = Some(self.found.stored.unwrap_or_default().worse(stored));
        let start = span(self.source, raw.get()).0 as u32;
        // A map with a reflection inverts triangles.
        let det = map[0][0] * (map[1][1] * map[2][2] - map[1][2] * map[2][1])
            - map[0][1] * (map[1][0] * map[2][2] - map[1][2] * map[2][0])
            + map[0][2] * (map[1][0] * map[2][1] - map[1][1] * map[2][0]);
        for (k, corners) in indices.chunks_exact(3).enumerate() {
            if let Some(far) = corners.iter().find(|c| **c as usize >= count) {
                return Err(self.refuse(raw, SurfaceError::NoVertexOfTriangle { triangle: k, vertex: *far, count }));
            }
            let [a, b, c] = [corners[0], corners[1], corners[2]].map(|c| c + first as u32);
            if a == b || b == c || c == a {
                let corners = format!("{corners:?}");
                return Err(self.refuse(raw, SurfaceError::VertexTwice { triangle: k, corners }));
            }
            self.found.triangles.push(if det < 0.0 { [a, c, b] } else { [a, b, c] });
            self.starts.push(start);
        }
        Ok(())
    }

    /// The rows of an accessor: three numbers or one, depending on its kind.
    fn accessor(&mut self, index: usize, kind: &'static str, components: &[u32]) -> Result<Vec<[f64; 3]>, SceneError> {
        let source = self.source;
        let raw = self.entry(&self.root.accessors, index, "accessor")?;
        let bad = |error: GltfError| Err(refuse(source, raw.get(), SceneError::of(error)));
        let accessor: Accessor<'a> = parse(source, raw.get())?;
        if accessor.sparse.is_some() {
            return bad(GltfError::Sparse {});
        }
        if accessor.kind != kind || !components.contains(&accessor.component) {
            let (found, component, components) =
                (visible(&accessor.kind), accessor.component, format!("{components:?}"));
            return bad(GltfError::Accessor { kind: found, component, wanted: kind, components });
        }
        let Some(view) = accessor.view else {
            return bad(GltfError::NoView {});
        };
        let view_raw = self.entry(&self.root.views, view, "bufferView")?;
        let view: View = parse(source, view_raw.get())?;
        let bytes = self.buffer(view.buffer)?;
        let size: u64 = match accessor.component {
            5121 => 1,
            5123 => 2,
            _ => 4,
        };
        let each = if kind == "VEC3" { 3 * size } else { size };
        let stride = view.stride.unwrap_or(each);
        // The size is compared with the number of bytes present before anything is allocated.
        let within = || {
            let last =
                accessor.count.checked_sub(1)?.checked_mul(stride)?.checked_add(each)?.checked_add(accessor.offset)?;
            let end = view.offset.checked_add(view.length)?;
            (last <= view.length && end <= bytes.len() as u64 && stride >= each).then_some(())
        };
        if within().is_none() {
            return bad(GltfError::Rows { rows: accessor.count, each, bytes: bytes.len() });
        }
        // The description of the accessor is parsed again, too.
        self.draw(accessor.count + (raw.get().len() + view_raw.get().len()) as u64 / 64, raw)?;
        let start = (view.offset + accessor.offset) as usize;
        let rows = (0..accessor.count as usize).map(|k| {
            let row = &bytes[start + k * stride as usize..];
            core::array::from_fn(|axis| {
                let at = axis * size as usize;
                match (accessor.component, axis) {
                    (5121, 0) => f64::from(row[0]),
                    (5123, 0) => f64::from(u16::from_le_bytes([row[0], row[1]])),
                    (5125, 0) => f64::from(u32::from_le_bytes([row[0], row[1], row[2], row[3]])),
                    (5126, _) => f64::from(f32::from_le_bytes([row[at], row[at + 1], row[at + 2], row[at + 3]])),
                    _ => 0.0,
                }
            })
        });
        Ok(rows.collect())
    }

    /// The bytes of a buffer: the chunk of a .glb, a data URI, or a file next to the scene.
    fn buffer(&mut self, index: usize) -> Result<Arc<[u8]>, SceneError> {
        let source = self.source;
        let raw = self.entry(&self.root.buffers, index, "buffer")?;
        if let Some(Some(bytes)) = self.buffers.get(index) {
            return Ok(Arc::clone(bytes));
        }
        let buffer: Buffer = parse(source, raw.get())?;
        let bad = |error: GltfError| Err(refuse(source, raw.get(), SceneError::of(error)));
        let bytes: Arc<[u8]> = match (&buffer.uri, self.binary) {
            (None, Some(binary)) if index == 0 => Arc::from(binary),
            (None, _) => return bad(GltfError::NoBytes {}),
            (Some(uri), _) if uri.starts_with("data:") => {
                match uri.split_once(";base64,").and_then(|(_, t)| base64::decode(t.as_bytes())) {
                    Some(bytes) => bytes.into(),
                    None => return bad(GltfError::Base64 {}),
                }
            }
            // The path is relative to the glTF file, and follows the rules for all files of a scene.
            (Some(uri), _) => {
                let folder = source.file.rsplit_once('/').map_or(String::new(), |(folder, _)| format!("{folder}/"));
                (self.open)(&format!("{folder}{uri}"))?
            }
        };
        if (bytes.len() as u64) < buffer.length {
            return bad(GltfError::Buffer { promised: buffer.length, bytes: bytes.len() });
        }
        self.buffers[index] = Some(Arc::clone(&bytes));
        Ok(bytes)
    }
}
