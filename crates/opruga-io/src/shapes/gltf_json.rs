//! The parts of the glTF JSON that are read. Objects in lists are read where they are named.

use super::json::Raw;
use serde::Deserialize;
use std::collections::BTreeMap;

#[derive(Deserialize)]
pub(super) struct Root<'a> {
    #[serde(borrow)]
    pub(super) asset: Raw<'a>,
    pub(super) scene: Option<usize>,
    #[serde(default)]
    pub(super) scenes: Vec<Scene>,
    #[serde(borrow, default)]
    pub(super) nodes: Vec<Raw<'a>>,
    #[serde(borrow, default)]
    pub(super) meshes: Vec<Raw<'a>>,
    #[serde(borrow, default)]
    pub(super) accessors: Vec<Raw<'a>>,
    #[serde(borrow, default, rename = "bufferViews")]
    pub(super) views: Vec<Raw<'a>>,
    #[serde(borrow, default)]
    pub(super) buffers: Vec<Raw<'a>>,
    #[serde(borrow, default)]
    pub(super) animations: Vec<Raw<'a>>,
    #[serde(default, rename = "extensionsRequired")]
    pub(super) extensions: Vec<String>,
}

#[derive(Deserialize)]
pub(super) struct Asset {
    pub(super) version: String,
}

#[derive(Deserialize)]
pub(super) struct Scene {
    #[serde(default)]
    pub(super) nodes: Vec<usize>,
}

#[derive(Deserialize)]
pub(super) struct Node {
    pub(super) name: Option<String>,
    pub(super) mesh: Option<usize>,
    pub(super) skin: Option<usize>,
    #[serde(default)]
    pub(super) children: Vec<usize>,
    pub(super) matrix: Option<[f64; 16]>,
    pub(super) translation: Option<[f64; 3]>,
    pub(super) rotation: Option<[f64; 4]>,
    pub(super) scale: Option<[f64; 3]>,
}

#[derive(Deserialize)]
pub(super) struct Mesh<'a> {
    pub(super) name: Option<String>,
    #[serde(borrow)]
    pub(super) primitives: Vec<Raw<'a>>,
}

#[derive(Deserialize)]
pub(super) struct Primitive<'a> {
    pub(super) attributes: BTreeMap<String, usize>,
    pub(super) indices: Option<usize>,
    pub(super) mode: Option<u32>,
    /// Morph targets.
    #[serde(borrow, default)]
    pub(super) targets: Vec<Raw<'a>>,
}

#[derive(Deserialize)]
pub(super) struct Accessor<'a> {
    #[serde(rename = "bufferView")]
    pub(super) view: Option<usize>,
    #[serde(default, rename = "byteOffset")]
    pub(super) offset: u64,
    #[serde(rename = "componentType")]
    pub(super) component: u32,
    pub(super) count: u64,
    #[serde(rename = "type")]
    pub(super) kind: String,
    #[serde(borrow)]
    pub(super) sparse: Option<Raw<'a>>,
}

#[derive(Deserialize)]
pub(super) struct View {
    pub(super) buffer: usize,
    #[serde(default, rename = "byteOffset")]
    pub(super) offset: u64,
    #[serde(rename = "byteLength")]
    pub(super) length: u64,
    #[serde(rename = "byteStride")]
    pub(super) stride: Option<u64>,
}

#[derive(Deserialize)]
pub(super) struct Buffer {
    pub(super) uri: Option<String>,
    #[serde(rename = "byteLength")]
    pub(super) length: u64,
}
