//! `docs/verification.md` describes every case as the table does.

use opruga_verify::cases;

#[test]
fn the_page_tells_of_every_case_as_it_is() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/verification.md");
    let page = std::fs::read_to_string(path).expect("docs/verification.md");
    let mut lines = page.lines().filter(|line| line.starts_with("| `"));
    for case in cases() {
        let line = lines.next().unwrap_or_default();
        let escaped = |text: &str| text.replace('|', "\\|");
        let expected = format!(
            "| `{}` | {} | {} | {} |",
            case.name,
            escaped(case.quantity),
            escaped(case.source),
            case.passes_when()
        );
        assert!(
            line.starts_with(&expected),
            "`opruga verify --report` makes the tables anew\nis:     {line}\nshould: {expected}"
        );
    }
    assert_eq!(lines.next(), None, "a case that is no more");
    for (what, why) in opruga_verify::LEFT_OUT {
        assert!(page.contains(&format!("* {what}: {why}.")), "{what}");
    }
}
