//! `opruga material`: the results of a law of the finite elements at one deformation gradient.

use crate::arguments::Material;
use crate::errors::CallError;
use crate::failure::{Failure, print_data};
use opruga::core::spec::{Value, Values, nearest};
use opruga::io::problem::{SceneError, visible};
use opruga::math::words::rounded;
use opruga::world::law::{self, AtPoint};
use serde_json::json;
use std::fmt::Write as _;

const SPEC: &opruga::core::spec::Spec = &law::SPEC;

/// Prints energy density, stress and tangent.
pub(crate) fn material(call: &Material) -> Result<u8, Failure> {
    let gradient = gradient(&call.gradient)?;
    let dimension = if gradient.len() == 4 { 2 } else { 3 };
    let values = values(call, dimension)?;
    let plane = values.text("plane").unwrap_or("strain");
    let setting = if dimension == 3 { "space".to_string() } else { format!("plane {plane}") };
    let name = &call.name;
    let text = match dimension {
        2 => shown(name, &setting, &values, &rows(&gradient), law::in_plane(&values, &rows(&gradient)), call.json)?,
        _ => shown(name, &setting, &values, &rows(&gradient), law::in_space(&values, &rows(&gradient)), call.json)?,
    };
    print_data(&text)?;
    Ok(0)
}

fn refuse(error: SceneError) -> Failure {
    Failure::Scene(vec![error])
}

/// The numbers of F, row by row, in the plane or in space.
fn gradient(text: &str) -> Result<Vec<f64>, Failure> {
    let split = |c: char| c == ',' || c == ';' || c.is_whitespace();
    let bare = text.replace(['[', ']'], " ");
    let words: Vec<&str> = bare.split(split).filter(|word| !word.is_empty()).collect();
    let wrong = |about: CallError| refuse(SceneError::of(about).path("--F"));
    let mut numbers = Vec::with_capacity(words.len());
    for word in &words {
        match word.parse::<f64>() {
            Ok(x) if x.is_finite() => numbers.push(x),
            _ => return Err(wrong(CallError::GradientNumber { word: visible(word) })),
        }
    }
    match numbers.len() {
        4 | 9 => Ok(numbers),
        count => Err(wrong(CallError::GradientCount { count, text: visible(text) })),
    }
}

fn rows<const D: usize>(numbers: &[f64]) -> [[f64; D]; D] {
    core::array::from_fn(|i| core::array::from_fn(|j| numbers[i * D + j]))
}

/// The fields of the law, checked like the fields of a scene.
fn values(call: &Material, dimension: usize) -> Result<Values, Failure> {
    let mut values = Values::defaults(SPEC, dimension);
    if !law::NAMES.contains(&call.name.as_str()) {
        let (name, known) = (visible(&call.name), law::NAMES.join(", "));
        let error = SceneError::of(CallError::NoMaterialToAsk { name, known }).path("NAME");
        return Err(refuse(error.nearest(nearest(&call.name, law::NAMES.iter().copied()))));
    }
    if dimension == 3 && call.plane.is_some() {
        return Err(refuse(SceneError::of(CallError::PlaneInSpace {}).path("--plane")));
    }
    let plane = call.plane.clone().unwrap_or_else(|| "strain".into());
    let mut given: Vec<(&str, &str, Value)> = vec![
        ("NAME", "material", Value::Text(call.name.clone())),
        ("--E", "youngs_modulus", Value::Number(call.youngs_modulus)),
        ("--nu", "poissons_ratio", Value::Number(call.poissons_ratio)),
        ("--plane", "plane", Value::Text(plane)),
    ];
    for text in &call.set {
        let (field, value) = text.split_once('=').unwrap_or((text, ""));
        let own: Vec<&str> = law::own_fields(&call.name).collect();
        let Some(field) = own.iter().find(|own| **own == field.trim()) else {
            let (law, text, known) = (call.name.clone(), visible(text), own.join(", "));
            let closest = nearest(field, own.iter().copied());
            let field = visible(field);
            let error = SceneError::of(match own.is_empty() {
                true => CallError::NoFields { field, law, text },
                false => CallError::NoFieldOfLaw { field, law, text, known },
            });
            return Err(refuse(error.path("--set").nearest(closest)));
        };
        let number = value.trim().parse::<f64>().map_or_else(|_| Value::Text(value.trim().into()), Value::Number);
        given.push(("--set", field, number));
    }
    for (option, field, value) in given {
        values.set(SPEC, field, value, dimension).map_err(|error| refuse(SceneError::of(error).path(option)))?;
    }
    Ok(values)
}

