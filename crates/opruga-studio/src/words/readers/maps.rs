//! What the readers of maps say.

pub(super) const SENTENCES: &[(&str, &str)] = &[
    ("there is no layer `{}`", "nema sloja `{}`"),
    ("no `layer`: only a topology has some", "bez `layer`: slojeve ima samo topologija"),
    ("a position has {} numbers", "položaj ima brojeva: {}"),
    ("two or three numbers", "dva ili tri broja"),
    ("the map has {} layers", "karta ima slojeva: {}"),
    ("name one by `layer`", "imenuj jedan s `layer`"),
    ("collections are nested more than {} deep", "zbirke su ugniježđene dublje od {}"),
    ("`{}` is no type that is read here", "`{}` nije vrsta koja se ovdje čita"),
    (
        "FeatureCollection, Feature, GeometryCollection, Polygon, MultiPolygon, Topology",
        "FeatureCollection, Feature, GeometryCollection, Polygon, MultiPolygon i Topology",
    ),
    ("a {} has no `{}`", "{} nema `{}`"),
    ("there is no arc {}", "nema luka {}"),
    ("a ring is not closed", "prsten nije zatvoren"),
    ("four or more positions, the last like the first", "četiri položaja ili više, zadnji kao prvi"),
    ("hole {} lies outside of its polygon", "rupa {} leži izvan svojeg poligona"),
    ("holes inside of the first ring of a polygon", "rupe unutar prvog prstena poligona"),
    ("islands are polygons of their own", "otoci su zasebni poligoni"),
    ("no polygon belongs to `{}`", "nijedan poligon ne pripada `{}`"),
    ("the `id` of a feature, or a text among its properties", "`id` obilježja ili tekst među njegovim svojstvima"),
    ("the map holds no polygon", "karta nema poligona"),
    ("({}, {}) is no place on the globe", "({}, {}) nije mjesto na globusu"),
    ("latitudes from -{} to {}, longitudes from -540 to 540", "zemljopisne širine od -{} do {}, dužine od -540 do 540"),
    ("`projection = \"none\"` takes coordinates as they are", "`projection = \"none\"` uzima koordinate kakve jesu"),
];
