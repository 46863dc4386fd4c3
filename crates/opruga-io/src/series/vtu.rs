//! VTK XML unstructured grids: one file per frame, and the list of all files (`.pvd`).
//!
//! # Source
//! Kitware, "VTK XML Formats"; arrays are base64 with a header of 8 bytes, little-endian.

use super::{Elements, Shape};
use crate::base64;
use std::collections::BTreeSet;
use std::io::{self, Write};

/// A text as the value of an attribute.
pub(crate) fn attribute(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c if c.is_control() => out.push('_'),
            c => out.push(c),
        }
    }
    out
}

/// Writes an array of numbers as base64.
pub(crate) fn array(out: &mut dyn Write, kind: &str, name: &str, components: usize, bytes: &[u8]) -> io::Result<()> {
    let mut whole = (bytes.len() as u64).to_le_bytes().to_vec();
    whole.extend_from_slice(bytes);
    writeln!(
        out,
        "<DataArray type=\"{kind}\" Name=\"{}\" NumberOfComponents=\"{components}\" format=\"binary\">{}</DataArray>",
        attribute(name),
        base64::encode(&whole)
    )
}

pub(crate) fn reals(out: &mut dyn Write, name: &str, components: usize, values: &[f64]) -> io::Result<()> {
    let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
    array(out, "Float64", name, components, &bytes)
}

pub(crate) fn wholes(out: &mut dyn Write, name: &str, values: &[i64]) -> io::Result<()> {
    let bytes: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
    array(out, "Int64", name, 1, &bytes)
}

/// Coordinates of all nodes.
fn vectors<'a>(all: impl Iterator<Item = &'a [f64; 3]>) -> Vec<f64> {
    all.flatten().copied().collect()
}

/// Writes the head and the points of a file, and the time [s] of a frame.
pub(crate) fn head(out: &mut dyn Write, time: Option<f64>, points: &[f64], cells: usize) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
    )?;
    writeln!(out, "<UnstructuredGrid>")?;
    if let Some(time) = time {
        let whole = [8u64.to_le_bytes(), time.to_le_bytes()].concat();
        let text = base64::encode(&whole);
        writeln!(out, "<FieldData>")?;
        writeln!(
            out,
            "<DataArray type=\"Float64\" Name=\"TimeValue\" NumberOfTuples=\"1\" format=\"binary\">{text}</DataArray>"
        )?;
        writeln!(out, "</FieldData>")?;
    }
    writeln!(out, "<Piece NumberOfPoints=\"{}\" NumberOfCells=\"{cells}\">", points.len() / 3)?;
    writeln!(out, "<Points>")?;
    reals(out, "Points", 3, points)?;
    writeln!(out, "</Points>")
}

/// Writes the nodes and the types of cells.
pub(crate) fn cells<'c>(out: &mut dyn Write, all: impl Iterator<Item = (u8, &'c [usize])>) -> io::Result<()> {
    let (mut nodes, mut offsets, mut types) = (Vec::new(), Vec::new(), Vec::new());
    for (kind, own) in all {
        nodes.extend(own.iter().map(|node| *node as i64));
        offsets.push(nodes.len() as i64);
        types.push(kind);
    }
    writeln!(out, "<Cells>")?;
    wholes(out, "connectivity", &nodes)?;
    wholes(out, "offsets", &offsets)?;
    array(out, "UInt8", "types", 1, &types)?;
    writeln!(out, "</Cells>")
}

pub(crate) fn foot(out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, "</Piece>\n</UnstructuredGrid>\n</VTKFile>")
}

/// Writes one frame: displacement [m] and velocity [m/s] of nodes; body, groups, values and fields of cells.
pub(super) fn write(out: &mut dyn Write, time: f64, shapes: &[Shape<'_>]) -> io::Result<()> {
    let elements = super::elements(shapes, true);
    let all = || elements.iter().enumerate().flat_map(|(body, e)| e.all.iter().map(move |e| (body, e)));
    let count = all().count();
    head(out, Some(time), &vectors(shapes.iter().flat_map(|s| s.positions)), count)?;
    cells(out, all().map(|(_, (kind, nodes))| (*kind, &nodes[..])))?;

    // Nodes.
    let mut displacements = Vec::new();
    for shape in shapes {
        let translation = shape.body.translation();
        for (x, rest) in shape.positions.iter().zip(shape.body.rest_positions()) {
            displacements.extend((0..3).map(|d| x[d] - (rest[d] + translation[d])));
        }
    }
    writeln!(out, "<PointData>")?;
    reals(out, "displacement [m]", 3, &displacements)?;
    reals(out, "velocity [m/s]", 3, &vectors(shapes.iter().flat_map(|s| s.velocities)))?;
    writeln!(out, "</PointData>\n<CellData>")?;

    // Cells: values that a body does not have are NaN.
    wholes(out, "body", &all().map(|(body, _)| body as i64).collect::<Vec<i64>>())?;
    let filled = |elements: &Elements, shape: &Shape<'_>| {
        let own = shape.body.cells().len();
        (own, elements.all.len() - own.min(elements.all.len()))
    };
    let mut write_field = |name: &str, components: usize, of: &dyn Fn(&Shape<'_>) -> Option<Vec<f64>>| {
        let mut values = Vec::with_capacity(count * components);
        for (own, shape) in elements.iter().zip(shapes) {
            let (cells, others) = filled(own, shape);
            match of(shape).filter(|found| found.len() == cells * components) {
                Some(found) => values.extend(found),
                None => values.extend(std::iter::repeat_n(f64::NAN, cells * components)),
            }
            values.extend(std::iter::repeat_n(f64::NAN, others * components));
        }
        reals(out, name, components, &values)
    };
    let names: BTreeSet<(&str, usize)> =
        shapes.iter().flat_map(|s| s.cell_fields).map(|field| (field.name, field.components)).collect();
    for (name, components) in names {
        write_field(name, components, &|shape| {
            let own = shape.cell_fields.iter().find(|field| field.name == name && field.components == components);
            own.map(|field| field.values.to_vec())
        })?;
    }
    let names: BTreeSet<&String> = shapes.iter().flat_map(|s| s.body.cell_values().keys()).collect();
    for name in names {
        write_field(name, 1, &|shape| shape.body.cell_values().get(name).cloned())?;
    }
    let names: BTreeSet<&String> = shapes.iter().flat_map(|s| s.body.cell_groups().keys()).collect();
    for name in names {
        write_field(&format!("group {name}"), 1, &|shape| {
            let mut member = vec![0.0; shape.body.cells().len()];
            shape.body.cell_groups().get(name)?.iter().for_each(|cell| member[*cell as usize] = 1.0);
            Some(member)
        })?;
    }
    writeln!(out, "</CellData>")?;
    foot(out)
}

/// Writes the list of a series of files with their times, in the format of ParaView (`.pvd`).
///
/// # Errors
/// The errors of the writer.
pub fn write_pvd(out: &mut dyn Write, files: &[(String, f64)]) -> io::Result<()> {
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(out, "<VTKFile type=\"Collection\" version=\"1.0\" byte_order=\"LittleEndian\">\n<Collection>")?;
    for (name, time) in files {
        writeln!(out, "<DataSet timestep=\"{time:e}\" part=\"0\" file=\"{}\"/>", attribute(name))?;
    }
    writeln!(out, "</Collection>\n</VTKFile>")
}
