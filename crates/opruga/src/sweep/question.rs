//! The question of a sweep as a file in the folder of the sweep. The sweep can be resumed from this file.

use super::errors::{QuestionDifference, SweepError};
use super::{Axis, Design, Metric, Sweep};
use opruga_io::problem::visible;
use opruga_io::{Files, SceneError, overrides};
use opruga_world::Registries;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Everything that determines the numbers in a sweep's table.
#[derive(Clone, Debug, Deserialize, PartialEq, Serialize)]
pub struct Question {
    /// The version of this format: 1.
    pub schema: u32,
    /// The name of the scene.
    pub name: String,
    /// The file that the scene comes from. The file is ignored when two questions are compared.
    pub file: String,
    /// The parameters that vary or are changed for all points, as `PATH=VALUES`.
    pub set: Vec<String>,
    /// The names of the measured quantities.
    pub metrics: Vec<String>,
    /// Whether the parameters vary one after the other, instead of in all combinations.
    pub each: bool,
    /// The number of random points; none if the points are not random.
    pub sample: Option<usize>,
    /// Whether the random points are independent of one another; otherwise they form a Latin hypercube.
    pub independent: bool,
    /// The seed of random points.
    pub seed: u64,
    /// Whether steps above the stable limit are allowed.
    pub allow_unstable: bool,
    /// Whether unknown fields of the scene are ignored.
    pub lenient: bool,
    /// The text of the scene.
    pub scene: String,
    /// The files that the scene names, with their bytes as pairs of hexadecimal digits.
    #[serde(default)]
    pub files: BTreeMap<String, String>,
}

impl Question {
    /// The version of this format.
    pub const SCHEMA: u32 = 1;

    /// Bytes of a file as pairs of hexadecimal digits.
    pub fn to_digits(bytes: &[u8]) -> String {
        bytes.iter().map(|byte| format!("{byte:02x}")).collect()
    }

    /// Reads the JSON of a question.
    ///
    /// # Errors
    /// `sweep.damaged` if the bytes are not a question, or are a question of another version.
    pub fn read(bytes: &[u8]) -> Result<Question, SceneError> {
        let damaged = |reason: &serde_json::Error| SweepError::Question { reason: visible(&reason.to_string()) };
        let question: Question = serde_json::from_slice(bytes).map_err(|e| SceneError::of(damaged(&e)))?;
        match question.schema {
            Question::SCHEMA => Ok(question),
            found => Err(SceneError::of(SweepError::QuestionVersion { found, version: Question::SCHEMA })),
        }
    }

    /// The JSON of the question.
    pub fn to_text(&self) -> String {
        serde_json::to_string_pretty(self).unwrap_or_default()
    }

    /// Makes the sweep, with the models and integrators that its scene can name.
    ///
    /// # Errors
    /// All errors in the parameters, the metrics and the files.
    pub fn sweep(&self, registries: &Registries) -> Result<Sweep, Vec<SceneError>> {
        let (mut errors, mut axes, mut fixed) = (Vec::new(), Vec::new(), Vec::new());
        for set in &self.set {
            match Axis::parse(set) {
                Ok(Some(axis)) => axes.push(axis),
                Ok(None) => fixed.extend(overrides::split(set).map_err(|e| errors.push(e))),
                Err(error) => errors.push(error),
            }
        }
        let metrics = self.metrics.iter().filter_map(|m| Metric::parse(m).map_err(|e| errors.push(e)).ok()).collect();
        let mut files = BTreeMap::new();
        for (name, digits) in &self.files {
            match from_digits(digits) {
                Some(bytes) => _ = files.insert(name.clone(), bytes.into()),
                None => errors.push(SceneError::of(SweepError::FileOfSweep { name: visible(name) })),
            }
        }
        if !errors.is_empty() {
            return Err(errors);
        }
        Ok(Sweep {
            name: self.name.clone(),
            file: self.file.clone(),
            text: self.scene.clone(),
            files: Files::in_memory(files),
            fixed,
            axes,
            design: match self.sample {
                Some(count) => Design::Sample { count, seed: self.seed, independent: self.independent },
                None if self.each => Design::Each,
                None => Design::Grid,
            },
            metrics,
            allow_unstable: self.allow_unstable,
            lenient: self.lenient,
            registries: registries.clone(),
        })
    }

    /// Whether another question has the same answer as this one.
    pub fn same(&self, other: &Question) -> bool {
        *self == Question { file: self.file.clone(), ..other.clone() }
    }

    /// Finds how an earlier question differs from this one.
    pub fn difference(&self, before: &Question) -> QuestionDifference {
        let listed = |list: &[String]| visible(&list.join(" "));
        if self.scene != before.scene {
            QuestionDifference::Scene {}
        } else if self.files != before.files {
            QuestionDifference::File {}
        } else if self.set != before.set {
            QuestionDifference::Set { before: listed(&before.set), now: listed(&self.set) }
        } else if self.metrics != before.metrics {
            QuestionDifference::Metric { before: listed(&before.metrics), now: listed(&self.metrics) }
        } else {
            QuestionDifference::Points {}
        }
    }
}

fn from_digits(text: &str) -> Option<Vec<u8>> {
    let byte = |pair: &[u8]| u8::from_str_radix(core::str::from_utf8(pair).ok()?, 16).ok();
    text.len().is_multiple_of(2).then(|| text.as_bytes().chunks(2).map(byte).collect()).flatten()
}
