//! Contact laws against closed forms, written down a second time by another route.
//!
//! JKR's truth is its own parametric form in the contact radius `a`, which needs no root; Hertz and
//! DMT are taken through `a` as well. Energies are checked against forces by differences.

use afmsweep::contact::{
    AUTO_BOUNDARY, Contact, Dmt, Hertz, Jkr, Law, StaticLaw, Warning, combined_modulus, tabor_parameter,
};
use afmsweep::scene::{Adhesion, LawChoice, Params, TipShape};
use std::f64::consts::PI;

/// Eight decades each of K (Pa), R (m) and w (J/m^2), every second decade.
fn cases() -> impl Iterator<Item = (f64, f64, f64)> {
    let decades = || (0..=8).step_by(2);
    decades().flat_map(move |k| {
        decades().flat_map(move |r| {
            decades().map(move |w| (1.3e4 * 10f64.powi(k), 0.7e-12 * 10f64.powi(r), 1.9e-8 * 10f64.powi(w)))
        })
    })
}

/// Contact radii from the fold (`a_s`) to `1e6 a_s`, denser towards the fold.
fn radii(a_s: f64) -> impl Iterator<Item = f64> {
    (0..60).map(move |i| a_s * (1.0 + 10f64.powf(-9.0 + f64::from(i) * 0.25)))
}

/// Equation (16a) and the force as Johnson, Kendall and Roberts give them, from `a`.
fn jkr_from_radius(modulus: f64, radius: f64, work: f64, a: f64) -> (f64, f64) {
    let delta = a * a / radius - 2.0 / 3.0 * (6.0 * PI * work * a / modulus).sqrt();
    let force = modulus * a.powi(3) / radius - (6.0 * PI * work * modulus * a.powi(3)).sqrt();
    (delta, force)
}

#[test]
fn jkr_agrees_with_its_parametric_form_over_eight_decades() {
    let mut worst: f64 = 0.0;
    for (modulus, radius, work) in cases() {
        let law = Jkr::new(modulus, radius, work);
        let a_s = (PI * work * radius * radius / (6.0 * modulus)).cbrt();
        for a in radii(a_s) {
            let (delta, force) = jkr_from_radius(modulus, radius, work, a);
            // What an error of rounding in delta alone may do to a and f: infinite slope at the fold.
            let rounding = 4.0 * f64::EPSILON * (a * a / radius + a_s * a_s / radius);
            let y3 = (a / a_s).powf(1.5);
            let slope = 1.5 * modulus * a * (y3 - 3.0) / (y3 - 1.0).max(1e-16);
            let scale = PI * work * radius + modulus * a.powi(3) / radius;
            let allowed = 1e-13 * scale + rounding * slope.abs();
            let error = (law.force(delta, true) - force).abs();
            // beyond the fold by rounding counts as released: only for the nearest few points
            if law.force(delta, true) == 0.0 && a < a_s * (1.0 + 1e-7) {
                continue;
            }
            assert!(error <= allowed, "K {modulus:e} R {radius:e} w {work:e} a/a_s {}", a / a_s);
            if a > 1.001 * a_s {
                worst = worst.max(error / scale);
                let back = law.contact_radius(delta, true);
                assert!((back / a - 1.0).abs() < 1e-12, "a {a:e} {back:e}");
            }
        }
    }
    println!("largest force error, share of its terms: {worst:e}");
    assert!(worst < 1e-12);
}

#[test]
fn jkr_radius_from_force_agrees_with_equation_16a() {
    // (16a): a^3 = (R/K) (f + 3 pi w R + sqrt(6 pi w R f + (3 pi w R)^2)), the upper branch, f >= -1.5 pi w R.
    for (modulus, radius, work) in cases() {
        let law = Jkr::new(modulus, radius, work);
        let pull = 3.0 * PI * work * radius;
        for i in 0..40 {
            let force = pull * (-0.5 + 10f64.powf(-4.0 + f64::from(i) * 0.25));
            let root = (2.0 * pull * force + pull * pull).max(0.0).sqrt();
            let a = (radius / modulus * (force + pull + root)).cbrt();
            let (delta, _) = jkr_from_radius(modulus, radius, work, a);
            assert!((law.contact_radius(delta, true) / a - 1.0).abs() < 1e-13);
            let scale = pull + force.abs();
            assert!((law.force(delta, true) - force).abs() < 1e-13 * scale, "{force:e}");
        }
    }
}

