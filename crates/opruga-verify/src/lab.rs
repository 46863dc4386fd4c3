//! Builds a world from the text of a scene, and reads results from it.

use opruga::blueprint::{AnyBlueprint, Blueprint};
use opruga::core::spec::{Role, Value};
use opruga::io::{Files, scene};
use opruga::mesh::Mesh;
use opruga::{Options, Registries, Registry, Simd, World, catalogue_of};
use std::sync::Arc;

/// The reason why a case has no numbers.
pub type Trouble = Box<dyn std::error::Error + Send + Sync>;

/// The settings with which scenes are run.
#[derive(Clone, Debug)]
pub struct Lab {
    /// The vector instructions; `None` stands for the best that the processor supports.
    pub simd: Option<Simd>,
    /// A factor on the shear modulus of every solid and on the stiffness of every spring and hinge; the default is 1. Another factor shows which
    /// cases would detect an error of that size.
    pub stiffer: f64,
    /// The models and integrators that scenes can name.
    pub registries: Registries,
}

impl Default for Lab {
    fn default() -> Lab {
        Lab { simd: None, stiffer: 1.0, registries: Registries::default() }
    }
}

/// A scene as text, with the meshes that it names.
pub(crate) struct Scene {
    pub(crate) text: String,
    files: Vec<(String, Arc<[u8]>)>,
}

impl Scene {
    /// A scene that is stepped through time; `rule` is the integrator, with its further fields on separate lines.
    pub(crate) fn new(dimension: usize, frame: f64, substeps: u32, rule: &str) -> Scene {
        let (kind, fields) = rule.split_once('\n').unwrap_or((rule, ""));
        let text = format!(
            "format = \"opruga-1\"\ndimension = {dimension}\n[time]\nseconds = 1.0\nframe = {frame:?}\nsubsteps = {substeps}\n\
             [integrator]\nkind = \"{kind}\"\n{fields}\n"
        );
        Scene { text, files: Vec::new() }
    }

    /// A scene of statics: every frame lasts 1 s and ends in the equilibrium for the loads and pins at that time. The tolerance is relative to the
    /// extent of the body.
    pub(crate) fn statics(dimension: usize, tolerance: f64) -> Scene {
        Scene::new(dimension, 1.0, 1, &format!("equilibrium\ntolerance = {tolerance:?}"))
    }

    /// Appends text.
    pub(crate) fn add(mut self, text: &str) -> Scene {
        self.text.push_str(text);
        self.text.push('\n');
        self
    }

    /// Adds a file that the scene refers to.
    pub(crate) fn file(mut self, name: &str, text: String) -> Scene {
        self.files.push((name.into(), text.into_bytes().into()));
        self
    }

    /// Adds a body with a mesh, and its further fields on separate lines.
    pub(crate) fn body<const D: usize>(self, mesh: &Mesh<D>, rest: &str) -> Result<Scene, Trouble> {
        self.named("body", mesh, rest)
    }

    /// Adds a body with a name, a mesh and further fields.
    pub(crate) fn named<const D: usize>(mut self, body: &str, mesh: &Mesh<D>, rest: &str) -> Result<Scene, Trouble> {
        let written = opruga::io::meshes::write(mesh, "vtk").map_err(|e| e.to_string())?;
        let name = format!("mesh-{}.vtk", self.files.len());
        let bytes = written.files.into_iter().next().ok_or("no file of the mesh")?.1;
        self.files.push((name.clone(), bytes.into()));
        // Meshes of linear cells are used as they are.
        let linear = !mesh.cells.triangles.is_empty() || !mesh.cells.tetrahedra.is_empty();
        let rest = if linear { format!("order = 1\n{rest}") } else { rest.to_string() };
        Ok(self.add(&format!("[[body]]\nname = \"{body}\"\nshape = {{ kind = \"mesh\", file = \"{name}\" }}\n{rest}")))
    }
}

/// Writes a pin for every node of a list, with the displacement that the node has after one second.
pub(crate) fn moved_pins<const D: usize>(moves: impl IntoIterator<Item = (u32, [f64; D])>) -> String {
    let rows: Vec<String> = moves
        .into_iter()
        .map(|(node, by)| {
            let (start, end) = (vec!["0"; D].join(", "), by.map(|c| format!("{c:?}")).join(", "));
            format!("{{ select = {{ node = {node} }}, motion = [[0, {start}], [1, {end}]] }}")
        })
        .collect();
    format!("pin = [{}]", rows.join(",\n  "))
}

impl Lab {
    fn read(&self, scene: Scene) -> Result<AnyBlueprint, Trouble> {
        let options = scene::Options { files: Files::in_memory(scene.files), ..scene::Options::default() };
        match scene::read(scene.text.as_bytes(), "case.toml", &catalogue_of(&self.registries), &options) {
            Ok((blueprint, _)) => Ok(blueprint),
            Err(errors) => Err(errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n").into()),
        }
    }

    fn build<const D: usize>(
        &self,
        mut blueprint: Blueprint<D>,
        registry: &Arc<Registry<D>>,
    ) -> Result<World<D>, Trouble> {
        if self.stiffer != 1.0 {
            stiffen(&mut blueprint, self.stiffer)?;
        }
        let options = Options { simd: self.simd, allow_unstable: true, ..Options::default() };
        Ok(World::with_registry(blueprint, options, Arc::clone(registry))?)
    }

    /// A world in the plane.
    pub(crate) fn plane(&self, scene: Scene) -> Result<World<2>, Trouble> {
        self.build(Blueprint::try_from(self.read(scene)?).map_err(|_| "the scene is in space")?, &self.registries.plane)
    }

    /// A world in space.
    pub(crate) fn space(&self, scene: Scene) -> Result<World<3>, Trouble> {
        self.build(
            Blueprint::try_from(self.read(scene)?).map_err(|_| "the scene is in the plane")?,
            &self.registries.space,
        )
    }
}

/// Multiplies the shear modulus μ of solids, without changing λ, and the stiffness of springs and hinges.
fn stiffen<const D: usize>(blueprint: &mut Blueprint<D>, factor: f64) -> Result<(), Trouble> {
    for values in blueprint.bodies.iter_mut().flat_map(|body| &mut body.models) {
        let spec = values.spec();
        let mut changed: Vec<(&str, f64)> = Vec::new();
        match values.number("youngs_modulus") {
            Some(young) => {
                let poisson = values.number("poissons_ratio").ok_or("a solid without Poisson's ratio")?;
                let mu = factor * young / (2.0 * (1.0 + poisson));
                let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
                changed.push(("youngs_modulus", mu * (3.0 * lambda + 2.0 * mu) / (lambda + mu)));
                changed.push(("poissons_ratio", lambda / (2.0 * (lambda + mu))));
            }
            // The model of the published program is not changed, because it is compared with the numbers of that program.
            None if values.spec().has_role(Role::Published) => {}
            None => {
                let known = |name: &'static str| values.number(name).map(|value| (name, factor * value));
                changed.extend(known("stiffness"));
                changed.extend(known("modulus"));
            }
        }
        for (name, value) in changed {
            values.set(spec, name, Value::Number(value), D).map_err(|e| format!("{name}: {e:?}"))?;
        }
    }
    Ok(())
}
