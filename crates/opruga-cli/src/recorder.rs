//! The data collected during a run: rows of tables, and moments for pictures.

use crate::errors::{CallFault, CallNote, CallWarning};
use crate::failure::Failure;
use crate::failure::{print_note, print_warning};
use opruga::blueprint::Recorded;
use opruga::core::spec::Role;
use opruga::io::tables::NumberTable;
use opruga::math::words::rounded;
use opruga::pictures::{Moment, Scenery};
use opruga::{AnyBody, AnyWorld, Warning, draw};
use std::borrow::Cow;
use std::time::{Duration, Instant};

/// The memory limit for pictures that wait to be drawn [bytes]. Longer or larger runs keep fewer pictures.
const PICTURE_BYTES: u64 = 1 << 30;

/// The largest number of bodies whose volume and pressure get their own columns.
const MOST_BODY_COLUMNS: usize = 64;

/// The largest number of nodes that are sampled within frames over the whole run. Sampling a node takes as long as stepping it
/// a few times.
const LOOKED_AT: u64 = 4_000_000;

/// The largest number of rows from which plots are drawn.
const MOST_ROWS: u64 = 60_000;

/// The largest size of `diagnostics.csv` if the call does not ask for more [bytes]: two to three million numbers, which programs read in seconds.
/// Without this limit, a run with frames of 1e-8 s would write 330 MB (test: `diagnostics.rs`).
const MOST_TABLE_BYTES: u64 = 64 << 20;

/// The size of a number in the table [bytes]: a sign, 17 digits, point, exponent and comma.
const NUMBER_BYTES: u64 = 24;

/// The desired output of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Wanted {
    /// Pictures per second of simulated time, if the call gives the number.
    pub(crate) fps: Option<f64>,
    /// Whether the strip, the video and the plots are written.
    pub(crate) pictures: bool,
    pub(crate) arrows: bool,
    pub(crate) springs: bool,
    pub(crate) gif: bool,
    /// Whether to print notes for the user.
    pub(crate) notes: bool,
    /// The number of frames from one row of the table to the next, if the call gives it.
    pub(crate) row_every: Option<u32>,
}

/// Pictures per second of simulated time if the call does not give the number.
const USUAL_RATE: f64 = 20.0;

/// The data collected in every frame.
pub(crate) struct Recorder {
    /// The table `diagnostics.csv`, with a row for every frame that `rows` selects.
    pub(crate) table: NumberTable,
    /// The table for the plots. For small runs it also has rows for times within frames.
    pub(crate) seen: NumberTable,
    /// Whether the run is small enough for table rows at times within frames.
    pub(crate) looks_within: bool,
    pub(crate) columns: Columns,
    /// Bodies with columns of their own, and the number of these columns.
    bodies: Vec<(String, usize)>,
    pub(crate) scenery: Option<Scenery>,
    pub(crate) moments: Vec<Moment>,
    /// The number of frames of the scene between two pictures.
    pub(crate) every: u64,
    /// The length of a frame of the scene [s].
    pub(crate) frame: f64,
    arrows: bool,
    pub(crate) gif: bool,
    rows: Rows,
}

/// Which frames have a row of the table.
struct Rows {
    /// The number of frames from one row to the next.
    apart: u64,
    /// The size of a table with a row for every frame [bytes]. It is `None` if the call chooses the rows, or if the size is within the limit.
    too_many: Option<u64>,
    /// The last frame that has a row.
    last: Option<u64>,
    left_out: u64,
}

impl Rows {
    fn new(asked: Option<u32>, frames: u64, columns: u64) -> Rows {
        let bytes = (frames + 1).saturating_mul(columns * NUMBER_BYTES);
        let too_many = (asked.is_none() && bytes > MOST_TABLE_BYTES).then_some(bytes);
        let apart = asked.map_or_else(|| bytes.div_ceil(MOST_TABLE_BYTES).max(1), u64::from);
        Rows { apart, too_many, last: None, left_out: 0 }
    }

