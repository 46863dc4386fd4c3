//! Closed chambers: the facets that enclose one volume.

use crate::boxes::Tree;
use crate::buckets::{nodes_of, sorted_by_node};
use crate::geometry::{cross, dot, lift, norm, signed_volume, subtract};
use crate::{Mesh, MeshError};

/// A connected piece of the boundary.
#[derive(Clone, Debug, PartialEq)]
pub struct Component {
    /// The facets of the component, ascending.
    pub facets: Vec<u32>,
    /// Enclosed area [m²] or volume [m³]: positive for an outer skin, negative for a hole.
    pub signed_volume: f64,
}

/// One facet's use of a ridge. Facets meet at ridges, which are nodes in the plane and edges in space. `forward` distinguishes the two directions.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Use {
    ridge: [u32; 2],
    facet: u32,
    forward: bool,
}

/// The structure of all facets: components, relative orientation, free boundaries.
pub(crate) struct Survey {
    /// Component of each facet; components are numbered by their lowest facet.
    component: Vec<u32>,
    /// The number of components.
    components: usize,
    /// Facets oriented against the majority of their component, ascending.
    minority: Vec<u32>,
    /// Lowest node of each free boundary, ascending.
    open: Vec<u32>,
}

/// The D ridges of each facet, sorted: end points of edges in the plane, sides of triangles in space.
fn ridges<const D: usize>(facets: &[[u32; D]]) -> Vec<Use> {
    let mut uses = Vec::with_capacity(D * facets.len());
    for (index, facet) in facets.iter().enumerate() {
        for corner in 0..D {
            let (a, b) = (facet[corner], facet[(corner + 1) % D]);
            let (ridge, forward) =
                if D == 2 { ([a, a], corner == 0) } else { (crate::geometry::ascending(a, b), a < b) };
            uses.push(Use { ridge, facet: index as u32, forward });
        }
    }
    sorted_by_node(&uses, nodes_of(facets), |entry| entry.ridge[0])
}

/// Marks a missing facet.
const NONE: u32 = u32::MAX;

impl Survey {
    /// Walks over the facets across their ridges.
    ///
    /// # Errors
    /// More than two facets at a ridge, or a surface with only one side.
    pub(crate) fn of<const D: usize>(facets: &[[u32; D]]) -> Result<Survey, MeshError> {
        let uses = ridges(facets);

        // At most two facets may meet at a ridge.
        let crowded: Vec<[u32; 2]> = uses
            .chunk_by(|p, q| p.ridge == q.ridge)
            .filter(|group| group.len() > 2)
            .map(|group| group[0].ridge)
            .collect();
        if !crowded.is_empty() {
            return Err(if D == 2 {
                MeshError::NonManifoldNodes { nodes: crowded.iter().map(|ridge| ridge[0]).collect() }
            } else {
                MeshError::NonManifoldEdges { edges: crowded }
            });
        }

        // Neighbours across ridges, and whether the two facets have the same orientation.
        let mut links = vec![[(NONE, false); D]; facets.len()];
        for pair in uses.chunk_by(|p, q| p.ridge == q.ridge).filter(|group| group.len() == 2) {
            let agree = pair[0].forward != pair[1].forward;
            for [facet, other] in [[pair[0].facet, pair[1].facet], [pair[1].facet, pair[0].facet]] {
                // There are as many slots as ridges.
                let own = &mut links[facet as usize];
                if let Some(free) = own.iter().position(|link| link.0 == NONE) {
                    own[free] = (other, agree);
                }
            }
        }
        links.iter_mut().for_each(|own| own.sort_unstable());

        // Flood-fill each component from its lowest facet; `against` is true for facets with the opposite orientation to that facet.
        let mut component = vec![NONE; facets.len()];
        let mut against = vec![false; facets.len()];
        let mut minority = Vec::new();
        let mut components = 0;
        let mut members = Vec::new();
        for seed in 0..facets.len() {
            if component[seed] != NONE {
                continue;
            }
            members.clear();
            members.push(seed as u32);
            component[seed] = components as u32;
            let mut next = 0;
            while next < members.len() {
                let facet = members[next];
                next += 1;
                for (other, agree) in links[facet as usize].into_iter().take_while(|link| link.0 != NONE) {
                    let expected = against[facet as usize] == agree;
                    if component[other as usize] == NONE {
                        component[other as usize] = components as u32;
                        against[other as usize] = expected;
                        members.push(other);
                    } else if against[other as usize] != expected {
                        return Err(MeshError::NonOrientable { facet: other });
                    }
                }
            }
            // The smaller part is reversed; in a tie the lowest facet is kept.
            let turned = members.iter().filter(|&&facet| against[facet as usize]).count();
            let wrong = 2 * turned <= members.len();
            minority.extend(members.iter().copied().filter(|&facet| against[facet as usize] == wrong));
            components += 1;
        }
        minority.sort_unstable();

        let free: Vec<Use> =
            uses.chunk_by(|p, q| p.ridge == q.ridge).filter(|group| group.len() == 1).map(|group| group[0]).collect();
        let open = if D == 2 { chain_ends(&free, &component) } else { loops(&free) };
        Ok(Survey { component, components, minority, open })
    }

