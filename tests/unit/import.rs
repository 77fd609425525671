//! Tables as laboratories write them: every dress of one curve is that curve, and what cannot be told is refused by name.

use std::path::Path;

use perilife_base::table::{
    Decimal, Sheet,
    units::{CycleUnit, LengthUnit, LoadUnit},
};
use perilife_base::units::MM;
use perilife_measured::{ColumnNames, Import, parse};

use crate::support::workbook::workbook;

/// Cycles and crack length in mm, as plain as they can be written.
const CURVE: [(f64, f64); 6] =
    [(5000.0, 12.0), (58_528.0, 12.5), (107_862.0, 13.0), (153_379.0, 13.5), (195_413.0, 14.0), (234_259.0, 14.75)];

/// The curve as text: a line a reading, by the caller's words for cycles and length.
fn lines(row: impl Fn(f64, f64) -> String) -> String {
    CURVE.iter().map(|&(n, a)| row(n, a) + "\n").collect()
}

fn table(header: &str, separator: &str) -> String {
    format!("{header}\n{}", lines(|n, a| format!("{n}{separator}{a:.2}")))
}

/// A number with a sign between its thousands.
fn grouped(number: f64, sign: &str) -> String {
    let digits = format!("{number}");
    let cut = digits.len().saturating_sub(3);
    if cut == 0 { digits } else { format!("{}{sign}{}", &digits[..cut], &digits[cut..]) }
}

fn comma(a: f64) -> String {
    format!("{a:.2}").replace('.', ",")
}

fn columns(names: &[&str]) -> ColumnNames {
    let mut columns = ColumnNames::default();
    names.iter().for_each(|name| columns.put(name).unwrap());
    columns
}

fn is_the_curve(name: &str, bytes: &[u8], import: &Import) {
    let measured = parse(bytes, Path::new("lab.txt"), import).unwrap_or_else(|error| panic!("{name}: {error}"));
    assert_eq!(measured.curves.len(), 1, "{name}: {:?}", measured.curves);
    let curve = &measured.curves[0];
    assert_eq!(curve.cycles.len(), CURVE.len(), "{name}: {curve:?}");
    for (i, (n, a)) in CURVE.iter().enumerate() {
        assert!((curve.cycles[i] / n - 1.0).abs() < 1e-9, "{name}: {:?}", curve.cycles);
        assert!((curve.crack_length[i] / (a * MM) - 1.0).abs() < 1e-9, "{name}: {:?}", curve.crack_length);
    }
}

#[test]
fn thousands_and_decimals_are_told_apart_by_the_whole_file() {
    let dresses = [
        ("points and commas", format!("Cycles;Crack length (mm)\n{}", lines(|n, a| format!("{};{}", grouped(n, "."), comma(a))))),
        ("commas between tabs", format!("Cycles\tCrack length (mm)\n{}", lines(|n, a| format!("{}\t{a:.2}", grouped(n, ","))))),
        (
            "commas between semicolons",
            format!("Cycles;Crack length (mm)\n{}", lines(|n, a| format!("{};{a:.2}", grouped(n, ",")))),
        ),
        ("commas in quotes", format!("Cycles,Crack length (mm)\n{}", lines(|n, a| format!("\"{}\",{a:.2}", grouped(n, ","))))),
        ("blanks", format!("Cycles;Crack length (mm)\n{}", lines(|n, a| format!("{};{}", grouped(n, " "), comma(a))))),
        (
            "narrow blanks",
            format!("Cycles;Crack length (mm)\n{}", lines(|n, a| format!("{};{}", grouped(n, "\u{202f}"), comma(a)))),
        ),
        ("apostrophes", format!("Cycles;Crack length (mm)\n{}", lines(|n, a| format!("{};{a:.2}", grouped(n, "'"))))),
        (
            "curly apostrophes",
            format!("Cycles\tCrack length (mm)\n{}", lines(|n, a| format!("{}\t{a:.2}", grouped(n, "\u{2019}")))),
        ),
        (
            "exponents",
            format!(
                "Cycles;Crack length (mm)\n{}",
                lines(|n, a| format!("{};{}E+01", comma(n), format!("{:.4}", a / 10.0).replace('.', ",")))
            ),
        ),
        ("three decimals of lengths", format!("Cycles;Crack length (mm)\n{}", lines(|n, a| format!("{n:.0};{a:.3}")))),
        ("three decimals between commas", format!("cycles,a (mm)\n{}", lines(|n, a| format!("{n:.0},{a:.3}")))),
    ];
    for (name, text) in &dresses {
        is_the_curve(name, text.as_bytes(), &Import::default());
    }
    // A column that is not read decides for one that leaves it open.
    let whole =
        "Zeit (s);Zyklen;a (mm)\n500.5;5,000;12\n5852.5;58,528;13\n10786.5;107,862;14\n15337.5;153,379;15\n19541.5;195,413;16\n";
    let curve = parse(whole.as_bytes(), Path::new("whole.csv"), &Import::default()).unwrap().curves.remove(0);
    assert_eq!(curve.cycles, [5000.0, 58_528.0, 107_862.0, 153_379.0, 195_413.0]);
}

