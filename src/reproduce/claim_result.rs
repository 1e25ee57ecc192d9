//! The result of a claim: the outcome, and a sentence with the numbers.
//!
//! In: a claim, and the values of both arms over the seeds. Out: a [`ClaimResult`]. If both arms have the same seeds, the
//! difference is taken within each seed, with Student's interval; otherwise between the means, with Welch's interval.
//! A claim **held** if the 95 % interval of the difference lies entirely on the claimed side of 0. It is **reversed** if
//! the interval lies entirely on the other side, and otherwise **not shown**. An arm with a lower bound among its values is
//! never called better, and a few seeds that happen to agree exactly show nothing.

use super::claim::Claim;
use super::measure::Measure;
use super::measured_value::ArmValues;
use crate::report::claim::{ClaimOutcome, ClaimResult};
use crate::report::format::{counted, interval, number};
use crate::report::statistics::{Estimate, MIN_SEEDS, difference, paired_difference};

/// The comparison of two arms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Comparison {
    /// The mean of the first arm minus the mean of the second, in the measure's unit; `None` without values.
    pub difference: Option<Estimate>,
    /// Whether both arms have the same seeds, so that the difference is taken within each seed.
    pub is_paired: bool,
    /// The outcome of the claim that the first arm is better.
    pub outcome: ClaimOutcome,
}

/// Compares the arm that is claimed to be `better` with the other one.
pub fn compare(measure: Measure, better: &ArmValues, than: &ArmValues) -> Comparison {
    let is_paired = better.seeds == than.seeds;
    let difference_of = if is_paired { paired_difference } else { difference };
    let difference = difference_of(&better.raw(), &than.raw());
    let sign = if measure.more_is_better() { 1.0 } else { -1.0 };
    let outcome = match difference {
        Some(Estimate { mean, half_width: Some(half_width), .. })
            if !is_coincidence(difference, better, than) =>
        {
            let (advantage, margin) = (sign * mean, margin(mean, half_width));
            // Lower bounds occur only in measures where less is better, so the true values are worse.
            if advantage > margin && better.lower_bound_count() == 0 {
                ClaimOutcome::Held
            } else if advantage < -margin && than.lower_bound_count() == 0 {
                ClaimOutcome::Reversed
            } else {
                ClaimOutcome::NotShown
            }
        }
        _ => ClaimOutcome::NotShown,
    };
    Comparison { difference, is_paired, outcome }
}

/// The largest mean difference that counts as 0: the half width of its interval, or the rounding error if that is larger.
fn margin(mean: f64, half_width: f64) -> f64 {
    half_width.max(1e-9 * mean.abs().max(1.0))
}

/// Whether all seeds agree, up to rounding errors, but are too few to know their spread.
fn is_coincidence(difference: Option<Estimate>, better: &ArmValues, than: &ArmValues) -> bool {
    let fewest = better.seeds.len().min(than.seeds.len());
    let agree = |d: Estimate| d.half_width.is_some_and(|half_width| half_width <= margin(d.mean, 0.0));
    fewest < MIN_SEEDS && difference.is_some_and(agree)
}

