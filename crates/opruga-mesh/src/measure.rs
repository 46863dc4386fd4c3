//! Length, area or volume of a body, in total and per node.

use crate::geometry::{
    Point, hexahedron_volume, lift, norm, quadrilateral_area, subtract, tetrahedron_volume, triangle_area,
};
use crate::quadratic::{self, TETRAHEDRON_SHARES, TRIANGLE_SHARES};
use crate::{Element, Mesh, MeshError};

/// The size of a body, in its own dimension.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Measure {
    /// Length of outlines in the plane and of wires [m].
    Length(f64),
    /// Area of surfaces, and of filled bodies in the plane [m²].
    Area(f64),
    /// Volume of filled bodies in space [m³].
    Volume(f64),
}

impl Measure {
    /// The measure as a number in m, m² or m³.
    pub fn value(self) -> f64 {
        match self {
            Measure::Length(value) | Measure::Area(value) | Measure::Volume(value) => value,
        }
    }
}

/// The distribution of a body's measure over its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Share {
    /// Every node has the same share.
    Equal,
    /// Each element gives equal parts of its own measure to its nodes: half of an edge, a third of a triangle, an eighth of a hexahedron. The shares
    /// of corners and mid-edge nodes of quadratic cells are [`TRIANGLE_SHARES`] and [`TETRAHEDRON_SHARES`].
    Proportional,
}

impl<const D: usize> Mesh<D> {
    /// Length, area or volume of the body: that of its cells if it is filled, otherwise that of its facets and sheets, otherwise that of its wires.
    ///
    /// In the plane, facets and wires have lengths, which are added. Facets that bound cells do not count. An empty mesh has length 0.
    ///
    /// # Errors
    /// The errors of [`Mesh::validate`]; [`MeshError::MixedMeasures`] if elements of different dimensions share the mesh.
    pub fn measure(&self) -> Result<Measure, MeshError> {
        let mut total = 0.0;
        let kind = self.visit_measures(|_, _, measure| total += measure)?;
        Ok(kind(total))
    }

    /// Each node's share of the measure [m, m² or m³], one value per node. Multiplied by the density, this share is the lumped mass. The shares add
    /// up to the total.
    ///
    /// # Errors
    /// The errors of [`Mesh::measure`].
    pub fn lumped_measures(&self, share: Share) -> Result<Vec<f64>, MeshError> {
        let mut shares = vec![0.0; self.nodes()];
        match share {
            Share::Equal => {
                let each = self.measure()?.value() / shares.len() as f64;
                shares.fill(each);
            }
            Share::Proportional => self.share_out(&mut shares, |_| 1.0)?,
        }
        Ok(shares)
    }

    /// The lumped mass of each node [kg], from the density of every cell [kg/m³, in the plane per area].
    ///
    /// # Errors
    /// The errors of [`Mesh::measure`]; [`MeshError::CellValues`] if the number of densities differs from the number of cells.
    pub fn lumped_masses(&self, densities: &[f64]) -> Result<Vec<f64>, MeshError> {
        let cells = self.cells.len();
        if densities.len() != cells {
            return Err(MeshError::CellValues { name: "density".into(), values: densities.len(), cells });
        }
        let mut masses = vec![0.0; self.nodes()];
        self.share_out(&mut masses, |cell| densities[cell])?;
        Ok(masses)
    }

    /// Adds to every node its share of the measure of the elements that have mass, each multiplied by a weight that depends on the number of the
    /// element.
    fn share_out(&self, shares: &mut [f64], weight: impl Fn(usize) -> f64) -> Result<(), MeshError> {
        let mut number = 0;
        self.visit_measures(|element, nodes, measure| {
            let measure = weight(number) * measure;
            number += 1;
            let mut give = |own: &[f64]| {
                nodes.iter().zip(own).for_each(|(&node, share)| shares[node as usize] += share * measure);
            };
            match element {
                Element::QuadraticTriangle => give(&TRIANGLE_SHARES),
                Element::QuadraticTetrahedron => give(&TETRAHEDRON_SHARES),
                _ => {
                    let part = measure / nodes.len() as f64;
                    nodes.iter().for_each(|&node| shares[node as usize] += part);
                }
            }
        })?;
        Ok(())
    }

    /// Calls `visit(kind, nodes, measure)` for each element that has mass; returns the kind of measure.
    fn visit_measures(&self, mut visit: impl FnMut(Element, &[u32], f64)) -> Result<fn(f64) -> Measure, MeshError> {
        self.validate()?;

        // The elements of the highest dimension have the mass. Elements of a lower dimension are a boundary, or are not
        // allowed.
        let rank = |element: Element| match element {
            Element::Facet if self.cells.is_empty() => Some(D - 1),
            Element::Facet | Element::SheetQuadrilateral | Element::Edge | Element::Group => None,
            Element::Wire => Some(1),
            Element::Sheet | Element::Triangle | Element::Quadrilateral | Element::QuadraticTriangle => Some(2),
            Element::Tetrahedron | Element::Hexahedron | Element::QuadraticTetrahedron => Some(3),
        };
        let mut known: Option<(Element, usize)> = None;
        for (element, _, nodes) in self.elements() {
            let Some(own) = rank(element) else { continue };
            match known {
                Some((first, other)) if other != own => {
                    return Err(MeshError::MixedMeasures { first, second: element });
                }
                Some(_) => {}
                None => known = Some((element, own)),
            }
            visit(element, nodes, self.size_of(nodes, element).abs());
        }
        Ok(match known {
            Some((_, 3)) => Measure::Volume,
            Some((_, 2)) => Measure::Area,
            _ => Measure::Length,
        })
    }

    /// Length, area or volume of one element; signed for filled cells, and negative if they are inverted.
    pub(crate) fn size_of(&self, nodes: &[u32], element: Element) -> f64 {
        let mut corners: [Point; 10] = [[0.0; 3]; 10];
        for (corner, &node) in corners.iter_mut().zip(nodes) {
            *corner = lift(&self.positions[node as usize]);
        }
        let [a, b, c, d, e, f, g, h, ..] = corners;
        match element {
            Element::QuadraticTetrahedron => quadratic::tetrahedron_volume_of(&corners),
            Element::QuadraticTriangle => quadratic::triangle_area(&[a, b, c, d, e, f]),
            Element::Hexahedron => hexahedron_volume(&[a, b, c, d, e, f, g, h]),
            Element::Tetrahedron => tetrahedron_volume(a, b, c, d),
            Element::Quadrilateral => quadrilateral_area(&[a, b, c, d]),
            Element::Triangle => crate::geometry::area_vector(a, b, c)[2],
            _ if nodes.len() == 3 => triangle_area(a, b, c),
            _ => norm(subtract(b, a)),
        }
    }
}