#[test]
fn what_the_file_leaves_open_is_refused_unless_the_decimal_sign_is_given() {
    let open = [
        ("all thousands", "N;a [mm]\n5.000;12\n58.528;13\n107.862;14\n153.379;15\n195.413;16\n"),
        ("the same sign twice", "N;a [mm]\n5.000;12.00\n58.528;13.00\n107.862;14.00\n153.379;15.00\n195.413;16.00\n"),
        ("between commas", "N,a [mm]\n5.000,12.00\n58.528,13.00\n107.862,14.00\n153.379,15.00\n195.413,16.00\n"),
    ];
    for (name, text) in open {
        let read = |decimal| parse(text.as_bytes(), Path::new("open.csv"), &Import { decimal, ..Import::default() });
        let error = read(None).unwrap_err().to_string();
        for words in ["open.csv:2: N = 5.000: ", "is ambiguous: 5 or 5000", "measured.decimal"] {
            assert!(error.contains(words), "{name}: {words} in {error}");
        }
        assert_eq!(read(Some(Decimal::Point)).unwrap().curves[0].cycles[1], 58.528, "{name}");
    }
    let read =
        |decimal| parse(open[0].1.as_bytes(), Path::new("open.csv"), &Import { decimal: Some(decimal), ..Import::default() });
    assert_eq!(read(Decimal::Comma).unwrap().curves[0].cycles[1], 58_528.0);
    // Kilocycles have three decimals as a matter of course.
    let kilo = open[1].1.replace("N;", "N (kcycles);");
    let curve = parse(kilo.as_bytes(), Path::new("kilo.csv"), &Import::default()).unwrap().curves.remove(0);
    assert_eq!(curve.cycles[1], 58_528.0);
}

#[test]
fn one_decimal_sign_holds_for_every_cell() {
    let broken = [
        ("another sign", "N;a [mm]\n0;10,5\n10;11.25\n20;12,5\n30;13,5\n40;14,5\n", "decimal"),
        ("groups of two", "N;a [mm]\n5.00.000;10,5\n60.00.000;11,5\n", "not a number"),
        ("a length", "N;a [mm]\n0.5;10,500\n10.5;11,500\n20.5;12,500\n30.5;13,500\n40.5;14,500\n", "is ambiguous: "),
    ];
    for (name, text, words) in broken {
        let error = parse(text.as_bytes(), Path::new("signs.csv"), &Import::default()).unwrap_err().to_string();
        assert!(error.contains(words) && error.contains("signs.csv:"), "{name}: {words} in {error}");
    }
}

