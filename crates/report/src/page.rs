//! The report as one HTML page, and what a report is made of.
//!
//! In: a [`Page`]: paragraphs, verdicts on claims, figures as SVG, tables. Out: the text of one HTML file that
//! opens anywhere: its style is in it, its figures are in it, it runs nothing and fetches nothing. The files
//! beside it (`figures/`, `tables/`) are only linked to. `markdown` writes the same page for a repository.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::table::{Cell, Column, ColumnKind, OutcomeCell, Table};

/// A report. All text in it is plain: whatever looks like markup is shown as it stands.
#[derive(Clone, Debug, PartialEq)]
pub struct Page {
    /// The title.
    pub title: String,
    /// What a reader should know first, in paragraphs.
    pub lead: Vec<String>,
    /// Why the report must not be taken at its word, if so: shown before all else.
    pub warning: Option<String>,
    /// The summary: a row for each claim of the paper.
    pub claims: Vec<ClaimResult>,
    /// The body.
    pub sections: Vec<Section>,
    /// The settings that were used, to the letter.
    pub settings: Vec<Setting>,
    /// How the report came about, as name and value: version, machine, seeds, command, date.
    pub provenance: Vec<(String, String)>,
}

/// A part of the body under a heading.
#[derive(Clone, Debug, PartialEq)]
pub struct Section {
    /// What links lead to; no two sections share it, and none is called `settings` or `provenance`.
    pub id: String,
    /// The heading.
    pub heading: String,
    /// What the section is about; a blank line parts paragraphs.
    pub about: String,
    /// What it shows, in order.
    pub items: Vec<Item>,
}

/// What a section shows.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// Words; a blank line parts paragraphs.
    Text(String),
    /// A picture, which also lies in `figures/` as `.svg` and `.png`.
    Figure {
        /// Stem of its files' names, such as `fig9`.
        name: String,
        /// The picture: trusted markup, put in as it is.
        svg: String,
        /// What it shows.
        caption: String,
        /// What it says of the paper's claims.
        claim_results: Vec<ClaimResult>,
    },
    /// A table, which also lies in `tables/` as `.csv` and `.md`.
    Table {
        /// The table.
        table: Table,
        /// What it says of the paper's claims.
        claim_results: Vec<ClaimResult>,
    },
}

/// What the data say of a claim.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClaimResult {
    /// The claim.
    pub claim: String,
    /// What became of it.
    pub outcome: OutcomeCell,
    /// The finding behind the outcome, in a sentence of numbers.
    pub sentence: String,
    /// The [`Section::id`] where it is shown.
    pub anchor: String,
}

/// Settings to the letter.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setting {
    /// What they set.
    pub heading: String,
    /// Their text, in RON, shown as it stands.
    pub ron: String,
}

/// The page as one HTML file.
pub fn html(page: &Page) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="color-scheme" content="light dark";
                title { (page.title) }
                style { (PreEscaped(include_str!("page.css"))) }
            }
            body {
                header {
                    h1 { (page.title) }
                    @if let Some(warning) = &page.warning {
                        p.warning role="note" { strong { "Warning: " } (warning) }
                    }
                    div.lead { @for text in &page.lead { (words(text)) } }
                }
                main {
                    (claims(&page.claims))
                    (contents(page))
                    @for one in &page.sections { (section(one)) }
                    @if !page.settings.is_empty() { (settings(&page.settings)) }
                    @if !page.provenance.is_empty() { (provenance(&page.provenance)) }
                }
            }
        }
    }
    .into_string()
}

/// Heading over the summary.
pub(super) const CLAIMS: &str = "The claims, one by one";
/// Heading over the settings.
pub(super) const SETTINGS: &str = "Exact settings";
/// Heading over the provenance.
pub(super) const PROVENANCE: &str = "How this report was made";

/// The paragraphs of a text: what blank lines part.
pub(super) fn paragraphs(text: &str) -> impl Iterator<Item = String> {
    let mut parts = vec![String::new()];
    for line in text.lines().map(str::trim) {
        match parts.last_mut() {
            Some(part) if !line.is_empty() => {
                if !part.is_empty() {
                    part.push(' ');
                }
                part.push_str(line);
            }
            _ => parts.push(String::new()),
        }
    }
    parts.into_iter().filter(|part| !part.is_empty())
}

