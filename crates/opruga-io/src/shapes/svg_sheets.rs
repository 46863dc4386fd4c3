//! Style sheets of a drawing, and the rules in them that apply to an element.
//!
//! The reader supports selectors of names, `.class`, `#id` and `*`, which may be nested (` `, `>`) and form lists. The reader cannot decide to which
//! elements rules with other selectors and conditional rules (`@media`) apply. Such a rule may apply to every element with one of the names in the
//! rule.
//!
//! # Source
//! W3C, Cascading Style Sheets, level 2 revision 1, chapters 5 and 6.

use super::drawing_errors::SvgError;
use super::svg_index::Index;
use super::svg_outlines::changes_outlines;
use super::svg_xml::is_drawing;
use crate::budget::RULES;
use crate::problem::{SceneError, visible};
use crate::source::Source;
use roxmltree::{Document, Node};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::rc::Rc;

/// Blocks that do not apply to elements.
const ELSEWHERE: [&str; 5] = ["@font-face", "@keyframes", "@page", "@counter-style", "@property"];

/// All rules of a drawing, in their order.
#[derive(Debug, Default)]
pub(super) struct Sheets {
    rules: Vec<Rule>,
    /// The elements of the drawing by their ids.
    pub(super) index: Index,
    /// A cache: the rules that apply to each element looked up so far, with their weights.
    obeyed: RefCell<BTreeMap<usize, Obeyed>>,
    /// For elements with a long `style`: the range of the value of each of its properties.
    styles: RefCell<BTreeMap<usize, LongStyle>>,
}

/// The range of the value of each property.
type LongStyle = BTreeMap<String, (usize, usize)>;

/// A `style` with more bytes is parsed only once, and not at each look-up.
const LONG_STYLE: usize = 1024;

/// The rules that apply to an element: for each, its precedence and its number.
type Obeyed = Rc<[(Weight, usize)]>;

/// The precedence of rules: the one with more ids wins, then the one with more classes, then the one with more names.
type Weight = [usize; 3];

#[derive(Debug)]
struct Rule {
    selectors: Vec<Selector>,
    /// The names of elements, `.class` and `#id` to which the rule may apply, if its selectors are not supported.
    perhaps: Vec<String>,
    declarations: Vec<Declaration>,
    /// The range of the rule's style sheet in the file.
    sheet: (usize, usize),
}

#[derive(Debug)]
struct Declaration {
    name: String,
    value: String,
    important: bool,
}

/// Nested elements: the simple selectors of each, and whether it must be a child of the previous one.
#[derive(Debug)]
struct Selector(Vec<(Vec<String>, bool)>);

/// The subject of a block while it is read.
enum Block {
    Conditional,
    Rule,
    Elsewhere,
}

impl Sheets {
    /// Reads the style sheets of a drawing.
    ///
    /// # Errors
    /// `limit.rules` if it would take too long to find the elements to which they apply.
    pub(super) fn of(document: &Document<'_>, source: &Source<'_>) -> Result<Sheets, SceneError> {
        let mut sheets = Sheets { index: Index::of(document), ..Sheets::default() };
        for node in document.descendants().filter(|node| is_drawing(*node) && node.tag_name().name() == "style") {
            let other = |name, usual: &[&str]| node.attribute(name).is_some_and(|value| !usual.contains(&value.trim()));
            if other("type", &["", "text/css"]) {
                continue;
            }
            let text: String = node.descendants().filter(Node::is_text).filter_map(|node| node.text()).collect();
            let range = node.range();
            let end = source.text[range.clone()].find('>').map_or(range.end, |k| range.start + k + 1);
            let conditional = other("media", &["", "all", "screen"]);
            sheets.read(&without_comments(&text), (range.start, end), conditional);
        }
        if let Some(last) = sheets.rules.last() {
            let elements = document.descendants().filter(Node::is_element).count() as u64;
            let words = |rule: &Rule| rule.perhaps.len() + rule.selectors.iter().map(|s| s.0.len()).sum::<usize>();
            let compared = elements.saturating_mul(sheets.rules.iter().map(words).sum::<usize>() as u64);
            RULES.check(compared).map_err(|e| source.mark(e, last.sheet.0, last.sheet.1))?;
        }
        Ok(sheets)
    }

