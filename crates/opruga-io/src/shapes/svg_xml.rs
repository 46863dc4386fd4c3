//! The XML of a drawing.

use crate::problem::{SceneError, visible};
use crate::source::Source;
use roxmltree::{Document, Node, ParsingOptions};

/// The largest number of elements and texts that stand in a file.
const MOST_NODES: u32 = 4 << 20;

/// Whether an element belongs to the drawing: one of SVG, or of no language at all.
pub(super) fn is_drawing(node: Node<'_, '_>) -> bool {
    matches!(node.tag_name().namespace(), None | Some("http://www.w3.org/2000/svg"))
}

/// Reads the elements of a drawing.
///
/// # Errors
/// `svg.syntax`, `svg.entity`, `limit.expansion`, `limit.elements`, with line and column.
pub(super) fn document<'a>(source: &Source<'a>) -> Result<Document<'a>, SceneError> {
    super::entities::check(source)?;
    let options = ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, entity_resolver: None };
    let document = Document::parse_with_options(source.text, options).map_err(|e| syntax(source, &e))?;
    let root = document.root_element();
    if root.tag_name().name() != "svg" {
        let error =
            SceneError::new("svg.syntax", format!("the file is no drawing but <{}>", visible(root.tag_name().name())));
        return Err(source
            .mark(error, root.range().start, root.range().start + 1)
            .value(visible(root.tag_name().name()))
            .allowed("<svg>"));
    }
    Ok(document)
}

/// What the XML reader refuses.
fn syntax(source: &Source<'_>, error: &roxmltree::Error) -> SceneError {
    let place = error.pos();
    let at = source.offset(place.row as usize, place.col as usize);
    let (code, hint) = match error {
        roxmltree::Error::UnknownEntityReference(..) | roxmltree::Error::EntityResolver(..) => {
            ("svg.entity", Some("entities from outside of the file are never read"))
        }
        roxmltree::Error::EntityReferenceLoop(_) => ("svg.entity", Some("entities may not contain one another")),
        roxmltree::Error::NodesLimitReached => ("limit.elements", None),
        _ => ("svg.syntax", None),
    };
    let text = error.to_string();
    let message = text.split(" at ").next().unwrap_or(&text);
    let found: String = source.text[at..].chars().take(1).collect();
    let error =
        source.mark(SceneError::new(code, format!("this is no well-formed XML: {}", visible(message))), at, at + 1);
    let error = error.value(visible(&found));
    hint.map_or(error.clone(), |hint| error.hint(hint))
}