/// How many claims had which outcome, in a sentence; nothing of no claims.
pub(super) fn tally(claims: &[ClaimResult]) -> Option<String> {
    let count = |outcome| claims.iter().filter(|claim| claim.outcome == outcome).count();
    let counts: Vec<_> = [OutcomeCell::Held, OutcomeCell::NotShown, OutcomeCell::Reversed]
        .into_iter()
        .filter(|&outcome| count(outcome) > 0)
        .map(|outcome| format!("{} {}", count(outcome), outcome.word()))
        .collect();
    let all = if claims.len() == 1 { "1 claim".to_owned() } else { format!("{} claims", claims.len()) };
    (!claims.is_empty()).then(|| format!("{all}: {}.", counts.join(", ")))
}

/// The address of a file beside the page, as a link writes it.
pub(super) fn relative_url(folder: &str, name: &str, extension: &str) -> String {
    format!("{folder}/{}.{extension}", percent_encoded(name))
}

/// A name as a link writes it.
pub(super) fn percent_encoded(name: &str) -> String {
    let mut text = String::new();
    for byte in name.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' => text.push(char::from(byte)),
            _ => text.push_str(&format!("%{byte:02X}")),
        }
    }
    text
}

fn words(text: &str) -> Markup {
    html! { @for paragraph in paragraphs(text) { p { (unbroken(&paragraph)) } } }
}

/// A sentence whose lines do not break beside a `±` or before a `%`.
fn unbroken(text: &str) -> String {
    text.replace(" \u{b1} ", "\u{a0}\u{b1}\u{a0}").replace(" %", "\u{a0}%")
}

fn claims(claims: &[ClaimResult]) -> Markup {
    let Some(tally) = tally(claims) else { return Markup::default() };
    html! {
        section {
            h2 { (CLAIMS) }
            table.claims {
                caption { (tally) }
                thead { tr { th scope="col" { "Outcome" } th scope="col" { "Claim and finding" } } }
                tbody {
                    @for one in claims {
                        tr {
                            td { (outcome(one.outcome)) }
                            td {
                                a href={ "#" (percent_encoded(&one.anchor)) } { (one.claim) }
                                p { (unbroken(&one.sentence)) }
                            }
                        }
                    }
                }
            }
        }
    }
}

fn contents(page: &Page) -> Markup {
    html! {
        nav aria-label="Contents" {
            h2 { "Contents" }
            ol {
                @for one in &page.sections { li { a href={ "#" (percent_encoded(&one.id)) } { (one.heading) } } }
                @if !page.settings.is_empty() { li { a href="#settings" { (SETTINGS) } } }
                @if !page.provenance.is_empty() { li { a href="#provenance" { (PROVENANCE) } } }
            }
        }
    }
}

fn section(section: &Section) -> Markup {
    html! {
        section id=(section.id) {
            h2 { (section.heading) }
            (words(&section.about))
            @for item in &section.items {
                @match item {
                    Item::Text(text) => (words(text)),
                    Item::Figure { name, svg, caption, claim_results } => (figure(name, svg, caption, claim_results)),
                    Item::Table { table, claim_results } => (table_block(table, claim_results)),
                }
            }
        }
    }
}

fn figure(name: &str, svg: &str, caption: &str, claim_results: &[ClaimResult]) -> Markup {
    // Anything before the picture itself, as an XML declaration, has no place inside a page.
    let svg = svg.find("<svg").map_or("", |start| &svg[start..]);
    let label = format!("caption-{name}");
    html! {
        figure id={ "figure-" (name) } {
            div.picture.scroll role="img" tabindex="0" aria-labelledby=(label) { (PreEscaped(svg)) }
            figcaption {
                p id=(label) { (unbroken(caption)) }
                (files("figures", name, &[("SVG", "svg"), ("PNG", "png")]))
                (findings(claim_results))
            }
        }
    }
}

fn table_block(table: &Table, claim_results: &[ClaimResult]) -> Markup {
    let label = format!("caption-{}", table.name);
    let halves: Vec<_> = (0..table.columns.len()).map(|i| half_length(table, i)).collect();
    html! {
        div.table id={ "table-" (table.name) } {
            div.scroll role="region" tabindex="0" aria-labelledby=(label) {
                table {
                    caption id=(label) { span { (table.title) } }
                    thead { tr { @for column in &table.columns { (heading(column)) } } }
                    tbody {
                        @for row in &table.rows {
                            tr {
                                @for (i, (column, half)) in table.columns.iter().zip(&halves).enumerate() {
                                    (cell(Table::cell(row, i), column.kind, *half, i == 0))
                                }
                            }
                        }
                    }
                }
            }
            @if !table.notes.is_empty() {
                ul.notes { @for note in &table.notes { li { (unbroken(note)) } } }
            }
            (files("tables", &table.name, &[("CSV", "csv"), ("Markdown", "md")]))
            (findings(claim_results))
        }
    }
}