    fn read(&mut self, text: &str, sheet: (usize, usize), conditional: bool) {
        let mut around: Vec<Block> = Vec::new();
        let mut start = 0;
        for (position, mark) in text.match_indices(['{', '}', ';']) {
            let piece = text[start..position].trim();
            start = position + 1;
            let elsewhere = around.iter().any(|block| matches!(block, Block::Elsewhere));
            match (mark, around.last()) {
                ("{", _) if elsewhere || ELSEWHERE.iter().any(|word| piece.starts_with(word)) => {
                    around.push(Block::Elsewhere);
                }
                ("{", _) if piece.starts_with('@') => around.push(Block::Conditional),
                ("{", _) => {
                    let certain = !conditional && around.is_empty();
                    self.rules.push(Rule::about(piece, certain, sheet));
                    around.push(Block::Rule);
                }
                (_, Some(Block::Rule)) => {
                    if let (Some(rule), Some(declaration)) = (self.rules.last_mut(), Declaration::read(piece)) {
                        rule.declarations.push(declaration);
                    }
                }
                // Another file could contain rules for any element.
                (";", None) if piece.starts_with("@import") => self.rules.push(Rule {
                    selectors: Vec::new(),
                    perhaps: vec!["*".into()],
                    declarations: Vec::new(),
                    sheet,
                }),
                _ => {}
            }
            if mark == "}" {
                around.pop();
            }
        }
    }

    /// The value of a property of an element: from its `style`, a sheet, or an attribute.
    pub(super) fn style<'n>(&'n self, node: Node<'n, '_>, name: &str) -> Option<&'n str> {
        self.declared(node, name).or_else(|| node.attribute(name).map(str::trim))
    }

    /// The value of a property from the `style` of an element, or from a sheet.
    pub(super) fn declared<'n>(&'n self, node: Node<'n, '_>, name: &str) -> Option<&'n str> {
        let own = node.attribute("style").and_then(|text| self.of_attribute(node, text, name));
        let own = own.map(|(value, important)| ((important, true, [0; 3], 0), value));
        let obeyed = self.obeyed(node);
        let mut best = own;
        for (weight, number) in obeyed.iter() {
            for declaration in self.rules[*number].declarations.iter().filter(|declaration| declaration.name == name) {
                let key = (declaration.important, false, *weight, *number);
                if best.is_none_or(|(least, _)| key >= least) {
                    best = Some((key, declaration.value.as_str()));
                }
            }
        }
        best.map(|(_, value)| value)
    }

    /// The value of a property in a `style`. Long styles are parsed only once, because every element in a group looks up the style of the group.
    fn of_attribute<'n>(&self, node: Node<'n, '_>, text: &'n str, name: &str) -> Option<(&'n str, bool)> {
        // If a property is given twice, the later one counts.
        let mut pieces = text.rsplit(';').filter_map(|piece| piece.split_once(':'));
        if text.len() <= LONG_STYLE {
            let (_, value) = pieces.find(|(word, _)| word.trim() == name)?;
            return Some(without_importance(value));
        }
        let mut known = self.styles.borrow_mut();
        let own = known.entry(node.id().get_usize()).or_insert_with(|| {
            let mut declarations = BTreeMap::new();
            for (word, value) in pieces {
                let from = value.as_ptr() as usize - text.as_ptr() as usize;
                declarations.entry(word.trim().to_string()).or_insert((from, from + value.len()));
            }
            declarations
        });
        let (from, to) = *own.get(name)?;
        Some(without_importance(&text[from..to]))
    }

    /// The rules that apply to an element.
    fn obeyed(&self, node: Node<'_, '_>) -> Obeyed {
        if self.rules.is_empty() {
            return Rc::from([]);
        }
        let id = node.id().get_usize();
        if let Some(known) = self.obeyed.borrow().get(&id) {
            return known.clone();
        }
        let weight = |rule: &Rule| rule.selectors.iter().filter(|s| s.is_about(node)).map(Selector::weight).max();
        let found = self.rules.iter().enumerate().filter_map(|(number, rule)| Some((weight(rule)?, number)));
        let found: Obeyed = found.collect();
        self.obeyed.borrow_mut().insert(id, found.clone());
        found
    }

    /// Whether some rule may apply to an element, but the reader cannot decide whether it does.
    ///
    /// # Errors
    /// `svg.style` for a rule that changes outlines.
    pub(super) fn may_be_about(&self, node: Node<'_, '_>, source: &Source<'_>) -> Result<bool, SceneError> {
        let mut about = false;
        for rule in self.rules.iter().filter(|rule| rule.perhaps.iter().any(|word| fits(word, node))) {
            about = true;
            let Some(declaration) =
                rule.declarations.iter().find(|declaration| changes_outlines(&declaration.name, &declaration.value))
            else {
                continue;
            };
            let error = SvgError::Style { property: visible(&declaration.name), value: visible(&declaration.value) };
            return Err(source.mark(SceneError::of(error), rule.sheet.0, rule.sheet.1));
        }
        Ok(about)
    }
}

