//! The nearest known word to one that is not known, for "did you mean" in messages.

/// The candidate closest to `word`, if it is close enough to be what was meant.
///
/// Case counts for nothing, and about one slip in three letters is forgiven.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted: Vec<char> = word.to_lowercase().chars().take(64).collect();
    let forgiven = 1.max(wanted.len() / 3);
    candidates
        .into_iter()
        .map(|candidate| {
            // A word cut short or drawn out, as "linear" for "lin", is as near as one slip.
            let other: Vec<char> = candidate.to_lowercase().chars().collect();
            let cut = wanted.len().min(other.len()) >= 3 && wanted.iter().zip(&other).all(|(a, b)| a == b);
            (if cut { distance(&wanted, candidate).min(1) } else { distance(&wanted, candidate) }, candidate)
        })
        .filter(|&(distance, candidate)| distance <= forgiven && distance < candidate.chars().count())
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
}

/// Letters to insert, drop, change or swap with their neighbour to turn one word into the other.
fn distance(a: &[char], b: &str) -> usize {
    let b: Vec<char> = b.to_lowercase().chars().collect();
    let mut before = vec![0; b.len() + 1];
    let mut last: Vec<usize> = (0..=b.len()).collect();
    for i in 1..=a.len() {
        let mut row = vec![i; b.len() + 1];
        for j in 1..=b.len() {
            let change = usize::from(a[i - 1] != b[j - 1]);
            row[j] = (last[j] + 1).min(row[j - 1] + 1).min(last[j - 1] + change);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                row[j] = row[j].min(before[j - 2] + 1);
            }
        }
        before = std::mem::replace(&mut last, row);
    }
    last[b.len()]
}

#[cfg(test)]
mod tests {
    use super::nearest;

    #[test]
    fn slips_are_forgiven_and_strangers_are_not() {
        let known = ["youngs_modulus", "poisson_ratio", "radius"];
        assert_eq!(nearest("young_modulus", known), Some("youngs_modulus"));
        assert_eq!(nearest("raduis", known), Some("radius"));
        assert_eq!(nearest("Radius", known), Some("radius"));
        assert_eq!(nearest("temperature", known), None);
        assert_eq!(nearest("linear", ["log", "lin"]), Some("lin"));
        assert_eq!(nearest("ha-fung-chen", ["ha-fung-chen-2005"]), Some("ha-fung-chen-2005"));
        assert_eq!(nearest("", known), None);
        // A one-letter word must not turn into any other one-letter word.
        assert_eq!(nearest("x", ["m", "V"]), None);
    }
}
