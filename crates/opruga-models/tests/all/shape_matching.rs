//! Shape matching against closed forms of its energy, and on bodies with too few nodes.

use crate::support::models::ShapeMatching as Matching;
use crate::support::{energy, forces, hessian, refusal, system, system_with_mass};
use opruga_core::system::System;
use opruga_mesh::Mesh;

fn block() -> Mesh<3> {
    Mesh::grid([0.1, 0.2, 0.3], [1.0, 0.8, 0.6], [2, 2, 3]).unwrap()
}
fn plate() -> Mesh<2> {
    Mesh::grid([0.1, 0.2], [1.0, 0.8], [3, 4]).unwrap()
}
/// Moves every node to the image of its rest position.
fn moved<const D: usize>(mut system: System<D>, mesh: &Mesh<D>, map: impl Fn(&[f64; D]) -> [f64; D]) -> System<D> {
    for (node, x) in mesh.positions.iter().enumerate() {
        system.state.x.set(node, map(x));
    }
    system
}
fn size(v: &[f64]) -> f64 {
    v.iter().fold(0.0, |most, x| if x.abs() > most { x.abs() } else { most })
}
/// The largest of |K δ − k δ|, with masses of 1 kg.
fn off<const D: usize>(system: &mut System<D>, displacement: &[f64], k: f64) -> f64 {
    let product = hessian(system).times(displacement);
    size(&product.iter().zip(displacement).map(|(a, b)| a - k * b).collect::<Vec<f64>>())
}
fn field<const D: usize>(mesh: &Mesh<D>, of: impl Fn([f64; D]) -> [f64; D]) -> Vec<f64> {
    let nodes = mesh.positions.len() as f64;
    let center: [f64; D] = core::array::from_fn(|d| mesh.positions.iter().map(|x| x[d]).sum::<f64>() / nodes);
    mesh.positions.iter().flat_map(|x| of(core::array::from_fn(|d| x[d] - center[d]))).collect()
}

/// At rest, rigid motions have no stiffness, strains have (1 − β)κ, and motions that no map follows have κ.
#[test]
fn stiffness_of_motions_at_rest() {
    let (stiffness, share) = (250.0, 0.6);
    let mesh = block();
    let linear = values!(shape_matching, stiffness: stiffness, fit_share: share);
    let mut body = system(&mesh, &[(&Matching, linear)]);
    let turn = field(&mesh, |q| [q[1] - 0.3 * q[2], -q[0] + 2.0 * q[2], 0.3 * q[0] - 2.0 * q[1]]);
    assert!(off(&mut body, &turn, 0.0) < 1e-10 * stiffness);
    assert!(off(&mut body, &field(&mesh, |_| [1.0, -2.0, 0.5]), 0.0) < 1e-10 * stiffness);
    // A strain along an axis, without rotation in the frame of the inertia.
    assert!(
        off(&mut body, &field(&mesh, |q| [q[0], -0.4 * q[1], 0.1 * q[2]]), (1.0 - share) * stiffness)
            < 1e-10 * stiffness
    );
    // A bend that is orthogonal to all linear maps: the square of a coordinate minus its mean.
    let mean = field(&mesh, |q| [q[0] * q[0], 0.0, 0.0]).iter().sum::<f64>() / mesh.positions.len() as f64;
    let bend = field(&mesh, |q| [0.0, q[0] * q[0] - mean, 0.0]);
    assert!(off(&mut body, &bend, stiffness) < 1e-10 * stiffness);
    // The quadratic fit follows that too.
    let quadratic = values!(shape_matching, stiffness: stiffness, fit_share: share, fit: "quadratic");
    let mut body = system(&mesh, &[(&Matching, quadratic)]);
    assert!(off(&mut body, &bend, (1.0 - share) * stiffness) < 1e-9 * stiffness);

    let mesh = plate();
    let linear = values!(shape_matching, stiffness: stiffness, fit_share: share);
    let mut body = system(&mesh, &[(&Matching, linear)]);
    assert!(off(&mut body, &field(&mesh, |q| [q[1], -q[0]]), 0.0) < 1e-10 * stiffness);
    assert!(off(&mut body, &field(&mesh, |q| [q[0], 0.3 * q[1]]), (1.0 - share) * stiffness) < 1e-10 * stiffness);
}

