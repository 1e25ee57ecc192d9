//! Parsers for option values.

use std::ops::RangeInclusive;
use std::time::Duration;

use crate::limits::experiment::MAX_SEEDS;
use crate::limits::{MAX_IMAGE_SIDE, MAX_SHEET_LEVELS, MAX_STEPS};
use crate::reproduce::Seeds;
use crate::scenario::whole_number;

/// The minimum width and height of an image, in pixels.
const MIN_IMAGE_SIDE: u16 = 16;

/// A parser of whole numbers in `range`. They may be written 600000, 600_000, 6e5 or 600k.
pub fn whole<N: TryFrom<u64>>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<N, String> + Clone + Send + Sync + 'static {
    move |text: &str| {
        let value = whole_number(text).filter(|n| range.contains(n)).and_then(|n| N::try_from(n).ok());
        value.ok_or_else(|| {
            let fix = ungrouped(text).filter(|n| range.contains(n)).map(|n| format!("; write {n}"));
            format!(
                "give a whole number from {} to {}{}",
                range.start(),
                range.end(),
                fix.unwrap_or_default()
            )
        })
    }
}

/// The whole number `text` without the separators of its groups of three digits, such as 600,000; `None` without such groups.
fn ungrouped(text: &str) -> Option<u64> {
    let mut groups = text.split([',', ' ', '\'', '’', '\u{a0}', '\u{202f}']);
    let first = groups.next().filter(|first| (1..=3).contains(&first.len()))?;
    let rest: Vec<&str> = groups.collect();
    let are_groups = !rest.is_empty() && rest.iter().all(|group| group.len() == 3);
    let digits = format!("{first}{}", rest.concat());
    (are_groups && digits.chars().all(|c| c.is_ascii_digit())).then(|| digits.parse().ok())?
}

/// Parses a number of episodes or env steps.
pub fn budget(text: &str) -> Result<u64, String> {
    whole(1..=MAX_STEPS)(text)
}

/// Parses a seed.
pub fn seed(text: &str) -> Result<u64, String> {
    whole(0..=u64::MAX)(text)
}

/// Parses a number of levels on a contact sheet.
pub fn levels(text: &str) -> Result<u64, String> {
    whole(1..=MAX_SHEET_LEVELS)(text)
}

/// Parses a number of seeds, or a list of them.
pub fn seeds(text: &str) -> Result<Seeds, String> {
    let Some(list) = text.contains(',').then(|| text.strip_suffix(',').unwrap_or(text)) else {
        return whole(1..=MAX_SEEDS)(text).map(Seeds::First);
    };
    let seeds = list.split(',').map(|text| seed(text.trim())).collect::<Result<Vec<_>, _>>();
    let seeds = Seeds::List(seeds.map_err(|error| format!("each seed: {error}"))?);
    match seeds.duplicate() {
        Some(seed) => Err(format!("{seed} is given twice; give each seed once")),
        None if seeds.count() > MAX_SEEDS => Err(format!("give at most {MAX_SEEDS} seeds")),
        None => Ok(seeds),
    }
}

/// Parses a fraction from 0 to 1.
pub fn fraction(text: &str) -> Result<f32, String> {
    let value = text.parse().ok().filter(|x| (0.0..=1.0).contains(x));
    value.ok_or_else(|| format!("give a number from 0 to 1{}", decimal_point(text, &(0.0..=1.0))))
}

/// Parses a width and a height, such as 1600x1200.
pub fn size(text: &str) -> Result<(u16, u16), String> {
    let sides =
        text.split_once('x').and_then(|(width, height)| Some((width.parse().ok()?, height.parse().ok()?)));
    let valid = MIN_IMAGE_SIDE..=MAX_IMAGE_SIDE;
    sides.filter(|(width, height)| valid.contains(width) && valid.contains(height)).ok_or_else(|| {
        let (least, most) = (MIN_IMAGE_SIDE, MAX_IMAGE_SIDE);
        format!("give width and height, {least}x{least} to {most}x{most}")
    })
}

