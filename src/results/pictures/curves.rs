//! `a_n.svg` and `k.svg` of a run.

use serde_json::Value;

use super::tables::RunTables;
use crate::axis::Axis;
use crate::chart::{COMPUTED, Frame, SECOND, Size};
use crate::specimen_picture::sketch::Sketch;
use perilife_base::monotone::Monotone;
use perilife_plate::specimen::Point;

/// Share of an area that the band of the specimens covers with its colour.
const BAND: f64 = 0.18;
/// Parts of the cubic between two rows.
const PARTS: usize = 8;
/// Rows from which a curve is dense enough without them.
const DENSE: usize = 200;

/// Percent of the rows whose K counts as usual, and times that value up to which K is drawn.
const USUAL_PERCENT: usize = 90;
/// See [`USUAL_PERCENT`].
const BEYOND: f64 = 10.0;

/// Why a run ended, in the words of a picture and as a sentence, by its `stop_reason`.
pub fn end_words(reason: &str) -> [&'static str; 2] {
    match reason {
        "toughness" => ["fracture", "the plate fractures"],
        "net_section_yield" => ["net section yields", "the remaining section yields throughout"],
        "severed" => ["severed", "the plate is in two"],
        "left_plate" => ["at the rim", "the crack has reached the rim"],
        "entered_hole" => ["into the hole", "the crack runs into a hole"],
        "cracks_joined" => ["cracks join", "the cracks have joined"],
        "crack_length_reached" => ["length asked for", "the crack has the length that was asked for"],
        "run_out" => ["cycles asked for", "the cycles that were asked for are over"],
        "nothing_ages" => ["no growth", "no crack grows"],
        "ligament_unresolved" => ["ligament not resolved", "the rest of the section is less than a spacing wide"],
        "left_refinement" => ["left the refined part", "the crack has left the refined part of the plate"],
        "no_growth" => ["stands still", "no tip grew any more, though bonds went on breaking"],
        "no_convergence" => ["no convergence", "the equations could not be solved any further"],
        _ => ["end of the run", "the run ended"],
    }
}

/// Whether lengths are told by tip: a plate with several, whose sum is nobody's crack.
fn by_tip(result: &Value, tables: &RunTables) -> bool {
    tables.tips.len() > 1 && result["tips"].as_array().is_some_and(|tips| tips.iter().any(|tip| !tip["crack"].is_null()))
}

/// The curves of a chart over cycles: length at every row, mm, and whether it ends the life.
fn lengths(result: &Value, tables: &RunTables) -> Vec<(Vec<f64>, bool)> {
    if !by_tip(result, tables) {
        return vec![(tables.rows.iter().map(|row| row.crack_length_mm).collect(), true)];
    }
    let leads = |tip: usize| result["tips"][tip]["leads"] == true;
    let of_tip = |(tip, rows): (usize, &super::tables::TipRows)| (rows.growth_mm.clone(), leads(tip));
    tables.tips.iter().enumerate().map(of_tip).collect()
}

/// Cycles and length, by a monotone cubic between rows: `[cycles, length]`.
pub fn smooth(cycles: &[f64], lengths: &[f64]) -> Vec<Point> {
    let known = || lengths.iter().zip(cycles).filter(|(length, cycles)| length.is_finite() && cycles.is_finite());
    let rows: Vec<Point> = known().map(|(length, cycles)| [*length, *cycles]).collect();
    let is_rising = rows.windows(2).all(|pair| pair[0][0] <= pair[1][0] && pair[0][1] <= pair[1][1]);
    if rows.len() > DENSE || !is_rising {
        return rows.into_iter().map(|[length, cycles]| [cycles, length]).collect();
    }
    let table = Monotone::new(rows.iter().copied());
    let between = |place: usize| {
        let (table, rows) = (&table, &rows);
        (0..PARTS).map(move |part| {
            let share = part as f64 / PARTS as f64;
            [table.between(place, share), rows[place][0] + share * (rows[place + 1][0] - rows[place][0])]
        })
    };
    let inner = (0..rows.len().saturating_sub(1)).flat_map(between);
    inner.chain(rows.last().map(|[length, cycles]| [*cycles, *length])).collect()
}

fn parts(pixels: f64, each: f64) -> f64 {
    (pixels / each).clamp(2.0, 6.0)
}

