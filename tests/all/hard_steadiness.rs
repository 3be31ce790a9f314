//! Status ok means settled, over every measured period: hard choices of what is measured.

use crate::checks;
use crate::checks::{one_mode, sample};
use afmsweep::observe::Status;
use afmsweep::scene::{LawChoice, Scene};

/// A stiff lever with Q = 400 tapping, which takes about a thousand periods to settle.
fn tapping(periods: u32, measure: u32) -> Scene {
    one_mode(40.0, 300e3, 400.0, 20e-9, 14e-9, |scene| {
        sample(scene, LawChoice::Dmt, 1e9, 0.03, 10e-9);
        scene.run.periods = periods;
        scene.run.measure = measure;
    })
}

#[test]
fn settled_tapping_is_ok() {
    assert_eq!(checks::one(&tapping(3000, 20), None).status, Status::Ok);
}

#[test]
fn a_measured_part_that_reaches_back_to_the_start_is_not_steady() {
    for (periods, measure) in [(3000, 3000), (3000, 2900), (40, 20), (2, 1), (1, 1)] {
        let status = checks::one(&tapping(periods, measure), None).status;
        assert_eq!(status, Status::NotSteady, "{measure} of {periods} periods");
    }
}

#[test]
fn without_a_drive_nothing_moves_and_that_is_steady() {
    let scene = one_mode(40.0, 300e3, 400.0, 0.0, 14e-9, |scene| {
        sample(scene, LawChoice::Hertz, 1e9, 0.0, 10e-9);
    });
    let finished = checks::one(&scene, None);
    assert_eq!(finished.status, Status::Ok);
    assert!(finished.measured.harmonics[0] < 1e-20);
}
