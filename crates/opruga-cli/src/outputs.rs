//! What a run leaves behind: tables, checkpoint, strip, video, plots.

use crate::arguments::Run;
use crate::checkpoints::{Keeper, NAME, PREVIOUS};
use crate::failure::Failure;
use crate::source::Source;
use opruga::World;
use opruga::draw;
use opruga::io::safe_write::OutputFolder;
use opruga::io::tables::{
    EnergySummary, FinalBody, MomentumSummary, NumberTable, Summary, WarningSummary, write_final,
};
use opruga::pictures::{Moment, Scenery};
use std::sync::atomic::{AtomicBool, Ordering};

/// The most memory that pictures may wait in [bytes]; longer or larger runs keep fewer of them.
const PICTURE_BYTES: u64 = 1 << 30;

/// Bodies whose volume and pressure get columns of their own.
const MOST_BODY_COLUMNS: usize = 64;

/// What is kept of every frame.
pub(crate) struct Recorder {
    pub(crate) table: NumberTable,
    /// Bodies with columns of their own, and how many.
    bodies: Vec<(String, usize)>,
    /// The first column of the table that belongs to a probe.
    first_probe: usize,
    scenery: Option<Scenery>,
    moments: Vec<Moment>,
    /// Frames of the scene between two pictures.
    every: u64,
    /// The length of a frame of the scene [s].
    frame: f64,
    arrows: bool,
    gif: bool,
}

impl Recorder {
    /// Prepares the columns, and pictures at the wanted rate as far as memory allows; refuses a rate that no film can have.
    pub(crate) fn new<const D: usize>(world: &mut World<D>, call: &Run, frames: u64) -> Result<Recorder, Failure> {
        let axes = &["x", "y", "z"][..D];
        let mut columns: Vec<String> =
            ["time", "kinetic", "elastic", "gas", "gravity", "work_user", "work_gas", "work_correction"]
                .into_iter()
                .chain(["loss_damping", "loss_friction", "loss_contact", "loss_integrator", "closure"])
                .map(String::from)
                .collect();
        columns.extend(axes.iter().map(|a| format!("momentum.{a}")));
        columns.extend(angular_axes::<D>().iter().map(|a| format!("angular_momentum{a}")));
        // Bodies that commands will add have theirs from the start: the head of the table is written for the whole run.
        let mut bodies = Vec::new();
        let mut add = |name: &str, readings: Vec<&'static str>| {
            columns.extend(readings.iter().map(|what| format!("{name}.{what}")));
            bodies.push((name.to_string(), readings.len()));
        };
        let present = world.blueprint().bodies.len();
        for body in 0..present.min(MOST_BODY_COLUMNS) {
            let readings = world.readings(body).into_iter().map(|(what, _)| what).collect();
            add(&world.blueprint().bodies[body].name, readings);
        }
        for body in world.coming_bodies().take(MOST_BODY_COLUMNS.saturating_sub(present)) {
            // A body for which a model cannot be built is told when it comes.
            add(&body.name, world.reading_names(body).unwrap_or_default());
        }
        let first_probe = columns.len();
        for probe in 0..world.blueprint().probes.len() {
            columns.extend(world.probe(probe).into_iter().map(|(name, _)| name));
        }
        let nodes: usize = world.bodies().map(|b| world.node_count(b)).sum();
        let frame = world.blueprint().time.frame;
        let wanted = ((1.0 / call.fps / frame).round() as u64).max(1);
        let pictures = frames / wanted + 1;
        let bytes = pictures * (nodes * D * 4) as u64;
        let every = wanted * bytes.div_ceil(PICTURE_BYTES).max(1);
        if every > wanted {
            eprintln!(
                "warning: pictures of {nodes} nodes would take {} MiB; every {every}th frame is kept",
                bytes >> 20
            );
        }
        let rate = film_rate(every, frame);
        if !call.no_pictures && draw::Mp4Writer::new(std::io::sink(), [16, 16], rate).is_err() {
            return Err(Failure::Call {
                message: format!(
                    "no film can have {rate:e} pictures per second: --fps {}, frames of {frame} s",
                    call.fps
                ),
                hint: Some("0.0001 to 10000 are possible; --no-pictures does without a film".into()),
            });
        }
        Ok(Recorder {
            table: NumberTable::new(columns),
            bodies,
            first_probe,
            scenery: (!call.no_pictures).then(|| Scenery::new(world)),
            moments: Vec::new(),
            every,
            frame,
            arrows: call.arrows,
            gif: call.gif,
        })
    }

    /// Keeps what there is to see of the present frame.
    pub(crate) fn record<const D: usize>(&mut self, world: &mut World<D>) {
        let e = world.energy();
        let m = world.momentum();
        let mut row = vec![
            world.time(),
            e.kinetic,
            e.elastic,
            e.gas,
            e.gravity,
            e.work_user,
            e.work_gas,
            e.work_correction,
            e.loss_damping,
            e.loss_friction,
            e.loss_contact,
            e.loss_integrator,
            e.closure,
        ];
        row.extend(m.linear.0);
        row.extend(&m.angular[if D == 2 { 2..3 } else { 0..3 }]);
        for (name, columns) in &self.bodies {
            let body = world.body(name);
            let mut readings: Vec<f64> =
                body.map_or_else(Vec::new, |b| world.readings(b).iter().map(|(_, x)| *x).collect());
            // A body that is not there yet, or no longer, leaves its columns empty.
            readings.resize(*columns, f64::NAN);
            row.extend(readings);
        }
        for probe in 0..world.blueprint().probes.len() {
            row.extend(world.probe(probe).into_iter().map(|(_, x)| x));
        }
        self.table.push(&row);
        if let Some(scenery) = &self.scenery
            && world.frames().is_multiple_of(self.every)
        {
            self.moments.push(scenery.capture(world, self.arrows));
        }
    }
}

