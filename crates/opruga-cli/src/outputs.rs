//! What a run leaves behind: tables, checkpoint, strip, video, plots.

use crate::arguments::Run;
use crate::failure::Failure;
use crate::run::Source;
use opruga::World;
use opruga::draw;
use opruga::io::checkpoint::Checkpoint;
use opruga::io::safe_write::OutputFolder;
use opruga::io::tables::{
    EnergySummary, FinalBody, MomentumSummary, NumberTable, Summary, WarningSummary, write_final,
};
use opruga::pictures::{Moment, Scenery};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The most memory that pictures may wait in [bytes]; longer or larger runs keep fewer of them.
const PICTURE_BYTES: u64 = 1 << 30;

/// Bodies whose volume and pressure get columns of their own.
const MOST_BODY_COLUMNS: usize = 64;

/// What is kept of every frame.
pub(crate) struct Recorder {
    pub(crate) table: NumberTable,
    /// Bodies with columns of their own, and how many.
    bodies: Vec<(usize, usize)>,
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

/// A checkpoint's payload: the snapshot and how the run was called.
pub(crate) struct SavedRun {
    pub(crate) name: String,
    pub(crate) overrides: Vec<(String, String)>,
    /// The files that the scene names.
    pub(crate) files: BTreeMap<String, Arc<[u8]>>,
    pub(crate) snapshot: Vec<u8>,
}

impl SavedRun {
    fn to_bytes(&self) -> Vec<u8> {
        let mut out = Vec::new();
        let mut part = |bytes: &[u8]| {
            out.extend((bytes.len() as u64).to_le_bytes());
            out.extend(bytes);
        };
        part(self.name.as_bytes());
        part(self.overrides.len().to_string().as_bytes());
        for (path, value) in &self.overrides {
            part(path.as_bytes());
            part(value.as_bytes());
        }
        part(self.files.len().to_string().as_bytes());
        for (name, bytes) in &self.files {
            part(name.as_bytes());
            part(bytes);
        }
        out.extend(&self.snapshot);
        out
    }
    /// Reads a payload; none if it has another form.
    pub(crate) fn read(mut bytes: &[u8]) -> Option<SavedRun> {
        let mut part = || {
            let (length, rest) = bytes.split_first_chunk::<8>()?;
            let (part, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
            bytes = rest;
            Some(part)
        };
        let mut text = || String::from_utf8(part()?.to_vec()).ok();
        let name = text()?;
        let count: usize = text()?.parse().ok()?;
        let mut overrides = Vec::new();
        for _ in 0..count {
            overrides.push((text()?, text()?));
        }
        let count: usize = text()?.parse().ok()?;
        let mut files = BTreeMap::new();
        for _ in 0..count {
            let name = String::from_utf8(part()?.to_vec()).ok()?;
            files.insert(name, Arc::from(part()?));
        }
        Some(SavedRun { name, overrides, files, snapshot: bytes.to_vec() })
    }
}

impl Recorder {
    /// Prepares the columns, and pictures at the wanted rate as far as memory allows.
    pub(crate) fn new<const D: usize>(world: &mut World<D>, call: &Run, frames: u64) -> Recorder {
        let axes = &["x", "y", "z"][..D];
        let mut columns: Vec<String> = ["time", "kinetic", "elastic", "gas", "gravity", "work_user", "work_gas"]
            .into_iter()
            .chain(["loss_damping", "loss_friction", "loss_contact", "loss_integrator", "closure"])
            .map(String::from)
            .collect();
        columns.extend(axes.iter().map(|a| format!("momentum.{a}")));
        columns.extend(angular_axes::<D>().iter().map(|a| format!("angular_momentum{a}")));
        // Bodies that commands add later have none: the head of the table is written for the whole run.
        let mut bodies = Vec::new();
        for body in 0..world.blueprint().bodies.len().min(MOST_BODY_COLUMNS) {
            let name = world.blueprint().bodies[body].name.clone();
            let readings = world.readings(body);
            columns.extend(readings.iter().map(|(what, _)| format!("{name}.{what}")));
            bodies.push((body, readings.len()));
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
        Recorder {
            table: NumberTable::new(columns),
            bodies,
            first_probe,
            scenery: (!call.no_pictures).then(|| Scenery::new(world)),
            moments: Vec::new(),
            every,
            frame,
            arrows: call.arrows,
            gif: call.gif,
        }
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
            e.loss_damping,
            e.loss_friction,
            e.loss_contact,
            e.loss_integrator,
            e.closure,
        ];
        row.extend(m.linear.0);
        row.extend(&m.angular[if D == 2 { 2..3 } else { 0..3 }]);
        for &(body, columns) in &self.bodies {
            let mut readings: Vec<f64> = world.readings(body).iter().map(|(_, x)| *x).collect();
            // A body that is gone leaves its columns empty.
            readings.resize(columns, f64::NAN);
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

fn angular_axes<const D: usize>() -> &'static [&'static str] {
    if D == 2 { &[""] } else { &[".x", ".y", ".z"] }
}

/// Where the files go and what they say of the run.
pub(crate) struct Outputs<'a> {
    pub(crate) folder: &'a OutputFolder,
    pub(crate) source: &'a Source,
    /// The files that the scene names.
    pub(crate) files: &'a BTreeMap<String, Arc<[u8]>>,
    pub(crate) set: &'a [(String, String)],
    pub(crate) wall: f64,
    pub(crate) steps: u64,
    pub(crate) stop: &'a AtomicBool,
}

impl Outputs<'_> {
    /// Writes every file; returns the summary as JSON.
    pub(crate) fn write<const D: usize>(&self, world: &mut World<D>, recorder: Recorder) -> Result<String, Failure> {
        let mut files = vec!["diagnostics.csv".to_string(), "final.csv".into(), "checkpoint".into()];
        self.folder.write("diagnostics.csv", false, |out| recorder.table.write(out))?;
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
        let saved = SavedRun {
            name: self.source.name.clone(),
            overrides: self.set.to_vec(),
            files: self.files.clone(),
            snapshot: world.snapshot(),
        };
        let checkpoint = Checkpoint { scene: self.source.text.clone(), payload: saved.to_bytes() };
        self.folder.write("checkpoint", true, |out| checkpoint.write(out))?;
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
        let work = self.steps as f64 * nodes as f64;
        Summary {
            scene: blueprint.name.clone(),
            dimension: D,
            bodies: world.bodies().count(),
            nodes,
            elements: world.bodies().map(|b| blueprint.bodies[b].mesh.edges(opruga::mesh::EdgeSet::All).len()).sum(),
            models,
            integrator: blueprint.integrator.kind().to_string(),
            frame: blueprint.time.frame,
            substeps: blueprint.time.substeps,
            h: world.h(),
            steps: self.steps,
            time: world.time(),
            wall_seconds: self.wall,
            nanoseconds_per_node_step: if work > 0.0 { self.wall * 1e9 / work } else { 0.0 },
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
            warnings: world
                .warnings()
                .into_iter()
                .map(|w| WarningSummary { code: w.code, message: w.message, count: w.count })
                .collect(),
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
        let rate = 1.0 / (recorder.every as f64 * recorder.frame);
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

    /// A few lines for people.
    pub(crate) fn talk<const D: usize>(&self, world: &World<D>) {
        let e = world.energy();
        let nodes: usize = world.bodies().map(|b| world.node_count(b)).sum();
        eprintln!(
            "{}: {:.3} s of {} nodes in {:.2} s ({:.2} ns per node and step), energy {:.6} J; {:.6} J unexplained, \
             {:.2e} of the most that moved",
            world.blueprint().name,
            world.time(),
            nodes,
            self.wall,
            self.wall * 1e9 / (self.steps.max(1) as f64 * nodes.max(1) as f64),
            e.total(),
            e.loss_integrator,
            e.closure,
        );
        for warning in world.warnings() {
            eprintln!("warning[{}]: {} ({} times)", warning.code, warning.message, warning.count);
        }
        eprintln!("written to {}", self.folder.path("").display());
    }
}
