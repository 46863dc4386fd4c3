//! Errors of the readers of VTK files.

use super::terms::ElementName;
use opruga_math::message::if_any;
use opruga_math::messages;

messages! {
    /// An array of an XML file, with its name if it has one.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum ArrayName {
        "part.array_name" #[error(" `{name}`")]
        Named { name: String },
    }

    /// A part of an XML file that occurs twice.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum Doubled {
        "part.doubled" #[error("<{tag}>")]
        Tag { tag: String },
        "part.doubled" #[error("array{} in <{tag}>", if_any(name))]
        Array { name: Option<ArrayName>, tag: String },
    }

    /// Errors in a legacy VTK file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum VtkError {
        "vtk.size" #[error("cell {cell}, a {element}, has {nodes} nodes")] #[value("{nodes}")] #[allowed("{wanted}")]
        CellNodes { cell: u64, element: ElementName, nodes: usize, wanted: usize },
        "mesh.index" #[error("cell {cell} names node {node}")] #[value("{node}")] #[allowed("0 to {most}")]
        NoNodeOfCell { cell: u64, node: i128, most: i128 },
        "vtk.syntax" #[error("the file does not begin like a VTK file")] #[value("{head}")] #[allowed("# vtk DataFile Version 3.0")]
        Head { head: String },
        "vtk.syntax" #[error("`{word}` is not a file type")] #[value("{word}")] #[allowed("ASCII or BINARY")]
        FileKind { word: String },
        "vtk.syntax" #[error("the data set is `{word}`")] #[value("{word}")] #[allowed("UNSTRUCTURED_GRID")]
        DataSet { word: String },
        "vtk.size" #[error("there are {there} cells, not {count}")] #[value("{count}")] #[allowed("{there}")]
        Cells { there: u64, count: u64 },
        "vtk.size" #[error("there are {there} points, not {count}")] #[value("{count}")] #[allowed("{there}")]
        Points { there: usize, count: u64 },
        "vtk.syntax" #[error("`{word}` is not a keyword")] #[value("{word}")]
        #[allowed("POINTS, CELLS, CELL_TYPES, CELL_DATA, POINT_DATA, FIELD, SCALARS …")]
        Keyword { word: String },
        "vtk.size" #[error("the first cell begins at {offset}")] #[value("{offset}")] #[allowed("{wanted}")]
        FirstOffset { offset: i128, wanted: i128 },
        "vtk.size" #[error("the last cell ends at {offset}")] #[value("{offset}")] #[allowed("{wanted}")]
        LastOffset { offset: i128, wanted: i128 },
        "vtk.size" #[error("the nodes of a cell begin at offset {start} and end at offset {end}")] #[value("{end}")] #[allowed("{start} to {most}")]
        Reach { start: i128, end: i128, most: i128 },
        "vtk.size" #[error("a cell has {nodes} nodes, but only {there} follow")] #[value("{nodes}")] #[allowed("at most {there}")]
        Follow { nodes: i128, there: usize },
        "vtk.size" #[error("numbers follow the last cell: {numbers}")] #[value("{size}")] #[allowed("{wanted}")]
        BehindCells { numbers: usize, size: u64, wanted: u64 },
        "vtk.size" #[error("there are types for {count} cells")] #[value("{count}")] #[allowed("{cells}")]
        Types { count: u64, cells: usize },
        "vtk.size" #[error("{values} values for {cells} cells")] #[value("{values}")] #[allowed("{cells}")]
        ValuesOfCells { values: u64, cells: usize },
        "vtk.size" #[error("{values} values for {points} points")] #[value("{values}")] #[allowed("{points}")]
        ValuesOfPoints { values: u64, points: usize },
        "vtk.syntax" #[error("a field of texts cannot be read")] #[value("string")] #[allowed("numbers")]
        Texts {},
        "vtk.syntax" #[error("`{word}` comes before CELL_DATA and POINT_DATA")] #[value("{word}")] #[allowed("after CELL_DATA or POINT_DATA")]
        BeforeData { word: String },
        "vtk.syntax" #[error("`{word}` is not a number of components")] #[value("{word}")] #[allowed("1 to 4")]
        Components { word: String },
    }

    /// Errors in a VTK XML file.
    #[derive(Clone, Debug, PartialEq)]
    pub(crate) enum VtuError {
        "vtu.syntax" #[error("the file is not a text in UTF-8")] #[value("byte {byte}")] #[hint("it is cut off, or is not a VTU file")]
        Encoding { byte: usize },
        "vtu.syntax" #[error("this is not well-formed XML: {reason}")] #[value("XML")] #[hint("the file is cut off, or is not a VTU file")]
        Xml { reason: String },
        "vtu.syntax" #[error("the file contains `{kind}`")] #[value("{kind}")] #[allowed("<VTKFile type=\"UnstructuredGrid\">")]
        Kind { kind: String },
        "vtu.compressor" #[error("data compressed by `{name}` cannot be read")] #[value("{name}")]
        #[allowed("vtkZLibDataCompressor, or none")] #[hint("choose another compressor in ParaView")]
        Compressor { name: String },
        "vtu.syntax" #[error("`{word}` is not a header type")] #[value("{word}")] #[allowed("UInt32, UInt64")]
        HeaderType { word: String },
        "vtu.syntax" #[error("`{word}` is not a byte order")] #[value("{word}")] #[allowed("LittleEndian, BigEndian")]
        ByteOrder { word: String },
        "vtu.syntax" #[error("there is no piece")] #[value("0")] #[allowed("<Piece> in <UnstructuredGrid>")]
        NoPiece {},
        "vtu.syntax" #[error("{attribute} is `{word}`")] #[value("{word}")] #[allowed("a whole number up to 2147483648")]
        Count { attribute: &'static str, word: String },
        "vtu.syntax" #[error("there is a second {what}")] #[value("{word}")] #[allowed("one")]
        Second { what: Doubled, word: String },
        "vtu.syntax" #[error("<{tag}> has no array{}", if_any(name))] #[value("0")] #[allowed("<DataArray>")]
        NoArray { tag: String, name: Option<ArrayName> },
        "vtu.syntax" #[error("points have `{components}` coordinates")] #[value("{components}")] #[allowed("3")]
        Coordinates { components: String },
        "scene.not_finite" #[error("a coordinate of point {point} is {number}")] #[value("{number}")] #[allowed("a finite number")]
        NotFinitePoint { point: usize, number: f64 },
        "vtu.size" #[error("the last cell ends at {offset}")] #[value("{offset}")] #[allowed("0 or more")]
        LastOffset { offset: i128 },
        "vtu.size" #[error("the nodes of cell {cell} begin at offset {start} and end at offset {end}")] #[value("{end}")] #[allowed("{start} to {most}")]
        Reach { cell: usize, start: i128, end: i128, most: usize },
        "vtu.syntax" #[error("`{number}` is not a whole number")] #[value("{number}")] #[allowed("a whole number")]
        NotWhole { number: f64 },
        "vtu.syntax" #[error("`{word}` is not a number that its array can contain")] #[value("{word}")] #[allowed("{range}")]
        NotOfArray { word: String, range: super::errors::NumberRange },
        "vtu.size" #[error("there is no appended data")] #[value("appended")] #[allowed("<AppendedData>")] #[hint("the file is cut off")]
        NothingAppended {},
        "vtu.size" #[error("the array begins after the end of the appended data")] #[value("{offset}")] #[allowed("0 to {most}")]
        #[hint("the file is cut off")]
        BehindAppended { offset: String, most: usize },
        "vtu.syntax" #[error("`{word}` is not an array format")] #[value("{word}")] #[allowed("ascii, binary, appended")]
        ArrayFormat { word: String },
        "vtu.size" #[error("the array has {there} values, not {count}")] #[value("{there}")] #[allowed("{count}")]
        #[hint("the file is cut off, or its counts are wrong")]
        ArraySize { there: u64, count: u64 },
        "vtu.size" #[error("the data of the array is cut off")] #[value("{there} bytes")] #[allowed("{wanted} bytes of numbers")]
        Cut { there: usize, wanted: u64 },
        "vtu.syntax" #[error("the data of the array is not base64")] #[value("base64")] #[allowed("A–Z a–z 0–9 + / =")]
        Base64 {},
        "vtu.syntax" #[error("block {block} of the array cannot be decompressed")] #[value("{there} bytes")] #[allowed("{wanted} bytes")]
        Block { block: u64, there: usize, wanted: u64 },
    }
}
