//! Sorting of items by nodes: first into a bucket for each node, then within each bucket.

/// Sorts items that are ordered first by a node number below `nodes`. The result is that of `sort_unstable`, but the time is proportional to the
/// number of items.
pub(crate) fn sorted_by_node<T: Copy + Ord>(items: &[T], nodes: usize, node: impl Fn(&T) -> u32) -> Vec<T> {
    let Some(first) = items.first() else { return Vec::new() };
    // The start of each bucket; while it is filled, the position of its next item.
    let mut offsets = vec![0u32; nodes + 1];
    items.iter().for_each(|item| offsets[node(item) as usize + 1] += 1);
    for bucket in 0..nodes {
        offsets[bucket + 1] += offsets[bucket];
    }
    let mut out = vec![*first; items.len()];
    for item in items {
        let next = &mut offsets[node(item) as usize];
        out[*next as usize] = *item;
        *next += 1;
    }
    let mut begin = 0;
    for end in offsets[..nodes].iter().map(|end| *end as usize) {
        if end - begin > 1 {
            out[begin..end].sort_unstable();
        }
        begin = end;
    }
    out
}

/// One more than the largest node number.
pub(crate) fn nodes_of<const N: usize>(lists: &[[u32; N]]) -> usize {
    lists.iter().flatten().max().map_or(0, |largest| *largest as usize + 1)
}

#[cfg(test)]
mod tests {
    use super::{nodes_of, sorted_by_node};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn buckets_give_the_order_of_a_sort(items in proptest::collection::vec([0..9u32, 0..50, 0..4], 0..60)) {
            let mut sorted = items.clone();
            sorted.sort_unstable();
            prop_assert_eq!(sorted_by_node(&items, nodes_of(&items), |item| item[0]), sorted);
        }
    }
}