/// Pictures per second of simulated time, if every so manieth frame is kept.
fn film_rate(every: u64, frame: f64) -> f64 {
    1.0 / (every as f64 * frame)
}

fn angular_axes<const D: usize>() -> &'static [&'static str] {
    if D == 2 { &[""] } else { &[".x", ".y", ".z"] }
}

/// Where the files go and what they say of the run.
pub(crate) struct Outputs<'a> {
    pub(crate) folder: &'a OutputFolder,
    pub(crate) source: &'a Source,
    pub(crate) wall: f64,
    pub(crate) steps: u64,
    /// The time of the checkpoint that the run went on from [s].
    pub(crate) resumed_at: Option<f64>,
    /// What was odd in the call and in the scene, and went wrong on the way; all of it was told when it was found.
    pub(crate) told: Vec<WarningSummary>,
    pub(crate) stop: &'a AtomicBool,
}

impl Outputs<'_> {
    /// Writes every file; returns the summary as JSON.
    pub(crate) fn write<const D: usize>(
        &self,
        world: &mut World<D>,
        recorder: Recorder,
        keeper: &mut Keeper<'_>,
    ) -> Result<String, Failure> {
        let mut files = vec!["diagnostics.csv".to_string(), "final.csv".into(), NAME.into()];
        keeper.write(world, &recorder.table)?;
        if self.folder.path(PREVIOUS).exists() {
            files.push(PREVIOUS.into());
        }
        let numbers: Vec<usize> = world.bodies().collect();
        let nodes = |body: usize| 0..world.node_count(body) as u32;
        let of = |vector: &dyn Fn(usize, u32) -> [f64; D]| -> Vec<Vec<[f64; D]>> {
            numbers.iter().map(|&b| nodes(b).map(|n| vector(b, n)).collect()).collect()
        };
        let (x, v) = (of(&|b, n| world.position(b, n)), of(&|b, n| world.velocity(b, n)));
        let rows = numbers.iter().zip(x.iter().zip(&v)).map(|(&body, (positions, velocities))| FinalBody {
            name: &world.blueprint().bodies[body].name,
            positions,
            velocities,
        });
        self.folder.write("final.csv", false, |out| write_final(out, rows))?;
        if let Some(scenery) = &recorder.scenery {
            self.pictures(scenery, &recorder, &mut files)?;
        }
        files.push("summary.json".into());
        let summary = self.summary(world, files);
        self.folder.write("summary.json", false, |out| summary.write(out))?;
        Ok(serde_json::to_string_pretty(&summary.to_json()).unwrap_or_default())
    }

    fn summary<const D: usize>(&self, world: &World<D>, files: Vec<String>) -> Summary {
        let blueprint = world.blueprint();
        let nodes: usize = world.bodies().map(|b| world.node_count(b)).sum();
        let e = world.energy();
        let m = world.momentum();
        let mut models: Vec<String> =
            world.bodies().flat_map(|b| blueprint.bodies[b].models.iter().map(|v| v.kind().to_string())).collect();
        models.sort();
        models.dedup();
        Summary {
            scene: blueprint.name.clone(),
            dimension: D,
            bodies: world.bodies().count(),
            nodes,
            elements: world.bodies().map(|b| blueprint.bodies[b].mesh.edges(opruga::mesh::EdgeSet::All).len()).sum(),
            models,
            integrator: world.integrators().join(", "),
            frame: blueprint.time.frame,
            substeps: blueprint.time.substeps,
            h: world.h(),
            steps: self.steps,
            time: world.time(),
            wall_seconds: self.wall,
            resumed_at: self.resumed_at,
            nanoseconds_per_node_step: self.nanoseconds(nodes),
            simd: world.simd().name().into(),
            threads: world.threads(),
            reproducibility: "everywhere".into(),
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
                loss_integrator: e.loss_integrator,
                closure: e.closure,
            },
            momentum: MomentumSummary {
                linear: m.linear.0.to_vec(),
                angular: if D == 2 { vec![m.angular[2]] } else { m.angular.to_vec() },
            },
            state_hash: format!("{:016x}", world.state_hash()),
            warnings: self.all_warnings(world),
            files,
        }
    }

    /// Strip, video and plots.
    fn pictures(&self, scenery: &Scenery, recorder: &Recorder, files: &mut Vec<String>) -> Result<(), Failure> {
        let draw_failed = |e: draw::DrawError| Failure::Draw(e.to_string());
        let plots =
            crate::plots::of_run(&recorder.table, recorder.first_probe, &self.source.name).map_err(draw_failed)?;
        self.folder.write("plots.svg", false, |out| out.write_all(plots.as_bytes()))?;
        files.push("plots.svg".into());
        let moments = &recorder.moments;
        if moments.is_empty() {
            return Ok(());
        }
        let pictures: Vec<draw::Picture> = draw::spread(moments, 60).into_iter().map(|m| scenery.picture(m)).collect();
        let view = match draw::View::fit(&pictures) {
            Ok(view) => view,
            Err(nothing @ draw::DrawError::Empty(_)) => {
                eprintln!("note: no strip and no video: {nothing}");
                return Ok(());
            }
            Err(error) => return Err(draw_failed(error)),
        };
        let panels = draw::spread(&pictures, 10);
        let strip = draw::strip(&panels, &view, &draw::StripStyle::default()).map_err(draw_failed)?;
        let png = strip.to_png().map_err(draw_failed)?;
        self.folder.write("strip.png", false, |out| out.write_all(&png))?;
        files.push("strip.png".into());
        if !self.stop.load(Ordering::Relaxed) {
            files.push(self.video(scenery, recorder, &view)?);
        }
        Ok(())
    }

    /// The animation of the run, drawn frame by frame.
    fn video(&self, scenery: &Scenery, recorder: &Recorder, view: &draw::View) -> Result<String, Failure> {
        let draw_failed = |e: draw::DrawError| Failure::Draw(e.to_string());
        let [width, height] = if recorder.gif { [640, 480] } else { [800, 600] };
        let style = draw::Style { width, height, ..draw::Style::default() };
        let draw_moment = |moment: &Moment| draw::draw(&scenery.picture(moment), view, &style).map_err(draw_failed);
        let rate = film_rate(recorder.every, recorder.frame);
        let every = |take: &mut dyn FnMut(&draw::Image) -> Result<(), draw::DrawError>| -> Result<(), Failure> {
            for (number, moment) in recorder.moments.iter().enumerate() {
                // An interrupted film is cut short, but a film has at least one frame.
                if number > 0 && self.stop.load(Ordering::Relaxed) {
                    break;
                }
                take(&draw_moment(moment)?).map_err(draw_failed)?;
            }
            Ok(())
        };
        let mut bytes = Vec::new();
        let name = if recorder.gif {
            let samples: Vec<draw::Image> =
                draw::spread(&recorder.moments, 6).into_iter().map(draw_moment).collect::<Result<_, _>>()?;
            let mut writer = draw::GifWriter::new(&mut bytes, rate, &samples).map_err(draw_failed)?;
            every(&mut |image| writer.push(image))?;
            "video.gif"
        } else {
            let mut writer = draw::Mp4Writer::new(&mut bytes, [width, height], rate).map_err(draw_failed)?;
            every(&mut |image| writer.push(image))?;
            writer.finish().map_err(draw_failed)?;
            "video.mp4"
        };
        self.folder.write(name, false, |out| out.write_all(&bytes))?;
        Ok(name.into())
    }

    /// Wall-clock time per node and substep [ns]; none where there was no such work.
    fn nanoseconds(&self, nodes: usize) -> Option<f64> {
        let work = self.steps as f64 * nodes as f64;
        (work > 0.0).then(|| self.wall * 1e9 / work)
    }

    /// What was odd: in the call, in the scene, on the way, in the world.
    fn all_warnings<const D: usize>(&self, world: &World<D>) -> Vec<WarningSummary> {
        let of_world = world.warnings().into_iter();
        let of_world = of_world.map(|w| WarningSummary { code: w.code, message: w.message, count: w.count });
        self.told.iter().cloned().chain(of_world).collect()
    }

    /// A few lines for people.
    pub(crate) fn talk<const D: usize>(&self, world: &World<D>) {
        let e = world.energy();
        let nodes: usize = world.bodies().map(|b| world.node_count(b)).sum();
        let from = self.resumed_at.map_or(String::new(), |t| format!("{t:.3} s to "));
        let speed = match self.nanoseconds(nodes) {
            Some(nanoseconds) => format!(" in {:.2} s ({nanoseconds:.2} ns per node and step)", self.wall),
            None if self.steps == 0 => ", no steps".into(),
            None => format!(" in {:.2} s", self.wall),
        };
        eprintln!(
            "{}: {from}{:.3} s of {}{speed}, energy {:.6} J; {:.6} J unexplained, {:.2e} of the most that moved",
            world.blueprint().name,
            world.time(),
            counted(nodes as u64, "node", "nodes"),
            e.total(),
            e.loss_integrator,
            e.closure,
        );
        for warning in world.warnings() {
            let times = if warning.count > 1 { format!(" ({} times)", warning.count) } else { String::new() };
            eprintln!("warning[{}]: {}{times}", warning.code, warning.message);
        }
        self.say_where();
    }

    /// Where the output lies.
    pub(crate) fn say_where(&self) {
        eprintln!("written to {}", self.folder.path("").display());
    }
}

/// `1 node`, `2 nodes`.
pub(crate) fn counted(count: u64, one: &str, many: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { many })
}
