//! The specimen of a case as a drawing to scale: outline, holes, slots, cracks, loads, supports, dimensions in mm.

mod nodes;
pub mod sketch;

use super::format::{PLAIN, trimmed};
use super::model_words::loading;
use super::pictures::plate::{Drawing, Plate};
pub use nodes::{nodes_svg, tip_svg};
use sketch::{CRACK, EDGE, LOAD, Sketch, WORDS};

use perilife_base::units::MM;
use perilife_base::units::shown::{name_of, per};
use perilife_growth::case::Case;
use perilife_plate::specimen::geometry::{bounding_box, distance};
use perilife_plate::specimen::{Crack, Point, Specimen, SpecimenKind, Support};

/// Mark by which a later drawing may replace it.
pub const SIGN: &str = "drawn by perilife check";
/// Room around the plate for arrows, sizes and words, pixels: left, right, top, bottom.
const MARGIN: [f64; 4] = [110.0, 190.0, 150.0, 122.0];
/// Largest size of the plate itself, pixels.
const PLATE_MAX: Point = [460.0, 520.0];
/// Height of words, pixels.
const TEXT: f64 = 12.0;

/// SVG text of the specimen of `case`; tips are numbered as in `crack_path.csv`.
pub fn specimen_svg(case: &Case) -> String {
    drawing(&case.name, &loading(case), &case.specimen, &[], |_| {})
}

/// The drawing with a title, the loads in words, lines below the others, and what `more` adds on the bare plate.
pub fn drawing(name: &str, loads: &str, specimen: &Specimen, lines: &[String], more: impl FnOnce(&mut Sketch)) -> String {
    let [low, high] = bounding_box(&specimen.outline);
    let size = [high[0] - low[0], high[1] - low[1]];
    let scale = (PLATE_MAX[0] / size[0]).min(PLATE_MAX[1] / size[1]);
    // Narrow plates still need room for the title and the words below.
    let side = ((420.0 - size[0] * scale) / 2.0).max(0.0);
    let origin = [MARGIN[0] + side - low[0] * scale, MARGIN[2] + high[1] * scale];
    let mut sketch = Sketch::new(scale, origin);
    let width = MARGIN[0] + MARGIN[1] + 2.0 * side + size[0] * scale;
    let mut rows = legend_rows(specimen);
    rows.extend_from_slice(lines);
    let plate_height = MARGIN[2] + MARGIN[3] + size[1] * scale;
    let height = plate_height + 21.0 * rows.len() as f64;

    let plate = Plate::of_specimen(specimen, loads.to_owned());
    let drawn = Drawing::of(&plate, TEXT);
    sketch.name([width / 2.0, 30.0], &format!("{name} ({})", specimen.kind), "middle", 18.0, EDGE);
    sketch.name([width / 2.0, 52.0], loads, "middle", 13.0, LOAD);
    sketch.in_mm(|sketch| drawn.body(sketch));
    number_holes(&mut sketch, specimen);
    more(&mut sketch);
    draw_cracks(&mut sketch, specimen);
    sketch.in_mm(|sketch| drawn.arrows(sketch));
    draw_sizes(&mut sketch, specimen, [low, high]);
    draw_axes(&mut sketch);
    draw_legend(&mut sketch, &rows, plate_height);
    sketch.picture([width, height], &format!("{name}, {}, {SIGN}", specimen.kind))
}

/// A number with at most two decimals.
fn short(value: f64) -> String {
    trimmed(&format!("{value:.2}")).to_owned()
}

/// A length in the unit that is shown, to a hundredth of a millimetre.
fn mm(metres: f64) -> String {
    match per("mm") {
        1.0 => format!("{} mm", short(metres / MM)),
        factor => format!("{} {}", trimmed(&PLAIN.fixed(metres / MM * factor, 4)), name_of("mm")),
    }
}

/// Numbers of the holes as in `specimen.holes` and `loading.pins`, where there is room and more than one.
fn number_holes(sketch: &mut Sketch, specimen: &Specimen) {
    if specimen.holes.len() < 2 {
        return;
    }
    for (number, hole) in specimen.holes.iter().enumerate() {
        let ([x, y], radius) = (sketch.place(hole.centre), hole.radius * sketch.scale);
        // Inside a large hole off its centre, where a pin load starts; beside a small one.
        let place = if radius > 20.0 { [x - 0.6 * radius, y + 4.0] } else { [x + radius + 8.0, y + radius + 8.0] };
        sketch.name(place, &number.to_string(), "middle", 12.0, WORDS);
    }
}

