//! What a scene says itself, and what it leaves to the preset; errors found later in a place of the file.

use super::Scene;
use super::address::Address;
use super::levers;
use super::params::PRESET;
use super::params::{ActuatorModel, LawChoice, LeverSpec, OutsideForce};
use super::paths::LAW;
use super::quantities::QUANTITIES;
use super::scene_error::{Fault, SceneError};
use crate::kernel::Attraction;
use crate::units::{Dimension, format as written};

/// Parts of the instrument of which many values from the preset are told together: what the paths begin with, which of
/// them are told one by one all the same, and the part's name.
static PARTS: [(&str, &[&str], &str); 3] = [
    ("instrument.actuator.", &["quality_factor"], "the rod"),
    ("instrument.cantilever.", &["quality_factor"], "the lever"),
    ("instrument.tip.", &["radius", "youngs_modulus", "poisson_ratio"], "the tip's shape"),
];
/// From so many on.
const MANY: usize = 3;

impl Scene {
    /// The quantities that matter to the scene and that it does not give, by section or axis: their paths and values,
    /// SI, in the order of the resolved scene. They have the preset's values; of a listed mode, its default.
    pub fn from_preset(&self) -> Vec<(String, f64)> {
        let modes = match &self.base.instrument.cantilever.lever {
            LeverSpec::Modes(modes) => modes.len(),
            _ => 0,
        };
        let listed = |index| Address::find(&format!("instrument.cantilever.modes.{index}.quality_factor"));
        let single = QUANTITIES.iter().filter_map(|quantity| Address::find(quantity.path));
        single
            .chain((0..modes).filter_map(listed))
            .filter(|address| self.matters(*address) && !self.says(&address.path()))
            .filter_map(|address| Some((address.path(), address.get(&self.base)?)))
            .collect()
    }

    /// The same in one line for people; none where the scene gives all.
    pub fn preset_line(&self) -> Option<String> {
        let named =
            |(path, _): &(String, f64)| self.lever.is_some() && levers::GIVEN.contains(&path.as_str());
        let (makers, papers): (Vec<_>, Vec<_>) = self.from_preset().into_iter().partition(named);
        let makers = self.lever.zip(told(&makers)).map(|(lever, values)| {
            format!("from the preset {}, nominal values (calibrate your lever): {values}", lever.preset)
        });
        let papers = told(&papers).map(|values| format!("from the preset {PRESET}: {values}"));
        let lines: Vec<String> = makers.into_iter().chain(papers).collect();
        (!lines.is_empty()).then(|| lines.join("; "))
    }
    fn says(&self, path: &str) -> bool {
        self.said.iter().any(|said| said.path == path)
    }

    /// Whether the quantity has an effect under the scene's choices.
    fn matters(&self, address: Address) -> bool {
        let (base, path) = (&self.base, address.quantity.path);
        // Where laws are swept each of them counts.
        let swept = self.sweep.quantities().any(|axis| axis.path == LAW);
        let law = if swept { LawChoice::Auto } else { base.contact.law };
        let lever = &base.instrument.cantilever.lever;
        let radius = base.contact.outside.iter().any(OutsideForce::needs_radius);
        match path {
            // A table is the whole force.
            "instrument.tip.radius" if law == LawChoice::Sum => radius,
            "instrument.tip.youngs_modulus" | "instrument.tip.poisson_ratio" if law == LawChoice::Sum => {
                false
            }
            _ if path.starts_with("sample.") && law == LawChoice::Sum => false,
            "instrument.cantilever.quality_factor" => !matches!(lever, LeverSpec::Modes(_)),
            "instrument.tip.poisson_ratio" => {
                law != LawChoice::None
                    && (base.instrument.tip.youngs_modulus.is_finite()
                        || self.sweep.quantities().any(|axis| axis.path == "instrument.tip.youngs_modulus"))
            }
            "instrument.tip.radius" => law != LawChoice::None && base.instrument.tip.shape.has_radius(),
            "instrument.tip.half_angle" => true,
            "instrument.tip.youngs_modulus" => law != LawChoice::None,
            "sample.surface_energy" | "sample.hamaker" => law.attraction() != Some(Attraction::None),
            "contact.decay_length" => matches!(law.attraction(), None | Some(Attraction::Distant)),
            _ if path.starts_with("instrument.actuator.") => {
                base.instrument.actuator.model != ActuatorModel::Rigid
            }
            // The inertia of the tip is part of a calibrated lever.
            _ if path.starts_with("instrument.tip.") => matches!(lever, LeverSpec::Dimensions { .. }),
            _ if path.starts_with("sample.") => law != LawChoice::None,
            _ => true,
        }
    }

    /// An error that came to light after reading, at the place of whichever of `paths` the scene says, the first one
    /// first; of the file as a whole where it says none of them.
    pub fn refusal(
        &self,
        paths: &[&str],
        title: &str,
        found: &str,
        expected: &str,
        help: &str,
    ) -> SceneError {
        let below = |said: &str, path: &str| {
            said.strip_prefix(path).is_some_and(|rest| rest.is_empty() || rest.starts_with('.'))
        };
        let said = paths.iter().find_map(|path| {
            // An axis replaces what a section says, and is said last.
            self.said.iter().rev().find(|said| below(&said.path, path))
        });
        let fault = match said {
            Some(said) => Fault::at(said.key.clone(), title),
            None => Fault::whole(title),
        };
        let source = self.source.strip_prefix('\u{FEFF}').unwrap_or(&self.source);
        fault.label(found).expected(expected).help(help).in_file(&self.path, source)
    }
}

/// Paths and values in one line, those of a part that has many together.
fn told(taken: &[(String, f64)]) -> Option<String> {
    let part_of = |path: &str| {
        PARTS.iter().find(|(prefix, alone, _)| {
            path.strip_prefix(prefix).is_some_and(|key| !key.contains('.') && !alone.contains(&key))
        })
    };
    let name_of = |path: &str| part_of(path).map(|(_, _, name)| *name);
    let mut parts: Vec<String> = Vec::new();
    for (place, (path, value)) in taken.iter().enumerate() {
        let name = name_of(path);
        let same = |(other, _): &&(String, f64)| name.is_some() && name_of(other) == name;
        let count = taken.iter().filter(same).count();
        if count < MANY {
            let dimension = Address::find(path).map_or(Dimension::Dimensionless, |at| at.quantity.dimension);
            let shown = if value.is_infinite() { "inf".to_owned() } else { written(*value, dimension) };
            parts.push(format!("{path} {shown}"));
        } else if !taken[..place].iter().any(|one| same(&one)) {
            parts.push(format!("{count} values of {}", name.unwrap_or_default()));
        }
    }
    (!parts.is_empty()).then(|| parts.join(", "))
}
