//! Maps: polygons of GeoJSON and TopoJSON, from degrees to the plane.
//!
//! # Source
//! RFC 7946, The GeoJSON Format; M. Bostock and C. Metcalf, The TopoJSON Format Specification (2013).

use super::curves::{Curves, Point, larger, smaller};
use super::drawing::Drawing;
use super::drawing_errors::{MapError, MapNotice};
use super::globe::{self, Polygon};
use super::json::{Raw, parse, refuse, span};
use crate::budget::POINTS;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use opruga_core::spec::{Values, nearest};
use opruga_math::message::Setting;
use opruga_mesh::outline::Inside;
use serde::Deserialize;
use std::cell::Cell;
use std::collections::BTreeMap;

/// The deepest nesting of collections.
const DEEPEST: usize = 32;

/// Any object of either format; missing parts stay empty.
#[derive(Deserialize)]
struct Object<'a> {
    #[serde(rename = "type")]
    kind: String,
    #[serde(borrow)]
    features: Option<Vec<Raw<'a>>>,
    #[serde(borrow)]
    geometry: Option<Raw<'a>>,
    #[serde(borrow)]
    geometries: Option<Vec<Raw<'a>>>,
    #[serde(borrow)]
    coordinates: Option<Raw<'a>>,
    #[serde(borrow)]
    arcs: Option<Raw<'a>>,
    id: Option<serde_json::Value>,
    properties: Option<BTreeMap<String, serde_json::Value>>,
}

#[derive(Deserialize)]
struct Topology<'a> {
    #[serde(borrow)]
    objects: BTreeMap<String, Raw<'a>>,
    #[serde(borrow)]
    arcs: Vec<Raw<'a>>,
    transform: Option<Quantisation>,
}

#[derive(Deserialize)]
struct Quantisation {
    scale: [f64; 2],
    translate: [f64; 2],
}

struct Reader<'a, 's> {
    source: &'s Source<'s>,
    wanted: Option<&'s str>,
    /// The arcs of a topology, in degrees.
    arcs: Option<Vec<Vec<Point>>>,
    /// The number of points of arcs, counted as often as rings name them.
    drawn: Cell<u64>,
    polygons: Vec<(Polygon, Raw<'a>)>,
    names: Vec<String>,
    /// The number of geometries with an area that the scene does not select.
    areas: usize,
    /// The number of objects with the name that the scene gives.
    meant: usize,
    /// The number of points and lines, which have no area.
    others: usize,
    /// The number of features and geometries that are null.
    empty: usize,
}

/// Reads a map: the feature that the scene names, or all features.
///
/// # Errors
/// `json.syntax`, `map.syntax`, `map.arc`, `map.hole`, `map.range`, `map.unknown_feature`, `map.unknown_layer`, with line and column.
pub(super) fn read<'a>(source: &'a Source<'a>, shape: &'a Values) -> Result<Drawing<'a>, SceneError> {
    let text = source.text;
    let raw: Raw<'_> = parse(source, text)?;
    let top: Object<'_> = parse(source, raw.get())?;
    let wanted = shape.text("feature");
    let (polygons, names) = (Vec::new(), Vec::new());
    let drawn = Cell::new(0);
    let mut reader =
        Reader { source, wanted, arcs: None, drawn, polygons, names, areas: 0, meant: 0, others: 0, empty: 0 };
    if top.kind == "Topology" {
        let topology: Topology<'_> = parse(source, raw.get())?;
        reader.arcs = Some(arcs(source, &topology)?);
        let layer = layer(source, raw, &topology, shape.text("layer"))?;
        reader.object(layer, wanted.is_none(), 0)?;
    } else if let Some(layer) = shape.text("layer") {
        let error = SceneError::of(MapError::NoLayers { layer: visible(layer), setting: Setting::named("layer") });
        return Err(refuse(source, &text[..1.min(text.len())], error));
    } else {
        reader.object(raw, wanted.is_none(), 0)?;
    }
    if reader.polygons.is_empty() {
        return Err(reader.nothing(raw));
    }
    let laid_out = match shape.text("projection") {
        Some("none") => globe::LaidOut::default(),
        _ => globe::lay_out(&mut reader.polygons, reader.arcs.is_some()),
    };
    let mut curves = Curves::default();
    let mut spans = Vec::new();
    let project = projection(source, &reader.polygons, shape)?;
    for (part, (rings, raw)) in reader.polygons.iter().enumerate() {
        let mut polygon = Curves::of_part(part as u32);
        for ring in rings {
            polygon.polygon(&ring.iter().map(|p| project(*p)).collect::<Vec<_>>());
        }
        curves.append(polygon, &super::curves::IDENTITY);
        spans.push(span(source, raw.get()));
    }
    let mut notices = Vec::new();
    if reader.others > 0 {
        notices.push(SceneError::of(MapNotice::PointsAndLines { count: reader.others }));
    }
    notices.extend(reader.notices(&laid_out));
    Ok(Drawing { curves, y_down: false, source: Some(source), spans, painted: Vec::new(), rules: Vec::new(), notices })
}

