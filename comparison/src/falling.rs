//! Runs falling bodies in every program for the same frames, and makes a table of the times.

use crate::processor_time;
use opruga::World;
use serde_json::{Value, json};
use std::ops::Range;

/// One program with one setting.
pub struct Row {
    name: String,
    /// Times of the measured frames, ascending [ms].
    milliseconds: Vec<f64>,
    /// The mean height of all nodes at the end [m].
    height: f64,
    /// The numbers in further columns.
    pub more: Vec<f64>,
}

/// The results of all programs on the same bodies.
pub struct Table {
    pub title: String,
    /// The names of further columns.
    pub more: Vec<&'static str>,
    pub rows: Vec<Row>,
}

/// The positions of all nodes of every body [m].
pub type Positions<const D: usize> = Vec<Vec<[f64; D]>>;

/// The positions of the nodes of Opruga's bodies [m].
pub fn positions<const D: usize>(world: &World<D>) -> Positions<D> {
    let bodies = 0..world.blueprint().bodies.len();
    bodies.map(|body| (0..world.node_count(body) as u32).map(|node| world.position(body, node)).collect()).collect()
}

/// Steps through all frames up to the last timed one: `step` computes one, and `look` returns the positions of all nodes after it.
pub fn run<W, const D: usize>(
    name: &str,
    timed: Range<usize>,
    world: &mut W,
    mut step: impl FnMut(&mut W) -> Result<(), String>,
    mut look: impl FnMut(&W, usize) -> Positions<D>,
) -> Result<Row, String> {
    let mut row = Row { name: name.into(), milliseconds: Vec::new(), height: f64::NAN, more: Vec::new() };
    for frame in 0..timed.end {
        let start = processor_time();
        step(world)?;
        let end = processor_time();
        if timed.contains(&frame) {
            row.milliseconds.push((end - start) * 1e3);
        }
        let at = look(world, frame);
        let heights: Vec<f64> = at.iter().flatten().map(|x| x[1]).collect();
        row.height = heights.iter().sum::<f64>() / heights.len() as f64;
    }
    row.milliseconds.sort_by(f64::total_cmp);
    Ok(row)
}

/// The depth of a point [m] inside a body with nodes at these positions; 0 outside.
pub type DepthOf<'a, const D: usize> = dyn Fn(&[f64; D], &[[f64; D]]) -> f64 + 'a;

/// Measures how deep nodes of one body are inside another one.
pub struct Depth<'a, const D: usize> {
    pub of: &'a DepthOf<'a, D>,
    /// The depth is given in per cent of this length [m].
    pub unit: f64,
}

/// The number of frames from one measurement of the depth to the next.
const LOOK: usize = 10;

impl<const D: usize> Depth<'_, D> {
    /// The depth of the deepest node [m].
    pub fn deepest(&self, at: &Positions<D>) -> f64 {
        let around = |nodes: &Vec<[f64; D]>| {
            nodes.iter().fold([[f64::INFINITY; D], [f64::NEG_INFINITY; D]], |[low, high], x| {
                [std::array::from_fn(|d| low[d].min(x[d])), std::array::from_fn(|d| high[d].max(x[d]))]
            })
        };
        let boxes: Vec<_> = at.iter().map(around).collect();
        let mut deepest: f64 = 0.0;
        for (a, nodes) in at.iter().enumerate() {
            for (b, other) in at.iter().enumerate().filter(|(b, _)| *b != a) {
                let near = |x: &&[f64; D]| (0..D).all(|d| boxes[b][0][d] <= x[d] && x[d] <= boxes[b][1][d]);
                deepest = nodes.iter().filter(near).map(|p| (self.of)(p, other)).fold(deepest, f64::max);
            }
        }
        deepest
    }
}

/// Does the same as [`run`], with the largest depth in the timed frames as an additional column.
pub fn run_and_measure<W, const D: usize>(
    name: &str,
    timed: Range<usize>,
    world: &mut W,
    step: impl FnMut(&mut W) -> Result<(), String>,
    place: impl Fn(&W) -> Positions<D>,
    depth: &Depth<'_, D>,
) -> Result<Row, String> {
    let mut deepest: f64 = 0.0;
    let mut row = run(name, timed.clone(), world, step, |world, frame| {
        let at = place(world);
        if timed.contains(&frame) && (frame + 1 - timed.start).is_multiple_of(LOOK) {
            deepest = deepest.max(depth.deepest(&at));
        }
        at
    })?;
    row.more.push(100.0 * deepest / depth.unit);
    Ok(row)
}

impl Row {
    fn median(&self) -> f64 {
        self.milliseconds[self.milliseconds.len() / 2]
    }
}

impl Table {
    /// The table in Markdown.
    pub fn markdown(&self) -> String {
        let further: String = self.more.iter().map(|name| format!(" {name} |")).collect();
        let mut out = format!(
            "\n{}\n\n| | ms per frame, median | least | ratio | mean height, m |{further}\n|---|---|---|---|---|{}\n",
            self.title,
            "---|".repeat(self.more.len())
        );
        for row in &self.rows {
            let further: String = row.more.iter().map(|number| format!(" {number:.2} |")).collect();
            out += &format!(
                "| {} | {:.1} | {:.1} | {:.2} | {:.3} |{further}\n",
                row.name,
                row.median(),
                row.milliseconds[0],
                row.median() / self.rows[0].median(),
                row.height,
            );
        }
        out
    }

    /// A JSON object with all digits.
    pub fn json(&self) -> Value {
        let row = |row: &Row| {
            let mut out = json!({
                "program": row.name, "milliseconds_per_frame": row.median(), "least": row.milliseconds[0],
                "ratio": row.median() / self.rows[0].median(), "mean_height": row.height,
            });
            for (name, number) in self.more.iter().zip(&row.more) {
                out[name] = json!(number);
            }
            out
        };
        json!({ "body": self.title, "rows": self.rows.iter().map(row).collect::<Vec<_>>() })
    }
}
