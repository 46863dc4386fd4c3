//! Whole runs in one file: point caches of Blender and others (PC2, MDD), and glTF with one morph target per frame.
//!
//! A point cache contains only positions. Such a cache needs a mesh with the same nodes in the same order, such as a frame of the OBJ series. A glTF
//! file includes the surface.

use opruga_mesh::triangle_parts;
use opruga_world::AnyBody;
use serde_json::{Value, json};
use std::io::{self, Write};

/// The positions of the nodes of one body, frame by frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Track {
    /// Name of the body.
    pub name: String,
    /// Number of nodes.
    pub nodes: usize,
    /// The triangles of the body's surface, facing outward.
    pub triangles: Vec<[u32; 3]>,
    /// The wires of the body, and its outlines in the plane.
    pub lines: Vec<[u32; 2]>,
    /// Times of the frames [s].
    pub times: Vec<f32>,
    /// Positions of all nodes, frame by frame [m]; z is zero in the plane.
    pub positions: Vec<[f32; 3]>,
}

impl Track {
    /// A body without frames.
    pub fn new(body: &dyn AnyBody) -> Track {
        let cells = body.cells();
        let mut track = Track { name: body.name().to_string(), nodes: body.nodes(), ..Track::default() };
        if body.dimension() == 3 {
            track.triangles.extend(body.facets().as_chunks().0);
        } else {
            track.triangles.extend(&cells.triangles);
            for &[a, b, c, d] in &cells.quadrilaterals {
                track.triangles.extend([[a, b, c], [a, c, d]]);
            }
            track.triangles.extend(cells.quadratic_triangles.iter().flat_map(triangle_parts));
            if track.triangles.is_empty() {
                track.lines.extend(body.facets().as_chunks().0);
            }
        }
        track.triangles.extend(body.sheets());
        track.lines.extend(body.wires());
        track
    }

    /// Adds a frame; a frame with another number of nodes is ignored.
    pub fn add(&mut self, time: f64, positions: &[[f64; 3]]) {
        if positions.len() == self.nodes {
            self.times.push(time as f32);
            self.positions.extend(positions.iter().map(|x| x.map(|c| c as f32)));
        }
    }

    /// The memory of the frames [bytes].
    pub fn bytes(&self) -> usize {
        12 * self.positions.len()
    }

    /// Writes a PC2 point cache that begins at frame 0 and has one sample per frame.
    ///
    /// # Errors
    /// The errors of the writer.
    ///
    /// # Source
    /// The point cache of 3ds Max as Blender's modifier Mesh Cache reads it: `POINTCACHE2`, version 1, points, first frame, sample rate, samples.
    pub fn write_pc2(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(b"POINTCACHE2\0")?;
        out.write_all(&1i32.to_le_bytes())?;
        out.write_all(&(self.nodes as i32).to_le_bytes())?;
        out.write_all(&0f32.to_le_bytes())?;
        out.write_all(&1f32.to_le_bytes())?;
        out.write_all(&(self.times.len() as i32).to_le_bytes())?;
        for x in self.positions.iter().flatten() {
            out.write_all(&x.to_le_bytes())?;
        }
        Ok(())
    }

    /// Writes the motion file MDD: times and positions, big-endian.
    ///
    /// # Errors
    /// The errors of the writer.
    ///
    /// # Source
    /// LightWave motion designer, as Blender's modifier Mesh Cache reads it.
    pub fn write_mdd(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(&(self.times.len() as i32).to_be_bytes())?;
        out.write_all(&(self.nodes as i32).to_be_bytes())?;
        for x in self.times.iter().chain(self.positions.iter().flatten()) {
            out.write_all(&x.to_be_bytes())?;
        }
        Ok(())
    }
}

/// The bytes of a glTF file and the descriptions of their parts.
#[derive(Default)]
struct Binary {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Binary {
    /// Adds numbers and returns their accessor.
    fn add(&mut self, bytes: &[u8], component: u32, kind: &str, count: usize, target: Option<u32>) -> usize {
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes.len(), "byteLength": bytes.len()});
        if let Some(target) = target {
            view["target"] = json!(target);
        }
        self.bytes.extend_from_slice(bytes);
        self.accessors
            .push(json!({"bufferView": self.views.len(), "componentType": component, "count": count, "type": kind}));
        self.views.push(view);
        self.accessors.len() - 1
    }

    fn floats(&mut self, values: &[f32], kind: &str, count: usize, target: Option<u32>) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        self.add(&bytes, 5126, kind, count, target)
    }

    /// Adds vectors with the bounds that glTF requires for positions.
    fn vectors(&mut self, values: &[[f32; 3]]) -> usize {
        let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for x in values {
            for d in 0..3 {
                low[d] = if x[d] < low[d] { x[d] } else { low[d] };
                high[d] = if x[d] > high[d] { x[d] } else { high[d] };
            }
        }
        let accessor = self.floats(values.as_flattened(), "VEC3", values.len(), Some(34962));
        self.accessors[accessor]["min"] = json!(low);
        self.accessors[accessor]["max"] = json!(high);
        accessor
    }
}