/// A stretched body has U = ½ (1 − β) κ Σ m |x − R q|², and rotating it does not change this.
#[test]
fn energy_of_a_stretch() {
    let (stiffness, share, stretch) = (250.0, 0.6, [1.2, 0.7, 1.1]);
    let mesh = block();
    let values = values!(shape_matching, stiffness: stiffness, fit_share: share);
    let (c, s) = (0.6, 0.8);
    let mut body = moved(system_with_mass(&mesh, &[(&Matching, values)], 0.25), &mesh, |x| {
        let y: [f64; 3] = core::array::from_fn(|d| stretch[d] * x[d]);
        [c * y[0] - s * y[1] + 40.0, s * y[0] + c * y[1], y[2] - 7.0]
    });
    let strain: f64 = field(&mesh, |q| core::array::from_fn(|d| (stretch[d] - 1.0) * q[d])).iter().map(|x| x * x).sum();
    let expected = 0.5 * (1.0 - share) * stiffness * 0.25 * strain;
    let found = energy(&mut body);
    assert!((found - expected).abs() < 1e-12 * expected, "{found} {expected}");
}

/// Overlapping clusters: weights sum to one, so that stiffnesses do not grow with the number of clusters that contain a node.
#[test]
fn clusters_share_the_mass_of_their_nodes() {
    let mesh = Mesh::<3>::grid([0.0; 3], [1.0; 3], [6, 6, 6]).unwrap();
    let values = values!(shape_matching, stiffness: 100.0, region: 0.5);
    let mut body = system(&mesh, &[(&Matching, values)]);
    let matrix = hessian(&mut body);
    let rigid = matrix.times(&field(&mesh, |q| [q[1], -q[0], 0.0]));
    assert!(size(&rigid) < 1e-9, "{}", size(&rigid));
    // No motion is stiffer than that of a single node.
    let nodes = mesh.positions.len();
    assert_eq!(matrix.eigenvalues_below(100.0 * (1.0 + 1e-9)), 3 * nodes);
    assert_eq!(matrix.eigenvalues_below(-1e-9), 0);
    assert_eq!(matrix.eigenvalues_below(1e-6), 6);
}

/// Bodies of one, two and three nodes, lines and planes: finite forces, none at rest, and no resistance in missing directions.
#[test]
fn bodies_of_too_few_dimensions() {
    let line: Vec<[f64; 3]> = (0..5).map(|k| [0.1 * f64::from(k), 0.2 * f64::from(k), -0.1 * f64::from(k)]).collect();
    let flat = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.0], [0.0, 1.0, 1.0]], [2, 3]).unwrap();
    let chain = Mesh::polyline(&line, false).unwrap();
    let two = Mesh::polyline(&line[..2], false).unwrap();
    for (mesh, rigid) in [(&flat, 6), (&chain, 5), (&two, 5)] {
        for fit in ["linear", "quadratic"] {
            let values = values!(shape_matching, stiffness: 100.0, fit_share: 0.5, fit: fit);
            let mut body = system(mesh, &[(&Matching, values)]);
            assert!(size(&forces(&mut body)) < 1e-12);
            let matrix = hessian(&mut body);
            assert!(matrix.entries.iter().all(|x| x.is_finite()));
            // Rigid motions have no stiffness. All other motions of these nodes have at least (1 − β)κ, except those across a
            // line or plane that a fitted map follows.
            assert!(matrix.eigenvalues_below(1e-6) >= rigid, "{}", matrix.eigenvalues_below(1e-6));
            assert_eq!(matrix.eigenvalues_below(-1e-6), 0);
        }
    }
    let values = values!(shape_matching, stiffness: 100.0);
    let mut body = moved(system(&flat, &[(&Matching, values.clone())]), &flat, |_| [1.0, 2.0, 3.0]);
    assert!(forces(&mut body).iter().all(|f| f.is_finite()));
    let mut body = moved(system(&flat, &[(&Matching, values.clone())]), &flat, |x| [x[0], 0.0, 0.0]);
    assert!(forces(&mut body).iter().all(|f| f.is_finite()));
    // A mirrored plate in space is a rotated plate: the best rotation matches it, and no force remains.
    let mut body = moved(system(&flat, &[(&Matching, values.clone())]), &flat, |x| [-x[0], x[1], x[2]]);
    assert!(size(&forces(&mut body)) < 1e-10, "{}", size(&forces(&mut body)));
    // A mirrored block is not a rotated one: the rotation has det R = 1, and the energy is that of the smallest extent, Σ m (2
    // q)²/2 κ.
    let mesh = block();
    let mut body = moved(system(&mesh, &[(&Matching, values)]), &mesh, |x| [-x[0], x[1], x[2]]);
    let least = field(&mesh, |q| [0.0, 0.0, 2.0 * q[2]]).iter().map(|x| x * x).sum::<f64>();
    let other = field(&mesh, |q| [0.0, 2.0 * q[1], 0.0]).iter().map(|x| x * x).sum::<f64>();
    let expected = 0.5 * 100.0 * if least < other { least } else { other };
    assert!((energy(&mut body) - expected).abs() < 1e-9 * expected, "{} {expected}", energy(&mut body));
}