/// The results as text or as JSON.
fn shown<const D: usize>(
    name: &str,
    setting: &str,
    values: &Values,
    f: &[[f64; D]; D],
    point: Result<AtPoint<D>, opruga::core::error::BuildError>,
    as_json: bool,
) -> Result<String, Failure> {
    let point = point.map_err(|error| refuse(SceneError::of(error.about).path("--F")))?;
    let number = |field: &str| values.number(field).unwrap_or(0.0);
    let ratio = opruga::math::matrix::determinant::<f64, D>(f) * point.across.unwrap_or(1.0);
    let own: Vec<(&str, f64)> = law::own_fields(name).map(|field| (field, number(field))).collect();
    if as_json {
        let mut parameters = serde_json::Map::new();
        for (field, x) in [("youngs_modulus", number("youngs_modulus")), ("poissons_ratio", number("poissons_ratio"))] {
            parameters.insert(field.into(), json!(x));
        }
        parameters.extend(own.iter().map(|(field, x)| ((*field).to_string(), json!(x))));
        let object = json!({
            "schema": 1, "material": name, "setting": setting, "dimension": D, "parameters": parameters,
            "mu": point.lame[0], "lambda": point.lame[1],
            "deformation_gradient": f.map(|row| row.to_vec()).to_vec(),
            "volume_ratio": ratio, "stretch_across": point.across, "energy_density": point.energy,
            "stress": point.stress.map(|row| row.to_vec()).to_vec(), "tangent": point.tangent,
        });
        return Ok(format!("{}\n", serde_json::to_string_pretty(&object).unwrap_or_default()));
    }
    let digits = |x: f64| rounded(x, 10);
    let mut text = format!(
        "`{name}`, {setting}: E = {} Pa, ν = {}, μ = {} Pa, λ = {} Pa",
        digits(number("youngs_modulus")),
        digits(number("poissons_ratio")),
        digits(point.lame[0]),
        digits(point.lame[1])
    );
    for (field, x) in own {
        let _ = write!(text, ", {field} = {}", digits(x));
    }
    let _ = writeln!(text, "\nJ = {}", digits(ratio));
    if let Some(across) = point.across.filter(|_| setting == "plane stress") {
        let _ = writeln!(text, "stretch across the plane = {}", digits(across));
    }
    let _ = writeln!(text, "ψ = {} J/m³", digits(point.energy));
    let axes = &["x", "y", "z"][..D];
    let _ = writeln!(text, "P = ∂ψ/∂F [Pa]");
    text.push_str(&table(axes, axes, &point.stress.map(|row| row.to_vec())));
    let pairs: Vec<String> = axes.iter().flat_map(|i| axes.iter().map(move |j| format!("{i}{j}"))).collect();
    let pairs: Vec<&str> = pairs.iter().map(String::as_str).collect();
    let _ = writeln!(text, "∂P/∂F [Pa]: a row for every entry of P, a column for every entry of F");
    text.push_str(&table(&pairs, &pairs, &point.tangent));
    Ok(text)
}

/// A right-aligned table of numbers with headers.
fn table(rows: &[&str], columns: &[&str], numbers: &[Vec<f64>]) -> String {
    let cells: Vec<Vec<String>> = numbers.iter().map(|row| row.iter().map(|x| rounded(*x, 8)).collect()).collect();
    let width = cells.iter().flatten().map(|cell| cell.chars().count()).max().unwrap_or(0) + 2;
    let mut text = format!("{:4}", "");
    columns.iter().for_each(|column| text.push_str(&format!("{column:>width$}")));
    text.push('\n');
    for (head, row) in rows.iter().zip(&cells) {
        text.push_str(&format!("{head:>4}"));
        row.iter().for_each(|cell| text.push_str(&format!("{cell:>width$}")));
        text.push('\n');
    }
    text
}
