//! Waveforms in the results file against what the physics says of them.
//! Truth: a start at rest, closed forms of the contact laws, modal superposition without a sample,
//! and Fourier sums over whole periods.

use crate::program::{Desk, scenes, variable};
use afmsweep::contact::{Contact, Law};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use afmsweep::store::Waveforms;
use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

fn paper_scenes() -> Vec<PathBuf> {
    let found: Vec<PathBuf> =
        scenes().into_iter().filter(|path| path.to_str().unwrap().contains("paper_fig4_")).collect();
    assert_eq!(found.len(), 3);
    found
}

/// Amplitude and lag (degree) of the fundamental over the whole row, which holds whole periods.
fn fundamental(row: &[f64], periods: usize) -> (f64, f64) {
    let (mut cosine, mut sine) = (0.0, 0.0);
    for (sample, value) in row.iter().enumerate() {
        let angle = TAU * (sample * periods) as f64 / row.len() as f64;
        cosine += value * angle.cos();
        sine += value * angle.sin();
    }
    let scale = 2.0 / row.len() as f64;
    // A sin(angle - lag) = A cos(lag) sin - A sin(lag) cos.
    (scale * f64::hypot(cosine, sine), (-cosine).atan2(sine).to_degrees().rem_euclid(360.0))
}

fn largest(row: &[f64]) -> f64 {
    row.iter().fold(0.0, |most, value| f64::max(most, value.abs()))
}

#[test]
fn the_papers_runs_start_at_rest_and_obey_their_law() {
    let desk = Desk::new();
    for path in paper_scenes() {
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let waveforms: Waveforms = desk.run(&path, &[]).waveforms.unwrap();
        let (time, travel) = (&waveforms.time[0], &waveforms.tip_travel[0]);
        let (indentation, force) = (&waveforms.indentation[0], &waveforms.force[0]);
        let top = &waveforms.actuator_top[0];
        assert_eq!(time.len(), 256 * 12);
        for (sample, time) in time.iter().enumerate() {
            let expected = sample as f64 / 256.0 / 30e3;
            assert!((time - expected).abs() <= 1e-15 * time.abs().max(1e-4), "{name}: {time} {expected}");
        }
        // At rest: no travel, and none to speak of a 256th of a period (0.13 us) later.
        assert!(travel[0].abs() < 1e-16, "{name}: {}", travel[0]);
        assert!(top[0].abs() < 1e-16, "{name}: {}", top[0]);
        assert!(travel[1].abs() < 1e-3 * largest(travel), "{name}: {}", travel[1]);
        assert!(largest(travel) > 5e-9, "{name}");

        let contact = Contact::new(&Scene::load(&path).unwrap().base);
        let mut forces = 0;
        let mut touching = false;
        for (sample, (delta, force)) in indentation.iter().zip(force).enumerate() {
            assert!(
                (delta + 0.3e-9 + travel[sample]).abs() < 1e-22,
                "{name}: indentation is -(gap + travel)"
            );
            touching = contact.next_contact(*delta, touching);
            // With memory the step in which contact begins belongs to either side.
            let either = contact.law == Law::Jkr && (delta.abs() < 0.2e-9);
            let expected = contact.force(*delta, touching);
            let fits = (force - expected).abs() <= 1e-12 * expected.abs();
            assert!(fits || (either && *force == 0.0), "{name} {sample}: {force} {expected} at {delta}");
            forces += usize::from(*force != 0.0);
        }
        assert!(forces > 100, "{name}: {forces} samples feel the sample");
        // 15 V at 30 kHz: 6.2 nm of steady motion under the transients of an undamped rod.
        let (amplitude, _) = fundamental(top, 12);
        assert!((amplitude - 6.2e-9).abs() < 0.3e-9, "{name}: the rod's top moves {amplitude}");
        assert!(largest(top) < 2.5 * 6.2e-9 && largest(top) > 6.2e-9, "{name}: {}", largest(top));
    }
}