#[test]
fn hertz_and_dmt_agree_with_forms_in_the_contact_radius() {
    for (modulus, radius, work) in cases() {
        let d0 = 0.3e-9;
        let (hertz, dmt) = (Hertz::new(modulus, radius), Dmt::new(modulus, radius, work, d0));
        let hamaker = 12.0 * PI * d0 * d0 * work;
        for i in -6..=4 {
            let a = radius * 10f64.powi(i);
            let delta = a * a / radius;
            let load = modulus * a.powi(3) / radius;
            let pull = 2.0 * PI * work * radius;
            assert!((hertz.force(delta, true) / load - 1.0).abs() < 1e-13);
            assert!((dmt.force(delta, true) - (load - pull)).abs() < 1e-13 * (load + pull));
            assert!((hertz.contact_radius(delta, true) / a - 1.0).abs() < 1e-14);
            let d = 10f64.powi(i) * d0;
            let van_der_waals = -hamaker * radius / (6.0 * (d0 + d) * (d0 + d));
            assert!((dmt.force(-d, false) / van_der_waals - 1.0).abs() < 1e-13);
            assert_eq!(hertz.force(-d, false), 0.0);
        }
    }
}

#[test]
fn jkr_meets_the_four_reference_points() {
    let (modulus, radius, work) = (3.1e7, 1.7e-8, 0.043);
    let law = Jkr::new(modulus, radius, work);
    let force = PI * work * radius;
    let depth = ((PI * work / modulus).powi(2) * radius).cbrt();
    let contact = (PI * work * radius * radius / modulus).cbrt();
    for (a, f, delta) in [
        (1.144714242553, -1.5, -0.436790232368),
        (1.3867225487, -4.0 / 3.0, 0.0),
        (1.81712059283, 0.0, 1.1006424163),
    ] {
        assert!((law.contact_radius(delta * depth, true) / contact - a).abs() < 2e-10);
        assert!((law.force(delta * depth, true) / force - f).abs() < 2e-10);
    }
    assert!((law.release() / depth + 0.908560296416).abs() < 1e-11);
    assert!((law.contact_radius(law.release(), true) / contact - 0.550321208149).abs() < 1e-11);
    assert!((law.force(law.release(), true) / force + 5.0 / 6.0).abs() < 1e-14);
    assert!((law.zero_force() / depth - 1.1006424163).abs() < 1e-10);
    assert!((law.pull_off() / force + 1.5).abs() < 1e-14);
}

#[test]
fn jkr_loss_per_cycle_is_the_area_between_its_branches() {
    // From delta = 0 (a^1.5 = 4 a_s^1.5) back to the fold the tip is pulled, on approach it is not:
    // loss = -int f d delta there, taken in s = sqrt(a - a_s), which is smooth at the fold.
    let (modulus, radius, work) = (1e8 / 0.5625, 2e-8, 0.05);
    let law = Jkr::new(modulus, radius, work);
    let unit = PI * work * radius * ((PI * work / modulus).powi(2) * radius).cbrt();
    let a_s = law.radius_scale();
    let top = (a_s * (4f64.powf(2.0 / 3.0) - 1.0)).sqrt();
    let steps = 2000;
    let mut area = 0.0;
    for i in 0..=steps {
        let s = top * f64::from(i) / f64::from(steps);
        let a = a_s + s * s;
        let (delta, _) = jkr_from_radius(modulus, radius, work, a);
        let slope = 2.0 * a / radius - (2.0 * PI * work / (3.0 * modulus * a)).sqrt();
        let force = law.force(delta.max(law.release()), true);
        let weight = if i == 0 || i == steps {
            1.0
        } else if i % 2 == 1 {
            4.0
        } else {
            2.0
        };
        area -= weight * force * slope * 2.0 * s;
    }
    area *= top / f64::from(steps) / 3.0;
    println!("loss per cycle: {} of its unit", area / unit);
    assert!((area / unit - 1.2749410291014).abs() < 1e-9);
    assert!((law.loss_per_cycle() / unit - 1.2749410291014).abs() < 2e-13);
    // the jumps in energy say the same: into contact at 0, out of it at the fold
    let jumps = -law.energy(0.0, true) + law.energy(law.release(), true);
    assert!((jumps / unit - 1.2749410291014).abs() < 2e-13);
}

