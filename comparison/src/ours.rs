//! Scenes of Opruga: a body clamped at one side, with some of its values replaced.

use crate::motion::Run;
use crate::processor_time;
use opruga::blueprint::AnyBlueprint;
use opruga::io::scene;
use opruga::{Options, World, catalogue, scenes};

/// The integrator whose steps are solved to the last digits.
pub const EXACT: &str = "{ kind = \"backward_euler\", accuracy = \"exact\" }";
/// The integrator whose steps have a fixed budget of iterations.
pub const REAL_TIME: &str = "{ kind = \"backward_euler\", accuracy = \"real_time\" }";

/// The damping of runs that must come to rest [s].
pub const DAMPING: f64 = 0.1;

/// A body that is clamped at its left side and hangs on the right.
pub struct Held {
    world: World<3>,
    tip: Vec<u32>,
}

/// A body given by its nodes, for other programs.
pub struct Shape {
    pub positions: Vec<[f64; 3]>,
    pub masses: Vec<f64>,
    pub tetrahedra: Vec<[u32; 4]>,
    pub held: Vec<u32>,
    pub tip: Vec<u32>,
}

impl Held {
    /// A scene that comes with Opruga, with some of its values replaced.
    pub fn new(scene: &str, overrides: &[(&str, String)], integrator: &str, substeps: u32) -> Result<Held, String> {
        let text = scenes::find(scene).ok_or_else(|| format!("the scene `{scene}` is missing"))?;
        let mut all: Vec<(String, String)> = overrides.iter().map(|(path, v)| ((*path).into(), v.clone())).collect();
        all.push(("integrator".into(), integrator.into()));
        all.push(("time.substeps".into(), substeps.to_string()));
        let reading = scene::Options { overrides: all, files: scenes::files(), ..scene::Options::default() };
        let (blueprint, _) = scene::read(text.as_bytes(), scene, &catalogue(), &reading)
            .map_err(|errors| errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))?;
        let AnyBlueprint::Space(blueprint) = blueprint else { return Err(format!("`{scene}` is not in space")) };
        let tip = blueprint.bodies[0].mesh.groups["right"].clone();
        let world = World::new(blueprint, Options::default()).map_err(|e| e.to_string())?;
        Ok(Held { world, tip })
    }

    /// Mean height of the free side [m].
    fn height(&self) -> f64 {
        self.tip.iter().map(|node| self.world.position(0, *node)[1]).sum::<f64>() / self.tip.len() as f64
    }

    /// The number of nodes.
    pub fn nodes(&self) -> usize {
        self.world.node_count(0)
    }

    /// Nodes, masses and linear tetrahedra.
    pub fn shape(&self) -> Shape {
        let nodes = || 0..self.world.node_count(0) as u32;
        let mesh = &self.world.blueprint().bodies[0].mesh;
        Shape {
            positions: nodes().map(|node| self.world.position(0, node)).collect(),
            masses: nodes().map(|node| self.world.node_mass(0, node)).collect(),
            tetrahedra: mesh.cells.tetrahedra.clone(),
            held: mesh.groups["left"].clone(),
            tip: self.tip.clone(),
        }
    }

    /// Steps frame by frame until `enough` returns true, for at most `frames` frames.
    pub fn run(&mut self, frames: usize, enough: impl Fn(&Run) -> bool) -> Result<Run, String> {
        let mut run = Run { milliseconds: Vec::new(), heights: vec![self.height()] };
        while run.milliseconds.len() < frames && !enough(&run) {
            let start = processor_time();
            self.world.frame().map_err(|e| e.to_string())?;
            run.milliseconds.push((processor_time() - start) * 1e3);
            run.heights.push(self.height());
        }
        Ok(run)
    }
}

/// How far the free side of a scene is below its initial position at rest [m].
pub fn sag_at_rest(scene: &str, overrides: &[(&str, String)]) -> Result<f64, String> {
    let rule = "{ kind = \"equilibrium\", load_steps = 4 }";
    Ok(Held::new(scene, overrides, rule, 1)?.run(1, |_| false)?.sag())
}
