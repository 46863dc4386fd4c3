//! A scene in two configurations that run in step: everything that is done to the left one is also done to the right one.

use crate::differences::{Difference, Twins, right_of};
use crate::document::{Document, read};
use crate::engine::{self, Common, Engine, Given, State};
use crate::exploded::Exploded;
use crate::report::Report;
use crate::samples::Sample;
use crate::setting::Setting;
use crate::shown::{Beside, Show, Shown};
use opruga::blueprint::AnyBlueprint;
use opruga::core::spec::{Value, Values};
use opruga::io::Files;
use opruga::world::SnapshotFault;
use opruga::{Warning, WorldError};
use std::sync::Arc;

/// Builds the engine of a scene and, if there are differences, that of the right scene.
///
/// # Errors
/// [`Report`] if one of the two scenes cannot be built.
pub fn build(
    document: &Document,
    differences: Option<&[Difference]>,
    files: &Files,
    setting: &Setting,
) -> Result<Box<dyn Engine>, Report> {
    let one = |document: &Document| {
        let (blueprint, scene_warnings) = read(document, files, &setting.registries).map_err(Report::Scene)?;
        engine::build(blueprint, scene_warnings, setting).map_err(Report::World)
    };
    let left = one(document)?;
    let Some(differences) = differences else { return Ok(left) };
    let (scene, twins) = right_of(document, differences, files, &setting.registries)?;
    let right = one(&scene)?;
    let differences = differences.to_vec();
    Ok(Box::new(Pair { left, right, differences, twins, stopped: None, behind: false }))
}

/// Two engines of one scene.
struct Pair {
    left: Box<dyn Engine>,
    right: Box<dyn Engine>,
    /// How the scene on the right differs from the scene on the left.
    differences: Vec<Difference>,
    /// The correspondence of nodes, for bodies with different nodes.
    twins: Twins,
    /// The reason why the right side has stopped, if it has.
    stopped: Option<Report>,
    /// Whether the right side has missed a command. After that, the right side must be rebuilt.
    behind: bool,
}

impl Pair {
    /// Repeats on the right side what the left side has accepted.
    fn follow<T>(&mut self, act: impl FnOnce(&mut dyn Engine) -> Result<T, WorldError>) {
        if self.stopped.is_none()
            && let Err(error) = act(&mut *self.right)
        {
            self.stopped = Some(Report::World(error));
        }
        self.behind |= self.stopped.is_some();
    }

    /// The distance between the centres of mass [m], and the difference of the enclosed volumes, right minus left [m³, m² in the plane].
    fn in_common(&self) -> [Option<f64>; 2] {
        if self.stopped.is_some() {
            return [None; 2];
        }
        let (left, right) = (self.left.common(), self.right.common());
        let square: f64 = left.center.iter().zip(&right.center).map(|(a, b)| (a - b) * (a - b)).sum();
        let volume = left.volume.zip(right.volume).map(|(left, right)| right - left);
        [Some(square.sqrt()).filter(|far| far.is_finite()), volume]
    }

    /// The root mean square and the largest distance between the nodes of both sides [m]; none if the bodies differ.
    fn distances(&self) -> Option<[f64; 2]> {
        let (left, right) = (self.left.positions(), self.right.positions());
        if self.stopped.is_some() || left.len() != right.len() || left.is_empty() {
            return None;
        }
        let square = |(a, b): (&[f64; 3], &[f64; 3])| (0..3).map(|d| (a[d] - b[d]) * (a[d] - b[d])).sum::<f64>();
        let squares: Vec<f64> = left.iter().zip(&right).map(square).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        Some([mean.sqrt(), squares.iter().copied().fold(0.0, f64::max).sqrt()])
    }
}

