//! Reports and tables as GitHub-flavoured Markdown. Markup characters in names and sentences are escaped.

use crate::claim::{ClaimResult, tally};
use crate::page::{Item, Page, Section, Setting};
use crate::page_text::{CLAIMS, PROVENANCE, SETTINGS, paragraphs, percent_encoded, relative_url};
use crate::style::is_xml;
use crate::table::{Column, ColumnKind, Table};

impl Table {
    /// The table as GitHub-flavoured Markdown: the title, the rows, and the notes as a list.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let cell = |row, i| escaped(&Table::cell(row, i).text());
        let rows: Vec<Vec<String>> =
            self.rows.iter().map(|row| (0..self.columns.len()).map(|i| cell(row, i)).collect()).collect();
        let mut blocks = vec![format!("**{}**", escaped(&self.title)), markdown_table(&self.columns, &rows)];
        if !self.notes.is_empty() {
            blocks.push(list(self.notes.iter().map(|note| line_start(note))));
        }
        document(&blocks)
    }
}

impl Page {
    /// The report as GitHub-flavoured Markdown.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        page_markdown(self)
    }
}

fn page_markdown(page: &Page) -> String {
    let mut blocks = vec![format!("# {}", escaped(&page.title))];
    blocks.extend(page.warning.iter().map(|warning| format!("> **Warning:** {}", escaped(warning))));
    blocks.extend(page.lead.iter().flat_map(|text| escaped_paragraphs(text)));
    blocks.extend(claims(&page.claims));
    for section in &page.sections {
        add_section(&mut blocks, section);
    }
    if !page.settings.is_empty() {
        blocks.push(format!("## {SETTINGS}"));
        blocks.extend(page.settings.iter().map(setting));
    }
    if !page.provenance.is_empty() {
        blocks.push(format!("## {PROVENANCE}"));
        blocks.push(list(page.provenance.iter().map(|(n, v)| format!("**{}:** {}", escaped(n), escaped(v)))));
    }
    document(&blocks)
}

fn claims(claims: &[ClaimResult]) -> Vec<String> {
    let Some(tally) = tally(claims) else { return Vec::new() };
    let rows: Vec<_> = claims
        .iter()
        .map(|result| {
            let claim = format!("[{}](#{})", escaped(&result.claim), percent_encoded(&result.anchor));
            vec![outcome_text(result), claim, escaped(&result.sentence)]
        })
        .collect();
    let columns = ["Result", "Claim", "Numbers"].map(text_column);
    vec![format!("## {CLAIMS}"), tally, markdown_table(&columns, &rows)]
}

fn add_section(blocks: &mut Vec<String>, section: &Section) {
    // GitHub derives anchors from headings, but the links use the section's id.
    blocks.push(format!("<a id=\"{}\"></a>", escaped_html(&section.id)));
    blocks.push(format!("## {}", escaped(&section.heading)));
    blocks.extend(escaped_paragraphs(&section.about));
    for item in &section.items {
        match item {
            Item::Text(text) => blocks.extend(escaped_paragraphs(text)),
            Item::Figure { name, caption, claim_results, .. } => {
                let (svg, png) = (relative_url("figures", name, "svg"), relative_url("figures", name, "png"));
                blocks.push(format!("![{}]({svg})", escaped(name)));
                blocks.push(format!("{} ([SVG]({svg}), [PNG]({png}))", line_start(caption)));
                blocks.extend(claim_list(claim_results));
            }
            Item::Table { table, claim_results } => {
                let (csv, md) =
                    (relative_url("tables", &table.name, "csv"), relative_url("tables", &table.name, "md"));
                blocks.push(table.to_markdown().trim_end().to_owned());
                blocks.push(format!("([CSV]({csv}), [Markdown]({md}))"));
                blocks.extend(claim_list(claim_results));
            }
        }
    }
}

fn claim_list(claim_results: &[ClaimResult]) -> Option<String> {
    let line = |result: &ClaimResult| {
        format!(
            "{}: *{}*\\\n  {}",
            outcome_text(result),
            escaped(&result.claim),
            line_start(&result.sentence)
        )
    };
    (!claim_results.is_empty()).then(|| list(claim_results.iter().map(line)))
}

fn outcome_text(claim_result: &ClaimResult) -> String {
    format!("{}\u{a0}{}", claim_result.outcome.glyph(), claim_result.outcome.word().replace(' ', "\u{a0}"))
}

fn setting(setting: &Setting) -> String {
    let longest = setting.ron.split(|c| c != '`').map(str::len).max().unwrap_or(0);
    let fence = "`".repeat((longest + 1).max(3));
    format!(
        "<details><summary>{}</summary>\n\n{fence}ron\n{}\n{fence}\n\n</details>",
        escaped_html(&setting.heading),
        setting.ron.trim_end(),
    )
}

/// The Markdown document of `blocks`, separated by blank lines.
fn document(blocks: &[String]) -> String {
    let mut text = blocks.join("\n\n") + "\n";
    text.retain(is_xml);
    text
}

fn list(lines: impl Iterator<Item = String>) -> String {
    lines.map(|line| format!("- {line}")).collect::<Vec<_>>().join("\n")
}

fn escaped_paragraphs(text: &str) -> Vec<String> {
    paragraphs(text).map(|paragraph| line_start(&paragraph)).collect()
}

fn text_column(heading: &str) -> Column {
    Column { heading: heading.to_owned(), unit: String::new(), kind: ColumnKind::Text }
}

