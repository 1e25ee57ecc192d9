//! Whether a claim held, in one sentence computed from the data.
//!
//! In: a claim, and the values of both arms over the seeds. Out: a [`ClaimResult`]: *held* when the 95 % interval of the
//! difference (Welch) lies wholly on the claimed side of 0, *reversed* when it lies wholly on the other, else *not
//! shown*. An arm of which a run never got where it should is never called ahead.

use super::experiment::Claim;
use super::measure::Measure;
use super::results::MeasuredValue;
use crate::report::claim::{ClaimOutcome, ClaimResult};
use crate::report::format::number;
use crate::report::statistics::{Estimate, difference};

/// How two arms compare: the difference in the measure's own direction, and what follows from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// Mean of the one less mean of the other, in the measure's unit; None if there is nothing to compare.
    pub difference: Option<Estimate>,
    /// What it says of the claim that the one is better.
    pub outcome: ClaimOutcome,
}

/// Compares the arm that is claimed to be `better` with the other.
#[must_use]
pub fn compare(measure: Measure, better: &[MeasuredValue], than: &[MeasuredValue]) -> Comparison {
    let difference = difference(&raw_values(better), &raw_values(than));
    // Of an arm that never got there only a bound is known, on the wrong side to say that it is ahead.
    let never = |values: &[MeasuredValue]| values.iter().any(|value| value.is_lower_bound);
    let sign = if measure.more_is_better() { 1.0 } else { -1.0 };
    let outcome = match difference {
        Some(Estimate { mean, half_width: Some(half_width), .. }) => {
            // Equal to the last digit is no difference, whatever rounding says.
            let least = 1e-9 * mean.abs().max(1.0);
            let (middle, reach) = (sign * mean, half_width.max(least));
            if middle > reach && !never(better) {
                ClaimOutcome::Held
            } else if middle < -reach && !never(than) {
                ClaimOutcome::Reversed
            } else {
                ClaimOutcome::NotShown
            }
        }
        _ => ClaimOutcome::NotShown,
    };
    Comparison { difference, outcome }
}

/// The verdict on `claim`; `anchor` is the section that shows it.
#[must_use]
pub fn claim_result(
    claim: &Claim,
    better: &[MeasuredValue],
    than: &[MeasuredValue],
    anchor: &str,
) -> ClaimResult {
    let measure = claim.measure;
    let Comparison { difference, outcome } = compare(measure, better, than);
    let unit = match measure.unit() {
        "" => String::new(),
        unit => format!("\u{a0}{unit}"),
    };
    let reads = |estimate: Option<Estimate>| {
        estimate.map_or("nothing".into(), |e| format!("{}{unit}", with_interval(&e, measure.digits())))
    };
    let mut sentence = format!(
        "{} {} {} episodes{}: {} {}, {} {}",
        measure.heading(),
        if matches!(measure, Measure::EpisodesTo(_) | Measure::StepsTo(_)) { "within" } else { "after" },
        number(claim.after as f64, 0),
        if claim.of_last_stage { " of the last stage" } else { "" },
        claim.better,
        reads(Estimate::from_values(&raw_values(better))),
        claim.than,
        reads(Estimate::from_values(&raw_values(than))),
    );
    if let Some(difference) = difference {
        let sign = if difference.mean > 0.0 { "+" } else { "" };
        sentence += &format!("; difference {sign}{}{unit}", with_interval(&difference, measure.digits()));
    }
    let holds_0 = |d: &Estimate| d.half_width.is_some_and(|half_width| d.mean.abs() <= half_width);
    sentence += match (outcome, difference.and_then(|d| d.half_width)) {
        (ClaimOutcome::Held, _) => ". The claim holds.",
        (ClaimOutcome::Reversed, _) => ". It is the other way round.",
        (ClaimOutcome::NotShown, None) if better.len() < 2 => ". One seed shows nothing.",
        (ClaimOutcome::NotShown, None) => ". Of some seeds there is no such number.",
        (ClaimOutcome::NotShown, Some(_)) if difference.as_ref().is_some_and(holds_0) => {
            ". The interval holds 0: no difference is shown."
        }
        (ClaimOutcome::NotShown, Some(_)) => ". Too many runs never got there to tell.",
    };
    for (name, values) in [(&claim.better, better), (&claim.than, than)] {
        let never = values.iter().filter(|value| value.is_lower_bound).count();
        if never > 0 {
            let all = values.len();
            let counts = match measure {
                Measure::BenchmarkRouteTime => "the time limit",
                _ => "their length",
            };
            sentence +=
                &format!(" ({never} of {all} runs of {name} never got there; they count with {counts}.)");
        }
    }
    ClaimResult { claim: claim.statement.clone(), outcome, sentence, anchor: anchor.into() }
}