/// Section 4's sample and tip of Ha, Fung & Chen 2005 under one law.
fn paper(law: LawChoice) -> Contact {
    let mut params = Params::default();
    params.contact.law = law;
    Contact::new(&params)
}

#[test]
fn the_papers_forces_at_its_indentations() {
    let nano = |law, delta: f64| paper(law).force(delta, true) * 1e9;
    let values = [nano(LawChoice::Hertz, 150e-9), nano(LawChoice::Dmt, 150e-9), nano(LawChoice::Jkr, 75e-9)];
    println!("Hertz, DMT at 150 nm, JKR at 75 nm: {values:?} nN");
    assert!((values[0] - 1.79).abs() < 0.005);
    assert!((values[1] - 1.41).abs() < 0.005);
    assert!((values[2] - 0.42).abs() < 0.005);
    assert!((paper(LawChoice::Jkr).contact_radius(75e-9, true) * 1e9 - 68.0).abs() < 0.5);
    assert!((paper(LawChoice::Jkr).law().release() * 1e9 + 30.4).abs() < 0.05);
}

#[test]
fn force_is_the_slope_of_the_energy_and_stiffness_of_the_force() {
    let (modulus, radius, work, d0) = (2e8, 2e-8, 0.05, 0.3e-9);
    let laws: [(&str, &dyn StaticLaw); 3] = [
        ("hertz", &Hertz::new(modulus, radius)),
        ("dmt", &Dmt::new(modulus, radius, work, d0)),
        ("jkr", &Jkr::new(modulus, radius, work)),
    ];
    for (name, law) in laws {
        for contact in [false, true] {
            let places: &[f64] = match (name, contact) {
                ("jkr", true) => &[-2.4e-10, -1e-10, 0.0, 1e-10, 1e-9, 7e-9],
                (_, true) => &[1e-11, 1e-10, 1e-9, 7e-9],
                _ => &[-5e-9, -3e-10, -2e-11],
            };
            for &delta in places {
                let room = match (name, contact) {
                    ("jkr", true) => delta - law.release(),
                    _ => delta.abs(),
                };
                let slope = |value: &dyn Fn(f64) -> f64| {
                    // eighth-order central difference
                    let h = 0.02 * room.min(1e-9);
                    let pair = |n: f64| value(delta + n * h) - value(delta - n * h);
                    (672.0 * pair(1.0) - 168.0 * pair(2.0) + 32.0 * pair(3.0) - 3.0 * pair(4.0)) / (840.0 * h)
                };
                let force = slope(&|d| law.energy(d, contact));
                let stiffness = slope(&|d| law.force(d, contact));
                let scale = PI * work * radius;
                let error = (force - law.force(delta, contact)).abs();
                assert!(error < 1e-10 * scale, "{name} {contact} {delta:e}: {error:e}");
                let error = (stiffness - law.stiffness(delta, contact)).abs();
                let stiff = law.stiffness(delta, contact).abs() + scale / 1e-8;
                assert!(error < 1e-9 * stiff, "{name} {contact} {delta:e}: {error:e}");
            }
        }
    }
}

#[test]
fn dmt_is_continuous_at_touch() {
    for (modulus, radius, work) in cases() {
        let law = Dmt::new(modulus, radius, work, 0.3e-9);
        let pull = 2.0 * PI * work * radius;
        let step = 1e-14 * 0.3e-9;
        assert!((law.force(-step, false) - law.force(0.0, true)).abs() < 1e-13 * pull);
        assert!((law.energy(-step, false) - law.energy(0.0, true)).abs() < 1e-13 * pull * 0.3e-9);
        assert!((law.force(0.0, true) / pull + 1.0).abs() < 1e-15);
    }
}