/// Out of the sample's reach, a start from rest is the superposition of all the instrument's modes.
#[test]
fn waveforms_from_rest_are_the_modal_superposition() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(&paper_scenes()[1]).unwrap();
    let text = text.replace("law = \"hertz\"", "law = \"none\"");
    assert!(text.contains("\"none\""));
    let path = desk.write("free.toml", &text);
    let waveforms = desk.run(&path, &[]).waveforms.unwrap();
    let plan = Plan::new(&Scene::load(&path).unwrap(), Precision::F64).unwrap();
    let driven = &plan.drives[0];
    for (row, of_tip) in [(&waveforms.tip_travel[0], true), (&waveforms.actuator_top[0], false)] {
        let scale = largest(row);
        let free = &driven.free;
        let mut worst: f64 = 0.0;
        for (time, value) in waveforms.time[0].iter().zip(row) {
            let (exact, _) = match of_tip {
                true => free.tip_from_rest(&driven.instrument, *time, &[]),
                false => free.top_from_rest(&driven.instrument, *time, &[]),
            };
            worst = worst.max((value - exact).abs() / scale);
        }
        // Between steps the motion is a cubic through four of them: a tenth of the accuracy asked for.
        assert!(worst < 1e-4, "{of_tip}: {worst:e}");
    }
}

/// What the waveform shows is what the observables measured.
#[test]
fn steady_waveforms_carry_the_observables() {
    let desk = Desk::new();
    for (name, law, gap, extra) in [
        ("hertz", "law = \"hertz\"", "14 nm", ""),
        ("dmt", "law = \"dmt\"\ndecay_length = \"0.5 nm\"", "14 nm", ""),
        ("jkr", "law = \"jkr\"", "15 nm", ""),
        ("tip", "law = \"hertz\"", "10 nm", "on = \"tip\"\n"),
    ] {
        let path = desk.write(
            &format!("{name}.toml"),
            &format!(
                "[instrument.cantilever]\nquality_factor = 25\n[instrument.actuator]\nquality_factor = 40\n\
                 [sample]\nyoungs_modulus = \"500 MPa\"\nsurface_energy = \"10 mJ/m^2\"\n\
                 [contact]\n{law}\n[drive]\n{extra}frequency = \"resonance\"\nfree_amplitude = \"20 nm\"\n\
                 [approach]\ngap = \"{gap}\"\n[run]\nperiods = 600\nmeasure = 4\nsteps_per_period = 2048\n\
                 [output]\nobservables = [\"amplitude\", \"phase\", \"force_max\", \"force_min\", \"indentation_max\", \"contacts\"]\n\
                 waveforms = {{ instances = [0], samples_per_period = 4096, periods = 4 }}\n"
            ),
        );
        let results = desk.run(&path, &[]);
        assert_eq!(results.status, [0], "{name} is steady");
        assert_eq!(variable(&results, "contacts"), [1.0], "{name}: taps once a period");
        let waveforms = results.waveforms.as_ref().unwrap();
        let (amplitude, phase) = fundamental(&waveforms.tip_travel[0], 4);
        let stored = variable(&results, "amplitude")[0];
        assert!(stored < 19e-9, "{name}: the sample limits the swing to {stored}");
        assert!((amplitude - stored).abs() < 1e-4 * 20e-9, "{name}: {amplitude} {stored}");
        let apart = phase - variable(&results, "phase")[0];
        assert!(apart.abs() < 0.01, "{name}: phase {phase}, {apart} off");
        let deepest = waveforms.indentation[0].iter().copied().fold(f64::MIN, f64::max);
        let stored = variable(&results, "indentation_max")[0];
        assert!((deepest - stored).abs() < 1e-4 * 20e-9, "{name}: {deepest} {stored}");
        let force = &waveforms.force[0];
        let (low, high) =
            (force.iter().copied().fold(f64::MAX, f64::min), force.iter().copied().fold(f64::MIN, f64::max));
        let (least, most) = (variable(&results, "force_min")[0], variable(&results, "force_max")[0]);
        let scale = most.max(-least);
        assert!((high - most).abs() < 1e-3 * scale, "{name}: {high} {most}");
        // A cusp of the force (DMT at touch) lies between two samples.
        assert!(low >= least - 1e-3 * scale && low < least + 0.02 * scale, "{name}: {low} {least}");
        // Time starts at a zero of the drive and the rod's top follows at the drive's frequency.
        assert_eq!(waveforms.time[0][0], 0.0, "{name}");
        let plan = Plan::new(&Scene::load(&path).unwrap(), Precision::F64).unwrap();
        let free = &plan.drives[0].free;
        let length = waveforms.time[0][4096] * free.omega;
        assert!((length - TAU).abs() < 1e-12, "{name}: {length}");
        if extra.is_empty() {
            let (top, lag) = fundamental(&waveforms.actuator_top[0], 4);
            assert!((top / free.top.norm() - 1.0).abs() < 0.05, "{name}: {top} {}", free.top.norm());
            let expected = (-free.top.arg() * 180.0 / PI).rem_euclid(360.0);
            assert!((lag - expected).abs() < 5.0, "{name}: {lag} {expected}");
        }
    }
}
