//! Which element of a changed list was which before.
//!
//! In: the lists before and after. Out: for each element after, the one before that it is, or none if it is new.
//! Elements keep their order; one that has changed is recognised by what it still shares.

use super::tree::Node;

/// The most pairs that are compared; longer stretches are paired in order.
const MOST_PAIRS: usize = 250_000;
/// What a pair that is equal is worth; less for one that only shares something.
const EQUAL: u32 = 1000;

/// For each of `new`, its index in `old`.
pub(super) fn align(old: &[Node], new: &[Node]) -> Vec<Option<usize>> {
    let shorter = old.len().min(new.len());
    let front = (0..shorter).take_while(|&k| old[k] == new[k]).count();
    let back = (0..shorter - front).take_while(|&k| old[old.len() - 1 - k] == new[new.len() - 1 - k]).count();
    let middle = between(&old[front..old.len() - back], &new[front..new.len() - back]);
    let mut aligned: Vec<_> = (0..front).map(Some).collect();
    aligned.extend(middle.into_iter().map(|k| k.map(|k| k + front)));
    aligned.extend((old.len() - back..old.len()).map(Some));
    aligned
}

/// The pairing of greatest worth. Of several, the one that pairs what comes first.
fn between(old: &[Node], new: &[Node]) -> Vec<Option<usize>> {
    if old.len().saturating_mul(new.len()) > MOST_PAIRS {
        return (0..new.len()).map(|k| (k < old.len()).then_some(k)).collect();
    }
    let width = new.len() + 1;
    // best[i * width + j]: the worth of pairing old[i..] with new[j..].
    let mut best = vec![0; (old.len() + 1) * width];
    let pair = |best: &[u32], i: usize, j: usize| worth(&old[i], &new[j]) + best[(i + 1) * width + j + 1];
    for i in (0..old.len()).rev() {
        for j in (0..new.len()).rev() {
            let skip = best[(i + 1) * width + j].max(best[i * width + j + 1]);
            best[i * width + j] = pair(&best, i, j).max(skip);
        }
    }
    let mut aligned = vec![None; new.len()];
    let (mut i, mut j) = (0, 0);
    while i < old.len() && j < new.len() {
        let here = best[i * width + j];
        if here == pair(&best, i, j) {
            aligned[j] = Some(i);
            (i, j) = (i + 1, j + 1);
        } else if here == best[(i + 1) * width + j] {
            i += 1;
        } else {
            j += 1;
        }
    }
    aligned
}

/// What it is worth to call `new` the same element as `old`.
fn worth(old: &Node, new: &Node) -> u32 {
    if old == new {
        return EQUAL;
    }
    match (old.record(), new.record()) {
        (Some(old), Some(new)) => {
            let shared = old.fields.iter().zip(&new.fields).filter(|(old, new)| old == new).count();
            u32::try_from(shared).unwrap_or(u32::MAX).min(EQUAL / 4)
        }
        _ => 0,
    }
}