#[test]
fn jkr_without_adhesion_is_hertz() {
    let (modulus, radius, delta) = (1e8, 2e-8, 3e-9);
    let hertz = Hertz::new(modulus, radius);
    let none = Jkr::new(modulus, radius, 0.0);
    assert!((none.force(delta, true) / hertz.force(delta, true) - 1.0).abs() < 1e-15);
    assert_eq!(none.force(-1e-12, true), 0.0);
    // Far from the fold, delta and f expanded in y^-3 = (a_s/a)^1.5: f = f_Hertz - pi w R [1 + O(y^-3)].
    // From adhesion that rules down to where it is lost in rounding, without a seam.
    let load = hertz.force(delta, true);
    for exponent in 4..300 {
        let work = 10f64.powi(-exponent);
        let law = Jkr::new(modulus, radius, work);
        let pull = PI * work * radius;
        let small = (law.radius_scale() / hertz.contact_radius(delta, true)).powf(1.5);
        let error = (law.force(delta, true) - (load - pull)).abs();
        assert!(error < 4.0 * small * pull + 2e-15 * load, "w {work:e} {error:e} {small:e}");
    }
    let mut params = Params::default();
    params.contact.law = LawChoice::Jkr;
    params.sample.adhesion = Adhesion::Work(0.0);
    assert_eq!(Contact::new(&params).law, Law::Hertz);
}

#[test]
fn tabor_decides_and_warns() {
    let case = |modulus: f64, work: f64, law: LawChoice| {
        let mut params = Params::default();
        params.sample.youngs_modulus = modulus;
        params.sample.adhesion = Adhesion::Work(work);
        params.contact.law = law;
        (Contact::new(&params), params)
    };
    // mu from E* directly: E* = E/(1 - nu^2) with nu = 0.5 and a rigid tip
    let (soft, params) = case(1e7, 0.05, LawChoice::Auto);
    let reduced: f64 = 1e7 / 0.75;
    let mu = (30e-9 * 0.05f64.powi(2) / (reduced.powi(2) * 0.3e-9f64.powi(3))).cbrt();
    assert!((soft.tabor() / mu - 1.0).abs() < 1e-14 && mu > 5.0);
    assert_eq!(soft.law, Law::Jkr);
    assert_eq!(soft.warnings(&params, None), []);

    let (stiff, params) = case(2e11, 0.01, LawChoice::Auto);
    assert_eq!(stiff.law, Law::Dmt);
    assert!(stiff.tabor() < 0.1);
    assert!(matches!(stiff.warnings(&params, None)[..], [Warning::RigidTip { .. }]));

    let (clean, _) = case(1e9, 0.0, LawChoice::Auto);
    assert_eq!(clean.law, Law::Hertz);
    let (_, params) = case(1e9, 1e-6, LawChoice::Auto);
    assert_eq!(Contact::for_load(&params, 1e-6).law, Law::Hertz);
    assert_eq!(Contact::for_load(&params, 1e-12).law, Law::Dmt);

    let (wrong, params) = case(2e11, 0.01, LawChoice::Jkr);
    let warnings = wrong.warnings(&params, None);
    let Some(Warning::LawDoesNotFit { law: Law::Jkr, fitting: Law::Dmt, tabor }) = warnings.first() else {
        panic!("{warnings:?}");
    };
    assert_eq!(*tabor, wrong.tabor());
    let (wrong, params) = case(1e7, 0.05, LawChoice::Dmt);
    assert!(matches!(wrong.warnings(&params, None)[..], [Warning::LawDoesNotFit { fitting: Law::Jkr, .. }]));

    // either side of the boundary between the limits
    for (factor, law) in [(0.99, Law::Dmt), (1.01, Law::Jkr)] {
        let work = 1e9 / 0.75 * ((factor * AUTO_BOUNDARY * 0.3e-9).powi(3) / 30e-9).sqrt();
        let (between, params) = case(1e9, work, LawChoice::Auto);
        assert_eq!(between.law, law);
        assert!(matches!(between.warnings(&params, None)[..], [Warning::BetweenLaws { .. }]));
    }

    let (hertz, params) = case(1e7, 0.05, LawChoice::Hertz);
    let warnings = hertz.warnings(&params, Some(30e-9));
    assert!(matches!(warnings[..], [Warning::AdhesionLeftOut { .. }, Warning::LargeStrain { .. }]));
    assert!(warnings[0].to_string().contains("9.425 nN"), "{}", warnings[0]);
    assert!(warnings[1].to_string().contains("1.00 of the tip radius"), "{}", warnings[1]);
    // a/R = 0.3 is where the warning begins: delta = 0.09 R
    assert_eq!(hertz.strain_warning(0.0899 * 30e-9), None);
    assert!(hertz.strain_warning(0.0901 * 30e-9).is_some());

    // the exact sphere leaves linear elasticity, not its shape; a tip without a radius of curvature has no such parameter
    let shaped = |shape| {
        let (_, mut params) = case(1e7, 0.05, LawChoice::Hertz);
        (params.instrument.tip.shape, params.instrument.tip.half_angle) = (shape, Some(35.0));
        Contact::new(&params)
    };
    let said = shaped(TipShape::Sphere).strain_warning(10e-9).unwrap().to_string();
    assert!(said.contains("the sphere's shape is exact"), "{said}");
    assert_eq!(shaped(TipShape::Sphere).tabor(), hertz.tabor());
    for shape in [TipShape::Cone, TipShape::Pyramid, TipShape::Punch] {
        assert!(shaped(shape).tabor().is_nan(), "{shape:?}");
    }
    // a sphere's series ends where half of it has sunk in, a hyperboloid's at 10 R/tan(alpha)^2
    let tangent = 35f64.to_radians().tan();
    for (shape, reach) in [(TipShape::Sphere, 30e-9), (TipShape::Hyperboloid, 10.0 * 30e-9 / tangent.powi(2))]
    {
        assert_eq!(shaped(shape).series_warning(0.999 * reach), None);
        let said = shaped(shape).series_warning(1.001 * reach).unwrap().to_string();
        assert!(said.contains("do not trust it"), "{said}");
    }
}

