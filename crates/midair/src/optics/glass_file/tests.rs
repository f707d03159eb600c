use super::*;
use crate::optics::glass;
use proptest::prelude::*;

fn parsed(text: &str) -> Result<GlassFile, GlassFileError> {
    midair_peers::corpus::keep("tables", &[&[0], text.as_bytes()]);
    GlassFile::from_yaml(text.as_bytes(), Path::new("glass.yml"))
}

fn by_formula(number: u8, coefficients: &str) -> GlassFile {
    parsed(&format!(
        "REFERENCES: \"a data sheet\"\nDATA:\n  - type: formula {number}\n    wavelength_range: 0.3 2.5\n    \
         coefficients: {coefficients}\n"
    ))
    .unwrap()
}

/// N-BK7 by Schott's coefficients, k by a table.
const CROWN: &str = "# a comment
REFERENCES: |
    Schott, data sheets
    of 2017
DATA:
  - type: formula 2
    wavelength_range: 0.3 2.5
    coefficients: 0 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653
  - type: tabulated k
    data: |
        0.300 2.8607e-06
        0.400 1.0e-08

        0.600 1.2e-08
        2.500 8.0e-05
SPECS:
    n_is_absolute: false
    nested: [{ DATA: 7 }, [1, 2]]
";

#[test]
fn catalogue_values_come_out() {
    // n_d of the makers' data sheets, of Daimon and Masumura for water at 20 degrees; half of the last digit printed.
    let crown = parsed(CROWN).unwrap();
    assert!((crown.index(0.5875618) - 1.5168).abs() < 5e-6);
    let flint = "0 1.61625977 0.0127534559 0.259229334 0.0581983954 1.07762317 116.60768";
    assert!((by_formula(2, flint).index(0.5875618) - 1.72825).abs() < 5e-6);
    let water = "0 0.5684027565 0.005101829712 0.1726177391 0.01821153936 0.02086189578 0.02620722293 \
                 0.1130748688 10.69792721";
    assert!((by_formula(2, water).index(0.589) - 1.33336).abs() < 1e-5);
    // Malitson's fused silica has lengths where formula 2 has their squares. n_d of the same paper: 1.45846.
    let silica = "0 0.6961663 0.0684043 0.4079426 0.1162414 0.8974794 9.896161";
    assert!((by_formula(1, silica).index(0.5875618) - 1.45846).abs() < 5e-6);
    // Air at 15 degrees and 101325 Pa: Ciddor, Applied Optics 35, 1566 (1996), eq. 1; n - 1 = 2.7653e-4 at 633 nm is his table 1's.
    let air = "0 0.05792105 238.0185 0.00167917 57.362";
    assert!((by_formula(6, air).index(0.633) - 1.0 - 2.7653e-4).abs() < 1e-8);
}

#[test]
fn one_law_comes_out_alike_by_several_formulas() {
    // n = 1.5 + 0.004 / w^2 by Cauchy; its square as a polynomial 2.25 + 0.012 w^-2 + 1.6e-5 w^-4; the same in the form of formula 4.
    let cauchy = by_formula(5, "1.5 0.004 -2");
    let polynomial = by_formula(3, "2.25 0.012 -2 1.6e-5 -4");
    let fourth = by_formula(4, "2.25 0 0 0 0 0 0 0 0 0.012 -2 1.6e-5 -4");
    // One Sellmeier term by formulas 1, 2, 4 (as a pole: b w^2 / (w^2 - l^2)), and 9 (1 + b + b l / (w^2 - l)).
    let sellmeier = [
        by_formula(1, "0 1.2 0.1"),
        by_formula(2, "0 1.2 0.01"),
        by_formula(4, "1 1.2 2 0.1 2"),
        by_formula(9, "2.2 0.012 0.01 0 0 1"),
    ];
    // Retro: x = (n^2 - 1) / (n^2 + 2) = 0.3 gives n^2 = 1.6 / 0.7.
    let retro = by_formula(8, "0.3 0 0.01 0");
    let herzberger = by_formula(7, "1.5 0.001 0.0001 -0.002");
    for w in [0.35f64, 0.4, 0.5876, 0.7, 1.9] {
        let n = 1.5 + 0.004 / (w * w);
        for glass in [&cauchy, &polynomial, &fourth] {
            assert!((glass.index(w) - n).abs() < 1e-12, "{glass:?} at {w}");
        }
        let n = (1.0 + 1.2 * w * w / (w * w - 0.01)).sqrt();
        for glass in &sellmeier {
            assert!((glass.index(w) - n).abs() < 1e-12, "{glass:?} at {w}");
        }
        assert!((retro.index(w) - (1.6f64 / 0.7).sqrt()).abs() < 1e-12);
        let l = 1.0 / (w * w - 0.028);
        let n = 1.5 + 0.001 * l + 0.0001 * l * l - 0.002 * w * w;
        assert!((herzberger.index(w) - n).abs() < 1e-12);
    }
}

