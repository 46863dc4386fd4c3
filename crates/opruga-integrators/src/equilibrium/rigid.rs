//! The motions of a body as a whole, or of each of its pieces, that nothing holds.

use super::motion::{Motion, center, loose_motions, shape_at};
use super::pieces::{pieces, whole};
use super::restraint::{deliver_outer, free_motions};
use super::slack::endless_turns;
use opruga_core::error::{BuildError, StepError};
use opruga_core::state::Columns;
use opruga_core::system::System;
use opruga_math::words::number;

/// Refuses a body that can move as a whole, or of which a piece can.
pub(super) fn refuse_free_motions<const D: usize>(system: &System<D>) -> Result<(), BuildError> {
    let x = &system.state.x;
    let refused = |message: String| Err(BuildError::new("equilibrium", "static.rigid_modes", message));
    let free = free_motions(system, x, &whole(system), &[]);
    if !free.is_empty() {
        return refused(format!(
            "nothing holds the body against {}; an equilibrium needs a body that is held; hint: pin as many axes of nodes \
             as there are rigid modes, or give it something to rest on",
            counted(&free)
        ));
    }
    let endless = endless_turns(system, &whole(system));
    if !endless.is_empty() {
        return refused(format!(
            "nothing holds the body against {}, since its forces are linear: what turns it turns it without end, and no weight \
             brings it back as it does a pendulum; an equilibrium needs a body that is held; hint: pin as many axes of nodes as \
             there are rigid modes, or take a material for large rotations, such as `neo_hookean`",
            counted(&endless)
        ));
    }
    let pieces = pieces(system);
    if pieces.len() > 1 {
        for piece in &pieces {
            let mut free = free_motions(system, x, piece, &[]);
            if free.is_empty() {
                free = endless_turns(system, piece);
            }
            if !free.is_empty() {
                return refused(format!(
                    "the body is in {} pieces, and nothing holds that of {} about {} against {}; an equilibrium needs every \
                     piece held; hint: pin as many axes of its nodes as it has rigid modes, join it to the others, or leave it out",
                    pieces.len(),
                    number_of(piece.len()),
                    place(&center(x, piece)),
                    counted(&free)
                ));
            }
        }
    }
    Ok(())
}

/// `translation along x, rotation: 2 rigid modes`.
fn counted<const D: usize>(free: &[Motion<D>]) -> String {
    let count = if free.len() == 1 { "1 rigid mode".into() } else { format!("{} rigid modes", free.len()) };
    format!("{}: {count}", names(free))
}

fn names<const D: usize>(free: &[Motion<D>]) -> String {
    free.iter().map(Motion::name).collect::<Vec<String>>().join(", ")
}

fn number_of(nodes: usize) -> String {
    if nodes == 1 { "1 node".into() } else { format!("{nodes} nodes") }
}

/// `(0.5, 2)`, a place in metres with four digits.
fn place<const D: usize>(x: &[f64; D]) -> String {
    let numbers: Vec<String> = x.iter().map(|x| number(*x)).collect();
    format!("({}) m", numbers.join(", "))
}

/// Refuses a body that can move as a whole though it lies on obstacles, which hold nodes along the given directions, with its
/// nodes at the given places.
pub(super) fn refuse_what_contact_leaves_free<const D: usize>(
    system: &System<D>,
    x: &Columns<D>,
    touched: &[(usize, [f64; D])],
) -> Result<(), StepError> {
    if touched.is_empty() {
        return Ok(());
    }
    let free = free_motions(system, x, &whole(system), touched);
    if !free.is_empty() {
        let message = format!(
            "the body lies on an obstacle, and neither that nor pins hold it against {}; an equilibrium needs a body that is \
             held; hint: pin an axis of a node for each, or let the obstacle rub (`friction`)",
            names(&free)
        );
        return Err(StepError::Model { model: "equilibrium", message });
    }
    let pieces = pieces(system);
    // A piece that has not met an obstacle yet may still do so.
    let lies = |piece: &&Vec<usize>| touched.iter().any(|(node, _)| piece.binary_search(node).is_ok());
    for piece in pieces.iter().filter(|_| pieces.len() > 1).filter(lies) {
        let own: Vec<(usize, [f64; D])> =
            touched.iter().filter(|(node, _)| piece.binary_search(node).is_ok()).copied().collect();
        let free = free_motions(system, x, piece, &own);
        if !free.is_empty() {
            let message = format!(
                "the body is in {} pieces, and that of {} about {} lies on an obstacle, and neither that nor pins hold it \
                 against {}; an equilibrium needs every piece held; hint: pin an axis of a node for each, or let the obstacle rub \
                 (`friction`)",
                pieces.len(),
                number_of(piece.len()),
                place(&center(x, piece)),
                names(&free)
            );
            return Err(StepError::Model { model: "equilibrium", message });
        }
    }
    Ok(())
}

/// Whether neither pins nor loads with a stiffness hold a body or one of its pieces.
pub(super) fn is_loose<const D: usize>(system: &System<D>) -> bool {
    let x = &system.state.x;
    !unheld_motions(system).is_empty()
        || pieces(system).iter().any(|piece| !untied_motions(system, x, piece).is_empty())
}

/// The motions of the whole that neither pins nor loads with a stiffness hold, translations first.
pub fn unheld_motions<const D: usize>(system: &System<D>) -> Vec<Motion<D>> {
    untied_motions(system, &system.state.x, &whole(system))
}

/// The same of a piece with the nodes at the given places.
fn untied_motions<const D: usize>(system: &System<D>, x: &Columns<D>, piece: &[usize]) -> Vec<Motion<D>> {
    loose_motions(system, x, piece, &[], Some(&|projection| deliver_outer(system, x, projection)))
}

/// The displacements of all nodes in a motion, one coordinate after the other.
pub fn shape_of<const D: usize>(system: &System<D>, motion: &Motion<D>) -> Vec<f64> {
    let (x, all) = (&system.state.x, whole(system));
    shape_at(x, system.nodes, &all, motion, &center(x, &all))
}
