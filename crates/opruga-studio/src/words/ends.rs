//! What the world says of cells and of shapes in which bodies end, in English and in Croatian.

/// Whole sentences, as in [`super::sentences::SENTENCES`].
pub(super) const SENTENCES: &[(&str, &str)] = &[
    (
        "at t = {} s {~} inside out, the first of them cell {} of body `{}` with J = {}; hint: more substeps, {~}, or `unfold = true` \
         in `[world]`",
        "u t = {} s izvrnuto je: {~}; prva je ćelija {} tijela `{}` s J = {}; savjet: više podkoraka, {~}, ili `unfold = true` u \
         `[world]`",
    ),
    (
        "at t = {} s {~} inside out, the first of them cell {} of body `{}` with J = {}; hint: more substeps, {~}",
        "u t = {} s izvrnuto je: {~}; prva je ćelija {} tijela `{}` s J = {}; savjet: više podkoraka, {~}",
    ),
    (
        "at t = {} s cell {} of body `{}` is turned by {}°, which its law `linear` takes for a strain of {} %; counted per frame and \
         body; hint: `corotated`, the same law in axes that turn with every cell",
        "u t = {} s ćelija {} tijela `{}` zakrenuta je za {}°, što njezin zakon `linear` uzima za deformaciju od {} %; broji se po \
         okviru i tijelu; savjet: `corotated`, isti zakon u osima koje se okreću sa svakom ćelijom",
    ),
    (
        "body `{}` bends or twists too stiffly: the longest edges of its cells are {} m on average, {} times its thickness of {} m; at \
         {} times the first frequencies of plates were measured {} % too high, and they rise farther; hint: {~}",
        "tijelo `{}` presavija se ili uvija prekruto: najdulji bridovi njegovih ćelija dugi su prosječno {} m, {} puta koliko je debelo \
         ({} m); uz {} puta prve su frekvencije ploča izmjerene {} % previsoke, a dalje rastu; savjet: {~}",
    ),
    (
        "at t = {} s {~} account for, in another balance than that of the own shape: snapped through, folded, inside out or \
         twisted round; the first of them is body `{}` with {} J, {} J of it accounted for, V/V₀ = {}, and cell {} at J = {}; hint: \
         where this was not meant, begin in its own shape, with more damping or more substeps{~}",
        "u t = {} s {~}, u drugoj ravnoteži nego što je ona vlastitog oblika: preskočilo, presavijeno, izvrnuto ili zavrnuto; prvo \
         je tijelo `{}` s {} J, od toga objašnjeno {} J, V/V₀ = {}, i ćelijom {} s J = {}; savjet: ako to nije namjera, počni u \
         vlastitom obliku, s više prigušenja ili podkoraka{~}",
    ),
    (
        "at t = {} s {~} account for, in another balance than that of the own shape: snapped through, folded, inside out or \
         twisted round; the first of them is body `{}` with {} J, {} J of it accounted for, V/V₀ = {}, and cell {} at J = {}; hint: \
         where this was not meant, begin in its own shape, with more damping or more substeps",
        "u t = {} s {~}, u drugoj ravnoteži nego što je ona vlastitog oblika: preskočilo, presavijeno, izvrnuto ili zavrnuto; prvo \
         je tijelo `{}` s {} J, od toga objašnjeno {} J, V/V₀ = {}, i ćelijom {} s J = {}; savjet: ako to nije namjera, počni u \
         vlastitom obliku, s više prigušenja ili podkoraka",
    ),
];

/// Parts of them, as in [`super::sentences::PARTS`].
pub(super) const PARTS: &[(&str, &str)] = &[
    (", or `unfold = true` in `[world]`", ", ili `unfold = true` u `[world]`"),
    ("1 cell is", "1 ćelija"),
    ("{} cells are", "ćelija {}"),
    (
        "quadratic cells (`order = 2`), quadrilaterals or hexahedra",
        "kvadratne ćelije (`order = 2`), četverokuti ili heksaedri",
    ),
    ("hexahedra, or shorter cells", "heksaedri ili kraće ćelije"),
    ("perhaps {~}", "možda {~}"),
    ("{} and perhaps {} more cells are", "ćelija {} i možda još {}"),
    ("smaller cells, or less that crushes them", "manje ćelije, ili manje onoga što ih drobi"),
    (
        "smaller cells, or a material that pushes such cells back from farther (`fixed_corotated`)",
        "manje ćelije, ili materijal koji takve ćelije vraća iz veće daljine (`fixed_corotated`)",
    ),
    (
        "or a material that pushes such cells back (`stable_neo_hookean`, `fixed_corotated`)",
        "ili materijal koji takve ćelije vraća (`stable_neo_hookean`, `fixed_corotated`)",
    ),
    (
        "1 body holds more energy in its cells than the forces on it",
        "1 tijelo ima u ćelijama više energije nego što je sile na njemu objašnjavaju",
    ),
    (
        "{} bodies hold more energy in their cells than the forces on them",
        "više energije u ćelijama nego što je sile na njima objašnjavaju ima tijela: {}",
    ),
];
