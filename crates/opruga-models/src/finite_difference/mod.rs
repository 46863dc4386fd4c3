//! # Finite differences
//!
//! Elastic curves, surfaces and solids, whose energy depends on the changes of the metric tensor G and the curvature tensor B
//! from rest, on a regular grid of material coordinates (Terzopoulos, Platt, Barr and Fleischer 1987, equations 5 to 8 and 14).
//! With ε = ½ (G − G₀) and β = B − B₀,
//!
//! U = ∫ ½ EA ε² + ½ EI β² for curves,
//! U = ∫ ½ Et/(1 − ν²) [(1 − ν) ε:ε + ν (tr ε)²] + ½ Et³/12(1 − ν²) [(1 − ν) β:β + ν (tr β)²] for surfaces,
//! U = ∫ ½ λ (tr ε)² + μ ε:ε for solids (St. Venant and Kirchhoff).
//!
//! Differences are staggered: strains along an axis are defined on edges, shear strains at the centres of cells (of faces in
//! space), curvatures at nodes and twists at the centres of cells. So the error falls with the square of the spacing, and no
//! checkerboard mode has zero energy. The paper defines all differences at nodes, so that a checkerboard mode has no energy.
//!
//! Forces are the exact gradient of the discrete energy. The paper's force (its equation 9) neglects that the normal n in B =
//! n·x″ rotates with the surface. The file docs/finite-differences.md reports the measured consequences.
//!
//! A curve in space may also resist a change of its Frenet torsion τ, U = ∫ ½ GJ (τ − τ₀)². On an edge of length L between two
//! nodes with a curvature, τ is the angle between the osculating planes of these nodes, divided by L.
//!
//! Limits: the Frenet torsion describes the centre line and not the twist of the section. Where a curve is straight, its Frenet
//! torsion has no value and causes no force. Near that state, the force grows with the inverse of the curvature. A curve with a
//! curvature at rest has no force where it is exactly straight, because its curvature has no direction there. The St.
//! Venant–Kirchhoff law softens below 1/√3 of the length. A degenerate tangent plane has no normal and no moment.

mod along;
mod curve;
mod folds;
mod grid;
mod plate;
mod solid;
mod spec;
mod states;

pub use spec::SPEC;

use crate::bending::hinge::{self, Hinge};
use crate::vectors::{cross, dot, in_space, minus};
use along::Along;
use curve::{Bend, Stretch};
use folds::Folds;
use grid::{Grid, HEXAHEDRON, QUADRILATERAL, spacings};
use opruga_core::error::BuildError;
use opruga_core::memory::{Counts, Need};
use opruga_core::potential::{
    CellState, Count, Definiteness, Ingredients, Model, Observe, Potential, Properties, Sink, Views,
};
use opruga_core::spec::{Spec, Values};
use opruga_core::state::{Layout, Parameter, View};
use opruga_core::stencil::Stencils;
use opruga_core::tile::Tile;
use opruga_math::words::number;
use opruga_math::{Simd, WIDTH};
use opruga_mesh::Mesh;
use plate::{Edge, Inner, Twist};
use solid::{Hexahedron, Quadrilateral};
use states::Cells;

/// The name of the model in scenes.
const KIND: &str = "finite_difference";

opruga_math::messages! {
    /// Why a body cannot be computed by finite differences.
    #[derive(Clone, Debug, PartialEq)]
    pub enum FiniteDifferenceError {
        /// The body has no regular grid.
        "model.not_a_grid"
        #[error("the body is not a regular grid")]
        #[allowed("line, ring, polyline, sheet, and a grid of quadrilaterals or hexahedra")]
        NotAGrid {},
        /// A cell that is not a rectangle or box. The deviation is a fraction of the smallest spacing of the cell.
        "model.not_rectangular"
        #[error("cell {cell} deviates from a rectangle by {} of its spacing", number(*deviation))]
        #[allowed("at most 1e-6")]
        NotRectangular { cell: usize, deviation: f64 },
        /// The cells of a surface differ in their spacing.
        "model.uneven_grid"
        #[error("cell {cell} has a spacing of {} m, but cell 0 has {} m", number(*spacing), number(*first))]
        #[allowed("equal spacings")]
        Uneven { cell: usize, spacing: f64, first: f64 },
        /// A curve or a surface needs a thickness.
        "model.no_thickness"
        #[error("a curve or a surface needs `thickness`")] #[parameters("thickness")]
        #[allowed("> 0 m")]
        NoThickness {},
        /// A `thickness` for a solid, which has none of its own.
        "model.solid_thickness"
        #[error("`thickness` belongs to curves and surfaces; a solid has none")] #[parameters("thickness")]
        SolidThickness {},
        /// Torsion of a surface or solid.
        "model.torsion_of_surface"
        #[error("`torsion` belongs to curves (`line`, `ring`, `polyline`); surfaces and solids resist shear without it")] #[parameters("torsion")]
        TorsionOfSurface {},
        /// Torsion of a curve without curvature.
        "model.no_torsion"
        #[error("the curve is straight at node {node}, where its torsion is undefined")]
        #[hint("leave `torsion` out, or bend the rest shape")]
        NoFrame { node: u32 },
        /// An edge has no length at rest.
        "model.zero_length"
        #[error("edge {edge} has no length at rest")]
        #[allowed("> 0 m")]
        NoLength { edge: usize },
    }
}

