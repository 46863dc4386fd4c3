//! What readers find odd and take nevertheless: told of, and counted.

pub(super) const SENTENCES: &[(&str, &str)] = &[
    ("{} of `{}` are left out", "{} od `{}` izostavljeno"),
    // Drawings.
    ("{} outlines without area are left out", "izostavljeno obrisa bez površine: {}"),
    ("{} outline without area is left out", "izostavljeno obrisa bez površine: {}"),
    (
        "{} outline lies within one of another element and is a hole there",
        "obrisa unutar obrisa drugog elementa, koji su ondje rupe: {}",
    ),
    (
        "{} outlines lie within those of other elements and are holes there",
        "obrisa unutar obrisa drugih elemenata, koji su ondje rupe: {}",
    ),
    (
        "`overlap = \"union\"` keeps what any element paints, `overlap = \"even_odd\"` says that holes are meant",
        "`overlap = \"union\"` zadržava što bilo koji element boji, `overlap = \"even_odd\"` kaže da se misli na rupe",
    ),
    ("{} of {} outlines have less than {} m² and are left out", "{} od {} obrisa manje je od {} m² i izostavljeno"),
    ("{} of {} outlines has less than {} m² and is left out", "{} od {} obrisa manji je od {} m² i izostavljen"),
    (
        "{} points of the file become {} nodes, {} m apart: {~}",
        "od {} točaka datoteke nastaje {} čvorova, na razmaku od {} m: {~}",
    ),
    (
        "{} point of the file becomes {} nodes, {} m apart: {~}",
        "od {} točke datoteke nastaje {} čvorova, na razmaku od {} m: {~}",
    ),
    ("{} nodes {} m apart leave {~}", "{} čvorova na razmaku od {} m daje ovo: {~}"),
    ("the filling leaves {~}", "popunjavanje daje ovo: {~}"),
    ("edges of {} m leave {~}", "bridovi od {} m daju ovo: {~}"),
    ("{} % of the volume, above 25 % is an error", "{} % obujma, iznad 25 % je pogreška"),
    (
        "{} of {~} have angles below {}°, the smallest {}° at ({}, {}): {~}",
        "{} od ({~}) ima kutove ispod {}°, najmanji od {}° u ({}, {}): {~}",
    ),
    (
        "{} of {~} has angles below {}°, the smallest {}° at ({}, {}): {~}",
        "{} od ({~}) ima kutove ispod {}°, najmanji od {}° u ({}, {}): {~}",
    ),
    ("angles from {}°", "kutovi od {}° naviše"),
    ("the outline itself has a corner of {}° there", "sâm obris ondje ima kut od {}°"),
    ("the outline is finer there than `spacing`", "obris je ondje finiji od `spacing`"),
    ("the refinement has added as many nodes as it may", "profinjavanje je dodalo onoliko čvorova koliko smije"),
    (
        "round it off in the drawing, or take `filling = \"lattice\"`",
        "zaobli ga u crtežu, ili uzmi `filling = \"lattice\"`",
    ),
    ("take a smaller `spacing`, or `filling = \"lattice\"`", "uzmi manji `spacing`, ili `filling = \"lattice\"`"),
    ("take a larger `spacing`, or `filling = \"lattice\"`", "uzmi veći `spacing`, ili `filling = \"lattice\"`"),
    ("take a smaller `spacing`", "uzmi manji `spacing`"),
    ("`spacing = {}` keeps the volume within {} %", "`spacing = {}` čuva obujam unutar {} %"),
    (
        "{} filled shapes have a stroke which is left out: the outline runs along its middle",
        "popunjenih oblika čiji je potez izostavljen, pa obris ide njegovom sredinom: {}",
    ),
    (
        "{} filled shape has a stroke which is left out: the outline runs along its middle",
        "popunjenih oblika čiji je potez izostavljen, pa obris ide njegovom sredinom: {}",
    ),
    ("{} elements have a filter which is not applied", "elemenata čiji filtar nije primijenjen: {}"),
    ("{} element has a filter which is not applied", "elemenata čiji filtar nije primijenjen: {}"),
    ("{} animations are left out", "izostavljeno animacija: {}"),
    ("{} animation is left out", "izostavljeno animacija: {}"),
    ("{} other scenes are left out", "izostavljeno drugih scena: {}"),
    ("{} other scene is left out", "izostavljeno drugih scena: {}"),
    ("{} skins, by which vertices follow bones, are left out", "izostavljeno koža, po kojima vrhovi prate kosti: {}"),
    ("{} skin, by which vertices follow bones, is left out", "izostavljeno koža, po kojima vrhovi prate kosti: {}"),
    ("{} parts with shapes to morph into have them left out", "dijelova čiji su oblici za pretapanje izostavljeni: {}"),
    ("{} part with shapes to morph into has them left out", "dijelova čiji su oblici za pretapanje izostavljeni: {}"),
    ("{} of `{}` is left out", "{} od `{}` izostavljeno"),
    ("features with polygons", "obilježja s poligonima"),
    ("`{}` is a feature without geometry", "`{}` je obilježje bez geometrije"),
    ("`{}` is nothing but points and lines", "`{}` su samo točke i linije"),
    (
        "{} shapes name no `fill-rule` and would have fewer holes by the non-zero rule",
        "oblika bez `fill-rule`, koji bi po pravilu nonzero imali manje rupa: {}",
    ),
    (
        "{} shape names no `fill-rule` and would have fewer holes by the non-zero rule",
        "oblika bez `fill-rule`, koji bi po pravilu nonzero imali manje rupa: {}",
    ),
    ("{} open paths are closed by a straight line", "otvorenih krivulja zatvorenih dužinom: {}"),
    ("{} open path is closed by a straight line", "otvorenih krivulja zatvorenih dužinom: {}"),
    (
        "{} shapes without fill are read by their outlines instead of strokes",
        "oblika bez ispune, čitanih po obrisu umjesto po potezu: {}",
    ),
    (
        "{} shape without fill is read by its outline instead of strokes",
        "oblika bez ispune, čitanih po obrisu umjesto po potezu: {}",
    ),
    ("{} images are left out", "izostavljeno slika: {}"),
    ("{} image is left out", "izostavljeno slika: {}"),
    ("{} elements that cannot be seen are left out", "izostavljeno nevidljivih elemenata: {}"),
    ("{} element that cannot be seen is left out", "izostavljeno nevidljivih elemenata: {}"),
    ("{} elements have markers which are left out", "elemenata čije su oznake izostavljene: {}"),
    ("{} element has markers which are left out", "elemenata čije su oznake izostavljene: {}"),
    ("{} gradients are painted in the mean of the colours", "prijelaza obojenih srednjom bojom: {}"),
    ("{} gradient is painted in the mean of the colours", "prijelaza obojenih srednjom bojom: {}"),
    (
        "{} shapes have rules of style sheets behind a selector that is not read: other colours may be meant",
        "likova za koje stilski list možda ima pravilo, iza selektora koji se ne čita, pa boje mogu biti druge: {}",
    ),
    (
        "{} shape has a rule of a style sheet behind a selector that is not read: other colours may be meant",
        "likova za koje stilski list možda ima pravilo, iza selektora koji se ne čita, pa boje mogu biti druge: {}",
    ),
    ("{} shapes without a path or points are left out", "izostavljeno likova bez putanje ili točaka: {}"),
    ("{} shape without a path or points is left out", "izostavljeno likova bez putanje ili točaka: {}"),
    // Maps.
    ("{} points and lines are left out", "izostavljeno točaka i linija: {}"),
    ("{} point or line is left out", "izostavljeno točaka i linija: {}"),
    ("{} features have no geometry", "obilježja bez geometrije: {}"),
    ("{} feature has no geometry", "obilježja bez geometrije: {}"),
    ("{} outlines cross the antimeridian and are in one piece", "obrisa preko antimeridijana, u jednom komadu: {}"),
    ("{} outline crosses the antimeridian and is in one piece", "obrisa preko antimeridijana, u jednom komadu: {}"),
    (
        "{} polygons that were cut along the antimeridian are one again",
        "poligona rezanih duž antimeridijana, opet spojenih: {}",
    ),
    ("{} polygons are moved by 360° beside the others", "poligona pomaknutih za 360° uz druge: {}"),
    ("{} polygon is moved by 360° beside the others", "poligona pomaknutih za 360° uz druge: {}"),
    (
        "{} outline around a pole is cut along the antimeridian and closed along the pole",
        "obrisa oko pola, rezanih duž antimeridijana i zatvorenih duž pola: {}",
    ),
    ("{} features belong to `{}` and are read together", "{} obilježja pripada `{}` i čita se zajedno"),
    // Surfaces.
    ("{} lines and points are left out", "izostavljeno linija i točaka: {}"),
    ("{} line or point is left out", "izostavljeno linija i točaka: {}"),
    (
        "{} vertices have weights other than 1, which triangles do not have",
        "vrhova s težinom različitom od 1, kakvu trokuti nemaju: {}",
    ),
    (
        "{} vertex has a weight other than 1, which triangles do not have",
        "vrhova s težinom različitom od 1, kakvu trokuti nemaju: {}",
    ),
    (
        "{} normals are no numbers: the order of the corners tells the side",
        "normala koje nisu brojevi, pa stranu kaže redoslijed uglova: {}",
    ),
    (
        "{} normal is no number: the order of the corners tells the side",
        "normala koje nisu brojevi, pa stranu kaže redoslijed uglova: {}",
    ),
    (
        "{} normals point against their triangles: the order of the corners tells the side",
        "normala okrenutih protiv svojih trokuta, pa stranu kaže redoslijed uglova: {}",
    ),
    (
        "{} normal points against its triangle: the order of the corners tells the side",
        "normala okrenutih protiv svojih trokuta, pa stranu kaže redoslijed uglova: {}",
    ),
    ("{} vertices that no triangle names are left out", "izostavljeno vrhova koje nijedan trokut ne imenuje: {}"),
    ("{} vertex that no triangle names is left out", "izostavljeno vrhova koje nijedan trokut ne imenuje: {}"),
    (
        "{} of {} triangles are slivers; the thinnest is triangle {}, with an area of {} of its longest edge squared",
        "{} od {} trokuta tanki su kao iver; najtanji je trokut {}, s površinom od {} kvadrata najduljeg brida",
    ),
    (
        "{} of {~} is a sliver; the thinnest is triangle {}, with an area of {} of its longest edge squared",
        "{} od ({~}) tanak je kao iver; najtanji je trokut {}, s površinom od {} kvadrata najduljeg brida",
    ),
    (
        "{} of {~} with more than three corners are concave: cut along diagonals inside",
        "udubljenih strana: {} od ({~}) s više od tri ugla; razrezane su po dijagonalama iznutra",
    ),
    (
        "{} of {~} with more than three corners is concave: cut along diagonals inside",
        "udubljenih strana: {} od ({~}) s više od tri ugla; razrezana je po dijagonalama iznutra",
    ),
    (
        "{} of {~} with more than three corners are not flat, by up to {} of their size: cut along the better diagonals",
        "strana koje nisu ravne: {} od ({~}) s više od tri ugla, do {} svoje veličine; razrezane su po boljim dijagonalama",
    ),
    (
        "{} of {~} with more than three corners is not flat, by up to {} of their size: cut along the better diagonals",
        "strana koje nisu ravne: {} od ({~}) s više od tri ugla, do {} svoje veličine; razrezana je po boljim dijagonalama",
    ),
    (
        "the length covers the whole file: leave out what follows it, {} bytes",
        "duljina obuhvaća cijelu datoteku: izostavi što slijedi, bajtova: {}",
    ),
    (
        "a face is far from flat: a corner lies {} of its size off its plane",
        "strana je daleko od ravne: jedan joj ugao leži {} njezine veličine izvan njezine ravnine",
    ),
    ("the surface is {} m large", "ploha je velika {} m"),
    ("{} of {} vertices are joined to others", "{} od {} vrhova spojeno je s drugima"),
    ("{} of {} vertices is joined to others", "{} od {} vrhova spojen je s drugima"),
    ("{} free boundaries are closed by fans of triangles", "slobodnih rubova zatvorenih lepezama trokuta: {}"),
    ("{} free boundary is closed by fans of triangles", "slobodnih rubova zatvorenih lepezama trokuta: {}"),
    ("{} components that are inside out are turned", "okrenuto izvrnutih dijelova: {}"),
    ("{} component that is inside out is turned", "okrenuto izvrnutih dijelova: {}"),
    (
        "too many triangles lie over one another: not all were compared, and some may cross",
        "previše trokuta leži jedan preko drugog: nisu svi uspoređeni, i neki se možda sijeku",
    ),
    (
        "{} pairs and more of triangles cross, touch or overlap",
        "parova trokuta koji se sijeku, dodiruju ili prekrivaju, ili više: {}",
    ),
    ("{} pairs of triangles cross, touch or overlap", "parova trokuta koji se sijeku, dodiruju ili prekrivaju: {}"),
    ("{} pair of triangles cross, touch or overlap", "parova trokuta koji se sijeku, dodiruju ili prekrivaju: {}"),
    ("{} triangles that face against their neighbours are turned", "okrenuto trokuta suprotnih svojim susjedima: {}"),
    ("{} triangle that faces against its neighbours is turned", "okrenuto trokuta suprotnih svojim susjedima: {}"),
    // Scenes.
    ("the points of `{}` run clockwise", "točke tijela `{}` idu u smjeru kazaljke na satu"),
];