/// The numbers alone.
#[must_use]
pub fn raw_values(values: &[MeasuredValue]) -> Vec<f64> {
    values.iter().map(|value| value.value).collect()
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
        of.iter().map(|&value| MeasuredValue { value, is_lower_bound: false }).collect()
    }

    fn outcome(measure: Measure, better: &[f64], than: &[f64]) -> ClaimOutcome {
        compare(measure, &values(better), &values(than)).outcome
    }

    #[test]
    fn a_claim_holds_when_the_interval_lies_on_its_side() {
        // Means 99 and 90, standard errors sqrt(1/3) each: far apart.
        let (high, low) = ([98.0, 99.0, 100.0], [89.0, 90.0, 91.0]);
        assert_eq!(outcome(Measure::Success, &high, &low), ClaimOutcome::Held);
        assert_eq!(outcome(Measure::Success, &low, &high), ClaimOutcome::Reversed);
        assert_eq!(outcome(Measure::MeanTime, &low, &high), ClaimOutcome::Held, "less time is better");
        // Means 96 and 94, standard errors sqrt(16/3) each: 2 +- 2.776 sqrt(32/3) = 9.07 (Welch: 4 degrees of freedom).
        let (one, other) = ([92.0, 96.0, 100.0], [90.0, 94.0, 98.0]);
        assert_eq!(outcome(Measure::Success, &one, &other), ClaimOutcome::NotShown);
        assert_eq!(
            outcome(Measure::Success, &[99.0], &[1.0]),
            ClaimOutcome::NotShown,
            "one seed shows nothing"
        );
        assert_eq!(
            outcome(Measure::Success, &[5.0, 5.0], &[5.0, 5.0]),
            ClaimOutcome::NotShown,
            "no difference"
        );
        assert_eq!(
            outcome(Measure::Success, &[6.0, 6.0], &[5.0, 5.0]),
            ClaimOutcome::Held,
            "no spread at all"
        );
    }

    #[test]
    fn a_verdict_says_the_numbers_it_rests_on() {
        let claim = Claim {
            statement: "More is reached".into(),
            measure: Measure::Success,
            better: "A".into(),
            than: "B".into(),
            after: 1000,
            of_last_stage: false,
        };
        // {98, 99, 100}: 99, sd 1, half width 4.3027 / sqrt 3 = 2.48; the difference's: 2.7764 sqrt(2/3) = 2.27.
        let said = claim_result(&claim, &values(&[98.0, 99.0, 100.0]), &values(&[89.0, 90.0, 91.0]), "here");
        assert_eq!(
            said.sentence,
            "Success after 1,000 episodes: A 99.0 ± 2.5\u{a0}%, B 90.0 ± 2.5\u{a0}%; difference +9.0 ± 2.3\u{a0}%. \
             The claim holds."
        );
        let never = [
            MeasuredValue { value: 800.0, is_lower_bound: true },
            MeasuredValue { value: 700.0, is_lower_bound: false },
        ];
        let claim = Claim { measure: Measure::EpisodesTo(4.0), after: 800, ..claim };
        let said = claim_result(&claim, &values(&[300.0, 310.0]), &never, "here");
        assert!(said.sentence.starts_with("Episodes to 4 goals within 800 episodes: A 305"));
        assert!(said.sentence.ends_with("(1 of 2 runs of B never got there; they count with their length.)"));
        // The arm that seems ahead only had shorter runs.
        let short = [MeasuredValue { value: 100.0, is_lower_bound: true }; 2];
        let long = [MeasuredValue { value: 200.0, is_lower_bound: true }; 2];
        assert_eq!(compare(Measure::EpisodesTo(4.0), &short, &long).outcome, ClaimOutcome::NotShown);
    }
}