opruga_math::messages! {
    /// Warnings about curves and surfaces.
    #[derive(Clone, Debug, PartialEq)]
    pub enum FiniteDifferenceWarning {
        /// Edges are crushed or folded.
        "finite_difference.folded"
        #[error("edges of a curve or a surface are folded back on their neighbours, or are shorter than 0.58 of their length at rest, so that their law softens; they may not recover (counted in the last state)")]
        #[hint("use lower loads, or shorter steps before the body folds; springs (`mass_spring`) resist any compression")]
        Folded {},
    }
}

use FiniteDifferenceError as Refusal;

impl From<FiniteDifferenceError> for BuildError {
    fn from(refusal: FiniteDifferenceError) -> BuildError {
        BuildError::of(KIND, refusal)
    }
}

/// The kind of model that scenes call `finite_difference`.
#[derive(Debug)]
pub struct FiniteDifferenceModel;

/// The stencils of one body, or of eight identical ones, kind by kind.
#[derive(Debug)]
struct FiniteDifference<const D: usize> {
    parts: Vec<Box<dyn Potential<D>>>,
    /// The forces of the first two parts of a curve, if its nodes follow each other.
    along: Option<Along>,
    damped: bool,
    /// The cells of a solid, and the elastic parameters of each body.
    solid: Option<(Cells<D>, Vec<Elastic>)>,
    /// The edges of a curve or a surface.
    folds: Option<Folds>,
}

/// The elastic parameters of one body.
#[derive(Clone, Copy, Debug)]
struct Elastic {
    youngs_modulus: f64,
    poissons_ratio: f64,
    thickness: f64,
    damping: f64,
    plane_stress: bool,
    torsion: bool,
}

impl Elastic {
    fn of(values: &Values) -> Elastic {
        Elastic {
            youngs_modulus: values.number("youngs_modulus").unwrap_or(0.0),
            poissons_ratio: values.number("poissons_ratio").unwrap_or(0.3),
            thickness: values.number("thickness").unwrap_or(0.0),
            damping: values.number("damping").unwrap_or(0.0),
            plane_stress: values.text("plane") == Some("stress"),
            torsion: values.flag("torsion"),
        }
    }
    /// c₁, c₂, c₃ of a surface [N/m]: Et/(1 − ν²) times 1, ν, 2 (1 − ν).
    fn membrane(&self) -> [f64; 3] {
        let nu = self.poissons_ratio;
        let whole = self.youngs_modulus * self.thickness / (1.0 - nu * nu);
        [whole, nu * whole, 2.0 * (1.0 - nu) * whole]
    }
    /// c₁, c₂, c₃ of a solid [Pa]: λ + 2μ, λ, 4μ.
    fn solid(&self) -> [f64; 3] {
        let nu = self.poissons_ratio;
        let mu = self.youngs_modulus / (2.0 * (1.0 + nu));
        let whole = self.youngs_modulus * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
        let lambda = if self.plane_stress { 2.0 * whole * mu / (whole + 2.0 * mu) } else { whole };
        [lambda + 2.0 * mu, lambda, 4.0 * mu]
    }
    /// The flexural rigidity of a surface D = Et³/12(1 − ν²) [N·m].
    fn rigidity(&self) -> f64 {
        let t = self.thickness;
        self.membrane()[0] * t * t / 12.0
    }
    /// GJ of a round wire [N·m²]: E/2(1 + ν) times π t⁴/32.
    fn torsional_rigidity(&self) -> f64 {
        self.section(None)[1] / (1.0 + self.poissons_ratio)
    }
    /// EA [N] and EI [N·m²] of a curve with this depth out of the plane [m], or with a round section in space.
    fn section(&self, depth: Option<f64>) -> [f64; 2] {
        let t = self.thickness;
        let round = core::f64::consts::PI * t * t / 4.0;
        let [area, inertia] = depth.map_or([round, round * t * t / 16.0], |b| [t * b, t * t * t * b / 12.0]);
        [self.youngs_modulus * area, self.youngs_modulus * inertia]
    }
}