    /// Whether a frame has a row. The first frame has one. After that, the number of the frame decides, so that a resumed run has the same rows
    /// as an uninterrupted one.
    fn take(&mut self, frame: u64) -> bool {
        let wanted = self.last.is_none() || frame.is_multiple_of(self.apart);
        if wanted {
            self.last = Some(frame);
        } else {
            self.left_out += 1;
        }
        wanted
    }
}

/// The meanings of the columns of the table.
pub(crate) struct Columns {
    /// For each of the last columns, the quantity that its probe measures.
    pub(crate) probes: Vec<Recorded>,
    pub(crate) dimension: usize,
    pub(crate) length_unit: String,
    /// The authors of the drawings, maps or surfaces in the scene.
    pub(crate) credit: String,
    /// Whether y points downwards in pictures.
    pub(crate) y_down: bool,
    /// The bodies with columns of their own. For each body: the thickness [m], and whether it is a body of the thesis, whose volume and pressure
    /// have other meanings.
    pub(crate) bodies: Vec<(String, f64, bool)>,
}

impl Recorder {
    /// Prepares the columns, and pictures at the desired rate if memory allows it. Refuses a rate that no film can have.
    pub(crate) fn new(world: &mut dyn AnyWorld, wanted: Wanted, frames: u64) -> Result<Recorder, Failure> {
        let Wanted { fps: asked, pictures: drawn, arrows, springs, gif, notes, row_every } = wanted;
        let fps = asked.unwrap_or(USUAL_RATE);
        let dimension = world.scene().dimension();
        let axes = &["x", "y", "z"][..dimension];
        let mut columns: Vec<String> =
            ["time", "kinetic", "elastic", "gas", "gravity", "work_user", "work_gas", "work_correction"]
                .into_iter()
                .chain([
                    "loss_damping",
                    "loss_friction",
                    "loss_contact",
                    "loss_numerical",
                    "loss_integrator",
                    "closure",
                ])
                .map(String::from)
                .collect();
        columns.extend(axes.iter().map(|a| format!("momentum.{a}")));
        columns.extend(angular_axes(dimension).iter().map(|a| format!("angular_momentum{a}")));
        // Bodies that commands add later have columns from the start, because the header of the table is written for the whole run.
        let (mut bodies, mut meanings) = (Vec::new(), Vec::new());
        let mut add = |body: &dyn AnyBody, readings: Vec<Cow<'static, str>>| {
            columns.extend(readings.iter().map(|what| format!("{}.{what}", body.name())));
            meanings.push((body.name().to_string(), body.thickness(), body.has_role(Role::Published)));
            bodies.push((body.name().to_string(), readings.len()));
        };
        let present = world.scene().body_count();
        for number in 0..present.min(MOST_BODY_COLUMNS) {
            let readings = world.readings(number).into_iter().map(|(what, _)| what).collect();
            if let Some(body) = world.scene().body(number) {
                add(body, readings);
            }
        }
        let coming = world.coming_bodies().into_iter().take(MOST_BODY_COLUMNS.saturating_sub(present));
        for (number, body) in coming.enumerate() {
            // A body whose model cannot be built is reported when it is added.
            add(body, world.reading_names_of(present + number));
        }
        columns.extend(world.scene().probe_columns().into_iter().flatten());
        let recorded = world.scene().probe_records().into_iter().flatten();
        let probes = recorded.flat_map(|what| what.columns(dimension).iter().map(|_| *what)).collect();
        let nodes: usize = world.bodies().into_iter().map(|body| world.node_count(body)).sum();
        let frame = world.scene().time().frame;
        let wanted = ((1.0 / fps / frame).round() as u64).max(1);
        let pictures = frames / wanted + 1;
        let bytes = pictures * (nodes * (dimension + 1) * 4) as u64;
        let every = wanted * bytes.div_ceil(PICTURE_BYTES).max(1);
        if drawn && every > wanted {
            print_warning(&Warning::new(CallWarning::PicturesThinned { nodes, mebibytes: bytes >> 20, every }, 1));
        }
        let rate = film_rate(every, frame);
        if drawn && draw::Mp4Writer::new(std::io::sink(), [16, 16], rate).is_err() {
            let (rate, fps, frame) = (format!("{rate:e}"), fps.to_string(), frame.to_string());
            return Err(Failure::call(CallFault::FilmRate { rate, fps, frame }));
        }
        if every == wanted
            && let Some(note) = asked.and_then(|asked| other_rate(asked, every, frame)).filter(|_| notes)
        {
            print_note(&note);
        }
        let mut scenery = drawn.then(|| Scenery::new(world));
        if springs {
            scenery.iter_mut().for_each(|scenery| scenery.show_springs(world));
        }
        let looks = look_every(frames, world.scene().time().substeps, nodes as u64);
        if drawn {
            world.keep_looks(looks);
        }
        let rows = Rows::new(row_every, frames, columns.len() as u64);
        Ok(Recorder {
            rows,
            table: NumberTable::new(columns.clone()),
            seen: NumberTable::new(columns),
            columns: Columns {
                probes,
                dimension,
                length_unit: world.scene().length_unit().to_string(),
                credit: world.scene().credit().to_string(),
                y_down: scenery.as_ref().is_some_and(Scenery::y_down),
                bodies: meanings,
            },
            bodies,
            scenery,
            looks_within: drawn && looks > 0,
            moments: Vec::new(),
            every,
            frame,
            arrows,
            gif,
        })
    }

    /// Collects the data of the present frame, and of moments within this frame. Returns how long this took.
    pub(crate) fn record(&mut self, world: &mut dyn AnyWorld) -> Duration {
        let begin = Instant::now();
        let (bodies, seen) = (&self.bodies, &mut self.seen);
        world.look_within(&mut |world| seen.push(&row(world, bodies)));
        if self.rows.take(world.frames()) {
            let row = row(world, bodies);
            if self.scenery.is_some() {
                seen.push(&row);
            }
            self.table.push(&row);
        }
        if let Some(scenery) = &self.scenery
            && world.frames().is_multiple_of(self.every)
        {
            self.moments.push(scenery.capture(world, self.arrows));
        }
        begin.elapsed()
    }

    /// Completes the table with the row of the last frame.
    pub(crate) fn finish(&mut self, world: &mut dyn AnyWorld) {
        if self.rows.last.is_some_and(|last| last != world.frames()) {
            let row = row(world, &self.bodies);
            self.table.push(&row);
            if self.scenery.is_some() {
                self.seen.push(&row);
            }
            self.rows.last = Some(world.frames());
            self.rows.left_out = self.rows.left_out.saturating_sub(1);
        }
    }

    /// The warning that frames have no row although this was not requested.
    pub(crate) fn thinned(&self) -> Option<Warning> {
        let [megabytes, most] = [self.rows.too_many?, MOST_TABLE_BYTES].map(|bytes| bytes / 1_000_000);
        Some(Warning::new(CallWarning::Thinned { megabytes, most, apart: self.rows.apart }, self.rows.left_out))
    }
}