/// Tests `claim`. `anchor` is the section that shows the data, and `window` the number of training episodes in the moving means
/// of the claim's figure, if it has curves.
pub fn claim_result(
    claim: &Claim,
    better: &ArmValues,
    than: &ArmValues,
    window: Option<usize>,
    anchor: &str,
) -> ClaimResult {
    let comparison = compare(claim.measure, better, than);
    let mut sentence = numbers(claim, (better, than), window, comparison);
    sentence += ". ";
    sentence += conclusion(comparison, (better, than));
    sentence += &small_sample_remark(better.seeds.len().min(than.seeds.len()), comparison.outcome);
    for (name, values) in [(&claim.better, better), (&claim.than, than)] {
        let bounds = values.lower_bound_count();
        if bounds > 0 {
            let all = values.values.len();
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

/// A remark on a small number of seeds, after a conclusion.
fn small_sample_remark(seeds: usize, outcome: ClaimOutcome) -> String {
    match (seeds, outcome) {
        (0 | 1 | MIN_SEEDS.., _) => String::new(),
        (n, ClaimOutcome::NotShown) => format!(" n = {n} says little."),
        (n, ClaimOutcome::Held | ClaimOutcome::Reversed) => {
            format!(" With n = {n}, more seeds need to confirm it.")
        }
    }
}

/// The means of both arms and their difference, without a full stop.
fn numbers(
    claim: &Claim,
    (better, than): (&ArmValues, &ArmValues),
    window: Option<usize>,
    Comparison { difference, is_paired, .. }: Comparison,
) -> String {
    let measure = claim.measure;
    let unit = match measure.unit() {
        "" => String::new(),
        unit => format!("\u{a0}{unit}"),
    };
    let with_unit = |e: &Estimate, limits, n: usize| {
        let value = number(e.mean, measure.digits());
        match interval(e.mean, e.half_width, limits, measure.digits()) {
            cut if cut.ends_with(')') => {
                format!("{value}{unit}{}{unit}, n = {n})", cut.trim_end_matches(')'))
            }
            interval => format!("{value}{interval}{unit}"),
        }
    };
    let mean = |values: &ArmValues| {
        let estimate = Estimate::from_values(&values.raw());
        estimate.map_or("no value".into(), |e| with_unit(&e, measure.limits(), e.n))
    };
    let is_time_to = matches!(measure, Measure::EpisodesTo(_) | Measure::StepsTo(_));
    let of_episodes = match window.filter(|_| measure.is_of_episodes()) {
        Some(window) if is_time_to => format!(" (moving mean over {})", counted(window as f64, "episode")),
        Some(window) => format!(" (mean of the last {})", counted(window as f64, "episode")),
        None => String::new(),
    };
    let mut text = format!(
        "{} {} {}{of_episodes}: {} {}, {} {}",
        measure.heading(),
        if is_time_to { "within" } else { "after" },
        claim.point().words(),
        claim.better,
        mean(better),
        claim.than,
        mean(than),
    );
    if let Some(difference) = difference {
        let sign = if difference.mean > 0.0 { "+" } else { "" };
        let paired = if is_paired && better.seeds.len() > 1 { " (paired by seed)" } else { "" };
        text += &format!(
            "; difference {sign}{}{paired}",
            with_unit(&difference, measure.difference_limits(), better.seeds.len().min(than.seeds.len()))
        );
    }
    text
}

/// The conclusion from a comparison.
fn conclusion(comparison: Comparison, (better, than): (&ArmValues, &ArmValues)) -> &'static str {
    let difference = comparison.difference;
    let contains_0 =
        |d: Estimate| d.half_width.is_some_and(|half_width| d.mean.abs() <= margin(d.mean, half_width));
    match (comparison.outcome, difference.and_then(|d| d.half_width)) {
        (ClaimOutcome::Held, _) => "The claim held.",
        (ClaimOutcome::Reversed, _) => "The opposite is the case.",
        (ClaimOutcome::NotShown, None) if better.seeds.len() < 2 || than.seeds.len() < 2 => {
            "A single seed shows no difference."
        }
        (ClaimOutcome::NotShown, None) => "Some seeds have no value.",
        (ClaimOutcome::NotShown, Some(_)) if difference.is_some_and(contains_0) => {
            "The interval contains 0, so no difference is shown."
        }
        (ClaimOutcome::NotShown, Some(_)) if is_coincidence(difference, better, than) => {
            "All seeds happen to agree, but there are too few to know their spread."
        }
        (ClaimOutcome::NotShown, Some(_)) => {
            "The mean that looks better includes a lower bound, so no difference is shown."
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::measured_value::MeasuredValue;
    use crate::run::preset::Budget;

    fn arm(values: Vec<MeasuredValue>) -> ArmValues {
        ArmValues { seeds: (1..).take(values.len()).collect(), values }
    }

    fn values(of: &[f64]) -> ArmValues {
        arm(of.iter().map(|&value| MeasuredValue::exact(value)).collect())
    }

    fn claim(measure: Measure, after: u64) -> Claim {
        Claim {
            statement: "A is better".into(),
            measure,
            better: "A".into(),
            than: "B".into(),
            after: Some(Budget::Episodes(after)),
            of_last_stage: false,
        }
    }

    fn outcome(measure: Measure, better: &[f64], than: &[f64]) -> ClaimOutcome {
        compare(measure, &values(better), &values(than)).outcome
    }

    #[test]
    fn a_claim_holds_if_the_interval_lies_on_its_side_of_zero() {
        // Differences 8, 9 and 10: 9 +- 2.48.
        let (high, low) = ([98.0, 99.0, 100.0], [90.0, 90.0, 90.0]);
        assert_eq!(outcome(Measure::Success, &high, &low), ClaimOutcome::Held);
        assert_eq!(outcome(Measure::Success, &low, &high), ClaimOutcome::Reversed);
        assert_eq!(outcome(Measure::MeanTime, &low, &high), ClaimOutcome::Held, "less time is better");
        // Differences -6, 2 and 10: 2 +- 4.3027 * 8 / sqrt 3 = 19.9.
        let (one, other) = ([92.0, 96.0, 100.0], [98.0, 94.0, 90.0]);
        assert_eq!(outcome(Measure::Success, &one, &other), ClaimOutcome::NotShown);
        assert_eq!(outcome(Measure::Success, &[99.0], &[1.0]), ClaimOutcome::NotShown, "a single seed");
        assert_eq!(outcome(Measure::Success, &[5.0; 5], &[5.0; 5]), ClaimOutcome::NotShown, "no difference");
        assert_eq!(outcome(Measure::Success, &[6.0; 5], &[5.0; 5]), ClaimOutcome::Held, "no variance");
        assert_eq!(
            outcome(Measure::Success, &[6.0; 2], &[5.0; 2]),
            ClaimOutcome::NotShown,
            "two seeds agree"
        );
        assert_eq!(
            outcome(Measure::Success, &[99.8, 99.6], &[99.6, 99.4]),
            ClaimOutcome::NotShown,
            "two seeds agree up to rounding errors"
        );
    }

    #[test]
    fn arms_with_the_same_seeds_are_paired_and_others_are_not() {
        // Every seed gains 1 to 3, while the seeds differ by 10.
        let (a, b) = (values(&[11.0, 22.0, 33.0]), values(&[10.0, 20.0, 30.0]));
        let paired = compare(Measure::Success, &a, &b);
        assert_eq!((paired.is_paired, paired.outcome), (true, ClaimOutcome::NotShown), "2 +- 2.48");
        let better = values(&[12.0, 22.0, 33.0]);
        assert_eq!(compare(Measure::Success, &better, &b).outcome, ClaimOutcome::Held, "2.33 +- 1.43");
        let other_seeds = ArmValues { seeds: vec![4, 5, 6], ..b };
        let unpaired = compare(Measure::Success, &better, &other_seeds);
        assert_eq!((unpaired.is_paired, unpaired.outcome), (false, ClaimOutcome::NotShown));
    }

    #[test]
    fn the_sentence_has_the_numbers_behind_the_outcome() {
        // {98, 99, 100}: 99, sd 1, half width 4.3027 / sqrt 3 = 2.48. The differences 8, 9 and 10 have the same half width.
        let (better, than) = (values(&[98.0, 99.0, 100.0]), values(&[90.0, 90.0, 90.0]));
        let result = claim_result(&claim(Measure::Success, 1000), &better, &than, None, "here");
        assert_eq!(
            result.sentence,
            "Success after 1,000 episodes: A 99.0\u{a0}% (96.5 to 100.0\u{a0}%, n = 3), B 90.0 ± 0.0\u{a0}%; difference \
             +9.0 ± 2.5\u{a0}% (paired by seed). The claim held. With n = 3, more seeds need to confirm it."
        );
        let result = claim_result(&claim(Measure::Goals, 1000), &better, &than, Some(20), "here");
        assert!(
            result.sentence.contains("after 1,000 episodes (mean of the last 20 episodes): A "),
            "{}",
            result.sentence
        );
        let result = claim_result(&claim(Measure::SuccessRate, 1000), &better, &than, Some(20), "here");
        let start = "Success in evaluations during training after 1,000 episodes: A 99.0";
        assert!(result.sentence.starts_with(start), "evaluations are not smoothed: {}", result.sentence);
    }

    #[test]
    fn an_arm_with_lower_bounds_is_never_better() {
        let claim = claim(Measure::EpisodesTo(4.0), 800);
        let bound = |value| MeasuredValue { value, is_lower_bound: true };
        let not_reached = arm(vec![bound(800.0), MeasuredValue::exact(700.0)]);
        let result = claim_result(&claim, &values(&[300.0, 310.0]), &not_reached, None, "here");
        assert!(result.sentence.starts_with("Episodes to 4 goals per episode within 800 episodes: A 305"));
        let note = "(1 of 2 runs of B did not reach this number of goals and count with their full length.)";
        assert!(result.sentence.ends_with(note), "{}", result.sentence);
        // The first arm only had shorter runs.
        let (short, long) = (arm(vec![bound(100.0); 5]), arm(vec![bound(200.0); 5]));
        assert_eq!(compare(Measure::EpisodesTo(4.0), &short, &long).outcome, ClaimOutcome::NotShown);
        let one = arm([bound(100.0)].into_iter().chain([MeasuredValue::exact(100.0); 4]).collect());
        let result = claim_result(&claim, &one, &long, None, "here");
        let reason = "The mean that looks better includes a lower bound, so no difference is shown.";
        assert!(result.sentence.contains(reason), "{}", result.sentence);
    }
}
