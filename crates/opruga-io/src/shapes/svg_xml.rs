//! The XML of a drawing.

use super::drawing_errors::SvgError;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use roxmltree::{Document, Node, ParsingOptions};

/// The largest number of elements and texts in a file.
const MOST_NODES: u32 = 4 << 20;

/// Whether an element belongs to the drawing: it has the namespace of SVG, or no namespace.
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
        let error = SceneError::of(SvgError::NoDrawing { element: visible(root.tag_name().name()) });
        return Err(source.mark(error, root.range().start, root.range().start + 1));
    }
    Ok(document)
}

/// An error of the XML reader.
fn syntax(source: &Source<'_>, error: &roxmltree::Error) -> SceneError {
    let position = error.pos();
    let at = source.offset(position.row as usize, position.col as usize);
    let text = error.to_string();
    let reason = visible(text.split(" at ").next().unwrap_or(&text));
    let found = visible(&source.text[at..].chars().take(1).collect::<String>());
    let error = match error {
        roxmltree::Error::UnknownEntityReference(..) | roxmltree::Error::EntityResolver(..) => {
            SvgError::OutsideEntity { reason, found }
        }
        roxmltree::Error::EntityReferenceLoop(_) => SvgError::EntityLoop { reason, found },
        roxmltree::Error::NodesLimitReached => SvgError::Elements { reason, found },
        _ => SvgError::Xml { reason, found },
    };
    source.mark(SceneError::of(error), at, at + 1)
}