#[test]
fn the_file_and_the_catalogue_say_the_same() {
    let (file, known) = (parsed(CROWN).unwrap(), glass::lookup("N-BK7").unwrap());
    for w in [0.4, 0.465, 0.549, 0.611, 0.75] {
        assert!((file.index(w) - known.index(w)).abs() < 1e-12);
    }
    assert!(file.index(0.29).is_nan() && file.index(2.51).is_nan());
    assert_eq!((file.range(), file.absorption_range()), ([0.3, 2.5], Some([0.3, 2.5])));
}

#[test]
fn tables_are_linear_between_their_lines_and_k_absorbs() {
    let file = parsed(CROWN).unwrap();
    // 4 pi k / lambda: k = 1.1e-8 at 0.5 micrometres.
    let expected = 4.0 * std::f64::consts::PI * 1.1e-8 / 0.5e-3;
    assert!((file.absorption(0.5) / expected - 1.0).abs() < 1e-12);
    let both = parsed("DATA:\n- type: tabulated nk\n  data: |\n    0.4 1.6 0\n    0.8 1.5 4e-6\n")
        .unwrap();
    assert!((both.index(0.6) - 1.55).abs() < 1e-12);
    assert!((both.absorption(0.6) - 4.0 * std::f64::consts::PI * 2e-6 / 0.6e-3).abs() < 1e-12);
    assert!(both.index(0.39).is_nan() && both.absorption(0.81).is_nan());
    let clear = parsed("DATA: [{ type: tabulated n, data: \"0.4 1.6\\n0.8 1.5\" }]\n").unwrap();
    assert_eq!((clear.absorption(9.0), clear.absorption_range()), (0.0, None));
    assert_eq!(clear.index(0.4), 1.6);
}

#[test]
fn errors_name_the_file_the_line_and_the_remedy() {
    for (text, line, part) in [
        ("", 1, "no DATA"),
        ("a: 1\nb: 2\n", 1, "no DATA"),
        ("a: 1\nDATA: 3\n", 2, "list of entries"),
        ("DATA:\n  - data: |\n      1 2\n", 2, "no `type`"),
        ("DATA:\n  - type: formula 12\n", 2, "formula 12 is not known"),
        ("DATA:\n  - type: tabulated q\n", 2, "tabulated q"),
        ("DATA:\n  - type: formula 2\n    wavelength_range: 0.4 0.8\n", 2, "coefficients"),
        ("DATA:\n  - type: formula 2\n    coefficients: 0 1 x\n", 3, "`x` is not a number"),
        ("DATA:\n  - type: formula 2\n    coefficients: 1\n", 3, "3 to 17 coefficients"),
        ("DATA:\n  - type: formula 2\n    coefficients: 0 1 2\n", 2, "wavelength_range"),
        (
            "DATA:\n  - type: formula 2\n    wavelength_range: 0.8 0.4\n    coefficients: 0 1 2\n",
            3,
            "shorter one first",
        ),
        ("DATA:\n  - type: tabulated n\n    data: |\n      0.4 1.5\n      0.5\n", 5, "1 numbers"),
        (
            "DATA:\n  - type: tabulated n\n    data: |\n      0.4 1.5\n\n      0 1.5\n",
            6,
            "more than 0",
        ),
        ("DATA:\n  - type: tabulated nk\n    data: |\n      0.4 1.5 -0.1\n", 4, "negative"),
        ("DATA:\n  - type: tabulated n\n    data: |\n      0.4 -1.5\n", 4, "negative"),
        ("DATA:\n  - type: tabulated n\n    data: \"\"\n", 3, "empty"),
        ("DATA:\n  - type: tabulated k\n    data: |\n      0.4 0\n", 2, "nothing of an index"),
        ("DATA:\n  - {type: formula 1\n", 3, "no YAML"),
        ("DATA:\n  - 7\n", 2, "list of entries"),
        ("DATA:\n  - type: formula 1\n    type: formula 2\n", 3, "duplicated key"),
        ("a: *b\n", 1, "no YAML"),
    ] {
        let message = parsed(text).unwrap_err().to_string();
        assert!(message.contains(part) && message.contains("glass.yml"), "{text:?}: {message}");
        assert!(message.contains(&format!("line {line}:")), "{text:?}: {message}");
    }
    let latin = GlassFile::from_yaml(b"a: 1\nb: caf\xe9\n", Path::new("glass.yml")).unwrap_err();
    assert!(latin.to_string().contains("line 2: it is not UTF-8"), "{latin}");
}

