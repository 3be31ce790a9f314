//! A lever in a fluid against Sader's formulas, evaluated elsewhere.
//!
//! Truth: SciPy 1.17.1 (`scipy.special.kve` for the Bessel functions, `scipy.optimize.brentq` for the frequencies) on the
//! formulas of J. E. Sader, J. Appl. Phys. 84 (1998) 64; closed forms of the clamped beam; limits.

use crate::continuum::close;
use crate::program::{Desk, numbers, scene};
use afmsweep::Scene;
use afmsweep::instrument::{Fluid, FluidMode, hydrodynamic_function, modes_in};
use afmsweep::scene::{InstrumentParams, LeverSpec, TipMass};

/// A bare beam: modulus (Pa), density (kg/m^3), length, width, thickness (m).
fn beam([youngs_modulus, density, length, width, thickness]: [f64; 5]) -> InstrumentParams {
    let mut params = InstrumentParams::default();
    params.cantilever.lever = LeverSpec::Dimensions { youngs_modulus, density, length, width, thickness };
    params.tip.half_length = 0.0;
    params.tip.mass = TipMass::Given(0.0);
    params
}

const SILICON: [f64; 5] = [169e9, 2330.0, 225e-6, 28e-6, 3e-6];
const NITRIDE: [f64; 5] = [250e9, 3100.0, 100e-6, 10e-6, 0.3e-6];

#[test]
fn hydrodynamic_function_is_scipys() {
    let table = [
        (1e-6, 59600.60447438402, 547783.3112777761),
        (0.001, 212.17182229205636, 1018.7336618856643),
        (0.1, 10.484879689242145, 21.827531221369203),
        (1.0, 3.733959493046819, 4.074610833672524),
        (3.7, 2.4539908722849337, 1.7561273171277076),
        (10.0, 1.9183181062502739, 0.9816219701685388),
        (100.0, 1.3262722508652187, 0.29610170621887844),
        (1234.5, 1.1069168339999813, 0.09141571288539595),
        (1e4, 1.0420450902297251, 0.035545980279510093),
    ];
    for (reynolds, real, imaginary) in table {
        let ours = hydrodynamic_function(reynolds);
        close(ours.re, real, 1e-10, &format!("real part at {reynolds}"));
        close(ours.im, imaginary, 1e-10, &format!("imaginary part at {reynolds}"));
    }
}

#[test]
fn modes_in_water_and_air_are_scipys() {
    // Vacuum and fluid frequency (Hz), quality factor, Reynolds number.
    let water = [
        [81527.07690092994, 34574.350522964545, 4.145251465200471, 47.69983772402087],
        [510921.4696419066, 234562.33768081537, 8.9395060388183, 323.60941779977423],
        [1430594.9092798613, 673086.2933756959, 13.838570760912809, 928.6105590604883],
        [2803395.052283369, 1333800.813286267, 18.461443658312565, 1840.1526388084635],
    ];
    let air = [
        [81527.07690092994, 81206.01542007057, 213.56377689833644, 6.400355764264276],
        [510921.4696419066, 509509.3823542901, 578.3797209675811, 40.15763235554623],
        [1430594.9092798613, 1427118.1057982119, 964.7048660902477, 112.48013521513037],
        [2803395.052283369, 2796996.448752605, 1330.9149737333357, 220.4488454555537],
    ];
    let soft = [
        [43520.17901497181, 7931.045387395379, 1.01485203658356, 1.2433140848239943],
        [272736.30634921766, 66059.97343742264, 2.101113183742009, 10.355923009642456],
        [763669.5551518877, 204084.6967443261, 3.166674033834965, 31.993434101703578],
        [1496487.5371812433, 419211.7960895796, 4.152501076734291, 65.71793567477097],
    ];
    let heavy = Fluid { density: 998.0, viscosity: 1e-3 };
    for (lever, fluid, truth) in
        [(SILICON, Fluid::WATER, water), (SILICON, Fluid::AIR, air), (NITRIDE, heavy, soft)]
    {
        let modes = modes_in(&beam(lever), fluid).expect("a sound lever");
        for (mode, [vacuum, frequency, quality, reynolds]) in modes.iter().zip(truth) {
            close(mode.vacuum_frequency, vacuum, 1e-9, "vacuum frequency");
            close(mode.frequency, frequency, 1e-9, "frequency in the fluid");
            close(mode.quality_factor, quality, 1e-6, "quality factor");
            close(mode.reynolds, reynolds, 1e-9, "Reynolds number");
        }
    }
}

/// Truth: without a fluid nothing changes; the stiffness of a bare beam's first mode is 1.0302 of its static one,
/// lambda^4/12 of E b h^3/(4 L^3) (closed form); the participations of all modes add up to the tip's own travel, 1.
#[test]
fn limits_of_thin_fluids_and_of_the_beam() {
    let thin = modes_in(&beam(SILICON), Fluid { density: 1e-9, viscosity: 1e-12 }).expect("a sound lever");
    assert!(thin.len() >= 4);
    for mode in &thin {
        close(mode.frequency, mode.vacuum_frequency, 1e-10, "nearly vacuum");
    }
    let [modulus, _, length, width, thickness] = SILICON;
    let fixed = modulus * width * thickness.powi(3) / (4.0 * length.powi(3));
    let lambda: f64 = 1.875_104_068_711_961;
    close(thin[0].stiffness, fixed * lambda.powi(4) / 12.0, 1e-8, "first stiffness");
    // sigma and lambda of the first three modes (R. D. Blevins, Formulas for Natural Frequency and Mode Shape, 1979).
    let shapes =
        [(0.734_095_514, 1.875_104_07), (1.018_467_319, 4.694_091_13), (0.999_224_497, 7.854_757_44)];
    let first =
        [1.0, -1.0, 1.0].iter().zip(shapes).map(|(sign, (sigma, lambda))| sign * 4.0 * sigma / lambda);
    for (mode, expected) in thin.iter().zip(first) {
        close(mode.drive, expected, 1e-7, "participation of a clamped beam");
    }
}

