//! The specimen of a case as a drawing to scale: outline, holes, slots, cracks, loads, supports, sizes in mm.

mod nodes;
pub mod sketch;

use super::model_words::loading;
pub use nodes::{nodes_svg, tip_svg};
use sketch::{CRACK, EDGE, HELD, LOAD, PLATE, Sketch, WORDS};

use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_plate::specimen::geometry::{along, bounding_box, distance};
use perilife_plate::specimen::{Crack, Load, LoadMeasure, Point, Specimen, SpecimenKind, Support};

/// What a drawing says of itself, so that it is known again.
pub const SIGN: &str = "drawn by perilife check";
/// Room around the plate for arrows, sizes and words, pixels: left, right, top, bottom.
const MARGIN: [f64; 4] = [110.0, 190.0, 150.0, 122.0];
/// Largest size of the plate itself, pixels.
const PLATE_MAX: Point = [460.0, 520.0];
/// Length of a load arrow of the nominal stress, pixels.
const ARROW: f64 = 38.0;

/// SVG text of the specimen of `case`.
///
/// Red: cracks, with a dot at each tip that can grow, numbered as in `crack_path.csv`. Blue: loads. Green hatching: what
/// is held.
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

    sketch.text([width / 2.0, 30.0], &format!("{name} ({})", specimen.kind), "middle", 18, EDGE);
    sketch.text([width / 2.0, 52.0], loads, "middle", 13, LOAD);
    sketch.polygon(&specimen.outline, PLATE, EDGE);
    for hole in &specimen.holes {
        sketch.circle(hole.centre, hole.radius, "white", EDGE);
    }
    number_holes(&mut sketch, specimen);
    sketch.clip(&specimen.outline);
    for slot in &specimen.slots {
        sketch.slot(&slot.corners());
    }
    draw_supports(&mut sketch, specimen);
    more(&mut sketch);
    draw_cracks(&mut sketch, specimen);
    draw_loads(&mut sketch, specimen);
    draw_sizes(&mut sketch, specimen, [low, high]);
    draw_axes(&mut sketch);
    draw_legend(&mut sketch, &rows, plate_height);
    sketch.finish(width, height)
}

