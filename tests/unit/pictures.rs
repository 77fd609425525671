//! Charts, the damage picture and ParaView files of the made-up run.

use std::fs;
use std::path::Path;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use tempfile::tempdir;

use crate::support::rows::{assert_holds, assert_says};
use crate::support::{made_up_case, made_up_run};
use perilife_growth::case::Case;
use perilife_growth::predict::StopReason;
use perilife_plate::specimen::Point;
use perilife_results::axis::{Box2, along, place_labels};
use perilife_results::chart::{self, COMPUTED, LARGE, Mark, Series};
use perilife_results::curve::{self, Row, RunTables, TipRows};
use perilife_results::pictures::curves::{a_n_svg, k_svg};
use perilife_results::pictures::plate::{HoleDrawn, LoadDrawn, Plate, SIZE, plate_svg};
use perilife_results::record::RunRecord;
use perilife_results::snapshots;
use perilife_results::snapshots::{DamagePicture, cycles_and_length};
use perilife_results::specimen_picture::sketch::{CRACK, Sketch};
use perilife_results::specimen_picture::specimen_svg;

const LENGTHS: [&str; 2] = ["Cycles N", "Crack length a, mm"];
/// Lattice angles that matter: the image and the mesh.
const ANGLES: [f64; 2] = [0.0, 0.35];

#[test]
fn charts_name_axes_units_and_series() {
    let dir = tempdir().unwrap();
    let run = made_up_run::prediction(0.0);
    let rows: Vec<curve::Row> = curve::Row::of_run(&made_up_case::case(), &run);
    let series = |name: &str, mark, pick: fn(&curve::Row) -> (f64, f64)| Series {
        name: name.into(),
        mark,
        points: rows.iter().map(pick).collect(),
    };
    for mark in [Mark::Line, Mark::Dashes, Mark::Circles, Mark::Dots] {
        let path = dir.path().join("chart.svg");
        let has = |words: &[&str]| {
            let svg = fs::read_to_string(&path).unwrap();
            words.iter().for_each(|word| assert!(svg.contains(word), "{mark:?}: {word}"));
            assert!(svg.contains("width=\"900\"") && svg.contains("viewBox"), "shown at its size");
        };
        chart::linear(&path, "plate", LENGTHS, &[series("predicted", mark, |r| (r.cycles, r.crack_length_mm))]).unwrap();
        has(&["plate", "predicted", "Cycles N", "Crack length a, mm", "500\u{2009}000"]);
        chart::growth_rate(&path, "plate", &[series("rates", mark, |r| (r.delta_k_mpa_sqrt_m, r.da_dn_mm_per_cycle))]).unwrap();
        has(&["rates", "MPa√m", "mm/cycle", "10⁻⁵"]);
    }
}

#[test]
fn charts_survive_what_has_no_extent() {
    let dir = tempdir().unwrap();
    let points = [
        vec![],
        vec![(0.0, 9.0)],
        vec![(f64::NAN, 9.0), (f64::INFINITY, -1.0)],
        vec![(1e300, 1e-300), (1e301, 1e-300)],
        vec![(5.0, 5.0); 3],
    ];
    for points in points {
        type Draw = fn(&Path, &str, &[Series]) -> perilife_base::error::Result<()>;
        for draw in [(|path, title, series| chart::linear(path, title, LENGTHS, series)) as Draw, chart::growth_rate] {
            for mark in [Mark::Line, Mark::Dashes, Mark::Circles] {
                draw(&dir.path().join("chart.svg"), "", &[Series { name: "n".into(), points: points.clone(), mark }]).unwrap();
            }
        }
    }
}

