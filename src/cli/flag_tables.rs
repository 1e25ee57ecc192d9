//! The flag tables of docs/command-line.md, generated from the clap definitions.
//!
//! The test fails if the tables are out of date. With `WAYFIELD_RENEW` set, it rewrites them instead.

use std::fmt::Write as _;

use clap::{Arg, CommandFactory};

use super::Arguments;

const PAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/command-line.md");
const RENEW_COMMAND: &str = "cargo xtask docs";
const END: &str = "<!-- end generated -->";

#[test]
fn the_flag_tables_in_the_docs_match_the_command_line() {
    let begin = format!("<!-- generated: {RENEW_COMMAND} -->");
    let page = std::fs::read_to_string(PAGE).expect("docs/command-line.md exists");
    let (before, rest) = page.split_once(&begin).expect("the page marks where the tables begin");
    let (_, after) = rest.split_once(END).expect("the page marks where the tables end");
    let renewed = format!("{before}{begin}\n{}\n{END}{after}", tables());
    if std::env::var_os("WAYFIELD_RENEW").is_some() {
        std::fs::write(PAGE, renewed).expect("the page can be written");
    } else {
        assert!(page == renewed, "docs/command-line.md is out of date; help: run `{RENEW_COMMAND}`");
    }
}

/// The Markdown tables, one per help heading.
fn tables() -> String {
    let command = Arguments::command();
    let (mut text, mut heading) = (String::new(), None);
    for arg in command.get_arguments() {
        if arg.get_help_heading() != heading {
            heading = arg.get_help_heading();
            let _ = write!(text, "\n### {}\n\n| flag | meaning |\n|---|---|\n", heading.unwrap_or_default());
        }
        let _ = writeln!(text, "| `{}` | {} |", flag(arg), meaning(arg));
    }
    text
}

/// The flag with its value, as in `--seed <N>`.
fn flag(arg: &Arg) -> String {
    let value = arg.get_value_names().unwrap_or_default().first().map(|name| format!(" <{name}>"));
    let ellipsis = if arg.get_num_args().is_some_and(|count| count.max_values() > 1) { "..." } else { "" };
    format!("--{}{}{ellipsis}", arg.get_long().unwrap_or_default(), value.unwrap_or_default())
}

/// The help text with its default, escaped for a Markdown table.
fn meaning(arg: &Arg) -> String {
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let default = arg.get_default_values().first().filter(|_| arg.get_value_names().is_some());
    let default = default.map(|value| format!(" [default: {}]", value.to_string_lossy()));
    (help + &default.unwrap_or_default()).replace('<', "\\<").replace('|', "\\|")
}
