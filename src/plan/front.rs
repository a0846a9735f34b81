//! Items that are better than all cheaper items.

/// The items of `(cost, error, item)` by ascending cost, each with less error than all items before.
pub(crate) fn front<T>(mut priced: Vec<(f64, f64, T)>) -> impl Iterator<Item = T> {
    priced.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let mut least = f64::INFINITY;
    priced.into_iter().filter_map(move |(_, error, item)| {
        let before = least;
        least = least.min(error);
        (error < before).then_some(item)
    })
}
