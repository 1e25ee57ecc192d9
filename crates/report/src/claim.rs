//! Results of claims.

/// The result of a claim: whether the data support it, with the numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ClaimResult {
    /// The claim.
    pub claim: String,
    /// Whether the claim held.
    pub outcome: ClaimOutcome,
    /// The numbers behind the outcome, in a sentence.
    pub sentence: String,
    /// The [`Section::id`](crate::page::Section::id) of the section that shows the data.
    pub anchor: String,
}

/// Whether the data support a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ClaimOutcome {
    /// The data support the claim.
    Held,
    /// The data support neither the claim nor its opposite.
    NotShown,
    /// The data support the opposite.
    Reversed,
}

impl ClaimOutcome {
    /// The outcome as a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::NotShown => "not shown",
            Self::Reversed => "reversed",
        }
    }

    /// The outcome as a symbol. The symbols differ in shape, so that they do not depend on colour.
    #[must_use]
    pub fn glyph(self) -> char {
        match self {
            Self::Held => '\u{2713}',
            Self::NotShown => '\u{25cb}',
            Self::Reversed => '\u{2717}',
        }
    }
}

/// The number of claims with each outcome, as a sentence; `None` without claims.
pub(crate) fn tally(claims: &[ClaimResult]) -> Option<String> {
    let count = |outcome| claims.iter().filter(|claim| claim.outcome == outcome).count();
    let counts: Vec<_> = [ClaimOutcome::Held, ClaimOutcome::NotShown, ClaimOutcome::Reversed]
        .into_iter()
        .filter(|&outcome| count(outcome) > 0)
        .map(|outcome| format!("{} {}", count(outcome), outcome.word()))
        .collect();
    let all = if claims.len() == 1 { "1 claim".to_owned() } else { format!("{} claims", claims.len()) };
    (!claims.is_empty()).then(|| format!("{all}: {}.", counts.join(", ")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tally_counts_each_outcome() {
        let claim = |outcome| ClaimResult {
            claim: String::new(),
            outcome,
            sentence: String::new(),
            anchor: String::new(),
        };
        let claims = [ClaimOutcome::Held, ClaimOutcome::Reversed, ClaimOutcome::Held].map(claim);
        assert_eq!(tally(&claims).as_deref(), Some("3 claims: 2 held, 1 reversed."));
        assert_eq!(tally(&[claim(ClaimOutcome::NotShown)]).as_deref(), Some("1 claim: 1 not shown."));
        assert_eq!(tally(&[]), None);
    }
}