fn draw_cracks(sketch: &mut Sketch, specimen: &Specimen) {
    for crack in &specimen.cracks {
        let (from, to) = (sketch.place(crack.from), sketch.place(crack.to));
        sketch.line(from, to, CRACK, 2.6);
    }
    for (number, tip) in specimen.tips.iter().enumerate() {
        let place = sketch.place(tip.position);
        sketch.dot(place, 3.6, CRACK);
        // Ahead of the tip and a little above the path, so that the number does not hide it.
        let words = [place[0] + 13.0 * tip.direction[0], place[1] - 13.0 * tip.direction[1] - 4.0];
        sketch.name(words, &number.to_string(), "middle", 12.0, CRACK);
    }
}

fn support_words(specimen: &Specimen) -> Vec<String> {
    let at = |from: &Point, to: &Point| {
        let [[a, b], [c, d]] = [from, to].map(|point| point.map(mm));
        format!("from ({a}, {b}) to ({c}, {d})")
    };
    let words = |support: &Support| match support {
        Support::Fixed { from, to, x, y, .. } => {
            let ways = match (x, y) {
                (true, true) => "x, y",
                (true, false) => "x",
                _ => "y",
            };
            Some(format!("fixed {ways} {}", at(from, to)))
        }
        Support::Moved { from, to, .. } => Some(format!("prescribed displacement (straight) {}", at(from, to))),
        Support::ClampedEnds => Some("rigid grips, clamped (no rotation)".to_owned()),
        Support::RigidEnds => Some("rigid grips, pinned".to_owned()),
        Support::Elsewhere => None,
    };
    specimen.supports.iter().filter_map(words).collect()
}

fn draw_sizes(sketch: &mut Sketch, specimen: &Specimen, [low, high]: [Point; 2]) {
    let below = sketch.place([0.0, low[1]])[1] + 78.0;
    let beside = sketch.place([high[0], 0.0])[0] + 78.0;
    let (left, right) = (sketch.place(low)[0], sketch.place(high)[0]);
    let (top, bottom) = (sketch.place(high)[1], sketch.place(low)[1]);
    if specimen.kind == SpecimenKind::CompactTension {
        // The standard measures from the load line.
        let line = sketch.place([0.0, 0.0])[0];
        sketch.line([line, top - 10.0], [line, below + 6.0], "#9aa4ae", 0.8);
        sketch.name([line, top - 16.0], "load line", "middle", 12.0, WORDS);
        let tip = sketch.place([specimen.crack_length, 0.0])[0];
        sketch.measure([line, below - 36.0], [tip, below - 36.0], &format!("a = {}", mm(specimen.crack_length)));
        sketch.measure([line, below], [right, below], &format!("W = {}", mm(specimen.width)));
    } else {
        sketch.measure([left, below], [right, below], &mm(high[0] - low[0]));
    }
    sketch.measure([beside, top], [beside, bottom], &mm(high[1] - low[1]));
    match specimen.kind {
        SpecimenKind::MiddleTension => {
            let (a, b) = (sketch.place([0.0, 0.0]), sketch.place([specimen.crack_length, 0.0]));
            sketch.line([a[0], a[1] + 5.0], [a[0], a[1] + 24.0], WORDS, 0.8);
            sketch.line([b[0], b[1] + 5.0], [b[0], b[1] + 24.0], WORDS, 0.8);
            sketch.measure([a[0], a[1] + 20.0], [b[0], b[1] + 20.0], "");
            sketch.name([b[0] + 6.0, b[1] + 24.0], &format!("a = {}", mm(specimen.crack_length)), "start", 13.0, CRACK);
        }
        SpecimenKind::SingleEdgeTension | SpecimenKind::DoubleEdgeTension => {
            for crack in &specimen.cracks {
                let [x, y] = sketch.place(crack.from);
                // Words start at the cracked edge and stay inside the plate.
                let (x, anchor) = if crack.from[0] < crack.to[0] { (x + 5.0, "start") } else { (x - 5.0, "end") };
                sketch.name([x, y + 20.0], &format!("a = {}", mm(specimen.crack_length)), anchor, 13.0, CRACK);
            }
        }
        _ => {}
    }
}