/// A Markdown table with aligned columns. The cells must already be escaped.
fn markdown_table(columns: &[Column], rows: &[Vec<String>]) -> String {
    let headings: Vec<_> = columns.iter().map(|column| escaped(&column.text())).collect();
    let lines = || std::iter::once(&headings).chain(rows);
    let width = |i: usize| lines().map(|line| line[i].chars().count()).max().unwrap_or(0).max(3);
    let widths: Vec<_> = (0..columns.len()).map(width).collect();
    let row = |line: &Vec<String>| {
        let cells = line.iter().zip(columns).zip(&widths).map(|((text, column), &width)| match column.kind {
            ColumnKind::Text => format!(" {text:<width$} |"),
            ColumnKind::Number => format!(" {text:>width$} |"),
        });
        format!("|{}", cells.collect::<String>())
    };
    let rules = columns.iter().zip(&widths).map(|(column, width)| match column.kind {
        ColumnKind::Text => format!(" {} |", "-".repeat(*width)),
        ColumnKind::Number => format!(" {}: |", "-".repeat(width - 1)),
    });
    let rule = format!("|{}", rules.collect::<String>());
    let mut lines: Vec<_> = lines().map(row).collect();
    lines.insert(1, rule);
    lines.join("\n")
}

/// `text` on one line. Escapes all characters that are markup anywhere in a line.
fn escaped(text: &str) -> String {
    let mut result = String::new();
    for c in single_line(text).chars() {
        match c {
            '&' => result.push_str("&amp;"),
            '<' => result.push_str("&lt;"),
            '\\' | '`' | '*' | '_' | '[' | ']' | '|' | '~' | '$' => result.extend(['\\', c]),
            _ => result.push(c),
        }
    }
    result
}

/// `text` escaped for the start of a line, where `#`, `-` and `1.` are markup too.
fn line_start(text: &str) -> String {
    let text = escaped(text);
    let digits = text.bytes().take_while(u8::is_ascii_digit).count();
    let (number, rest) = text.split_at(digits);
    let numbered = digits > 0 && (rest.len() == 1 || rest.as_bytes().get(1) == Some(&b' '));
    match rest.chars().next() {
        Some('#' | '-' | '+' | '=' | '>') if digits == 0 => format!("\\{text}"),
        Some('.' | ')') if numbered => format!("{number}\\{rest}"),
        _ => text,
    }
}

/// `text` on one line, escaped for an HTML element or attribute.
fn escaped_html(text: &str) -> String {
    maud::html! { (single_line(text)) }.into_string()
}

/// `text` with line breaks and runs of spaces replaced by single spaces. Non-breaking spaces are kept.
fn single_line(text: &str) -> String {
    text.split_ascii_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples::{page, table};

    /// The number of cell separators, without escaped bars.
    fn separators(line: &str) -> usize {
        line.replace("\\|", "").matches('|').count()
    }

    #[test]
    fn a_table_has_aligned_columns() {
        let text = table().to_markdown();
        let lines: Vec<_> = text.lines().filter(|line| line.starts_with('|')).collect();
        assert_eq!(lines.len(), 4);
        let length = lines[0].chars().count();
        for line in &lines {
            assert_eq!((separators(line), line.chars().count()), (6, length), "{line}");
        }
        assert!(lines[1].starts_with("| ---") && lines[1].contains("-: |"));
        assert!(lines[2].contains("a \\| b, &lt;i>") && lines[2].contains(" 99.4 \u{b1} 0.8 |"));
        assert!(lines[3].contains(" > 1,800"));
        assert!(text.starts_with("**Success &amp; time**\n\n|"));
        assert!(text.ends_with("|\n\n- Mean of 5 seeds &lt;each>.\n"));
    }

    #[test]
    fn a_page_has_all_its_parts_with_escaped_text() {
        let text = page().to_markdown();
        assert!(text.starts_with("# A \"report\" &lt;of> us\n\n> **Warning:** Only 2 seeds &lt;each>.\n"));
        for part in [
            "\n\\# First &amp; &lt;last>.\n",
            "\n1\\. Two &lt;two> is long.\n",
            "[A &lt; B &amp; C](#table%20%222%22)",
            "<a id=\"table &quot;2&quot;\"></a>",
            "![fig 9](figures/fig%209.svg)",
            "[PNG](figures/fig%209.png)",
            "[CSV](tables/table2.csv)",
            "<summary>DQN &lt;1&gt;</summary>",
            "\n````ron\n(a: \"<x> & ```\")\n````\n",
            "- **Command:** wayfield &lt;x> &amp;&amp; y\n",
        ] {
            assert!(text.contains(part), "{part} is not in\n{text}");
        }
        assert!(!text.contains("<script") && !text.contains("<svg"));
        assert_eq!(text, page().to_markdown(), "the text is reproducible");
    }

    #[test]
    fn only_markup_is_escaped() {
        assert_eq!(line_start("96.8 of 100"), "96.8 of 100");
        assert_eq!(line_start("1. one"), "1\\. one");
        assert_eq!(line_start("7)"), "7\\)");
        assert_eq!(line_start("- x"), "\\- x");
        assert_eq!(line_start("2023"), "2023");
        assert_eq!(line_start(""), "");
        assert_eq!(escaped("a_b *c* `d`\n e\u{a0}f"), "a\\_b \\*c\\* \\`d\\` e\u{a0}f");
    }
}