/// The published goal of a stretched square is a rectangle with its original area; with β = 1 the force pulls towards it.
#[test]
fn the_published_goal_keeps_the_volume() {
    let mesh = plate();
    let values = values!(shape_matching, stiffness: 100.0, fit_share: 1.0, scheme: "as_published");
    let mut body = moved(system(&mesh, &[(&Matching, values.clone())]), &mesh, |x| [2.0 * x[0], 0.5 * x[1]]);
    assert!(size(&forces(&mut body)) < 1e-10);
    let mut body = moved(system(&mesh, &[(&Matching, values)]), &mesh, |x| [4.0 * x[0], x[1]]);
    let expected = field(&mesh, |q| [-100.0 * 2.0 * q[0], -100.0 * 0.5 * q[1]]);
    let wrong = forces(&mut body).iter().zip(&expected).map(|(a, b)| a - b).collect::<Vec<f64>>();
    assert!(size(&wrong) < 1e-10, "{}", size(&wrong));
    // The fraction α of the distance in a step of 1 ms.
    let goal = values!(shape_matching, goal_step: 0.3, scheme: "as_published");
    let mut body = moved(system(&mesh, &[(&Matching, goal)]), &mesh, |x| [x[0] * 1.5, x[1]]);
    let force = forces(&mut body);
    let expected = field(&mesh, |q| [-0.3 / 1e-6 * 0.5 * q[0], 0.0]);
    let wrong = force.iter().zip(&expected).map(|(a, b)| a - b).collect::<Vec<f64>>();
    assert!(size(&wrong) < 1e-9 * size(&expected), "{}", size(&wrong));
}

#[test]
fn what_has_no_meaning_is_refused_with_what_is_allowed() {
    let mut mesh = plate();
    mesh.groups.insert("left".into(), (0..8).collect());
    let of = |values| refusal(&mesh, &Matching, values);
    assert!(of(values!(shape_matching)).starts_with("model.one_of"));
    let goal = of(values!(shape_matching, goal_step: 0.3));
    assert!(goal.starts_with("model.goal_step") && goal.contains("stiffness = 300000"), "{goal}");
    let missed = of(values!(shape_matching, stiffness: 1.0, groups: "left"));
    assert!(missed.starts_with("model.cluster_misses") && missed.contains("12 of 20 nodes"), "{missed}");
    let unknown = of(values!(shape_matching, stiffness: 1.0, groups: "left, rigth"));
    assert!(unknown.starts_with("model.no_group") && unknown.contains("`left`"), "{unknown}");
    assert!(of(values!(shape_matching, stiffness: 1.0, region: 1e-4)).starts_with("model.region"));
    mesh.groups.insert("rest".into(), (6..20).collect());
    assert_eq!(refusal(&mesh, &Matching, values!(shape_matching, stiffness: 1.0, groups: "left,rest")), "built");
}

/// `goal_step` is valid only for the declared step.
#[test]
fn another_step_is_refused_where_the_stiffness_depends_on_it() {
    let mesh = plate();
    let goal = values!(shape_matching, goal_step: 0.3, scheme: "as_published");
    let mut body = system(&mesh, &[(&Matching, goal)]);
    let view = body.view(opruga_core::system::Stage::Current, 0.0);
    let simd = body.simd;
    let potential = &body.members[0].potential;
    let mut memory = potential.initial_memory();
    let mut scratch = vec![0.0; potential.properties().scratch_len];
    potential.remember(simd, &view, 1e-3, &mut scratch, &mut memory);
    assert!(potential.prepare(simd, &view, &memory, &mut scratch).is_ok());
    potential.remember(simd, &view, 5e-4, &mut scratch, &mut memory);
    let refused = potential.prepare(simd, &view, &memory, &mut scratch).unwrap_err().to_string();
    assert!(refused.contains("the substep is 0.0005 s"), "{refused}");
    body.forces(false).unwrap();
}

