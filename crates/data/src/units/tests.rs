use super::*;

/// A small generator (xorshift), so that loops over many numbers repeat exactly.
struct Bits(u64);

impl Bits {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }
}

#[test]
fn reading_is_the_nearest_double() {
    use Dimension::*;
    let cases: [(&str, Dimension, f64); 38] = [
        ("30 nm", Length, 3e-8),
        ("0.3 nm", Length, 3e-10),
        ("4000 um", Length, 4e-3),
        ("6.9 \u{B5}m", Length, 6.9e-6),
        ("6.9 \u{3BC}m", Length, 6.9e-6),
        ("3 \u{C5}", Length, 3e-10),
        ("3 \u{212B}", Length, 3e-10),
        ("3 angstrom", Length, 3e-10),
        ("30nm", Length, 3e-8),
        ("  30   nm ", Length, 3e-8),
        ("-1.5 nm", Length, -1.5e-9),
        ("\u{2212}1.5 nm", Length, -1.5e-9),
        ("+2e-3 mm", Length, 2e-6),
        ("100 kPa", Pressure, 1e5),
        ("22.16 GPa", Pressure, 2.216e10),
        ("2.216e10 N/m^2", Pressure, 2.216e10),
        ("1 MN/m²", Pressure, 1e6),
        ("2 mJ/m^2", SurfaceEnergy, 2e-3),
        ("2 mN/m", SurfaceEnergy, 2e-3),
        ("2 mJ/m²", SurfaceEnergy, 2e-3),
        ("15 V", Voltage, 15.0),
        ("30 kHz", Frequency, 3e4),
        ("438.9 kHz", Frequency, 438_900.0),
        ("42 N/m", Stiffness, 42.0),
        ("42 nN/nm", Stiffness, 42.0),
        ("42 pN/nm", Stiffness, 0.042),
        ("1e-12 N", Force, 1e-12),
        ("2 nN", Force, 2e-9),
        ("6.4e-20 J", Energy, 6.4e-20),
        ("0.064 aJ", Energy, 6.4e-20),
        ("833.3 pg", Mass, 8.333e-13),
        ("8.333e-13 kg", Mass, 8.333e-13),
        ("2.5 g/cm^3", Density, 2500.0),
        ("2500 kg/m^3", Density, 2500.0),
        ("5.45136e8 N/C", ElectricField, 5.45136e8),
        ("545.136 MV/m", ElectricField, 5.45136e8),
        ("7.81e7 V m/C", InversePermittivity, 7.81e7),
        ("78.1 Mm/F", InversePermittivity, 7.81e7),
    ];
    for (text, dimension, expected) in cases {
        assert_eq!(parse(text, dimension).map(f64::to_bits), Ok(expected.to_bits()), "{text}");
    }
    assert_eq!(parse("5 us", Time), Ok(5e-6));
    assert_eq!(parse("inf", Pressure), Ok(f64::INFINITY));
    assert_eq!(parse("inf GPa", Pressure), Ok(f64::INFINITY));
    assert_eq!(parse("inf", Dimensionless), Ok(f64::INFINITY));
    assert_eq!(parse("0.3", Dimensionless), Ok(0.3));
}

#[test]
fn every_prefix_reads_as_the_literal_with_its_exponent() {
    // Multiplying by 1e-9 instead of moving the exponent misses the nearest double in about a third of these.
    let mut bits = Bits(0x1234_5678_9abc_def1);
    let mut product_misses = 0;
    for _ in 0..20_000 {
        let decimal = format!("{}.{:03}", bits.next() % 1000, bits.next() % 1000);
        for (unit, exponent) in [("pm", -12), ("nm", -9), ("um", -6), ("mm", -3), ("cm", -2), ("km", 3)] {
            let literal: f64 = format!("{decimal}e{exponent}").parse().unwrap();
            let read = parse(&format!("{decimal} {unit}"), Dimension::Length).unwrap();
            assert_eq!(read.to_bits(), literal.to_bits(), "{decimal} {unit}");
            let product = decimal.parse::<f64>().unwrap() * 10f64.powi(exponent);
            product_misses += usize::from(product != literal);
        }
    }
    assert!(product_misses > 1000, "the loop no longer tells exact reading from a product");
}

#[test]
fn writing_is_readable() {
    use Dimension::*;
    for (value, dimension, text) in [
        (3e-8, Length, "30 nm"),
        (1.74e-4, Length, "174 um"),
        (4e-3, Length, "4 mm"),
        (2.216e10, Pressure, "22.16 GPa"),
        (1e5, Pressure, "100 kPa"),
        (2e-3, SurfaceEnergy, "2 mJ/m^2"),
        (8.333e-13, Mass, "833.3 pg"),
        (2500.0, Density, "2500 kg/m^3"),
        (8000.0, Density, "8000 kg/m^3"),
        (5.45136e8, ElectricField, "545.136 MV/m"),
        (7.81e7, InversePermittivity, "7.81e7 V m/C"),
        (6.4e-20, Energy, "64 zJ"),
        (0.0, SurfaceEnergy, "0 J/m^2"),
        (15.0, Voltage, "15 V"),
        (f64::INFINITY, Pressure, "inf Pa"),
        (f64::INFINITY, Dimensionless, "inf"),
        (200.0, Dimensionless, "200.0"),
    ] {
        assert_eq!(format(value, dimension), text);
    }
}

