//! Plates from drawings: DXF says what the keys of a case say; what is no plate is refused by layer and place.

use std::fmt::Write as _;

use perilife_base::error::Result;
use perilife_base::input::Folder;
use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_growth::predict::tip_factors::{StressIntensityMethod, stress_intensity};
use perilife_growth::stress_concentration::stressed;
use perilife_plate::specimen::{Edge, Specimen};

use crate::support::rows::{assert_says, rows};

const REST: &str = "thickness_mm = 2.0\n[material]\nyoungs_modulus_gpa = 72\npoisson_ratio = 0.3\n[loading]\nstress_max_mpa = 70\n\
                    stress_ratio = 0.1\n[fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3.0\n";

/// The case of keys of `[specimen]` with files at hand.
fn try_case(keys: &str, files: &[(&str, &str)]) -> Result<Case> {
    let files = files.iter().map(|(name, text)| ((*name).to_owned(), text.as_bytes().to_vec()));
    Case::from_toml(&format!("[specimen]\nkind = \"plate\"\n{keys}\n{REST}"), "drawn", Folder::at_hand(files), &[])
}

pub(super) fn plate(keys: &str, files: &[(&str, &str)]) -> Specimen {
    try_case(keys, files).unwrap_or_else(|error| panic!("{keys} {files:?}: {error}")).specimen
}

