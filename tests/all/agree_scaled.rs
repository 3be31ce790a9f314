//! Levers scaled from one reduction, beside reductions of their own.

use afmsweep::design::Mix;
use afmsweep::instrument::{Instrument, Pattern};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{ActuatorModel, DriveOn, InstrumentParams, LeverSpec, QualityFactor, Scene};
use afmsweep::store::Attribute;
use afmsweep::{Audit, Backend, Sweep};

/// A lever of a random stiffness (0.01 to 1,000 N/m), frequency (1 kHz to 10 MHz) and quality factors.
fn lever(number: u64) -> InstrumentParams {
    let share = |place: u64| Mix::new(19).of(number).of(place).share();
    let mut params = InstrumentParams::default();
    params.actuator.model = ActuatorModel::Rigid;
    params.cantilever.lever = LeverSpec::Calibrated {
        stiffness: 0.01 * 1e5f64.powf(share(0)),
        frequency: 1e3 * 1e4f64.powf(share(1)),
    };
    params.cantilever.quality_factor = match number % 3 {
        0 => QualityFactor::All(f64::INFINITY),
        1 => QualityFactor::All(1000.0 * share(2) + 1.0),
        _ => QualityFactor::PerMode(vec![200.0 * share(2) + 1.0, 1e3, 50.0]),
    };
    params
}

/// Of every mode that meets the accuracy, frequency, tip and drive agree to what rounding does to the fastest of them: a
/// frequency comes from an eigenvalue that is (slowest/fastest)^2 of the largest.
#[test]
fn a_scaled_lever_is_the_reduced_one_to_rounding() {
    let mut worst: f64 = 0.0;
    for on in [DriveOn::Tip, DriveOn::Actuator] {
        let pattern = Pattern::new(on, 1e-8).unwrap();
        for number in 0..300 {
            let params = lever(number);
            let scaled = pattern.instrument(&params).unwrap().unwrap();
            let reduced = Instrument::reduce(&params, on, 1e-8).unwrap();
            assert_eq!((scaled.modes.len(), scaled.resolved), (reduced.modes.len(), reduced.resolved));
            assert_eq!((scaled.order, scaled.beam_elements), (reduced.order, reduced.beam_elements));
            let mut off = |a: f64, b: f64, ratio: f64, what: &str| {
                let miss = if a == b { 0.0 } else { (a / b - 1.0).abs() };
                assert!(miss < 64.0 * f64::EPSILON * ratio * ratio, "{what} of {number}: {a:e}, not {b:e}");
                worst = worst.max(miss);
            };
            off(scaled.lever_frequency, reduced.lever_frequency, 1.0, "lever frequency");
            off(scaled.flexibility(), reduced.flexibility(), 1.0, "flexibility");
            for (a, b) in scaled.modes.iter().zip(&reduced.modes).take(reduced.resolved) {
                let ratio = b.omega / reduced.modes[0].omega;
                off(a.omega, b.omega, ratio, "frequency");
                off(a.tip, b.tip, ratio, "tip");
                off(a.drive.abs(), b.drive.abs(), ratio, "drive");
                assert_eq!(a.quality_factor, b.quality_factor);
                assert_eq!(a.tip * a.drive > 0.0, b.tip * b.drive > 0.0);
            }
        }
    }
    println!("largest difference {worst:.1e}");
    assert!(worst < 1e-9, "{worst:e}");
}

/// A rod, a tip's mass or dimensions decide more than scale.
#[test]
fn other_levers_are_not_scaled() {
    let calibrated = lever(1);
    assert!(Pattern::serves(&calibrated));
    assert!(!Pattern::serves(&InstrumentParams::default()));
    let mut coupled = calibrated.clone();
    coupled.actuator.model = ActuatorModel::Coupled;
    assert!(!Pattern::serves(&coupled));
    let mut heavy = calibrated;
    heavy.tip.mass = afmsweep::scene::TipMass::Given(1e-15);
    assert!(!Pattern::serves(&heavy));
    let mut bad = lever(2);
    bad.cantilever.lever = LeverSpec::Calibrated { stiffness: -1.0, frequency: 1e5 };
    let pattern = Pattern::new(DriveOn::Tip, 1e-8).unwrap();
    assert!(pattern.instrument(&bad).unwrap().unwrap_err().to_string().contains("stiffness"));
}
/// Rows of Saltelli's design between two points A and B share the lever of one of them unless they change it themselves: of
/// the 8 rows over 6 quantities, 2 of them the lever's, 4 have levers of their own.
#[test]
fn rows_that_share_a_lever_share_its_instrument() {
    let text = std::fs::read_to_string(crate::program::scene("sensitivity.toml")).unwrap();
    let text = text.replace("samples = 2048", "samples = 32");
    let scene = Scene::parse("sensitivity.toml".as_ref(), &text).unwrap();
    let plan = Plan::new(&scene, Precision::F64).unwrap();
    assert_eq!((plan.len(), plan.ensemble.drives.len()), (32 * 8, 32 * 4));
    for i in 0..plan.len() as u32 {
        let own = scene.instance(i as usize).instrument.cantilever;
        let LeverSpec::Calibrated { stiffness, .. } = own.lever else { panic!() };
        let first = plan.ensemble.drive(plan.id(i)).free.first_mode;
        assert!((first.1 / stiffness - 1.0).abs() < 1e-9, "{i}: {first:?}, not {stiffness}");
    }
}

/// Samples are numbered, which makes no neighbours: they begin at the nearest in what they are made of.
#[test]
fn samples_begin_at_the_nearest_not_at_the_next() {
    let text = std::fs::read_to_string(crate::program::scene("sensitivity.toml")).unwrap();
    let text = text.replace("samples = 2048", "samples = 256");
    let scene = Scene::parse("sensitivity.toml".as_ref(), &text).unwrap();
    let plan = Plan::new(&scene, Precision::F64).unwrap();
    let grid = plan.ensemble.grid.as_ref().unwrap();
    assert_eq!(grid.axes.iter().map(|axis| axis.order.len()).collect::<Vec<_>>(), [0]);
    let run = Sweep::new(scene).backend(Backend::Cpu).audit(Audit::None).run().unwrap();
    let started = run.results.attributes.iter().find(|(name, _)| name == "neighbour_started");
    assert!(matches!(started.unwrap().1, Attribute::Number(share) if share > 0.9), "{started:?}");
}