/// The arcs of a topology, in degrees.
fn arcs(source: &Source<'_>, topology: &Topology<'_>) -> Result<Vec<Vec<Point>>, SceneError> {
    let mut all = Vec::with_capacity(topology.arcs.len());
    for raw in &topology.arcs {
        let mut points = positions(source, raw)?;
        if let Some(Quantisation { scale, translate }) = &topology.transform {
            // Quantised arcs contain differences.
            let mut at = [0.0; 2];
            for point in &mut points {
                at = [at[0] + point[0], at[1] + point[1]];
                *point = core::array::from_fn(|d| at[d] * scale[d] + translate[d]);
            }
        }
        all.push(points);
    }
    Ok(all)
}

/// A list of positions; heights are ignored.
fn positions(source: &Source<'_>, raw: Raw<'_>) -> Result<Vec<Point>, SceneError> {
    let rows: Vec<Vec<f64>> = parse(source, raw.get())?;
    rows.into_iter()
        .map(|row| match row.as_slice() {
            [x, y, ..] => Ok([*x, *y]),
            _ => Err(refuse(source, raw.get(), SceneError::of(MapError::Position { count: row.len() }))),
        })
        .collect()
}

/// The layer of a topology that the scene names, or its only one.
fn layer<'a>(
    source: &Source<'_>,
    raw: Raw<'a>,
    topology: &Topology<'a>,
    wanted: Option<&str>,
) -> Result<Raw<'a>, SceneError> {
    let names = || topology.objects.keys().map(String::as_str);
    let found = match wanted {
        Some(name) => topology.objects.get(name),
        None if topology.objects.len() == 1 => topology.objects.values().next(),
        None => None,
    };
    found.copied().ok_or_else(|| {
        let (count, known) = (topology.objects.len(), names().map(visible).collect::<Vec<_>>().join(", "));
        let error = match wanted {
            Some(name) => {
                SceneError::of(MapError::NoLayer { layer: visible(name), known }).nearest(nearest(name, names()))
            }
            None => SceneError::of(MapError::SeveralLayers { count, known, setting: Setting::named("layer") }),
        };
        refuse(source, &raw.get()[..1], error)
    })
}