impl Engine for Pair {
    fn frame(&mut self) -> Result<(), WorldError> {
        // If the frame of the right side is interrupted, both sides return to the state before the frame.
        let before = self.left.snapshot();
        self.left.frame()?;
        if self.stopped.is_some() {
            return Ok(());
        }
        match self.right.frame() {
            Err(WorldError::BrokenOff {}) => {
                self.left.rewind(&before)?;
                return Err(WorldError::BrokenOff {});
            }
            Err(error) => self.stopped = Some(Report::World(error)),
            Ok(()) => self.stopped = self.right.exploded().map(Report::Exploded),
        }
        Ok(())
    }
    fn begin_what_is_due(&mut self) -> Result<(), WorldError> {
        self.left.begin_what_is_due()?;
        self.follow(|right| right.begin_what_is_due());
        Ok(())
    }
    fn frames(&self) -> u64 {
        self.left.frames()
    }
    fn frame_seconds(&self) -> f64 {
        self.left.frame_seconds()
    }
    fn time(&self) -> f64 {
        self.left.time()
    }
    fn dimension(&self) -> usize {
        self.left.dimension()
    }
    fn substeps(&self) -> u32 {
        self.left.substeps()
    }
    fn snapshot(&self) -> State {
        let right = (Box::new(self.right.snapshot()), self.stopped.clone());
        State { right: Some(right), ..self.left.snapshot() }
    }
    fn rewind(&mut self, state: &State) -> Result<(), WorldError> {
        let foreign = || WorldError::snapshot(SnapshotFault::NoPair {});
        let (right, stopped) = state.right.as_ref().ok_or_else(foreign)?;
        let before = self.left.snapshot();
        self.left.rewind(state)?;
        if self.behind {
            return Ok(());
        }
        if let Err(error) = self.right.rewind(right) {
            self.left.rewind(&before)?;
            return Err(error);
        }
        self.stopped.clone_from(stopped);
        Ok(())
    }
    fn warnings(&self) -> Vec<Warning> {
        self.left.warnings()
    }
    fn end(&self) -> u64 {
        self.left.end()
    }
    fn warnings_at_the_end(&mut self) -> Vec<Warning> {
        self.left.warnings_at_the_end()
    }
    fn exploded(&mut self) -> Option<Exploded> {
        self.left.exploded()
    }
    fn hash(&self) -> u64 {
        self.left.hash()
    }
    fn pull(&mut self, body: usize, node: u32, pointer: [f64; 3]) -> Result<Given, WorldError> {
        let given = self.left.pull(body, node, pointer)?;
        let node = self.twins.on_right(body, node);
        self.follow(|right| right.pull(body, node, pointer));
        Ok(given)
    }
    fn usual_pull(&self, body: usize) -> Option<[f64; 2]> {
        self.left.usual_pull(body)
    }
    fn lead(&mut self, number: usize, pointer: [f64; 3]) -> Result<Vec<f64>, WorldError> {
        let row = self.left.lead(number, pointer)?;
        self.follow(|right| right.lead(number, pointer));
        Ok(row)
    }
    fn finish(&mut self, number: usize) -> Result<f64, WorldError> {
        let until = self.left.finish(number)?;
        self.follow(|right| right.finish(number));
        Ok(until)
    }
    fn push(&mut self, body: usize, node: u32, force: [f64; 3]) -> Result<Given, WorldError> {
        let given = self.left.push(body, node, force)?;
        let node = self.twins.on_right(body, node);
        self.follow(|right| right.push(body, node, force));
        Ok(given)
    }
    fn pin(&mut self, body: usize, node: u32) -> Result<Given, WorldError> {
        let given = self.left.pin(body, node)?;
        let node = self.twins.on_right(body, node);
        self.follow(|right| right.pin(body, node));
        Ok(given)
    }
    fn free(&mut self, body: usize, node: u32) -> Result<Given, WorldError> {
        let given = self.left.free(body, node)?;
        let node = self.twins.on_right(body, node);
        self.follow(|right| right.free(body, node));
        Ok(given)
    }
    fn set(&mut self, path: &str, value: Value) -> Result<Given, WorldError> {
        let given = self.left.set(path, value.clone())?;
        self.follow(|right| right.set(path, value));
        Ok(given)
    }
    fn remove(&mut self, name: &str) -> Result<Given, WorldError> {
        let given = self.left.remove(name)?;
        self.follow(|right| right.remove(name));
        Ok(given)
    }
    fn change(
        &mut self,
        body: usize,
        models: Option<Vec<Values>>,
        integrator: Option<Values>,
    ) -> Result<Given, WorldError> {
        let given = self.left.change(body, models.clone(), integrator.clone())?;
        self.follow(|right| right.change(body, models, integrator));
        Ok(given)
    }
    fn add_from(&mut self, scene: AnyBlueprint, scene_warnings: Vec<Warning>) -> Result<(), WorldError> {
        self.left.add_from(scene.clone(), scene_warnings.clone())?;
        self.follow(|right| right.add_from(scene, scene_warnings));
        Ok(())
    }
    fn nearest(&self, body: usize, point: [f64; 3]) -> Option<u32> {
        self.left.nearest(body, point)
    }
    fn nearest_beside(&self, body: usize, point: [f64; 3]) -> Option<u32> {
        self.right.nearest(body, point).map(|node| self.twins.on_left(body, node))
    }
    fn position(&self, body: usize, node: u32) -> Option<[f64; 3]> {
        self.left.position(body, node)
    }
    fn position_beside(&self, body: usize, node: u32) -> Option<[f64; 3]> {
        self.right.position(body, self.twins.on_right(body, node))
    }
    fn common(&self) -> Common {
        self.left.common()
    }
    fn positions(&self) -> Vec<[f64; 3]> {
        self.left.positions()
    }
    fn names(&self) -> Vec<String> {
        self.left.names()
    }
    fn name(&self, body: usize) -> Option<String> {
        self.left.name(body)
    }
    fn rest_center(&self, body: usize) -> Option<([f64; 3], [f64; 3])> {
        self.left.rest_center(body)
    }
    fn shown(&mut self, show: &Show) -> Shown {
        let mut shown = self.left.shown(show);
        let right = Shown { hash: show.hash.then(|| self.right.hash()), ..self.right.shown(show) };
        let energy = self.stopped.is_none().then(|| right.energy.total() - shown.energy.total());
        let [center, volume] = self.in_common();
        shown.beside = Some(Beside {
            distances: self.distances(),
            center,
            volume,
            energy,
            differences: self.differences.clone(),
            stopped: self.stopped.clone(),
            right: Arc::new(right),
        });
        shown
    }
    fn sample(&mut self) -> Sample {
        let mut sample = self.left.sample();
        if self.stopped.is_none() {
            let stored = |sample: &Sample| sample.energy[..4].iter().sum::<f64>();
            let more = stored(&self.right.sample()) - stored(&sample);
            let [mean, largest] = self.distances().unwrap_or([f64::NAN; 2]);
            let [center, volume] = self.in_common().map(|x| x.unwrap_or(f64::NAN));
            sample.beside = Some([mean, largest, center, volume, more]);
        }
        sample
    }
    fn row(&mut self) -> Vec<(String, f64)> {
        let mut row = self.left.row();
        let (right, distances) = (self.right.row(), self.distances());
        let stored = |row: &[(String, f64)]| -> f64 {
            let stocks = ["kinetic", "elastic", "gas", "gravity"];
            row.iter().filter(|(name, _)| stocks.contains(&name.as_str())).map(|(_, x)| x).sum()
        };
        // If the right side has stopped, there is nothing to compare.
        if self.stopped.is_none() {
            let energy = stored(&right) - stored(&row);
            row.extend(right.into_iter().skip(1).map(|(name, x)| (format!("right.{name}"), x)));
            let [mean, largest] = distances.unwrap_or([f64::NAN; 2]);
            let [center, volume] = self.in_common().map(|x| x.unwrap_or(f64::NAN));
            let named = [
                ("mean_distance", mean),
                ("largest_distance", largest),
                ("center_of_mass", center),
                ("volume", volume),
                ("energy", energy),
            ];
            row.extend(named.map(|(name, x)| (format!("difference.{name}"), x)));
        }
        row
    }
    fn moment(&mut self, show: &Show) -> opruga::draw::Picture {
        self.left.moment(show)
    }
}