/// Truth: the share of a mode's mass that the fluid adds to follows from energies: with a tip of mass m at the end of a beam
/// whose mode weighs M there, Q and frequency change as if the beam's part alone were heavier. Held by the frequency of the
/// same lever in vacuum with its density raised by the mass that moves along.
#[test]
fn tips_mass_is_not_loaded_by_the_fluid() {
    let mut params = beam(SILICON);
    params.tip.mass = TipMass::Given(1e-11);
    let wet: FluidMode = modes_in(&params, Fluid::WATER).expect("a sound lever")[0];
    let [modulus, density, length, width, thickness] = SILICON;
    let added = std::f64::consts::PI * Fluid::WATER.density * width / (4.0 * thickness) * wet.hydrodynamic.re;
    let mut heavier = beam([modulus, density + added, length, width, thickness]);
    heavier.tip.mass = TipMass::Given(1e-11);
    let dry = modes_in(&heavier, Fluid { density: 1e-9, viscosity: 1e-12 }).expect("a sound lever")[0];
    close(wet.frequency, dry.vacuum_frequency, 1e-9, "frequency with the mass added");
    // Rayleigh: the beam's part of the modal mass, from the stiffness and the frequency.
    let moving = dry.stiffness / (std::f64::consts::TAU * dry.vacuum_frequency).powi(2);
    let share = 1.0 - 1e-11 / moving;
    let bare = (density * 4.0 * thickness / (std::f64::consts::PI * Fluid::WATER.density * width)
        + wet.hydrodynamic.re)
        / wet.hydrodynamic.im;
    close(wet.quality_factor, bare / share, 1e-6, "quality factor with a tip");
}

const BARE: &str = "[instrument.cantilever]\nlength = \"225 um\"\nwidth = \"28 um\"\nthickness = \"3 um\"\n\
    density = \"2330 kg/m^3\"\nyoungs_modulus = \"169 GPa\"\n[instrument.tip]\nhalf_length = \"0 m\"\nmass = \"0 kg\"\n";

#[test]
fn the_command_tells_modes_and_lines_for_a_scene() {
    let desk = Desk::new();
    let path = desk.write("bare.toml", BARE);
    let file = path.to_str().expect("a name");
    let answer = desk.json(&["modes", file, "--fluid", "water", "--json"]);
    let modes = answer["modes"].as_array().expect("modes");
    close(modes[0]["frequency_hz"].as_f64().expect("a number"), 34574.350522964545, 1e-9, "first frequency");
    assert_eq!(numbers(&modes[0]["hydrodynamic_function"]).len(), 2);
    let same = desk.json(&["modes", file, "--fluid", "997.05 kg/m^3, 890 uPa s", "--json"]);
    assert_eq!(answer, same);
    // The lines can be pasted, and are the lever.
    let told = desk.works(&["modes", file, "--fluid", "water"]).out;
    let lines = told.split_once("[instrument.cantilever]").expect("lines for a scene").1;
    const DRIVE: &str = "[drive]\non = \"tip\"\nfree_amplitude = \"1 nm\"\n";
    let text = format!("{DRIVE}[instrument.cantilever]{lines}");
    let pasted = Scene::parse("pasted.toml".as_ref(), &text).expect("a scene");
    let LeverSpec::Calibrated { frequency, .. } = pasted.base.instrument.cantilever.lever else {
        panic!("not a calibrated lever: {text}")
    };
    close(frequency, 34574.350522964545, 1e-5, "pasted frequency");
    let (_, listed) = text.split_once("# modes = [").expect("modes as a comment");
    let listed = format!("{DRIVE}[instrument.cantilever]\nmodes = [{}", listed.replace("\n#", "\n"));
    let pasted = Scene::parse("pasted.toml".as_ref(), &listed).expect("a scene");
    let LeverSpec::Modes(list) = pasted.base.instrument.cantilever.lever else {
        panic!("no modes: {listed}")
    };
    close(list[1].frequency, 234562.33768081537, 1e-5, "second frequency");
}

#[test]
fn fluids_that_are_none_are_refused_with_their_form() {
    let desk = Desk::new();
    let by_size = scene("paper_fig4_hertz.toml");
    for (fluid, words) in [
        ("oil", "write water, air, or a density and a viscosity"),
        ("998 kg/m^3, 1 mPa", "a viscosity"),
        ("0 kg/m^3, 1 mPa s", "above zero"),
    ] {
        let run = desk.call(&["modes", &by_size, "--fluid", fluid]);
        assert!(run.err.contains(words), "{fluid}: {}", run.err);
        assert_eq!(run.code, Some(2));
    }
    let calibrated = scene("approach_stiff.toml");
    desk.refuses(&["modes", &calibrated, "--fluid", "water"], &["given by its dimensions"]);
}