/// Letters in a column's longest half width.
fn half_length(table: &Table, column: usize) -> usize {
    let halves = table.rows.iter().filter_map(|row| Table::cell(row, column).half_width());
    halves.map(|half| half.chars().count()).max().unwrap_or(0)
}

fn class(kind: ColumnKind) -> &'static str {
    match kind {
        ColumnKind::Text => "words",
        ColumnKind::Number => "number",
    }
}

fn heading(column: &Column) -> Markup {
    html! {
        th scope="col" class=(class(column.kind)) {
            (column.heading)
            @if !column.unit.is_empty() { " " span.unit { "(" (column.unit) ")" } }
        }
    }
}

/// A cell of a table. In a column with half widths all cells give them the same room, so that the means align.
fn cell(cell: &Cell, kind: ColumnKind, half_length: usize, first: bool) -> Markup {
    let content = html! {
        @if let Cell::ClaimResult(what) = cell { (outcome(*what)) } @else { (cell.value_text()) }
        @if half_length > 0 && kind == ColumnKind::Number {
            span.half style={ "min-width:" (half_length + 2) "ch" } {
                @if let Some(half) = cell.half_width() { " \u{b1} " (half) }
            }
        }
        @else if let Some(half) = cell.half_width() { " \u{b1} " (half) }
    };
    html! {
        @if first {
            th scope="row" class=(class(kind)) { (content) }
        } @else {
            td class=(class(kind)) { (content) }
        }
    }
}

fn outcome(outcome: OutcomeCell) -> Markup {
    let class = match outcome {
        OutcomeCell::Held => "held",
        OutcomeCell::NotShown => "not-shown",
        OutcomeCell::Reversed => "reversed",
    };
    html! { span.outcome.(class) { span aria-hidden="true" { (outcome.glyph()) } " " (outcome.word()) } }
}

/// Links to the files of a figure or table.
fn files(folder: &str, name: &str, kinds: &[(&str, &str)]) -> Markup {
    html! {
        p.files {
            @for (i, (label, extension)) in kinds.iter().enumerate() {
                @if i > 0 { " \u{b7} " }
                a href=(relative_url(folder, name, extension)) { (label) }
            }
        }
    }
}

/// What a figure or table says of the claims.
fn findings(claim_results: &[ClaimResult]) -> Markup {
    html! {
        @if !claim_results.is_empty() {
            ul.findings {
                @for claim_result in claim_results {
                    li {
                        (outcome(claim_result.outcome)) " " em { (claim_result.claim) }
                        p { (unbroken(&claim_result.sentence)) }
                    }
                }
            }
        }
    }
}

fn settings(settings: &[Setting]) -> Markup {
    html! {
        section #settings {
            h2 { (SETTINGS) }
            @for setting in settings {
                details { summary { (setting.heading) } pre tabindex="0" { code { (setting.ron) } } }
            }
        }
    }
}