/// Overlapping groups: slices along x, each of which shares half of its nodes with the next.
fn grouped<const D: usize>(mut mesh: Mesh<D>, groups: u32) -> Mesh<D> {
    let [low, high] = mesh.positions.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
        [if x[0] < low { x[0] } else { low }, if x[0] > high { x[0] } else { high }]
    });
    for group in 0..groups {
        let begin = low + (high - low) * f64::from(group) / f64::from(groups + 1);
        let end = begin + 2.0 * (high - low) / f64::from(groups + 1);
        let within = |x: &[f64; D]| x[0] >= begin - 1e-9 && x[0] <= end + 1e-9;
        let own = (0..mesh.positions.len() as u32).filter(|node| within(&mesh.positions[*node as usize]));
        let own: Vec<u32> = own.collect();
        mesh.groups.insert(format!("g{group}"), own);
    }
    mesh
}

/// Nodes with the same clusters are summed together, unless the body is so much larger than its clusters that digits would be
/// lost; then every cluster is evaluated by itself. A distant part of the body decides which of the two happens, and it changes
/// no force.
#[test]
fn a_far_part_changes_no_force_of_overlapping_clusters() {
    fn compare<const D: usize>(mesh: &Mesh<D>, groups: u32, fit_share: f64, size_of: Option<f64>) -> bool {
        let mut with_far = mesh.clone();
        let first = mesh.positions.len() as u32;
        for k in 0..8 {
            let corner = |d: usize| f64::from(k >> d & 1u32);
            with_far.positions.push(core::array::from_fn(|d| corner(d) + if d == 0 { 1e4 } else { 0.0 }));
        }
        with_far.groups.insert("far".into(), (first..first + 8).collect());
        let names: Vec<String> = (0..groups).map(|group| format!("g{group}")).collect();
        let names = names.join(",");
        let disturbed = |mesh: &Mesh<D>, names: &str| {
            let values = values!(shape_matching, stiffness: 300.0, groups: names, fit_share: fit_share);
            let mut system = system(mesh, &[(&Matching, values)]);
            for (node, at) in mesh.positions.iter().take(first as usize).enumerate() {
                let x = |d: usize| at[d] * (1.0 + 0.2 * at[(d + 1) % D]) + 0.01 * ((node + d) % 7) as f64;
                system.state.x.set(node, core::array::from_fn(x));
            }
            forces(&mut system)[..first as usize * D].to_vec()
        };
        let alone = disturbed(mesh, &names);
        let together = disturbed(&with_far, &format!("{names},far"));
        let off = size(&alone.iter().zip(&together).map(|(a, b)| a - b).collect::<Vec<f64>>());
        let size = size_of.unwrap_or_else(|| size(&together));
        assert!(off < 1e-12 * size, "{off} of {size}");
        off > 0.0
    }
    let plate = Mesh::<2>::grid([0.3, 0.2], [1.0, 0.7], [13, 9]).unwrap();
    let block = Mesh::<3>::grid([0.3, 0.2, 0.1], [1.0, 0.7, 0.5], [9, 7, 5]).unwrap();
    let sheet = Mesh::sheet([0.0; 3], [[1.0, 0.0, 0.5], [0.0, 1.0, 0.2]], [11, 12]).unwrap();
    let mut two_ways = 0;
    for fit_share in [0.0, 0.6] {
        for groups in [2, 5] {
            two_ways += u32::from(compare(&grouped(plate.clone(), groups), groups, fit_share, None));
            two_ways += u32::from(compare(&grouped(block.clone(), groups), groups, fit_share, None));
            two_ways += u32::from(compare(&grouped(sheet.clone(), groups), groups, fit_share, None));
        }
    }
    // A chain that is almost long enough for digits to be lost. Forces keep twelve digits relative to κ m r, the force of a
    // cluster that is displaced by its radius.
    let chain = Mesh::<2>::line([0.0; 2], [100.0, 0.0], 100).unwrap();
    compare(&grouped(chain, 49), 49, 0.5, Some(300.0 * 2.0 * 1.3));
    assert!(two_ways > 8, "{two_ways} of 12: what is summed up in one way compares nothing");
}
