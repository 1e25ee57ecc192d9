//! The HTML format of reports: one file.

mod parts;
mod table;

use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::claim::{ClaimResult, tally};
use crate::page::{Item, Page, Section, Setting};
use crate::page_text::{CLAIMS, PROVENANCE, SETTINGS, percent_encoded};
use crate::style::is_xml;
use parts::{claim_list, files, outcome, paragraphs_html, unbroken};
use table::table_block;

impl Page {
    /// The report as one HTML file.
    #[must_use]
    pub fn to_html(&self) -> String {
        html(self)
    }
}

fn html(page: &Page) -> String {
    let mut html = html! {
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
                    div.lead { @for text in &page.lead { (paragraphs_html(text)) } }
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
    .into_string();
    html.retain(is_xml);
    html
}

fn claims(claims: &[ClaimResult]) -> Markup {
    let Some(tally) = tally(claims) else { return Markup::default() };
    html! {
        section {
            h2 { (CLAIMS) }
            table.claims {
                caption { (tally) }
                thead { tr { th scope="col" { "Result" } th scope="col" { "Claim and numbers" } } }
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
            (paragraphs_html(&section.about))
            @for item in &section.items {
                @match item {
                    Item::Text(text) => (paragraphs_html(text)),
                    Item::Figure { name, svg, caption, claim_results } => (figure(name, svg, caption, claim_results)),
                    Item::Table { table, claim_results } => (table_block(table, claim_results)),
                }
            }
        }
    }
}

fn figure(name: &str, svg: &str, caption: &str, claim_results: &[ClaimResult]) -> Markup {
    // An XML declaration before the figure is not allowed inside HTML.
    let svg = svg.find("<svg").map_or("", |start| &svg[start..]);
    let label = format!("caption-{name}");
    html! {
        figure id={ "figure-" (name) } {
            div.picture.scroll role="img" tabindex="0" aria-labelledby=(label) { (PreEscaped(svg)) }
            figcaption {
                p id=(label) { (unbroken(caption)) }
                (files("figures", name, &[("SVG", "svg"), ("PNG", "png")]))
                (claim_list(claim_results))
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
mod tests {
    use super::*;
    use crate::samples;

    fn bare() -> Page {
        Page {
            warning: None,
            claims: vec![],
            sections: vec![],
            settings: vec![],
            provenance: vec![],
            ..samples::page()
        }
    }

    /// All values of an attribute.
    fn values<'a>(html: &'a str, attribute: &str) -> Vec<&'a str> {
        html.split(&format!(" {attribute}=\"")).skip(1).filter_map(|rest| rest.split('"').next()).collect()
    }

    #[test]
    fn every_link_has_a_target_and_ids_are_unique() {
        let html = html(&samples::page());
        let ids = values(&html, "id");
        assert!(ids.iter().enumerate().all(|(i, id)| !ids[..i].contains(id)), "{ids:?}");
        for link in values(&html, "href").iter().filter_map(|href| href.strip_prefix('#')) {
            let matches = |id: &&str| percent_encoded(&id.replace("&quot;", "\"")) == link;
            assert!(ids.iter().any(matches), "{link} is not in {ids:?}");
        }
        for label in values(&html, "aria-labelledby") {
            assert!(ids.contains(&label), "{label}");
        }
    }

    #[test]
    fn the_page_runs_no_script_and_fetches_nothing() {
        let html = html(&samples::page())
            .replace(&samples::svg()[samples::svg().find("<svg").expect("an SVG")..], "");
        for markup in ["<script", "http://", "https://", "@import", "url(", " src=", "<link", "<?xml"] {
            assert!(!html.contains(markup), "{markup}");
        }
        for href in values(&html, "href") {
            assert!(["#", "figures/", "tables/"].iter().any(|start| href.starts_with(start)), "{href}");
        }
        assert!(html.contains("figures/fig%209.svg") && html.contains("tables/table2.csv"));
    }

    #[test]
    fn text_is_escaped_and_figures_are_inserted() {
        let html = html(&samples::page());
        for markup in ["<of>", "<b>more", "<two>", "<each>", "<x>", "<i>", "<I>", "<last>", "<1>"] {
            assert!(!html.contains(markup), "{markup}");
        }
        assert!(html.contains("<h1>A &quot;report&quot; &lt;of&gt; us</h1>"));
        assert!(html.contains("<svg xmlns=") && html.contains("<rect/></svg>"));
        assert!(html.contains("<p>1. Two &lt;two&gt; is long.</p>"));
        assert!(html.contains("3.4\u{a0}\u{b1}\u{a0}1.2"), "the half width stays on the line of its mean");
    }

    #[test]
    fn means_align_in_a_column() {
        let html = html(&samples::page());
        let first = "99.4<span class=\"half\" style=\"min-width:5ch\"> \u{b1} 0.8</span>";
        assert!(html.contains(first), "{html}");
        assert!(html.contains("\u{2013}<span class=\"half\" style=\"min-width:5ch\"></span>"));
        assert!(html.contains("<th scope=\"row\" class=\"words\">DQN</th>"));
        assert!(html.contains("Success <span class=\"unit\">(%)</span>"));
    }

    #[test]
    fn an_empty_page_is_valid_and_reproducible() {
        let html = html(&bare());
        assert!(html.starts_with("<!DOCTYPE html><html lang=\"en\">") && html.ends_with("</html>"));
        assert!(!html.contains("Warning") && !html.contains(SETTINGS) && !html.contains(PROVENANCE));
        assert_eq!(html, super::html(&bare()));
    }
}
