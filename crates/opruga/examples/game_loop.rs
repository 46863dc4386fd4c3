//! A game loop: the player pulls a ball by its top, a second ball is added, and the first one is removed.

use opruga::blueprint::{Action, CommandBlueprint};
use opruga::{Options, World};

#[path = "ball_in_code.rs"]
#[allow(dead_code)]
mod ball_in_code;

/// Returns how far the pull lifts the ball [m], the number of bodies at the end, and the code of the error for the old handle.
pub(crate) fn run() -> Result<(f64, usize, &'static str), Box<dyn std::error::Error>> {
    let mut world = World::new(ball_in_code::scene()?, Options::default())?;
    for _ in 0..60 {
        world.frame()?;
    }
    let ball = world.body("ball").and_then(|body| world.handle(body)).ok_or("there is no ball")?;

    // The pointer grabs node 9, the top, and rises by 2 m/s for one second. Its path is one point now; each iteration adds another.
    let body = world.resolve(ball)?;
    let (at, top) = (world.time(), world.position(body, 9));
    let pull = Action::Drag {
        body,
        node: Some(9),
        facet: false,
        stiffness: None,
        path: vec![vec![at, top[0], top[1]]],
        largest_force: None,
    };
    let pull = world.act(CommandBlueprint { at, until: at + 1.0, action: pull })?;
    for frame in 1..=60 {
        let later = f64::from(frame) / 60.0;
        world.lead(pull, vec![at + later, top[0], top[1] + 2.0 * later])?;
        world.frame()?;
    }
    let lifted = ball_in_code::lowest(&world);

    // A second ball with the shape and models of the first one is added next to it.
    let mut second = world.view(ball)?.blueprint().clone();
    (second.name, second.translation) = ("second".into(), [3.0, 0.0]);
    world.add_body(second)?;
    for _ in 0..60 {
        world.frame()?;
    }

    // The first one is removed; its handle never means another body.
    world.remove_body("ball")?;
    world.frame()?;
    let error = world.view(ball).err().ok_or("the handle outlives its body")?;
    Ok((lifted, world.bodies().count(), error.code()))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let (lifted, bodies, code) = run()?;
    println!(
        "the pull lifts the ball {lifted:.2} m above the floor; {bodies} ball is left; its old handle says `{code}`"
    );
    Ok(())
}
