//! The composed shader of every combination: naga's validation, the project's own lint, and the layout of
//! its bindings and tables against what the engine packs.

use afmsweep::contact::Law;
use afmsweep::engine::gpu::Job;
use afmsweep::kernel::{Binding, Entry, MODES_MAX, ShaderSpec, WORKGROUP};
use afmsweep::observe::Wants;
use naga::front::wgsl;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{AddressSpace, Expression, Handle, MathFunction, Module, Scalar, StorageAccess, TypeInner};
use std::path::Path;

/// Every law, few modes and as many as there can be, the `observables`, both starts, both parts of a run, both precisions;
/// both parts of a period with its slope; and the strides of either search.
fn specs_of(observables: impl Fn(usize) -> Vec<Wants>) -> Vec<ShaderSpec> {
    let mut all = Vec::new();
    let entry = Entry::Sweep;
    for law in Law::ALL {
        for modes in (1..=5).chain([8, MODES_MAX]) {
            for wants in observables(modes) {
                for kind in 0..8 {
                    let (measured, decay, double) = (kind & 1 != 0, kind & 2 != 0, kind & 4 != 0);
                    let one_drive = measured != decay;
                    all.push(ShaderSpec { entry, law, modes, wants, measured, decay, double, one_drive });
                }
                for (entry, double) in SEARCH {
                    let (measured, decay, one_drive) = (true, false, double);
                    all.push(ShaderSpec { entry, law, modes, wants, measured, decay, double, one_drive });
                }
            }
            let wants = Wants::FUNDAMENTAL;
            for (entry, double) in SLOPES {
                let (measured, decay, one_drive) = (false, false, double);
                all.push(ShaderSpec { entry, law, modes, wants, measured, decay, double, one_drive });
            }
        }
    }
    all
}

/// With every set of observables.
fn every_spec() -> Vec<ShaderSpec> {
    specs_of(|_| Wants::every())
}

/// The corners of that: two modes with every set of observables, other numbers of modes with the fewest observables and with
/// all.
fn corner_specs() -> Vec<ShaderSpec> {
    let every = Wants::every();
    specs_of(|modes| match modes {
        2 => every.clone(),
        _ => vec![every[0], every[every.len() - 1]],
    })
}

const SLOPES: [(Entry, bool); 6] = [
    (Entry::Kicks, false),
    (Entry::Kicks, true),
    (Entry::Carry, false),
    (Entry::Carry, true),
    (Entry::Walk, false),
    (Entry::Walk, true),
];

const SEARCH: [(Entry, bool); 2] = [(Entry::Stride, false), (Entry::Stride, true)];

fn parsed(spec: &ShaderSpec) -> (String, Module) {
    let text = spec.compose();
    let module = wgsl::parse_str(&text).unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
    (text, module)
}

/// What a shader is for, as its first line says.
fn title(text: &str) -> &str {
    text.lines().next().unwrap_or_default()
}

/// Calls of mathematics that every device rounds alike, or nearly.
const ALLOWED: [MathFunction; 4] =
    [MathFunction::Sqrt, MathFunction::Min, MathFunction::Max, MathFunction::Abs];

/// What the lint finds in a text.
fn lint(text: &str, module: &Module) -> Vec<String> {
    let mut found = Vec::new();
    let mut functions: Vec<_> = module.functions.iter().map(|(_, function)| function).collect();
    functions.extend(module.entry_points.iter().map(|point| &point.function));
    for function in functions {
        for (_, expression) in function.expressions.iter() {
            match expression {
                Expression::Math { fun, .. } if !ALLOWED.contains(fun) => found.push(format!("{fun:?}")),
                // A number equals itself, says an optimiser: this never finds a NaN.
                Expression::Binary { op, left, right }
                    if matches!(op, naga::BinaryOperator::Equal | naga::BinaryOperator::NotEqual)
                        && same(function, *left, *right) =>
                {
                    found.push("x != x".into());
                }
                _ => {}
            }
        }
    }
    // The head has every number, by name; below it there are none but whole ones.
    let (head, body) = text.split_once("struct Law").expect("the head ends with the law's structure");
    assert!(head.contains("const TWELFTH"), "no head");
    for line in body.lines() {
        let code = line.split("//").next().unwrap_or_default();
        let bytes = code.as_bytes();
        let digit = |at: usize| bytes.get(at).is_some_and(u8::is_ascii_digit);
        let point =
            (0..bytes.len()).any(|at| bytes[at] == b'.' && (digit(at + 1) || at > 0 && digit(at - 1)));
        let suffix = code.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| {
            word.starts_with(|c: char| c.is_ascii_digit())
                && word.contains(['f', 'h', 'e', 'l'])
                && !word.starts_with("0x")
        });
        if point || suffix {
            found.push(format!("a number: {}", code.trim()));
        }
    }
    found
}

