//! Bodies that finite elements refuse, and the messages.

use crate::support;

use crate::support::models::Fem;
use opruga_mesh::Mesh;
use support::refusal;

#[test]
fn what_has_no_meaning_is_refused_with_what_is_allowed() {
    let boxes = Mesh::<2>::grid([0.0; 2], [1.0, 1.0], [2, 2]).unwrap();
    let triangles = boxes.clone().into_simplices().unwrap();
    let ring = Mesh::<2>::ring(1.0, 12, [0.0; 2], 0.0).unwrap();
    let fem = |ratio: f64| values!(fem, youngs_modulus: 1.0, poissons_ratio: ratio);
    let of = |mesh: &Mesh<2>, values| refusal(mesh, &Fem, values);
    assert!(of(&ring, fem(0.3)).starts_with("model.no_cells"), "{}", of(&ring, fem(0.3)));
    assert!(of(&triangles, fem(0.46)).contains("`order = 2`"), "{}", of(&triangles, fem(0.46)));
    assert!(of(&triangles, fem(0.46)).starts_with("model.locking"));
    let accepted = values!(fem, youngs_modulus: 1.0, poissons_ratio: 0.46, locking: "accept");
    assert_eq!(of(&triangles, accepted), "built");
    let nodal =
        |plane: &str| values!(fem, youngs_modulus: 1.0, poissons_ratio: 0.4999, locking: "nodal_volume", plane: plane);
    assert_eq!(of(&triangles, nodal("strain")), "built");
    assert!(of(&triangles, nodal("stress")).contains("in plane stress"), "{}", of(&triangles, nodal("stress")));
    assert!(of(&boxes, nodal("strain")).contains("not linear triangles"), "{}", of(&boxes, nodal("strain")));
    let thin = values!(fem, youngs_modulus: 1.0, poissons_ratio: 0.49, plane: "stress");
    assert_eq!(of(&triangles, thin), "built");
    assert_eq!(of(&boxes, fem(0.4999)), "built");
    assert_eq!(of(&triangles.clone().into_quadratic().unwrap(), fem(0.4999)), "built");
    assert!(of(&boxes, values!(fem)).starts_with("model.one_of"));
    assert!(of(&boxes, values!(fem, youngs_modulus_of_cells: "E")).contains("the mesh has no numbers for its cells"));
    assert!(of(&boxes, values!(fem, youngs_modulus: 1.0, cells: "bone")).contains("it has none"));
    let mooney = values!(fem, material: "mooney_rivlin", youngs_modulus: 1.0, poissons_ratio: 0.1, mooney_share: 0.2);
    assert!(of(&boxes, mooney).contains("at most 0.125"));
    // With λ < 0 no share is allowed: the message blames the ratio and states how large it has to be.
    let auxetic = values!(fem, material: "mooney_rivlin", youngs_modulus: 1.0, poissons_ratio: -0.5, mooney_share: 0.5);
    let said = of(&boxes, auxetic);
    assert!(said.contains("`poissons_ratio` is -0.5") && said.contains("at least 0.25,"), "{said}");
    let least = values!(fem, material: "mooney_rivlin", youngs_modulus: 1.0, poissons_ratio: 0.25, mooney_share: 0.5);
    assert_eq!(of(&boxes, least), "built");
    let mut folded = boxes.clone();
    folded.positions[4] = [2.0, 2.0];
    assert!(of(&folded, fem(0.3)).starts_with("model.inverted_cell"), "{}", of(&folded, fem(0.3)));
}
