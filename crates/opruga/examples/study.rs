//! A study: how high does the ball of the thesis bounce with more gas?

use opruga::sweep::{Status, Sweep, number};

/// Returns nRT [J] and the bounce height [m] of every run.
pub(crate) fn run() -> Result<Vec<(f64, f64)>, Box<dyn std::error::Error>> {
    let text = opruga::scenes::find("ball").ok_or("there is no such scene")?;
    // A single value applies to every run, several values form an axis, as on the command line.
    let axes = ["time.seconds=2", "body.ball.models.pressure.nRT=20,40,80,160"];
    let sweep = Sweep::new("ball", text, &axes, &["bounce_height.ball"])?;
    let rows = sweep.run().map_err(|errors| errors[0].to_string())?;

    let mut found = Vec::new();
    for row in rows {
        if row.status != Status::Done {
            return Err(format!("point {}: {}: {}", row.number, row.status.word(), row.message).into());
        }
        let gas = row.values[0].as_deref().and_then(number).ok_or("no amount of gas")?;
        found.push((gas, row.numbers[0].ok_or("no bounce")?));
    }
    Ok(found)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    for (gas, height) in run()? {
        println!("nRT = {gas:3} J: the ball bounces {height:.3} m high");
    }
    Ok(())
}
