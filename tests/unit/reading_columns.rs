//! Columns that were once misread without a word: units in names of specimens, whole lengths, ranges of load, rows that do not count.

use std::fs;
use std::path::Path;

use perilife_base::table::units::{CycleUnit, LengthUnit};
use perilife_base::units::MM;
use perilife_calibration::case::CalibrationCase;
use perilife_measured::{ColumnNames, Import, Measured, RateFileKeys, parse, rates};
use tempfile::tempdir;

use crate::support::workbook::workbook_hiding;

/// Cycles, and crack length in mm.
const CURVE: [(f64, f64); 6] =
    [(1000.0, 5.0), (11_000.0, 6.0), (20_000.0, 7.0), (27_000.0, 8.25), (33_000.0, 9.5), (38_000.0, 11.0)];

fn table(header: &str, row: impl Fn(f64, f64) -> String) -> String {
    CURVE.iter().fold(format!("{header}\n"), |text, &(n, a)| text + &row(n, a) + "\n")
}

fn read(text: &str, import: &Import) -> perilife_base::error::Result<Measured> {
    parse(text.as_bytes(), Path::new("lab.csv"), import)
}

fn all_are_the_curve(name: &str, measured: &Measured, count: usize) {
    assert_eq!(measured.curves.len(), count, "{name}");
    for curve in &measured.curves {
        for (i, (n, a)) in CURVE.iter().enumerate() {
            assert!((curve.cycles[i] / n - 1.0).abs() < 1e-9, "{name}: {:?}", curve.cycles);
            assert!((curve.crack_length[i] / (a * MM) - 1.0).abs() < 1e-9, "{name}: {:?}", curve.crack_length);
        }
    }
}

/// The calibration of a table, on a specimen with its crack of 5 mm.
fn case(specimen: &str, text: &str) -> perilife_base::error::Result<CalibrationCase> {
    let folder = tempdir().unwrap();
    fs::write(folder.path().join("lab.csv"), text).unwrap();
    let case = format!(
        "[measured]\nfiles = [\"lab.csv\"]\n[specimen]\nwidth_mm = 100.0\nlength_mm = 300.0\nthickness_mm = 3.0\n{specimen}\n\
         [material]\nname = \"al2024-t3\"\n[loading]\nstress_max_mpa = 80.0\nstress_ratio = 0.1\n"
    );
    CalibrationCase::from_text(&case, "case.toml", folder.path())
}

const MIDDLE: &str = "kind = \"middle_tension\"\ncrack_length_mm = 5.0";
const PLATE: &str = "kind = \"plate\"\ncracks = [{ from_mm = [-2.5, 0.0], to_mm = [2.5, 0.0] }]";

#[test]
fn specimens_of_a_wide_table_have_their_cycles_in_the_unit_of_their_names() {
    let headers = [
        ("a (mm);S1;CT-1000", [1.0, 1.0]),
        ("a (mm);S1 (kcycles);S2 (kcycles)", [1e3, 1e3]),
        ("a (mm);S1 [10^3];S2 [x1000]", [1e3, 1e3]),
        ("a (mm);S1 (10\u{b3});S2 10^3", [1e3, 1e3]),
        ("a (mm);S1 kilocycles;S2_thousand_cycles", [1e3, 1e3]),
        ("a (mm);N1 (Mcycles);N2 (1e6)", [1e6, 1e6]),
        ("a (mm);S1 (cycles);S2 (kcycles)", [1.0, 1e3]),
        ("a;S1;S2\nmm;kcycles;cycles", [1e3, 1.0]),
        ("a;S1;S2\nmm;10^3;10^6", [1e3, 1e6]),
    ];
    for (header, [one, two]) in headers {
        let text = table(header, |n, a| format!("{a};{};{}", n / one, n / two));
        all_are_the_curve(header, &read(&text, &Import::default()).unwrap(), 2);
    }
    for (header, words) in [
        ("a (mm);S1 (mm);S2", "header = S1 (mm): has an unknown unit; name one of cycles, kilocycles, megacycles"),
        ("a (mm);S1 (kcycles);S2\nmm;cycles;-", "lab.csv:2: S1 (kcycles) = cycles: conflicts with the unit of the name"),
        ("a (mm);S1;S2\nin;cycles;cycles", "lab.csv:2: a (mm) = in: conflicts with the unit of the name above it, mm"),
    ] {
        let error = read(&table(header, |n, a| format!("{a};{n};{n}")), &Import::default()).unwrap_err().to_string();
        assert!(error.contains(words), "{header}: {error}");
    }
    // Whole numbers that could be units are readings.
    let text = "N (cycles),a\n1000,1\n2000,2\n3000,3\n4000,4\n5000,5\n6000,6\n";
    let mm = Import { length: Some(LengthUnit::Millimetre), ..Import::default() };
    assert_eq!(read(text, &mm).unwrap().curves[0].cycles[0], 1000.0);
}

