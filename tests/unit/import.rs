//! Tables as laboratories write them: every dress of one curve is that curve, and what cannot be told is refused by name.

use std::fs;
use std::path::Path;

use perilife_base::table::units::{CycleUnit, LengthUnit, LoadUnit};
use perilife_base::table::{Decimal, Sheet};
use perilife_base::units::MM;
use perilife_calibration::case::CalibrationCase;
use perilife_measured::{Import, RateFileKeys, parse, rates};
use tempfile::tempdir;

use crate::support::lab::{CURVE, all_are_the_curve, columns, read, table, table_of};
use crate::support::rows::{assert_refusal, assert_says, rows};
use crate::support::workbook::{workbook, workbook_hiding};

type Dress = (String, String, usize);

fn plain() -> Import {
    Import::default()
}

fn in_mm() -> Import {
    Import { length: Some(LengthUnit::Millimetre), ..plain() }
}

fn refused(text: &str, import: &Import) -> String {
    read(text, import).unwrap_err().to_string()
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
fn every_dress_of_the_curve_is_the_curve() {
    for (header, row, count) in rows::<Vec<Dress>>("import", "read") {
        all_are_the_curve(&format!("{header}: {row}"), read(&table(&header, &row), &plain()), count);
    }
    let text = table("Cycles;Crack length [mm]", "{n};{a:2}");
    let changes =
        [("27000", "Cycles;Crack length [mm]\n27000"), ("\n", "\r"), (".00\n", ".00;;\n"), ("11.00\n", "11.00\n;\n;;\n\n")];
    for (old, new) in changes {
        all_are_the_curve(new, read(&text.replace(old, new), &plain()), 1);
    }
    for cycles in rows::<Vec<String>>("import", "cycles") {
        all_are_the_curve(&cycles, read(&table(&format!("{cycles}|a (mm)"), "{n}|{a:2}"), &plain()), 1);
    }
    for length in rows::<Vec<String>>("import", "lengths") {
        all_are_the_curve(&length, read(&table(&format!("N|{length}"), "{n}|{a:2}"), &plain()), 1);
    }
    // A column that is not read decides for one that leaves it open.
    let whole =
        "Zeit (s);Zyklen;a (mm)\n500.5;5,000;12\n5852.5;58,528;13\n10786.5;107,862;14\n15337.5;153,379;15\n19541.5;195,413;16";
    assert_eq!(read(whole, &plain()).unwrap().curves[0].cycles, [5000.0, 58_528.0, 107_862.0, 153_379.0, 195_413.0]);
    // Whole numbers that could be units are readings.
    let text = "N (cycles),a\n1000,1\n2000,2\n3000,3\n4000,4\n5000,5\n6000,6\n";
    assert_eq!(read(text, &in_mm()).unwrap().curves[0].cycles[0], 1000.0);
}

#[test]
fn what_cannot_be_told_is_refused_by_name() {
    for (header, row, words) in rows::<Vec<(String, String, Vec<String>)>>("import", "refused") {
        let error = refused(&table(&header, &row), &plain());
        assert_says(&error, &words);
        assert!(!error.contains("line 8"), "five rows are shown: {error}");
    }
    // What the file leaves open, unless the decimal sign is given.
    let open = [
        "N;a [mm]\n5.000;12\n58.528;13\n107.862;14\n153.379;15\n195.413;16\n",
        "N;a [mm]\n5.000;12.00\n58.528;13.00\n107.862;14.00\n153.379;15.00\n195.413;16.00\n",
        "N,a [mm]\n5.000,12.00\n58.528,13.00\n107.862,14.00\n153.379,15.00\n195.413,16.00\n",
    ];
    let second = |text: &str, decimal| read(text, &Import { decimal: Some(decimal), ..plain() }).unwrap().curves[0].cycles[1];
    for text in open {
        assert_says(&refused(text, &plain()), &["lab.csv:2: N = 5.000: ", "is ambiguous: 5 or 5000", "measured.decimal"]);
        assert_eq!(second(text, Decimal::Point), 58.528, "{text}");
    }
    assert_eq!(second(open[0], Decimal::Comma), 58_528.0);
    // Kilocycles have three decimals as a matter of course.
    let kilo = open[1].replace("N;", "N (kcycles);");
    assert_eq!(read(&kilo, &plain()).unwrap().curves[0].cycles[1], 58_528.0);
    let import = Import { cycles: Some(CycleUnit::Kilocycles), ..plain() };
    let error = refused(&table("N (Mcycles);a (mm)", "{n};{a}"), &import);
    assert!(error.contains("is in megacycles, but measured.cycle_unit says kilocycles"), "{error}");
    let text = "ln ΔK (MPa√m),ln da/dN (mm/cycle)\n2.079,-10.1\n2.197,-9.75\n";
    let error = rates::read(text.as_bytes(), Path::new("r.csv"), &RateFileKeys::default()).unwrap_err().to_string();
    assert!(error.contains("has no columns delta_k_mpa_sqrt_m") && !error.contains("blanks"), "{error}");
}

#[test]
fn encodings_of_spreadsheets_are_read() {
    let text = table("Zyklen;Ri\u{df}l\u{e4}nge (mm)", "{n};{a:2}");
    let utf16 = |order: fn(u16) -> [u8; 2], mark: bool| -> Vec<u8> {
        let mark = mark.then_some(0xfeff);
        mark.into_iter().chain(text.encode_utf16()).flat_map(order).collect()
    };
    let western = text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect();
    let dresses = [
        ("UTF-8 with a mark", format!("\u{feff}{text}").into_bytes()),
        ("UTF-16, little end first", utf16(u16::to_le_bytes, true)),
        ("UTF-16, big end first", utf16(u16::to_be_bytes, true)),
        ("UTF-16 without a mark", utf16(u16::to_le_bytes, false)),
        ("UTF-16, big end first, without a mark", utf16(u16::to_be_bytes, false)),
        ("Windows-1252", western),
    ];
    for (name, bytes) in dresses {
        all_are_the_curve(name, parse(&bytes, Path::new("lab.csv"), &plain()), 1);
    }
    let refused = parse(b"cycles,a_mm\n\x00\x01\x02\x03\x04\x05\x06,1\n", Path::new("x.csv"), &plain());
    assert_refusal(refused, &["x.csv:2: is not text"]);
}

#[test]
fn columns_may_be_named_by_the_user() {
    let strange = table("t;Zahl;Sonde [in];Kraft", "{n/10};{n};{a/25.4};7");
    for names in [["cycles=Zahl", "length=Sonde [in]"], ["cycles=zahl", "length= SONDE  [in]"], ["cycles=2", "length=3"]] {
        all_are_the_curve(names[1], read(&strange, &columns(&names)), 1);
    }
    let headless = table("", "{n},{a:2}").trim_start().to_owned();
    let import = Import { length: Some(LengthUnit::Millimetre), ..columns(&["cycles=1", "length=2"]) };
    all_are_the_curve("no header", read(&headless, &import), 1);
    // The user's word goes before that of the names.
    let both = table("N,a (mm),a corrected (mm)", "{n},{a+1},{a}");
    let error = refused(&both, &plain());
    assert!(error.contains("duplicates an earlier column; select one by measured.columns = { length ="), "{error}");
    all_are_the_curve("the corrected one", read(&both, &columns(&["cycles=N", "length=a corrected (mm)"])), 1);
    let error = refused(&both, &columns(&["cycles=N", "length=b"]));
    assert!(error.contains("measured.columns.length = b: is not a column of this file; its columns are N | a (mm)"), "{error}");
    let mut columns = columns(&["cycles=N"]).columns;
    for (text, words) in
        [("N", "has no ="), ("depth=a", "has an unknown key"), ("cycles=M", "repeats a column"), ("length=", "has no column")]
    {
        assert_says(&columns.put(text).unwrap_err().to_string(), &["--column = ", words]);
    }
}

#[test]
fn a_wide_table_holds_lengths_alone() {
    let rows = "0;12.8;11.2;6\n10;13.3;11.7;6\n20;13.8;12.2;6\n30;14.3;12.7;6\n40;14.8;13.2;6\n";
    for other in ["Pmax", "Pmax (kN)", "K (MPa√m)", "COD (mm)", "Time (s)", "Temperature", "B", "W (mm)", "Load", "R", "da/dN"]
    {
        let said = refused(&format!("Cycles;S1;S2;{other}\n{rows}"), &in_mm());
        assert_says(&said, &["lab.csv:1: header = S1", "measured.columns"]);
        // Two sides are one specimen, and the other quantity is none.
        let measured = read(&format!("Cycles;Front;Back;{other}\n{rows}"), &in_mm()).unwrap();
        assert_eq!(measured.curves.len(), 1, "{other}");
        assert!((measured.curves[0].crack_length[0] - 12.0 * MM).abs() < 1e-12, "{other}");
        assert!((measured.curves[0].side_difference[0] - 1.6 * MM).abs() < 1e-12, "{other}");
    }
    let text = table("Cycles;S1;S2", "{n};{a};{a-0.5}");
    assert_eq!(read(&text, &in_mm()).unwrap().curves.len(), 2);
    let named = Import { length: Some(LengthUnit::Millimetre), ..columns(&["length=S1", "length=S2"]) };
    assert_eq!(read(&text, &named).unwrap().curves.len(), 1);
    let error = refused(&table("Cycles;S1;S2", "{n};{a};11.2"), &in_mm());
    assert!(error.contains("specimen = S2: does not increase: not a crack length"), "{error}");
}

#[test]
fn lengths_left_and_right_are_sides_of_one_specimen() {
    for sides in [
        "front;back",
        "a front (mm);a back (mm)",
        "Left;Right",
        "a_L;a_R",
        "Vorderseite;R\u{fc}ckseite",
        "Crack length (front);Crack length (back)",
        "a_L (mm);a_R (mm)",
        "aLeft (mm);aRight (mm)",
        "left;right\n-;mm;mm",
    ] {
        let measured = all_are_the_curve(sides, read(&table(&format!("N;{sides}"), "{n};{a-0.1};{a+0.1}"), &in_mm()), 1);
        assert!((measured.curves[0].side_difference[0] / MM - 0.2).abs() < 1e-9, "{sides}");
    }
    // Sides or specimens, places of one crack or specimens, two cracks, a length from the notch: asked about.
    for names in
        ["aL (mm);aR (mm)", "AL (mm);AR (mm)", "a1 (mm);a2 (mm)", "Crack A (mm);Crack B (mm)", "a left from notch (mm);S2 (mm)"]
    {
        let text = table(&format!("N;{names}"), "{n};{a};{a}");
        assert_says(&refused(&text, &plain()), &["lab.csv:1: header = ", "--column length="]);
        let named: Vec<String> = names.split(';').map(|name| format!("length={name}")).collect();
        all_are_the_curve(names, read(&text, &columns(&named.iter().map(String::as_str).collect::<Vec<_>>())), 1);
    }
}

#[test]
fn workbooks_are_read_by_sheet() {
    let words = |row: &[&str]| row.iter().map(|word| (*word).to_owned()).collect::<Vec<String>>();
    let readings = |shift: f64| -> Vec<Vec<String>> {
        let mut rows = vec![words(&["Test 7"]), words(&["Cycles", "Crack length (mm)"]), words(&["-", "mm"])];
        // Three decimals of a stored number are no thousands.
        rows.extend(CURVE.iter().map(|(n, a)| vec![n.to_string(), format!("{:.3}", a + shift)]));
        rows
    };
    let notes = vec![words(&["Operator", "J. Doe"]), words(&["Machine", "MTS"])];
    // The bytes say what it is, not the name.
    let of = |bytes: &[u8], sheet: Option<&str>| {
        parse(bytes, Path::new("book"), &Import { sheet: sheet.map(|name| Sheet(name.to_owned())), ..plain() })
    };
    let one = workbook(&[("Notes", notes.clone()), ("data", readings(0.0))]);
    all_are_the_curve("the only sheet of readings", of(&one, None), 1);
    let two = workbook(&[("first", readings(1.0)), ("data", readings(0.0)), ("Notes", notes)]);
    for sheet in ["data", "2"] {
        all_are_the_curve(sheet, of(&two, Some(sheet)), 1);
    }
    let wrong = [
        (two.clone(), None, "has 2 sheets of readings: \"first\", \"data\"; set measured.sheet"),
        (two.clone(), Some("4"), "its sheets are 1 \"first\", 2 \"data\", 3 \"Notes\""),
        (b"PK\x03\x04 nothing of the kind".to_vec(), None, "is not an .xlsx workbook"),
        (two[..two.len() / 2].to_vec(), None, "is not an .xlsx workbook"),
        (table("N,a_mm", "{n},{a}").into_bytes(), Some("data"), "is set for a file that is not a workbook"),
    ];
    for (bytes, sheet, words) in wrong {
        let error = of(&bytes, sheet).unwrap_err();
        assert!(error.exit_code() == 2 && error.to_string().contains(words), "{words}: {error}");
    }
    // What a workbook hides is left out or told.
    let mut rows = vec![words(&["N", "a (mm)", "Time (s)"])];
    rows.extend(CURVE.map(|(n, a)| vec![n.to_string(), a.to_string(), "1".to_owned()]));
    rows.insert(4, words(&["21000", "30", "1"]));
    let hidden = "<cols><col min=\"2\" max=\"3\" width=\"9\" hidden=\"1\"/></cols>";
    for name in ["data", "A &amp; B"] {
        let book = workbook_hiding(&[(name, rows.clone())], &[5], hidden);
        let told = all_are_the_curve(name, of(&book, None), 1).warnings.join("\n");
        let words = ["1 of 7 rows excluded: hidden in the workbook (line 5)", "hidden columns are used: a (mm), Time (s)"];
        assert_says(&told, &words);
    }
    let refused = of(&workbook_hiding(&[("data", rows)], &[2, 3, 4, 5, 6, 7, 8], ""), None);
    assert_refusal(refused, &["has no usable row: each is hidden in the workbook; unhide them"]);
}

#[test]
fn loads_are_read_in_every_unit() {
    let loads = |header: &str, row: String| {
        let measured =
            all_are_the_curve(header, read(&table(&format!("N;a (mm);{header}"), &format!("{{n}};{{a:2}};{row}")), &plain()), 1);
        measured.curves[0].loads.clone().unwrap_or_else(|| panic!("{header}"))
    };
    for (header, largest, smallest) in rows::<Vec<(String, f64, f64)>>("import", "loads") {
        let loads = loads(&header, format!("{largest};{smallest}"));
        assert!((loads.maximum[3] / 6000.0 - 1.0).abs() < 1e-9 && (loads.ratio[3] - 0.1).abs() < 1e-9, "{header}: {loads:?}");
    }
    assert!((loads("stress_max_mpa;stress_min_mpa", "60;6".to_owned()).maximum[0] / 60e6 - 1.0).abs() < 1e-12);
    for (header, row) in [("force_range_kn;R", "5.4;0.1"), ("\u{394}P (kN);Pmin (kN)", "5.4;0.6")] {
        let loads = loads(header, row.to_owned());
        let is_range = loads.is_range && (loads.maximum[2] - 5400.0).abs() < 1e-6;
        assert!(is_range && (loads.ratio[2] - 0.1).abs() < 1e-9, "{header}: {loads:?}");
    }
    // A range beside the load of the case: 24 kN at R = 0.1 have one of 21.6 kN.
    for (name, range) in rows::<Vec<(String, f64)>>("import", "ranges") {
        let text = table(&format!("N;a (mm);{name}"), &format!("{{n}};{{a}};{range}"));
        assert!(read(&text, &plain()).unwrap().curves[0].loads.as_ref().is_some_and(|loads| loads.is_range), "{name}");
        assert!((case(MIDDLE, &text).unwrap().read[0].load_factor[0] - 0.5).abs() < 1e-9, "{name}");
    }
    // Without a unit: no load where it does not change, a refusal where it does, and the user's word for both.
    let still = table("N;a (mm);Pmax;Pmin", "{n};{a:2};6;0.6");
    let measured = read(&still, &plain()).unwrap();
    assert!(measured.curves[0].loads.is_none() && measured.warnings[0].contains("Pmax ignored (unknown load unit)"));
    let changing = still.replace("11.00;6;", "11.00;7;");
    let error = refused(&changing, &plain());
    assert!(error.contains("lab.csv:7: Pmax = 7: is a varying load (from 6) in an unknown unit"), "{error}");
    let import = Import { load: Some(LoadUnit::Kilonewton), ..plain() };
    let loads = read(&changing, &import).unwrap().curves.remove(0).loads.unwrap();
    assert!((loads.maximum[5] - 7000.0).abs() < 1e-9);
    // Loads that are none are told, other quantities are not.
    for (name, is_told) in [
        ("Pop (kN)", true),
        ("closure load (kN)", true),
        ("dP", true),
        ("K (MPa√m)", false),
        ("dF (Hz)", false),
        ("COD (mm)", false),
    ] {
        let measured = all_are_the_curve(name, read(&table(&format!("N;a (mm);{name}"), "{n};{a};{a}"), &plain()), 1);
        let told = measured.warnings.iter().any(|line| line.contains("ignored") && line.contains(name));
        assert!(told == is_told && measured.curves[0].loads.is_none(), "{name}: {:?}", measured.warnings);
    }
}

#[test]
fn whole_lengths_are_halved_in_every_shape_where_the_specimen_counts_the_half() {
    for (header, row, count) in rows::<Vec<Dress>>("import", "whole") {
        let doubled = table_of(&header, &row, 2.0);
        all_are_the_curve(&header, read(&doubled, &plain()), count);
        let of_middle = case(MIDDLE, &doubled).unwrap_or_else(|error| panic!("{header}: {error}"));
        assert!((of_middle.read[0].crack_length[3] / MM - 8.25).abs() < 1e-9, "{header}");
        // A plate counts the whole length.
        let of_plate = case(PLATE, &table(&header, &row)).unwrap_or_else(|error| panic!("{header}: {error}"));
        assert!((of_plate.read[0].crack_length[3] / MM - 8.25).abs() < 1e-9, "{header}: {:?}", of_plate.read[0].crack_length);
        assert!(of_plate.read[0].side_difference.iter().all(|side| (side / MM - 0.2).abs() < 1e-9), "{header}");
    }
}

#[test]
fn rows_marked_out_are_left_out_with_a_note() {
    let keys = RateFileKeys { stress_ratio: Some(0.1), ..RateFileKeys::default() };
    for [name, good, bad, other] in rows::<Vec<[String; 4]>>("import", "marks") {
        let rows = |header: &str, row: &dyn Fn(usize, f64) -> String| -> String {
            let mark = |i: usize| match i {
                4 => &bad,
                6 => &other,
                _ => &good,
            };
            (1..9).fold(format!("{header};{name}\n"), |text, i| text + &row(i, i as f64) + ";" + mark(i) + "\n")
        };
        let note = format!("1 of 8 rows excluded: flagged by the column {name} (line 5); remove the column");
        let lengths = rows("N;a (mm)", &|i, x| format!("{};{}", 1000 * i, if i == 4 { 30.0 } else { 5.0 + x }));
        let measured = read(&lengths, &plain()).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(measured.curves[0].cycles, [1e3, 2e3, 3e3, 5e3, 6e3, 7e3, 8e3], "{name}");
        assert!(measured.warnings.len() == 1 && measured.warnings[0].contains(&note), "{name}: {:?}", measured.warnings);
        let text = rows("ΔK (MPa√m);da/dN (mm/cycle)", &|_, x| format!("{};{}", 10.0 + x, x * 1e-5));
        let table = rates::read(text.as_bytes(), Path::new("r.csv"), &keys).unwrap_or_else(|error| panic!("{name}: {error}"));
        let lines: Vec<usize> = table.rows.iter().map(|row| row.line).collect();
        assert_eq!(lines, [2, 3, 4, 6, 7, 8, 9], "{name}");
        assert!(table.warnings.len() == 1 && table.warnings[0].contains(&note), "{name}: {:?}", table.warnings);
    }
    // What is not understood is told; a column that says nothing says nothing.
    let perhaps = table("N;a (mm);valid", "{n};{a};yes").replace("9.5;yes", "9.5;perhaps").replace("11;yes", "11;perhaps");
    let told = all_are_the_curve("perhaps", read(&perhaps, &plain()), 1).warnings.join("\n");
    assert!(told.contains("lab.csv:6: valid = \"perhaps\" is neither yes nor no (1 more cells)"), "{told}");
    assert!(read(&table("N;a (mm);valid", "{n};{a};"), &plain()).unwrap().warnings.is_empty());
}

#[test]
fn a_first_reading_is_at_the_start_within_its_rounding() {
    for digits in [4, 5, 6] {
        let text = table("N;a (in)", &format!("{{n}};{{a/25.4:{digits}}}"));
        let started = case(MIDDLE, &text).unwrap_or_else(|error| panic!("{digits}: {error}"));
        assert!(started.curves[0].crack_length[0] >= started.case.specimen.crack_length, "{digits}");
    }
    // Rounded in a report by up to 0.05 mm, as long as one reading alone is put at the start.
    let started = |short: f64, step: f64| {
        let rows = CURVE.map(|(n, a)| format!("{n};{}\n", 5.0 - short + step * (a - 5.0)));
        case(MIDDLE, &format!("N;a (mm)\n{}", rows.concat()))
    };
    assert!(started(0.04, 1.0).is_ok());
    for (short, step, first) in [(0.06, 1.0, "4.94"), (0.04, 0.01, "4.96")] {
        assert_refusal(started(short, step), &[&format!("5: exceeds the first reading of specimen lab, {first} mm")]);
    }
}

/// What stands above the header or beside the columns that are read, and contradicts how they are.
#[test]
fn what_a_table_says_against_its_columns_is_told() {
    for preamble in [
        "Cycle counts are given in kilocycles",
        "Zyklen in Tausend",
        "N x 1000",
        "Cycles are counted in blocks of 1000 cycles",
        "Unit of N;kilocycles",
        "# Units: N [kcycles]",
    ] {
        let text = table(&format!("{preamble}\nN,a (mm)"), "{n},{a}");
        assert_says(&refused(&text, &plain()), &["lab.csv:1: ", "may give the unit of cycles"]);
        all_are_the_curve(preamble, read(&text, &Import { cycles: Some(CycleUnit::Cycles), ..plain() }), 1);
    }
    // Lengths of potential drop corrected by a few optical ones.
    let few = |(i, (n, a)): (usize, &(f64, f64))| {
        let optical = if i.is_multiple_of(3) { (1.1 * a - 0.5).to_string() } else { String::new() };
        format!("{n},{a},{optical}\n")
    };
    let text = format!("N,a_DCPD [mm],a_optical [mm]\n{}", CURVE.iter().enumerate().map(few).collect::<String>());
    let measured = read(&text, &plain()).unwrap();
    for (own, (_, of_dcpd)) in measured.curves[0].crack_length.iter().zip(CURVE) {
        assert!((own / MM / (1.1 * of_dcpd - 0.5) - 1.0).abs() < 1e-9, "{own} of {of_dcpd}");
    }
    assert!(measured.warnings[0].contains("a_DCPD [mm] is corrected by"), "{:?}", measured.warnings);
    for (remark, words) in
        [("rejected", "1 row"), ("ungültig", "1 row"), ("void: grips slipped", "1 row"), ("fail", "1 row"), ("checked", "")]
    {
        let text = table("N,a (mm),Comment", "{n},{a},ok").replace("7,ok", &format!("7,{remark}"));
        let told = all_are_the_curve(remark, read(&text, &plain()), 1).warnings.join("\n");
        assert!(told.is_empty() == words.is_empty() && told.contains(words), "{remark}: {told}");
        assert!(words.is_empty() || told.contains("lab.csv:4: Comment"), "{remark}: {told}");
    }
    // Statistics beside specimens are none.
    for name in ["Mean", "Std dev", "s.d.", "Standardabweichung", "N mean", "Predicted", "Design curve"] {
        let text = table(&format!("a (mm);S1;S2;{name}"), "{a};{n};{n};{n}");
        let told = all_are_the_curve(name, read(&text, &plain()), 2).warnings.join("\n");
        assert!(told.contains(&format!("or a model): {name}")), "{told}");
    }
}

#[test]
fn orientation_and_environment_above_a_table_are_noted() {
    let noted = |above: &str| {
        let measured = read(&format!("{above}\n{}", table("N;a (mm)", "{n};{a}")), &plain()).unwrap();
        let [orientation, environment, waveform] = measured.curves[0].source.noted.clone();
        [orientation, environment, waveform].map(Option::unwrap_or_default)
    };
    let cases = [
        ("Material: 7075-T651, L-T, t = 6 mm\nEnvironment: lab air, 23 °C\nMachine: 100 kN", "L-T", "lab air, 23 °C", ""),
        ("# orientation T-L\n# Test temperature = 22 C\n# laboratory air", "T-L", "22 C, laboratory air", ""),
        ("Specimen 7;repair 3\nW = 50 mm", "", "", ""),
        ("Humidity: 45 % RH", "", "Humidity: 45 % RH", ""),
        ("Orientierung;LT\nFrequenz (Hz);10\nPrüftemperatur (°C);23\nUmgebung;Laborluft", "L-T", "23 °C, Laborluft", "10 Hz"),
        ("Frequency: 10 Hz, Waveform: sine\nEnvironmental data: none\nLT 4", "", "", "10 Hz, sine"),
    ];
    for (above, orientation, environment, waveform) in cases {
        assert_eq!(noted(above), [orientation, environment, waveform], "{above}");
    }
}
