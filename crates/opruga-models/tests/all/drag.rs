//! Drag against its closed form.

use crate::support;

use crate::support::models::Drag;
use opruga_mesh::Mesh;
use support::system_with_mass;

/// f = −λ m v: a flying body is braked as a whole, by design.
#[test]
fn force_is_rate_times_momentum() {
    let mesh = Mesh::icosphere(0.5, 2).unwrap();
    let mut ball = system_with_mass(&mesh, &[(&Drag, values!(drag, rate: 0.25))], 3.0);
    for node in 0..ball.nodes {
        ball.state.v.set(node, [1.0, -2.0, 4.0]);
    }
    let force = ball.forces(true).unwrap();
    for node in 0..ball.nodes {
        assert_eq!(force.at(node), [-0.75, 1.5, -3.0]);
    }
}
