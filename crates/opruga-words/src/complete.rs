//! Finds gaps in a translation, for tests.

use crate::{Translation, entry_name};
use fluent_syntax::ast::{Expression, InlineExpression, Pattern, PatternElement};
use opruga_math::message::Variant;
use std::collections::BTreeSet;

impl Translation {
    /// Lists the entries, attributes and fields that are missing or superfluous for these variants.
    pub fn gaps<'v>(&self, variants: impl Iterator<Item = &'v Variant>) -> Vec<String> {
        let (mut problems, mut names) = (Vec::new(), BTreeSet::new());
        for variant in variants {
            let name = entry_name(variant.code, variant.name);
            let Some(entry) = self.entries.get(&*name) else {
                problems.push(format!("`{name}` is missing"));
                continue;
            };
            for (kind, english) in ["text", "allowed", "hint"].iter().zip(variant.english) {
                let pattern = match *kind {
                    "text" => entry.value.as_ref(),
                    kind => entry.attributes.iter().find(|a| a.id.name == kind).map(|a| &a.value),
                };
                let mut used = BTreeSet::new();
                pattern.into_iter().for_each(|pattern| variables(pattern, &mut used));
                let wanted: BTreeSet<&str> =
                    variant.fields.iter().copied().filter(|field| names_field(english, field)).collect();
                if pattern.is_some() == english.is_empty() && *kind != "text" {
                    problems.push(format!("`{name}` and its English text do not both have `{kind}`"));
                } else if used != wanted {
                    problems
                        .push(format!("`{name}` has the fields {used:?} in `{kind}`, and the English text {wanted:?}"));
                }
            }
            if !names.insert(name.clone()) {
                problems.push(format!("two variants are called `{name}`"));
            }
        }
        let stale = self.entries.keys().filter(|name| !names.contains(**name));
        problems.extend(stale.map(|name| format!("no variant is called `{name}`")));
        problems
    }
}

/// Whether the source of a text uses a field, within braces or outside quotes.
fn names_field(source: &str, field: &str) -> bool {
    let word = |text: &str| text.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == field);
    // Of the pieces between quotes, every second one is quoted. Escaped quotes do not matter in texts without braces around them.
    let plain = source.replace("\\\"", "");
    plain.split('"').enumerate().any(|(index, piece)| match index % 2 {
        1 => piece.split('{').skip(1).any(|gap| word(gap.split('}').next().unwrap_or_default())),
        _ => word(piece),
    })
}

fn variables<'p>(pattern: &Pattern<&'p str>, used: &mut BTreeSet<&'p str>) {
    for element in &pattern.elements {
        if let PatternElement::Placeable { expression } = element {
            match expression {
                Expression::Inline(inline) => variable(inline, used),
                Expression::Select { selector, variants } => {
                    variable(selector, used);
                    variants.iter().for_each(|variant| variables(&variant.value, used));
                }
            }
        }
    }
}

fn variable<'p>(inline: &InlineExpression<&'p str>, used: &mut BTreeSet<&'p str>) {
    match inline {
        InlineExpression::VariableReference { id } => {
            used.insert(id.name);
        }
        InlineExpression::FunctionReference { arguments, .. } => {
            arguments.positional.iter().for_each(|argument| variable(argument, used));
        }
        _ => {}
    }
}