#[test]
fn agrees_with_runits() {
    // runits computes in floating point, hence the tolerance; the exactness is tested against literals above.
    use Dimension::*;
    let units: [(Dimension, &str, &[&str]); 9] = [
        (Length, "m", &["m", "mm", "um", "nm", "pm", "cm", "angstrom"]),
        (Time, "s", &["s", "ms", "us", "ns"]),
        (Mass, "kg", &["kg", "g", "mg", "ug", "ng", "pg"]),
        (Density, "kg/m^3", &["kg/m^3", "g/cm^3"]),
        (Frequency, "Hz", &["Hz", "kHz", "MHz", "GHz"]),
        (Force, "N", &["N", "mN", "uN", "nN", "pN"]),
        (Pressure, "Pa", &["Pa", "kPa", "MPa", "GPa", "N/m^2", "bar"]),
        (Energy, "J", &["J", "fJ", "aJ", "zJ"]),
        (Voltage, "V", &["V", "mV", "kV", "uV"]),
    ];
    let mut compared = 0;
    for (dimension, si, names) in units {
        for name in names {
            let text = format!("2.75 {name}");
            let oracle = runits::Quantity::parse(&text).unwrap().to(si).unwrap().value();
            let ours = parse(&text, dimension).unwrap();
            assert!((ours / oracle - 1.0).abs() < 1e-14, "{text}: {ours:e} against {oracle:e}");
            compared += 1;
        }
    }
    assert_eq!(compared, 42);
    for (dimension, si, name) in [(Stiffness, "N/m", "nN/nm"), (SurfaceEnergy, "J/m^2", "mJ/m^2")] {
        let text = format!("2.75 {name}");
        let oracle = runits::Quantity::parse(&text).unwrap().to(si).unwrap().value();
        assert!((parse(&text, dimension).unwrap() / oracle - 1.0).abs() < 1e-14, "{text}");
    }
}

#[test]
fn refusals_say_what_and_why() {
    use Dimension::*;
    use UnitErrorKind::*;
    let cases: [(&str, Dimension, UnitErrorKind, &str); 19] = [
        ("30", Length, MissingUnit, "give its unit: \"30 nm\" or \"30 um\""),
        ("8e-9", Length, MissingUnit, "give its unit: \"8 nm\", if it is in m"),
        ("0", SurfaceEnergy, MissingUnit, "\"0 J/m^2\""),
        ("30 GPa", Length, WrongDimension(Some(Pressure)), "a pressure"),
        ("30 nm", Dimensionless, WrongDimension(Some(Length)), "leave the unit out"),
        ("30 A", Length, WrongDimension(None), "of another kind"),
        ("30 nmm", Length, UnknownUnit, "did you mean \"30 nm\"?"),
        ("1 gpa", Pressure, UnknownUnit, "did you mean \"1 GPa\"?"),
        ("1 mJ/m2", SurfaceEnergy, UnknownUnit, "did you mean \"1 mJ/m^2\"?"),
        ("3 rad/s", Frequency, UnknownUnit, "divide by 2 pi"),
        ("0.4 eV", Energy, UnknownUnit, "1.602176634e-19 J"),
        ("0,3 nm", Length, NotANumber, "\"0.3 nm\""),
        ("1.2.3 nm", Length, NotANumber, "not a number"),
        ("nm", Length, NotANumber, "put a number before the unit"),
        ("", Length, NotANumber, "an empty text"),
        ("fast", Frequency, NotANumber, "expected a frequency with its unit, such as \"30 kHz\""),
        ("1e400 nm", Length, OutOfRange, "beyond the range"),
        ("1e-400 nm", Length, OutOfRange, "beyond the range"),
        ("1e99999999999999999999 nm", Length, OutOfRange, "beyond the range"),
    ];
    for (text, dimension, kind, fragment) in cases {
        let error = parse(text, dimension).unwrap_err();
        assert_eq!(error.kind, kind, "{text}");
        assert!(error.to_string().contains(fragment), "{text}: {error}");
    }
}

#[test]
fn odd_texts_are_refused_without_a_panic() {
    let long = "9".repeat(100_000);
    let unit = "m".repeat(100_000);
    for text in [
        "e", ".", "-", "+", "-e5 m", "1e", "1e+", "1 /m", "1 m/", "1 m//m", "1 m^", "1 m^0", "1 m^99",
        "1 ^2", "1 ²", "µ", "1 µ", "infm", "1\u{0}m", "１ nm", "--1 nm", "0x10 nm", "1 m^-", "nan", "NaN m",
        &long, &unit,
    ] {
        for dimension in Dimension::ALL {
            if let Err(error) = parse(text, dimension) {
                assert!(error.to_string().len() < 600, "message of {} bytes", error.to_string().len());
            } else {
                assert!(dimension == Dimension::Dimensionless && text == "never", "{text:.20}");
            }
        }
    }
}