/// Pictures per second of simulated time if one in `every` frames is kept.
pub(crate) fn film_rate(every: u64, frame: f64) -> f64 {
    1.0 / (every as f64 * frame)
}

/// The note if pictures have another rate than requested.
fn other_rate(asked: f64, every: u64, frame: f64) -> Option<CallNote> {
    let rate = film_rate(every, frame);
    (rounded(rate, 4) != rounded(asked, 4)).then_some(CallNote::OtherRate { rate, asked, every, frame })
}

/// The number of substeps between two samples within a frame, which make small runs show every oscillation. It is 0 if there are no such samples.
fn look_every(frames: u64, substeps: u32, nodes: u64) -> u32 {
    let steps = frames * u64::from(substeps);
    let rows = (LOOKED_AT / nodes.max(1)).min(MOST_ROWS);
    let every = steps.div_ceil(rows.max(1));
    if every < u64::from(substeps) { every.max(1) as u32 } else { 0 }
}

/// The row of a table for the present state.
fn row(world: &mut dyn AnyWorld, bodies: &[(String, usize)]) -> Vec<f64> {
    let e = world.energy();
    let [linear, angular] = world.momentum();
    let dimension = world.scene().dimension();
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
        e.loss_numerical,
        e.loss_integrator,
        e.closure,
    ];
    row.extend(&linear[..dimension]);
    row.extend(&angular[if dimension == 2 { 2..3 } else { 0..3 }]);
    for (name, columns) in bodies {
        let body = world.body(name);
        let mut readings: Vec<f64> =
            body.map_or_else(Vec::new, |b| world.readings(b).iter().map(|(_, x)| *x).collect());
        // A body that does not exist yet, or no longer exists, has empty columns.
        readings.resize(*columns, f64::NAN);
        row.extend(readings);
    }
    for probe in 0..world.scene().probe_records().len() {
        row.extend(world.probe(probe).into_iter().map(|(_, x)| x));
    }
    row
}