#[test]
fn separators_and_headers_are_found_below_a_preamble() {
    let preamble = "Fatigue crack growth, ASTM E647\nSpecimen: CT-7, B 12.5, W 50.0\nOperator;J. Doe;Width, mm;50\n\n";
    let dresses = [
        ("the other sign in a name", table("Cycle\tLength, mm", "\t").replace('.', ",")),
        ("decimal commas in semicolons", table("Cycles;crack length, mm", ";").replace('.', ",")),
        ("a quoted name", table("cycles,\"crack length; mm\"", ",")),
        ("a quoted name with the separator", table("cycles,\"crack length, mm\"", ",")),
        ("bars", table("cycles|a (mm)", "|")),
        ("framed bars", table("cycles | a (mm)", " | ")),
        ("blanks", table("N a_mm", "  ")),
        ("one blank", table("N a_mm", " ")),
        (
            "columns of fixed width",
            format!("Cycle Count      Crack size (mm)\n{}", lines(|n, a| format!("{n:>10}       {a:>8.2}"))),
        ),
        ("a preamble", preamble.to_owned() + &table("Cycles;Crack length [mm]", ";")),
        ("a sign for the spreadsheet", "sep=;\n".to_owned() + &table("Cycles;Crack length [mm]", ";")),
        ("a row of units", table("Cycles;Crack length\n-;mm", ";")),
        ("a row of units in brackets", table("Cycles,Crack length\n(cycles),(mm)", ",")),
        ("a header in a comment", "# saved by a script\n".to_owned() + &table("# cycles a_mm", " ")),
        ("other comments", "% exported\n// twice\n".to_owned() + &table("cycles,a_mm", ",")),
        ("trailing separators", table("Cycles;Crack length [mm];;", ";").replace(".00\n", ".00;;\n").replace(".50\n", ".50;\n")),
        ("empty rows", table("Cycles;Crack length [mm]", ";") + ";\n;;\n\n"),
        (
            "a header over every block",
            table("Cycles,Crack length [mm]", ",").replace("153379", "Cycles,Crack length [mm]\n153379"),
        ),
        ("columns the other way round", format!("a [mm];N\n{}", lines(|n, a| format!("{a:.2};{n}")))),
        ("carriage returns", table("Cycles;Crack length [mm]", ";").replace('\n', "\r")),
    ];
    for (name, text) in &dresses {
        is_the_curve(name, text.as_bytes(), &Import::default());
    }
}

#[test]
fn encodings_of_spreadsheets_are_read() {
    let text = table("Zyklen;Ri\u{df}l\u{e4}nge (mm)", ";");
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
        is_the_curve(name, &bytes, &Import::default());
    }
    let error = parse(b"cycles,a_mm\n\x00\x01\x02\x03\x04\x05\x06,1\n", Path::new("x.csv"), &Import::default()).unwrap_err();
    assert!(error.to_string().contains("x.csv:2: is not text"), "{error}");
}

#[test]
fn names_of_laboratories_are_known() {
    let cycles = "cycles, N, n, Cycle, Cycle Count, Elapsed Cycles, Cycles [-], N (cycles), No. of cycles, Total Cycles, Cycle number, Axial Count, \
                  Axial Count (cycles), Lastwechsel, Zyklenzahl N, Nombre de cycles, Number of cycles N, Fatigue cycles";
    let lengths = "crack_length_mm, Crack size (mm), Length [mm], a (mm), a [mm], a_mm, a/mm, Crack Length (mm), Crack Length (a) [mm], \
                   crack length; mm, Risslaenge (mm), Average crack length (mm), a avg (mm), Visual Crack Length (mm), Crack Length a (mm), \
                   Longueur de fissure (mm), crack length in mm, A (mm), Mean crack length/mm";
    for cycles in cycles.split(", ") {
        is_the_curve(cycles, table(&format!("{cycles}|a (mm)"), "|").as_bytes(), &Import::default());
    }
    for length in lengths.split(", ").map(str::trim) {
        is_the_curve(length, table(&format!("N|{length}"), "|").as_bytes(), &Import::default());
    }
    let units = [
        ("N (kcycles)|a (mm)", 1e3, 1.0),
        ("N [x1000]|a (mm)", 1e3, 1.0),
        ("Cycles/1000|a (mm)", 1e3, 1.0),
        ("N (10\u{b3})|a (mm)", 1e3, 1.0),
        ("N x 10^3|a (mm)", 1e3, 1.0),
        ("kilocycles|a (mm)", 1e3, 1.0),
        ("Cycles (millions)|a (mm)", 1e6, 1.0),
        ("N (1e6)|a (mm)", 1e6, 1.0),
        ("N|a (in)", 1.0, 25.4),
        ("N|a, in.", 1.0, 25.4),
        ("N|a (inches)", 1.0, 25.4),
        ("N|a (\")", 1.0, 25.4),
        ("N|crack length [m]", 1.0, 1000.0),
        ("N|2a (mm)", 1.0, 0.5),
    ];
    for (header, per_cycle, per_mm) in units {
        let text = format!("{header}\n{}", lines(|n, a| format!("{}|{}", n / per_cycle, a / per_mm)));
        is_the_curve(header, text.as_bytes(), &Import::default());
    }
}

