//! The rigid motions of a body, or of each of its pieces, that nothing prevents.

use super::motion::{Motion, center, loose_motions, shape_at};
use super::pieces::{pieces, whole};
use super::restraint::{deliver_outer, free_motions};
use super::slack::endless_turns;
use crate::refusals::{MotionName, Refusal};
use opruga_core::error::{BuildError, StepError};
use opruga_core::state::Columns;
use opruga_core::system::System;
use opruga_math::message::AnyMessage;
use opruga_math::words::number;

/// Refuses a body that can move rigidly, or has a piece that can move rigidly.
pub(super) fn refuse_free_motions<const D: usize>(system: &System<D>) -> Result<(), BuildError> {
    let x = &system.state.x;
    let refused = |refusal: Refusal| Err(BuildError::of("equilibrium", refusal));
    let free = free_motions(system, x, &whole(system), &[]);
    if !free.is_empty() {
        return refused(Refusal::Free { motions: names(&free), count: free.len() });
    }
    let endless = endless_turns(system, &whole(system));
    if !endless.is_empty() {
        return refused(Refusal::Endless { motions: names(&endless), count: endless.len() });
    }
    let all = pieces(system);
    for piece in all.iter().filter(|_| all.len() > 1) {
        let mut free = free_motions(system, x, piece, &[]);
        if free.is_empty() {
            free = endless_turns(system, piece);
        }
        if !free.is_empty() {
            let (pieces, nodes, center) = (all.len(), piece.len(), coordinates(&center(x, piece)));
            return refused(Refusal::FreePiece { pieces, nodes, center, motions: names(&free), count: free.len() });
        }
    }
    Ok(())
}

/// Returns the names of motions as a list, such as `translation along x, rotation`.
fn names<const D: usize>(free: &[Motion<D>]) -> AnyMessage {
    let list = |rest, first| match rest {
        None => Some(first),
        Some(rest) => Some(MotionName::List { first, rest }.into()),
    };
    let names = free.iter().rev().map(|motion| AnyMessage::from(motion.name()));
    names.fold(None, list).unwrap_or_else(|| MotionName::Rotation {}.into())
}

/// Returns a position in metres with four digits, such as `(0.5, 2)`.
fn coordinates<const D: usize>(x: &[f64; D]) -> String {
    let numbers: Vec<String> = x.iter().map(|x| number(*x)).collect();
    format!("({}) m", numbers.join(", "))
}

/// Refuses a body that can move rigidly although it lies on obstacles. The obstacles hold nodes along the given directions, and
/// the nodes are at the given positions.
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
        return Err(StepError::of("equilibrium", Refusal::Slides { motions: names(&free) }));
    }
    let pieces = pieces(system);
    // A piece that has not met an obstacle yet may still do so.
    let lies = |piece: &&Vec<usize>| touched.iter().any(|(node, _)| piece.binary_search(node).is_ok());
    for piece in pieces.iter().filter(|_| pieces.len() > 1).filter(lies) {
        let own: Vec<(usize, [f64; D])> =
            touched.iter().filter(|(node, _)| piece.binary_search(node).is_ok()).copied().collect();
        let free = free_motions(system, x, piece, &own);
        if !free.is_empty() {
            let (nodes, center) = (piece.len(), coordinates(&center(x, piece)));
            let refusal = Refusal::PieceSlides { pieces: pieces.len(), nodes, center, motions: names(&free) };
            return Err(StepError::of("equilibrium", refusal));
        }
    }
    Ok(())
}

/// Whether a body or one of its pieces has a motion that neither pins nor loads with a stiffness prevent.
pub(super) fn is_loose<const D: usize>(system: &System<D>) -> bool {
    let x = &system.state.x;
    !unheld_motions(system).is_empty()
        || pieces(system).iter().any(|piece| !untied_motions(system, x, piece).is_empty())
}

/// The rigid motions that neither pins nor loads with a stiffness prevent, translations first.
pub fn unheld_motions<const D: usize>(system: &System<D>) -> Vec<Motion<D>> {
    untied_motions(system, &system.state.x, &whole(system))
}

/// The motions of a piece that neither pins nor loads with a stiffness prevent, with the nodes at the given positions.
fn untied_motions<const D: usize>(system: &System<D>, x: &Columns<D>, piece: &[usize]) -> Vec<Motion<D>> {
    loose_motions(system, x, piece, &[], Some(&|projection| deliver_outer(system, x, projection)))
}

/// The displacements of all nodes in a motion, one coordinate after the other.
pub fn shape_of<const D: usize>(system: &System<D>, motion: &Motion<D>) -> Vec<f64> {
    let (x, all) = (&system.state.x, whole(system));
    shape_at(x, system.nodes, &all, motion, &center(x, &all))
}
