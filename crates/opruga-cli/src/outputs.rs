//! The output of a run: tables, checkpoint, strip, video, plots.

use crate::checkpoints::Keeper;
use crate::errors::CallNote;
use crate::failure::{Failure, print_note, print_warning};
use crate::recorder::{Recorder, film_rate};
use crate::source::Source;
use opruga::blueprint::Recorded;
use opruga::draw;
use opruga::io::output_folder::OutputFolder;
use opruga::io::tables::{
    CellSummary, EnergySummary, FinalBody, MomentumSummary, SolverSummary, Summary, WarningSummary, write_final,
    write_final_with,
};
use opruga::math::words::{counted, number, rounded};
use opruga::pictures::{Moment, Scenery};
use opruga::world::{NodeState, Vectors};
use opruga::{AnyBody, AnyWorld, Warning};
use std::sync::atomic::{AtomicBool, Ordering};

/// The largest number of pictures to which the view is fitted.
const MOST_FITTED: usize = 120;

/// The destination of the files, and information about the run for them.
pub(crate) struct Outputs<'a> {
    pub(crate) folder: &'a OutputFolder,
    pub(crate) source: &'a Source,
    pub(crate) wall: f64,
    pub(crate) steps: u64,
    /// The time of the checkpoint from which the run was resumed [s].
    pub(crate) resumed_at: Option<f64>,
    /// Warnings about the call and the scene, and failures during the run. All of them have been reported already.
    pub(crate) reported: Vec<Warning>,
    pub(crate) stop: &'a AtomicBool,
    /// Whether `final.csv` also contains the stress at every node.
    pub(crate) stress: bool,
}