    /// Facets oriented against the majority of their component, ascending.
    pub(crate) fn minority(&self) -> &[u32] {
        &self.minority
    }

    /// Refuses free boundaries.
    pub(crate) fn closed(&self) -> Result<(), MeshError> {
        if self.open.is_empty() {
            Ok(())
        } else {
            Err(MeshError::Open { loops: self.open.len(), nodes: self.open.clone() })
        }
    }

    /// Refuses free boundaries, and facets oriented against their neighbours.
    pub(crate) fn closed_and_consistent(&self) -> Result<(), MeshError> {
        self.closed()?;
        if !self.minority.is_empty() {
            return Err(MeshError::InconsistentOrientation { count: self.minority.len(), first: self.minority[0] });
        }
        Ok(())
    }
}

/// Lowest free end of each open chain.
fn chain_ends(free: &[Use], component: &[u32]) -> Vec<u32> {
    let mut ends: Vec<(u32, u32)> = free.iter().map(|end| (component[end.facet as usize], end.ridge[0])).collect();
    ends.sort_unstable();
    ends.dedup_by_key(|end| end.0);
    let mut nodes: Vec<u32> = ends.into_iter().map(|end| end.1).collect();
    nodes.sort_unstable();
    nodes
}

/// Lowest node of each loop of free edges.
fn loops(free: &[Use]) -> Vec<u32> {
    let mut nodes: Vec<u32> = free.iter().flat_map(|edge| edge.ridge).collect();
    nodes.sort_unstable();
    nodes.dedup();
    let index_of = |node: u32| nodes.partition_point(|&other| other < node);

    // Union by lowest node, with path halving.
    let mut parent: Vec<usize> = (0..nodes.len()).collect();
    let root = |parent: &mut Vec<usize>, mut at: usize| {
        while parent[at] != at {
            parent[at] = parent[parent[at]];
            at = parent[at];
        }
        at
    };
    for edge in free {
        let (p, q) = (root(&mut parent, index_of(edge.ridge[0])), root(&mut parent, index_of(edge.ridge[1])));
        if p < q {
            parent[q] = p;
        } else {
            parent[p] = q;
        }
    }
    (0..nodes.len()).filter(|&at| parent[at] == at).map(|at| nodes[at]).collect()
}

impl<const D: usize> Mesh<D> {
    /// Connected components of the closed boundary, each with its signed area [m²] or volume [m³]; holes are negative.
    ///
    /// Facets are connected if they share a node (plane) or an edge (space). Components are ordered by their lowest facet.
    ///
    /// # Errors
    /// The errors of [`Mesh::validate`]; [`MeshError::NonManifoldNodes`] (plane) or [`MeshError::NonManifoldEdges`] (space) if more than two facets
    /// meet; [`MeshError::NonOrientable`] for a surface with only one side; [`MeshError::Open`] with the number of free boundaries and a node on
    /// each; [`MeshError::InconsistentOrientation`] if neighbours have opposite orientations.
    pub fn components(&self) -> Result<Vec<Component>, MeshError> {
        self.validate()?;
        let survey = Survey::of(&self.facets)?;
        survey.closed_and_consistent()?;
        Ok(self.components_of(&survey))
    }

    /// The components of a survey, with their volumes.
    pub(crate) fn components_of(&self, survey: &Survey) -> Vec<Component> {
        let mut components = vec![Component { facets: Vec::new(), signed_volume: 0.0 }; survey.components];
        for (facet, &component) in survey.component.iter().enumerate() {
            components[component as usize].facets.push(facet as u32);
        }
        for component in &mut components {
            component.signed_volume = signed_volume(&self.gather(&component.facets), &self.positions);
        }
        components
    }