#[test]
fn of_a_fit_and_its_table_the_last_entry_counts() {
    let glass = parsed(
        "DATA:\n  - type: formula 5\n    wavelength_range: 0.375 1\n    coefficients: 1.5 0.0 -2\n  - type: tabulated nk\n    data: |\n      \
         0.4 1.6 0.001\n      0.6 1.7 0.003\n",
    )
    .unwrap();
    // Half way between the table's lines.
    assert!((glass.index(0.5) - 1.65).abs() < 1e-12);
    assert!((glass.absorption(0.5) - 4.0 * std::f64::consts::PI * 0.002 / 0.0005).abs() < 1e-9);
    assert_eq!(glass.range(), [0.4, 0.6]);
}

#[test]
fn tables_out_of_order_and_with_wavelengths_twice_are_read() {
    let table = |lines: &str| {
        parsed(&format!("DATA:\n  - type: tabulated nk\n    data: |\n{lines}")).unwrap()
    };
    let good = table("      0.4 1.5 0\n      0.6 1.4 2e-7\n      0.8 1.3 4e-7\n");
    // The same, with the middle one last, and one of them again with other values.
    let mixed = table("      0.4 1.5 0\n      0.8 1.3 4e-7\n      0.4 1.6 1\n      0.6 1.4 2e-7\n");
    assert_eq!(good, mixed);
    assert_eq!(good.range(), [0.4, 0.8]);
    // Halfway between 1.5 and 1.4.
    assert!((mixed.index(0.5) - 1.45).abs() < 1e-12);
    let noisy = table("      0.4 1.5 -1.6e-9\n      0.8 1.5 -1e-7\n");
    assert_eq!(noisy.absorption(0.6), 0.0);
}

proptest! {
    #[test]
    fn damaged_files_never_panic(
        cuts in prop::collection::vec((0usize..600, any::<u8>()), 1..12),
        tail in "[\\[\\]{}:\\-|>&*!\n a0.]{0,40}",
    ) {
        let mut bytes = CROWN.as_bytes().to_vec();
        for (at, byte) in cuts {
            let at = at % bytes.len();
            bytes[at] = byte;
        }
        bytes.extend(tail.as_bytes());
        match parsed(&String::from_utf8_lossy(&bytes)) {
            // Whatever numbers it holds, it answers.
            Ok(glass) => drop((glass.index(0.5), glass.absorption(0.5))),
            Err(error) => prop_assert!(error.to_string().contains("glass.yml"), "{error}"),
        }
    }
}

#[test]
fn deep_nesting_is_no_danger() {
    let brackets = "[".repeat(100_000);
    // An alias brings its own depth with it: each line is as deep as the one before and some more.
    let mut aliases = "a0: &a0 [[[[[[[[[[[[7]]]]]]]]]]]]\n".to_owned();
    for i in 1..20_000 {
        let (open, shut) = ("[".repeat(20), "]".repeat(20));
        aliases += &format!("a{i}: &a{i} {open}*a{}{shut}\n", i - 1);
    }
    for text in [brackets, "- ".repeat(50_000), "a: {".repeat(50_000), aliases] {
        assert!(parsed(&text).is_err());
    }
}
