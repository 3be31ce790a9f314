//! Words that people bring from papers and other programs, and what they are called here.

/// What a word stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Meant {
    /// A key of a scene or an observable, by its name.
    Name(&'static str),
    /// Nothing of that name: what to do instead.
    Instead(&'static str),
}

use Meant::{Instead, Name};

const FLUID: Meant =
    Instead("there is no fluid model: give the lever's frequency and quality factor as measured in it");
const ELASTIC: Meant = Instead("samples are elastic: only jkr loses energy");
const WAYS: Meant = Instead(
    "amplitude and phase there and back are a [curve] with direction = \"both\" (afmsweep init --curve); the force of a \
     slow approach and retraction is afmsweep force --lever",
);
const PARALLEL: Meant = Instead("all cores work; --threads N takes fewer");

/// Letters count as they are written; failing that, in small ones.
static SYNONYMS: &[(Meant, &[&str])] = &[
    (Name("stiffness"), &["k", "spring_constant", "force_constant"]),
    (Name("quality_factor"), &["Q", "q_factor", "quality"]),
    (Name("frequency"), &["f0", "f", "resonance_frequency", "natural_frequency", "eigenfrequency"]),
    (Name("youngs_modulus"), &["E", "modulus", "elastic_modulus"]),
    (Name("poisson_ratio"), &["nu", "poisson"]),
    (Name("surface_energy"), &["gamma", "w", "adhesion", "work_of_adhesion", "adhesion_energy"]),
    (Name("hamaker"), &["hamaker_constant", "H"]),
    (Name("radius"), &["R", "tip_radius"]),
    (Name("free_amplitude"), &["A0", "free_amp", "amplitude_free"]),
    (Name("decay_length"), &["D0", "a0", "z0", "intermolecular_distance"]),
    (Name("gap"), &["z", "zc", "distance", "separation", "tip_sample_distance", "height"]),
    (Name("periods"), &["cycles", "duration", "time"]),
    (Name("steps_per_period"), &["dt", "time_step", "steps"]),
    (Name("accuracy"), &["tolerance", "tol", "rtol"]),
    (Name("law"), &["contact_law", "contact_model"]),
    (Name("force_max"), &["peak_force", "max_force", "force"]),
    (Name("force_min"), &["min_force", "adhesion_force", "pull_off"]),
    (Name("force_mean"), &["mean_force", "average_force"]),
    (Name("indentation_max"), &["indentation", "deformation", "penetration"]),
    (Name("dissipation"), &["energy", "dissipated_energy", "loss"]),
    (Name("phase"), &["phase_shift", "phase_lag"]),
    (Name("harmonic_amplitude"), &["harmonics"]),
    (Name("setpoint"), &["sp", "set_point", "amplitude_ratio"]),
    (WAYS, &["hysteresis", "retract", "retraction", "approach_curve", "snap_in", "jump_to_contact"]),
    (Name("deflection_amplitude"), &["deflection"]),
    (ELASTIC, &["viscosity"]),
    (Instead("a lever's damping is its `quality_factor`; samples are elastic"), &["damping"]),
    (FLUID, &["medium", "fluid"]),
    (Instead("there is no thermal noise"), &["temperature"]),
    (PARALLEL, &["threads", "cores"]),
];

/// What the word stands for, if it is one of these.
pub fn meant(word: &str) -> Option<Meant> {
    let of = |word: &str| SYNONYMS.iter().find(|(_, words)| words.contains(&word)).map(|(meant, _)| *meant);
    of(word).or_else(|| of(&word.to_lowercase()))
}

/// The help for a word that is none of the known ones, where it stands for one of them or for nothing here.
pub(super) fn help<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> Option<String> {
    match meant(word)? {
        Name(name) => known.into_iter().any(|one| one == name).then(|| format!("here that is `{name}`")),
        Instead(text) => Some(text.to_owned()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::observe::Observable;
    use crate::scene::QUANTITIES;

    /// Truth: the program's own lists.
    #[test]
    fn every_synonym_stands_for_something_that_there_is() {
        let run = super::super::output::KEYS;
        let is_key = |name: &str| QUANTITIES.iter().any(|one| one.path.ends_with(&format!(".{name}")));
        for (meant, words) in SYNONYMS {
            let Name(name) = meant else { continue };
            let known =
                is_key(name) || run.contains(name) || *name == "law" || Observable::from_name(name).is_some();
            assert!(known && !words.contains(name), "{words:?} -> {name}");
        }
        let mut words: Vec<&str> = SYNONYMS.iter().flat_map(|(_, words)| *words).copied().collect();
        words.sort_unstable();
        assert!(words.windows(2).all(|pair| pair[0] != pair[1]), "{words:?}");
    }

    #[test]
    fn letters_count_first_as_they_are_written() {
        assert_eq!(meant("A0"), Some(Name("free_amplitude")));
        assert_eq!(meant("a0"), Some(Name("decay_length")));
        assert_eq!(meant("Spring_Constant"), Some(Name("stiffness")));
        assert_eq!(help("k", ["frequency"]), None);
        assert_eq!(help("k", ["stiffness"]).as_deref(), Some("here that is `stiffness`"));
        assert!(help("fluid", []).is_some_and(|text| text.contains("no fluid model")));
    }
}
