//! The results of a test, as text: a list for one policy, a table for several.

use std::fmt::Write as _;

use super::report::{ComparisonReport, PolicyReport, ROUTE_EPISODES};
use super::suite::{DriverReport, SuiteReport};
use crate::run::suite::FamilyResult;
use crate::scenario::printable;

/// The explanation of the classes.
const CLASSES: &str =
    "classes: A has the scans, the goal and its own motion, B also a map it builds, C the true scenario";
/// The explanation of the brackets.
const BRACKETS: &str = "in brackets: 95 % confidence intervals";

/// The results of one policy.
pub fn list(report: &PolicyReport) -> String {
    let e = &report.evaluation;
    let rounds: Vec<String> = e.rounds.iter().map(|r| format!("{:.0}", 100.0 * r)).collect();
    let mut text = format!(
        "{} in {}, {} episodes, seed {} ({BRACKETS})\n\
         success         {}  (rounds: {})\n\
         collision       {}\n\
         timeout         {}\n\
         mean time       {}\n\
         SPL             {:.3}\n\
         class           {:?} ({})\n",
        printable(&report.policy),
        printable(&report.scenario),
        e.episodes,
        e.seed,
        rate_text(e.success_rate, e.success_interval),
        rounds.join(" "),
        rate_text(e.collision_rate, e.collision_interval),
        rate_text(e.timeout_rate, e.timeout_interval),
        seconds(e.mean_time_s),
        report.spl,
        report.class,
        report.physics,
    );
    if let Some(route) = &report.benchmark_route {
        let _ = writeln!(
            text,
            "benchmark route {}, {} of {ROUTE_EPISODES} episodes{}",
            seconds(route.course_time_s),
            rate_text(route.course_success_rate, route.course_success_interval),
            if route.in_paper_scenario { " (the paper's PER-D3QN: 13.155 s)" } else { "" },
        );
    }
    if let Some(optimum) = report.optimum.as_ref().filter(|optimum| optimum.is_supported) {
        let _ = match optimum.time_ratio {
            Some(ratio) => writeln!(
                text,
                "optimal time    {} over {} of these episodes; the policy takes {ratio:.3} times as long",
                seconds(optimum.optimum_mean_time_s),
                optimum.optimum_episodes,
            ),
            None if e.success_rate == 0.0 => {
                writeln!(text, "optimal time    not compared: no episode succeeded")
            }
            None => {
                writeln!(text, "optimal time    not compared: the planner found no path in these episodes")
            }
        };
    }
    text
}

/// The results of several policies in the same episodes.
pub fn table(comparison: &ComparisonReport) -> String {
    let policies = comparison.policies;
    let mut columns = vec![
        column("policy", policies, |p| printable(&p.policy).into_owned()),
        column("class", policies, |p| format!("{:?}", p.class)),
        column("success", policies, |p| rate_text(p.evaluation.success_rate, p.evaluation.success_interval)),
        column("collision", policies, |p| {
            rate_text(p.evaluation.collision_rate, p.evaluation.collision_interval)
        }),
        column("timeout", policies, |p| rate_text(p.evaluation.timeout_rate, p.evaluation.timeout_interval)),
        column("mean time", policies, |p| seconds(p.evaluation.mean_time_s)),
        column("SPL", policies, |p| format!("{:.3}", p.spl)),
    ];
    if policies.iter().any(|p| p.benchmark_route.is_some()) {
        columns.push(column("route", policies, |p| {
            let route = p.benchmark_route.as_ref();
            route.map_or("-".into(), |r| rate_text(r.course_success_rate, r.course_success_interval))
        }));
        columns.push(column("route time", policies, |p| {
            seconds(p.benchmark_route.as_ref().and_then(|route| route.course_time_s))
        }));
    }
    if policies.iter().any(|p| p.optimum.is_some()) {
        columns.push(column("time ratio", policies, |p| {
            let ratio = p.optimum.as_ref().and_then(|optimum| optimum.time_ratio);
            ratio.map_or("-".into(), |ratio| format!("{ratio:.3}"))
        }));
    }
    let ComparisonReport { scenario, episodes, seed, .. } = comparison;
    let count = policies.len();
    let title = printable(scenario);
    format!(
        "{count} policies in {title}, the same {episodes} episodes, seed {seed} ({BRACKETS})\n\n{}\n{CLASSES}\n",
        aligned(&columns)
    )
}

