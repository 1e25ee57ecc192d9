//! Tests of the sections of `docs/` that are generated from the code. Two markers enclose such a section.
//!
//! A test fails if its section is out of date. With `WAYFIELD_RENEW` set, it rewrites the section instead.

use std::path::Path;

const RENEW_COMMAND: &str = "cargo xtask docs";
const END: &str = "<!-- end generated -->";

/// Checks that the generated section of `page`, a path below the repository's root, is `text`; or rewrites it.
///
/// # Panics
/// The section is out of date, or the page cannot be read or has no markers.
pub fn check(page: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(page);
    let begin = format!("<!-- generated: {RENEW_COMMAND} -->");
    let old = std::fs::read_to_string(&path).expect("the page exists");
    let (before, rest) = old.split_once(&begin).expect("the page marks where the section begins");
    let (_, after) = rest.split_once(END).expect("the page marks where the section ends");
    let renewed = format!("{before}{begin}\n{text}\n{END}{after}");
    if std::env::var_os("WAYFIELD_RENEW").is_some() {
        std::fs::write(path, renewed).expect("the page can be written");
    } else {
        assert!(old == renewed, "{page} is out of date; help: run `{RENEW_COMMAND}`");
    }
}
