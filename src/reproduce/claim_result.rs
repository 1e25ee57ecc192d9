//! The result of a claim: the outcome, and a sentence with the numbers.
//!
//! In: a claim, and the values of both arms over the seeds. Out: a [`ClaimResult`]. A claim **held** if the 95 %
//! interval of the difference (Welch) lies entirely on the claimed side of 0. It is **reversed** if the interval lies
//! entirely on the other side, and otherwise **not shown**. An arm with a lower bound among its values is never called
//! better.

use super::claim::Claim;
use super::measure::Measure;
use super::measured_value::{MeasuredValue, raw_values};
use crate::report::claim::{ClaimOutcome, ClaimResult};
use crate::report::format::number;
use crate::report::statistics::{Estimate, difference};

/// The comparison of two arms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// The mean of the first arm minus the mean of the second, in the measure's unit; `None` without values.
    pub difference: Option<Estimate>,
    /// The outcome of the claim that the first arm is better.
    pub outcome: ClaimOutcome,
}

/// Compares the arm that is claimed to be `better` with the other one.
pub fn compare(measure: Measure, better: &[MeasuredValue], than: &[MeasuredValue]) -> Comparison {
    let difference = difference(&raw_values(better), &raw_values(than));
    let is_bound = |values: &[MeasuredValue]| values.iter().any(|value| value.is_lower_bound);
    let sign = if measure.more_is_better() { 1.0 } else { -1.0 };
    let outcome = match difference {
        Some(Estimate { mean, half_width: Some(half_width), .. }) => {
            // A difference within rounding errors counts as 0.
            let rounding = 1e-9 * mean.abs().max(1.0);
            let (advantage, margin) = (sign * mean, half_width.max(rounding));
            // Lower bounds occur only in measures where less is better, so the true values are worse.
            if advantage > margin && !is_bound(better) {
                ClaimOutcome::Held
            } else if advantage < -margin && !is_bound(than) {
                ClaimOutcome::Reversed
            } else {
                ClaimOutcome::NotShown
            }
        }
        _ => ClaimOutcome::NotShown,
    };
    Comparison { difference, outcome }
}

/// The result of `claim`; `anchor` is the section that shows the data.
pub fn claim_result(
    claim: &Claim,
    better: &[MeasuredValue],
    than: &[MeasuredValue],
    anchor: &str,
) -> ClaimResult {
    let comparison = compare(claim.measure, better, than);
    let mut sentence = numbers(claim, better, than, comparison.difference);
    sentence += ". ";
    sentence += conclusion(comparison, better.len());
    for (name, values) in [(&claim.better, better), (&claim.than, than)] {
        let bounds = values.iter().filter(|value| value.is_lower_bound).count();
        if bounds > 0 {
            let all = values.len();
            sentence += &match claim.measure {
                Measure::BenchmarkRouteTime => {
                    format!(
                        " ({bounds} of {all} runs of {name} failed in every episode and count as the time limit.)"
                    )
                }
                _ => format!(
                    " ({bounds} of {all} runs of {name} did not reach this number of goals and count with their full \
                     length.)"
                ),
            };
        }
    }
    ClaimResult {
        claim: claim.statement.clone(),
        outcome: comparison.outcome,
        sentence,
        anchor: anchor.into(),
    }
}

/// The means of both arms and their difference, without a full stop.
fn numbers(
    claim: &Claim,
    better: &[MeasuredValue],
    than: &[MeasuredValue],
    difference: Option<Estimate>,
) -> String {
    let measure = claim.measure;
    let unit = match measure.unit() {
        "" => String::new(),
        unit => format!("\u{a0}{unit}"),
    };
    let with_unit = |e: &Estimate| format!("{}{unit}", with_interval(e, measure.digits()));
    let mean = |values: &[MeasuredValue]| {
        Estimate::from_values(&raw_values(values)).map_or("no value".into(), |e| with_unit(&e))
    };
    let mut text = format!(
        "{} {} {} episodes{}: {} {}, {} {}",
        measure.heading(),
        if matches!(measure, Measure::EpisodesTo(_) | Measure::StepsTo(_)) { "within" } else { "after" },
        number(claim.after as f64, 0),
        if claim.of_last_stage { " of the last stage" } else { "" },
        claim.better,
        mean(better),
        claim.than,
        mean(than),
    );
    if let Some(difference) = difference {
        let sign = if difference.mean > 0.0 { "+" } else { "" };
        text += &format!("; difference {sign}{}", with_unit(&difference));
    }
    text
}

