//! What the paper could not do: its three parameters at once, under each of the three laws.

mod maps;

use super::super::scene_run::{SceneRun, run, scene};
use super::super::{Numbers, StudyError};
use super::{ENSEMBLE, Extent, LAWS, Picture};
use crate::contact::{Contact, DMT_BELOW, JKR_ABOVE, SMALL_STRAIN, StaticLaw};
use crate::engine::Finished;
use crate::observe::Status;
use crate::scene::LawChoice;
use std::f64::consts::PI;
use std::path::Path;

const CHOICES: [LawChoice; 3] = [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr];
/// Tip radii that the maps show, m.
const RADII: [f64; 3] = [10e-9, 30e-9, 100e-9];
/// Laws closer than this in their largest force are as good as each other.
const TENTH: f64 = 0.1;

pub(super) fn find(numbers: &mut Numbers, folder: &Path, extent: Extent) -> Result<Vec<Picture>, StudyError> {
    let mut runs = Vec::new();
    for (choice, (law, name)) in CHOICES.into_iter().zip(LAWS) {
        let ran = run(scene("scenes/paper/ensemble.toml", ENSEMBLE, |scene| {
            scene.base.contact.law = choice;
            scene.title = format!("{}: {name}", scene.title);
            if extent == Extent::Shown {
                scene.sweep.axes[0].values = RADII.to_vec().into();
            }
        })?)?;
        ran.save(&folder.join(format!("ensemble_{law}.h5")))?;
        summary(numbers, &ran, law, name);
        runs.push(ran);
    }
    regimes(numbers, &runs);
    letting_go(numbers, &runs[2]);
    Ok(maps::draw(&runs))
}

/// Smallest, median and largest of the finite values; NaN without any.
fn spread(values: impl Iterator<Item = f64>) -> [f64; 3] {
    let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    match values.as_slice() {
        [] => [f64::NAN; 3],
        [first, .., last] => [*first, values[values.len() / 2], *last],
        [only] => [*only; 3],
    }
}

fn usable(one: &Finished) -> bool {
    one.status == Status::Ok
}

fn summary(numbers: &mut Numbers, ran: &SceneRun, law: &str, name: &str) {
    let all = &ran.outcome.results;
    let mut add = |what: &str, meaning: &str, value: f64, units: &'static str| {
        numbers.add(format!("ensemble.{law}.{what}"), format!("{meaning}, {name}"), value, units);
    };
    let share = |count: usize| count as f64 / all.len() as f64;
    add("instances", "instances", all.len() as f64, "1");
    let unsteady = all.iter().filter(|one| one.status == Status::NotSteady).count();
    add("not_steady", "share that does not settle", share(unsteady), "1");
    let lost = all.iter().filter(|one| !usable(one) && one.status != Status::NotSteady).count();
    add("failed", "share without a result", share(lost), "1");
    let sound = || all.iter().filter(|one| usable(one)).map(|one| one.measured);
    // A tip that never lets go has nothing to lose.
    let losing = || sound().filter(|one| one.contacts > 0.0);
    let kinds: [(&str, &str, &'static str, [f64; 3]); 4] = [
        ("force_max", "largest force", "N", spread(sound().map(|one| one.force_max))),
        ("depth", "largest deformation", "m", spread(sound().map(|one| one.indentation_max))),
        ("contact_time", "share of the period in contact", "1", spread(sound().map(|one| one.contact_time))),
        ("loss", "loss per period", "J", spread(losing().map(|one| one.dissipation))),
    ];
    for (what, meaning, units, [least, middle, most]) in kinds {
        add(&format!("{what}.least"), &format!("{meaning}, smallest"), least, units);
        add(&format!("{what}.median"), &format!("{meaning}, median"), middle, units);
        add(&format!("{what}.most"), &format!("{meaning}, largest"), most, units);
    }
}