#[test]
fn columns_may_be_named_by_the_user() {
    let strange = format!("t;Zahl;Sonde [in];Kraft\n{}", lines(|n, a| format!("{};{n};{};7", n / 10.0, a / 25.4)));
    let names = |cycles: &str, length: &str| Import {
        columns: columns(&[&format!("cycles={cycles}"), &format!("length={length}")]),
        ..Import::default()
    };
    for (cycles, length) in [("Zahl", "Sonde [in]"), ("zahl", " SONDE  [in]"), ("2", "3")] {
        is_the_curve(length, strange.as_bytes(), &names(cycles, length));
    }
    let plain = Import { length: Some(LengthUnit::Millimetre), ..names("1", "2") };
    is_the_curve("no header", lines(|n, a| format!("{n},{a:.2}")).as_bytes(), &plain);
    // The user's word goes before that of the names.
    let both = format!("N,a (mm),a corrected (mm)\n{}", lines(|n, a| format!("{n},{},{a}", a + 1.0)));
    let error = parse(both.as_bytes(), Path::new("b.csv"), &Import::default()).unwrap_err().to_string();
    assert!(error.contains("duplicates an earlier column; select one by measured.columns = { length ="), "{error}");
    is_the_curve("the corrected one", both.as_bytes(), &names("N", "a corrected (mm)"));
    let error = parse(both.as_bytes(), Path::new("b.csv"), &names("N", "b")).unwrap_err().to_string();
    assert!(error.contains("measured.columns.length = b: is not a column of this file; its columns are N | a (mm)"), "{error}");
    let mut columns = columns(&["cycles=N"]);
    for (text, words) in
        [("N", "has no ="), ("depth=a", "has an unknown key"), ("cycles=M", "repeats a column"), ("length=", "has no column")]
    {
        let error = columns.put(text).unwrap_err().to_string();
        assert!(error.contains("--column = ") && error.contains(words), "{error}");
    }
}

#[test]
fn a_shape_that_is_not_known_is_shown_as_it_was_understood() {
    let text = "Probe A;;\nfoo;bar;Pmax (kN)\n1;2;3\n4;5;6\n7;8;9\n10;11;12\n13;14;15\n16;17;18\n";
    let error = parse(text.as_bytes(), Path::new("odd.csv"), &Import::default()).unwrap_err().to_string();
    for words in [
        "odd.csv:2: ",
        "columns separated by semicolons",
        "line 2: foo | bar | Pmax (kN)",
        "line 3: 1 | 2 | 3",
        "line 7: 13 | 14 | 15",
        "measured.columns = { cycles",
        "--column cycles=",
    ] {
        assert!(error.contains(words), "{words} in {error}");
    }
    assert!(!error.contains("line 8"), "{error}");
}

#[test]
fn a_wide_table_holds_lengths_alone() {
    let import = Import { length: Some(LengthUnit::Millimetre), ..Import::default() };
    let rows = "0;12.8;11.2;6\n10;13.3;11.7;6\n20;13.8;12.2;6\n30;14.3;12.7;6\n40;14.8;13.2;6\n";
    for other in ["Pmax", "Pmax (kN)", "K (MPa√m)", "COD (mm)", "Time (s)", "Temperature", "B", "W (mm)", "Load", "R", "da/dN"]
    {
        let text = format!("Cycles;S1;S2;{other}\n{rows}");
        let error = parse(text.as_bytes(), Path::new("wide.csv"), &import).unwrap_err().to_string();
        assert!(error.contains("wide.csv:1: header = S1") && error.contains("measured.columns"), "{other}: {error}");
        // Two sides are one specimen, and the other quantity is none.
        let text = format!("Cycles;Front;Back;{other}\n{rows}");
        let measured = parse(text.as_bytes(), Path::new("sides.csv"), &import).unwrap();
        assert_eq!(measured.curves.len(), 1, "{other}");
        assert!((measured.curves[0].crack_length[0] - 12.0 * MM).abs() < 1e-12, "{other}");
        assert!((measured.curves[0].side_difference[0] - 1.6 * MM).abs() < 1e-12, "{other}");
    }
    for sides in [
        "front;back",
        "a front (mm);a back (mm)",
        "Left;Right",
        "a_L;a_R",
        "Vorderseite;R\u{fc}ckseite",
        "Crack length (front);Crack length (back)",
    ] {
        let text = format!("N;{sides}\n0;12.8;11.2\n10;13.3;11.7\n20;13.8;12.2\n30;14.3;12.7\n40;14.8;13.2\n");
        let curves = parse(text.as_bytes(), Path::new("s.csv"), &import).unwrap().curves;
        assert_eq!(curves.len(), 1, "{sides}");
        assert!((curves[0].crack_length[4] - 14.0 * MM).abs() < 1e-12, "{sides}");
    }
    let named = Import { columns: columns(&["length=S1", "length=S2"]), ..import.clone() };
    let text = "Cycles;S1;S2\n0;12.8;11.2\n10;13.3;11.7\n20;13.8;12.2\n30;14.3;12.7\n40;14.8;13.2\n";
    assert_eq!(parse(text.as_bytes(), Path::new("w.csv"), &import).unwrap().curves.len(), 2);
    assert_eq!(parse(text.as_bytes(), Path::new("w.csv"), &named).unwrap().curves.len(), 1);
    let still = text.replace(";11.7", ";11.2").replace(";12.2", ";11.2").replace(";12.7", ";11.2").replace(";13.2", ";11.2");
    let error = parse(still.as_bytes(), Path::new("w.csv"), &import).unwrap_err().to_string();
    assert!(error.contains("specimen = S2: does not increase: not a crack length"), "{error}");
}

