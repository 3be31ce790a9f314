//! The drive's strength must be said in a way that drives what the scene has: the rod, a rigid base or the tip.

use super::draft::{Draft, Said};
use super::params::{ActuatorModel, DriveOn};
use super::paths::{CALIBRATION, LEVELS, MODES, NAME_ROD};
use super::scene_error::{Checked, Fault};

const TIP_LEVELS: &str = "force or free_amplitude, as for any drive on the tip";
const BASE_LEVELS: &str = "base_amplitude or free_amplitude, as for a rigid base";
const ROD_LEVELS: &str = "voltage or free_amplitude, as for a drive by the rod";

pub(super) fn check(draft: &Draft) -> Checked<()> {
    match draft.first_of(&LEVELS) {
        Some(level) => level_fits(draft, level),
        None => preset_fits(draft),
    }
}

fn on_tip(draft: &Draft) -> bool {
    draft.params.drive.on == DriveOn::Tip
}

fn on_rigid_base(draft: &Draft) -> bool {
    draft.params.instrument.actuator.model == ActuatorModel::Rigid
}

/// Where the scene names the actuator's model, if it does.
fn chosen_model(draft: &Draft) -> Option<&Said> {
    draft.first_of(&["instrument.actuator.model"])
}

/// Without a level in the scene the preset's voltage drives, which takes a rod.
fn preset_fits(draft: &Draft) -> Checked<()> {
    if on_tip(draft) {
        return Err(Fault::at(draft.place_of("drive.on"), "the drive on the tip has no strength")
            .label("the preset's voltage drives the rod, not the tip")
            .expected("force or free_amplitude in [drive]")
            .help("add a line such as force = \"2 nN\" or free_amplitude = \"20 nm\""));
    }
    if !on_rigid_base(draft) {
        return Ok(());
    }
    let chosen = chosen_model(draft);
    let lever = || draft.first_of(&CALIBRATION).or_else(|| draft.first_under(MODES));
    let place = chosen.or_else(lever).map_or(0..0, |said| said.key.clone());
    if draft.first_under("drive").is_none() {
        return Err(Fault::at(place, "nothing drives this lever: the scene has no [drive]")
            .label("it stands on a rigid base")
            .expected("[drive] with a frequency and a strength")
            .help(format!(
                "add [drive] with on = \"tip\", frequency = \"resonance\" and free_amplitude = \"20 nm\", say, or {NAME_ROD}"
            )));
    }
    Err(Fault::at(place, "the rigid base has no motion")
        .label(match chosen {
            Some(_) => "there is no rod for the preset's voltage to drive",
            None => "this lever stands on a rigid base, as the scene names no rod",
        })
        .expected("base_amplitude or free_amplitude in [drive]")
        .help(match chosen {
            Some(_) => {
                "add a line such as base_amplitude = \"1 nm\", or drive the tip with on = \"tip\"".to_string()
            }
            None => format!(
                "add a line such as base_amplitude = \"1 nm\", drive the tip with on = \"tip\", or {NAME_ROD}"
            ),
        }))
}

/// A level in the scene has to drive what the drive acts on.
fn level_fits(draft: &Draft, level: &Said) -> Checked<()> {
    let (on_tip, rigid) = (on_tip(draft), on_rigid_base(draft));
    let refuse = |title: &str, expected: &str, help: &str| {
        Err(Fault::at(level.key.clone(), title)
            .label(format!("found `{}`", level.path))
            .expected(expected)
            .help(help))
    };
    match level.path.as_str() {
        "drive.voltage" if on_tip => refuse(
            "a voltage does not drive the tip",
            TIP_LEVELS,
            "give force = \"2 nN\", or remove on = \"tip\"",
        ),
        "drive.base_amplitude" if on_tip => refuse(
            "a base amplitude does not drive the tip",
            TIP_LEVELS,
            "remove on = \"tip\" and take the actuator model \"rigid\"",
        ),
        "drive.force" if !on_tip => refuse(
            "a force drives the tip, not the actuator",
            if rigid { BASE_LEVELS } else { ROD_LEVELS },
            "add on = \"tip\" to [drive]",
        ),
        "drive.voltage" if rigid => refuse(
            "a rigid base has no rod for a voltage",
            BASE_LEVELS,
            &match chosen_model(draft) {
                Some(_) => "give base_amplitude = \"1 nm\", or another actuator model".to_string(),
                None => format!("give base_amplitude = \"1 nm\", or {NAME_ROD}"),
            },
        ),
        "drive.base_amplitude" if !rigid => refuse(
            "a base amplitude needs a rigid base",
            ROD_LEVELS,
            "add model = \"rigid\" to [instrument.actuator]",
        ),
        _ => Ok(()),
    }
}
