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
static SYNONYMS: &[(&str, Meant)] = &[
    ("k", Name("stiffness")),
    ("spring_constant", Name("stiffness")),
    ("force_constant", Name("stiffness")),
    ("Q", Name("quality_factor")),
    ("q_factor", Name("quality_factor")),
    ("quality", Name("quality_factor")),
    ("f0", Name("frequency")),
    ("f", Name("frequency")),
    ("resonance_frequency", Name("frequency")),
    ("natural_frequency", Name("frequency")),
    ("eigenfrequency", Name("frequency")),
    ("E", Name("youngs_modulus")),
    ("modulus", Name("youngs_modulus")),
    ("elastic_modulus", Name("youngs_modulus")),
    ("nu", Name("poisson_ratio")),
    ("poisson", Name("poisson_ratio")),
    ("gamma", Name("surface_energy")),
    ("w", Name("surface_energy")),
    ("adhesion", Name("surface_energy")),
    ("work_of_adhesion", Name("surface_energy")),
    ("adhesion_energy", Name("surface_energy")),
    ("hamaker_constant", Name("hamaker")),
    ("H", Name("hamaker")),
    ("R", Name("radius")),
    ("tip_radius", Name("radius")),
    ("A0", Name("free_amplitude")),
    ("free_amp", Name("free_amplitude")),
    ("amplitude_free", Name("free_amplitude")),
    ("D0", Name("decay_length")),
    ("a0", Name("decay_length")),
    ("z0", Name("decay_length")),
    ("intermolecular_distance", Name("decay_length")),
    ("z", Name("gap")),
    ("zc", Name("gap")),
    ("distance", Name("gap")),
    ("separation", Name("gap")),
    ("tip_sample_distance", Name("gap")),
    ("height", Name("gap")),
    ("cycles", Name("periods")),
    ("duration", Name("periods")),
    ("time", Name("periods")),
    ("dt", Name("steps_per_period")),
    ("time_step", Name("steps_per_period")),
    ("steps", Name("steps_per_period")),
    ("tolerance", Name("accuracy")),
    ("tol", Name("accuracy")),
    ("rtol", Name("accuracy")),
    ("contact_law", Name("law")),
    ("contact_model", Name("law")),
    ("peak_force", Name("force_max")),
    ("max_force", Name("force_max")),
    ("force", Name("force_max")),
    ("min_force", Name("force_min")),
    ("adhesion_force", Name("force_min")),
    ("pull_off", Name("force_min")),
    ("mean_force", Name("force_mean")),
    ("average_force", Name("force_mean")),
    ("indentation", Name("indentation_max")),
    ("deformation", Name("indentation_max")),
    ("penetration", Name("indentation_max")),
    ("energy", Name("dissipation")),
    ("dissipated_energy", Name("dissipation")),
    ("loss", Name("dissipation")),
    ("phase_shift", Name("phase")),
    ("phase_lag", Name("phase")),
    ("harmonics", Name("harmonic_amplitude")),
    ("sp", Name("setpoint")),
    ("set_point", Name("setpoint")),
    ("amplitude_ratio", Name("setpoint")),
    ("hysteresis", WAYS),
    ("retract", WAYS),
    ("retraction", WAYS),
    ("approach_curve", WAYS),
    ("snap_in", WAYS),
    ("jump_to_contact", WAYS),
    ("deflection", Name("deflection_amplitude")),
    ("viscosity", ELASTIC),
    ("damping", Instead("a lever's damping is its `quality_factor`; samples are elastic")),
    ("medium", FLUID),
    ("fluid", FLUID),
    ("temperature", Instead("there is no thermal noise")),
    ("threads", PARALLEL),
    ("cores", PARALLEL),
];

/// What the word stands for, if it is one of these.
pub fn meant(word: &str) -> Option<Meant> {
    let of = |word: &str| SYNONYMS.iter().find(|(name, _)| *name == word).map(|(_, meant)| *meant);
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
        for (word, meant) in SYNONYMS {
            let Name(name) = meant else { continue };
            let known =
                is_key(name) || run.contains(name) || *name == "law" || Observable::from_name(name).is_some();
            assert!(known, "{word} -> {name}");
            assert_ne!(word, name);
        }
        let mut words: Vec<&str> = SYNONYMS.iter().map(|(word, _)| *word).collect();
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