#[test]
fn specimens_of_a_wide_table_may_be_numbers() {
    let text = "crack_length_mm,1,2,3\n10,0,0,0\n11,100,110,90\n12,200,210,190\n13,300,310,290\n14,400,410,390\n";
    let curves = parse(text.as_bytes(), Path::new("w.csv"), &Import::default()).unwrap().curves;
    assert_eq!(curves.iter().map(|curve| curve.specimen.as_str()).collect::<Vec<_>>(), ["1", "2", "3"]);
    assert_eq!(curves[2].cycles[4], 390.0);
}

#[test]
fn tables_of_this_program_are_read() {
    let own = [
        "cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle",
        "cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,broken_bonds,load_work_j,tip1_x_mm,tip1_growth_mm",
    ];
    for header in own {
        let more = ",1".repeat(header.matches(',').count() - 1);
        is_the_curve(header, format!("{header}\n{}", lines(|n, a| format!("{n},{a}{more}"))).as_bytes(), &Import::default());
    }
    let rates = format!(
        "specimen,cycles,crack_length_mm,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,flags\n{}",
        lines(|n, a| format!("S1,{n},{a},,1e-5,step_under_0.25_mm"))
    );
    is_the_curve("rates", rates.as_bytes(), &Import::default());
    let with_ratio: String =
        rates.lines().map(|line| format!("{line},{}\n", if line.starts_with('s') { "stress_ratio" } else { "0.1" })).collect();
    is_the_curve("rates at a stress ratio", with_ratio.as_bytes(), &Import::default());
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
    let one = workbook(&[("Notes", notes.clone()), ("data", readings(0.0))]);
    is_the_curve("the only sheet of readings", &one, &Import::default());
    let two = workbook(&[("first", readings(1.0)), ("data", readings(0.0)), ("Notes", notes)]);
    let error = parse(&two, Path::new("two.xlsx"), &Import::default()).unwrap_err().to_string();
    assert!(error.contains("has 2 sheets of readings: \"first\", \"data\"; set measured.sheet"), "{error}");
    for sheet in ["data", "2"] {
        is_the_curve(sheet, &two, &Import { sheet: Some(Sheet(sheet.to_owned())), ..Import::default() });
    }
    let wrong = [
        ("no such sheet", two.clone(), Some("4"), "its sheets are 1 \"first\", 2 \"data\", 3 \"Notes\""),
        ("no workbook", b"PK\x03\x04 nothing of the kind".to_vec(), None, "is not an .xlsx workbook"),
        ("cut off", two[..two.len() / 2].to_vec(), None, "is not an .xlsx workbook"),
        ("a sheet of a text", table("N,a_mm", ",").into_bytes(), Some("data"), "is set for a file that is not a workbook"),
    ];
    for (name, bytes, sheet, words) in wrong {
        let import = Import { sheet: sheet.map(|name| Sheet(name.to_owned())), ..Import::default() };
        let error = parse(&bytes, Path::new("book"), &import).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{name}");
        assert!(error.to_string().contains(words), "{name}: {error}");
    }
}

