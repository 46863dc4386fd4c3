//! Calls MuJoCo through a Python program that answers in JSON.

use crate::motion::Run;
use crate::ours::Shape;
use serde_json::{Value, json};
use std::io::Write;
use std::process::{Command, Stdio};

/// A body for MuJoCo.
pub enum Body<'a> {
    /// Linear tetrahedra, node by node.
    Tetrahedra(&'a Shape),
    /// A box with cells of 27 nodes.
    Quadratic { size: [f64; 3], cells: [u32; 3], density: f64 },
}

/// The answer of MuJoCo.
pub struct Answer {
    pub version: String,
    pub nodes: usize,
    pub swinging: Run,
    /// The sag at rest; none if the run did not come to rest.
    pub resting: Option<f64>,
}

/// Lets a body oscillate for some frames of one step each, and then come to rest.
pub fn run(
    python: &str,
    body: &Body,
    [modulus, poisson]: [f64; 2],
    frame: f64,
    [frames, rest_frames]: [usize; 2],
) -> Result<Answer, String> {
    let body = match body {
        Body::Tetrahedra(shape) => json!({
            "positions": shape.positions, "masses": shape.masses, "tetrahedra": shape.tetrahedra, "held": shape.held,
            "tip": shape.tip,
        }),
        Body::Quadratic { size, cells, density } => json!({ "size": size, "cells": cells, "density": density }),
    };
    let question = json!({
        "body": body, "youngs_modulus": modulus, "poissons_ratio": poisson, "frame": frame, "frames": frames,
        "rest_frames": rest_frames,
    });
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/mujoco_beam.py");
    let failed = |e: &dyn std::fmt::Display| format!("{python} {script}: {e}");
    let mut child = Command::new(python)
        .arg(script)
        // MuJoCo writes its warnings to a file in its working directory.
        .current_dir(std::env::temp_dir())
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|e| failed(&e))?;
    let mut to = child.stdin.take().ok_or("the script takes no question")?;
    to.write_all(question.to_string().as_bytes()).map_err(|e| failed(&e))?;
    drop(to);
    let output = child.wait_with_output().map_err(|e| failed(&e))?;
    if !output.status.success() {
        return Err(failed(&output.status));
    }
    let answer: Value = serde_json::from_slice(&output.stdout).map_err(|e| failed(&e))?;
    let numbers = |key: &str| -> Result<Vec<f64>, String> {
        let list = answer[key].as_array().ok_or_else(|| failed(&format!("its answer lacks {key}")))?;
        Ok(list.iter().filter_map(Value::as_f64).collect())
    };
    Ok(Answer {
        version: answer["version"].as_str().unwrap_or("?").into(),
        nodes: answer["nodes"].as_u64().unwrap_or(0) as usize,
        swinging: Run { milliseconds: numbers("milliseconds")?, heights: numbers("heights")? },
        resting: answer["sag_at_rest"].as_f64(),
    })
}
