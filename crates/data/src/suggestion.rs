//! The nearest known word to one that is not known, for "did you mean" in messages.

/// The candidate closest to `word`, if it is close enough to be what was meant.
///
/// Case counts for nothing, and about one slip in three letters is forgiven.
pub fn nearest<'a>(word: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let wanted: String = word.to_lowercase().chars().take(64).collect();
    let length = wanted.chars().count();
    let forgiven = 1.max(length / 3);
    candidates
        .into_iter()
        .map(|candidate| {
            // A word cut short or drawn out, as "linear" for "lin", is as near as one slip.
            let other = candidate.to_lowercase();
            let rest = wanted.strip_prefix(&other).or(other.strip_prefix(&wanted));
            // The section of a path is no such word.
            let cut =
                length.min(other.chars().count()) >= 3 && rest.is_some_and(|rest| !rest.starts_with('.'));
            // Letters to insert, drop, change or swap with their neighbour to turn one word into the other.
            let distance = strsim::osa_distance(&wanted, &other);
            (if cut { distance.min(1) } else { distance }, candidate)
        })
        .filter(|&(distance, candidate)| distance <= forgiven && distance < candidate.chars().count())
        .min_by_key(|&(distance, _)| distance)
        .map(|(_, candidate)| candidate)
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
        // A path with a slip is not its section.
        assert_eq!(nearest("tip.raduis", ["tip", "tip.radius"]), Some("tip.radius"));
        // A one-letter word must not turn into any other one-letter word.
        assert_eq!(nearest("x", ["m", "V"]), None);
    }
}
