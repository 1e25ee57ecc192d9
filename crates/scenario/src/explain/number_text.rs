//! Numbers as people write them: `6e5` and `600k` for a whole number, `0.1 m`, `0,1`, `1,000.5`.

use std::f64::consts::PI;
use std::ops::Range;

use wayfield_ron_patch::tokens;

/// What is expected instead of a whole number that its field cannot hold.
pub(super) const OUT_OF_RANGE: &str = "a whole number in range: this one is negative or too large";

/// The units of the format: a number with one of them is right without it.
const OWN_UNITS: [&str; 11] =
    ["m", "s", "rad", "m/s", "rad/s", "m/s2", "m/s^2", "rad/s2", "rad/s^2", "px", "steps"];

/// Units that people write instead, with the factors that convert them.
const CONVERTED_UNITS: [(&str, f64); 14] = [
    ("km", 1000.0),
    ("cm", 0.01),
    ("mm", 0.001),
    ("h", 3600.0),
    ("min", 60.0),
    ("ms", 0.001),
    ("deg", PI / 180.0),
    ("\u{b0}", PI / 180.0),
    ("km/h", 1.0 / 3.6),
    ("cm/s", 0.01),
    ("mm/s", 0.001),
    ("deg/s", PI / 180.0),
    ("\u{b0}/s", PI / 180.0),
    ("%", 0.01),
];

/// Units of quantities that no field has.
const FOREIGN_UNITS: [&str; 2] = ["Hz", "rpm"];

/// Whether `word` is a unit that is recognized after a number and a space.
pub(super) fn is_unit(word: &str) -> bool {
    OWN_UNITS.contains(&word) || factor(word).is_some() || FOREIGN_UNITS.contains(&word)
}

/// The factor that converts `unit` to the format's own.
fn factor(unit: &str) -> Option<f64> {
    CONVERTED_UNITS.iter().find(|(name, _)| *name == unit).map(|(_, factor)| *factor)
}

/// The word around `offset` if it starts like a number and `offset` lies inside it, so that ron has read only a part of it. Of a
/// unit such as `km/h`, all is part of the word.
pub(super) fn cut_number(text: &str, offset: usize) -> Option<Range<usize>> {
    let is_word = |c: char| c.is_alphanumeric() || "_.+-".contains(c);
    let before = text[..offset].len() - text[..offset].trim_end_matches(is_word).len();
    let after = text[offset..].find(|c| !is_word(c)).unwrap_or(text.len() - offset);
    let end = offset + after;
    let word = offset - before..end + denominator(&text[end..]);
    let is_number =
        text[word.clone()].trim_start_matches(['+', '-', '.']).starts_with(|c: char| c.is_ascii_digit());
    (before > 0 && after > 0 && is_number).then_some(word)
}

/// The length of the second part of a unit, such as `/s`, at the start of `text`; 0 if there is none.
fn denominator(text: &str) -> usize {
    let Some(unit) = text.strip_prefix('/').filter(|unit| unit.starts_with(char::is_alphabetic)) else {
        return 0;
    };
    1 + unit.find(|c: char| !c.is_alphanumeric() && c != '^').unwrap_or(unit.len())
}

/// The problem with `word`, if ron has read only a part of it as a number: the rest of a sentence that starts with the field.
pub(super) fn cut_number_problem(word: &str) -> String {
    if let Ok(value) = word.replace('_', "").parse::<f64>() {
        return match whole(value) {
            Some(whole) => format!("must be a whole number: write {whole}"),
            None if value.is_finite() && value.fract() != 0.0 => {
                "must be a whole number, without a fraction".into()
            }
            // f64 may not represent it exactly.
            None if (0.0..u64::MAX as f64).contains(&value) => "must be a whole number in digits only".into(),
            None => format!("must be {OUT_OF_RANGE}"),
        };
    }
    if let Some(whole) = whole_number(word) {
        return format!("must be a number in digits: write {whole}");
    }
    match word.find(|c: char| !(c.is_ascii_digit() || "_.+-".contains(c))) {
        Some(end) => with_unit(&word[..end], &word[end..]),
        None => format!("must be a single number, not `{word}`"),
    }
}

/// The whole number that a person means by `text`: 600000, 600_000, 6e5 or 600k.
#[must_use]
pub fn whole_number(text: &str) -> Option<u64> {
    let is_grouped = text.split('_').all(|group| group.contains(|c: char| c.is_ascii_digit()));
    let digits = text.replace('_', "");
    if !is_grouped || !digits.starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    if let Ok(value) = digits.parse() {
        return Some(value);
    }
    // An exponent is exact. A product is not: 2.01 times 1000 is less than 2010.
    let (number, exponent) = match digits.char_indices().next_back()? {
        (end, 'k' | 'K') => (&digits[..end], "e3"),
        (end, 'M') => (&digits[..end], "e6"),
        (end, 'G') => (&digits[..end], "e9"),
        _ => (digits.as_str(), ""),
    };
    format!("{number}{exponent}").parse().ok().and_then(whole)
}

