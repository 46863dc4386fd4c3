//! Frames of a world for other programs: one file a frame, or whole runs in one file.

use crate::arguments::Replay;
use crate::failure::Failure;
use opruga::World;
use opruga::blueprint::BodyBlueprint;
use opruga::io::output_folder::OutputFolder;
use opruga::io::series::{CellField, Format, Shape};
use opruga::io::tracks::{Track, write_glb};
use std::collections::BTreeMap;

/// Whole runs are held in memory until their end: up to so many bytes of positions.
const MOST_BYTES: usize = 2 << 30;

/// Writes the present frame of a world.
pub(crate) fn frame<const D: usize>(
    world: &World<D>,
    format: Format,
    folder: &OutputFolder,
    name: &str,
) -> Result<(), Failure> {
    let bodies: Vec<usize> = world.bodies().collect();
    let of = |vector: &dyn Fn(usize, u32) -> [f64; D]| -> Vec<Vec<[f64; D]>> {
        bodies.iter().map(|&b| (0..world.node_count(b) as u32).map(|n| vector(b, n)).collect()).collect()
    };
    let (x, v) = (of(&|b, n| world.position(b, n)), of(&|b, n| world.velocity(b, n)));
    let blueprint = world.blueprint();
    // What finite elements say of their cells.
    let stresses: Vec<Stresses> = bodies.iter().map(|&body| Stresses::of(world, body)).collect();
    let fields: Vec<Vec<CellField<'_>>> = stresses.iter().map(Stresses::fields).collect();
    let shape = |((&body, cell_fields), (positions, velocities))| {
        let cell_fields: &Vec<CellField<'_>> = cell_fields;
        let body: &BodyBlueprint<D> = &blueprint.bodies[body];
        let (positions, velocities): (&Vec<[f64; D]>, &Vec<[f64; D]>) = (positions, velocities);
        let (name, mesh, translation) = (&body.name, &*body.mesh, body.translation);
        Shape { name, mesh, positions, velocities, translation, cell_fields }
    };
    let shapes: Vec<Shape<'_, D>> = bodies.iter().zip(&fields).zip(x.iter().zip(&v)).map(shape).collect();
    folder.write(name, false, |out| format.write(out, &blueprint.name, world.time(), &shapes))?;
    Ok(())
}

/// Stress and volume ratio of the cells of a body; empty where it has no finite elements.
#[derive(Default)]
struct Stresses {
    cauchy: Vec<f64>,
    von_mises: Vec<f64>,
    volume_ratio: Vec<f64>,
}

impl Stresses {
    /// Those of a body now; cells without finite elements have no number.
    fn of<const D: usize>(world: &World<D>, body: usize) -> Stresses {
        let states = world.cell_states(body);
        if states.is_empty() {
            return Stresses::default();
        }
        let cells = world.blueprint().bodies[body].mesh.cells.len();
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

/// Where the nodes of all bodies were, frame by frame.
#[derive(Default)]
pub(crate) struct Tracks(BTreeMap<usize, Track>);

impl Tracks {
    /// Adds the present frame of a world.
    pub(crate) fn add<const D: usize>(&mut self, world: &World<D>) -> Result<(), Failure> {
        for body in world.bodies() {
            let of = &world.blueprint().bodies[body];
            let track = self.0.entry(body).or_insert_with(|| Track::new(&of.name, &of.mesh));
            let positions: Vec<[f64; D]> =
                (0..world.node_count(body) as u32).map(|node| world.position(body, node)).collect();
            track.add(world.time(), &positions);
        }
        let bytes: usize = self.0.values().map(Track::bytes).sum();
        if bytes > MOST_BYTES {
            let message = format!("--gltf, --pc2 and --mdd hold the whole run in memory, more than {MOST_BYTES} bytes");
            return Err(Failure::Call { message, hint: Some("a lower --fps, or --from and --to".into()) });
        }
        Ok(())
    }

    /// Writes what the call asks for.
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
            // Names of bodies may hold what names of files may not.
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