impl<'a> Reader<'a, '_> {
    /// Reads an object and its contents; `taken` means that the scene selects all of it.
    fn object(&mut self, raw: Raw<'a>, taken: bool, depth: usize) -> Result<(), SceneError> {
        if depth > DEEPEST {
            let error = SceneError::of(MapError::Depth { deepest: DEEPEST });
            return Err(refuse(self.source, &raw.get()[..1], error));
        }
        if raw.get() == "null" {
            self.empty += usize::from(taken);
            return Ok(());
        }
        let object: Object<'a> = parse(self.source, raw.get())?;
        let (before, named) = (self.areas + self.polygons.len(), self.names.len());
        let meant = self.wanted.is_some() && self.is_wanted(&object);
        self.meant += usize::from(meant && !taken);
        let taken = taken || meant;
        match object.kind.as_str() {
            "FeatureCollection" => {
                for feature in object.features.unwrap_or_default() {
                    self.object(feature, taken, depth + 1)?;
                }
            }
            "GeometryCollection" => {
                for geometry in object.geometries.unwrap_or_default() {
                    self.object(geometry, taken, depth + 1)?;
                }
            }
            "Feature" => match object.geometry {
                Some(geometry) => self.object(geometry, taken, depth + 1)?,
                None => self.empty += usize::from(taken),
            },
            "Polygon" | "MultiPolygon" if !taken => self.areas += 1,
            "Polygon" => {
                let rings = self.rings(raw, &object)?;
                let polygon = self.polygon(raw, rings)?;
                self.polygons.push((polygon, raw));
            }
            "MultiPolygon" => {
                for rings in parse::<Vec<Raw<'a>>>(self.source, self.rings(raw, &object)?.get())? {
                    let polygon = self.polygon(raw, rings)?;
                    self.polygons.push((polygon, raw));
                }
            }
            "Point" | "MultiPoint" | "LineString" | "MultiLineString" => self.others += usize::from(taken),
            kind => {
                let error = SceneError::of(MapError::Kind { kind: visible(kind) });
                return Err(refuse(self.source, &raw.get()[..1], error));
            }
        }
        // A name cannot select something without an area.
        if self.areas + self.polygons.len() == before {
            self.names.truncate(named);
        }
        Ok(())
    }

    /// Whether the scene names this object, by its `id` or by any text among its properties.
    fn is_wanted(&mut self, object: &Object<'_>) -> bool {
        let Some(wanted) = self.wanted else { return true };
        let mut means = false;
        if let Some(id) = &object.id {
            means |= id.as_str().map_or_else(|| id.to_string(), String::from) == wanted;
        }
        for (key, value) in object.properties.iter().flatten() {
            if let Some(text) = value.as_str() {
                means |= text == wanted;
                if key.to_lowercase().contains("name") && self.names.len() < 100_000 {
                    self.names.push(text.to_string());
                }
            }
        }
        means
    }

    /// The coordinates of a geometry, or its arcs in a topology.
    fn rings(&self, raw: Raw<'a>, object: &Object<'a>) -> Result<Raw<'a>, SceneError> {
        let (field, name) =
            if self.arcs.is_some() { (object.arcs, "arcs") } else { (object.coordinates, "coordinates") };
        field.ok_or_else(|| {
            let kind = visible(&object.kind);
            refuse(self.source, raw.get(), SceneError::of(MapError::NoField { kind, field: name }))
        })
    }

    /// The rings of one polygon, without the repeated last point.
    fn polygon(&self, geometry: Raw<'_>, raw: Raw<'a>) -> Result<Vec<Vec<Point>>, SceneError> {
        let rings: Vec<Raw<'a>> = parse(self.source, raw.get())?;
        let mut out = Vec::with_capacity(rings.len());
        for ring in rings {
            let mut points = match &self.arcs {
                None => positions(self.source, ring)?,
                Some(arcs) => {
                    let mut points: Vec<Point> = Vec::new();
                    for index in parse::<Vec<i64>>(self.source, ring.get())? {
                        // ~k is arc k backwards.
                        let (arc_index, backwards) = if index < 0 { (!index, true) } else { (index, false) };
                        let Some(arc) = usize::try_from(arc_index).ok().and_then(|k| arcs.get(k)) else {
                            let n = arcs.len() as i64;
                            let error = SceneError::of(MapError::NoArc { arc: index, least: -n, most: n - 1 });
                            return Err(refuse(self.source, geometry.get(), error));
                        };
                        // The first point of an arc repeats the last point of the previous one.
                        points.pop();
                        if backwards {
                            points.extend(arc.iter().rev())
                        } else {
                            points.extend(arc)
                        }
                        let drawn = self.drawn.get() + arc.len() as u64;
                        self.drawn.set(drawn);
                        POINTS.check(drawn).map_err(|e| refuse(self.source, ring.get(), e))?;
                    }
                    points
                }
            };
            if points.first() != points.last() || points.len() < 4 {
                let error = SceneError::of(MapError::OpenRing { count: points.len() });
                return Err(refuse(self.source, ring.get(), error));
            }
            points.pop();
            out.push(points);
        }
        let lies_outside = |(outer, holes): (&Vec<Point>, &[Vec<Point>])| {
            let inside = (!holes.is_empty()).then(|| Inside::of(outer))?;
            holes.iter().position(|hole| !hole.iter().any(|p| inside.holds(*p)))
        };
        if let Some((outer, holes)) = out.split_first()
            && let Some(k) = lies_outside((outer, holes))
            && self.checks_holes(outer)
        {
            let position = holes[k].first().map_or(String::new(), |p| format!("{}, {}", p[0], p[1]));
            return Err(refuse(self.source, geometry.get(), SceneError::of(MapError::Hole { hole: k + 1, position })));
        }
        Ok(out)
    }

    /// Whether holes can be distinguished from islands. They cannot be distinguished yet if a ring crosses the antimeridian.
    fn checks_holes(&self, outer: &[Point]) -> bool {
        outer.windows(2).all(|pair| (pair[1][0] - pair[0][0]).abs() < 180.0)
    }

    /// Notices of changes that the map itself does not ask for.
    fn notices(&self, done: &globe::LaidOut) -> Vec<SceneError> {
        let mut notices = Vec::new();
        let mut report = |count: usize, notice: fn(usize) -> MapNotice| {
            if count > 0 {
                notices.push(SceneError::of(notice(count)));
            }
        };
        report(self.empty, |count| MapNotice::Empty { count });
        report(done.over, |count| MapNotice::Over { count });
        report(done.cut, |count| MapNotice::Cut { count });
        report(done.beside, |count| MapNotice::Beside { count });
        report(done.polar, |count| MapNotice::Polar { count });
        if let (2.., Some(name)) = (self.meant, self.wanted) {
            notices.push(SceneError::of(MapNotice::Features { count: self.meant, feature: visible(name) }));
        }
        notices
    }

    /// Why no polygon was found.
    fn nothing(&self, raw: Raw<'_>) -> SceneError {
        let error = match self.wanted {
            Some(name) if self.meant > 0 => {
                let feature = visible(name);
                SceneError::of(match (self.others, self.empty) {
                    (0, 0) => MapError::Nothing { feature },
                    (0, _) => MapError::NoGeometry { feature },
                    _ => MapError::PointsAndLines { feature },
                })
            }
            Some(name) => SceneError::of(MapError::NoFeature { feature: visible(name) })
                .nearest(nearest(name, self.names.iter().map(String::as_str))),
            None => SceneError::of(MapError::NoPolygon {}),
        };
        refuse(self.source, &raw.get()[..1], error)
    }
}