/// The RON `text` with its whole numbers in digits: `EnvSteps(600000)` for `EnvSteps(600k)` and `EnvSteps(6e5)`.
pub fn with_plain_numbers(text: &str) -> String {
    let (mut plain, mut end) = (String::new(), 0);
    for word in tokens(text) {
        plain += &text[end..word.start];
        end = word.end;
        let word = &text[word];
        let whole = whole_number(word).filter(|_| word.contains(char::is_alphabetic));
        plain += &whole.map_or_else(|| word.to_owned(), |whole| whole.to_string());
    }
    plain + &text[end..]
}

/// The problem with a `number` that has a unit, as the rest of a sentence. The suggested number is in the format's own unit.
pub(super) fn with_unit(number: &str, unit: &str) -> String {
    if OWN_UNITS.contains(&unit) {
        return format!("must be a number only: write {number}, without `{unit}`");
    }
    let Some(factor) = factor(unit) else {
        return format!("must be a number only, in the unit of the field, without `{unit}`");
    };
    match number.parse::<f64>() {
        Ok(value) => format!("must be a number only: write {} for {number} {unit}", (value * factor) as f32),
        Err(_) => format!("must be a number only, without `{unit}`"),
    }
}

/// `value` as a whole number, if it is one and f64 represents it exactly.
fn whole(value: f64) -> Option<u64> {
    ((0.0..=9e15).contains(&value) && value.fract() == 0.0).then_some(value as u64)
}

/// The range of a number with commas around `offset`, where ron expected a field or a closing bracket, and the problem with
/// it: a decimal comma, or commas between groups of digits.
pub(super) fn comma_problem(text: &str, offset: usize) -> Option<(Range<usize>, String)> {
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, ',' | '.' | '_');
    let start = text[..offset].trim_end_matches(is_part).len();
    let end = offset + text[offset..].find(|c| !is_part(c)).unwrap_or(text.len() - offset);
    let number = text[start..end].trim_end_matches(',');
    let groups: Vec<&str> = number.split(',').collect();
    let (_, before) = groups.split_last()?;
    let joined = groups.concat();
    if before.is_empty()
        || !groups.iter().all(|group| group.starts_with(|c: char| c.is_ascii_digit()))
        || before.iter().any(|group| group.contains('.'))
        || joined.replace('_', "").parse::<f64>().is_err()
    {
        return None;
    }
    let range = start..start + number.len();
    let decimal = number.replacen(',', ".", 1);
    let are_thousands =
        groups[1..].iter().all(|group| group.split('.').next().is_some_and(|digits| digits.len() == 3))
            && !groups[0].starts_with('0');
    let message = match (groups.len(), are_thousands) {
        (2, false) if !number.contains('.') => format!("a decimal comma: write {decimal}"),
        (_, false) => return None,
        (2, true) if joined.contains('.') || groups[0].len() > 1 => {
            format!("a comma inside a number: write {joined}")
        }
        (2, true) => format!("a comma inside a number: write {joined} or {decimal}"),
        (_, true) => format!("commas inside a number: write {joined}"),
    };
    Some((range, message))
}

/// The problem with a pair in `brackets` that was written with decimal commas, such as `(0,6, 1,2)`.
pub(super) fn pair_problem(brackets: &str) -> Option<String> {
    let inner = brackets.strip_prefix('(')?.strip_suffix(')')?;
    let numbers: Vec<&str> = inner.split(", ").map(str::trim).collect();
    let fixed: Vec<String> = numbers.iter().map(|number| number.replacen(',', ".", 1)).collect();
    let are_numbers = fixed.iter().all(|number| number.parse::<f32>().is_ok());
    (are_numbers && inner.matches(',').count() >= numbers.len())
        .then(|| format!("decimal commas: write ({})", fixed.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_with_a_suffix_is_exact() {
        for (text, value) in
            [("2.01k", 2_010), ("16.06K", 16_060), ("4.35M", 4_350_000), ("1.001G", 1_001_000_000)]
        {
            assert_eq!(whole_number(text), Some(value), "{text}");
        }
        assert_eq!(whole_number("1.0005k"), None);
    }

    #[test]
    fn the_number_suggested_for_a_number_with_commas_is_valid() {
        let found = |text: &str| {
            let end = text.rfind(',').map(|comma| comma + 1)?;
            comma_problem(text, end).map(|(_, message)| message)
        };
        assert_eq!(found("0,5").as_deref(), Some("a decimal comma: write 0.5"));
        assert_eq!(found("1,000.5").as_deref(), Some("a comma inside a number: write 1000.5"));
        for text in ["1.234,56", "1.5,200", "1,2.3", "12,345.6.7", "1,234.5,678"] {
            assert_eq!(found(text), None, "{text}");
        }
    }
}
