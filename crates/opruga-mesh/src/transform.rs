//! Translation, rotation, scaling and mirroring of a body at rest.

use crate::geometry::{cross, dot, lift, norm};
use crate::mesh::finite;
use crate::{Cells, Element, Mesh, MeshError, Must, Quantity};

impl<const D: usize> Mesh<D> {
    /// Translates every node by the same vector [m].
    pub fn translate(&mut self, by: [f64; D]) {
        for position in &mut self.positions {
            for axis in 0..D {
                position[axis] += by[axis];
            }
        }
    }

    /// Maps every node by X′ = about + A (X − about), with the rows of A [−] in `rows`; returns whether orientations were reversed.
    ///
    /// If det A < 0 every oriented element is reversed, so that outlines stay counter-clockwise and cells keep a positive measure.
    ///
    /// # Errors
    /// [`MeshError::Size`] if A or `about` is not finite, or if det A = 0. The mesh is then unchanged.
    pub fn transform(&mut self, rows: &[[f64; D]; D], about: [f64; D]) -> Result<bool, MeshError> {
        rows.iter().try_for_each(|row| finite(Quantity::EntryMap, row))?;
        finite(Quantity::CentreMap, &about)?;
        let determinant = if D == 2 {
            rows[0][0] * rows[1][1] - rows[0][1] * rows[1][0]
        } else {
            dot(lift(&rows[0]), cross(lift(&rows[1]), lift(&rows[D - 1])))
        };
        if determinant == 0.0 || !determinant.is_finite() {
            return Err(MeshError::Size { what: Quantity::DeterminantMap, value: determinant, must: Must::NotZero });
        }
        for position in &mut self.positions {
            let offset: [f64; D] = std::array::from_fn(|axis| position[axis] - about[axis]);
            for axis in 0..D {
                let mut mapped = 0.0;
                for column in 0..D {
                    mapped += rows[axis][column] * offset[column];
                }
                position[axis] = about[axis] + mapped;
            }
        }
        if determinant < 0.0 {
            self.reverse();
        }
        Ok(determinant < 0.0)
    }

    /// Scales by one factor per axis [−] about a point [m]; returns whether orientations were reversed (an odd number of negative factors).
    ///
    /// # Errors
    /// [`MeshError::Size`] if a factor is zero or not finite.
    pub fn scale(&mut self, factors: [f64; D], about: [f64; D]) -> Result<bool, MeshError> {
        let rows =
            std::array::from_fn(|axis| std::array::from_fn(|column| if axis == column { factors[axis] } else { 0.0 }));
        self.transform(&rows, about)
    }

    /// Mirrors the body in a line (in 2D) or a plane (in 3D), given by a point [m] and a normal of any length. Always reverses orientations and
    /// returns true.
    ///
    /// # Errors
    /// [`MeshError::Size`] if the normal is zero or not finite.
    pub fn mirror(&mut self, normal: [f64; D], about: [f64; D]) -> Result<bool, MeshError> {
        let length = direction_length(Quantity::LengthNormal, lift(&normal))?;
        let unit = normal.map(|component| component / length);
        let rows = std::array::from_fn(|axis| {
            std::array::from_fn(|column| f64::from(u8::from(axis == column)) - 2.0 * unit[axis] * unit[column])
        });
        self.transform(&rows, about)
    }

    /// Reverses every oriented element: facets, sheets, cells, the skin.
    fn reverse(&mut self) {
        self.facets.iter_mut().for_each(|facet| facet.swap(0, 1));
        self.sheets.iter_mut().for_each(|triangle| triangle.swap(0, 1));
        self.sheet_quadrilaterals.iter_mut().for_each(|quadrilateral| quadrilateral.swap(1, 3));
        self.cells.turn_all();
        self.skin.iter_mut().flat_map(|skin| &mut skin.triangles).for_each(|triangle| triangle.swap(0, 1));
        self.skin.iter_mut().flat_map(|skin| &mut skin.outline).for_each(|edge| edge.swap(0, 1));
    }
}

impl Cells {
    /// Reverses a cell: swaps two corners, and the nodes between corners accordingly.
    pub(crate) fn turn(&mut self, element: Element, index: usize) {
        match element {
            Element::Triangle => self.triangles[index].swap(0, 1),
            Element::Quadrilateral => self.quadrilaterals[index].swap(1, 3),
            Element::Tetrahedron => self.tetrahedra[index].swap(0, 1),
            Element::Hexahedron => self.hexahedra[index].rotate_left(4),
            Element::QuadraticTriangle => {
                self.quadratic_triangles[index].swap(0, 1);
                self.quadratic_triangles[index].swap(4, 5);
            }
            Element::QuadraticTetrahedron => {
                self.quadratic_tetrahedra[index].swap(0, 1);
                self.quadratic_tetrahedra[index].swap(5, 6);
                self.quadratic_tetrahedra[index].swap(7, 8);
            }
            _ => {}
        }
    }

    fn turn_all(&mut self) {
        let all: Vec<(Element, u32)> = self.iter().map(|(element, index, _)| (element, index)).collect();
        all.into_iter().for_each(|(element, index)| self.turn(element, index as usize));
    }
}

impl Mesh<2> {
    /// Rotates counter-clockwise by an angle [rad] about a point [m].
    ///
    /// # Errors
    /// [`MeshError::Size`] if the angle or the point is not finite.
    pub fn rotate(&mut self, angle: f64, about: [f64; 2]) -> Result<(), MeshError> {
        finite(Quantity::RotationAngle, &[angle])?;
        let (s, c) = (libm::sin(angle), libm::cos(angle));
        self.transform(&[[c, -s], [s, c]], about).map(|_| ())
    }
}

impl Mesh<3> {
    /// Rotates by an angle [rad] about an axis of any length through a point [m], counter-clockwise as seen against the axis.
    ///
    /// # Errors
    /// [`MeshError::Size`] if a number is not finite or the axis is zero.
    ///
    /// # Source
    /// Rodrigues' formula: R = cos θ I + sin θ [u]× + (1 − cos θ) u ⊗ u.
    pub fn rotate(&mut self, axis: [f64; 3], angle: f64, about: [f64; 3]) -> Result<(), MeshError> {
        finite(Quantity::RotationAngle, &[angle])?;
        let length = direction_length(Quantity::LengthRotationAxis, axis)?;
        let [x, y, z] = axis.map(|component| component / length);
        let (s, c) = (libm::sin(angle), libm::cos(angle));
        let t = 1.0 - c;
        let rows = [
            [c + t * x * x, t * x * y - s * z, t * x * z + s * y],
            [t * y * x + s * z, c + t * y * y, t * y * z - s * x],
            [t * z * x - s * y, t * z * y + s * x, c + t * z * z],
        ];
        self.transform(&rows, about).map(|_| ())
    }
}

/// The length of a direction; refused if it is zero or not finite.
fn direction_length(what: Quantity, direction: [f64; 3]) -> Result<f64, MeshError> {
    let length = norm(direction);
    crate::mesh::positive(what, length)?;
    Ok(length)
}
