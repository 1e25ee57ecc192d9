//! HTML fragments that several parts of the page use: text, outcomes, claim results and links to files.

use maud::{Markup, html};

use crate::claim::{ClaimOutcome, ClaimResult};
use crate::page_text::{paragraphs, relative_url};

pub(super) fn paragraphs_html(text: &str) -> Markup {
    html! { @for paragraph in paragraphs(text) { p { (unbroken(&paragraph)) } } }
}

/// The text with non-breaking spaces around `±` and before `%`.
pub(super) fn unbroken(text: &str) -> String {
    text.replace(" \u{b1} ", "\u{a0}\u{b1}\u{a0}").replace(" %", "\u{a0}%")
}

pub(super) fn outcome(outcome: ClaimOutcome) -> Markup {
    let class = match outcome {
        ClaimOutcome::Held => "held",
        ClaimOutcome::NotShown => "not-shown",
        ClaimOutcome::Reversed => "reversed",
    };
    html! { span.outcome.(class) { span aria-hidden="true" { (outcome.glyph()) } " " (outcome.word()) } }
}

/// Links to the files of a figure or table.
pub(super) fn files(folder: &str, name: &str, kinds: &[(&str, &str)]) -> Markup {
    html! {
        p.files {
            @for (i, (label, extension)) in kinds.iter().enumerate() {
                @if i > 0 { " \u{b7} " }
                a href=(relative_url(folder, name, extension)) { (label) }
            }
        }
    }
}

/// The results of the claims that a figure or table is about.
pub(super) fn claim_list(claim_results: &[ClaimResult]) -> Markup {
    html! {
        @if !claim_results.is_empty() {
            ul.claim-list {
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
