//! Errors and notices of the glTF reader.

use opruga_math::words::counted;
use opruga_math::{messages, terms};

terms! {
    /// A part of a binary file whose size is wrong.
    pub(crate) enum Sized = "part.gltf_size" {
        File = "at byte 8, the length of the file",
        Chunk = "the position of a chunk",
    }
}

messages! {
    /// Errors in a glTF file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum GltfError {
        "gltf.size" #[error("{what} is {length}, but the file has {bytes} bytes")] #[value("{length}")] #[hint("the file is cut off")]
        CutOff { what: Sized, length: u64, bytes: usize },
        "gltf.size" #[error("{what} is {length}, but the file has {bytes} bytes")] #[value("{length}")]
        #[hint("the length in the header must equal the size of the file: remove the {more} bytes at the end")]
        Behind { what: Sized, length: u64, bytes: usize, more: u64 },
        "gltf.size" #[error("at byte {byte}, the length of a chunk is {length}, but the file has {bytes} bytes")] #[value("{length}")]
        #[hint("the file is cut off")]
        Chunk { byte: usize, length: u64, bytes: usize },
        "gltf.version" #[error("at byte 4, the version is {version}")] #[value("{version}")] #[allowed("2")]
        BinaryVersion { version: u64 },
        "gltf.size" #[error("the file has no JSON chunk")] #[value("0")] #[allowed("a chunk `JSON` at byte 12")]
        NoJson {},
        "gltf.version" #[error("version `{version}` cannot be read")] #[value("{version}")] #[allowed("2.0")]
        Version { version: String },
        "gltf.unsupported" #[error("the file needs the extension `{extension}`")] #[value("{extension}")]
        #[allowed("no compression and no other required extension")] #[hint("export without compression")]
        Extension { extension: String },
        "gltf.syntax" #[error("the file names no scene")] #[allowed("`scenes` with `nodes`")]
        NoScene {},
        "gltf.index" #[error("there is no {what} {index}")] #[value("{index}")] #[allowed("below {count}")]
        NoEntry { what: &'static str, index: usize, count: usize },
        "gltf.tree" #[error("node {node} has two parents, or is its own parent")] #[value("{node}")] #[allowed("one parent for every node")]
        #[hint("give each instance its own node, with the same mesh")]
        Parents { node: usize },
        "gltf.depth" #[error("nodes are nested more than {deepest} levels deep, or contain themselves")] #[value("{node}")] #[allowed("at most {deepest} levels")]
        Depth { deepest: usize, node: usize },
        "gltf.unsupported" #[error("primitives of mode {mode} cannot be read")] #[value("{mode}")] #[allowed("4 (triangles)")]
        Mode { mode: u32 },
        "gltf.syntax" #[error("a primitive has no POSITION")] #[allowed("an attribute POSITION")]
        NoPosition {},
        "scene.not_finite" #[error("a coordinate of vertex {vertex} is not finite")] #[value("{position}")] #[allowed("finite numbers")]
        NotFinitePosition { vertex: usize, position: String },
        "gltf.syntax" #[error("a primitive has {corners} corners")] #[value("{corners}")] #[allowed("three for every triangle")]
        Corners { corners: usize },
        "gltf.unsupported" #[error("sparse accessors cannot be read")] #[value("sparse")]
        Sparse {},
        "gltf.syntax" #[error("the accessor contains {kind} of type {component}")] #[value("{kind} of type {component}")]
        #[allowed("{wanted} of type {components}")]
        Accessor { kind: String, component: u32, wanted: &'static str, components: String },
        "gltf.unsupported" #[error("the accessor has no bufferView")] #[value("none")]
        NoView {},
        "gltf.size" #[error("{rows} rows of {each} bytes do not fit into the view and its buffer of {bytes} bytes")] #[value("{rows}")]
        #[hint("the file is cut off, or the view is too short")]
        Rows { rows: u64, each: u64, bytes: usize },
        "gltf.syntax" #[error("the buffer has neither a URI nor a binary chunk")]
        NoBytes {},
        "gltf.syntax" #[error("the data URI is not base64")] #[allowed("data:…;base64,…")]
        Base64 {},
        "gltf.size" #[error("the buffer declares {promised} bytes, but has {bytes}")] #[value("{bytes}")] #[allowed("{promised} bytes")]
        Buffer { promised: u64, bytes: usize },
    }

    /// Parts of a glTF file that are omitted.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum GltfNotice {
        "gltf.scenes" #[error("{} left out", counted(*count as u64, "other scene is", "other scenes are"))] #[value("{count}")]
        Scenes { count: usize },
        "gltf.skin" #[error("{} left out", counted(*count as u64, "skin, which makes vertices follow bones, is", "skins, which make vertices follow bones, are"))] #[value("{count}")]
        Skins { count: usize },
        "gltf.morph" #[error("morph targets of {} left out", counted(*count as u64, "part are", "parts are"))] #[value("{count}")]
        Morphs { count: usize },
        "gltf.animation" #[error("{} left out", counted(*count as u64, "animation is", "animations are"))] #[value("{count}")]
        Animations { count: usize },
    }
}
