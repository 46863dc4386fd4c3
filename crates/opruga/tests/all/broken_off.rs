//! Frames that are interrupted from outside, with any integrator: the world returns to its last good frame, and continues as if nothing had happened.
#![allow(missing_docs)]

use crate::common;

use opruga::{BreakOff, Options, World, WorldError};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

/// A cantilever of finite elements under its own weight.
fn scene(integrator: &str, substeps: u32) -> opruga::blueprint::Blueprint<2> {
    common::plane(&format!(
        "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1.0\nframe = 0.02\nsubsteps = {substeps}\n\
         [integrator]\n{integrator}\n[[body]]\nname = \"beam\"\nmass = 1.0\n\
         shape = {{ kind = \"grid\", corner = [0.0, 0.0], size = [1.0, 0.2], cells = [10, 2] }}\n\
         models = [{{ kind = \"fem\", youngs_modulus = 2000.0, poissons_ratio = 0.3 }}]\n\
         pin = [{{ select = {{ side = \"left\" }} }}]\n"
    ))
}

/// A world in which a law without effect counts its calls and interrupts the frame at call number `at`.
fn world(integrator: &str, substeps: u32, at: u32) -> (World<2>, Arc<BreakOff>, Arc<AtomicU32>) {
    let break_off = Arc::new(BreakOff::default());
    let options = Options { break_off: Arc::clone(&break_off), ..Options::default() };
    let mut world = World::new(scene(integrator, substeps), options).expect("a world");
    let asked = Arc::new(AtomicU32::new(0));
    let (count, flag) = (Arc::clone(&asked), Arc::clone(&break_off));
    let law = move |_, _, _, _| {
        if count.fetch_add(1, Ordering::Relaxed) + 1 == at {
            flag.ask(true);
        }
        [0.0; 2]
    };
    world.add_force(0, Arc::new(law)).expect("a law");
    asked.store(0, Ordering::Relaxed);
    (world, break_off, asked)
}

/// A block that lies on the cantilever, for scenes with contact.
const BLOCK: &str = "\n[contact]\nthickness = 1e-5\nRESPONSE\n[[body]]\nname = \"block\"\nmass = 0.1\n\
     shape = { kind = \"grid\", corner = [0.55, 0.2001], size = [0.3, 0.2], cells = [2, 2] }\n\
     models = [{ kind = \"fem\", youngs_modulus = 2000.0, poissons_ratio = 0.3 }]\n";

#[test]
fn a_frame_that_is_broken_off_leaves_the_last_good_one_and_is_made_again_to_the_bit() {
    for (rule, substeps) in [
        ("kind = \"symplectic_euler\"", 200),
        ("kind = \"verlet\"", 200),
        ("kind = \"runge_kutta\"", 200),
        ("kind = \"backward_euler\"", 4),
        ("kind = \"bdf2\"\nwhen_not_converged = \"halve\"", 4),
        ("kind = \"backward_euler\"\naccuracy = \"real_time\"", 4),
        ("kind = \"implicit_midpoint\"", 4),
        ("kind = \"equilibrium\"\nwhen_not_converged = \"halve\"", 1),
        (&format!("kind = \"symplectic_euler\"{}", BLOCK.replace("RESPONSE", "")), 200),
        (&format!("kind = \"backward_euler\"{}", BLOCK.replace("RESPONSE", "")), 4),
        (&format!("kind = \"backward_euler\"{}", BLOCK.replace("RESPONSE", "response = \"barrier\"")), 4),
    ] {
        let (mut whole, _, asked) = world(rule, substeps, 0);
        // Statics has nothing to compute after its first frame.
        let good = u32::from(!rule.contains("equilibrium"));
        let (mut hash, mut begin) = (whole.state_hash(), 0);
        for frame in 0..=good {
            (hash, begin) = (whole.state_hash(), asked.load(Ordering::Relaxed));
            whole.frame().unwrap_or_else(|error| panic!("{rule}, frame {frame}: {error}"));
        }
        let all = asked.load(Ordering::Relaxed);
        whole.frame().expect("one more");
        // Somewhere in the last frame but one.
        let (mut broken, flag, asked) = world(rule, substeps, begin + 1 + good * (all - begin) / 3);
        (0..good).for_each(|_| broken.frame().expect("the first one"));
        assert_eq!(broken.state_hash(), hash, "{rule}");
        assert_eq!(broken.frame(), Err(WorldError::BrokenOff {}), "{rule}");
        let spent = asked.load(Ordering::Relaxed);
        assert!(spent < all, "{rule}: {spent} of {all}: the frame has ended early");
        assert_eq!((broken.frames(), broken.state_hash()), (u64::from(good), hash), "{rule}");
        // While the flag is set, no frame is computed.
        assert_eq!(broken.frame(), Err(WorldError::BrokenOff {}), "{rule}");
        flag.ask(false);
        (0..2).for_each(|_| broken.frame().expect("it goes on"));
        assert_eq!(broken.state_hash(), whole.state_hash(), "{rule}");
        assert_eq!(broken.energy(), whole.energy(), "{rule}");
    }
}

#[test]
fn a_body_whose_preparation_is_broken_off_does_not_come_and_the_world_stays_as_it_was() {
    let ring = |name: &str, model: &str| {
        format!(
            "[[body]]\nname = \"{name}\"\nmass = 1.0\nshape = {{ kind = \"ring\", radius = 0.5, vertices = 41 }}\n\
             models = [{{ {model} }}]\n"
        )
    };
    let head = "format = \"opruga-1\"\ndimension = 2\n[time]\nseconds = 1.0\nframe = 0.01\nsubsteps = 1\n\
                [integrator]\nkind = \"backward_euler\"\n";
    let break_off = Arc::new(BreakOff::default());
    let options = Options { break_off: Arc::clone(&break_off), ..Options::default() };
    let springs = common::plane(&format!("{head}{}", ring("springs", "kind = \"mass_spring\", stiffness = 100.0")));
    let mut world = World::new(springs, options.clone()).expect("a world");
    let dense =
        || common::plane(&format!("{head}{}", ring("solid", "kind = \"boundary_element\", youngs_modulus = 1e4")));
    let body = dense().bodies.remove(0);
    let hash = world.state_hash();
    break_off.ask(true);
    assert_eq!(world.add_body(body.clone()), Err(WorldError::BrokenOff {}));
    assert_eq!((world.state_hash(), break_off.prepared()), (hash, None));
    assert!(matches!(World::new(dense(), options), Err(WorldError::BrokenOff {})));
    break_off.ask(false);
    world.add_body(body).expect("a body");
    world.frame().expect("a frame");
}
