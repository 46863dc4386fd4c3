//! Bodies, pins and loads of the cases with boundary elements.

use opruga::World;

/// A pressure or stress so small that the change of shape of the body does not matter, in units of E.
pub(super) const SMALL: f64 = 1e-6;

/// The lines of the scene for a solid of E = 1 Pa, with further fields of its model.
pub(super) fn solid(poisson: f64, fields: &str) -> String {
    format!(
        "mass = 1.0\nmodels = [{{ kind = \"boundary_element\", youngs_modulus = 1.0, poissons_ratio = {poisson:?}{fields} }}]\n"
    )
}

pub(super) fn body(shape: &str, rest: &str) -> String {
    format!("[[body]]\nname = \"body\"\nshape = {{ {shape} }}\n{rest}")
}

pub(super) fn pressed(nodes: &[u32], pressure: f64) -> String {
    format!("[[load]]\nkind = \"pressure\"\nbody = \"body\"\nselect = {{ nodes = {nodes:?} }}\nvalue = {pressure:?}\n")
}

pub(super) fn radius<const D: usize>(x: &[f64; D]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// Pins that prevent rigid motions of a ball or a ring of `count` nodes. These pins have no reaction forces if the loads balance. In space, they are
/// at the two poles and near the equator; in the plane, they are at both ends of a diameter.
pub(super) fn pinned(dimension: usize, count: u32) -> String {
    let pin = |node: u32, axes: &str| format!("{{ select = {{ node = {node} }}, axes = \"{axes}\" }}");
    let pins = if dimension == 2 {
        vec![pin(0, "xy"), pin(count / 2, "y")]
    } else {
        vec![pin(0, "xyz"), pin(count - 1, "xy"), pin(count / 2, "y")]
    };
    format!("pin = [{}]\n", pins.join(", "))
}

/// The mean displacement of some nodes away from their centre [m].
pub(super) fn outward<const D: usize>(world: &World<D>, nodes: std::ops::Range<u32>) -> f64 {
    let rest = &world.blueprint().bodies[0].mesh.positions;
    let count = f64::from(nodes.end - nodes.start);
    let mut moved = [0.0; D];
    for node in nodes.clone() {
        let now = world.position(0, node);
        (0..D).for_each(|d| moved[d] += (now[d] - rest[node as usize][d]) / count);
    }
    let away = |node: u32| {
        let now = world.position(0, node);
        radius::<D>(&std::array::from_fn(|d| now[d] - moved[d])) - radius(&rest[node as usize])
    };
    nodes.map(away).sum::<f64>() / count
}