/// Dimensions of holes, slots and cracks of a plate in words: in the picture they would overlap.
fn flaw_list(specimen: &Specimen) -> Vec<String> {
    let mut lines = Vec::new();
    for (i, hole) in specimen.holes.iter().enumerate() {
        let [x, y] = hole.centre;
        lines.push(format!("hole {i}: diameter {} at ({}, {})", mm(2.0 * hole.radius), short(x / MM), mm(y)));
    }
    if !specimen.kind.is_plate() {
        return lines;
    }
    let angle = |from: Point, to: Point| {
        let degrees = (to[1] - from[1]).atan2(to[0] - from[0]).to_degrees().rem_euclid(180.0);
        if degrees > 90.0 { degrees - 180.0 } else { degrees }
    };
    let is_micro = |crack: &&Crack| !specimen.tips.iter().any(|tip| tip.position == crack.from || tip.position == crack.to);
    for crack in specimen.cracks.iter().filter(|crack| !is_micro(crack)) {
        let tips = tips_at(specimen, crack.from, crack.to);
        lines.push(format!(
            "crack with {tips}: {}, {}° against x",
            mm(distance(crack.from, crack.to)),
            short(angle(crack.from, crack.to))
        ));
    }
    let micro: Vec<f64> = specimen.cracks.iter().filter(is_micro).map(|crack| distance(crack.from, crack.to)).collect();
    if !micro.is_empty() {
        lines.push(format!("cracks without tips: {}, up to {}", micro.len(), mm(micro.iter().fold(0.0, |a, b| f64::max(a, *b)))));
    }
    for slot in &specimen.slots {
        let tips = tips_at(specimen, slot.from, slot.to);
        lines.push(format!(
            "slot with {tips}: {} x {}, {}° against x",
            mm(specimen.length_inside(slot.from, slot.to)),
            mm(slot.width),
            short(angle(slot.from, slot.to))
        ));
    }
    lines
}

fn tips_at(specimen: &Specimen, from: Point, to: Point) -> String {
    let at = |(_, tip): &(usize, &perilife_plate::specimen::TipSeed)| tip.position == from || tip.position == to;
    let numbers: Vec<String> = specimen.tips.iter().enumerate().filter(at).map(|(number, _)| number.to_string()).collect();
    match numbers.len() {
        0 => "no tip".to_owned(),
        1 => format!("tip {}", numbers[0]),
        _ => format!("tips {}", numbers.join(" and ")),
    }
}

/// Directions of x and y.
fn draw_axes(sketch: &mut Sketch) {
    let corner = [34.0, 112.0];
    sketch.arrow(corner, [corner[0] + 32.0, corner[1]], WORDS, 1.2);
    sketch.arrow(corner, [corner[0], corner[1] - 32.0], WORDS, 1.2);
    sketch.name([corner[0] + 41.0, corner[1] + 4.0], "x", "middle", 13.0, WORDS);
    sketch.name([corner[0], corner[1] - 38.0], "y", "middle", 13.0, WORDS);
}

/// Lines of the flaw list that fit below the picture.
const LIST_MAX: usize = 10;

/// Rows below the picture: legend, thickness, then the list of flaws.
fn legend_rows(specimen: &Specimen) -> Vec<String> {
    let slots = if specimen.tips.iter().any(|tip| tip.from_slot) { "; slot tip = center of its end" } else { "" };
    let mut rows = vec![
        format!("through crack; dots: numbered tips{slots}"),
        format!("thickness {}; drawn to scale", mm(specimen.thickness)),
    ];
    rows.extend(support_words(specimen));
    let list = flaw_list(specimen);
    let more = list.len().saturating_sub(LIST_MAX);
    rows.extend(list.into_iter().take(LIST_MAX));
    if more > 0 {
        rows.push(format!("{more} more holes, cracks and slots"));
    }
    rows
}

fn draw_legend(sketch: &mut Sketch, rows: &[String], top: f64) {
    sketch.line([30.0, top], [54.0, top], CRACK, 2.6);
    sketch.dot([54.0, top], 3.6, CRACK);
    for (i, row) in rows.iter().enumerate() {
        let x = if i == 0 { 66.0 } else { 30.0 };
        sketch.name([x, top + 4.0 + 21.0 * i as f64], row, "start", 12.0, WORDS);
    }
}