/// An ASCII DXF of entities `kind layer code value code value ...`, with `$INSUNITS`.
pub(super) fn dxf(unit: u8, entities: &[&str]) -> String {
    let mut text = format!("0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
    for entity in entities {
        let mut words = entity.split_whitespace();
        let _ = writeln!(text, "0\n{}\n8\n{}", words.next().unwrap(), words.next().unwrap());
        words.for_each(|word| writeln!(text, "{word}").unwrap());
    }
    text + "0\nENDSEC\n0\nEOF\n"
}

pub(super) fn line(layer: &str, [a, b]: [[f64; 2]; 2]) -> String {
    format!("LINE {layer} 10 {} 20 {} 11 {} 21 {}", a[0], a[1], b[0], b[1])
}

/// The sides of a polygon as lines, each other one drawn backwards.
fn sides(corners: &[[f64; 2]]) -> Vec<String> {
    let side = |i: usize| [corners[i], corners[(i + 1) % corners.len()]];
    (0..corners.len()).map(|i| line("outline", if i % 2 == 0 { side(i) } else { [side(i)[1], side(i)[0]] })).collect()
}

pub(super) const RECTANGLE: &str = "LWPOLYLINE outline 90 4 70 1 10 -50 20 -100 10 50 20 -100 10 50 20 100 10 -50 20 100";
const HOLE: &str = "CIRCLE holes 10 0 20 0 40 10";
const CRACK: &str = "LINE cracks 10 5 20 0 11 22 21 0";
const KEYS: &str = "width_mm = 100\nlength_mm = 200\nholes = [{ x_mm = 0, y_mm = 0, diameter_mm = 20 }]\n\
                    cracks = [{ from_mm = [5, 0], to_mm = [22, 0] }]";
pub(super) const DXF: &str = "outline_file = \"part.dxf\"";
/// One plate by its keys and by drawings of every kind of line: the same shape, and the same K.
#[test]
fn a_drawing_is_the_plate_of_the_keys() {
    let by_keys = plate(KEYS, &[]);
    let inch = |text: &str| -> String {
        let scaled = text.split(' ').enumerate().map(|(i, word)| match word.parse::<f64>() {
            // Values stand behind their codes; 70 and 90 are no lengths.
            Ok(value) if i >= 2 && i % 2 == 1 && !["70", "90"].contains(&text.split(' ').nth(i - 1).unwrap()) => {
                (value / 25.4).to_string()
            }
            _ => word.to_owned(),
        });
        scaled.collect::<Vec<_>>().join(" ")
    };
    let corners = [[-50.0, -100.0], [50.0, -100.0], [50.0, 100.0], [-50.0, 100.0]];
    let of_lines = [
        sides(&corners),
        vec!["ARC holes 10 0 20 0 40 10 50 0 51 180".into(), "ARC holes 10 0 20 0 40 10 50 180 51 360".into()],
        vec![line("cracks", [[14.0, 0.0], [5.0, 0.0]]), line("cracks", [[14.0, 0.0], [22.0, 0.0]])],
    ]
    .concat();
    let of_lines: Vec<&str> = of_lines.iter().map(String::as_str).collect();
    let polyline = [
        "POLYLINE outline 70 1",
        "VERTEX outline 10 -50 20 -100",
        "VERTEX outline 10 50 20 -100",
        "VERTEX outline 10 50 20 100",
        "VERTEX outline 10 -50 20 100",
        "SEQEND outline",
        "LWPOLYLINE holes 70 1 10 -10 20 0 42 1 10 10 20 0 42 1",
        CRACK,
    ];
    let half = [
        "LWPOLYLINE outline 70 0 10 -50 20 0 10 -50 20 -100 10 50 20 -100 10 50 20 0",
        "ARC holes 10 0 20 0 40 10 50 180 51 360",
        CRACK,
    ];
    let closed_half = ["LWPOLYLINE outline 70 1 10 -50 20 0 10 -50 20 -100 10 50 20 -100 10 50 20 0", HOLE, CRACK];
    let drawings = [
        (DXF.to_owned(), dxf(4, &[RECTANGLE, HOLE, CRACK])),
        (DXF.to_owned(), dxf(1, &[&inch(RECTANGLE), &inch(HOLE), &inch(CRACK)])),
        (format!("{DXF}\noutline_unit = \"mm\""), dxf(0, &of_lines)),
        (DXF.to_owned(), dxf(4, &polyline)),
        // R12 writes capitals.
        (DXF.to_owned(), dxf(4, &polyline).replace("outline", "OUTLINE").replace("holes", "Holes").replace("cracks", "CRACKS")),
        (format!("{DXF}\noutline_symmetry = \"y=0\""), dxf(4, &half)),
        (format!("{DXF}\noutline_symmetry = \"y=0\""), dxf(4, &closed_half)),
    ];
    for (keys, text) in &drawings {
        let drawn = plate(keys, &[("part.dxf", text.as_str())]);
        let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12;
        assert_eq!((drawn.outline.len(), drawn.holes.len(), drawn.cracks.len()), (4, 1, 1), "{keys}: {drawn:?}");
        assert!(
            by_keys.outline.iter().all(|at| drawn.outline.iter().any(|drawn| near(*drawn, *at))),
            "{keys}: {:?}",
            drawn.outline
        );
        assert!(near(drawn.holes[0].centre, [0.0; 2]), "{keys}: {:?}", drawn.holes);
        assert!((drawn.holes[0].radius - 10.0 * MM).abs() < 1e-12, "{keys}: {:?}", drawn.holes);
        assert!(near(drawn.tips[0].position, by_keys.tips[0].position) && drawn.tips.len() == 1, "{keys}: {:?}", drawn.tips);
    }
    let k = |case: &Case| {
        stress_intensity(case, &[StressIntensityMethod::ElementFreeGalerkin]).unwrap()[0].methods[0].intensity.k_i.unwrap()
    };
    let [drawn, keys] = [(DXF, vec![("part.dxf", drawings[0].1.as_str())]), (KEYS, vec![])]
        .map(|(keys, files)| k(&try_case(keys, &files).unwrap()));
    assert!((drawn / keys - 1.0).abs() < 1e-9, "{drawn} {keys}");
}

/// Shoulder fillet of a flat bar, t/r = 2, 2t/D = 0.5: K_tn = 1.852 by the fit of Pilkey (Peterson's Stress Concentration Factors 1997,
/// chart 3.1); the same outline given by keys: 1.865.
#[test]
#[ignore = "long: 18 s, four solves up to 39 431 nodes"]
fn a_drawn_fillet_concentrates_stress_as_in_the_charts() {
    let (d, t, r, l) = (40.0, 20.0, 10.0, 80.0);
    let quarter = [
        line("outline", [[0.0, 2.0 * l], [0.5 * d, 2.0 * l]]),
        line("outline", [[0.5 * d, 2.0 * l], [0.5 * d, l + r]]),
        format!("ARC outline 10 {} 20 {} 40 {r} 50 180 51 270", 0.5 * d + r, l + r),
        line("outline", [[0.5 * d + r, l], [0.5 * d + t, l]]),
        line("outline", [[0.5 * d + t, l], [0.5 * d + t, 0.0]]),
        line("outline", [[0.5 * d + t, 0.0], [0.0, 0.0]]),
    ];
    let text = dxf(4, &quarter.iter().map(String::as_str).collect::<Vec<_>>());
    let keys = format!("{DXF}\noutline_symmetry = \"x=0\"");
    let text_of_case = format!("[specimen]\nkind = \"plate\"\n{keys}\n{REST}")
        .replace("stress_ratio", "edges = [\"top\"]\nstress_ratio")
        + "[supports]\nbottom = { fix = [\"y\"] }\n";
    let folder = Folder::at_hand([("part.dxf".to_owned(), text.into_bytes())]);
    let document = perilife_base::input::Document::parse(&text_of_case, "fillet", folder, &[]).unwrap();
    let case = Case::plate_on_nodes(&document).unwrap();
    let found = stressed(&case).unwrap();
    let peak = found.rims.iter().map(|rim| rim.largest).max_by(|a, b| a.stress.total_cmp(&b.stress)).unwrap();
    let factor = peak.stress / case.loading.maximum;
    // C1 + C2 (2t/D) + C3 (2t/D)² + C4 (2t/D)³ for 2.0 ≤ t/r ≤ 20.
    let h = t / r;
    let x = 2.0 * t / (d + 2.0 * t);
    let c = [
        1.020 + 1.009 * f64::sqrt(h) - 0.048 * h,
        -0.065 - 0.165 * f64::sqrt(h) - 0.007 * h,
        -3.459 + 1.266 * f64::sqrt(h) - 0.016 * h,
        3.505 - 2.109 * f64::sqrt(h) + 0.069 * h,
    ];
    let chart = c.iter().rev().fold(0.0, |sum, c| sum * x + c);
    println!("fillet: {factor:.3} at {:?}, chart {chart:.3}, change {:?}", peak.at, found.change);
    assert!((factor / chart - 1.0).abs() < 0.02, "{factor} for {chart}");
}

#[test]
fn what_is_no_plate_is_refused_by_layer_and_place() {
    for (unit, entities, words) in rows::<Vec<(u8, Vec<String>, Vec<String>)>>("drawings", "no_plate") {
        let named = |entity: &String| if entity == "RECTANGLE" { RECTANGLE.to_owned() } else { entity.replace("HOLE", HOLE) };
        let entities: Vec<String> = entities.iter().map(named).collect();
        refused(DXF, ("part.dxf", &dxf(unit, &entities.iter().map(String::as_str).collect::<Vec<_>>())), &words);
    }
    let table = |name: &str, flags: u8, colour: i8| {
        let layers = format!("0\nLAYER\n2\noutline\n70\n0\n62\n7\n0\nLAYER\n2\n{name}\n70\n{flags}\n62\n{colour}\n");
        let tables =
            format!("0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n70\n2\n{layers}0\nENDTAB\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n");
        dxf(4, &[RECTANGLE, HOLE, CRACK]).replace("0\nSECTION\n2\nENTITIES\n", &tables)
    };
    for (name, flags, colour, why) in [("HOLES", 1, 7, "frozen"), ("holes", 0, -7, "switched off")] {
        refused(DXF, ("part.dxf", &table(name, flags, colour)), &["layer holes", "CIRCLE at (0, 0)", why, "show it"]);
    }
    for (name, flags) in [("holes", 0), ("frame", 1), ("holes", 4)] {
        assert_eq!(plate(DXF, &[("part.dxf", &table(name, flags, 7))]).holes.len(), 1);
    }
    let good = dxf(4, &[RECTANGLE, HOLE, CRACK]);
    for (keys, name, text, words) in rows::<Vec<(String, String, String, Vec<String>)>>("drawings", "no_keys") {
        refused(&keys, (&name, if text == "GOOD" { &good } else { &text }), &words);
    }
    refused(DXF, ("other.dxf", good.as_str()), &["part.dxf", "was not uploaded"]);
}

/// Gaps and overlaps of a hundredth of a millimetre, along sides, across them and at an arc, leave level and upright what was drawn so.
#[test]
fn gaps_that_are_closed_tilt_no_side() {
    let slip = 0.01;
    let sides = [
        line("outline", [[-40.0, -100.0], [50.0, -100.0]]),
        line("outline", [[50.0 + slip, -100.0], [50.0 + slip, 100.0 - slip]]),
        line("outline", [[50.0, 100.0], [-40.0, 100.0]]),
        format!("ARC outline 10 -40 20 {} 40 10 50 90 51 180", 90.0 - slip),
        line("outline", [[-50.0 - slip, 90.0], [-50.0 - slip, -90.0]]),
        format!("ARC outline 10 -40 20 {} 40 10 50 180 51 270", slip - 90.0),
    ];
    for turn in 0..sides.len() {
        let turned = (0..sides.len()).map(|side| sides[(side + turn) % sides.len()].as_str());
        let turned: Vec<&str> = turned.chain([CRACK]).collect();
        let plate = plate(DXF, &[("part.dxf", &dxf(4, &turned))]);
        for (edge, length) in [(Edge::Top, 90.0), (Edge::Bottom, 90.0), (Edge::Right, 200.0), (Edge::Left, 180.0)] {
            let [(from, to)] = edge.stretches(&plate)[..] else { panic!("{turn} {edge}: {:?}", plate.outline) };
            let found = (to[0] - from[0]).hypot(to[1] - from[1]) / MM;
            assert!((found - length).abs() < 0.03, "{turn} {edge}: {found} of {length}");
        }
    }
}

/// What programs write is understood as it is meant: round-off of sides and ends, flaws in large panels, cracks from arcs, units of print.
#[test]
fn what_programs_leave_in_a_drawing_changes_no_plate() {
    let of = |entities: &[&str]| plate(DXF, &[("part.dxf", &dxf(4, entities))]);
    // A step of round-off in a side; sides that are not quite as long as their opposites.
    let stepped = |step: f64| {
        format!(
            "LWPOLYLINE outline 70 1 10 -50 20 -100 10 50 20 -100 10 50 20 {0} 10 0 20 {0} 10 0 20 100 10 -50 20 100",
            100.0 + step
        )
    };
    let top =
        |plate: &Specimen| -> f64 { Edge::Top.stretches(plate).iter().map(|(from, to)| (to[0] - from[0]).abs() / MM).sum() };
    for step in [0.0, 1e-7, 1e-5, -1e-5, 1e-4] {
        assert!((top(&of(&[&stepped(step), CRACK])) - 100.0).abs() < 1e-6, "{step}");
    }
    refused(
        DXF,
        ("part.dxf", &dxf(4, &[&stepped(0.01), CRACK])),
        &["loading.edges", "top", "has a step", "(0.0000, 100.0000) mm"],
    );
    // A step that is meant: the side is what lies on the bounding box.
    refused(DXF, ("part.dxf", &dxf(4, &[&stepped(0.05), CRACK])), &["loading.edges", "not in equilibrium"]);
    let tilted = "LWPOLYLINE outline 70 1 10 -50 20 -100 10 50.0004 20 -100 10 50 20 100 10 -50 20 100.000004";
    assert_eq!(top(&of(&[tilted, CRACK])), 100.0);

    // Flaws, and cracks that nearly meet, in a panel of 2 m.
    let panel = "LWPOLYLINE outline 70 1 10 -400 20 -1000 10 400 20 -1000 10 400 20 1000 10 -400 20 1000";
    let flaw = of(&[panel, "CIRCLE holes 10 50 20 0 40 2.5", "LINE cracks 10 52.5 20 0 11 52.627 21 0"]);
    assert!(flaw.tips.len() == 1 && (flaw.crack_length / MM - 0.127).abs() < 1e-9, "{}", flaw.crack_length);
    let two = of(&[panel, "LINE cracks 10 -20 20 0 11 -0.08 21 0", "LINE cracks 10 0.08 20 0 11 20 21 0"]);
    assert_eq!(two.tips.len(), 4);
    // Two cracks drawn from the middle of a hole.
    let at_hole = of(&[RECTANGLE, HOLE, "LINE cracks 10 0 20 0 11 22 21 0", "LINE cracks 10 0 20 0 11 -25 21 0"]);
    assert!(at_hole.tips.len() == 2 && (at_hole.crack_length / MM - 27.0).abs() < 1e-9, "{}", at_hole.crack_length);
    let one = of(&[panel, "LINE cracks 10 -20 20 0 11 -0.0004 21 0", "LINE cracks 10 0 20 0 11 20 21 0"]);
    assert_eq!(one.tips.len(), 2);

    // Cracks of 1 mm on the concave sides, of radius 260 mm, of a waist: from the arc itself, and drawn from outside of it.
    let waist = "LWPOLYLINE outline 70 1 10 -40 20 -100 10 40 20 -100 42 -0.2 10 40 20 100 10 -40 20 100 42 -0.2";
    for height in [0.0, 1.0, 3.0, 7.0_f64] {
        let arc = 280.0 - (260.0 * 260.0 - height * height).sqrt();
        for from in [arc, arc + 4.0] {
            let crack = format!("LINE cracks 10 -{from} 20 {height} 11 -{} 21 {height}", arc - 1.0);
            let plate = of(&[waist, &crack]);
            let length = plate.crack_length / MM;
            assert!(plate.tips.len() == 1, "{height} from {from}: {} tips, {length} mm", plate.tips.len());
            assert!((length - 1.0).abs() < 1e-6, "{height} from {from}: {} tips, {length} mm", plate.tips.len());
        }
    }

    assert_eq!(of(&[RECTANGLE, CRACK]), plate(DXF, &[("part.dxf", &(dxf(4, &[RECTANGLE, CRACK]) + "\n\n"))]));
}

/// What is not looked at, or cannot be meant, is refused.
#[test]
fn what_a_drawing_hides_or_repeats_is_refused() {
    let twice: [(&[&str], &[&str]); 5] = [
        (&[RECTANGLE, CRACK, CRACK], &["layer cracks", "LINE at (5, 0)", "drawn twice"]),
        (&[RECTANGLE, CRACK, "LINE cracks 10 22 20 0 11 5 21 0"], &["layer cracks", "drawn twice"]),
        (&[RECTANGLE, RECTANGLE, CRACK], &["layer outline", "drawn twice"]),
        (&[RECTANGLE, HOLE, HOLE], &["layer holes", "CIRCLE at (10, 0)", "drawn twice"]),
        (&[RECTANGLE, "CIRCLE holes 10 3 20 4 40 0"], &["layer holes", "circle at (3.0000, 4.0000) mm", "no radius"]),
    ];
    for (entities, words) in twice {
        refused(DXF, ("part.dxf", &dxf(4, entities)), words);
    }
}

fn refused(keys: &str, file: (&str, &str), words: &[impl AsRef<str>]) {
    let Err(error) = try_case(keys, &[file]) else { panic!("{keys} {}: taken, not refused", file.1) };
    assert_says(&format!("{keys}: {error}"), words);
}