/// Whether two operands are one: the same expression, or loads of the same place.
fn same(function: &naga::Function, left: Handle<Expression>, right: Handle<Expression>) -> bool {
    let load = |handle| match &function.expressions[handle] {
        Expression::Load { pointer } => Some(*pointer),
        _ => None,
    };
    left == right || load(left).is_some_and(|place| load(right) == Some(place))
}

#[test]
fn corner_combinations_pass_naga_and_the_lint_and_bind_what_is_packed() {
    let all = corner_specs();
    assert_eq!(
        all.len(),
        Law::ALL.len() * ((Wants::every().len() + 6 * 2) * (8 + SEARCH.len()) + 7 * SLOPES.len())
    );
    pass_naga_and_the_lint(&all);
}

#[test]
#[ignore = "minutes; `make test-all` runs it"]
fn every_combination_passes_naga_and_the_lint_and_binds_what_is_packed() {
    let all = every_spec();
    assert!(all.len() >= 4 * 7 * (8 * 2 * 10 + 4));
    assert_eq!(all.len(), Law::ALL.len() * 7 * (Wants::every().len() * (8 + SEARCH.len()) + SLOPES.len()));
    pass_naga_and_the_lint(&all);
}

fn pass_naga_and_the_lint(all: &[ShaderSpec]) {
    let threads = 4;
    let part = all.len().div_ceil(threads);
    std::thread::scope(|scope| {
        for specs in all.chunks(part) {
            scope.spawn(move || {
                let mut validator = Validator::new(ValidationFlags::all(), Capabilities::FLOAT64);
                for spec in specs {
                    let (text, module) = parsed(spec);
                    if let Err(error) = validator.validate(&module) {
                        panic!("{}: {}", title(&text), error.emit_to_string(&text));
                    }
                    assert_eq!(lint(&text, &module), Vec::<String>::new(), "{}", title(&text));
                    binds_what_is_packed(spec, &module);
                    every_field_has_its_place(spec, &text);
                    let code = |line: &str| line.split("// ").next().unwrap_or_default().to_owned();
                    let left = text.lines().map(code).find(|line| line.contains("//%") || line.contains('$'));
                    assert_eq!(left, None, "{}", title(&text));
                }
            });
        }
    });
    println!("{} shaders", all.len());
}

/// What a reader finds in shaders/recorded is what the program writes: the laws, and the step and the sums of two modes
/// with two harmonics. With `AFM_WRITE_SHADERS` set it is written anew.
#[test]
fn recorded_texts_are_those_that_are_kept() {
    let mut texts = Law::ALL.map(|law| (law.name(), "contact/", law.kick_text())).to_vec();
    let wants = Wants { harmonics: 2, ..Wants::ALL };
    let spec = ShaderSpec {
        entry: Entry::Sweep,
        law: Law::Jkr,
        modes: 2,
        wants,
        measured: true,
        decay: true,
        double: false,
        one_drive: false,
    };
    texts.extend([
        ("step", "step.rs", spec.step_text()),
        ("sums", "tally.rs and run_sums.rs", spec.sums_text()),
    ]);
    for (name, source, text) in texts {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("shaders/recorded/{name}.wgsl"));
        let text = format!(
            "// `{name}` as the program writes it for a shader from crates/kernel/src/{source}; do not change it by hand.\n\n{}",
            text.trim_start()
        );
        if std::env::var_os("AFM_WRITE_SHADERS").is_some() {
            std::fs::write(&path, &text).unwrap();
        }
        let kept = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            kept == text,
            "{}: AFM_WRITE_SHADERS=1 cargo test shader_text writes it anew",
            path.display()
        );
    }
}

#[test]
fn the_lint_sees_what_it_is_for() {
    for (line, finding) in [
        ("let y = pow(x, x);", "Pow"),
        ("let y = exp(x);", "Exp"),
        ("let y = sin(x);", "Sin"),
        ("let y = x != x;", "x != x"),
        ("let y = x * 1.5;", "a number"),
        ("let y = x * 2f;", "a number"),
        ("let y = x + 1e3;", "a number"),
    ] {
        let text =
            format!("const TWELFTH: f32 = 0.1f;\nstruct Law {{ a: f32 }}\nfn f(x: f32) {{ {line} }}\n");
        let module = wgsl::parse_str(&text).unwrap();
        let found = lint(&text, &module);
        assert!(found.iter().any(|one| one.starts_with(finding)), "{line}: {found:?}");
    }
    let text = "const TWELFTH: f32 = 0.1f;\nstruct Law { a: f32 }\nfn f(x: f32) -> f32 { return sqrt(x) * TWELFTH; }\n";
    assert_eq!(lint(text, &wgsl::parse_str(text).unwrap()), Vec::<String>::new());
}