/// A number with at most two decimals.
fn short(value: f64) -> String {
    let text = format!("{value:.2}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

fn mm(metres: f64) -> String {
    format!("{} mm", short(metres / MM))
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
        sketch.text(place, &number.to_string(), "middle", 12, WORDS);
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
        sketch.text(words, &number.to_string(), "middle", 12, CRACK);
    }
}

fn draw_loads(sketch: &mut Sketch, specimen: &Specimen) {
    let largest = specimen.loads.iter().fold(1e-12_f64, |largest, load| match load {
        Load::Edge { .. } | Load::Bent { .. } => {
            let ends = load.on_edge().map_or([[0.0; 2]; 2], |(.., ends)| ends);
            ends.iter().fold(largest, |largest, [x, y]| largest.max(x.hypot(*y)))
        }
        // Beside loaded edges forces are per stress: what an arrow shows of them is their direction.
        Load::Pin { .. } if specimen.load_measure == LoadMeasure::Stress => largest,
        Load::Pin { force, .. } => largest.max(force.abs()),
    });
    let mut named = false;
    for load in &specimen.loads {
        match load {
            Load::Edge { .. } | Load::Bent { .. } => {
                let Some((from, to, [first, last])) = load.on_edge() else { continue };
                let (from, to) = (&from, &to);
                let count = (distance(*from, *to) * sketch.scale / 34.0).round().clamp(1.0, 25.0) as usize;
                let mut vector = [0.0; 2];
                for i in 0..count {
                    let share = (i as f64 + 0.5) / count as f64;
                    let traction = along(first, last, share);
                    let size = traction[0].hypot(traction[1]);
                    if size == 0.0 || first != last && size < 0.02 * largest {
                        continue;
                    }
                    let reach = ARROW * (size / largest).max(0.4) / size;
                    vector = [traction[0] * reach, -traction[1] * reach];
                    let foot = sketch.place(along(*from, *to, share));
                    // Tension pulls out of the plate: the arrow starts 8 pixels off the edge so that grips stay visible.
                    let start = [foot[0] + 0.2 * vector[0], foot[1] + 0.2 * vector[1]];
                    sketch.arrow(start, [start[0] + vector[0], start[1] + vector[1]], LOAD, 1.6);
                }
                if !named && vector != [0.0; 2] {
                    let middle = sketch.place(along(*from, *to, 0.5));
                    sketch.text([middle[0] + 1.5 * vector[0], middle[1] + 1.5 * vector[1] + 4.0], "σ", "middle", 16, LOAD);
                    named = true;
                }
            }
            Load::Pin { hole, direction, force, .. } => {
                let Some(hole) = specimen.holes.get(*hole) else { continue };
                let centre = sketch.place(hole.centre);
                let share = if specimen.load_measure == LoadMeasure::Stress { 1.0 } else { force / largest };
                let reach = hole.radius * sketch.scale + ARROW * share.max(0.5);
                let end = [centre[0] + reach * direction[0], centre[1] - reach * direction[1]];
                sketch.dot(centre, 3.6, LOAD);
                sketch.arrow(centre, end, LOAD, 2.4);
                sketch.text([end[0] + 14.0, end[1] + 4.0], "P", "middle", 16, LOAD);
            }
        }
    }
}

fn draw_supports(sketch: &mut Sketch, specimen: &Specimen) {
    let [low, high] = bounding_box(&specimen.outline);
    for support in &specimen.supports {
        match support {
            Support::Fixed { from, to, depth, x, y } => {
                hold(sketch, *from, *to, *depth, middle_of(specimen));
                let held = match (x, y) {
                    (true, true) => "held in x and y",
                    (true, false) => "held in x",
                    _ => "held in y",
                };
                let right = if from[0] > to[0] { from } else { to };
                let [px, py] = sketch.place(*right);
                sketch.text([px + 12.0, py + 14.0], held, "start", 12, HELD);
            }
            Support::Moved { from, to, .. } => {
                hold(sketch, *from, *to, 0.0, middle_of(specimen));
                let right = if from[0] > to[0] { from } else { to };
                let [px, py] = sketch.place(*right);
                sketch.text([px + 12.0, py + 14.0], "moved straight", "start", 12, HELD);
            }
            Support::Elsewhere => {}
            Support::ClampedEnds | Support::RigidEnds => {
                let words =
                    if *support == Support::ClampedEnds { "rigid grip, cannot rotate" } else { "rigid grip, turns on a pin" };
                for (y, sign) in [(high[1], 1.0), (low[1], -1.0)] {
                    let band = 7.0 / sketch.scale * sign;
                    sketch.polygon(&[[low[0], y], [high[0], y], [high[0], y + band], [low[0], y + band]], HELD, HELD);
                    let [px, py] = sketch.place([high[0], y + band]);
                    sketch.text([px + 12.0, py + 4.0], words, "start", 12, HELD);
                    if *support == Support::RigidEnds {
                        let [cx, cy] = sketch.place([(low[0] + high[0]) / 2.0, y + band / 2.0]);
                        sketch.dot([cx, cy], 5.0, "white");
                    }
                }
            }
        }
    }
}

fn middle_of(specimen: &Specimen) -> Point {
    let [low, high] = bounding_box(&specimen.outline);
    along(low, high, 0.5)
}

/// Hatching outside a held stretch, and a tinted band as deep as the hold.
fn hold(sketch: &mut Sketch, from: Point, to: Point, depth: f64, inside: Point) {
    let length = distance(from, to);
    let mut normal = [-(to[1] - from[1]) / length, (to[0] - from[0]) / length];
    if normal[0] * (inside[0] - from[0]) + normal[1] * (inside[1] - from[1]) < 0.0 {
        normal = [-normal[0], -normal[1]];
    }
    let inward = |p: Point| [p[0] + normal[0] * depth, p[1] + normal[1] * depth];
    if depth > 0.0 {
        sketch.polygon(&[from, to, inward(to), inward(from)], "#c9d19a", HELD);
    }
    let (a, b) = (sketch.place(from), sketch.place(to));
    sketch.line(a, b, HELD, 3.0);
    let count = ((length * sketch.scale) / 9.0).ceil().clamp(2.0, 200.0);
    // Pixels run downwards: outward is minus the normal in x and plus in y.
    let out = [-normal[0] * 9.0, normal[1] * 9.0];
    let lean = [(b[0] - a[0]) / count, (b[1] - a[1]) / count];
    for i in 0..count as usize {
        let foot = [a[0] + lean[0] * (i as f64 + 1.0), a[1] + lean[1] * (i as f64 + 1.0)];
        sketch.line(foot, [foot[0] + out[0] - lean[0], foot[1] + out[1] - lean[1]], HELD, 1.0);
    }
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
        sketch.text([line, top - 16.0], "load line", "middle", 12, WORDS);
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
            sketch.text([b[0] + 6.0, b[1] + 24.0], &format!("a = {}", mm(specimen.crack_length)), "start", 13, CRACK);
        }
        SpecimenKind::SingleEdgeTension | SpecimenKind::DoubleEdgeTension => {
            for crack in &specimen.cracks {
                let [x, y] = sketch.place(crack.from);
                // Words start at the cracked edge and stay inside the plate.
                let (x, anchor) = if crack.from[0] < crack.to[0] { (x + 5.0, "start") } else { (x - 5.0, "end") };
                sketch.text([x, y + 20.0], &format!("a = {}", mm(specimen.crack_length)), anchor, 13, CRACK);
            }
        }
        _ => {}
    }
}

