//! Gas: its laws, rings supported by it, breathing, buckling.

use super::BASE;
use crate::case::{Case, Check, Family, Over, Scale};
use crate::lab::{Lab, Scene, Trouble};
use opruga::World;

const GAS: Case = Case { family: Family::Pressure, over: Over::Cells("vertices"), ..BASE };

const LAW: Case = Case {
    quantity: "largest deviation of P V from its value at the start, in a bouncing ball",
    source: "exact: P V = nRT",
    over: Over::Parameter("γ"),
    scale: Scale::Of(1.0),
    tolerance: 1e-12,
    check: Check::Everywhere,
    quick: true,
    ..GAS
};

pub(super) const CASES: &[Case] = &[
    Case { name: "gas-law-isothermal", levels: &[1.0], measure: gas_law, ..LAW },
    Case {
        name: "gas-law-adiabatic",
        quantity: "largest deviation of P V^γ from its value at the start, in a bouncing ball, γ = 1.4 and 1.67",
        source: "exact: P V^γ = P₀ V₀^γ (S. D. Poisson 1823)",
        levels: &[1.4, 1.67],
        measure: gas_law,
        ..LAW
    },
    Case {
        name: "gas-holds-a-ring",
        quantity: "length of an edge of a ring of springs around gas, k = 1600 N/m, nRT = 100 J, R = 0.5 m",
        unit: "m",
        source: "exact: l = (l₀ + √(l₀² + 8 nRT/kN))/2",
        levels: &[12.0, 36.0, 108.0],
        expected: &[0.294_223_026_832_954, 0.116_866_704_736_737_88, 0.051_540_840_739_023_76],
        tolerance: 1e-8,
        check: Check::Everywhere,
        quick: true,
        measure: gas_filled_ring,
        ..GAS
    },
    Case {
        name: "ring-breathes-springs-and-gas",
        quantity: "angular frequency of the breathing mode of a ring of springs around an adiabatic gas, P = P₀ = 100 Pa, M = 2 kg, k = 50 N/m",
        unit: "rad/s",
        source: "exact: ω² = 2γ P N sin(2π/N)/M + 4 k sin²(π/N) N/M",
        over: Over::Parameter("vertices"),
        levels: &[8.0, 16.0, 32.0],
        expected: &[30.151_565_174_204_705, 30.300_284_858_211_675, 30.079_032_464_277_933],
        tolerance: 1e-8,
        check: Check::Everywhere,
        quick: true,
        measure: breathing_modes,
        ..GAS
    },
    Case {
        name: "ring-breathes-gas-alone",
        quantity: "angular frequency of the breathing mode of a ring with mass around gas, 100 Pa inside and outside, M = 2 kg, γ = 1.4",
        unit: "rad/s",
        source: "exact for a circle: ω = √(4πγP₀/M)",
        levels: &[12.0, 24.0, 48.0],
        expected: &[29.658_825_718_580_67],
        check: Check::Order(2.0),
        quick: true,
        measure: ring_in_time,
        ..GAS
    },
    Case {
        name: "balloon-breathes-gas-alone",
        quantity: "angular frequency of the breathing mode of a skin with mass around gas, 100 Pa inside and outside, M = 2 kg, R = 0.5 m, γ = 1.4",
        unit: "rad/s",
        source: "exact for a sphere: ω = √(12πγP₀R/M)",
        over: Over::Cells("parts of an edge of the icosahedron"),
        levels: &[2.0, 4.0, 8.0],
        expected: &[36.324_494_690_328_635],
        check: Check::Order(2.0),
        measure: balloon_in_time,
        ..GAS
    },
    Case {
        name: "ring-buckles",
        quantity: "outer pressure at which a ring of EI = 1 N m², R = 1 m, buckles: where ω² of its oval motion, linear in the pressure, is zero",
        unit: "N/m",
        source: "M. Lévy 1884: 3EI/R³ for the pressure of a fluid",
        levels: &[16.0, 32.0, 64.0],
        expected: &[3.0],
        check: Check::Order(2.0),
        quick: true,
        measure: buckling,
        ..GAS
    },
];

fn reading<const D: usize>(world: &mut World<D>, name: &str) -> Result<f64, Trouble> {
    let found = world.readings(0).into_iter().find(|r| r.0 == name);
    Ok(found.ok_or_else(|| format!("no reading `{name}`"))?.1)
}

fn gas_law(lab: &Lab, gamma: f64) -> Result<f64, Trouble> {
    let process = if gamma > 1.0 {
        format!("process = \"adiabatic\", gamma = {gamma:?}")
    } else {
        "process = \"isothermal\"".into()
    };
    let scene = Scene::new(2, 1.0 / 60.0, 40, "symplectic_euler").add(&format!(
        "[world]\ngravity = [0.0, -9.81]\n[[body]]\nname = \"ball\"\nmass = 1\nvelocity = [0, -6]\n\
         shape = {{ kind = \"ring\", radius = 0.5, vertices = 36, center = [0, 0.6] }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 300.0, damping = 0.5 }}, {{ kind = \"pressure\", pressure = 60.0, {process} }}]\n\
         [[collider]]\nkind = \"half_space\"\npoint = [0, 0]\nnormal = [0, 1]\nfriction = 0.5"
    ));
    let mut world = lab.plane(scene)?;
    let start = reading(&mut world, "volume")?;
    let (mut worst, mut least, mut most) = (0.0f64, f64::INFINITY, 0.0f64);
    for _ in 0..120 {
        world.frame()?;
        let (pressure, part) = (reading(&mut world, "pressure")?, reading(&mut world, "volume")? / start);
        (least, most) = (least.min(part), most.max(part));
        worst = worst.max((pressure * part.powf(gamma) / 60.0 - 1.0).abs());
    }
    if most < 1.2 * least {
        return Err("the ball was not squeezed".into());
    }
    Ok(worst)
}

