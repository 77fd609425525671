//! Workbooks (`.xlsx`) for tests.

use std::io::Write as _;

/// A workbook of one or more sheets; numbers as such, everything else as text.
pub fn workbook(sheets: &[(&str, Vec<Vec<String>>)]) -> Vec<u8> {
    workbook_hiding(sheets, &[], "")
}

/// The same with hidden rows, counted from 1, and its element `cols`.
pub fn workbook_hiding(sheets: &[(&str, Vec<Vec<String>>)], hidden: &[usize], columns: &str) -> Vec<u8> {
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let mut put = |name: &str, text: String| {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    };
    let each = |of: &dyn Fn(usize, &str) -> String| -> String {
        sheets.iter().enumerate().map(|(i, (name, _))| of(i + 1, name)).collect()
    };
    let head = "<?xml version=\"1.0\" encoding=\"UTF-8\"?>";
    let main = "http://schemas.openxmlformats.org/spreadsheetml/2006/main";
    let relations = "http://schemas.openxmlformats.org/officeDocument/2006/relationships";
    put(
        "[Content_Types].xml",
        format!(
            "{head}<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\"><Default Extension=\"xml\" ContentType=\"application/xml\"/></Types>"
        ),
    );
    put(
        "_rels/.rels",
        format!(
            "{head}<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\"><Relationship Id=\"rId1\" Type=\"{relations}/officeDocument\" Target=\"xl/workbook.xml\"/></Relationships>"
        ),
    );
    put(
        "xl/workbook.xml",
        format!(
            "{head}<workbook xmlns=\"{main}\" xmlns:r=\"{relations}\"><sheets>{}</sheets></workbook>",
            each(&|i, name| format!("<sheet name=\"{name}\" sheetId=\"{i}\" r:id=\"rId{i}\"/>"))
        ),
    );
    put(
        "xl/_rels/workbook.xml.rels",
        format!(
            "{head}<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">{}</Relationships>",
            each(&|i, _| format!(
                "<Relationship Id=\"rId{i}\" Type=\"{relations}/worksheet\" Target=\"worksheets/sheet{i}.xml\"/>"
            ))
        ),
    );
    for (i, (_, rows)) in sheets.iter().enumerate() {
        let cell = |row: usize, column: usize, text: &str| {
            let place = format!("{}{}", char::from(b'A' + column as u8), row + 1);
            match text.parse::<f64>() {
                Ok(_) => format!("<c r=\"{place}\"><v>{text}</v></c>"),
                Err(_) => format!("<c r=\"{place}\" t=\"inlineStr\"><is><t>{text}</t></is></c>"),
            }
        };
        let row = |(row, cells): (usize, &Vec<String>)| {
            let cells: String = cells.iter().enumerate().map(|(column, text)| cell(row, column, text)).collect();
            let attribute = if hidden.contains(&(row + 1)) { " hidden=\"1\"" } else { "" };
            format!("<row r=\"{}\"{attribute}>{cells}</row>", row + 1)
        };
        let rows: String = rows.iter().enumerate().map(row).collect();
        put(
            &format!("xl/worksheets/sheet{}.xml", i + 1),
            format!("{head}<worksheet xmlns=\"{main}\">{columns}<sheetData>{rows}</sheetData></worksheet>"),
        );
    }
    zip.finish().unwrap().into_inner()
}
