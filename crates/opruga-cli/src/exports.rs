//! Frames of a world for other programs: one file per frame, or whole runs in one file.

use crate::arguments::Replay;
use crate::errors::CallFault;
use crate::failure::Failure;
use opruga::io::output_folder::OutputFolder;
use opruga::io::series::{CellField, Format, Shape};
use opruga::io::tracks::{Track, write_glb};
use opruga::world::Vectors;
use opruga::{AnyBody, AnyWorld};
use std::collections::BTreeMap;

/// Whole runs are held in memory until their end, up to this many bytes of positions.
const MOST_BYTES: usize = 2 << 30;

/// Writes the present frame of a world.
pub(crate) fn frame(world: &dyn AnyWorld, format: Format, folder: &OutputFolder, name: &str) -> Result<(), Failure> {
    let (numbers, scene) = (world.bodies(), world.scene());
    let all = |vectors: fn(&dyn AnyWorld, usize) -> Vectors<'_>| -> Vec<Vec<[f64; 3]>> {
        numbers.iter().map(|&body| vectors(world, body).iter().collect()).collect()
    };
    let (x, v) = (all(|world, body| world.positions(body)), all(|world, body| world.velocities(body)));
    let bodies = numbers.iter().filter_map(|&number| Some((number, scene.body(number)?)));
    // The stresses in the cells of finite elements.
    let stresses: Vec<(&dyn AnyBody, Stresses)> =
        bodies.map(|(number, body)| (body, Stresses::of(world, number))).collect();
    let fields: Vec<Vec<CellField<'_>>> = stresses.iter().map(|(_, stresses)| stresses.fields()).collect();
    let rows = stresses.iter().zip(&fields).zip(x.iter().zip(&v));
    let shapes: Vec<Shape<'_>> = rows
        .map(|(((body, _), cell_fields), (positions, velocities))| Shape {
            body: *body,
            positions,
            velocities,
            cell_fields,
        })
        .collect();
    folder.write(name, false, |out| format.write(out, scene.name(), world.time(), &shapes))?;
    Ok(())
}

/// The stresses and the volume ratio of the cells of a body. The lists are empty if the body has no
/// finite elements.
#[derive(Default)]
struct Stresses {
    cauchy: Vec<f64>,
    von_mises: Vec<f64>,
    volume_ratio: Vec<f64>,
}

impl Stresses {
    /// The present stresses of a body, which are NaN for cells without finite elements.
    fn of(world: &dyn AnyWorld, body: usize) -> Stresses {
        let states = world.cell_states(body);
        if states.is_empty() {
            return Stresses::default();
        }
        let cells = world.scene().body(body).map_or(0, |body| body.cells().len());
        let (cauchy, each) = (vec![f64::NAN; 9 * cells], vec![f64::NAN; cells]);
        let mut out = Stresses { cauchy, von_mises: each.clone(), volume_ratio: each };
        for state in states {
            let cell = state.cell as usize;
            out.cauchy[9 * cell..9 * cell + 9].copy_from_slice(state.stress.as_flattened());
            out.von_mises[cell] = state.von_mises();
            out.volume_ratio[cell] = state.volume_ratio;
        }
        out
    }
    fn fields(&self) -> Vec<CellField<'_>> {
        if self.von_mises.is_empty() {
            return Vec::new();
        }
        vec![
            CellField { name: "Cauchy stress [Pa]", components: 9, values: &self.cauchy },
            CellField { name: "von Mises stress [Pa]", components: 1, values: &self.von_mises },
            CellField { name: "J", components: 1, values: &self.volume_ratio },
        ]
    }
}

/// The positions of the nodes of all bodies, frame by frame.
#[derive(Default)]
pub(crate) struct Tracks(BTreeMap<usize, Track>);

impl Tracks {
    /// Adds the present frame of a world.
    pub(crate) fn add(&mut self, world: &dyn AnyWorld) -> Result<(), Failure> {
        for number in world.bodies() {
            let Some(body) = world.scene().body(number) else { continue };
            let track = self.0.entry(number).or_insert_with(|| Track::new(body));
            let positions: Vec<[f64; 3]> = world.positions(number).iter().collect();
            track.add(world.time(), &positions);
        }
        let bytes: usize = self.0.values().map(Track::bytes).sum();
        if bytes > MOST_BYTES {
            return Err(Failure::call(CallFault::RunTooLong { bytes: MOST_BYTES }));
        }
        Ok(())
    }

    /// Writes the files that the call asks for.
    pub(crate) fn write(
        self,
        call: &Replay,
        folder: &OutputFolder,
        title: &str,
        files: &mut Vec<String>,
    ) -> Result<(), Failure> {
        let tracks: Vec<Track> = self.0.into_values().collect();
        if call.gltf {
            folder.write("run.glb", false, |out| write_glb(out, title, &tracks))?;
            files.push("run.glb".into());
        }
        for track in &tracks {
            // Names of bodies may contain characters that are not allowed in file names.
            let stem: String =
                track.name.chars().map(|c| if c.is_alphanumeric() || "-_ ".contains(c) { c } else { '_' }).collect();
            for (wanted, ending) in [(call.pc2, "pc2"), (call.mdd, "mdd")] {
                if wanted {
                    let name = format!("{stem}.{ending}");
                    folder.write(&name, false, |out| {
                        if ending == "pc2" { track.write_pc2(out) } else { track.write_mdd(out) }
                    })?;
                    files.push(name);
                }
            }
        }
        Ok(())
    }
}