/// Where on the grid which law belongs, and what taking another one does.
fn regimes(numbers: &mut Numbers, runs: &[SceneRun]) {
    let jkr = &runs[2];
    let contacts: Vec<Contact> = jkr.plan.cases().map(|case| case.contact).collect();
    let share = |count: usize| count as f64 / contacts.len() as f64;
    let of = |fits: &dyn Fn(f64) -> bool| share(contacts.iter().filter(|one| fits(one.tabor())).count());
    numbers.add("regime.dmt", "share of the grid where DMT fits, μ < 0.1", of(&|mu| mu < DMT_BELOW), "1");
    let between = of(&|mu| (DMT_BELOW..=JKR_ABOVE).contains(&mu));
    numbers.add("regime.between", "share between DMT and JKR", between, "1");
    numbers.add("regime.jkr", "share where JKR fits, μ > 5", of(&|mu| mu > JKR_ABOVE), "1");
    let strained = contacts.iter().zip(&jkr.outcome.results).filter(|(contact, one)| {
        contact.contact_radius(one.measured.indentation_max, true) > SMALL_STRAIN * contact.radius
    });
    numbers.add("regime.strained", "share where a/R passes 0.3 under JKR", share(strained.count()), "1");
    for (other, (law, name)) in runs.iter().zip(LAWS).take(2) {
        let pairs = other.outcome.results.iter().zip(&jkr.outcome.results);
        let near = pairs.filter(|(a, b)| {
            let (a, b) = (a.measured.force_max, b.measured.force_max);
            (a - b).abs() <= TENTH * b.abs()
        });
        let meaning = format!("share where the largest force under {name} is within 10 % of that under JKR");
        numbers.add(format!("regime.{law}_near"), meaning, share(near.count()), "1");
    }
}

/// How far the free tip comes up above the sample less what the pull at the fold takes it down, m: a contact
/// whose fold lies higher never ends.
fn reach(ran: &SceneRun, instance: usize) -> f64 {
    let case = ran.plan.case(instance as u32);
    let driven = ran.plan.driven(instance as u32);
    let pull = 5.0 / 6.0 * PI * case.contact.work * case.contact.radius;
    driven.free_amplitude() + case.gap - pull * driven.kept.flexibility
}

/// Whether JKR lets go, against its closed forms: where the fold lies, and what a tap loses.
fn letting_go(numbers: &mut Numbers, ran: &SceneRun) {
    let all = &ran.outcome.results;
    let (mut held, mut agreed, mut taps, mut close, mut worst) = (0, 0, 0, 0, 0.0f64);
    let mut errors = Vec::new();
    for (instance, one) in all.iter().enumerate() {
        let contact = ran.plan.contact(instance as u32);
        let Some(jkr) = contact.jkr() else { continue };
        let never = one.measured.contacts == 0.0;
        held += usize::from(never);
        agreed += usize::from(never == (-jkr.release() > reach(ran, instance)));
        if usable(one) && one.measured.contacts == 1.0 {
            let exact = jkr.loss_per_cycle();
            let off = (one.measured.dissipation - exact).abs();
            taps += 1;
            close += usize::from(off <= ran.scene.run.accuracy * exact);
            errors.push(off / exact);
            // What the sample stores and gives back, the scale on which a small loss is a difference.
            let stored = jkr.energy(one.measured.indentation_max, true) - jkr.energy(jkr.zero_force(), true);
            worst = worst.max(off / (stored + exact));
        }
    }
    let share = |count: usize| count as f64 / all.len() as f64;
    numbers.add("jkr.never", "share where JKR never lets go", share(held), "1");
    let meaning = "share where the fold's height foretells that";
    numbers.add("jkr.foretold", meaning, share(agreed), "1");
    numbers.add("jkr.single_taps", "share with one tap a period", share(taps), "1");
    let [_, median, _] = spread(errors.into_iter());
    numbers.add("jkr.loss_error", "loss per tap against its closed form, median error", median, "1");
    let meaning = "share of those taps whose loss is within 1 % of the closed form";
    numbers.add("jkr.loss_close", meaning, close as f64 / taps.max(1) as f64, "1");
    let meaning = "largest error of the loss over the energy stored at the deepest point";
    numbers.add("jkr.loss_error_stored", meaning, worst, "1");
}