/// Projects degrees to the plane; the proportions are right at the centre of the polygons.
fn projection(
    source: &Source<'_>,
    polygons: &[(Polygon, Raw<'_>)],
    shape: &Values,
) -> Result<Box<dyn Fn(Point) -> Point>, SceneError> {
    let kind = shape.text("projection").unwrap_or("equirectangular");
    if kind == "none" {
        return Ok(Box::new(|p| p));
    }
    // In the Mercator projection the poles are at infinity.
    let most = if kind == "mercator" { 89.0 } else { 90.0 };
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    for (rings, raw) in polygons {
        for point in rings.iter().flatten() {
            if !(point[1].abs() <= most && point[0].abs() <= 540.0) {
                let error = SceneError::of(MapError::Range {
                    x: point[0],
                    y: point[1],
                    most,
                    projection: Setting::with("projection", "\"none\""),
                });
                return Err(refuse(source, raw.get(), error));
            }
            low = smaller(low, point[1]);
            high = larger(high, point[1]);
        }
    }
    let radians = |degrees: f64| degrees / 180.0 * core::f64::consts::PI;
    if kind == "mercator" {
        let quarter = core::f64::consts::FRAC_PI_4;
        return Ok(Box::new(move |[x, y]| [radians(x), libm::log(libm::tan(quarter + 0.5 * radians(y)))]));
    }
    let shrink = libm::cos(radians(0.5 * (low + high)));
    Ok(Box::new(move |[x, y]| [x * shrink, y]))
}
