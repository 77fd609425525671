//! What the lines above a table say of its test: read where it is certain, by the words of laboratories.

use std::path::Path;

use perilife_calibration::preamble::{Preamble, StatedMaterial};
use perilife_measured::{Import, survey};

use crate::support::lab::table;

#[test]
fn dimensions_above_a_table_are_read_where_they_are_certain() {
    let (ct, mt) = (Some("compact_tension"), Some("middle_tension"));
    for (above, kind, numbers) in [
        // Units behind the number, before it, and in cells of their own; quotation marks; names in both languages.
        ("W = 50 mm\nB: 6.35mm\nR = 0.1", None, [Some(50.0), Some(6.35), Some(0.1)]),
        ("W = 50,8 mm B = 2 in. R=0,5", None, [Some(50.8), Some(50.8), Some(0.5)]),
        ("Width (mm): 50\nThickness mm: 6,35\nR-ratio;-1", None, [Some(50.0), Some(6.35), Some(-1.0)]),
        ("\"W [in]\";\"2\"\n\"B\";\"10\";\"mm\"\n\"Stress ratio\";\"0,1\"", None, [Some(50.8), Some(10.0), Some(0.1)]),
        ("Breite (mm);50,0\nProbendicke: 5 mm\nSpannungsverhältnis = 0,1", None, [Some(50.0), Some(5.0), Some(0.1)]),
        ("Specimen width W = 50 mm (nominal)\nSpecimen thickness: B = 5 mm", None, [Some(50.0), Some(5.0), None]),
        ("Load ratio R: 0.1, Constant amplitude R = 0.1", None, [None, None, Some(0.1)]),
        ("Panel 7 W = 2 inches a0 = 5 mm f = 10 Hz", None, [Some(50.8), None, None]),
        ("W = 50 mm\nWidth: 5.0e1\nwidth = 50.0 mm", None, [Some(50.0), None, None]),
        // No unit, a comma that may be one between thousands, two values, other quantities of the same letters.
        ("W = 50\nB: 1,250 mm\nR = 3 mm", None, [None, None, None]),
        ("W = 50 mm\nW = 60 mm\nR = 0.1 and 0.5\nB = 5 to 6 mm", None, [None, None, None]),
        ("Notch width W = 1 mm\nNotch radius R = 0.1\nWidth of the slot: 1 mm\nR = 1.5", None, [None, None, None]),
        ("W = -50 mm\nB = thick\nR = 0.5 cm", None, [None, None, None]),
        ("C(T) specimen W = 50 mm", ct, [Some(50.0), None, None]),
        ("Specimen: CT-12", ct, [None; 3]),
        ("Probenform;C (T)", ct, [None; 3]),
        ("Type: compact tension", ct, [None; 3]),
        ("M-T panel of 2024-T3 plate", mt, [None; 3]),
        ("middle tension, M(T)", mt, [None; 3]),
        ("SE(B)", Some("single_edge_bend"), [None; 3]),
        ("ESE(T), eccentric single edge tension", Some("eccentric_single_edge_tension"), [None; 3]),
        ("CTOD of plate, 23 C T-L, CT12, surface crack length", None, [None; 3]),
        ("C(T) and M(T)", None, [None; 3]),
    ] {
        let said = preamble(above);
        assert_eq!((said.kind, [said.width_mm, said.thickness_mm, said.stress_ratio]), (kind, numbers), "{above}");
    }
    // A description without end is not one of a test.
    let long = format!("# R = 0.1 {}\n# {}\n# W = 50 mm", "W = 5 mm ".repeat(100_000), "word ".repeat(1_000_000));
    assert_eq!((preamble(&long).stress_ratio, preamble(&long).width_mm), (None, Some(50.0)));
    // Words between blanks are words, not cells.
    let text = "Material: EN AW-2024 T3\nW = 50 mm B = 5 mm\nStress ratio = 0.1\nN a_mm\n0 9\n1 9.5\n2 10\n3 11\n4 12\n";
    let said = Preamble::of(&survey(text.as_bytes(), Path::new("lab.txt"), &Import::default()));
    assert_eq!((said.width_mm, said.thickness_mm, said.stress_ratio), (Some(50.0), Some(5.0), Some(0.1)));
    assert_eq!(said.material.and_then(|material| material.name).as_deref(), Some("al2024-t3"));
}

#[test]
fn a_material_above_a_table_is_one_of_the_library_by_alloy_and_orientation() {
    for (above, stated, name, orientation) in [
        ("Material: 2024-T3", "2024-T3", "al2024-t3", ""),
        ("Werkstoff: EN AW-2024 T3\nRissebene: T-L", "EN AW-2024 T3", "al2024-t3-clad-tl", ""),
        ("Alloy AA2024-T3, L T\nOrientation: L T", "AA2024-T3", "al2024-t3-clad-lt", ""),
        ("Material;\"AA 7075-T651\"\nProbenlage;TL", "AA 7075-T651", "al7075-t651-sheet-lt", "T-L"),
        ("Werkstoff;7075-T651", "7075-T651", "al7075-t651-sheet-lt", ""),
        ("Material name: AL2024-T3-Clad-TL", "AL2024-T3-Clad-TL", "al2024-t3-clad-tl", ""),
        ("Material no.: steel-4340\nMaterial properties: see 2", "steel-4340", "steel-4340", ""),
        ("Specimen 5 alloy 15-5PH H900\nCrack plane = C-R", "15-5PH H900", "steel-15-5ph-h900-sheet-cr", ""),
        ("Legierung: Ti-6Al-4V MA", "Ti-6Al-4V MA", "ti-6al-4v-ma-plate-lt", ""),
        ("Titanium Ti-6Al-4V, annealed", "Ti-6Al-4V", "ti-6al-4v", ""),
        ("Sheet of aluminum 2024-T3, C(T)", "2024-T3", "al2024-t3", ""),
        ("Stahl 4340", "", "", ""),
        ("Material: AISI 4340", "AISI 4340", "steel-4340", ""),
        ("Material: AISI 4340H", "AISI 4340H", "", ""),
        // Not the one that a longer designation begins with; several; none.
        ("Material: 2024-T352", "2024-T352", "", ""),
        ("Material: 2024-T3-51", "2024-T3-51", "", ""),
        ("Material: 7075-T6\nOrientation: L-T", "7075-T6", "", ""),
        ("2024-T3 on 7075-T6", "2024-T3, 7075-T6", "", ""),
        ("Material: 2024-T3\nMaterial: 7075-T651", "2024-T3, 7075-T651", "", ""),
        ("Material;Inconel 718", "Inconel 718", "", ""),
        ("Material Inconel\nPart 12024-T3, X2024-T3, 1.2024-T3", "", "", ""),
    ] {
        let text = |words: &str| Some(words.to_owned()).filter(|words| !words.is_empty());
        let material = |stated| StatedMaterial { stated, name: text(name), orientation: text(orientation) };
        assert_eq!(preamble(above).material, text(stated).map(material), "{above}");
    }
}

fn preamble(above: &str) -> Preamble {
    let text = format!("{above}\n{}", table("N;a (mm)", "{n};{a}"));
    Preamble::of(&survey(text.as_bytes(), Path::new("lab.csv"), &Import::default()))
}
