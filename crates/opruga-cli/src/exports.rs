//! Frames of a world for other programs: one file a frame, or whole runs in one file.

use crate::arguments::Replay;
use crate::failure::Failure;
use opruga::World;
use opruga::blueprint::BodyBlueprint;
use opruga::io::safe_write::OutputFolder;
use opruga::io::series::{Format, Shape};
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
    let shape = |(&body, (positions, velocities))| {
        let body: &BodyBlueprint<D> = &blueprint.bodies[body];
        let (positions, velocities): (&Vec<[f64; D]>, &Vec<[f64; D]>) = (positions, velocities);
        let (name, mesh, translation) = (&body.name, &*body.mesh, body.translation);
        Shape { name, mesh, positions, velocities, translation, cell_fields: &[] }
    };
    let shapes: Vec<Shape<'_, D>> = bodies.iter().zip(x.iter().zip(&v)).map(shape).collect();
    folder.write(name, false, |out| format.write(out, &blueprint.name, world.time(), &shapes))?;
    Ok(())
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
