//! The seeds of an experiment: a number of them, or a list.

use std::fmt;

use serde::de::{Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::limits::experiment::MAX_SEEDS;

/// The seeds of an experiment.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Seeds {
    /// The seeds from 1 to this number.
    First(u64),
    /// These seeds.
    List(Vec<u64>),
}

impl Default for Seeds {
    fn default() -> Self {
        Self::First(5)
    }
}

impl Seeds {
    /// The number of seeds.
    #[must_use]
    pub fn count(&self) -> u64 {
        match self {
            Self::First(n) => *n,
            Self::List(seeds) => seeds.len() as u64,
        }
    }

    /// The seeds, in the order in which they were given.
    #[must_use]
    pub fn list(&self) -> Vec<u64> {
        match self {
            Self::First(n) => (1..=*n).collect(),
            Self::List(seeds) => seeds.clone(),
        }
    }

    /// The value of `--seeds` for these seeds. A trailing comma makes a single number a list.
    pub(super) fn flag_value(&self) -> String {
        match self {
            Self::First(n) => n.to_string(),
            Self::List(seeds) => {
                let list = seeds.iter().map(u64::to_string).collect::<Vec<_>>().join(",");
                if seeds.len() == 1 { list + "," } else { list }
            }
        }
    }

    /// At most the first `most` seeds.
    #[must_use]
    pub fn at_most(&self, most: u64) -> Self {
        match self {
            Self::First(n) => Self::First(most.min(*n)),
            Self::List(seeds) => Self::List(seeds.iter().copied().take(most as usize).collect()),
        }
    }

    /// A seed that is given more than once; `None` if all are different.
    #[must_use]
    pub fn duplicate(&self) -> Option<u64> {
        let Self::List(seeds) = self else { return None };
        let mut sorted = seeds.clone();
        sorted.sort_unstable();
        sorted.windows(2).find(|pair| pair[0] == pair[1]).map(|pair| pair[0])
    }
}

/// Different seeds, in increasing order, as text for a report: "1 to 5", or "3, 17, 42".
pub(super) fn seeds_text(seeds: &[u64]) -> String {
    match seeds {
        [first, .., last] if *first == 1 && *last == seeds.len() as u64 => format!("1 to {last}"),
        seeds => seeds.iter().map(u64::to_string).collect::<Vec<_>>().join(", "),
    }
}

impl Serialize for Seeds {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::First(n) => n.serialize(serializer),
            Self::List(seeds) => seeds.serialize(serializer),
        }
    }
}

impl<'de> Deserialize<'de> for Seeds {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(SeedsVisitor)
    }
}

struct SeedsVisitor;

impl<'de> Visitor<'de> for SeedsVisitor {
    type Value = Seeds;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a number of seeds, such as 5, or a list of seeds, such as [3, 17, 42]")
    }

    fn visit_u64<E: serde::de::Error>(self, n: u64) -> Result<Seeds, E> {
        Ok(Seeds::First(n))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Seeds, A::Error> {
        let mut seeds = Vec::new();
        while let Some(seed) = list.next_element()? {
            seeds.push(seed);
            // One too many is read, so that the check of the experiment reports it like any other problem.
            if seeds.len() > MAX_SEEDS as usize + 1 {
                let expected = format!("at most {MAX_SEEDS} seeds");
                return Err(A::Error::invalid_length(seeds.len(), &expected.as_str()));
            }
        }
        Ok(Seeds::List(seeds))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn seeds_are_a_number_or_a_list() {
        let read = |text: &str| crate::scenario::parse_ron::<Vec<Seeds>>(text, "seeds.ron");
        let seeds = read("[5, [3, 17, 42]]").expect("both forms are read");
        assert_eq!(seeds, [Seeds::First(5), Seeds::List(vec![3, 17, 42])]);
        assert_eq!((seeds[0].list(), seeds[1].list()), (vec![1, 2, 3, 4, 5], vec![3, 17, 42]));
        assert_eq!((seeds[0].at_most(2), seeds[1].at_most(2)), (Seeds::First(2), Seeds::List(vec![3, 17])));
        let text = crate::scenario::to_ron(&seeds).expect("they are written");
        assert_eq!(read(&text), Ok(seeds), "written and read again");
        for wrong in ["[\"5\"]", "[-1]", "[[1.5]]", "[(a: 1)]"] {
            assert!(read(wrong).is_err(), "{wrong}");
        }
        assert_eq!(Seeds::List(vec![3, 1, 3]).duplicate(), Some(3));
        assert_eq!(
            (seeds_text(&[1, 2, 3]), seeds_text(&[3, 17]), seeds_text(&[1])),
            ("1 to 3".into(), "3, 17".into(), "1".into())
        );
    }
}