/// Parses a time in s.
pub fn seconds(text: &str) -> Result<Duration, String> {
    let range: RangeInclusive<f64> = 0.01..=1e6;
    let value = text.parse().ok().filter(|s| range.contains(s));
    value
        .map(Duration::from_secs_f64)
        .ok_or_else(|| format!("give 0.01 to 1000000 seconds{}", decimal_point(text, &range)))
}

/// A parser of lengths in m in `range`.
pub fn metres(
    range: RangeInclusive<f64>,
) -> impl Fn(&str) -> Result<f64, String> + Clone + Send + Sync + 'static {
    move |text: &str| {
        let value = text.parse().ok().filter(|length| range.contains(length));
        let (least, most) = (range.start(), range.end());
        value.ok_or_else(|| format!("give {least} to {most} (metres){}", decimal_point(text, &range)))
    }
}

/// The end of a message about `text` if it is a number in `range` with a decimal comma.
fn decimal_point(text: &str, range: &RangeInclusive<f64>) -> String {
    let fixed = text.replacen(',', ".", 1);
    let is_fixed = fixed != text && fixed.parse::<f64>().is_ok_and(|value| range.contains(&value));
    if is_fixed { format!("; write {fixed}") } else { String::new() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_numbers_may_be_written_short() {
        for (text, value) in [
            ("600000", 600_000),
            ("600_000", 600_000),
            ("6e5", 600_000),
            ("6E+5", 600_000),
            ("0.6e6", 600_000),
            ("600k", 600_000),
            ("1.5M", 1_500_000),
        ] {
            assert_eq!(budget(text), Ok(value), "{text}");
        }
        assert_eq!(seed("18446744073709551615"), Ok(u64::MAX), "no digit of a seed is lost");
        for (text, fix) in [
            ("600,000", "; write 600000"),
            ("600 000", "; write 600000"),
            ("1,000,000", "; write 1000000"),
            ("1,2", ""),
            ("1,2345", ""),
            ("1000,000", ""),
            (",600", ""),
            ("6.5", ""),
            ("-1", ""),
            ("_1", ""),
            ("1__0", ""),
            ("1e-3", ""),
            ("0", ""),
            ("1e16", ""),
            ("inf", ""),
            ("6e", ""),
            ("", ""),
            ("k", ""),
        ] {
            let error = format!("give a whole number from 1 to 1000000000000000{fix}");
            assert_eq!(budget(text), Err(error), "{text}");
        }
        assert_eq!(
            levels("1,000"),
            Err("give a whole number from 1 to 100".into()),
            "1000 is not valid either"
        );
    }

    #[test]
    fn seeds_are_given_as_a_count_or_as_a_list_without_duplicates() {
        assert_eq!(seeds("5"), Ok(Seeds::First(5)));
        assert_eq!(seeds("3,17, 42"), Ok(Seeds::List(vec![3, 17, 42])));
        assert_eq!(seeds("17,"), Ok(Seeds::List(vec![17])), "a single one");
        assert_eq!(seeds("0"), Err("give a whole number from 1 to 1000".into()));
        assert_eq!(seeds("3,17,3"), Err("3 is given twice; give each seed once".into()));
        assert!(seeds("3,x").is_err() && seeds(",").is_err());
    }

    #[test]
    fn a_decimal_comma_is_rejected_with_the_number_to_write() {
        assert_eq!(fraction("0,5"), Err("give a number from 0 to 1; write 0.5".into()));
        assert_eq!(seconds("1,5"), Err("give 0.01 to 1000000 seconds; write 1.5".into()));
        assert_eq!(fraction("1,5"), Err("give a number from 0 to 1".into()), "1.5 is not valid either");
        assert_eq!(fraction("NaN"), Err("give a number from 0 to 1".into()));
    }
}