impl Rule {
    fn about(text: &str, certain: bool, sheet: (usize, usize)) -> Rule {
        let known = |c: char| c.is_alphanumeric() || c.is_ascii_whitespace() || "-_.#*>".contains(c);
        let (mut selectors, mut perhaps) = (Vec::new(), Vec::new());
        for one in text.split(',') {
            match Selector::read(one).filter(|_| certain && one.chars().all(known)) {
                Some(selector) => selectors.push(selector),
                None => {
                    let apart = |c: char| !(c.is_alphanumeric() || "-_.#*".contains(c));
                    perhaps.extend(one.split(apart).filter(|word| !word.is_empty()).flat_map(simple));
                }
            }
        }
        Rule { selectors, perhaps, declarations: Vec::new(), sheet }
    }
}

impl Declaration {
    fn read(piece: &str) -> Option<Declaration> {
        let (name, value) = piece.split_once(':')?;
        let (value, important) = without_importance(value);
        Some(Declaration { name: name.trim().to_string(), value: value.to_string(), important })
    }
}

impl Selector {
    fn read(text: &str) -> Option<Selector> {
        let apart = text.replace('>', " > ");
        let (mut parts, mut child): (Vec<(Vec<String>, bool)>, bool) = (Vec::new(), false);
        for word in apart.split_ascii_whitespace() {
            if word == ">" {
                // A `>` needs something to its left, and must not be repeated.
                if child || parts.is_empty() {
                    return None;
                }
                child = true;
                continue;
            }
            parts.push((simple(word), child));
            child = false;
        }
        (!parts.is_empty() && !child).then_some(Selector(parts))
    }

    fn weight(&self) -> Weight {
        let mut weight = [0; 3];
        for word in self.0.iter().flat_map(|(words, _)| words) {
            match word.as_bytes() {
                [b'#', ..] => weight[0] += 1,
                [b'.', ..] => weight[1] += 1,
                b"*" => {}
                _ => weight[2] += 1,
            }
        }
        weight
    }

    fn is_about(&self, node: Node<'_, '_>) -> bool {
        let all = |words: &[String], node| words.iter().all(|word| fits(word, node));
        match self.0.as_slice() {
            [] => false,
            [(words, _)] => all(words, node),
            [.., (last, _)] if !all(last, node) => false,
            parts => {
                // From the outermost element inwards: for each part, whether it has matched any element above, and whether it has matched the parent.
                let mut lineage: Vec<Node<'_, '_>> = node.ancestors().filter(Node::is_element).collect();
                lineage.reverse();
                let (mut above, mut parent) = (vec![false; parts.len()], vec![false; parts.len()]);
                for element in lineage {
                    let met = |(k, (words, child)): (usize, &(Vec<String>, bool))| {
                        let before = k == 0 || if *child { parent[k - 1] } else { above[k - 1] };
                        before && all(words, element)
                    };
                    let here: Vec<bool> = parts.iter().enumerate().map(met).collect();
                    above.iter_mut().zip(&here).for_each(|(above, here)| *above |= here);
                    parent = here;
                }
                parent.last() == Some(&true)
            }
        }
    }
}

/// Whether a name, a `.class`, an `#id` or `*` matches an element.
fn fits(word: &str, node: Node<'_, '_>) -> bool {
    match word.as_bytes() {
        b"*" => true,
        [b'#', ..] => node.attribute("id") == Some(&word[1..]),
        [b'.', ..] => node.attribute("class").unwrap_or("").split_whitespace().any(|class| class == &word[1..]),
        _ => node.tag_name().name() == word,
    }
}

/// The simple selectors in a word such as `path.thick#left`.
fn simple(word: &str) -> Vec<String> {
    let mut found = vec![String::new()];
    for c in word.chars() {
        if ".#".contains(c) {
            found.push(String::new());
        }
        if let Some(last) = found.last_mut() {
            last.push(c);
        }
    }
    found.retain(|word| !word.is_empty());
    found
}

/// A value without `!important`, and whether the value had this mark.
fn without_importance(value: &str) -> (&str, bool) {
    let value = value.trim();
    match value.rsplit_once('!') {
        Some((before, "important")) => (before.trim(), true),
        _ => (value, false),
    }
}

fn without_comments(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once("/*") {
        out.push_str(before);
        rest = after.split_once("*/").map_or("", |(_, after)| after);
    }
    out + rest
}