    /// The closed chambers, each as the ascending indices of the facets that enclose it.
    ///
    /// A chamber consists of one component of positive volume and the holes in it, which are components of negative volume. A hole belongs to the
    /// smallest positive component whose winding number about a node of the hole is 1. An outward component inside another is a chamber of its own.
    ///
    /// # Errors
    /// The errors of [`Mesh::components`], and [`MeshError::InsideOut`] for a hole without an enclosing component.
    pub fn chambers(&self) -> Result<Vec<Vec<u32>>, MeshError> {
        let components = self.components()?;
        let (outer, holes): (Vec<&Component>, Vec<&Component>) =
            components.iter().partition(|component| component.signed_volume >= 0.0);
        let skins: Vec<Vec<[u32; D]>> = outer.iter().map(|component| self.gather(&component.facets)).collect();
        let mut chambers: Vec<Vec<u32>> = outer.iter().map(|component| component.facets.clone()).collect();

        // Each hole belongs to the smallest skin that encloses it; only skins whose box contains it are candidates.
        let tree = (!holes.is_empty()).then(|| Tree::of(skins.iter().map(|skin| self.box_of(skin))));
        for hole in holes {
            let point = self.positions[self.facets[hole.facets[0] as usize][0] as usize];
            let mut home: Option<usize> = None;
            let candidates = tree.as_ref().map_or(Vec::new(), |tree| tree.around(&lift(&point)));
            for candidate in candidates.into_iter().map(|number| number as usize) {
                let tighter = home.is_none_or(|best| outer[candidate].signed_volume < outer[best].signed_volume);
                if tighter && winding_number(&skins[candidate], &self.positions, &point) > 0.5 {
                    home = Some(candidate);
                }
            }
            match home {
                Some(home) => chambers[home].extend(&hole.facets),
                None => {
                    return Err(MeshError::InsideOut { facet: hole.facets[0], signed_volume: hole.signed_volume });
                }
            }
        }
        chambers.iter_mut().for_each(|chamber| chamber.sort_unstable());
        Ok(chambers)
    }

    /// Orients facets so that neighbours agree and the total signed volume is positive; returns the number of reversed facets.
    ///
    /// In each component, facets follow the orientation of the majority. Holes remain holes. If the total is negative, every
    /// facet is reversed.
    ///
    /// # Errors
    /// The errors of [`Mesh::validate`]; [`MeshError::NonManifoldNodes`], [`MeshError::NonManifoldEdges`], [`MeshError::NonOrientable`],
    /// [`MeshError::Open`]. The mesh is then unchanged.
    pub fn orient_outward(&mut self) -> Result<usize, MeshError> {
        self.validate()?;
        let survey = Survey::of(&self.facets)?;
        if !survey.open.is_empty() {
            return Err(MeshError::Open { loops: survey.open.len(), nodes: survey.open });
        }
        let before = self.facets.clone();
        for &facet in &survey.minority {
            self.facets[facet as usize].swap(0, 1);
        }
        if signed_volume(&self.facets, &self.positions) < 0.0 {
            self.facets.iter_mut().for_each(|facet| facet.swap(0, 1));
        }
        // A facet that was reversed twice does not count.
        let mut reversed = 0;
        for (facet, old) in self.facets.iter().zip(&before) {
            reversed += usize::from(facet != old);
        }
        Ok(reversed)
    }

    /// The lowest corner of the box around facets, followed by its highest corner, twice.
    pub(crate) fn box_of(&self, facets: &[[u32; D]]) -> [[f64; 3]; 3] {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for node in facets.iter().flatten() {
            let point = lift(&self.positions[*node as usize]);
            for d in 0..3 {
                low[d] = if point[d] < low[d] { point[d] } else { low[d] };
                high[d] = if point[d] > high[d] { point[d] } else { high[d] };
            }
        }
        [low, high, high]
    }

    /// The facets with the given indices.
    pub(crate) fn gather(&self, facets: &[u32]) -> Vec<[u32; D]> {
        facets.iter().map(|&facet| self.facets[facet as usize]).collect()
    }
}

/// The winding number of closed facets about a point: 1 inside an outward skin, 0 outside.
///
/// Plane: signed crossings of the ray to the right. Space: solid angles over 4π.
///
/// # Source
/// van Oosterom and Strackee, "The solid angle of a plane triangle", IEEE Trans. Biomed. Eng. 30 (1983), equation 8.
pub fn winding_number<const D: usize>(facets: &[[u32; D]], positions: &[[f64; D]], point: &[f64; D]) -> f64 {
    let o = lift(point);
    let from = |node: u32| subtract(lift(&positions[node as usize]), o);
    let mut total = 0.0;
    if D == 2 {
        for facet in facets {
            let (a, b) = (from(facet[0]), from(facet[1]));
            let left = a[0] * b[1] - a[1] * b[0];
            if a[1] <= 0.0 && b[1] > 0.0 && left > 0.0 {
                total += 1.0;
            } else if a[1] > 0.0 && b[1] <= 0.0 && left < 0.0 {
                total -= 1.0;
            }
        }
        return total;
    }
    for facet in facets {
        let (a, b, c) = (from(facet[0]), from(facet[1]), from(facet[D - 1]));
        let (la, lb, lc) = (norm(a), norm(b), norm(c));
        let numerator = dot(a, cross(b, c));
        let denominator = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        total += 2.0 * libm::atan2(numerator, denominator);
    }
    total / (4.0 * std::f64::consts::PI)
}