#[test]
fn whole_lengths_are_halved_in_every_shape_where_the_specimen_counts_the_half() {
    // Headers, columns of a row, specimens.
    type Row = fn(f64, f64) -> String;
    let shapes: [(&str, Row, usize); 6] = [
        ("N;2a (mm)", |n, a| format!("{n};{a}"), 1),
        ("N;2a left (mm);2a right (mm)", |n, a| format!("{n};{};{}", a - 0.1, a + 0.1), 1),
        ("2a (mm);S1;S2", |n, a| format!("{a};{n};{n}"), 2),
        ("N;P1 2a (mm);P2 2a (mm)", |n, a| format!("{n};{a};{a}"), 2),
        ("N;2a;N;2a\n-;mm;-;mm", |n, a| format!("{n};{a};{n};{a}"), 2),
        ("N1;2a1 (mm);N2;2a2 (mm)", |n, a| format!("{n};{a};{n};{a}"), 2),
    ];
    for (header, row, count) in shapes {
        let doubled = table(header, |n, a| row(n, 2.0 * a));
        all_are_the_curve(header, &read(&doubled, &Import::default()).unwrap(), count);
        let of_middle = case(MIDDLE, &doubled).unwrap_or_else(|error| panic!("{header}: {error}"));
        assert!((of_middle.read[0].crack_length[3] / MM - 8.25).abs() < 1e-9, "{header}");
        // A plate counts the whole length.
        let of_plate = case(PLATE, &table(header, row)).unwrap_or_else(|error| panic!("{header}: {error}"));
        assert!((of_plate.read[0].crack_length[3] / MM - 8.25).abs() < 1e-9, "{header}: {:?}", of_plate.read[0].crack_length);
        assert!(of_plate.read[0].side_difference.iter().all(|side| (side / MM - 0.2).abs() < 1e-9), "{header}");
    }
    let mixed = table("N;P1 2a (mm);P2 a (mm)", |n, a| format!("{n};{};{a}", 2.0 * a));
    all_are_the_curve("one whole, one half", &read(&mixed, &Import::default()).unwrap(), 2);
    // `2a` is a specimen of its own beside `1a`.
    let measured = read(&table("N;CT-1a (mm);CT-2a (mm)", |n, a| format!("{n};{a};{a}")), &Import::default()).unwrap();
    all_are_the_curve("specimens", &measured, 2);
}

#[test]
fn ranges_of_load_are_read_and_loads_that_are_not_are_told() {
    let names =
        "dP (kN), dF (kN), ΔP (kN), delta P (kN), P_range (kN), Prange (kN), DeltaP [kN], load range (kN), dP_kN, dLoad (kN)";
    for name in names.split(", ") {
        let text = table(&format!("N;a (mm);{name}"), |n, a| format!("{n};{a};10.8"));
        let loads = read(&text, &Import::default()).unwrap().curves.remove(0).loads.unwrap_or_else(|| panic!("{name}"));
        assert!(loads.is_range && (loads.maximum[0] - 10_800.0).abs() < 1e-6, "{name}: {loads:?}");
        // 24 kN at R = 0.1 have a range of 21.6 kN.
        assert!((case(MIDDLE, &text).unwrap().read[0].load_factor[0] - 0.5).abs() < 1e-9, "{name}");
    }
    for name in ["dS (MPa)", "dsigma (MPa)", "Δσ (MPa)"] {
        let text = table(&format!("N;a (mm);{name}"), |n, a| format!("{n};{a};36"));
        assert!((case(MIDDLE, &text).unwrap().read[0].load_factor[0] - 0.5).abs() < 1e-9, "{name}");
    }
    for (name, is_told) in [
        ("Pop (kN)", true),
        ("closure load (kN)", true),
        ("dP", true),
        ("K (MPa√m)", false),
        ("dF (Hz)", false),
        ("COD (mm)", false),
    ] {
        let measured = read(&table(&format!("N;a (mm);{name}"), |n, a| format!("{n};{a};{a}")), &Import::default()).unwrap();
        let told = measured.warnings.iter().any(|line| line.contains("ignored") && line.contains(name));
        assert_eq!(told, is_told, "{name}: {:?}", measured.warnings);
        assert!(measured.curves[0].loads.is_none(), "{name}");
    }
}