impl<const D: usize> Model<D> for FiniteDifferenceModel {
    fn spec(&self) -> &'static Spec {
        &SPEC
    }
    fn batches(&self) -> bool {
        true
    }
    fn need(&self, counts: &Counts) -> Need {
        // Eight numbers per stencil, and the location of their forces. A curve has no cell pairs; its torsion couples nodes that
        // are three edges apart.
        let couplings = 2.0 * counts.edges + 2.0 * counts.hinges + counts.cell_pairs;
        Need { bytes: 160.0 * counts.edges, couplings }
    }
    fn build(&self, ingredients: &Ingredients<D>) -> Result<Box<dyn Potential<D>>, BuildError> {
        Ok(Box::new(FiniteDifference::new(ingredients)?))
    }
}

impl<const D: usize> FiniteDifference<D> {
    fn new(ingredients: &Ingredients<D>) -> Result<FiniteDifference<D>, BuildError> {
        let grid = Grid::of(ingredients.mesh)?;
        let solid = matches!(grid, Grid::Plane { .. } | Grid::Space { .. });
        for values in ingredients.values {
            if values.flag("torsion") && !matches!(grid, Grid::Curve { .. }) {
                return Err(Refusal::TorsionOfSurface {}.into());
            }
            match (solid, values.number("thickness")) {
                (true, Some(_)) => return Err(Refusal::SolidThickness {}.into()),
                (false, None) => return Err(Refusal::NoThickness {}.into()),
                _ => {}
            }
        }
        let elastic: Vec<Elastic> = ingredients.values.iter().map(|values| Elastic::of(values)).collect();
        let damped = elastic.iter().any(|body| body.damping > 0.0);
        let plan = Plan { ingredients, elastic, damped };
        let along = match &grid {
            Grid::Curve { edges, .. } => plan.along(edges),
            _ => None,
        };
        let edges: Option<Vec<[u32; 2]>> = match &grid {
            Grid::Curve { edges, .. } => Some(edges.clone()),
            Grid::Surface { cells, .. } => {
                Some(cells.iter().flat_map(|cell| [0, 1, 2, 3].map(|k| [cell[k], cell[(k + 1) % 4]])).collect())
            }
            Grid::Plane { .. } | Grid::Space { .. } => None,
        };
        let folds = edges.map(|edges| Folds::new(&ingredients.mesh.positions, edges));
        let (parts, cells) = match grid {
            Grid::Curve { edges, nodes } => (plan.curve(&edges, &nodes)?, None),
            Grid::Surface { cells, inner, edge } => (plan.surface(&cells, &inner, &edge)?, None),
            Grid::Plane { cells } => plan.plane(&cells)?,
            Grid::Space { cells } => plan.space(&cells)?,
        };
        let solid = cells.map(|cells| (cells, plan.elastic));
        Ok(FiniteDifference { parts, along, damped, solid, folds })
    }
}

type Parts<const D: usize> = Vec<Box<dyn Potential<D>>>;
/// The parts of a solid and its cells.
type Solid<const D: usize> = (Parts<D>, Option<Cells<D>>);

/// The data from which all parts of a body are built.
struct Plan<'a, const D: usize> {
    ingredients: &'a Ingredients<'a, D>,
    elastic: Vec<Elastic>,
    damped: bool,
}

