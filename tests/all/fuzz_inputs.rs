//! Whatever the texts and bytes that the program reads are, nothing panics, what is refused is refused in words, and what is
//! taken means the same when it is written and read again. proptest makes the inputs: the same few in every run, or, where
//! FUZZ_SECONDS is set, others for so long in each test. What was found wrong once stands in `tests/scenes/bad` or here.

use afmsweep::Status;
use afmsweep::control::{Chunk, ChunkMeta, CompactOrbit, InstanceRecord, portion_number, portion_to_bytes};
use afmsweep::engine::Finished;
use afmsweep::periodic::Floquet;
use afmsweep::plan::{BasisRule, Precision, Resolution, SectionState};
use afmsweep::scene::Scene;
use afmsweep::store::{ExistingFile, Journal, RecordKind, RunFile};
use afmsweep::units::{self, Dimension, parse};
use proptest::prelude::*;
use proptest::test_runner::{Config, TestCaseError, TestRunner};
use std::cell::Cell;
use std::fmt::Debug;
use std::path::Path;
use std::time::{Duration, Instant};

/// Inputs of a test where nobody asks for more.
const FEW: u32 = 192;

/// Holds `test` to inputs of `strategy`; it says whether one was taken, and some must be.
fn hold<S: Strategy>(strategy: &S, test: impl Fn(S::Value) -> Result<bool, TestCaseError>)
where
    S::Value: Debug,
{
    let config = || Config { cases: FEW, failure_persistence: None, ..Config::default() };
    let taken = Cell::new(0);
    let counted = |value| test(value).map(|one| taken.set(taken.get() + u64::from(one)));
    let held =
        |mut runner: TestRunner| runner.run(strategy, counted).unwrap_or_else(|error| panic!("{error}"));
    let seconds: f64 = std::env::var("FUZZ_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(0.0);
    let start = Instant::now();
    held(TestRunner::new_with_rng(config(), TestRunner::deterministic().new_rng()));
    let mut rounds = 1;
    while start.elapsed() < Duration::from_secs_f64(seconds) {
        held(TestRunner::new(config()));
        rounds += 1;
    }
    println!("{} inputs, {} taken, in {:.0} s", rounds * FEW, taken.get(), start.elapsed().as_secs_f64());
    assert!(taken.get() > 0, "no input was taken");
}

/// Pieces of numbers, units and slips in them.
fn quantity() -> impl Strategy<Value = String> {
    let digits =
        prop_oneof!["[0-9]{1,20}", Just("0".to_owned()), Just("1e".to_owned()), Just("inf".to_owned())];
    let piece = prop_oneof![
        4 => digits,
        1 => "[-+.,_ eE]{1,3}",
        4 => prop::sample::select(vec![
            "m", "nm", "um", "\u{b5}m", "\u{3bc}m", "GPa", "Pa s", "mJ/m^2", "J/m²", "kHz", "N/m", "V m/C", "kg/m^3", "°",
            "^", "*", "/", "·", " ", "fN", "Ym", "e-9", "E300", "e-400", "99999999999", "da", "min",
        ]).prop_map(str::to_owned),
        1 => any::<char>().prop_map(String::from),
    ];
    let any = prop::collection::vec(piece, 0..6).prop_map(|pieces| pieces.concat());
    // Half of them have the form of one.
    let units = prop::sample::select(vec!["nm", "kHz", "GPa", "N/m", "mJ/m^2", "us", "", "aJ", "V"]);
    let form = ("-?[0-9]{1,9}(\\.[0-9]{0,20})?([eE][-+]?[0-9]{1,3})?", units);
    prop_oneof![any, form.prop_map(|(number, unit)| format!("{number} {unit}"))]
}

#[test]
fn quantities_of_any_text_are_read_or_refused() {
    let any = (quantity(), prop::sample::select(Dimension::ALL.to_vec()));
    hold(&any, |(text, dimension)| {
        let parsed = parse(&text, dimension);
        let read = parsed.is_ok();
        match parsed {
            Ok(value) => {
                prop_assert!(!value.is_nan(), "{text:?} is no number");
                let back = parse(&units::format(value, dimension), dimension);
                prop_assert_eq!(back.ok().map(f64::to_bits), Some(value.to_bits()), "{:?}", text);
            }
            Err(error) => prop_assert!(error.to_string().len() > 10, "{text:?}: {error}"),
        }
        Ok(read)
    });
}

/// Every number that is written is read as itself.
#[test]
fn quantities_of_any_size_come_back_by_their_bits() {
    let any = (any::<f64>(), prop::sample::select(Dimension::ALL.to_vec()));
    hold(&any, |(value, dimension)| {
        let text = units::format(value, dimension);
        match value.is_nan() {
            true => prop_assert!(parse(&text, dimension).is_err() || dimension == Dimension::Dimensionless),
            false => {
                let back = parse(&text, dimension);
                prop_assert_eq!(back.ok().map(f64::to_bits), Some(value.to_bits()), "{}", text);
            }
        }
        Ok(true)
    });
}

/// What is done to a text: a piece of it, by shares of its length, is taken out, doubled or replaced by another piece.
#[derive(Clone, Debug)]
struct Slip {
    from: f64,
    length: usize,
    way: u8,
    token: String,
}

fn slips(tokens: &'static [&'static str]) -> impl Strategy<Value = Vec<Slip>> {
    let token = prop_oneof![
        6 => prop::sample::select(tokens).prop_map(str::to_owned),
        3 => quantity(),
        1 => "\\PC{1,3}",
    ];
    let slip = (0.0..1.0, 0usize..24, 0u8..4, token);
    let slip = slip.prop_map(|(from, length, way, token)| Slip { from, length, way, token });
    prop::collection::vec(slip, 1..5)
}