fn provenance(provenance: &[(String, String)]) -> Markup {
    html! {
        section #provenance {
            h2 { (PROVENANCE) }
            table.provenance {
                tbody {
                    @for (name, value) in provenance { tr { th scope="row" { (name) } td { (value) } } }
                }
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::super::table::tests::sample as table;
    use super::*;

    fn claim_result(outcome: OutcomeCell, anchor: &str) -> ClaimResult {
        ClaimResult {
            claim: "A < B & C".into(),
            outcome,
            sentence: "3.4 \u{b1} 1.2 | <b>more</b>.".into(),
            anchor: anchor.into(),
        }
    }

    fn svg() -> String {
        let xmlns = "http://www.w3.org/2000/svg";
        format!(r#"<?xml version="1.0"?><svg xmlns="{xmlns}" viewBox="0 0 9 9"><rect/></svg>"#)
    }

    /// A page with one of everything, and with markup in all its words.
    pub fn sample() -> Page {
        let figure = Item::Figure {
            name: "fig 9".into(),
            svg: svg(),
            caption: "Return <script>alert(1)</script>".into(),
            claim_results: vec![claim_result(OutcomeCell::Held, "fig9")],
        };
        let section = |id: &str, items| Section {
            id: id.into(),
            heading: "Scenario & <I>".into(),
            about: "One.\n\n1. Two <two>\nis long.".into(),
            items,
        };
        Page {
            title: "A \"report\" <of> us".into(),
            lead: vec!["# First & <last>.".into()],
            warning: Some("Only 2 seeds <each>.".into()),
            claims: vec![
                claim_result(OutcomeCell::Held, "fig9"),
                claim_result(OutcomeCell::Reversed, "table \"2\""),
                claim_result(OutcomeCell::Held, "fig9"),
            ],
            sections: vec![
                section("fig9", vec![Item::Text("Words.".into()), figure]),
                section("table \"2\"", vec![Item::Table { table: table(), claim_results: vec![] }]),
            ],
            settings: vec![Setting { heading: "DQN <1>".into(), ron: "(a: \"<x> & ```\")\n".into() }],
            provenance: vec![("Command".into(), "wayfield <x> && y".into())],
        }
    }

    fn bare() -> Page {
        Page {
            warning: None,
            claims: vec![],
            sections: vec![],
            settings: vec![],
            provenance: vec![],
            ..sample()
        }
    }

    /// What an attribute is set to, each time.
    fn values<'a>(html: &'a str, attribute: &str) -> Vec<&'a str> {
        html.split(&format!(" {attribute}=\"")).skip(1).filter_map(|rest| rest.split('"').next()).collect()
    }

    #[test]
    fn every_link_leads_somewhere_and_no_id_is_there_twice() {
        let html = html(&sample());
        let ids = values(&html, "id");
        assert!(ids.iter().enumerate().all(|(i, id)| !ids[..i].contains(id)), "{ids:?}");
        for link in values(&html, "href").iter().filter_map(|href| href.strip_prefix('#')) {
            let leads = |id: &&str| percent_encoded(&id.replace("&quot;", "\"")) == link;
            assert!(ids.iter().any(leads), "{link} is none of {ids:?}");
        }
        for label in values(&html, "aria-labelledby") {
            assert!(ids.contains(&label), "{label}");
        }
    }

    #[test]
    fn nothing_is_run_or_fetched() {
        let html = html(&sample()).replace(&svg()[svg().find("<svg").expect("a picture")..], "");
        for word in ["<script", "http://", "https://", "@import", "url(", " src=", "<link", "<?xml"] {
            assert!(!html.contains(word), "{word}");
        }
        for href in values(&html, "href") {
            assert!(["#", "figures/", "tables/"].iter().any(|start| href.starts_with(start)), "{href}");
        }
        assert!(html.contains("figures/fig%209.svg") && html.contains("tables/table2.csv"));
    }

    #[test]
    fn words_are_words_and_the_picture_is_a_picture() {
        let html = html(&sample());
        for markup in ["<of>", "<b>more", "<two>", "<each>", "<x>", "<i>", "<I>", "<last>", "<1>"] {
            assert!(!html.contains(markup), "{markup}");
        }
        assert!(html.contains("<h1>A &quot;report&quot; &lt;of&gt; us</h1>"));
        assert!(html.contains("<svg xmlns=") && html.contains("<rect/></svg>"));
        assert!(html.contains("<p>1. Two &lt;two&gt; is long.</p>"));
        assert!(html.contains("3.4\u{a0}\u{b1}\u{a0}1.2"), "a half width stays with its mean");
    }

    #[test]
    fn the_summary_counts() {
        assert_eq!(tally(&sample().claims).as_deref(), Some("3 claims: 2 held, 1 reversed."));
        assert_eq!(
            tally(&[claim_result(OutcomeCell::NotShown, "")]).as_deref(),
            Some("1 claim: 1 not shown.")
        );
        assert_eq!(tally(&[]), None);
    }

    #[test]
    fn means_align_in_a_table() {
        let html = html(&sample());
        let first = "99.4<span class=\"half\" style=\"min-width:5ch\"> \u{b1} 0.8</span>";
        assert!(html.contains(first), "{html}");
        assert!(html.contains("\u{2013}<span class=\"half\" style=\"min-width:5ch\"></span>"));
        assert!(html.contains("<th scope=\"row\" class=\"words\">DQN</th>"));
        assert!(html.contains("Success <span class=\"unit\">(%)</span>"));
    }

    #[test]
    fn a_bare_page_is_a_page_and_the_same_one_each_time() {
        let html = html(&bare());
        assert!(html.starts_with("<!DOCTYPE html><html lang=\"en\">") && html.ends_with("</html>"));
        assert!(!html.contains("Warning") && !html.contains(SETTINGS) && !html.contains(PROVENANCE));
        assert_eq!(html, super::html(&bare()));
    }
}