#[test]
fn loads_are_read_in_every_unit() {
    let text = |header: &str, largest: f64, smallest: f64| {
        format!("N;a (mm);{header}\n{}", lines(|n, a| format!("{n};{a:.2};{largest};{smallest}")))
    };
    let newtons = [
        ("force_max_kn;force_min_kn", 6.0, 0.6),
        ("Maximum Axial Force (kN);Minimum Axial Force (kN)", 6.0, 0.6),
        ("Pmax [N];Pmin [N]", 6000.0, 600.0),
        ("Fmax, lbf;Fmin, lbf", 6000.0 / 4.448_221_615_260_5, 600.0 / 4.448_221_615_260_5),
        ("Max Load (kip);Min Load (kip)", 6.0 / 4.448_221_615_260_5, 0.6 / 4.448_221_615_260_5),
        ("peak load (kgf);valley load (kgf)", 6000.0 / 9.806_65, 600.0 / 9.806_65),
        ("Oberlast [kN];R", 6.0, 0.1),
        ("Pmax kN;stress ratio", 6.0, 0.1),
        ("Pmax kN;load range (kN)", 6.0, 5.4),
    ];
    for (header, largest, smallest) in newtons {
        let curve =
            parse(text(header, largest, smallest).as_bytes(), Path::new("l.csv"), &Import::default()).unwrap().curves.remove(0);
        let loads = curve.loads.unwrap_or_else(|| panic!("{header}"));
        assert!((loads.maximum[3] / 6000.0 - 1.0).abs() < 1e-9 && (loads.ratio[3] - 0.1).abs() < 1e-9, "{header}: {loads:?}");
    }
    let stress =
        parse(text("stress_max_mpa;stress_min_mpa", 60.0, 6.0).as_bytes(), Path::new("s.csv"), &Import::default()).unwrap();
    assert!((stress.curves[0].loads.as_ref().unwrap().maximum[0] / 60e6 - 1.0).abs() < 1e-12);
    for (header, range, other) in [("force_range_kn;R", 5.4, 0.1), ("\u{394}P (kN);Pmin (kN)", 5.4, 0.6)] {
        let loads =
            parse(text(header, range, other).as_bytes(), Path::new("r.csv"), &Import::default()).unwrap().curves.remove(0).loads;
        let loads = loads.unwrap_or_else(|| panic!("{header}"));
        assert!(
            loads.is_range && (loads.maximum[2] - 5400.0).abs() < 1e-6 && (loads.ratio[2] - 0.1).abs() < 1e-9,
            "{header}: {loads:?}"
        );
    }
    // Without a unit: no load where it does not change, a refusal where it does, and the user's word for both.
    let still = text("Pmax;Pmin", 6.0, 0.6);
    let measured = parse(still.as_bytes(), Path::new("p.csv"), &Import::default()).unwrap();
    assert!(measured.curves[0].loads.is_none() && measured.warnings[0].contains("Pmax ignored (unknown load unit)"));
    let changing = still.replace("14.75;6;", "14.75;7;");
    let error = parse(changing.as_bytes(), Path::new("p.csv"), &Import::default()).unwrap_err().to_string();
    assert!(error.contains("p.csv:7: Pmax = 7: is a varying load (from 6) in an unknown unit"), "{error}");
    let import = Import { load: Some(LoadUnit::Kilonewton), ..Import::default() };
    let loads = parse(changing.as_bytes(), Path::new("p.csv"), &import).unwrap().curves.remove(0).loads.unwrap();
    assert!((loads.maximum[5] - 7000.0).abs() < 1e-9);
    let broken = [
        ("compression alone", text("force_max_kn;force_min_kn", -1.0, -6.0), "force_max_kn = -1: is not above 0"),
        ("no range", text("force_max_kn;force_min_kn", 6.0, 6.0), "force_min_kn = 6: gives no load range"),
        ("stress and force", text("stress_max_mpa;force_min_kn", 6.0, 0.6), "is not the same quantity as stress_max_mpa"),
        ("two largest", text("Pmax (kN);Fmax (kN)", 6.0, 0.6), "duplicates an earlier column"),
    ];
    for (name, text, words) in broken {
        let error = parse(text.as_bytes(), Path::new("b.csv"), &Import::default()).unwrap_err().to_string();
        assert!(error.contains(words), "{name}: {error}");
    }
    let kilo = Import { cycles: Some(CycleUnit::Kilocycles), ..Import::default() };
    let error = parse(table("N (Mcycles);a (mm)", ";").as_bytes(), Path::new("c.csv"), &kilo).unwrap_err().to_string();
    assert!(error.contains("is in megacycles, but measured.cycle_unit says kilocycles"), "{error}");
}