impl Outputs<'_> {
    /// Writes every file. Returns the summary as JSON.
    pub(crate) fn write(
        &self,
        world: &dyn AnyWorld,
        recorder: Recorder,
        keeper: &mut Keeper<'_>,
    ) -> Result<String, Failure> {
        // The checkpoint is written first, so that the run is not lost if pictures cannot be written.
        let mut files = keeper.write(world, &recorder.table)?;
        files.push("final.csv".into());
        let (scene, numbers) = (world.scene(), world.bodies());
        let dimension = scene.dimension();
        let all = |vectors: fn(&dyn AnyWorld, usize) -> Vectors<'_>| -> Vec<Vec<[f64; 3]>> {
            numbers.iter().map(|&body| vectors(world, body).iter().collect()).collect()
        };
        let (x, v) = (all(|world, body| world.positions(body)), all(|world, body| world.velocities(body)));
        let rows = numbers.iter().zip(x.iter().zip(&v)).map(|(&body, (positions, velocities))| {
            let name = scene.body(body).map_or("", AnyBody::name);
            FinalBody { name, positions, velocities }
        });
        if self.stress {
            let columns = [Recorded::Stress, Recorded::VolumeRatio].map(|what| what.columns(dimension)).concat();
            let rows = rows.zip(&numbers).map(|(row, &body)| (row, stresses(world, body)));
            self.folder.write("final.csv", false, |out| write_final_with(out, dimension, &columns, rows))?;
        } else {
            self.folder.write("final.csv", false, |out| write_final(out, dimension, rows))?;
        }
        if let Some(scenery) = &recorder.scenery {
            self.pictures(scenery, &recorder, &mut files)?;
        }
        files.push("summary.json".into());
        let summary = self.summary(world, files);
        self.folder.write("summary.json", false, |out| summary.write(out))?;
        Ok(serde_json::to_string_pretty(&summary.to_json()).unwrap_or_default())
    }

    fn summary(&self, world: &dyn AnyWorld, files: Vec<String>) -> Summary {
        let (scene, numbers) = (world.scene(), world.bodies());
        let (dimension, time) = (scene.dimension(), scene.time());
        let nodes: usize = numbers.iter().map(|body| world.node_count(*body)).sum();
        let e = world.energy();
        let [linear, angular] = world.momentum();
        let bodies: Vec<&dyn AnyBody> = numbers.iter().filter_map(|body| scene.body(*body)).collect();
        let of_body =
            |body: &&dyn AnyBody| body.models().iter().map(|model| model.kind().to_string()).collect::<Vec<_>>();
        let mut models: Vec<String> = bodies.iter().flat_map(of_body).collect();
        models.sort();
        models.dedup();
        Summary {
            scene: scene.name().to_string(),
            dimension,
            bodies: bodies.len(),
            nodes,
            elements: bodies.iter().map(|body| body.edges().len()).sum(),
            models,
            integrator: world.integrators().join(", "),
            frame: time.frame,
            substeps: time.substeps,
            h: world.h(),
            steps: self.steps,
            time: world.time(),
            wall_seconds: self.wall,
            resumed_at: self.resumed_at,
            nanoseconds_per_node_step: self.nanoseconds(nodes),
            simd: world.simd().name().into(),
            threads: world.threads(),
            reproducibility: if world.same_bits_everywhere() { "everywhere" } else { "this_cpu_class" }.into(),
            energy: EnergySummary {
                kinetic: e.kinetic,
                elastic: e.elastic,
                gas: e.gas,
                gravity: e.gravity,
                work_user: e.work_user,
                work_gas: e.work_gas,
                work_correction: e.work_correction,
                loss_damping: e.loss_damping,
                loss_friction: e.loss_friction,
                loss_contact: e.loss_contact,
                loss_numerical: e.loss_numerical,
                loss_integrator: e.loss_integrator,
                closure: e.closure,
            },
            momentum: MomentumSummary {
                linear: linear[..dimension].to_vec(),
                angular: if dimension == 2 { vec![angular[2]] } else { angular.to_vec() },
            },
            state_hash: format!("{:016x}", world.state_hash()),
            solver: solver_summary(world),
            cells: cells(world),
            warnings: self.all_warnings(world),
            files,
        }
    }

    /// Writes the strip, the video and the plots.
    pub(crate) fn pictures(
        &self,
        scenery: &Scenery,
        recorder: &Recorder,
        files: &mut Vec<String>,
    ) -> Result<(), Failure> {
        let plots =
            crate::plots::of_run(&recorder.seen, &recorder.columns, &self.source.name).map_err(Failure::Draw)?;
        self.folder.write("plots.svg", false, |out| out.write_all(plots.as_bytes()))?;
        files.push("plots.svg".into());
        let moments = &recorder.moments;
        let Some(first) = moments.first() else {
            return Ok(());
        };
        let dimension = scenery.picture(first).dimension;
        let mut fitting = draw::Fitting::default();
        draw::spread(moments, MOST_FITTED).into_iter().for_each(|m| fitting.add(&scenery.picture(m)));
        let (strip, whole) = (fitting.clone().finish(), fitting.everything().finish());
        let (view, film) = match strip.and_then(|strip| whole.map(|whole| (strip, whole))) {
            Ok(views) => views,
            Err(nothing @ draw::DrawError::Empty { .. }) => {
                print_note(&CallNote::NoStrip { cause: nothing.into() });
                return Ok(());
            }
            Err(error) => return Err(error.into()),
        };
        let count = scenery.panels().unwrap_or_else(|| draw::best_count(&view, dimension, moments.len()));
        let pictures: Vec<draw::Picture> =
            draw::spread(moments, count).into_iter().map(|m| scenery.picture(m)).collect();
        let panels: Vec<&draw::Picture> = pictures.iter().collect();
        let strip = draw::strip(&panels, &view, &draw::StripStyle::default()).map_err(Failure::Draw)?;
        let png = strip.to_png().map_err(Failure::Draw)?;
        self.folder.write("strip.png", false, |out| out.write_all(&png))?;
        files.push("strip.png".into());
        if self.stop.load(Ordering::Relaxed) {
            print_note(&CallNote::NoVideo {});
            return Ok(());
        }
        files.push(self.video(scenery, recorder, &film, dimension)?);
        Ok(())
    }

    /// Writes the animation of the run, drawn frame by frame.
    fn video(
        &self,
        scenery: &Scenery,
        recorder: &Recorder,
        view: &draw::View,
        dimension: u8,
    ) -> Result<String, Failure> {
        let style = draw::Style::film(view, dimension, if recorder.gif { 640 } else { 960 });
        let draw_moment = |moment: &Moment| draw::draw(&scenery.picture(moment), view, &style).map_err(Failure::Draw);
        let rate = film_rate(recorder.every, recorder.frame);
        let every = |take: &mut dyn FnMut(&draw::Image) -> Result<(), draw::DrawError>| -> Result<(), Failure> {
            for (number, moment) in recorder.moments.iter().enumerate() {
                // An interrupted film is shortened, but has at least one frame.
                if number > 0 && self.stop.load(Ordering::Relaxed) {
                    break;
                }
                take(&draw_moment(moment)?).map_err(Failure::Draw)?;
            }
            Ok(())
        };
        let mut bytes = Vec::new();
        let name = if recorder.gif {
            let samples: Vec<draw::Image> =
                draw::spread(&recorder.moments, 6).into_iter().map(draw_moment).collect::<Result<_, _>>()?;
            let mut writer = draw::GifWriter::new(&mut bytes, rate, &samples).map_err(Failure::Draw)?;
            every(&mut |image| writer.push(image))?;
            "video.gif"
        } else {
            let mut writer =
                draw::Mp4Writer::new(&mut bytes, [style.width, style.height], rate).map_err(Failure::Draw)?;
            every(&mut |image| writer.push(image))?;
            writer.finish().map_err(Failure::Draw)?;
            "video.mp4"
        };
        self.folder.write(name, false, |out| out.write_all(&bytes))?;
        Ok(name.into())
    }

    /// The wall-clock time per node and substep [ns], or `None` if there was no step.
    fn nanoseconds(&self, nodes: usize) -> Option<f64> {
        let work = self.steps as f64 * nodes as f64;
        (work > 0.0).then(|| self.wall * 1e9 / work)
    }

    /// All warnings: about the call, the scene, the run and the world.
    fn all_warnings(&self, world: &dyn AnyWorld) -> Vec<WarningSummary> {
        self.reported.iter().chain(&world.warnings_at_the_end()).map(WarningSummary::from).collect()
    }

    /// Prints a short summary. Warnings that were reported early are not reported again.
    pub(crate) fn talk(&self, world: &dyn AnyWorld, early: &[Warning]) {
        let e = world.energy();
        let nodes: usize = world.bodies().into_iter().map(|body| world.node_count(body)).sum();
        let from = self.resumed_at.map_or(String::new(), |t| format!("{t:.3} s to "));
        let speed = match self.nanoseconds(nodes) {
            Some(nanoseconds) => {
                format!(" in {:.2} s ({} ns per node and step)", self.wall, rounded(nanoseconds, 3))
            }
            None if self.steps == 0 => ", no steps".into(),
            None => format!(" in {:.2} s", self.wall),
        };
        let by_the_rule = match e.loss_numerical {
            0.0 => String::new(),
            made if made < 0.0 => format!(", {} J added by the steps of its integrator", number(-made)),
            taken => format!(", {} J removed by the damping of its integrator", number(taken)),
        };
        eprintln!(
            "{}: {from}{:.3} s of {}{speed}\n  energy {} J; the ledger closes to {} % of the largest energy in motion ({} J {} by the integrator's \
             error{})",
            world.scene().name(),
            world.time(),
            counted(nodes as u64, "node", "nodes"),
            number(e.total()),
            rounded(100.0 * e.closure, 2),
            number(e.loss_integrator.abs()),
            if e.loss_integrator < 0.0 { "gained" } else { "lost" },
            by_the_rule,
        );
        print_late_warnings(world, early);
        self.print_paths();
    }

    /// Prints the folder of the output, and which files in it are pictures.
    pub(crate) fn print_paths(&self) {
        eprintln!("written to {}", self.folder.path("").display());
        let pictures = ["video.mp4", "video.gif", "strip.png", "plots.svg"];
        let there: Vec<&str> = pictures.into_iter().filter(|name| self.folder.path(name).is_file()).collect();
        if !there.is_empty() {
            eprintln!("  results: {}", there.join(", "));
        }
    }
}