#[test]
fn the_damage_picture_shows_plate_crack_and_scale() {
    for angle in ANGLES {
        let (run, cracks) = (made_up_run::prediction(angle), made_up_run::cracks());
        let paths: Vec<Vec<Point>> =
            curve::paths(&run, &cracks).into_iter().map(|path| path.into_iter().map(|(_, p)| p).collect()).collect();
        let caption = cycles_and_length(&run.snapshots[2]);
        let picture =
            DamagePicture { grid: &run.grid, snapshot: &run.snapshots[2], cracks: &cracks, paths: &paths, caption: &caption };
        let svg = picture.svg().unwrap();
        let count = |text: &str| svg.matches(text).count();
        // Cracks and paths, and one of each in the legend; words of the caption; the bar of the scale.
        assert_eq!(count("stroke=\"black\""), cracks.len() + 1, "angle {angle}");
        assert_eq!(count("stroke=\"#0096ff\""), paths.len() + 1, "angle {angle}");
        assert!(caption.iter().all(|line| svg.contains(line.as_str())) && svg.contains(" mm</text>"));
        assert!(svg.contains(&format!("rotate({:.4})", -angle.to_degrees())), "turned as the lattice is");
        let image = svg.split("base64,").nth(1).unwrap().split('"').next().unwrap();
        let bytes = STANDARD.decode(image).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!([info.width as usize, info.height as usize], [run.grid.columns, run.grid.rows]);
        // A pixel a point, y up; what is no material is clear.
        for (place, point) in run.grid.point_at.iter().enumerate() {
            let (column, row) = (place % run.grid.columns, run.grid.rows - 1 - place / run.grid.columns);
            let at = 4 * (row * run.grid.columns + column);
            assert_eq!(pixels[at + 3] > 0, point.is_some(), "angle {angle}: place {place}");
        }
        let colours: std::collections::BTreeSet<&[u8]> = pixels.chunks_exact(4).collect();
        assert!(colours.len() > 2, "whole and damaged points differ");
    }
}

/// An array of a VTK XML file with appended raw data: bytes of the array called `name`.
fn array<'f>(file: &'f [u8], name: &str) -> (String, &'f [u8]) {
    let marker = b"<AppendedData encoding=\"raw\">\n_";
    let start = file.windows(marker.len()).position(|w| w == marker).unwrap() + marker.len();
    let head = std::str::from_utf8(&file[..start]).unwrap();
    let element = head.split("<DataArray ").find(|e| e.contains(&format!("Name=\"{name}\""))).unwrap_or_else(|| panic!("{name}"));
    let attribute = |key: &str| element.split(&format!("{key}=\"")).nth(1).unwrap().split('"').next().unwrap().to_owned();
    let at = start + attribute("offset").parse::<usize>().unwrap();
    let length = u64::from_le_bytes(file[at..at + 8].try_into().unwrap()) as usize;
    (format!("{} {}", attribute("type"), attribute("NumberOfComponents")), &file[at + 8..at + 8 + length])
}

fn reals(bytes: &[u8]) -> Vec<f64> {
    bytes.chunks_exact(8).map(|b| f64::from_le_bytes(b.try_into().unwrap())).collect()
}

