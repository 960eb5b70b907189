//! Near-miss names.

/// The candidate nearest to `name`, if it is near enough to be a slip of the pen: at most a third of the letters
/// differ (one for short names), counting a swap of neighbours as one difference, or only the case differs.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    /// Longer names are not compared: the work is quadratic.
    const MAX_NAME: usize = 64;
    if name.len() > MAX_NAME {
        return None;
    }
    let lower = name.to_lowercase();
    let allowed = (name.chars().count() / 3).max(1);
    candidates
        .into_iter()
        .filter(|c| c.len() <= MAX_NAME)
        .map(|c| (distance(&lower, &c.to_lowercase()), c))
        // A name of one letter is near to every other; only its case may be wrong.
        .filter(|(d, c)| {
            *d <= allowed && (*d == 0 || name.chars().count().max(c.chars().count()) > 1)
        })
        // `sine` means `sin` rather than `sinh`: letters added at the end are the commonest slip.
        .min_by_key(|(d, c)| (*d, !name.starts_with(c), c.len().abs_diff(name.len())))
        .map(|(_, c)| c)
}

/// The number of letters inserted, left out, changed or swapped (Damerau's distance, adjacent swaps only).
fn distance(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut rows = vec![(0..=b.len()).collect::<Vec<_>>()];
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let change = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            row[j] = change.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(rows[i - 2][j - 2] + 1);
            }
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}