fn angular_axes(dimension: usize) -> &'static [&'static str] {
    if dimension == 2 { &[""] } else { &[".x", ".y", ".z"] }
}

#[cfg(test)]
mod tests {
    use super::{MOST_TABLE_BYTES, NUMBER_BYTES, Rows, look_every, other_rate};

    /// However short frames are, the table respects its limit, and every frame has a row or is counted.
    #[test]
    fn a_table_keeps_to_its_size_and_counts_what_it_leaves_out() {
        for (frames, columns) in [(1_000_000, 18), (480, 18), (1_000_000_000, 40)] {
            let mut rows = Rows::new(None, frames, columns);
            let most = frames / rows.apart + 2;
            assert!(most * columns * NUMBER_BYTES <= MOST_TABLE_BYTES + 2 * columns * NUMBER_BYTES, "{frames}");
            assert_eq!(rows.too_many.is_some(), rows.apart > 1);
            let shown = (0..1_000).filter(|frame| rows.take(*frame)).count() as u64;
            assert_eq!(shown + rows.left_out, 1_000);
        }
        assert_eq!((Rows::new(None, 480, 18).apart, Rows::new(None, 1_000_000, 18).apart), (1, 7));
        let asked = Rows::new(Some(1), 1_000_000_000, 18);
        assert_eq!((asked.apart, asked.too_many), (1, None));
    }

    /// Frames of 1/60 s give 12 pictures per second if 11.3 are requested, and never more than 60.
    #[test]
    fn a_rate_that_frames_do_not_have_is_told() {
        let frame = 1.0 / 60.0;
        for (asked, every) in [(20.0, 3), (60.0, 1), (12.0, 5), (15.0, 4), (30.0, 2)] {
            assert_eq!(other_rate(asked, every, frame), None, "{asked}");
        }
        assert_eq!(
            other_rate(11.3, 5, frame).expect("it is told").to_string(),
            "there are 12 pictures per second, not 11.3 (--fps): the time between two pictures is a whole number of frames of the scene, here \
             5 frames of 0.01667 s each"
        );
        let most = other_rate(240.0, 1, frame).expect("it is told").to_string();
        assert!(
            most.starts_with("there are 60 pictures per second, not 240") && most.contains("here 1 frame of"),
            "{most}"
        );
    }

    #[test]
    fn small_runs_are_seen_at_every_substep_and_large_ones_only_between_frames() {
        assert_eq!(look_every(480, 32, 36), 1);
        assert_eq!(look_every(240, 40, 1926), 5);
        assert_eq!(look_every(240, 32, 36_000), 0);
        assert_eq!(look_every(0, 32, 36), 1);
        assert_eq!(look_every(10, 1, 36), 0);
    }
}