/// Prints the warnings of a run that were not reported early.
pub(crate) fn print_late_warnings(world: &dyn AnyWorld, early: &[Warning]) {
    let warnings = world.warnings_at_the_end().into_iter();
    warnings.filter(|warning| !early.contains(warning)).for_each(|warning| print_warning(&warning));
}

/// Stress, von Mises stress and J of every node of a body. A row has no numbers if none of the cells at its node
/// has a stress.
fn stresses(world: &dyn AnyWorld, body: usize) -> Vec<Vec<f64>> {
    let dimension = world.scene().dimension();
    let row = |state: Option<NodeState>| {
        state.map_or(Vec::new(), |state| [state.components(dimension), vec![state.volume_ratio]].concat())
    };
    world.node_states(body).into_iter().map(row).collect()
}

/// Statistics of implicit integrators, if there are any.
fn solver_summary(world: &dyn AnyWorld) -> Option<SolverSummary> {
    let work = world.solver_work();
    (work.steps > 0).then_some(SolverSummary {
        systems: work.steps,
        newton_iterations: work.iterations,
        linear_iterations: work.linear_iterations,
        largest_residual: work.residual,
        accepted: work.accepted,
        halved: work.halved,
        cut_off: work.cut_off,
        largest_left: work.left,
        disturbed: work.disturbed,
        stayed_degenerate: work.stayed_degenerate,
    })
}

/// The quality of the cells of bodies at rest. If several copies share a mesh, the mesh is evaluated once.
pub(crate) fn cells(world: &dyn AnyWorld) -> Vec<CellSummary> {
    let mut seen = std::collections::BTreeSet::new();
    let mut found = Vec::new();
    for body in world.bodies().into_iter().filter_map(|body| world.scene().body(body)) {
        if !seen.insert(core::ptr::from_ref(body.cells())) {
            continue;
        }
        let Some(quality) = body.cell_quality() else { continue };
        found.push(CellSummary {
            body: body.name().into(),
            cells: quality.cells,
            smallest_angle: quality.smallest_angle.to_degrees(),
            largest_angle: quality.largest_angle.to_degrees(),
            shortest_edge: quality.shortest_edge,
            longest_edge: quality.longest_edge,
        });
    }
    found
}
