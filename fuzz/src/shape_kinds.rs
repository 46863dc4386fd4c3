/// The shapes as which a file is read: dimension, name of the file, shape. The first byte of an input selects one.
///
/// The fuzz target `shape_files` and the test `shape_fuzz` share this list, and start from `fuzz/corpus/shape_files`.
const SHAPES: [(u8, &str, &str); 25] = [
    (2, "a.svg", "kind = \"svg\", spacing = 0.2, size = 1.0, filling = \"triangles\""),
    (2, "a.svg", "kind = \"svg\", spacing = 0.1, size = 1.0, overlap = \"union\""),
    (2, "a.svg", "kind = \"svg\", spacing = 0.2, size = 1.0, filling = \"lattice\", overlap = \"union\", colours = true"),
    (2, "a.svg", "kind = \"svg\", spacing = 0.2, size = 1.0, overlap = \"even_odd\", colours = true"),
    (2, "a.geojson", "kind = \"map\", spacing = 0.1, size = 1.0, overlap = \"even_odd\""),
    (2, "a.topojson", "kind = \"map\", spacing = 0.2, size = 1.0, filling = \"triangles\""),
    (2, "a.json", "kind = \"map\", spacing = 0.2, size = 1.0, filling = \"lattice\", feature = \"a\""),
    (2, "a.ttf", "kind = \"text\", spacing = 0.2, size = 1.0, text = \"o B\""),
    (2, "a.png", "kind = \"bitmap\", spacing = 0.1, size = 1.0"),
    (3, "a.obj", "kind = \"surface\", weld = 1e-6, filling = \"lattice\", spacing = 0.5"),
    (3, "a.obj", "kind = \"surface\", filling = \"tetrahedra\", spacing = 0.1"),
    (3, "a.obj", "kind = \"surface\", remesh = 0.5"),
    (3, "a.stl", "kind = \"surface\", open = \"cap\""),
    (3, "a.ply", "kind = \"surface\", filling = \"lattice\", spacing = 0.5"),
    (3, "a.gltf", "kind = \"surface\", open = \"sheet\""),
    (3, "a.glb", "kind = \"surface\", weld = 1e-9"),
    (2, "a.msh", "kind = \"mesh\", inverted = \"turn\", unreferenced = \"leave_out\""),
    (3, "a.msh", "kind = \"mesh\", inverted = \"turn\", unreferenced = \"leave_out\""),
    (3, "a.vtk", "kind = \"mesh\", inverted = \"turn\""),
    (3, "a.vtu", "kind = \"mesh\", inverted = \"turn\""),
    (3, "a.mesh", "kind = \"mesh\", inverted = \"turn\""),
    (3, "a.ele", "kind = \"mesh\", inverted = \"turn\""),
    (3, "a.node", "kind = \"mesh\", unreferenced = \"leave_out\""),
    (2, "a.vtk", "kind = \"mesh\", unreferenced = \"leave_out\""),
    (3, "a.msh", "kind = \"surface\""),
];

/// The two files of a TetGen mesh; any bytes replace one of them.
const NODES: &[u8] = b"4 3 0 0\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n";
const CELLS: &[u8] = b"1 4 0\n1 1 2 3 4\n";
