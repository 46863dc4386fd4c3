//! Checks that the bodies of a world fit into the allowed memory, before anything large is built.

use crate::blueprint::{Blueprint, BodyBlueprint};
use crate::build::build_integrator;
use crate::error::{Part, WorldError};
use crate::refusals::Refusal;
use crate::registry::Registry;
use opruga_core::error::BuildError;
use opruga_core::integrator::Integrator;
use opruga_core::memory::Counts;
use opruga_math::Lane;
use opruga_mesh::Mesh;
use std::sync::Arc;

/// An estimate of the memory of bodies: meshes, states, models, and workspaces of integrators.
struct Estimate<'a, const D: usize> {
    registry: &'a Registry<D>,
    /// The integrator of the scene.
    integrator: &'a dyn Integrator<D>,
    /// The mesh of the previous body: copies are adjacent and share their mesh.
    mesh: *const Mesh<D>,
    all: f64,
    largest: f64,
    /// The body that takes the most memory.
    name: &'a str,
}

impl<'a, const D: usize> Estimate<'a, D> {
    fn add(&mut self, body: &'a BodyBlueprint<D>) -> Result<(), WorldError> {
        let counts = Counts::of(&body.mesh);
        let needs = body.models.iter().filter_map(|values| self.registry.model(values.kind()));
        let needs = needs.map(|model| model.need(&counts));
        let (bytes, couplings) = needs.fold((0.0, 0.0), |sum, need| (sum.0 + need.bytes, sum.1 + need.couplings));
        let own = body.integrator.as_ref();
        let own = own
            .map(|values| build_integrator(self.registry, values, || Part::IntegratorOf { name: body.name.clone() }));
        let working = own.transpose()?.as_deref().unwrap_or(self.integrator).memory(&counts, couplings);
        let mesh = Arc::as_ptr(&body.mesh);
        let mesh_bytes = if mesh == self.mesh { 0.0 } else { counts.mesh_bytes::<D>() };
        self.mesh = mesh;
        let bytes = mesh_bytes + counts.state_bytes::<D>() + bytes + working;
        self.all += bytes;
        if bytes > self.largest {
            (self.largest, self.name) = (bytes, &body.name);
        }
        Ok(())
    }
}

/// The approximate maximum memory of the bodies of a world [bytes]: meshes, states, models, and workspaces of integrators.
///
/// # Errors
/// [`WorldError`] if there is no such integrator.
pub fn estimate<const D: usize>(blueprint: &Blueprint<D>, registry: &Registry<D>) -> Result<f64, WorldError> {
    let integrator = build_integrator(registry, &blueprint.integrator, || Part::Section { path: "integrator" })?;
    Ok(estimate_of(&blueprint.bodies, &*integrator, registry)?.all)
}

fn estimate_of<'a, const D: usize>(
    bodies: &'a [BodyBlueprint<D>],
    integrator: &'a dyn Integrator<D>,
    registry: &'a Registry<D>,
) -> Result<Estimate<'a, D>, WorldError> {
    let mut estimate = Estimate { registry, integrator, mesh: std::ptr::null(), all: 0.0, largest: 0.0, name: "" };
    for body in bodies {
        estimate.add(body)?;
    }
    Ok(estimate)
}

/// Refuses bodies that take more memory than is allowed, or more than the system provides.
///
/// # Errors
/// `limit.memory`, with the body that takes the most; [`WorldError`] if there is no such integrator.
pub(crate) fn check<const D: usize>(
    bodies: &[BodyBlueprint<D>],
    integrator: &dyn Integrator<D>,
    registry: &Registry<D>,
    most: Option<u64>,
) -> Result<(), WorldError> {
    let Estimate { all, largest, name, .. } = estimate_of(bodies, integrator, registry)?;
    let (shown, largest) = (format!("{all:.0}"), format!("{largest:.0}"));
    let refusal = match most {
        Some(most) if all > most as f64 => Refusal::SceneMemory { all: shown, body: name.into(), largest, most },
        _ if is_given(all) => return Ok(()),
        _ => Refusal::MachineMemory { all: shown, body: name.into(), largest },
    };
    Err(WorldError::Build { part: Part::body(name), source: BuildError::of("memory", refusal) })
}

/// Whether the system provides this memory: allocates it in one piece and frees it. Without this check, a lower limit of the system would abort the
/// program while it builds the world.
fn is_given(bytes: f64) -> bool {
    /// Smaller amounts are not tested, because without them the program does not work anyway.
    const LITTLE: f64 = 16_777_216.0;
    let mut probe: Vec<u8> = Vec::new();
    bytes < LITTLE || probe.try_reserve_exact(bytes.smaller(isize::MAX as f64) as usize).is_ok()
}
