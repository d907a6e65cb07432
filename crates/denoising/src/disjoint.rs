//! Disjoint sets of numbered items.

/// The representative of the set of `item`, given a parent of each item, its own for a
/// representative. All items on the way then have it as their parent.
pub(crate) fn root(parents: &mut [u32], item: u32) -> u32 {
    let mut top = item;
    while parents[top as usize] != top {
        top = parents[top as usize];
    }
    let mut at = item;
    while at != top {
        at = std::mem::replace(&mut parents[at as usize], top);
    }
    top
}
