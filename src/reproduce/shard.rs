//! Shards: the parts of a plan that several machines execute independently of each other.
//!
//! In: a plan, the number of a part, and the number of parts. Out: the plan of that part. Training runs that start from each
//! other's weights stay together, and the parts take about equally long. The division depends only on the plan and the number
//! of parts, so every machine makes the same one.

use std::collections::BTreeMap;
use std::fmt;
use std::str::FromStr;

use super::plan::{PlannedRun, RunPlan};
use super::progress::gradient_steps;

/// The largest number of shards.
const MAX_SHARDS: usize = 100_000;

/// One of several parts of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// The number of the part, 1 to `count`.
    number: usize,
    /// The number of parts.
    count: usize,
}

impl FromStr for Shard {
    type Err = String;

    /// Parses a shard such as "2/8".
    fn from_str(text: &str) -> Result<Self, String> {
        let numbers = text.split_once('/').and_then(|(k, n)| Some((k.parse().ok()?, n.parse().ok()?)));
        match numbers {
            Some((number, count)) if (1..=count).contains(&number) && count <= MAX_SHARDS => {
                Ok(Self { number, count })
            }
            _ => Err(format!("give K/N, such as 2/8: part K, from 1 to N, of at most {MAX_SHARDS} parts")),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

impl Shard {
    /// The end of the names of this shard's files, such as "-2-of-8".
    pub(super) fn suffix(self) -> String {
        format!("-{}-of-{}", self.number, self.count)
    }

    /// This part of `plan`: its training runs, without the arms.
    pub(super) fn of(self, plan: &RunPlan) -> RunPlan {
        let mut part = RunPlan::default();
        let chains = self.chains(plan);
        let mut indices = BTreeMap::new();
        for (index, training) in plan.training_runs.iter().enumerate() {
            if chains.contains(&root(plan, index)) {
                indices.insert(index, part.training_runs.len());
                let mut training = training.clone();
                training.origin = training.origin.and_then(|origin| indices.get(&origin).copied());
                part.training_runs.push(training);
            }
        }
        part
    }

    /// The chains of training runs in this part, as the indices of their first runs. A chain is a run and all that start from
    /// its weights, directly or not. The chains are distributed, the longest first, each to the part that has the least to do.
    fn chains(self, plan: &RunPlan) -> Vec<usize> {
        let mut costs: BTreeMap<usize, f64> = BTreeMap::new();
        for (index, training) in plan.training_runs.iter().enumerate() {
            *costs.entry(root(plan, index)).or_default() += cost(training);
        }
        let mut chains: Vec<(usize, f64)> = costs.into_iter().collect();
        let name = |index: usize| &plan.training_runs[index].name;
        chains.sort_by(|(a, x), (b, y)| y.total_cmp(x).then_with(|| name(*a).cmp(name(*b))));
        let mut loads = vec![0.0; self.count];
        let mut mine = Vec::new();
        for (chain, cost) in chains {
            let least = (0..self.count).min_by(|&a, &b| f64::total_cmp(&loads[a], &loads[b])).unwrap_or(0);
            loads[least] += cost;
            if least + 1 == self.number {
                mine.push(chain);
            }
        }
        mine
    }
}

/// The cost of a run in gradient steps. A run that was trained elsewhere is only tested.
fn cost(training: &PlannedRun) -> f64 {
    if training.elsewhere.is_some() { 1.0 } else { gradient_steps(training, training.config.preset.budget) }
}

/// The index of the first training run in the chain of run `index`.
fn root(plan: &RunPlan, mut index: usize) -> usize {
    while let Some(origin) = plan.training_runs[index].origin {
        index = origin;
    }
    index
}