/// Names of the tips whose curves end within a fiftieth of the chart of each other, so that both could not be told apart.
fn tips_together(ends: &[(usize, Point)], spans: Point) -> Vec<(String, Point)> {
    let mut groups: Vec<(Vec<usize>, Point)> = Vec::new();
    for (tip, end) in ends {
        let is_near = |(_, other): &&mut (Vec<usize>, Point)| (0..2).all(|i| (other[i] - end[i]).abs() < 0.02 * spans[i]);
        match groups.iter_mut().find(is_near) {
            Some((tips, _)) => tips.push(*tip),
            None => groups.push((vec![*tip], *end)),
        }
    }
    let name = |tips: &[usize]| match tips {
        [tip] => format!("tip {tip}"),
        tips => format!("tips {}", tips.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    };
    groups.into_iter().map(|(tips, end)| (name(&tips), end)).collect()
}

/// Largest distance of points along both axes.
fn spans(points: &[Point]) -> Point {
    [0, 1].map(|axis| {
        let values = || points.iter().map(|point| point[axis]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    })
}

/// Crack length over cycles: band of the specimens where there is one, curve, and a cross at the end with the reason.
pub fn a_n_svg(result: &Value, tables: &RunTables, size: Size) -> String {
    let [_, sentence] = end_words(result["stop_reason"].as_str().unwrap_or(""));
    let name = if by_tip(result, tables) { "Growth of each tip" } else { "Crack length" };
    a_n(result, tables, size).finish(&format!("{name} in mm over cycles to {:.0}; it ends because {sentence}", tables.life()))
}

/// The same with a dot on every curve that follows the cycles.
pub(super) fn a_n_moving(result: &Value, tables: &RunTables, size: Size) -> Sketch {
    let mut frame = a_n(result, tables, size);
    let life = tables.life();
    let times: Vec<f64> = tables.rows.iter().map(|row| row.cycles / life).collect();
    for (lengths, _) in lengths(result, tables) {
        let places: Vec<Point> = tables.rows.iter().zip(lengths).map(|(row, length)| frame.at([row.cycles, length])).collect();
        frame.sketch().moving(&places, &times, 4.5, COMPUTED);
    }
    frame.into_sketch()
}

fn a_n(result: &Value, tables: &RunTables, size: Size) -> Frame {
    let curves = lengths(result, tables);
    let cycles: Vec<f64> = tables.rows.iter().map(|row| row.cycles).collect();
    let ends = tables.band.iter().flatten().flatten().copied();
    let all_cycles = cycles.iter().copied().chain(ends).chain([0.0]);
    let all_lengths: Vec<f64> = curves.iter().flat_map(|(lengths, _)| lengths.iter().copied()).collect();
    let axes = [
        Axis::linear_in(all_cycles, parts(size.width, 95.0)),
        Axis::linear_in(all_lengths.into_iter(), parts(size.height, 45.0)),
    ];
    let is_by_tip = curves.len() > 1;
    let names = ["Cycles N", if is_by_tip { "Growth of each tip, mm" } else { "Crack length a, mm" }];
    let mut frame = Frame::with_names(size, axes, names, if is_by_tip { 9 } else { 0 });
    for (lengths, leads) in &curves {
        if let Some(band) = tables.band.as_ref().filter(|_| *leads) {
            let of = |end: usize| smooth(&band.iter().map(|ends| ends[end]).collect::<Vec<_>>(), lengths);
            frame.band(&of(0), &of(1), BAND);
        }
    }
    if let Some(from) = result["plastic_zone"]["too_large_from_mm"].as_f64().filter(|_| !is_by_tip) {
        let begins = result["plastic_zone"]["too_large_to_mm"].as_f64();
        frame.limit(
            begins.unwrap_or(from),
            if begins.is_some() { "small-scale yielding begins" } else { "small-scale yielding ends" },
        );
    }
    for (lengths, _) in &curves {
        frame.line(&smooth(&cycles, lengths), COMPUTED, 2.0, "");
    }
    let [why, _] = end_words(result["stop_reason"].as_str().unwrap_or(""));
    let mut ends = Vec::new();
    let mut is_ended = false;
    for (tip, (lengths, leads)) in curves.iter().enumerate() {
        let last = [tables.life(), lengths.last().copied().unwrap_or(f64::NAN)];
        if *leads && !is_ended {
            frame.end(last, why);
            is_ended = true;
        }
        ends.push((tip, last));
    }
    if is_by_tip {
        let all: Vec<Point> = ends.iter().map(|(_, end)| *end).chain([[0.0; 2]]).collect();
        tips_together(&ends, spans(&all)).iter().for_each(|(name, end)| frame.name(*end, name, COMPUTED));
    }
    frame
}

/// K_I and K_II of every tip at maximum load over crack length; `None` where no K was read.
pub fn k_svg(result: &Value, tables: &RunTables, size: Size) -> Option<String> {
    let is_by_tip = by_tip(result, tables);
    let length: Vec<f64> = tables.rows.iter().map(|row| row.crack_length_mm).collect();
    let along = |tip: usize| if is_by_tip { &tables.tips[tip].growth_mm } else { &length };
    let points = |tip: usize, mode: usize| -> Vec<Point> {
        along(tip).iter().zip(&tables.tips[tip].factors).map(|(length, factors)| [*length, factors[mode]]).collect()
    };
    // Tips of a standard specimen are alike: the first stands for both.
    let tips: Vec<usize> = (0..if is_by_tip { tables.tips.len() } else { 1.min(tables.tips.len()) }).collect();
    let known = |point: &Point| point.iter().all(|value| value.is_finite());
    let read: Vec<Point> = tips.iter().flat_map(|tip| [0, 1].map(|mode| points(*tip, mode))).flatten().filter(known).collect();
    if read.is_empty() {
        return None;
    }
    let mut sizes: Vec<f64> = read.iter().map(|point| point[1].abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let [usual, largest] = [sizes[(sizes.len() - 1) * USUAL_PERCENT / 100], sizes[sizes.len() - 1]];
    // Where the last of a section goes K grows beyond bounds, and would hide all before it.
    let most = if largest > BEYOND * usual && usual > 0.0 { BEYOND * usual } else { largest };
    let points = |tip: usize, mode: usize| -> Vec<Point> {
        points(tip, mode).into_iter().map(|[x, k]| [x, if k.abs() <= most { k } else { f64::NAN }]).collect()
    };
    let all: Vec<Point> = read.into_iter().filter(|point| point[1].abs() <= most).collect();
    let axes = [
        Axis::linear_in(all.iter().map(|point| point[0]), parts(size.width, 95.0)),
        Axis::linear_in(all.iter().map(|point| point[1]).chain([0.0]), parts(size.height, 45.0)),
    ];
    let names = [if is_by_tip { "Growth of the tip, mm" } else { "Crack length a, mm" }, "K at maximum load, MPa√m"];
    let mut frame = Frame::with_names(size, axes, names, if is_by_tip { 13 } else { 4 });
    if let Some([low, high]) = calibrated(result) {
        frame.unknown(high, true, "above the ΔK of the law");
        if tips.iter().any(|tip| points(*tip, 0).iter().any(|point| point[1] < low)) {
            frame.unknown(low, false, "below the ΔK of the law");
        }
    }
    if largest > most {
        frame.remark(&format!("at the end to {largest:.1e}, not drawn"));
    }
    for (mode, colour, dash) in [(1, SECOND, "6 3"), (0, COMPUTED, "")] {
        tips.iter().for_each(|tip| frame.pieces(&points(*tip, mode), colour, 2.0, dash));
    }
    for (mode, name, colour) in [(0, "K_I", COMPUTED), (1, "K_II", SECOND)] {
        let last = |tip: &usize| Some((*tip, points(*tip, mode).into_iter().rfind(known)?));
        let ends: Vec<(usize, Point)> = tips.iter().filter_map(last).collect();
        for (of_tips, end) in tips_together(&ends, spans(&all)) {
            let words = if is_by_tip { format!("{name} {of_tips}") } else { name.to_owned() };
            frame.name(end, &words, colour);
        }
    }
    Some(frame.finish(&format!("{} over {}", names[1], names[0])))
}

/// K at maximum load between which the law was fitted, MPa√m; `None` where that is not known.
fn calibrated(result: &Value) -> Option<[f64; 2]> {
    let law = &result["law"];
    let record = &law["record"];
    let limit = |key: &str| law[key].as_f64().or_else(|| record[key].as_f64());
    let ratio = result["case"]["loading"]["stress_ratio"].as_f64()?;
    let share = 1.0 - ratio.max(0.0);
    Some([limit("delta_k_min_mpa_sqrt_m")? / share, limit("delta_k_max_mpa_sqrt_m")? / share])
}