/// A layer's series ends at a contact radius of two thicknesses; DMT's attraction on it, and no law of Tabor's, is told.
#[test]
fn layers_warn_of_depth_and_adhesion() {
    let mut params = Params::default();
    (params.contact.law, params.instrument.tip.radius) = (LawChoice::Dmt, 30e-9);
    params.sample.thickness = Some(20e-9);
    let dmt = Contact::new(&params);
    assert!(matches!(dmt.warnings(&params, None)[..], [Warning::AdhesiveLayer]));
    let depth =
        (1..).map(|n| 1e-10 * f64::from(n)).find(|depth| dmt.series_warning(*depth).is_some()).unwrap();
    let radius = dmt.contact_radius(depth, true);
    assert!(radius > 40e-9 && radius < 40.2e-9, "{radius:e}");
}

#[test]
fn moduli_and_hamaker_constants_are_resolved() {
    let mut params = Params::default();
    params.instrument.tip.youngs_modulus = 130e9;
    params.instrument.tip.poisson_ratio = 0.3;
    params.sample.youngs_modulus = 70e6;
    params.sample.poisson_ratio = 0.3;
    params.sample.adhesion = Adhesion::Hamaker(6.4e-20);
    params.contact.decay_length = 0.2e-9;
    let modulus = 1.0 / (0.75 * (0.91 / 130e9 + 0.91 / 70e6));
    assert!((combined_modulus(&params) / modulus - 1.0).abs() < 1e-14);
    let contact = Contact::new(&params);
    assert!((contact.work / 0.0424413181578388 - 1.0).abs() < 1e-14);
    assert!((contact.tabor() / tabor_parameter(modulus, 30e-9, contact.work, 0.2e-9) - 1.0).abs() < 1e-14);
}
