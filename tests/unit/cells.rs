//! Text in CSV files that spreadsheets open, and tables that would become too large.

use std::io::Write as _;
use std::path::Path;
use std::time::Instant;

use perilife_base::cells::{CELLS_MAX, ROWS_MAX, UNPACKED_MAX, defused, field, restored};
use perilife_measured::{Import, parse, survey};
use perilife_tables::Column;
use perilife_tables::{csv, frame};

use crate::support::workbook::workbook;

#[test]
fn no_text_is_a_formula_and_all_of_it_comes_back() {
    let formulas =
        ["=1+1", "+cmd", "-2+3", "@SUM(A1)", "\t=1", "\r=1", "'=1", "''@x", "-", "+inf", "-nan", "=HYPERLINK(\"x\",\"y\")"];
    for text in formulas {
        assert!(defused(text).starts_with('\''), "{text}");
        assert_eq!(restored(&defused(text)), text);
    }
    for text in ["", "S1", "-5.3", "+1e3", "'quoted'", "a=b", "1-2", "Ti-6Al", "'"] {
        assert_eq!(defused(text), text);
        assert_eq!(restored(text), text);
    }
    assert_eq!(field("=a,b"), "\"'=a,b\"");
    assert_eq!(field("a\"b"), "\"a\"\"b\"");
}

/// Names that begin like formulas, through every writer of tables whose reader is the importer.
#[test]
fn names_of_specimens_go_through_tables() {
    let names = ["=2+2", "+A", "-B", "@C", "'=D", "E"];
    let rows = |name: &str| (0..5).map(|i| format!("{},{},{}\n", field(name), 1000 * i, 10 + i)).collect::<String>();
    let written = format!("specimen,cycles,crack_length_mm\n{}", names.map(rows).concat());
    let of_cells = |name: &str, index: usize| (0..5).map(|_| name.to_owned()).nth(index).unwrap();
    let column: Vec<String> = names.iter().flat_map(|name| (0..5).map(|i| of_cells(name, i))).collect();
    let numbers = |name: &str, of: fn(usize) -> f64| Column::new(name.into(), (0..5 * names.len()).map(of).collect::<Vec<f64>>());
    let table = frame(vec![
        Column::new("specimen".into(), column),
        numbers("cycles", |i| 1000.0 * (i % 5) as f64),
        numbers("crack_length_mm", |i| 10.0 + (i % 5) as f64),
    ])
    .unwrap();
    let files = [("a.csv", written.into_bytes()), ("b.csv", csv(&table).unwrap())];
    for (file, bytes) in files {
        let text = String::from_utf8_lossy(&bytes);
        let has_formula = text.lines().any(|line| line.starts_with(['=', '+', '-', '@']));
        assert!(!has_formula, "{file}: {text}");
        let curves = parse(&bytes, Path::new(file), &Import::default()).unwrap().curves;
        assert_eq!(curves.iter().map(|curve| curve.specimen.as_str()).collect::<Vec<_>>(), names, "{file}");
    }
}

/// Small files that would become gigabytes: each is refused by name, with its figure and the limit.
#[test]
fn tables_that_become_too_large_are_refused() {
    refused(vec![
        ("many.parquet", b"PAR1 nothing PAR1".to_vec(), "is a Parquet file".to_owned()),
        ("lines.csv", format!("{HEAD}{}", "1\n".repeat(ROWS_MAX)).into_bytes(), format!("lines, limit {ROWS_MAX}")),
        (
            "claim.xlsx",
            with_texts("<sst uniqueCount=\"99999999999999\"><si><t>a</t></si></sst>", 1, 0),
            "99999999999999 texts".to_owned(),
        ),
        (
            "texts.xlsx",
            with_texts(&format!("<sst><si><t>{}</t></si></sst>", "x".repeat(1 << 20)), 300, 0),
            "bytes of text".to_owned(),
        ),
        ("columns.xlsx", with_texts("<sst><si><t>a</t></si></sst>", 2500, 4095), format!("cells, limit {CELLS_MAX}")),
        ("zeros.xlsx", unpacking(UNPACKED_MAX + 1), format!("unpacks to more than {UNPACKED_MAX} bytes")),
    ]);
}

#[test]
#[ignore = "long: half a minute; cargo test cells -- --ignored --nocapture"]
fn a_line_of_too_many_commas_is_refused() {
    let commas = format!("{HEAD}{}", ",".repeat(CELLS_MAX)).into_bytes();
    refused(vec![("commas.csv", commas, format!("cells, limit {CELLS_MAX}"))]);
}

const HEAD: &str = "specimen,cycles,crack_length_mm\n";

/// Files by name, and the words with which each is refused.
fn refused(files: Vec<(&str, Vec<u8>, String)>) {
    for (name, bytes, words) in files {
        let started = Instant::now();
        let error = parse(&bytes, Path::new(name), &Import::default()).map(|measured| measured.curves.len()).unwrap_err();
        println!("{name}: {} bytes, {:.2} s: {error}", bytes.len(), started.elapsed().as_secs_f64());
        assert_eq!(error.exit_code(), 2, "{name}");
        let said = error.to_string();
        assert!(said.contains(name) && said.contains(&words), "{words} in {said}");
        let found = survey(&bytes, Path::new(name), &Import::default());
        assert_eq!(found.problems.len(), 1, "{name}: {:?}", found.problems);
    }
}

/// A workbook whose shared texts are these, with so many rows of one cell each at this column that is the first text.
fn with_texts(texts: &str, rows: usize, column: usize) -> Vec<u8> {
    let plain = workbook(&[("data", vec![vec!["1".to_owned()]])]);
    let mut letters = String::new();
    let mut left = column + 1;
    while left > 0 {
        letters.insert(0, char::from(b'A' + ((left - 1) % 26) as u8));
        left = (left - 1) / 26;
    }
    let row = |row: usize| format!("<row r=\"{row}\"><c r=\"{letters}{row}\" t=\"s\"><v>0</v></c></row>");
    let rows: String = (1..=rows).map(row).collect();
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let sheet = format!("<worksheet xmlns=\"{main}\"><sheetData>{rows}</sheetData></worksheet>");
    rezipped(&plain, &[("xl/sharedStrings.xml", texts.as_bytes()), ("xl/worksheets/sheet1.xml", sheet.as_bytes())])
}

/// A workbook with a part of so many zeros beside the others.
fn unpacking(bytes: u64) -> Vec<u8> {
    let plain = workbook(&[("data", vec![vec!["1".to_owned()]])]);
    rezipped(&plain, &[("xl/media/zeros.bin", &vec![0; bytes as usize])])
}

/// A zip file with some parts put in or replaced, packed.
fn rezipped(plain: &[u8], parts: &[(&str, &[u8])]) -> Vec<u8> {
    let mut old = zip::ZipArchive::new(std::io::Cursor::new(plain)).unwrap();
    let mut new = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = zip::write::SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    for index in 0..old.len() {
        let mut part = old.by_index(index).unwrap();
        let name = part.name().unwrap().into_owned();
        if parts.iter().all(|(other, _)| *other != name) {
            new.start_file(name, options).unwrap();
            std::io::copy(&mut part, &mut new).unwrap();
        }
    }
    for (name, bytes) in parts {
        new.start_file(*name, options).unwrap();
        new.write_all(bytes).unwrap();
    }
    new.finish().unwrap().into_inner()
}
