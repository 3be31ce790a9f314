//! Made-up results with everything a file can hold.

// Each test file uses its own part of this.

use afmsweep::store::{
    Attribute, AuditTable, BranchTable, Coordinate, Flags, ForceCurve, Results, Spectra, Variable, Waveforms,
};

pub const SCENE: &str = "title = \"one\"\n";

/// Distinct, exactly representable values.
pub fn ramp(count: usize, step: f64) -> Vec<f64> {
    (0..count).map(|i| (i as f64 + 0.5) * step).collect()
}

pub fn coordinate(name: &str, units: &str, values: Vec<f64>) -> Coordinate {
    Coordinate {
        name: name.into(),
        units: units.into(),
        long_name: format!("the {name}"),
        scene_path: format!("scene.{name}"),
        words: Vec::new(),
        columns: Vec::new(),
        values: values.into(),
    }
}

pub fn variable(name: &str, units: &str, harmonics: Option<usize>, data: Vec<f64>) -> Variable {
    let error_scale = if name == "error_estimate" { String::new() } else { format!("the free {name}") };
    Variable {
        name: name.into(),
        units: units.into(),
        long_name: format!("the {name}"),
        harmonics,
        error_scale,
        data,
    }
}

/// Results over these axes with everything a file can hold.
pub fn results(axes: Vec<Coordinate>, list: bool) -> Results {
    let count = match (list, axes.first()) {
        (true, Some(axis)) => axis.values.len(),
        _ => axes.iter().map(|axis| axis.values.len()).product(),
    };
    let rows = |count: usize, scale: f64| (0..count).map(|i| ramp(8, scale * (i + 1) as f64)).collect();
    let last = count as u64 - 1;
    Results {
        title: "Tapping: E × w".into(),
        axes,
        list,
        variables: vec![
            variable("amplitude", "m", None, ramp(count, 1e-9)),
            variable("phase", "degree", None, ramp(count, 0.25)),
            variable("harmonic_amplitude", "m", Some(3), ramp(3 * count, 1e-12)),
            variable("error_estimate", "1", None, ramp(count, 1e-5)),
        ],
        status: (0..count).map(|i| (i % 6) as u8).collect(),
        steps_per_period: (0..count).map(|i| 200 + i as u32).collect(),
        flags: vec![
            Flags {
                name: "contact_law".into(),
                long_name: "contact law used".into(),
                meanings: vec!["none".into(), "hertz".into(), "dmt".into()],
                bits: false,
                data: (0..count).map(|i| (i % 3) as u8).collect(),
            },
            Flags {
                name: "contact_warnings".into(),
                long_name: "doubts".into(),
                meanings: vec!["large_strain".into(), "rigid_tip".into()],
                bits: true,
                data: (0..count).map(|i| (i % 4) as u8).collect(),
            },
        ],
        waveforms: Some(Waveforms {
            instances: vec![last],
            time: rows(1, 1e-7),
            tip_travel: rows(1, 1e-9),
            actuator_top: rows(1, 1e-10),
            indentation: rows(1, 1e-11),
            force: rows(1, 1e-12),
        }),
        spectra: None,
        force_curves: ["approach", "retract"]
            .iter()
            .enumerate()
            .map(|(i, branch)| ForceCurve {
                instance: last,
                law: "jkr".into(),
                branch: (*branch).into(),
                indentation: ramp(4 + i, 1e-10),
                force: ramp(4 + i, 1e-9),
                contact_radius: ramp(4 + i, 1e-11),
            })
            .collect(),
        audit: Some(AuditTable {
            instances: vec![0, last],
            variables: vec![
                variable("amplitude", "m", None, ramp(2, 1e-9)),
                variable("phase", "degree", None, ramp(2, 60.0)),
            ],
            observables: vec!["amplitude".into(), "phase".into()],
            errors: ramp(4, 1e-4),
            flags: vec![Flags {
                name: "reference_status".into(),
                long_name: "status".into(),
                meanings: vec!["ok".into(), "not_steady".into()],
                bits: false,
                data: vec![0, 1],
            }],
        }),
        other_branch: Some(BranchTable {
            variables: vec![
                variable("amplitude", "m", None, ramp(count, 2e-9)),
                variable("harmonic_amplitude", "m", Some(3), ramp(3 * count, 2e-12)),
            ],
            status: (0..count).map(|i| (i % 3) as u8).collect(),
            steps_per_period: (0..count).map(|i| 100 + i as u32).collect(),
            flags: vec![Flags {
                name: "branch".into(),
                long_name: "branch".into(),
                meanings: vec!["none".into(), "attractive".into()],
                bits: false,
                data: (0..count).map(|i| (i % 2) as u8).collect(),
            }],
        }),
        comments: vec![("amplitude".into(), "of the tip".into())],
        attributes: vec![
            ("device".into(), Attribute::Text(String::new())),
            ("wall_time".into(), Attribute::Number(1.5)),
        ],
        provenance: vec![("scene".into(), SCENE.into()), ("plan".into(), "{\"modes\": 2}".into())],
    }
}

pub fn grid() -> Results {
    results(
        vec![
            coordinate("sample_youngs_modulus", "Pa", vec![1e8, 1e9, 1e10]),
            coordinate("tip_radius", "m", vec![5e-9, 1e-8, 2e-8, 4e-8]),
        ],
        false,
    )
}

pub fn list() -> Results {
    let axes = vec![
        coordinate("sample_youngs_modulus", "Pa", ramp(7, 1e8)),
        coordinate("tip_radius", "m", ramp(7, 1e-9)),
    ];
    results(axes, true)
}

pub fn scalar() -> Results {
    results(Vec::new(), false)
}

/// A grid whose two waveforms have different drive frequencies, and so times of their own.
pub fn own_times() -> Results {
    let mut results = grid();
    let rows = |scale: f64| vec![ramp(8, scale), ramp(8, scale * 2.0)];
    results.waveforms = Some(Waveforms {
        instances: vec![3, 5],
        time: rows(1e-7),
        tip_travel: rows(1e-9),
        actuator_top: rows(1e-9),
        indentation: rows(1e-9),
        force: rows(1e-9),
    });
    results
}

/// A grid with two spectra, the second of which has fewer harmonics.
pub fn with_spectra() -> Results {
    let mut results = grid();
    let rows = |scale: f64| {
        let mut rows = vec![ramp(40, scale), ramp(40, scale * 2.0)];
        rows[1][30..].fill(f64::NAN);
        rows
    };
    results.spectra = Some(Spectra {
        instances: vec![3, 5],
        frequency: [1e5, 2e5].map(|first| (1..=40).map(|n| f64::from(n) * first).collect()).to_vec(),
        tip_amplitude: rows(1e-9),
        tip_phase: rows(1.0),
        deflection_amplitude: rows(2e-9),
        deflection_phase: rows(2.0),
        force_amplitude: rows(1e-10),
        force_phase: rows(3.0),
    });
    results
}