/// Three pins that prevent rigid motions of a round ring but let it expand.
pub(super) fn ring_pins(n: u32) -> String {
    format!(
        "pin = [{{ select = {{ nodes = [0, {}] }}, axes = \"y\" }}, {{ select = {{ node = {} }}, axes = \"x\" }}]",
        n / 2,
        n / 4
    )
}

fn gas_filled_ring(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let scene = Scene::statics(2, 1e-11).add(&format!(
        "[[body]]\nname = \"ring\"\nmass = 1\nshape = {{ kind = \"ring\", radius = 0.5, vertices = {n} }}\n\
         models = [{{ kind = \"mass_spring\", stiffness = 1600.0 }}, {{ kind = \"pressure\", nRT = 100.0 }}]\n{}",
        ring_pins(n as u32)
    ));
    let mut world = lab.plane(scene)?;
    world.frame()?;
    // The result is the mean length of the edges.
    let count = n as u32;
    let length = |k: u32| {
        let (a, b) = (world.position(0, k), world.position(0, (k + 1) % count));
        ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2)).sqrt()
    };
    Ok((0..count).map(length).sum::<f64>() / n)
}

fn breathing_modes(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let (radius, pressure) = (0.5, 100.0);
    let area = 0.5 * n * radius * radius * (std::f64::consts::TAU / n).sin();
    let scene = Scene::new(2, 0.001, 1, "newmark").add(&format!(
        "[[body]]\nname = \"ring\"\nshape = {{ kind = \"ring\", radius = {radius:?}, vertices = {n} }}\nmass = 2.0\n\
         models = [{{ kind = \"mass_spring\", stiffness = 50.0 }}, {{ kind = \"pressure\", nRT = {:?}, ambient = {pressure:?}, \
         process = \"adiabatic\", gamma = 1.4 }}]",
        pressure * area
    ));
    let world = lab.plane(scene)?;
    // For the mode φ of uniform expansion, Σ m φ·x/R is √(mass). For all other modes it is 0.
    let alike = |shape: &[[f64; 2]]| -> f64 {
        let along = shape.iter().enumerate().map(|(k, v)| {
            let x = world.position(0, k as u32);
            world.node_mass(0, k as u32) * (v[0] * x[0] + v[1] * x[1]) / radius
        });
        along.sum::<f64>().abs() / 2.0f64.sqrt()
    };
    let modes = world.modes(0, 2 * n as usize)?;
    Ok(modes.iter().find(|mode| alike(&mode.shape) > 0.99).ok_or("it does not breathe")?.omega())
}

/// The angular frequency at which the volume oscillates, found from the times at which it falls through its value at rest.
fn pulse<const D: usize>(world: &mut World<D>) -> Result<f64, Trouble> {
    let rest = reading(world, "volume")?;
    for node in 0..world.node_count(0) as u32 {
        let x = world.position(0, node);
        world.set_node(0, node, x, x.map(|c| 1e-3 * c))?;
    }
    let (mut falls, mut before) = (Vec::new(), 0.0);
    for _ in 0..4000 {
        world.frame()?;
        let now = reading(world, "volume")? / rest - 1.0;
        if before > 0.0 && now <= 0.0 {
            let frame = world.blueprint().time.frame;
            falls.push(world.time() - frame * now / (now - before));
        }
        if let [first, .., last] = falls[..] {
            return Ok(std::f64::consts::TAU / (last - first));
        }
        before = now;
    }
    Err("it does not breathe".into())
}

fn ring_in_time(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    pulse(&mut lab.plane(Scene::new(2, 0.001, 4, "verlet").add(&format!(
        "[[body]]\nname = \"ring\"\nmass = 2.0\nshape = {{ kind = \"ring\", radius = 0.5, vertices = {n} }}\n\
         models = [{{ kind = \"pressure\", pressure = 100.0, ambient = 100.0, process = \"adiabatic\", gamma = 1.4 }}]"
    )))?)
}

fn balloon_in_time(lab: &Lab, parts: f64) -> Result<f64, Trouble> {
    pulse(&mut lab.space(Scene::new(3, 0.001, 4, "verlet").add(&format!(
        "[[body]]\nname = \"balloon\"\nmass = 2.0\nshape = {{ kind = \"icosphere\", radius = 0.5, subdivisions = {} }}\n\
         models = [{{ kind = \"pressure\", pressure = 100.0, ambient = 100.0, process = \"adiabatic\", gamma = 1.4 }}]",
        parts.log2()
    )))?)
}

fn buckling(lab: &Lab, n: f64) -> Result<f64, Trouble> {
    let l = 2.0 * (std::f64::consts::PI / n).sin();
    let lowest = |pressure: f64| -> Result<f64, Trouble> {
        let scene = Scene::statics(2, 1e-8).add(&format!(
            "[[body]]\nname = \"ring\"\nmass = 1.0\nshape = {{ kind = \"ring\", radius = 1.0, vertices = {n} }}\n\
             models = [{{ kind = \"bending\", stiffness = {:?} }}, {{ kind = \"mass_spring\", stiffness = {:?} }}]\n{}\n\
             [[load]]\nkind = \"pressure\"\nbody = \"ring\"\nvalue = {pressure:?}",
            1.0 / l,
            1e6 / l,
            ring_pins(n as u32)
        ));
        let mut world = lab.plane(scene)?;
        world.frame()?;
        Ok(world.modes(0, 1)?.first().ok_or("no modes")?.square)
    };
    let (low, high) = (lowest(1.0)?, lowest(2.0)?);
    Ok(1.0 + low / (low - high))
}
