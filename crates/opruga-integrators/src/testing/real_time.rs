//! The state does not depend on the frame rate of the display.

use super::{state, two_nodes};
use crate::symplectic_euler::SymplecticEuler;
use opruga_core::accumulator::Accumulator;
use opruga_core::integrator::Integrator;

#[test]
fn every_display_rate_gives_the_same_bits() {
    const SUBSTEPS: usize = 16;
    let after_ten_seconds = |rate: u32| {
        let frame = 1.0 / 60.0;
        let mut system = two_nodes::<2>(0.1);
        system.plan(0);
        let mut accumulator = Accumulator::new(frame, 8).unwrap();
        let mut frames = 0;
        for _ in 0..rate * 10 {
            let due = accumulator.advance(1.0 / f64::from(rate));
            assert_eq!(due.dropped, 0.0);
            for _ in 0..due.frames as usize * SUBSTEPS {
                SymplecticEuler.step(&mut system, frame / SUBSTEPS as f64).unwrap();
            }
            frames += due.frames;
        }
        (frames, state(&system).iter().map(|n| n.to_bits()).collect::<Vec<_>>())
    };
    let expected = after_ten_seconds(60);
    assert_eq!(expected.0, 600);
    for rate in [30, 144, 1000] {
        assert_eq!(after_ten_seconds(rate), expected, "{rate} Hz");
    }
}