/// Sizes of holes, slots and cracks of a plate in words: beside each other in the picture they would overlap.
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
        lines.push(format!("{} micro cracks up to {}", micro.len(), mm(micro.iter().fold(0.0, |a, b| f64::max(a, *b)))));
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

/// Directions of x and y, beside the plate.
fn draw_axes(sketch: &mut Sketch) {
    let corner = [34.0, 112.0];
    sketch.arrow(corner, [corner[0] + 32.0, corner[1]], WORDS, 1.2);
    sketch.arrow(corner, [corner[0], corner[1] - 32.0], WORDS, 1.2);
    sketch.text([corner[0] + 41.0, corner[1] + 4.0], "x", "middle", 13, WORDS);
    sketch.text([corner[0], corner[1] - 38.0], "y", "middle", 13, WORDS);
}

/// Lines of the flaw list that fit below the picture.
const LIST_MAX: usize = 10;

/// Rows below the picture: what the colours mean, thickness, then the list of flaws.
fn legend_rows(specimen: &Specimen) -> Vec<String> {
    let slots = if specimen.tips.iter().any(|tip| tip.from_slot) { "; a slot's tip is the middle of its end face" } else { "" };
    let mut rows = vec![
        format!("crack through the thickness; dots: numbered tips that can grow{slots}"),
        format!("thickness {}; drawn to scale", mm(specimen.thickness)),
    ];
    let list = flaw_list(specimen);
    let more = list.len().saturating_sub(LIST_MAX);
    rows.extend(list.into_iter().take(LIST_MAX));
    if more > 0 {
        rows.push(format!("and {more} more holes, cracks and slots"));
    }
    rows
}

fn draw_legend(sketch: &mut Sketch, rows: &[String], top: f64) {
    sketch.line([30.0, top], [54.0, top], CRACK, 2.6);
    sketch.dot([54.0, top], 3.6, CRACK);
    for (i, row) in rows.iter().enumerate() {
        let x = if i == 0 { 66.0 } else { 30.0 };
        sketch.text([x, top + 4.0 + 21.0 * i as f64], row, "start", 12, WORDS);
    }
}