impl<const D: usize> Plan<'_, D> {
    fn layout(&self) -> (Layout, usize) {
        (self.ingredients.layout, self.ingredients.mesh.positions.len())
    }
    fn mesh(&self) -> &Mesh<D> {
        self.ingredients.mesh
    }
    fn of(&self, body: usize) -> &Elastic {
        &self.elastic[body.min(self.elastic.len() - 1)]
    }
    fn at(&self, node: u32) -> [f64; 3] {
        in_space(&self.mesh().positions[node as usize])
    }
    fn length(&self, a: u32, b: u32) -> f64 {
        let d = minus(&self.at(b), &self.at(a));
        dot(&d, &d).sqrt()
    }

    fn curve(&self, edges: &[[u32; 2]], nodes: &[[u32; 3]]) -> Result<Parts<D>, Refusal> {
        let lengths: Vec<f64> = edges.iter().map(|&[a, b]| self.length(a, b)).collect();
        if let Some(edge) = lengths.iter().position(|length| *length <= 0.0) {
            return Err(Refusal::NoLength { edge });
        }
        let depth = (D == 2).then_some(self.ingredients.thickness);
        let (layout, count) = self.layout();
        let stretch = Stencils::<Stretch, 2, 3>::new(layout, count, edges, self.damped, |edge, body| {
            let (own, length) = (self.of(body), lengths[edge]);
            [own.section(depth)[0] * length, 1.0 / (length * length), own.damping]
        });
        let bend = Stencils::<Bend, 3, 7>::new(layout, count, nodes, self.damped, |node, body| {
            let [before, at, after] = nodes[node];
            let (low, high) = (self.length(before, at), self.length(at, after));
            let mean = 0.5 * (low + high);
            let own = self.of(body);
            let share = high / (low + high);
            let rest = self.rest_curvature(nodes[node], [low, high], share);
            [own.section(depth)[1] * mean, 1.0 / low, 1.0 / high, share, 1.0 / mean, rest, own.damping]
        });
        let mut parts: Parts<D> = vec![Box::new(stretch), Box::new(bend)];
        if self.elastic.iter().any(|body| body.torsion) {
            parts.push(self.torsion(nodes)?);
        }
        Ok(parts)
    }
    /// Stretch and bending in one walk, if edges follow the numbers of the nodes.
    fn along(&self, edges: &[[u32; 2]]) -> Option<Along> {
        let depth = (D == 2).then_some(self.ingredients.thickness);
        let (layout, count) = self.layout();
        let by_body =
            |number: &dyn Fn(&Elastic) -> f64| Parameter::by_body(core::array::from_fn(|body| number(self.of(body))));
        let section =
            [by_body(&|own| own.section(depth)[0]), by_body(&|own| own.section(depth)[1]), by_body(&|own| own.damping)];
        Along::new(layout, count, edges, section, self.damped, |before, behind| {
            let length = |edge: Option<[u32; 2]>| edge.map_or(0.0, |[a, b]| self.length(a, b));
            let (low, high) = (length(before), length(behind));
            let inverse = if high > 0.0 { 1.0 / high } else { 0.0 };
            let (Some([first, at]), Some([_, after])) = (before, behind) else {
                return [inverse, 0.0, 0.0, 0.0, high, 0.0];
            };
            let (share, mean) = (high / (low + high), 0.5 * (low + high));
            let rest = self.rest_curvature([first, at, after], [low, high], share);
            [inverse, share, 1.0 / mean, rest, high, mean]
        })
    }
    /// The torsion of a curve in space, on its edges between two nodes with curvature.
    fn torsion(&self, nodes: &[[u32; 3]]) -> Result<Box<dyn Potential<D>>, Refusal> {
        for &[before, at, after] in nodes {
            let (a, b) = (minus(&self.at(at), &self.at(before)), minus(&self.at(after), &self.at(at)));
            let normal = cross(&a, &b);
            // If three nodes are collinear up to rounding, their plane is undetermined.
            if dot(&normal, &normal) <= 1e-18 * dot(&a, &a) * dot(&b, &b) {
                return Err(Refusal::NoFrame { node: at });
            }
        }
        let (layout, count) = self.layout();
        // Each inner node with its neighbours before and after.
        let mut around = vec![None; count];
        for node in nodes {
            around[node[1] as usize] = Some(*node);
        }
        let twisted = |&[before, at, after]: &[u32; 3]| match around[after as usize] {
            Some([low, _, high]) if low == at => Some([at, after, before, high]),
            _ => None,
        };
        let edges: Vec<[u32; 4]> = nodes.iter().filter_map(twisted).collect();
        Ok(Box::new(Stencils::<Hinge, 4, 4>::new(layout, count, &edges, self.damped, |edge, body| {
            let [at, after, ..] = edges[edge];
            let own = self.of(body);
            let rigidity = if own.torsion { own.torsional_rigidity() } else { 0.0 };
            let stiffness = rigidity / self.length(at, after);
            let [cosine, sine] = hinge::direction(&edges[edge].map(|n| self.at(n)));
            [stiffness, own.damping * stiffness, cosine, sine]
        })))
    }
    /// The curvature at rest B₀ of a node of a curve [1/m].
    fn rest_curvature(&self, [before, at, after]: [u32; 3], [low, high]: [f64; 2], share: f64) -> f64 {
        let a = minus(&self.at(at), &self.at(before)).map(|c| c / low);
        let b = minus(&self.at(after), &self.at(at)).map(|c| c / high);
        let tangent: [f64; 3] = core::array::from_fn(|d| share * a[d] + (1.0 - share) * b[d]);
        let normal = cross(&a, &b);
        let size = dot(&tangent, &tangent).sqrt() * 0.5 * (low + high);
        let across = if D == 2 { normal[2] } else { dot(&normal, &normal).sqrt() };
        // The curve is straight up to rounding, so all directions of bending are equivalent.
        if D == 3 && across < 1e-9 { 0.0 } else { across / size }
    }

    /// The spacings of quadrilaterals.
    fn rectangles(&self, cells: &[[u32; 4]]) -> Result<Vec<[f64; 2]>, Refusal> {
        let (neighbours, steps) = QUADRILATERAL;
        cells.iter().enumerate().map(|(k, cell)| spacings(self.mesh(), k, cell, neighbours, steps)).collect()
    }
    fn quadrilaterals(
        &self,
        cells: &[[u32; 4]],
        sides: &[[f64; 2]],
        law: impl Fn(&Elastic) -> [f64; 3],
        depth: f64,
    ) -> Box<dyn Potential<D>> {
        let (layout, count) = self.layout();
        Box::new(Stencils::<Quadrilateral, 4, 7>::new(layout, count, cells, self.damped, |cell, body| {
            let [h1, h2] = sides[cell];
            let own = self.of(body);
            let c = law(own).map(|c| c * h1 * h2 * depth);
            [c[0], c[1], c[2], 1.0 / (h1 * h1), 1.0 / (h2 * h2), 1.0 / (h1 * h2), own.damping]
        }))
    }
    fn plane(&self, cells: &[[u32; 4]]) -> Result<Solid<D>, Refusal> {
        let (sides, depth) = (self.rectangles(cells)?, self.ingredients.thickness);
        let part = self.quadrilaterals(cells, &sides, Elastic::solid, depth);
        let sides = sides.iter().map(|side| core::array::from_fn(|d| side[d])).collect();
        Ok((vec![part], Some(Cells::new(cells, sides, depth))))
    }
    fn space(&self, cells: &[[u32; 8]]) -> Result<Solid<D>, Refusal> {
        let (neighbours, steps) = HEXAHEDRON;
        let sides: Vec<[f64; 3]> = cells
            .iter()
            .enumerate()
            .map(|(k, cell)| spacings(self.mesh(), k, cell, neighbours, steps))
            .collect::<Result<_, _>>()?;
        let (layout, count) = self.layout();
        let part = Stencils::<Hexahedron, 8, 10>::new(layout, count, cells, self.damped, |cell, body| {
            let [h1, h2, h3] = sides[cell];
            let own = self.of(body);
            let c = own.solid().map(|c| c * h1 * h2 * h3);
            let over = |a: f64, b: f64| 1.0 / (a * b);
            [
                c[0],
                c[1],
                c[2],
                over(h1, h1),
                over(h2, h2),
                over(h3, h3),
                over(h1, h2),
                over(h1, h3),
                over(h2, h3),
                own.damping,
            ]
        });
        let sides = sides.iter().map(|side| core::array::from_fn(|d| side[d])).collect();
        Ok((vec![Box::new(part)], Some(Cells::new(cells, sides, 1.0))))
    }

    fn surface(&self, cells: &[[u32; 4]], inner: &[[u32; 5]], edge: &[[u32; 4]]) -> Result<Parts<D>, Refusal> {
        let sides = self.rectangles(cells)?;
        let [h1, h2] = sides[0];
        for (cell, own) in sides.iter().enumerate() {
            for (spacing, first) in own.iter().zip([h1, h2]) {
                if (spacing - first).abs() > 1e-6 * first {
                    return Err(Refusal::Uneven { cell, spacing: *spacing, first });
                }
            }
        }
        let area = h1 * h2;
        let (layout, count) = self.layout();
        // The grid is usually flat at rest, since its cells are equal rectangles. A rolled sheet has rectangles too, so B₀ is
        // computed.
        let at_inner = Stencils::<Inner, 5, 7>::new(layout, count, inner, self.damped, |node, body| {
            let own = self.of(body);
            let p = [own.rigidity() * area, own.poissons_ratio, 1.0 / h1, 1.0 / h2, 0.0, 0.0, own.damping];
            let [b1, b2] = plate::curvatures(&p, &inner[node].map(|n| self.at(n)));
            [p[0], p[1], p[2], p[3], b1, b2, p[6]]
        });
        let at_edge = Stencils::<Edge, 4, 5>::new(layout, count, edge, self.damped, |node, body| {
            let own = self.of(body);
            let nu = own.poissons_ratio;
            let nodes = edge[node];
            let (along, across) = (self.length(nodes[0], nodes[2]), self.length(nodes[0], nodes[3]));
            let p = [0.5 * area * own.rigidity() * (1.0 - nu * nu), 1.0 / along, 1.0 / across, 0.0, own.damping];
            [p[0], p[1], p[2], plate::edge_curvature(&p, &nodes.map(|n| self.at(n))), p[4]]
        });
        let twist = Stencils::<Twist, 4, 5>::new(layout, count, cells, self.damped, |cell, body| {
            let own = self.of(body);
            let whole = 2.0 * (1.0 - own.poissons_ratio) * own.rigidity() * area;
            let p = [whole, 1.0 / h1, 1.0 / h2, 0.0, own.damping];
            [p[0], p[1], p[2], plate::twist(&p, &cells[cell].map(|n| self.at(n))), p[4]]
        });
        let membrane = self.quadrilaterals(cells, &sides, Elastic::membrane, 1.0);
        Ok(vec![membrane, Box::new(at_inner), Box::new(at_edge), Box::new(twist)])
    }
}