/// The text after these.
fn slipped(text: &str, slips: &[Slip]) -> String {
    let mut all: Vec<char> = text.chars().collect();
    for Slip { from, length, way, token } in slips {
        let start = (from * all.len() as f64) as usize;
        let end = (start + length).min(all.len());
        let piece: Vec<char> = all[start..end].to_vec();
        match way {
            0 => drop(all.drain(start..end)),
            1 => drop(all.splice(start..start, piece)),
            2 => drop(all.splice(start..end, token.chars())),
            _ => drop(all.splice(start..start, token.chars())),
        }
    }
    all.into_iter().collect()
}

const TOKENS: [&str; 28] = [
    "[sweep]",
    "[samples]",
    "[design]",
    "[uncertain]",
    "[curve]",
    "\"",
    "{",
    "}",
    "[",
    "]",
    "=",
    ",",
    "\n",
    ".",
    "#",
    "'''",
    "values",
    "points",
    "from",
    "to",
    "scale = \"log\"",
    "\"approach.gap\"",
    "true",
    "1e999",
    "nan",
    "0",
    "-1",
    "65537",
];

/// A scene of any text is refused in words, or it is the scene that it says it is.
#[test]
fn scenes_of_any_text_are_read_or_refused() {
    let folder = Path::new("tests/scenes/good");
    let scenes = ["uncertain_sobol.toml", "uncertain_morris.toml", "samples.toml", "overrides.toml"];
    let mut texts: Vec<String> = scenes
        .iter()
        .map(|name| std::fs::read_to_string(folder.join(name)).expect("the scene is there"))
        .collect();
    for name in ["lever", "force_curves", "peak_force", "set_point", "sensitivity"] {
        texts.push(std::fs::read_to_string(format!("scenes/{name}.toml")).expect("the scene is there"));
    }
    let any = (prop::sample::select(texts), slips(&TOKENS));
    hold(&any, |(text, slips)| {
        let text = slipped(&text, &slips);
        let parsed = Scene::parse(&folder.join("fuzzed.toml"), &text);
        let taken = parsed.is_ok();
        match parsed {
            Ok(scene) => {
                prop_assert!(!scene.is_empty());
                let resolved = scene.resolved_toml();
                let again = Scene::parse(&folder.join("resolved.toml"), &resolved);
                let again = again.map_err(|error| TestCaseError::fail(format!("{error}\nof\n{text}")))?;
                prop_assert_eq!(again.resolved_toml(), resolved);
                prop_assert_eq!(again.len(), scene.len());
            }
            Err(error) => prop_assert!(error.to_string().len() > 20, "{error}"),
        }
        Ok(taken)
    });
}

/// A table of any text is refused in words, or every number of it is one of the sweep.
#[test]
fn tables_of_any_text_are_read_or_refused() {
    const CELLS: [&str; 16] = [
        ",",
        ";",
        "\t",
        "\n",
        "\r\n",
        "\"",
        "#",
        "[nm]",
        "[",
        "]",
        "nan",
        "inf",
        "1e999",
        "-",
        "\u{feff}",
        "approach.gap [m]",
    ];
    let text = "sample.youngs_modulus [GPa],instrument.tip.radius [nm],approach.gap [nm]\n\
                1.5,10,12\n2.0,20,13.5\n2.5,30,14\n0.1,5,1e1\n";
    let scene = r#"
        [instrument.cantilever]
        modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 30 }]
        [drive]
        on = "tip"
        frequency = "300 kHz"
        force = "20 nN"
        [samples]
        file = "rows.csv"
    "#;
    let folder = tempfile::tempdir().expect("there is room");
    hold(&slips(&CELLS), |slips| {
        let table = slipped(text, &slips);
        std::fs::write(folder.path().join("rows.csv"), &table).expect("there is room");
        let parsed = Scene::parse(&folder.path().join("fuzzed.toml"), scene);
        let taken = parsed.is_ok();
        match parsed {
            Ok(scene) => {
                prop_assert!(scene.len() < table.lines().count() + table.matches('\r').count());
                prop_assert!(
                    scene.sweep.quantities().all(|axis| axis.values.iter().all(|value| !value.is_nan()))
                );
            }
            Err(error) => prop_assert!(error.to_string().len() > 20, "{error}"),
        }
        Ok(taken)
    });
}

