//! A custom integrator: x₁ = x₀ + h v₀ + ½ h² a₀, v₁ = v₀ + h a₀. It is exact in free fall.

use opruga::extend::*;
use opruga::{Options, Registry, World};

#[path = "ball_in_code.rs"]
#[allow(dead_code)]
mod ball_in_code;

const SPEC: Spec =
    Spec { kind: "taylor", summary: "a parabola", documentation: "", dimensions: &[2], fields: &[], roles: &[] };

#[derive(Debug)]
struct Taylor;
impl IntegratorKind<2> for Taylor {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn build(&self, _: &Values) -> Result<Box<dyn Integrator<2>>, BuildError> {
        Ok(Box::new(Taylor))
    }
}
impl Integrator<2> for Taylor {
    fn name(&self) -> &'static str {
        SPEC.kind
    }
    fn amplification(&self, omega: f64, c: f64, h: f64) -> Amplification {
        let (k, d) = (-omega * omega * h, -c * h); // v₁ − v₀ = k x₀ + d v₀: the world checks the step by this
        Amplification::new([[1.0 + 0.5 * h * k, h + 0.5 * h * d], [k, 1.0 + d]])
    }
    fn step(&self, system: &mut System<2>, h: f64) -> Result<(), StepError> {
        let rule = |x, v, a| [x + h * v + 0.5 * h * h * a, v + h * a];
        system.advance(Stage::Current, 0.0, h, Some(h), &ByCoordinate { h, rule })?;
        system.finish_step(h);
        Ok(())
    }
}
/// How far a ring of springs falls in half a second with an integrator [m].
pub(crate) fn run(integrator: &str) -> Result<f64, Box<dyn std::error::Error>> {
    let mut registry = Registry::<2>::default();
    registry.add_integrator(Box::new(Taylor));
    let mut scene = ball_in_code::scene()?;
    scene.integrator = registry.integrator_values(integrator, &[])?;
    scene.bodies[0].models.truncate(1); // without gas, which would swell
    let mut world = World::with_registry(scene, Options::default(), registry.into())?;
    for _ in 0..30 {
        world.frame()?;
    }
    Ok(2.0 - world.position(0, 0)[1])
}
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (own, euler) = (run("taylor")?, run("symplectic_euler")?);
    println!("a fall of 0.5 s: exactly 1.22625 m, taylor {own:.5} m, symplectic_euler {euler:.5} m");
    Ok(())
}
