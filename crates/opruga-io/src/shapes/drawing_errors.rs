//! Errors and notices of the readers of drawings, maps, fonts and pictures.

use opruga_math::message::Setting;
use opruga_math::messages;
use opruga_math::words::counted;

messages! {
    /// Errors in an SVG drawing.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum SvgError {
        "svg.unknown_id" #[error("no element has the id `{id}`")] #[value("{id}")]
        UnknownId { id: String },
        "svg.same_id" #[error("two elements have the id `{id}`")] #[value("{id}")] #[allowed("ids that differ")]
        SameId { id: String },
        "svg.unsupported" #[error("the drawing is stretched more in one direction than in the other")] #[value("preserveAspectRatio=\"none\"")]
        #[allowed("a width and a height in proportion to the `viewBox`")]
        Stretched {},
        "svg.unsupported" #[error("the language to use is unknown")] #[value("systemLanguage")]
        #[hint("leave only one element in the <switch>")]
        Language {},
        "svg.unsupported" #[error("`{property}` cannot be read")] #[value("{value}")] #[hint("apply it in the drawing program")]
        Property { property: String, value: String },
        "svg.depth" #[error("elements are nested more than {deepest} levels deep")] #[value("{element}")] #[allowed("at most {deepest} levels")]
        Depth { deepest: usize, element: String },
        "svg.unsupported" #[error("<{element}> has no outline here")] #[value("{element}")]
        #[hint("turn text into paths in the drawing program, or use a shape of `kind = \"text\"` in a scene")]
        NoOutline { element: String },
        "svg.unsupported" #[error("<{element}> cannot be read")] #[value("{element}")]
        #[allowed("path, rect, circle, ellipse, polygon, polyline in svg, g, a, switch, use")]
        Element { element: String },
        "svg.outside" #[error("`{link}` is not an element of this file")] #[value("{link}")]
        #[allowed("href = \"#id\" of this file")] #[hint("other files are never read")]
        Outside { link: String },
        "svg.cycle" #[error("`#{id}` contains itself")] #[value("{id}")] #[hint("an element cannot be drawn inside itself")]
        Cycle { id: String },
        "svg.unsupported" #[error("a <use> cannot give an <svg> another size")] #[value("use")]
        #[hint("give the <svg> itself its `width` and `height`")]
        SizeOfUse {},
        "svg.unsupported" #[error("the size of an element with a `viewBox` is unknown")] #[value("{element}")]
        #[hint("give the element `width` and `height`")]
        SizeOfView { element: String },
        "svg.unsupported" #[error("<{element}> has a frame that cuts off {percent} % of its content")] #[value("{element}")]
        #[allowed("content inside the frame")] #[hint("`overflow=\"visible\"` shows all of it")]
        Framed { element: String, percent: String },
        "svg.unsupported" #[error("`clip-path` cuts off {percent} % of what is drawn")] #[value("{value}")]
        #[allowed("clip paths that enclose everything that is drawn")] #[hint("apply it in the drawing program")]
        Clipped { percent: String, value: String },
        "svg.syntax" #[error("`{attribute}` cannot be read: {reason}")] #[value("{found}")]
        Attribute { attribute: String, reason: String, found: String },
        "svg.syntax" #[error("`viewBox` cannot be read: {reason}")] #[value("{value}")] #[allowed("x y width height")]
        ViewBox { reason: String, value: String },
        "svg.number" #[error("the transform gives coordinates outside the range of numbers")] #[value("{value}")]
        Transform { value: String },
        "svg.unsupported" #[error("length `{attribute}` cannot be read")] #[value("{value}")]
        #[allowed("a finite number without unit, or in px, pt, pc, mm, cm, in, or in % of a drawing with a `viewBox`")]
        Length { attribute: String, value: String },
        "svg.number" #[error("`{attribute}` is negative")] #[value("{value}")] #[allowed("0 or more")]
        Negative { attribute: String, value: f64 },
        "svg.syntax" #[error("`points` has {count} numbers, which is odd")] #[value("{count}")] #[allowed("pairs of numbers")]
        OddPoints { count: usize },
        "svg.number" #[error("the path gives coordinates outside the range of numbers")] #[value("inf")]
        Path {},
        "svg.unsupported" #[error("invalid `fill-rule`")] #[value("{value}")] #[allowed("evenodd, nonzero")]
        FillRule { value: String },
        "svg.colour" #[error("`{property}` is not a number")] #[value("{value}")] #[allowed("0 to 1")]
        Share { property: String, value: String },
        "svg.colour" #[error("the fill cannot be painted")] #[value("{value}")]
        #[allowed("a colour such as #ffac33 or gold, a gradient of this file, none")] #[hint("{colours} reads only the outline")]
        Colour { value: String, colours: Setting },
        "svg.style" #[error("a style sheet may set `{property}` here, which changes outlines")] #[value("{property}: {value}")]
        #[allowed("rules without conditions, with selectors that are names, `.class` and `#id`")]
        #[hint("let the drawing program write attributes instead of a style sheet")]
        Style { property: String, value: String },
        "svg.syntax" #[error("the file is <{element}>, not a drawing")] #[value("{element}")] #[allowed("<svg>")]
        NoDrawing { element: String },
        "svg.syntax" #[error("invalid XML: {reason}")] #[value("{found}")]
        Xml { reason: String, found: String },
        "limit.elements" #[error("invalid XML: {reason}")] #[value("{found}")]
        Elements { reason: String, found: String },
        "svg.entity" #[error("invalid XML: {reason}")] #[value("{found}")] #[hint("entities from outside the file are never read")]
        OutsideEntity { reason: String, found: String },
        "svg.entity" #[error("invalid XML: {reason}")] #[value("{found}")] #[hint("entities may not contain one another")]
        EntityLoop { reason: String, found: String },
    }

    /// Parts of an SVG drawing that are omitted or interpreted differently.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum SvgNotice {
        "svg.open_path" #[error("{} closed by a straight line", counted(*count as u64, "open path is", "open paths are"))] #[value("{count}")]
        OpenPaths { count: usize },
        "svg.stroke" #[error("{}; strokes are ignored", counted(*count as u64, "shape without a fill is read as the area enclosed by its outline", "shapes without a fill are read as the areas enclosed by their outlines"))] #[value("{count}")]
        Unfilled { count: usize },
        "svg.empty" #[error("{} left out", counted(*count as u64, "shape without a path or points is", "shapes without a path or points are"))] #[value("{count}")]
        Empty { count: usize },
        "svg.image" #[error("{} left out", counted(*count as u64, "image is", "images are"))] #[value("{count}")]
        Images { count: usize },
        "svg.hidden" #[error("{} left out", counted(*count as u64, "element that cannot be seen is", "elements that cannot be seen are"))] #[value("{count}")]
        Hidden { count: usize },
        "svg.marker" #[error("{}, which are left out", counted(*count as u64, "element has markers", "elements have markers"))] #[value("{count}")]
        Markers { count: usize },
        "svg.filter" #[error("{}, which is not applied", counted(*count as u64, "element has a filter", "elements have a filter"))] #[value("{count}")]
        Filters { count: usize },
        "svg.stroke" #[error("{}, which is left out: the outline runs along the middle of the stroke", counted(*count as u64, "filled shape has a stroke", "filled shapes have a stroke"))]
        #[value("{count}")]
        Strokes { count: usize },
        "svg.animation" #[error("{} left out", counted(*count as u64, "animation is", "animations are"))] #[value("{count}")]
        Animations { count: usize },
        "svg.gradient" #[error("{} painted in the mean of the colours", counted(*count as u64, "gradient is", "gradients are"))] #[value("{count}")]
        Gradients { count: usize },
        "svg.style" #[error("{} with a selector that is not read: other colours may be intended", counted(*count as u64, "shape has a rule of a style sheet", "shapes have rules of style sheets"))]
        #[value("{count}")]
        Styled { count: usize },
        "svg.fill_rule" #[error("{} no `fill-rule` and would have fewer holes under the non-zero rule", counted(*count as u64, "shape names", "shapes name"))] #[value("{count}")]
        #[hint("`fill-rule=\"evenodd\"` or `fill-rule=\"nonzero\"` in the file determines which rule applies")]
        FillRule { count: usize },
    }

    /// Errors in a map.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum MapError {
        "map.unknown_layer" #[error("there is no layer `{layer}`")] #[value("{layer}")] #[allowed("no {setting}: only a topology has layers")]
        NoLayers { layer: String, setting: Setting },
        "map.unknown_layer" #[error("there is no layer `{layer}`")] #[value("{layer}")] #[allowed("{known}")]
        NoLayer { layer: String, known: String },
        "map.unknown_layer" #[error("the map has {count} layers")] #[value("")] #[allowed("{known}")] #[hint("name one with {setting}")]
        SeveralLayers { count: usize, known: String, setting: Setting },
        "map.syntax" #[error("a position has {count} numbers")] #[value("{count}")] #[allowed("two or three numbers")]
        Position { count: usize },
        "map.depth" #[error("collections are nested more than {deepest} levels deep")] #[allowed("at most {deepest} levels")]
        Depth { deepest: usize },
        "map.syntax" #[error("type `{kind}` cannot be read")] #[value("{kind}")]
        #[allowed("FeatureCollection, Feature, GeometryCollection, Polygon, MultiPolygon, Topology")]
        Kind { kind: String },
        "map.syntax" #[error("a {kind} has no `{field}`")] #[allowed("{field}")]
        NoField { kind: String, field: &'static str },
        "map.arc" #[error("there is no arc {arc}")] #[value("{arc}")] #[allowed("{least} to {most}")]
        NoArc { arc: i64, least: i64, most: i64 },
        "map.syntax" #[error("a ring is not closed")] #[value("{count}")] #[allowed("four or more positions, the last like the first")]
        OpenRing { count: usize },
        "map.hole" #[error("hole {hole} lies outside its polygon")] #[value("{position}")]
        #[allowed("holes inside the first ring of a polygon")] #[hint("an island must be a separate polygon")]
        Hole { hole: usize, position: String },
        "map.unknown_feature" #[error("`{feature}` is empty")] #[value("{feature}")] #[allowed("features with polygons")]
        Nothing { feature: String },
        "map.unknown_feature" #[error("`{feature}` is a feature without geometry")] #[value("{feature}")] #[allowed("features with polygons")]
        NoGeometry { feature: String },
        "map.unknown_feature" #[error("`{feature}` has only points and lines")] #[value("{feature}")] #[allowed("features with polygons")]
        PointsAndLines { feature: String },
        "map.unknown_feature" #[error("no polygon belongs to `{feature}`")] #[value("{feature}")]
        #[allowed("the `id` of a feature, or a text among its properties")]
        NoFeature { feature: String },
        "shape.no_area" #[error("the map contains no polygon")] #[value("0")]
        NoPolygon {},
        "map.range" #[error("({x}, {y}) is not a point on the globe")] #[value("{x}, {y}")]
        #[allowed("latitudes from -{most} to {most}, longitudes from -540 to 540")] #[hint("{projection} uses coordinates as they are")]
        Range { x: f64, y: f64, most: f64, projection: Setting },
        "json.syntax" #[error("{reason}")] #[value("{found}")]
        Json { reason: String, found: String },
    }

    /// Parts of a map that are omitted or changed.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum MapNotice {
        "mesh.strokes" #[error("{} left out", counted(*count as u64, "point or line is", "points and lines are"))] #[value("{count}")]
        PointsAndLines { count: usize },
        "map.empty" #[error("{} no geometry", counted(*count as u64, "feature has", "features have"))] #[value("{count}")]
        Empty { count: usize },
        "map.antimeridian" #[error("{} in one piece", counted(*count as u64, "outline crosses the antimeridian and is kept", "outlines cross the antimeridian and are kept"))] #[value("{count}")]
        Over { count: usize },
        "map.antimeridian" #[error("{count} polygons that were cut along the antimeridian are joined again")] #[value("{count}")]
        Cut { count: usize },
        "map.antimeridian" #[error("{} moved by 360° to lie next to the others", counted(*count as u64, "polygon is", "polygons are"))] #[value("{count}")]
        Beside { count: usize },
        "map.pole" #[error("{} cut along the antimeridian and closed along the pole", counted(*count as u64, "outline around a pole is", "outlines around a pole are"))]
        #[value("{count}")]
        Polar { count: usize },
        "map.features" #[error("{count} features belong to `{feature}` and are read together")] #[value("{count}")]
        Features { count: usize, feature: String },
    }

    /// Errors in a font or a picture, or in what the scene asks of them.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum LetterError {
        "font.syntax" #[error("the font cannot be read: {reason}")] #[value("{bytes} bytes")] #[allowed("OpenType or TrueType (.ttf, .otf)")]
        Font { reason: String, bytes: usize },
        "font.no_glyph" #[error("`{letter}` is not a letter")] #[value("{letter}")]
        NoLetter { letter: String },
        "font.script" #[error("`{letter}` belongs to a script whose letters are not set one by one from left to right")] #[value("{letter}")]
        #[allowed("letters of scripts such as Latin, Greek or Cyrillic, without combining marks")]
        #[hint("write the text in a drawing program and convert it to paths in an SVG file")]
        Script { letter: String },
        "font.no_glyph" #[error("the font `{font}` has no letter `{letter}`")] #[value("{letter}")]
        NoGlyph { font: String, letter: String },
        "shape.no_area" #[error("the text is empty")] #[value("")] #[allowed("at least one letter that is drawn")]
        EmptyText {},
        "shape.no_area" #[error("the text has no letter with an outline")] #[value("{text}")] #[allowed("at least one letter that is drawn")]
        NoLetters { text: String },
        "shape.no_area" #[error("no pixel is more {inside} than the threshold")] #[value("at most {most}")] #[allowed("pixels above {threshold}")]
        #[hint("use a smaller {lower}, or another {choice}: dark, bright or opaque")]
        NoPixel { inside: String, most: String, threshold: f64, lower: Setting, choice: Setting },
        "png.syntax" #[error("the PNG cannot be read: {reason}")] #[value("{bytes} bytes")] #[allowed("a picture in PNG")]
        Png { reason: String, bytes: usize },
    }
}
