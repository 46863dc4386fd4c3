//! What readers find odd and take nevertheless: told of, and counted.

pub(super) const SENTENCES: &[(&str, &str)] = &[
    // Drawings.
    ("{} outlines without area are left out", "izostavljeno obrisa bez površine: {}"),
    ("{} outline without area is left out", "izostavljeno obrisa bez površine: {}"),
    ("{} of {} outlines have less than {} m² and are left out", "{} od {} obrisa manje je od {} m² i izostavljeno"),
    ("{} of {} outlines has less than {} m² and is left out", "{} od {} obrisa manji je od {} m² i izostavljen"),
    (
        "{} points of the file become {} nodes, {} m apart",
        "od {} točaka datoteke nastaje {} čvorova, na razmaku od {} m",
    ),
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
        "{} elements have a style sheet which is not read: other colours may be meant",
        "elemenata sa stilskim listom, koji se ne čita, pa boje mogu biti druge: {}",
    ),
    (
        "{} element has a style sheet which is not read: other colours may be meant",
        "elemenata sa stilskim listom, koji se ne čita, pa boje mogu biti druge: {}",
    ),
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
    ("more warnings", "još upozorenja"),
];
