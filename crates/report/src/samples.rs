//! A sample table and a sample page, for tests.

use crate::claim::{ClaimOutcome, ClaimResult};
use crate::page::{Item, Page, Section, Setting};
use crate::table::{Cell, Column, ColumnKind, Table};

fn column(heading: &str, unit: &str, kind: ColumnKind) -> Column {
    Column { heading: heading.into(), unit: unit.into(), kind }
}

/// A table with a cell of each kind but `Empty`, and with markup in its text. The second row lacks its last cell, which is
/// shown as empty.
pub(crate) fn table() -> Table {
    Table {
        name: "table2".into(),
        title: "Success & time".into(),
        columns: vec![
            column("Agent", "", ColumnKind::Text),
            column("Success", "%", ColumnKind::Number),
            column("Episodes", "", ColumnKind::Number),
            column("Difference", "s", ColumnKind::Number),
            column("Claim", "", ColumnKind::Text),
        ],
        rows: vec![
            vec![
                Cell::Text("a | b, <i>\"c\"</i>".into()),
                Cell::Estimate { mean: 99.44, half_width: Some(0.81), limits: None, digits: 1 },
                Cell::Number { value: 1500.0, digits: 0 },
                Cell::Signed { value: -3.4, half_width: Some(1.2), limits: None, digits: 1 },
                Cell::Outcome(ClaimOutcome::Held),
            ],
            vec![
                Cell::Text("DQN".into()),
                Cell::Estimate { mean: f64::NAN, half_width: Some(1.0), limits: None, digits: 1 },
                Cell::AtLeast { value: 1800.0, digits: 0 },
                Cell::Signed { value: 3.4, half_width: None, limits: None, digits: 1 },
            ],
        ],
        notes: vec!["Mean of 5 seeds <each>.".into()],
    }
}

fn claim_result(outcome: ClaimOutcome, anchor: &str) -> ClaimResult {
    ClaimResult {
        claim: "A < B & C".into(),
        outcome,
        sentence: "3.4 \u{b1} 1.2 | <b>more</b>.".into(),
        anchor: anchor.into(),
    }
}

pub(crate) fn svg() -> String {
    let xmlns = "http://www.w3.org/2000/svg";
    format!(r#"<?xml version="1.0"?><svg xmlns="{xmlns}" viewBox="0 0 9 9"><rect/></svg>"#)
}

/// A page with one item of each kind, and with markup in most of its text.
pub(crate) fn page() -> Page {
    let figure = Item::Figure {
        name: "fig 9".into(),
        svg: svg(),
        caption: "Return <script>alert(1)</script>".into(),
        claim_results: vec![claim_result(ClaimOutcome::Held, "fig9")],
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
            claim_result(ClaimOutcome::Held, "fig9"),
            claim_result(ClaimOutcome::Reversed, "table \"2\""),
            claim_result(ClaimOutcome::Held, "fig9"),
        ],
        sections: vec![
            section("fig9", vec![Item::Text("Some text.".into()), figure]),
            section("table \"2\"", vec![Item::Table { table: table(), claim_results: vec![] }]),
        ],
        settings: vec![Setting { heading: "DQN <1>".into(), ron: "(a: \"<x> & ```\")\n".into() }],
        provenance: vec![("Command".into(), "wayfield <x> && y".into())],
    }
}