/// Writes bodies as binary glTF 2.0 (`.glb`). Each body is a mesh whose frames are morph targets, played one after the other by an animation.
///
/// # Errors
/// The errors of the writer; `InvalidInput` if the file would exceed 4 GiB, the limit of the format.
///
/// # Source
/// Khronos Group, glTF 2.0 specification, sections 3.7.2.2 (morph targets), 3.11 (animations), 4.4 (binary).
pub fn write_glb(out: &mut dyn Write, title: &str, tracks: &[Track]) -> io::Result<()> {
    let mut binary = Binary::default();
    let (mut meshes, mut nodes, mut samplers, mut channels) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for track in tracks.iter().filter(|track| !track.times.is_empty() && track.nodes > 0) {
        let frames: Vec<&[[f32; 3]]> = track.positions.chunks_exact(track.nodes).collect();
        let base = binary.vectors(frames[0]);
        // Targets contain displacements from the first frame.
        let mut targets = Vec::new();
        for frame in &frames[1..] {
            let moved: Vec<[f32; 3]> =
                frame.iter().zip(frames[0]).map(|(x, rest)| core::array::from_fn(|d| x[d] - rest[d])).collect();
            targets.push(json!({"POSITION": binary.vectors(&moved)}));
        }
        let mut primitives = Vec::new();
        for (mode, indices) in [(4, track.triangles.as_flattened()), (1, track.lines.as_flattened())] {
            if !indices.is_empty() {
                let bytes: Vec<u8> = indices.iter().flat_map(|x| x.to_le_bytes()).collect();
                let accessor = binary.add(&bytes, 5125, "SCALAR", indices.len(), Some(34963));
                let mut primitive = json!({"attributes": {"POSITION": base}, "indices": accessor, "mode": mode});
                if !targets.is_empty() {
                    primitive["targets"] = json!(targets);
                }
                primitives.push(primitive);
            }
        }
        if primitives.is_empty() {
            primitives.push(json!({"attributes": {"POSITION": base}, "mode": 0, "targets": targets}));
        }
        let mut mesh = json!({"name": track.name, "primitives": primitives});
        if !targets.is_empty() {
            mesh["weights"] = json!(vec![0; targets.len()]);
            // In frame k only target k − 1 has weight; between frames, glTF interpolates between two targets.
            let mut weights = vec![0f32; frames.len() * targets.len()];
            for k in 1..frames.len() {
                weights[k * targets.len() + k - 1] = 1.0;
            }
            let input = binary.floats(&track.times, "SCALAR", track.times.len(), None);
            binary.accessors[input]["min"] = json!([track.times[0]]);
            binary.accessors[input]["max"] = json!([track.times[track.times.len() - 1]]);
            let output = binary.floats(&weights, "SCALAR", weights.len(), None);
            channels.push(json!({"sampler": samplers.len(), "target": {"node": nodes.len(), "path": "weights"}}));
            samplers.push(json!({"input": input, "output": output, "interpolation": "LINEAR"}));
        }
        nodes.push(json!({"name": track.name, "mesh": meshes.len()}));
        meshes.push(mesh);
    }
    let mut root = json!({
        "asset": {"version": "2.0", "generator": concat!("opruga ", env!("CARGO_PKG_VERSION"))},
        "scene": 0,
        "scenes": [{"name": title, "nodes": (0..nodes.len()).collect::<Vec<usize>>()}],
    });
    for (key, list) in
        [("nodes", nodes), ("meshes", meshes), ("accessors", binary.accessors), ("bufferViews", binary.views)]
    {
        if !list.is_empty() {
            root[key] = Value::Array(list);
        }
    }
    if !channels.is_empty() {
        root["animations"] = json!([{"name": "run", "channels": channels, "samplers": samplers}]);
    }
    if !binary.bytes.is_empty() {
        root["buffers"] = json!([{"byteLength": binary.bytes.len()}]);
    }

    // Chunks are padded to multiples of four bytes.
    let mut text = serde_json::to_vec(&root)?;
    text.resize(text.len().next_multiple_of(4), b' ');
    binary.bytes.resize(binary.bytes.len().next_multiple_of(4), 0);
    let whole = 12 + 8 + text.len() + 8 + binary.bytes.len();
    let too_large = || {
        io::Error::new(io::ErrorKind::InvalidInput, format!("glTF holds 4 GiB, not {whole} bytes: take fewer frames"))
    };
    let length = |bytes: usize| u32::try_from(bytes).map_err(|_| too_large());
    for word in [0x4654_6c67, 2, length(whole)?, length(text.len())?, 0x4e4f_534a] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(&text)?;
    for word in [length(binary.bytes.len())?, 0x004e_4942] {
        out.write_all(&word.to_le_bytes())?;
    }
    out.write_all(&binary.bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use opruga_mesh::Mesh;
    use opruga_world::blueprint::{BodyBlueprint, Mass};

    fn track() -> Track {
        let mesh = Mesh::<3> {
            positions: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            sheets: vec![[0, 1, 2]],
            ..Mesh::default()
        };
        let cloth = BodyBlueprint::new("cloth", mesh, Mass::Total(1.0), Vec::new());
        let mut track = Track::new(&cloth);
        track.add(0.0, &cloth.mesh.positions);
        track.add(0.5, &[[0.0, 0.0, 0.25], [1.0, 0.0, 0.25], [0.0, 1.0, 0.25]]);
        track
    }

    #[test]
    fn point_caches_hold_their_heads_and_every_position() {
        let mut pc2 = Vec::new();
        track().write_pc2(&mut pc2).unwrap();
        assert_eq!(&pc2[..12], b"POINTCACHE2\0");
        assert_eq!(pc2.len(), 32 + 2 * 3 * 12);
        let word = |k: usize| i32::from_le_bytes(pc2[k..k + 4].try_into().unwrap());
        assert_eq!((word(12), word(16), word(28)), (1, 3, 2));
        assert_eq!(pc2[pc2.len() - 4..], 0.25f32.to_le_bytes());
        let mut mdd = Vec::new();
        track().write_mdd(&mut mdd).unwrap();
        assert_eq!(mdd.len(), 8 + 2 * 4 + 2 * 3 * 12);
        assert_eq!(
            mdd[..16],
            [&2i32.to_be_bytes()[..], &3i32.to_be_bytes(), &0f32.to_be_bytes(), &0.5f32.to_be_bytes()].concat()
        );
    }

    /// The requirements of glTF for sizes, offsets and counts.
    #[test]
    fn gltf_is_whole_and_its_weights_choose_one_target_a_frame() {
        let mut glb = Vec::new();
        write_glb(&mut glb, "scene", &[track()]).unwrap();
        let word = |k: usize| u32::from_le_bytes(glb[k..k + 4].try_into().unwrap()) as usize;
        assert_eq!((&glb[..4], word(4), word(8)), (&b"glTF"[..], 2, glb.len()));
        let text = word(12);
        let root: Value = serde_json::from_slice(&glb[20..20 + text]).unwrap();
        let bytes = &glb[28 + text..];
        assert_eq!(word(20 + text), bytes.len());
        let numbers = |accessor: &Value| -> Vec<f32> {
            let accessor = &root["accessors"][accessor.as_u64().unwrap() as usize];
            let view = &root["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
            let (at, length) =
                (view["byteOffset"].as_u64().unwrap() as usize, view["byteLength"].as_u64().unwrap() as usize);
            assert!(at.is_multiple_of(4) && at + length <= bytes.len());
            bytes[at..at + length].chunks_exact(4).map(|w| f32::from_le_bytes(w.try_into().unwrap())).collect()
        };
        let primitive = &root["meshes"][0]["primitives"][0];
        assert_eq!(numbers(&primitive["targets"][0]["POSITION"]), [0.0, 0.0, 0.25].repeat(3));
        let sampler = &root["animations"][0]["samplers"][0];
        assert_eq!((numbers(&sampler["input"]), numbers(&sampler["output"])), (vec![0.0, 0.5], vec![0.0, 1.0]));
        assert_eq!(root["meshes"][0]["weights"].as_array().unwrap().len(), 1);
    }
}
