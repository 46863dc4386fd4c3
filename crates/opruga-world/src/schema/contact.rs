//! `[contact]`, `[[contact.pair]]`, and the contact settings of a body.

use super::{Child, Holds, Section, child, section};
use opruga_core::spec::{Allowed, Bound, Condition, Default, Field};

/// What a barrier does not use: it keeps bodies apart before they touch, so nothing bounces or overlaps.
const WITHOUT_BARRIER: &[Condition] = &[Condition::Word("response", &["constraint"])];

const IF_IT_TOUCHES: &[Condition] = &[Condition::Given("touch")];

const FRICTION: &str =
    "Coulomb's coefficient µ, for both sticking and sliding; two bodies use the mean of their values.";
const RESTITUTION: &str =
    "Ratio of the normal speeds after and before an impact of two points; two bodies use the mean of their values.";
const THICKNESS: &str = "The distance between the surfaces in contact; two bodies use the mean of their values. The default is a hundredth of the \
mean edge length of the surface.";

/// `[contact]`.
pub const CONTACT: Section = Section {
    spec: &section(
        "contact",
        "How deformable bodies touch one another and themselves",
        "Without this section bodies pass through one another. Contact acts on boundaries, open surfaces and wires; if a body has none of these, \
contact acts on its points. If a lattice fills a body, contact acts on the surface that the lattice carries. Obstacles act not only on nodes: their \
corners and edges also touch edges and facets of bodies. A substep first moves all bodies as if they did not touch one another. It then applies \
impulses to pairs of a vertex and a facet, and in space also to pairs of edges.",
        &[
            Field::new(
                "response",
                Allowed::Choice(&["constraint", "barrier"]),
                "",
                Default::Text("constraint"),
                "How contact is enforced: `constraint` uses impulses that let pairs touch but not pass; `barrier` uses forces that grow without \
bound as a gap closes, and needs implicit integrators.",
            ),
            Field::new(
                "reach",
                Allowed::POSITIVE,
                "m",
                Default::Absent,
                "The gap, beyond the thickness, at which the barrier begins to push. The default is a fiftieth of the mean edge length of all \
surfaces, but at most half of the shortest edge.",
            )
            .applies(&[Condition::Word("response", &["barrier"])]),
            Field::new("friction", Allowed::NOT_NEGATIVE, "", Default::Number(0.0), FRICTION),
            Field::new("restitution", Allowed::FRACTION, "", Default::Number(0.0), RESTITUTION)
                .applies(WITHOUT_BARRIER),
            Field::new(
                "rest_speed",
                Allowed::NOT_NEGATIVE,
                "m/s",
                Default::Number(0.05),
                "Speed of approach up to which a pair does not bounce.",
            )
            .applies(WITHOUT_BARRIER),
            Field::new("thickness", Allowed::POSITIVE, "m", Default::Absent, THICKNESS),
            Field::new(
                "recovery_speed",
                Allowed::POSITIVE,
                "m/s",
                Default::Number(0.5),
                "The speed at which bodies that overlap are moved apart. Only positions are changed; the work of these changes against forces is \
entered in the ledger as `work_correction`.",
            )
            .applies(WITHOUT_BARRIER),
            Field::new("self", Allowed::Boolean, "", Default::Boolean(true), "Whether a body touches itself."),
            Field::new(
                "most_pairs",
                Allowed::Number { least: Bound::Closed(1.0), greatest: Bound::Closed(1e8) },
                "",
                Default::Number(4e6),
                "The largest number of pairs that are considered in a step; a run that needs more ends with the error `limit.contacts`.",
            ),
        ],
    ),
    children: &[child("pair", Holds::List(&CONTACT_PAIR), false, "What happens between two groups of bodies.")],
};

/// An entry of `pair` in `[contact]`.
pub const CONTACT_PAIR: Section = Section {
    spec: &section(
        "contact.pair",
        "What happens where two groups of bodies touch",
        "A body belongs to the group that its `contact` names. If it names none, the group has the name of the body, and all copies of the body \
share it. Two groups have at most one entry.",
        &[
            Field::new("first", Allowed::Text, "", Default::Required, "A group."),
            Field::new(
                "second",
                Allowed::Text,
                "",
                Default::Required,
                "Another group, or the same one for contact among its own bodies.",
            ),
            Field::new("touch", Allowed::Boolean, "", Default::Boolean(true), "Whether the two groups touch at all."),
            Field::new(
                "friction",
                Allowed::NOT_NEGATIVE,
                "",
                Default::Absent,
                "Coulomb's coefficient µ between the two groups.",
            )
            .applies(IF_IT_TOUCHES),
            Field::new(
                "restitution",
                Allowed::FRACTION,
                "",
                Default::Absent,
                "Ratio of the normal speeds after and before an impact between the two groups.",
            )
            .applies(IF_IT_TOUCHES),
        ],
    ),
    children: &[],
};

/// `contact` in a body.
pub const BODY_CONTACT: Section = Section {
    spec: &section(
        "body.contact",
        "How a body touches others, if this differs from `[contact]`",
        "This table has an effect only if the scene has `[contact]`.",
        &[
            Field::new(
                "group",
                Allowed::Text,
                "",
                Default::Absent,
                "The group of the body in `[[contact.pair]]`; the default is the name of the body.",
            )
            .applies(IF_IT_TOUCHES),
            Field::new("friction", Allowed::NOT_NEGATIVE, "", Default::Absent, FRICTION).applies(IF_IT_TOUCHES),
            Field::new("restitution", Allowed::FRACTION, "", Default::Absent, RESTITUTION).applies(IF_IT_TOUCHES),
            Field::new("thickness", Allowed::POSITIVE, "m", Default::Absent, THICKNESS).applies(IF_IT_TOUCHES),
            Field::new("self", Allowed::Boolean, "", Default::Absent, "Whether the body touches itself.")
                .applies(IF_IT_TOUCHES),
            Field::new(
                "surface",
                Allowed::Choice(&["skin", "cells"]),
                "",
                Default::Text("skin"),
                "For a body filled by a lattice, the surface that touches other bodies: `skin` is the drawn surface, which the lattice carries; \
`cells` is the boundary of the cells of the lattice, which lies outside the skin.",
            )
            .applies(IF_IT_TOUCHES),
            Field::new(
                "touch",
                Allowed::Boolean,
                "",
                Default::Boolean(true),
                "Whether the body touches anything at all.",
            ),
        ],
    ),
    children: &[],
};

/// The contact settings of a body, as a child of its section.
pub(super) const OF_BODY: Child = child(
    "contact",
    Holds::Table(&BODY_CONTACT),
    false,
    "How the body touches other bodies, if this differs from `[contact]`.",
);
