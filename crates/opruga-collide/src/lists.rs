//! Long lists that waste little memory.

/// A list that is too short becomes longer by an eighth of the needed length. A list that doubles wastes up to half of its memory, and one that grows by
/// less is copied more often (`long_lists_are_at_most_an_eighth_longer_than_needed`).
const GROWTH: usize = 8;

/// The least number of items by which a list becomes longer, so that short lists do not grow item by item.
const LEAST: usize = 64;

/// Makes room for more items in a list.
pub(crate) fn reserve<T>(list: &mut Vec<T>, more: usize) {
    if list.capacity() - list.len() < more {
        list.reserve_exact((more + (list.len() + more) / GROWTH).max(LEAST));
    }
}

/// Sets the length of a list. New items have the given value.
pub(crate) fn resize<T: Clone>(list: &mut Vec<T>, length: usize, value: T) {
    reserve(list, length.saturating_sub(list.len()));
    list.resize(length, value);
}

/// Adds an item to a list.
#[inline(always)]
pub(crate) fn push<T>(list: &mut Vec<T>, item: T) {
    if list.len() == list.capacity() {
        reserve(list, 1);
    }
    list.push(item);
}

/// Moves all items of a list to the end of another one.
pub(crate) fn append<T>(to: &mut Vec<T>, from: &mut Vec<T>) {
    if to.is_empty() {
        std::mem::swap(to, from);
    } else {
        reserve(to, from.len());
        to.append(from);
    }
}

/// Brings items into an order, given the present index of every item in that order. The list `indices` is overwritten. The items are swapped within
/// their list, because a second list would take as much memory as the first one.
pub(crate) fn bring_into_order<T>(items: &mut [T], order: &[u32], indices: &mut Vec<u32>) {
    indices.resize(items.len(), 0);
    for (index, k) in order.iter().enumerate() {
        indices[*k as usize] = index as u32;
    }
    for k in 0..items.len() {
        while indices[k] as usize != k {
            let index = indices[k] as usize;
            items.swap(k, index);
            indices.swap(k, index);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn items_come_into_any_order() {
        let mut state = 7_u32;
        for length in 0..50 {
            let mut order: Vec<u32> = (0..length).collect();
            for k in (1..order.len()).rev() {
                state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                order.swap(k, (state >> 16) as usize % (k + 1));
            }
            let mut items: Vec<u32> = (0..length).map(|k| 10 * k).collect();
            bring_into_order(&mut items, &order, &mut Vec::new());
            assert!(items.iter().zip(&order).all(|(item, k)| *item == 10 * k), "{items:?} {order:?}");
        }
    }

    #[test]
    fn long_lists_are_at_most_an_eighth_longer_than_needed() {
        let (mut list, mut length) = (Vec::new(), 0);
        for k in 0..100_000 {
            push(&mut list, k);
            length += 1;
            assert!(list.capacity() <= length + (length / 8 + 1).max(LEAST), "{} for {length}", list.capacity());
        }
    }
}
