//! The flag tables of docs/command-line.md, generated from the clap definitions.

use std::fmt::Write as _;

use clap::{Arg, CommandFactory};

use super::Arguments;

#[test]
fn the_flag_tables_in_the_docs_match_the_command_line() {
    crate::generated_section::check("docs/command-line.md", &tables());
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
    let names = arg.get_value_names().filter(|_| arg.get_action().takes_values());
    let is_optional = arg.get_num_args().is_some_and(|count| count.min_values() == 0);
    let in_brackets = |name| if is_optional { format!(" [<{name}>]") } else { format!(" <{name}>") };
    let value = names.unwrap_or_default().first().map(in_brackets);
    let ellipsis = if arg.get_num_args().is_some_and(|count| count.max_values() > 1) { "..." } else { "" };
    format!("--{}{}{ellipsis}", arg.get_long().unwrap_or_default(), value.unwrap_or_default())
}

/// The help text with its default, escaped for a Markdown table.
fn meaning(arg: &Arg) -> String {
    let help = arg.get_help().map(ToString::to_string).unwrap_or_default();
    let default = arg.get_default_values().first().filter(|_| arg.get_action().takes_values());
    let default = default.map(|value| format!(" [default: {}]", value.to_string_lossy()));
    (help + &default.unwrap_or_default()).replace('<', "\\<").replace('|', "\\|")
}