/// Names of columns with the cells of a row that counts, one that does not, and another one that counts.
const MARKS: [(&str, [&str; 3]); 12] = [
    ("valid", ["yes", "no", "yes"]),
    ("Valid?", ["TRUE", "FALSE", "TRUE"]),
    ("used", ["1", "0", "1"]),
    ("Use (y/n)", ["y", "n", "y"]),
    ("included in fit", ["x", "", "x"]),
    ("include", ["", "no", ""]),
    ("exclude", ["", "x", "-"]),
    ("Rejected", ["no", "yes", "no"]),
    ("outlier", ["false", "true", ""]),
    ("flag", ["ok", "x", "ok"]),
    ("Flag", ["0.0", "1.0", "0.0"]),
    ("flags", ["0", "1", ""]),
];

#[test]
fn rows_marked_out_are_left_out_with_a_note() {
    let keys = RateFileKeys { stress_ratio: Some(0.1), ..RateFileKeys::default() };
    for (name, [good, bad, other]) in MARKS {
        let rows = |header: &str, row: &dyn Fn(usize, f64) -> String| -> String {
            let mark = |i: usize| {
                if i == 4 {
                    bad
                } else if i == 6 {
                    other
                } else {
                    good
                }
            };
            (1..9).fold(format!("{header};{name}\n"), |text, i| text + &row(i, i as f64) + ";" + mark(i) + "\n")
        };
        let note = format!("1 of 8 rows excluded: flagged by the column {name} (line 5); remove the column");
        let lengths = rows("N;a (mm)", &|i, x| format!("{};{}", 1000 * i, if i == 4 { 30.0 } else { 5.0 + x }));
        let measured = read(&lengths, &Import::default()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(measured.curves[0].cycles, [1e3, 2e3, 3e3, 5e3, 6e3, 7e3, 8e3], "{name}");
        assert!(measured.warnings.len() == 1 && measured.warnings[0].contains(&note), "{name}: {:?}", measured.warnings);
        let text = rows("ΔK (MPa√m);da/dN (mm/cycle)", &|_, x| format!("{};{}", 10.0 + x, x * 1e-5));
        let table = rates::read(text.as_bytes(), Path::new("r.csv"), &keys).unwrap_or_else(|error| panic!("{name}: {error}"));
        let lines: Vec<usize> = table.rows.iter().map(|row| row.line).collect();
        assert_eq!(lines, [2, 3, 4, 6, 7, 8, 9], "{name}");
        assert!(table.warnings.len() == 1 && table.warnings[0].contains(&note), "{name}: {:?}", table.warnings);
    }
    // What is not understood is told, and what leaves nothing refused.
    let marked = |mark: &dyn Fn(f64) -> &'static str| table("N;a (mm);valid", |n, a| format!("{n};{a};{}", mark(a)));
    let measured = read(&marked(&|a| if a > 9.0 { "perhaps" } else { "yes" }), &Import::default()).unwrap();
    all_are_the_curve("perhaps", &measured, 1);
    let words = "lab.csv:6: valid = \"perhaps\" is neither yes nor no (1 more cells)";
    assert!(measured.warnings.iter().any(|line| line.contains(words)), "{:?}", measured.warnings);
    let error = read(&marked(&|_| "no"), &Import::default()).unwrap_err().to_string();
    assert!(error.contains("has no usable row: each is flagged by the column valid"), "{error}");
    // A column that says nothing says nothing.
    assert!(read(&marked(&|_| ""), &Import::default()).unwrap().warnings.is_empty());
}

#[test]
fn what_a_workbook_hides_is_left_out_or_told() {
    let mut rows = vec![["N", "a (mm)", "Time (s)"].map(str::to_owned).to_vec()];
    rows.extend(CURVE.map(|(n, a)| vec![n.to_string(), a.to_string(), "1".to_owned()]));
    rows.insert(4, ["21000", "30", "1"].map(str::to_owned).to_vec());
    let columns = "<cols><col min=\"2\" max=\"3\" width=\"9\" hidden=\"1\"/></cols>";
    for name in ["data", "A &amp; B"] {
        let book = workbook_hiding(&[(name, rows.clone())], &[5], columns);
        let measured = parse(&book, Path::new("lab.xlsx"), &Import::default()).unwrap();
        all_are_the_curve(name, &measured, 1);
        for words in ["1 of 7 rows excluded: hidden in the workbook (line 5)", "hidden columns are used: a (mm), Time (s)"] {
            assert!(measured.warnings.iter().any(|line| line.contains(words)), "{name}: {:?}", measured.warnings);
        }
    }
    let book = workbook_hiding(&[("data", rows)], &[2, 3, 4, 5, 6, 7, 8], "");
    let error = parse(&book, Path::new("lab.xlsx"), &Import::default()).unwrap_err().to_string();
    assert!(error.contains("has no usable row: each is hidden in the workbook; unhide them"), "{error}");
}

#[test]
fn a_first_reading_is_at_the_start_within_its_rounding() {
    for digits in [4, 5, 6] {
        let text = table("N;a (in)", |n, a| format!("{n};{:.digits$}", a / 25.4));
        let started = case(MIDDLE, &text).unwrap_or_else(|error| panic!("{digits}: {error}"));
        assert!(started.curves[0].crack_length[0] >= started.case.specimen.crack_length, "{digits}");
    }
    // Rounded in a report by up to 0.05 mm, as long as one reading alone is put at the start.
    let started = |short: f64, step: f64| {
        let of = |n: f64, a: f64| format!("{n};{}", 5.0 - short + step * (a - 5.0));
        case(MIDDLE, &table("N;a (mm)", of))
    };
    assert!(started(0.04, 1.0).is_ok());
    for (short, step, first) in [(0.06, 1.0, "4.94"), (0.04, 0.01, "4.96")] {
        let error = started(short, step).unwrap_err().to_string();
        assert!(error.contains(&format!("5: exceeds the first reading of specimen lab, {first} mm")), "{error}");
    }
}

#[test]
fn a_name_of_several_words_does_not_move_the_cut_from_commas_to_blanks() {
    let words = ["lab.csv:1: header = total crack length (mm): unknown column", "columns separated by commas"];
    let error = read(&table("N,total crack length (mm)", |n, a| format!("{n},{a}")), &Import::default()).unwrap_err().to_string();
    assert!(words.iter().all(|words| error.contains(words)), "{error}");
    let text = "ln ΔK (MPa√m),ln da/dN (mm/cycle)\n2.079,-10.1\n2.197,-9.75\n";
    let error = rates::read(text.as_bytes(), Path::new("r.csv"), &RateFileKeys::default()).unwrap_err().to_string();
    assert!(error.contains("has no columns delta_k_mpa_sqrt_m") && !error.contains("blanks"), "{error}");
}

#[test]
fn lengths_left_and_right_are_sides_of_one_specimen() {
    for header in ["N;a_L (mm);a_R (mm)", "N;aLeft (mm);aRight (mm)", "N;left;right\n-;mm;mm"] {
        let measured = read(&table(header, |n, a| format!("{n};{};{}", a - 0.1, a + 0.1)), &Import::default()).unwrap();
        all_are_the_curve(header, &measured, 1);
        assert!((measured.curves[0].side_difference[0] / MM - 0.2).abs() < 1e-9, "{header}");
    }
    // Sides or specimens, places of one crack or specimens, two cracks, a length from the notch: asked about.
    for header in [
        "N;aL (mm);aR (mm)",
        "N;AL (mm);AR (mm)",
        "N;a1 (mm);a2 (mm)",
        "N;Crack A (mm);Crack B (mm)",
        "N;a left from notch (mm);S2 (mm)",
    ] {
        let text = table(header, |n, a| format!("{n};{a};{a}"));
        let error = read(&text, &Import::default()).unwrap_err().to_string();
        assert!(error.contains("lab.csv:1: header = ") && error.contains("--column length="), "{header}: {error}");
        let mut columns = ColumnNames::default();
        header.split(';').skip(1).for_each(|name| columns.put(&format!("length={name}")).unwrap());
        all_are_the_curve(header, &read(&text, &Import { columns, ..Import::default() }).unwrap(), 1);
    }
}

/// What stands above the header or beside the columns that are read, and contradicts how they are.
#[test]
fn what_a_table_says_against_its_columns_is_told() {
    let rows = |header: &str, more: &dyn Fn(usize, f64) -> String| {
        let line = |(i, (n, a)): (usize, &(f64, f64))| format!("{n},{a}{}\n", more(i, *a));
        format!("{header}\n{}", CURVE.iter().enumerate().map(line).collect::<String>())
    };
    let plain = |_: usize, _: f64| String::new();
    for preamble in [
        "Cycle counts are given in kilocycles",
        "Zyklen in Tausend",
        "N x 1000",
        "Cycles are counted in blocks of 1000 cycles",
        "Unit of N;kilocycles",
        "# Units: N [kcycles]",
    ] {
        let text = rows(&format!("{preamble}\nN,a (mm)"), &plain);
        let error = read(&text, &Import::default()).unwrap_err().to_string();
        assert!(error.contains("lab.csv:1: ") && error.contains("may give the unit of cycles"), "{preamble}: {error}");
        let said = Import { cycles: Some(CycleUnit::Cycles), ..Import::default() };
        all_are_the_curve(preamble, &read(&text, &said).unwrap(), 1);
    }
    for preamble in ["Precracked for 50 thousand cycles", "Frequency 1000 Hz, cycles sinusoidal", "Plate 10 x 1000 mm"] {
        all_are_the_curve(preamble, &read(&rows(&format!("{preamble}\nN,a (mm)"), &plain), &Import::default()).unwrap(), 1);
    }
    let warnings = |header: &str, more: &dyn Fn(usize, f64) -> String| {
        let measured = read(&rows(header, more), &Import::default()).unwrap();
        all_are_the_curve(header, &measured, 1);
        measured.warnings.join("\n")
    };
    // Lengths of potential drop, alone or corrected by a few optical ones; two methods in every row are asked about.
    for header in ["N,a_DCPD [mm],Vpd (uV)", "N,DCPD (mm),V/V0", "N,Crack length by potential drop (mm),Vpd (uV)"] {
        all_are_the_curve(header, &read(&rows(header, &|i, _| format!(",{}", 600 + i)), &Import::default()).unwrap(), 1);
    }
    let few = |i: usize, a: f64| if i.is_multiple_of(3) { format!(",{}", 1.1 * a - 0.5) } else { ",".to_owned() };
    let measured = read(&rows("N,a_DCPD [mm],a_optical [mm]", &few), &Import::default()).unwrap();
    let plain = read(&rows("N,a (mm)", &|_, _| String::new()), &Import::default()).unwrap();
    for (own, of_dcpd) in measured.curves[0].crack_length.iter().zip(&plain.curves[0].crack_length) {
        assert!((own / (1.1 * of_dcpd - 0.5e-3) - 1.0).abs() < 1e-9, "{own} of {of_dcpd}");
    }
    assert!(measured.warnings[0].contains("a_DCPD [mm] is corrected by"), "{:?}", measured.warnings);
    let error = read(&rows("N,a DCPD (mm),a ACPD (mm)", &|_, a| format!(",{a}")), &Import::default()).unwrap_err().to_string();
    assert!(error.contains("measured.columns = { length = \"a ACPD (mm)\" }"), "{error}");
    for remark in ["rejected", "ungültig", "void: grips slipped", "fail"] {
        let told = warnings("N,a (mm),Comment", &|i, _| format!(",{}", if i == 2 { remark } else { "ok" }));
        assert!(told.contains("lab.csv:4: Comment") && told.contains("1 row"), "{remark}: {told}");
    }
    assert!(warnings("N,a (mm),Comment", &|_, _| ",checked".to_owned()).is_empty());
    // Statistics beside specimens are none.
    for name in ["Mean", "Std dev", "s.d.", "Standardabweichung", "N mean", "Predicted", "Design curve"] {
        let text = table(&format!("a (mm);S1;S2;{name}"), |n, a| format!("{a};{n};{n};{n}"));
        let measured = read(&text, &Import::default()).unwrap();
        all_are_the_curve(name, &measured, 2);
        assert!(measured.warnings.iter().any(|line| line.contains(&format!("or a model): {name}"))), "{:?}", measured.warnings);
    }
    for name in ["Type A", "Design A", "-40 C", "Plate model 3"] {
        let text = table(&format!("a (mm);S1;S2;{name}"), |n, a| format!("{a};{n};{n};{n}"));
        all_are_the_curve(name, &read(&text, &Import::default()).unwrap(), 3);
    }
}