/// The conclusion from a comparison over `seeds` seeds.
fn conclusion(Comparison { difference, outcome }: Comparison, seeds: usize) -> &'static str {
    let contains_0 = |d: Estimate| d.half_width.is_some_and(|half_width| d.mean.abs() <= half_width);
    match (outcome, difference.and_then(|d| d.half_width)) {
        (ClaimOutcome::Held, _) => "The claim held.",
        (ClaimOutcome::Reversed, _) => "The opposite is the case.",
        (ClaimOutcome::NotShown, None) if seeds < 2 => "A single seed shows no difference.",
        (ClaimOutcome::NotShown, None) => "Some seeds have no value.",
        (ClaimOutcome::NotShown, Some(_)) if difference.is_some_and(contains_0) => {
            "The interval contains 0, so no difference is shown."
        }
        (ClaimOutcome::NotShown, Some(_)) => "Too many values are lower bounds to show a difference.",
    }
}

fn with_interval(estimate: &Estimate, digits: usize) -> String {
    match estimate.half_width {
        Some(half_width) => format!("{} ± {}", number(estimate.mean, digits), number(half_width, digits)),
        None => number(estimate.mean, digits),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn values(of: &[f64]) -> Vec<MeasuredValue> {
        of.iter().map(|&value| MeasuredValue::exact(value)).collect()
    }

    fn outcome(measure: Measure, better: &[f64], than: &[f64]) -> ClaimOutcome {
        compare(measure, &values(better), &values(than)).outcome
    }

    #[test]
    fn a_claim_holds_if_the_interval_lies_on_its_side_of_zero() {
        // Means 99 and 90, standard errors sqrt(1/3) each: far apart.
        let (high, low) = ([98.0, 99.0, 100.0], [89.0, 90.0, 91.0]);
        assert_eq!(outcome(Measure::Success, &high, &low), ClaimOutcome::Held);
        assert_eq!(outcome(Measure::Success, &low, &high), ClaimOutcome::Reversed);
        assert_eq!(outcome(Measure::MeanTime, &low, &high), ClaimOutcome::Held, "less time is better");
        // Means 96 and 94, standard errors sqrt(16/3) each: 2 +- 2.776 sqrt(32/3) = 9.07 (Welch: 4 degrees of freedom).
        let (one, other) = ([92.0, 96.0, 100.0], [90.0, 94.0, 98.0]);
        assert_eq!(outcome(Measure::Success, &one, &other), ClaimOutcome::NotShown);
        assert_eq!(outcome(Measure::Success, &[99.0], &[1.0]), ClaimOutcome::NotShown, "a single seed");
        assert_eq!(outcome(Measure::Success, &[5.0; 2], &[5.0; 2]), ClaimOutcome::NotShown, "no difference");
        assert_eq!(outcome(Measure::Success, &[6.0; 2], &[5.0; 2]), ClaimOutcome::Held, "no variance");
    }

    #[test]
    fn the_sentence_has_the_numbers_behind_the_outcome() {
        let claim = Claim {
            statement: "A succeeds more often".into(),
            measure: Measure::Success,
            better: "A".into(),
            than: "B".into(),
            after: 1000,
            of_last_stage: false,
        };
        // {98, 99, 100}: 99, sd 1, half width 4.3027 / sqrt 3 = 2.48; the difference's: 2.7764 sqrt(2/3) = 2.27.
        let result =
            claim_result(&claim, &values(&[98.0, 99.0, 100.0]), &values(&[89.0, 90.0, 91.0]), "here");
        assert_eq!(
            result.sentence,
            "Success after 1,000 episodes: A 99.0 ± 2.5\u{a0}%, B 90.0 ± 2.5\u{a0}%; difference +9.0 ± 2.3\u{a0}%. \
             The claim held."
        );
    }

    #[test]
    fn an_arm_with_lower_bounds_is_never_better() {
        let claim = Claim {
            statement: "A learns in fewer episodes".into(),
            measure: Measure::EpisodesTo(4.0),
            better: "A".into(),
            than: "B".into(),
            after: 800,
            of_last_stage: false,
        };
        let not_reached = [MeasuredValue { value: 800.0, is_lower_bound: true }, MeasuredValue::exact(700.0)];
        let result = claim_result(&claim, &values(&[300.0, 310.0]), &not_reached, "here");
        assert!(result.sentence.starts_with("Episodes to 4 goals per episode within 800 episodes: A 305"));
        let note = "(1 of 2 runs of B did not reach this number of goals and count with their full length.)";
        assert!(result.sentence.ends_with(note), "{}", result.sentence);
        // The first arm only had shorter runs.
        let short = [MeasuredValue { value: 100.0, is_lower_bound: true }; 2];
        let long = [MeasuredValue { value: 200.0, is_lower_bound: true }; 2];
        assert_eq!(compare(Measure::EpisodesTo(4.0), &short, &long).outcome, ClaimOutcome::NotShown);
    }
}