/// Where bytes are harmed, over what length, how, and by what.
type Harm = (usize, usize, u8, u8);

/// Fewer than `most` of them, for so many bytes.
fn harms(length: usize, most: usize) -> impl Strategy<Value = Vec<Harm>> {
    prop::collection::vec((0..length, 0usize..40, 0u8..8, any::<u8>()), 1..most.max(2))
}

/// The bytes after these: cut off, taken out, overwritten, doubled, appended to, or a bit of them turned over.
fn harmed(bytes: &[u8], all: &[Harm]) -> Vec<u8> {
    let mut harmed = bytes.to_vec();
    for &(from, length, way, byte) in all {
        let from = from.min(harmed.len());
        let to = (from + length).min(harmed.len());
        let piece = harmed[from..to].to_vec();
        match way {
            0 => harmed.truncate(from),
            1 => drop(harmed.drain(from..to)),
            2 => harmed[from..to].fill(byte),
            3 => drop(harmed.splice(from..from, piece)),
            4 => harmed.extend(piece),
            _ => harmed.iter_mut().skip(from).take(1).for_each(|one| *one ^= 1 << (byte % 8)),
        }
    }
    harmed
}

/// The journal of a run that wrote these records.
fn journal(records: &[(RecordKind, Vec<u8>)]) -> Vec<u8> {
    let folder = tempfile::tempdir().expect("there is room");
    let path = folder.path().join("a.h5");
    let (mut file, _) = RunFile::create(&path, "scene", ExistingFile::Kept).expect("the place is free");
    file.begin("the header").expect("there is room");
    records.iter().for_each(|(kind, bytes)| _ = file.append(*kind, bytes).expect("there is room"));
    std::fs::read(file.partial()).expect("it is there")
}

/// Damaged bytes of a journal hold records that were written, in their order, or are refused in words.
#[test]
fn journals_of_any_bytes_hold_what_was_written_or_are_refused() {
    let whole: Vec<(RecordKind, Vec<u8>)> = vec![
        (RecordKind::Portion, (0..200u16).map(|n| (n * 7) as u8).collect()),
        (RecordKind::Unfinished, Vec::new()),
        (RecordKind::Portion, vec![0; 64]),
        (RecordKind::Portion, b"afmjournal 2\n".to_vec()),
    ];
    let bytes = journal(&whole);
    hold(&harms(bytes.len(), 5), |all| {
        let harmed = harmed(&bytes, &all);
        let read = Journal::read(harmed.clone());
        let taken = read.is_ok();
        match read {
            Ok(read) => {
                prop_assert_eq!(read.header(), "the header");
                prop_assert!(read.torn() <= harmed.len() as u64);
                for (kind, own) in read.records() {
                    let written = whole.iter().any(|(one, bytes)| *one == kind && *bytes == own);
                    prop_assert!(written, "{kind:?} {own:?} was never written");
                }
            }
            Err(why) => prop_assert!(why.len() > 10, "{why}"),
        }
        Ok(taken)
    });
}

/// Damaged bytes of a portion are none, or, where its notes alone are damaged, a portion of as many instances.
#[test]
fn portions_of_any_bytes_are_what_they_were_or_none() {
    let spectrum = Floquet { multiplier: 0.3, sigma_min: f64::NAN };
    let rule = BasisRule::Contact { rate: 2e6, count: 3, elastic: true, resonant: false };
    let place = CompactOrbit::new(&SectionState::FREE, spectrum, 256, rule);
    let one = |n: u32| InstanceRecord {
        finished: Finished { status: Status::ALL[n as usize % 3], ..Finished::NOT_RUN },
        estimate: 1e-4 * f64::from(n),
        left_out: f64::NAN,
        periods: 300 * n,
        jump: n == 2,
        neighbour_started: n > 1,
        precision: Precision::F64,
        fineness: Resolution { steps: 64 << n, gap: 1e-8, rule: BasisRule::shares(1e-3) },
        state: (n > 0).then(|| place.clone()),
        from_rest: (n == 3).then(|| Box::new((Finished::NOT_RUN, place.clone()))),
    };
    let notes = vec!["a note of what a user should know".repeat(40)];
    let about = ChunkMeta { whole: true, searched: true, curves: false, from_rest: true, notes };
    let bytes = portion_to_bytes(7, &about, 4, |n| one(n as u32));
    let written = Chunk::of_bytes(bytes.clone(), (7, 4), 1e-3).expect("it is whole");
    hold(&harms(bytes.len(), 2), |all| {
        let harmed = harmed(&bytes, &all);
        let Some(told) = portion_number(&harmed) else { return Ok(false) };
        let Some(portion) = Chunk::of_bytes(harmed, (7, 4), 1e-3) else { return Ok(false) };
        prop_assert_eq!(told, (7, 4));
        prop_assert_eq!((portion.meta.whole, portion.meta.searched), (true, true));
        prop_assert_eq!(&portion.flags, &written.flags);
        prop_assert!(portion.meta.notes.iter().all(|note| !note.is_empty() && !note.contains('\n')));
        Ok(true)
    });
}
