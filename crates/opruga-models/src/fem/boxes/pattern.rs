//! The nonzero entries of the small matrices of boxes.
//!
//! In a hexahedron with right angles, 7 of 49 entries of one matrix and 21 of 144 entries of the other are nonzero. In other
//! cells all entries are nonzero. Leaving out the zeros changes neither the sums nor the order of their terms.

/// The entries of a matrix that may be nonzero, by rows and by columns.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Pattern {
    pub(super) rows: Lists,
    pub(super) columns: Lists,
}

/// Lists of small numbers, one after the other.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Lists {
    ends: Vec<u8>,
    items: Vec<u8>,
}

impl Lists {
    fn new(lists: usize, of: impl Fn(usize, usize) -> bool) -> Self {
        let mut out = Lists::default();
        for list in 0..lists {
            out.items.extend((0..lists).filter(|k| of(list, *k)).map(|k| k as u8));
            out.ends.push(out.items.len() as u8);
        }
        out
    }
    /// The numbers of a list, ascending.
    #[inline(always)]
    pub(super) fn of(&self, list: usize) -> impl Iterator<Item = usize> + '_ {
        let from = if list == 0 { 0 } else { self.ends[list - 1] };
        self.items[from as usize..self.ends[list] as usize].iter().map(|k| usize::from(*k))
    }
}

impl Pattern {
    /// The pattern of a square matrix with `size` rows.
    pub(super) fn new(size: usize, is: impl Fn(usize, usize) -> bool) -> Self {
        Pattern { rows: Lists::new(size, &is), columns: Lists::new(size, |column, row| is(row, column)) }
    }
    pub(super) fn heap_bytes(&self) -> usize {
        let bytes = |lists: &Lists| lists.ends.capacity() + lists.items.capacity();
        bytes(&self.rows) + bytes(&self.columns)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pattern_lists_its_entries_by_rows_and_by_columns() {
        let pattern = Pattern::new(3, |i, j| i == j || (i, j) == (0, 2));
        let lists = |lists: &Lists| (0..3).map(|k| lists.of(k).collect::<Vec<_>>()).collect::<Vec<_>>();
        assert_eq!(lists(&pattern.rows), [vec![0, 2], vec![1], vec![2]]);
        assert_eq!(lists(&pattern.columns), [vec![0], vec![1], vec![0, 2]]);
    }
}