#[test]
fn paraview_files_read_back() {
    let dir = tempdir().unwrap();
    for (angle, extension) in ANGLES.into_iter().zip(["vti", "vtu"]) {
        let run = made_up_run::prediction(angle);
        snapshots::write_series(dir.path(), &run.grid, &run.snapshots).unwrap();
        let list = fs::read_to_string(dir.path().join("run.pvd")).unwrap();
        for (number, snapshot) in run.snapshots.iter().enumerate() {
            let name = format!("plate_{number:04}.{extension}");
            assert!(list.contains(&format!("timestep=\"{}\" group=\"\" part=\"0\" file=\"{name}\"", snapshot.cycles)));
            let file = fs::read(dir.path().join(name)).unwrap();
            let (kind, damage) = array(&file, "damage");
            assert_eq!(kind, "Float64 1");
            let (kind, displacement) = array(&file, "displacement_mm");
            assert_eq!(kind, "Float64 3");
            let (damage, displacement) = (reals(damage), reals(displacement));
            assert_eq!(displacement.len(), 3 * damage.len());
            // Sums survive the change from points to lattice places, whatever the order.
            assert!((damage.iter().sum::<f64>() - snapshot.damage.iter().sum::<f64>()).abs() < 1e-9);
            let up: f64 = displacement.iter().skip(1).step_by(3).map(|v| v.abs()).sum();
            let expected: f64 = snapshot.displacement.iter().map(|u| 1e3 * u[1].abs()).sum();
            assert!((up / expected - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn a_turned_lattice_is_squares_of_its_own_size() {
    let run = made_up_run::prediction(0.35);
    let file = snapshots::mesh(&run.grid, &run.snapshots[0]);
    let points = reals(array(&file, "points").1);
    let corners: Vec<i64> =
        array(&file, "connectivity").1.chunks_exact(8).map(|b| i64::from_le_bytes(b.try_into().unwrap())).collect();
    assert_eq!(points.len(), 3 * run.figures.points);
    assert_eq!(array(&file, "types").1.len(), corners.len() / 4);
    for square in corners.chunks_exact(4) {
        let [a, b, c] = [0, 1, 2].map(|i| &points[3 * square[i] as usize..][..2]);
        let (first, second) = ([b[0] - a[0], b[1] - a[1]], [c[0] - b[0], c[1] - b[1]]);
        let area = first[0] * second[1] - first[1] * second[0];
        assert!((area - 1.0).abs() < 1e-9, "1 mm², counter-clockwise: {area}");
    }
}

#[test]
fn places_outside_the_material_are_hidden() {
    let run = made_up_run::prediction(0.0);
    let file = snapshots::image(&run.grid, &run.snapshots[0]);
    let ghosts = array(&file, "vtkGhostType").1;
    assert_eq!(ghosts.len(), run.grid.point_at.len());
    assert!(ghosts.iter().zip(&run.grid.point_at).all(|(ghost, point)| (*ghost == 2) == point.is_none()));
}

#[test]
fn names_cover_nothing_where_there_is_room() {
    let frame = Box2 { low: [0.0; 2], high: [600.0, 400.0] };
    // A crowd of points in the middle and two at the edges.
    let mut points: Vec<[f64; 2]> = (0..12).map(|i| [280.0 + 9.0 * f64::from(i % 4), 190.0 + 9.0 * f64::from(i / 4)]).collect();
    points.extend([[595.0, 200.0], [4.0, 397.0]]);
    let named = [0, 3, 5, 12, 13];
    let sizes = [[90.0, 16.0]; 5];
    let line = [points[0], points[3], points[12]];
    let boxes = place_labels(frame, &points, &line, &named, &sizes);
    for (i, spot) in boxes.iter().enumerate() {
        assert!(frame.contains(*spot), "{spot:?}");
        let free = |p: &[f64; 2]| !spot.overlaps(Box2 { low: *p, high: *p });
        assert!(line.windows(2).flat_map(|ends| along(ends[0], ends[1])).all(|p| free(&p)), "{spot:?} on the line");
        assert!(points.iter().all(free) && boxes[..i].iter().all(|other| !spot.overlaps(*other)), "{spot:?}");
    }
}

const CASE: &str = "[specimen]\nkind = \"plate\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\n\
    holes = [{ x_mm = 20, y_mm = 40, diameter_mm = 10 }]\nnotches = [{ from_mm = [-50, 0], to_mm = [-40, 0], width_mm = 2 }]\n\
    cracks = [{ from_mm = [0, 0], to_mm = [10, 5] }]\n[material]\nname = \"q345\"\n[loading]\nstress_max_mpa = 70\nstress_ratio = 0.1\n\
    [supports]\nbottom = { rows_mm = 3, fix = [\"x\", \"y\"] }\n[fatigue]\na = 1\np = 2\nhorizon_mm = 3";

#[test]
fn everything_of_the_specimen_is_drawn() {
    let case = Case::from_toml(CASE, "a < b & c", std::path::Path::new(""), &["fatigue.driver=bond_strain".to_owned()]).unwrap();
    let svg = specimen_svg(&case);
    assert!(svg.starts_with("<svg") && svg.ends_with("</svg>\n") && svg.contains("a &lt; b &amp; c"));
    // Three tips, one dot in the legend.
    assert_eq!(svg.matches(&format!(r#"r="3.6" fill="{CRACK}""#)).count(), case.specimen.tips.len() + 1);
    assert_holds(
        &svg,
        "100 mm | 200 mm | thickness 2 mm | stress 7 to 70 MPa, R = 0.1 | fixed x, y | diameter 10 mm | \
        slot with tip 2 | tips 0 and 1: 11.18 mm",
    );
    assert!(!svg.contains("NaN"));
}

#[test]
fn drawn_to_scale_with_y_up() {
    let sketch = Sketch::new(1000.0, [100.0, 500.0]);
    assert_eq!(sketch.place([0.01, 0.02]), [110.0, 480.0]);
}

/// A square plate of 100 mm with a crack from its left side that grows 40 mm, as far in every thousand cycles.
fn straight_growth() -> (Plate, RunTables) {
    let arrow = |y: f64, way: f64| LoadDrawn { from_mm: [-50.0, y], to_mm: [50.0, y], direction: [0.0, way], shares: [1.0; 2] };
    let plate = Plate {
        outline_mm: vec![[-50.0, -50.0], [50.0, -50.0], [50.0, 50.0], [-50.0, 50.0]],
        holes: vec![HoleDrawn { x_mm: 20.0, y_mm: 30.0, diameter_mm: 10.0 }],
        slots_mm: Vec::new(),
        cracks_mm: vec![[[-50.0, 0.0], [-40.0, 0.0]]],
        loads: vec![arrow(50.0, 1.0), arrow(-50.0, -1.0)],
        held_mm: Vec::new(),
        load: "stress 5 to 50 MPa, R = 0.1 <&>".into(),
        specimen: String::new(),
        material: String::new(),
    };
    let steps = || (0..=8).map(f64::from);
    let row = |step: f64| Row {
        cycles: 1e3 * step,
        crack_length_mm: 10.0 + 5.0 * step,
        delta_k_mpa_sqrt_m: 10.0 + step,
        da_dn_mm_per_cycle: 5e-3,
    };
    let factors = steps().map(|step| if step == 4.0 { [f64::NAN; 2] } else { [12.0 + step, -0.5] }).collect();
    let path = [[0.0, -50.0, 0.0]].into_iter().chain(steps().map(|step| [1e3 * step, -40.0 + 5.0 * step, 0.0])).collect();
    let tips = vec![TipRows { growth_mm: steps().map(|step| 5.0 * step).collect(), factors }];
    (plate, RunTables { rows: steps().map(row).collect(), tips, paths: vec![path], ..RunTables::default() })
}

/// Of the made-up run, had it ended by fracture.
fn broken() -> RunRecord {
    let mut run = made_up_run::prediction(0.0);
    run.stop = StopReason::Toughness;
    run.curve.iter_mut().for_each(|row| row.tips.truncate(1));
    made_up_run::judged(&made_up_case::case(), &run).record
}

fn numbers_of(svg: &str, element: &str, key: &str) -> Vec<f64> {
    let value = |part: &str| part.split(&format!(" {key}=\"")).nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
    svg.split(element).skip(1).map(value).collect()
}

#[test]
fn the_way_of_a_tip_is_marked_by_shares_of_the_life() {
    let (mut plate, tables) = straight_growth();
    // No larger than the crack at its end asks for, so that there is one picture.
    plate.outline_mm = vec![[-50.0, -30.0], [10.0, -30.0], [10.0, 30.0], [-50.0, 30.0]];
    let svg = plate_svg(&plate, &tables, SIZE);
    assert_says(
        &svg,
        &["25 %", "50 %", "75 %", "90 %", "stress 5 to 50 MPa, R = 0.1 &lt;&amp;&gt;", "cycles: 0", " mm</text>", "aria-label"],
    );
    assert!(!svg.contains("NaN") && svg.matches("R = 0.1").count() == 2, "the load stands there once, and in the sentence");
    // Four marks, then the tip; growth is even over the cycles.
    let rings: Vec<f64> = numbers_of(&svg, "fill=\"white\" stroke=\"#12171d\"", "stroke-width");
    assert_eq!(rings, [1.3, 1.3, 1.3, 1.3, 1.8]);
    let circles = svg.split("<circle").skip(1).map(|part| part.split("/>").next().unwrap());
    let of_ways: String =
        circles.filter(|part| part.contains("stroke=\"#12171d\"")).map(|part| format!("<circle{part}/>")).collect();
    let x = numbers_of(&of_ways, "<circle", "cx");
    for (mark, share) in [0.25, 0.5, 0.75, 0.9].into_iter().enumerate() {
        let expected = x[0] + (share - 0.25) / 0.75 * (x[4] - x[0]);
        assert!((x[mark] - expected).abs() < 0.3, "{share}: {} and {expected}", x[mark]);
    }
}

/// The words of a load on a pin stand above the plate, not across its outline.
#[test]
fn words_of_a_pin_stand_above_the_plate() {
    let (mut plate, tables) = straight_growth();
    plate.outline_mm = vec![[-50.0, -30.0], [10.0, -30.0], [10.0, 30.0], [-50.0, 30.0]];
    plate.holes = vec![HoleDrawn { x_mm: -20.0, y_mm: 15.0, diameter_mm: 10.0 }];
    plate.loads = vec![LoadDrawn { from_mm: [-20.0, 15.0], to_mm: [-20.0, 15.0], direction: [0.0, 1.0], shares: [1.0; 2] }];
    let svg = plate_svg(&plate, &tables, SIZE);
    let outline = svg.split("<polygon points=\"").nth(1).unwrap().split('"').next().unwrap();
    let top =
        outline.split(' ').map(|pair| pair.split(',').nth(1).unwrap().parse::<f64>().unwrap()).fold(f64::INFINITY, f64::min);
    let words = svg.split("<text").skip(1).find(|part| part.contains("stress 5 to 50")).unwrap();
    let y: f64 = words.split(" y=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
    assert!(y < top && y > 10.0, "words at {y}, plate from {top}");
}

#[test]
fn a_small_crack_gets_a_picture_of_its_own() {
    let (plate, mut tables) = straight_growth();
    tables.paths[0].push([8e3, 40.0, 0.0]);
    assert!(!plate_svg(&plate, &tables, SIZE).contains("overflow=\"hidden\""), "nine tenths of the plate are not small");
    tables.paths[0].truncate(3);
    assert!(plate_svg(&plate, &tables, SIZE).contains("overflow=\"hidden\""));
}

#[test]
fn no_line_is_drawn_where_k_was_not_read() {
    let (_, mut tables) = straight_growth();
    let pieces = |svg: &str| svg.matches(&format!("stroke=\"{COMPUTED}\" stroke-width=\"2\"")).count();
    let result = broken();
    assert_eq!(pieces(&k_svg(&result, &tables, LARGE).unwrap()), 2, "K is unknown in one row");
    tables.tips[0].factors[4] = [16.0, -0.5];
    assert_eq!(pieces(&k_svg(&result, &tables, LARGE).unwrap()), 1);
    // The last of a section goes: K beyond bounds is said, and hides nothing.
    tables.tips[0].factors[8] = [4e7, 0.0];
    let svg = k_svg(&result, &tables, LARGE).unwrap();
    assert!(svg.contains("rises to 4.0e7 (off scale)") && svg.contains(">20</text>"), "{svg}");
    tables.tips[0].factors.fill([f64::NAN; 2]);
    assert_eq!(k_svg(&result, &tables, LARGE), None);
}

#[test]
fn the_curve_has_its_band_and_says_why_it_ends() {
    let (_, mut tables) = straight_growth();
    let result = broken();
    let bare = a_n_svg(&result, &tables, LARGE);
    assert!(bare.contains("fracture") && !bare.contains("fill-opacity"), "no band, none drawn");
    tables.band = Some(tables.rows.iter().map(|row| [0.8 * row.cycles, 1.3 * row.cycles]).collect());
    assert_eq!(a_n_svg(&result, &tables, LARGE).matches("fill-opacity").count(), 1);
}

/// What an SVG reader makes of the path of areas: a part that it cannot read would end the path, and all areas after it.
#[test]
fn areas_of_any_size_are_a_path_that_can_be_read() {
    let square = |x: f64, side: f64| vec![[x, 0.0], [x + side, 0.0], [x + side, -side], [x, -side]];
    let mut sketch = Sketch::new(1.0, [0.0; 2]);
    sketch.areas(&[square(3.0, 2.0), square(5.0, 0.01), vec![[1.0, 1.0]; 3], square(-7.5, 1.3)], "#123456");
    let svg = sketch.picture([10.0, 10.0], "areas");
    let way = svg.split(" d=\"").nth(1).unwrap().split('"').next().unwrap();
    assert_eq!(way, "M30 0l20 0 0-20-20 0zM-75 0l13 0 0-13-13 0z", "in tenths of a pixel, from corner to corner");
}