/// The results of drivers in the families of a suite.
pub fn suite_table(report: &SuiteReport) -> String {
    let SuiteReport { suite, episodes, seed, policies, .. } = report;
    let families = policies.first().map_or(0, |policy| policy.families.len());
    let rows = (0..families).flat_map(|k| policies.iter().map(move |policy| (policy, &policy.families[k])));
    let rows: Vec<FamilyRow> =
        rows.map(|(policy, (name, result))| FamilyRow { policy, name, result }).collect();
    let mut columns = vec![
        column("family", &rows, |row| printable(row.name).into_owned()),
        column("policy", &rows, |row| printable(&row.policy.policy).into_owned()),
        column("class", &rows, |row| format!("{:?}", row.policy.class)),
        column("success", &rows, |row| rate_text(row.result.success_rate, row.result.success_interval)),
        column("collision", &rows, |row| percent(row.result.collision_rate)),
        column("timeout", &rows, |row| percent(row.result.timeout_rate)),
        column("worst tenth", &rows, |row| percent(row.result.worst_tenth)),
        column("mean time", &rows, |row| seconds(row.result.mean_time_s)),
        column("SPL", &rows, |row| format!("{:.3}", row.result.spl)),
    ];
    let number = |value: Option<f64>| value.map_or("-".into(), |value| format!("{value:.3}"));
    if rows.iter().any(|row| row.result.time_ratio.is_some()) {
        columns.push(column("time ratio", &rows, |row| number(row.result.time_ratio)));
    }
    if rows.iter().any(|row| row.result.barn_score.is_some()) {
        columns.push(column("BARN score", &rows, |row| number(row.result.barn_score)));
    }
    let the_same = if policies.len() == 1 { "" } else { "the same " };
    format!(
        "{}, {the_same}{episodes} episodes, seed {seed} ({BRACKETS})\n\n{}\n{CLASSES}\n\
         worst tenth: success in the tenth of the family's scenarios (at least one) where it is lowest\n",
        printable(suite),
        aligned(&columns)
    )
}

/// A row of the table of a suite.
struct FamilyRow<'a> {
    policy: &'a DriverReport,
    name: &'a str,
    result: &'a FamilyResult,
}

/// A column of a table: its title, then a cell per row.
fn column<R>(title: &str, rows: &[R], cell: impl Fn(&R) -> String) -> Vec<String> {
    std::iter::once(title.into()).chain(rows.iter().map(cell)).collect()
}

/// The rows of a table whose columns are as wide as their widest cells.
fn aligned(columns: &[Vec<String>]) -> String {
    let width = |column: &Vec<String>| column.iter().map(|cell| cell.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = columns.iter().map(width).collect();
    let rows = columns.first().map_or(0, Vec::len);
    let row = |index: usize| {
        let cells = columns.iter().zip(&widths).map(|(column, &width)| format!("{:<width$}", column[index]));
        cells.collect::<Vec<_>>().join("  ").trim_end().to_owned() + "\n"
    };
    (0..rows).map(row).collect()
}

/// A rate, 0 to 1, with its 95 % confidence interval, in %: `98.0 % [96.4, 98.9]`.
fn rate_text(rate: f64, [low, high]: [f64; 2]) -> String {
    format!("{:.1} % [{:.1}, {:.1}]", 100.0 * rate, 100.0 * low, 100.0 * high)
}

fn percent(rate: f64) -> String {
    format!("{:.1} %", 100.0 * rate)
}

fn seconds(time_s: Option<f64>) -> String {
    time_s.map_or("-".into(), |s| format!("{s:.3} s"))
}