/// What a shader binds is what the engine packs.
fn binds_what_is_packed(spec: &ShaderSpec, module: &Module) {
    let mut found: Vec<(u32, Binding, Option<u8>)> = module
        .global_variables
        .iter()
        .map(|(_, variable)| {
            let place = variable.binding.expect("only bound variables");
            assert_eq!(place.group, 0);
            let kind = match variable.space {
                AddressSpace::Uniform => Binding::Uniform,
                AddressSpace::Storage { access } if access.contains(StorageAccess::STORE) => Binding::Write,
                AddressSpace::Storage { .. } => Binding::Read,
                space => panic!("{space:?}"),
            };
            let width = match &module.types[variable.ty].inner {
                TypeInner::Array { base, .. } => match module.types[*base].inner {
                    TypeInner::Scalar(Scalar { width, .. }) | TypeInner::Atomic(Scalar { width, .. }) => {
                        Some(width)
                    }
                    ref inner => panic!("{inner:?}"),
                },
                _ => None,
            };
            (place.binding, kind, width)
        })
        .collect();
    found.sort_by_key(|(binding, ..)| *binding);
    let kinds: Vec<Binding> = found.iter().map(|(_, kind, _)| *kind).collect();
    assert_eq!(kinds, spec.bindings(), "{spec:?}");
    // Numbers have the precision's width, but for the job, which drive, the marks and who is under way.
    let (real, whole) = (Some(spec.bytes() as u8), Some(4));
    let mut widths = match spec.entry {
        Entry::Sweep => vec![None, real, real, real, whole, real, whole, whole],
        Entry::Kicks => vec![None, real, real, real, whole, real, whole, real, whole],
        Entry::Carry => vec![None, real, whole, real, whole, real, real, whole],
        Entry::Walk => vec![None, real, whole, real, whole, real, real, real],
        Entry::Stride => vec![None, real, whole, real, whole, real, real],
    };
    widths.extend(spec.decay.then_some(real));
    assert_eq!(found.iter().map(|(.., width)| *width).collect::<Vec<_>>(), widths, "{spec:?}");
    let point = &module.entry_points[0];
    assert_eq!((point.name.as_str(), point.workgroup_size), (spec.entry.name(), [WORKGROUP, 1, 1]));
}

#[test]
fn the_job_lies_as_the_shader_reads_it() {
    let spec = every_spec()[0];
    let (_, module) = parsed(&spec);
    let (_, kind) = module.types.iter().find(|(_, one)| one.name.as_deref() == Some("Job")).unwrap();
    let TypeInner::Struct { members, span } = &kind.inner else { panic!("{kind:?}") };
    assert_eq!(*span as usize, size_of::<Job>());
    let ours = [
        ("instances", std::mem::offset_of!(Job, instances)),
        ("drives", std::mem::offset_of!(Job, drives)),
        ("steps", std::mem::offset_of!(Job, steps)),
        ("first", std::mem::offset_of!(Job, first)),
        ("count", std::mem::offset_of!(Job, count)),
        ("width", std::mem::offset_of!(Job, width)),
        ("round", std::mem::offset_of!(Job, round)),
    ];
    let theirs: Vec<(&str, usize)> =
        members.iter().map(|one| (one.name.as_deref().unwrap(), one.offset as usize)).collect();
    assert_eq!(theirs, ours);
}

/// The head's places are the engine's: each field once, in order, and nothing else is asked for.
/// Every field has one place, and its own.
fn every_field_has_its_place(spec: &ShaderSpec, text: &str) {
    let lines: Vec<&str> = text.lines().filter(|line| line.starts_with("const ")).collect();
    for (prefix, fields) in
        [("DRIVE_", spec.drive_fields()), ("CASE_", spec.case_fields()), ("", spec.state_fields())]
    {
        for (place, field) in fields.iter().enumerate() {
            let line = format!("const {prefix}{}: u32 = {place}u;", field.to_uppercase());
            assert_eq!(lines.iter().filter(|one| **one == line).count(), 1, "{}: {line}", title(text));
        }
        let mut names = fields.clone();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), fields.len(), "{spec:?}: a field twice");
    }
}
