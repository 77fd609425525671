//! `section.svg`: the section of a plate through its part-through crack, with the front at quarters of the cycles until it is through.

use super::plate::{SIZE, colour, scale_bar};
use crate::band::at;
use crate::chart::{INK, width_of};
use crate::specimen_picture::sketch::{EDGE, PLATE, Sketch, WORDS};
use perilife_base::units::MM;
use perilife_growth::case::Case;
use perilife_growth::predict::part_through::PartThroughLife;
use perilife_growth::predict::{CurvePoint, Prediction};
use perilife_plate::specimen::{PartThrough, Point};

const SHARES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];
/// What is shown of the width beside the front, over its last length and over the thickness.
const BESIDE: [f64; 2] = [0.6, 1.0];
/// Room around the section, and for words above it, px.
const AROUND: f64 = 30.0;
const ABOVE: f64 = 64.0;
const HIGH: f64 = 300.0;

/// SVG text; `None` of a crack that goes through from the start.
pub fn section_svg(case: &Case, prediction: &Prediction) -> Option<String> {
    let flaw = case.specimen.part_through?;
    let found = PartThroughLife::of(case, &prediction.curve)?;
    let fronts = SHARES.map(|share| (share, axes_at(&prediction.curve, share * found.cycles)));
    let [low, high] = window(&flaw, found.axes[1]);
    let wide = SIZE.width - 2.0 * AROUND;
    let scale = (wide / (high - low)).min(HIGH / flaw.thickness);
    let [width, height] = [(high - low) * scale, flaw.thickness * scale];
    let origin = [0.5 * (SIZE.width - width) - low * scale, ABOVE];
    let mut sketch = Sketch::new(scale, origin);
    body(&mut sketch, &flaw, [low, high]);
    for (share, axes) in fronts {
        draw(&mut sketch, &flaw, axes, share);
    }
    words(&mut sketch, case, &found, height);
    let sentence = format!(
        "Section through the crack: depth {:.3} mm to {:.3} mm, length {:.3} mm to {:.3} mm, fronts at quarters of {:.0} cycles",
        flaw.depth / MM,
        found.axes[0] / MM,
        flaw.half_length / MM,
        found.axes[1] / MM,
        found.cycles
    );
    Some(sketch.picture([SIZE.width, ABOVE + height + 2.6 * AROUND], &sentence))
}

/// Semi-axes at cycles, linear between rows, m.
fn axes_at(curve: &[CurvePoint], cycles: f64) -> [f64; 2] {
    let axes = |row: &CurvePoint| [row.depth.map_or(f64::NAN, |depth| depth.depth), row.crack_length];
    [0, 1].map(|i| at(&curve.iter().map(|row| [row.cycles, axes(row)[i]]).collect::<Vec<_>>(), cycles))
}

/// From where to where the width is shown, m.
fn window(flaw: &PartThrough, length: f64) -> Point {
    let room = (BESIDE[0] * length).max(BESIDE[1] * flaw.thickness);
    let places = flaw.seen_in_section([flaw.depth, length]).into_iter().flatten().map(|[x, _]| x);
    let [low, high] = places.fold([-flaw.radius, flaw.radius], |[low, high], x| [low.min(x), high.max(x)]);
    let [low, high] = if flaw.radius == 0.0 && low < 0.0 && high <= 0.0 { [low, low + length] } else { [low, high] };
    [(low - room).max(-0.5 * flaw.width), (high + room).min(0.5 * flaw.width)]
}

/// The plate, the hole in it, and open ends where more of it follows.
fn body(sketch: &mut Sketch, flaw: &PartThrough, [low, high]: Point) {
    let part = |from: f64, to: f64| [[from, 0.0], [to, 0.0], [to, -flaw.thickness], [from, -flaw.thickness]];
    sketch.polygon(&part(low, high), PLATE, EDGE);
    if flaw.radius > 0.0 {
        sketch.polygon(&part(-flaw.radius, flaw.radius), "white", EDGE);
        let middle = sketch.place([0.0, -0.5 * flaw.thickness]);
        sketch.name(middle, "hole", "middle", SIZE.text, WORDS);
    }
    for (end, is_cut) in [(low, low > -0.5 * flaw.width), (high, high < 0.5 * flaw.width)] {
        if is_cut {
            let places = [sketch.place([end, 0.0]), sketch.place([end, -flaw.thickness])];
            sketch.path(&places, "white", 3.0, "");
            sketch.path(&places, EDGE, 1.2, "4 4");
        }
    }
}

/// A front, and its share of the cycles at its deepest point.
fn draw(sketch: &mut Sketch, flaw: &PartThrough, axes: [f64; 2], share: f64) {
    for front in flaw.seen_in_section(axes) {
        let places: Vec<Point> = front.iter().map(|place| sketch.place(*place)).collect();
        if let (true, [first, .., last]) = (share == 0.0, &places[..]) {
            // A quarter of an ellipse is closed by its corner; of others that is one of the ends.
            sketch.area(&[&places[..], &[[last[0], first[1]]]].concat(), INK, 0.35);
        }
        sketch.path(&places, &colour(share), 2.2, "");
    }
}

fn words(sketch: &mut Sketch, case: &Case, found: &PartThroughLife, height: f64) {
    let text = SIZE.text;
    let end = if found.is_through { "breakthrough" } else { "the end" };
    sketch.name([AROUND, 24.0], &format!("{}: section through the crack", case.name), "start", text + 1.0, INK);
    let of_fronts = format!("front at fraction of {:.0} cycles to {end}:", found.cycles);
    sketch.name([AROUND, 46.0], &of_fronts, "start", text, WORDS);
    let mut x = AROUND + width_of(&of_fronts, text);
    for share in SHARES {
        sketch.path(&[[x, 42.0], [x + 18.0, 42.0]], &colour(share), 2.6, "");
        sketch.name([x + 22.0, 46.0], &format!("{:.0} %", 100.0 * share), "start", text, WORDS);
        x += 68.0;
    }
    // Bars are measured in mm.
    let mm = sketch.scale * MM;
    scale_bar(sketch, [AROUND, ABOVE + height + 1.6 * AROUND], [mm, (SIZE.width - 2.0 * AROUND) / mm], text);
}