impl<const D: usize> Potential<D> for FiniteDifference<D> {
    fn properties(&self) -> Properties {
        Properties::new(KIND, Views { energy: true, hessian: true, symmetric: true, damping: self.damped })
    }
    fn stencils(&self, visit: &mut dyn FnMut(&[u32])) {
        self.parts.iter().for_each(|part| part.stencils(visit));
    }
    fn add_force(&self, simd: Simd, view: &View<D>, scratch: &[f64], tile: &mut Tile<D>) {
        if let Some(along) = &self.along {
            along.add_force(simd, view, tile);
        }
        let rest = if self.along.is_some() { 2 } else { 0 };
        self.parts[rest..].iter().for_each(|part| part.add_force(simd, view, scratch, tile));
    }
    fn energy(&self, simd: Simd, view: &View<D>, scratch: &[f64]) -> [f64; WIDTH] {
        let mut energy = [0.0; WIDTH];
        for part in &self.parts {
            let own = part.energy(simd, view, scratch);
            (0..WIDTH).for_each(|l| energy[l] += own[l]);
        }
        energy
    }
    fn hessian(&self, view: &View<D>, scratch: &[f64], keep: Definiteness, sink: &mut dyn Sink<D>) {
        self.parts.iter().for_each(|part| part.hessian(view, scratch, keep, sink));
    }
    fn damping_matrix(&self, view: &View<D>, scratch: &[f64], sink: &mut dyn Sink<D>) {
        self.parts.iter().for_each(|part| part.damping_matrix(view, scratch, sink));
    }
}

impl<const D: usize> Observe<D> for FiniteDifference<D> {
    fn cell_states(&self, view: &View<D>, body: usize) -> Vec<CellState> {
        let Some((cells, elastic)) = &self.solid else { return Vec::new() };
        cells.states(view, body, &elastic[body.min(elastic.len() - 1)])
    }
    fn shape_counts(&self, view: &View<D>) -> Vec<Count> {
        self.folds.iter().map(|folds| folds.found(view)).collect()
    }
    fn heap_bytes(&self) -> usize {
        let folds = self.folds.as_ref().map_or(0, Folds::heap_bytes);
        let cells = self.solid.as_ref().map_or(0, |(cells, _)| cells.heap_bytes());
        let along = self.along.as_ref().map_or(0, Along::heap_bytes);
        self.parts.iter().map(|part| part.heap_bytes()).sum::<usize>() + cells + along + folds
    }
}
