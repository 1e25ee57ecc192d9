//! The alignment of a changed list with the old one: pairs of corresponding elements.
//!
//! Elements keep their order. A changed element is recognised by the fields that are still equal to those of the old one.

use crate::value::Value;

/// The maximum number of pairs that are compared. Elements of longer lists are paired in order.
const MAX_PAIRS: usize = 250_000;
/// The similarity of two equal elements. The similarity of two different elements is at most a quarter of it.
const EQUAL: u32 = 1000;

/// For each element of `new`, the index of the corresponding element of `old`, or `None` if it has been added.
pub(crate) fn align(old: &[Value], new: &[Value]) -> Vec<Option<usize>> {
    let shorter = old.len().min(new.len());
    let front = (0..shorter).take_while(|&k| old[k] == new[k]).count();
    let back = (0..shorter - front).take_while(|&k| old[old.len() - 1 - k] == new[new.len() - 1 - k]).count();
    let middle = best_pairing(&old[front..old.len() - back], &new[front..new.len() - back]);
    let mut aligned: Vec<_> = (0..front).map(Some).collect();
    aligned.extend(middle.into_iter().map(|k| k.map(|k| k + front)));
    aligned.extend((old.len() - back..old.len()).map(Some));
    aligned
}

/// The pairing with the greatest total similarity. Among equally good ones, it pairs the earliest elements.
fn best_pairing(old: &[Value], new: &[Value]) -> Vec<Option<usize>> {
    if old.len().saturating_mul(new.len()) > MAX_PAIRS {
        return (0..new.len()).map(|k| (k < old.len()).then_some(k)).collect();
    }
    let width = new.len() + 1;
    // best[i * width + j]: the greatest total similarity of old[i..] and new[j..].
    let mut best = vec![0; (old.len() + 1) * width];
    let pair =
        |best: &[u32], i: usize, j: usize| similarity(&old[i], &new[j]) + best[(i + 1) * width + j + 1];
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

/// The similarity of two elements: [`EQUAL`] if they are equal, otherwise the number of equal fields.
fn similarity(old: &Value, new: &Value) -> u32 {
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
