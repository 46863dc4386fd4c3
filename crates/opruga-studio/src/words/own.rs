//! What the studio itself says in the words of the world, in English and in Croatian.

/// Whole sentences, as in [`super::sentences::SENTENCES`].
pub(super) const SENTENCES: &[(&str, &str)] = &[
    ("`{}` exploded: `{}` is unstable at this step", "tijelo `{}` se raspalo: `{}` je nestabilan uz ovaj korak"),
    (
        "`{}` exploded: it is more than 100 times as large as the scene was",
        "tijelo `{}` se raspalo: više je od 100 puta veće nego što je bio prizor",
    ),
];

#[cfg(test)]
mod tests {
    use super::super::{Language, details};
    use crate::exploded::Exploded;
    use crate::said::Said;

    #[test]
    fn a_body_that_exploded_is_told_of_in_both_languages_on_either_side() {
        for unstable in [true, false] {
            let exploded = Exploded { body: "ball".into(), integrator: "explicit_euler".into(), unstable };
            let beside = details::croatian(&exploded.to_string()).expect("it is known");
            let [english, croatian] =
                [Language::English, Language::Croatian].map(|words| words.said(&Said::Exploded(exploded.clone())));
            assert!(english.starts_with("`ball` exploded: "), "{english}");
            assert_eq!(english == "`ball` exploded: explicit euler is unstable at this step", unstable, "{english}");
            for said in [&beside, &croatian] {
                assert!(said.contains("`ball` se raspalo") && said.contains("nestabilan") == unstable, "{said}");
            }
            assert!(croatian.contains("eksplicitni Euler") == unstable, "{croatian}");
        }
    }
}
