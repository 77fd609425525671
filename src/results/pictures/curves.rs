//! Pictures `a_n.svg` and `k.svg` of a run.

use crate::axis::Axis;
use crate::chart::{COLOURS, COMPUTED, Frame, SECOND, Size};
use crate::curve::RunTables;
use crate::record::RunRecord;
use crate::specimen_picture::sketch::Sketch;
use perilife_base::monotone::Monotone;
use perilife_growth::predict::StopReason;
use perilife_plate::specimen::Point;

/// Color of K at the deepest point of a part-through crack.
const THIRD: &str = COLOURS[2];
const BAND: f64 = 0.18;
/// Segments of the cubic between two rows.
const PARTS: usize = 8;
/// Number of rows from which a polyline is smooth enough.
const DENSE: usize = 200;

/// Percentile of K, and its multiple up to which K is drawn.
const USUAL_PERCENT: usize = 90;
/// See [`USUAL_PERCENT`].
const BEYOND: f64 = 10.0;

/// Why a run ended: label of a picture, and at length.
pub fn end_words(reason: StopReason) -> [&'static str; 2] {
    match reason {
        StopReason::Toughness => ["fracture", "fracture: toughness K_c reached"],
        StopReason::NetSectionYield => ["net-section yield", "net-section yield"],
        StopReason::Severed => ["separation", "complete separation"],
        StopReason::LeftPlate => ["at the edge", "the crack reached the edge"],
        StopReason::EnteredHole => ["at the hole", "the crack entered a hole"],
        StopReason::CracksJoined => ["link-up", "the cracks linked up"],
        StopReason::CrackLengthReached => ["length limit", "crack length limit reached"],
        StopReason::CrackDepthReached => ["depth limit", "crack depth limit reached"],
        StopReason::BrokenThrough => ["breakthrough", "breakthrough"],
        StopReason::RequiredStrength => ["required strength", "residual strength fell below the required strength"],
        StopReason::RunOut => ["run-out", "cycle limit reached (run-out)"],
        StopReason::NothingAges => ["no growth", "no crack grows"],
        StopReason::LigamentUnresolved => ["ligament not resolved", "ligament smaller than the point spacing"],
        StopReason::NoGrowth => ["no growth", "bonds broke without crack growth"],
        StopReason::NoConvergence => ["no convergence", "the solver did not converge"],
        StopReason::Stopped => ["stopped", "stopped by a user"],
    }
}

/// What curves are drawn over, in words.
pub fn length_name(run: &RunRecord, tables: &RunTables) -> &'static str {
    if by_tip(run, tables) { "Crack extension of each tip" } else { "Crack length" }
}

/// Whether lengths are drawn by tip: the sum over several cracks is the length of none.
fn by_tip(run: &RunRecord, tables: &RunTables) -> bool {
    tables.tips.len() > 1 && run.tips.iter().any(|tip| tip.crack.is_some())
}

/// The curves of a chart against cycles: length at every row, mm, and whether its tip governs.
fn lengths(run: &RunRecord, tables: &RunTables) -> Vec<(Vec<f64>, bool)> {
    if !by_tip(run, tables) {
        return vec![(tables.rows.iter().map(|row| row.crack_length_mm).collect(), true)];
    }
    let leads = |tip: usize| run.tips.get(tip).is_some_and(|tip| tip.leads);
    let of_tip = |(tip, rows): (usize, &crate::curve::TipRows)| (rows.growth_mm.clone(), leads(tip));
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

pub(super) fn parts(pixels: f64, each: f64) -> f64 {
    (pixels / each).clamp(2.0, 6.0)
}

/// Colors of the curves of the tips; tips with equal growth share one.
fn colours(tables: &RunTables) -> Vec<&'static str> {
    let ends: Vec<f64> = tables.tips.iter().map(|tip| tip.growth_mm.last().copied().unwrap_or(0.0)).collect();
    let near = 0.02 * ends.iter().fold(0.0, |a: f64, b| a.max(*b));
    let first = |tip: usize| ends.iter().position(|end| (end - ends[tip]).abs() <= near).unwrap_or(tip);
    let firsts: Vec<usize> = (0..ends.len()).filter(|tip| first(*tip) == *tip).collect();
    let place = |tip| firsts.iter().position(|own| *own == first(tip)).unwrap_or(0);
    (0..ends.len().max(1)).map(|tip| COLOURS[if ends.is_empty() { 0 } else { place(tip) } % COLOURS.len()]).collect()
}

/// Labels of the tips; curves that end within 2 % of the chart of each other share one.
fn tips_together(ends: &[(usize, Point)], spans: Point, colours: &[&'static str]) -> Vec<(String, Point, &'static str)> {
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
    groups.into_iter().map(|(tips, end)| (name(&tips), end, colours[tips[0]])).collect()
}

fn spans(points: &[Point]) -> Point {
    [0, 1].map(|axis| {
        let values = || points.iter().map(|point| point[axis]);
        values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
    })
}

/// Crack length against cycles: scatter band if any, curve, and a cross at the end with the reason.
pub fn a_n_svg(run: &RunRecord, tables: &RunTables, size: Size) -> String {
    let [_, sentence] = end_words(run.stop_reason);
    let name = length_name(run, tables);
    a_n(run, tables, size).finish(&format!("{name} in mm against cycles to {:.0}; end of analysis: {sentence}", tables.life()))
}

/// The same with a dot on every curve that follows the cycles.
pub(super) fn a_n_moving(run: &RunRecord, tables: &RunTables, size: Size) -> Sketch {
    let mut frame = a_n(run, tables, size);
    let life = tables.life();
    let times: Vec<f64> = tables.rows.iter().map(|row| row.cycles / life).collect();
    for (lengths, _) in lengths(run, tables) {
        let places: Vec<Point> = tables.rows.iter().zip(lengths).map(|(row, length)| frame.at([row.cycles, length])).collect();
        frame.sketch().moving(&places, &times, 4.5, COMPUTED);
    }
    frame.into_sketch()
}

fn a_n(run: &RunRecord, tables: &RunTables, size: Size) -> Frame {
    let curves = lengths(run, tables);
    let cycles: Vec<f64> = tables.rows.iter().map(|row| row.cycles).collect();
    let ends = tables.band.iter().flatten().flatten().copied();
    let all_cycles = cycles.iter().copied().chain(ends).chain([0.0]);
    let all_lengths: Vec<f64> = curves.iter().flat_map(|(lengths, _)| lengths.iter().copied()).collect();
    let axes = [
        Axis::linear_in(all_cycles, parts(size.width, 95.0)),
        Axis::linear_in(all_lengths.into_iter(), parts(size.height, 45.0)),
    ];
    let is_by_tip = curves.len() > 1;
    let names = ["Cycles N", if is_by_tip { "Crack extension of each tip, mm" } else { "Crack length a, mm" }];
    let mut frame = Frame::with_names(size, axes, names, if is_by_tip { 9 } else { 0 });
    for (lengths, leads) in &curves {
        if let Some(band) = tables.band.as_ref().filter(|_| *leads) {
            let of = |end: usize| smooth(&band.iter().map(|ends| ends[end]).collect::<Vec<_>>(), lengths);
            frame.band(&of(0), &of(1), BAND);
        }
    }
    if let Some((from, zone)) =
        run.plastic_zone.as_ref().and_then(|zone| Some((zone.too_large_from_mm?, zone))).filter(|_| !is_by_tip)
    {
        let begins = zone.too_large_to_mm;
        frame.limit(begins.unwrap_or(from), if begins.is_some() { "LEFM valid from here" } else { "LEFM valid up to here" });
    }
    let lines: Vec<Vec<Point>> = curves.iter().map(|(lengths, _)| smooth(&cycles, lengths)).collect();
    let colours = colours(tables);
    let drawn = lines.iter().zip(colours.iter().chain(std::iter::repeat(&COMPUTED)));
    drawn.for_each(|(line, colour)| frame.line(line, if is_by_tip { colour } else { COMPUTED }, 2.0, ""));
    let [why, _] = end_words(run.stop_reason);
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
        frame.names(&tips_together(&ends, spans(&all), &colours), &lines);
    }
    frame
}

/// `k.svg`: K_I and K_II of every tip at maximum load against crack length; `None` if no K was computed.
pub fn k_svg(run: &RunRecord, tables: &RunTables, size: Size) -> Option<String> {
    let is_by_tip = by_tip(run, tables);
    let length: Vec<f64> = tables.rows.iter().map(|row| row.crack_length_mm).collect();
    let along = |tip: usize| if is_by_tip { &tables.tips[tip].growth_mm } else { &length };
    let points = |tip: usize, mode: usize| -> Vec<Point> {
        along(tip).iter().zip(&tables.tips[tip].factors).map(|(length, factors)| [*length, factors[mode]]).collect()
    };
    // Tips of a standard specimen are equal by symmetry.
    let tips: Vec<usize> = (0..if is_by_tip { tables.tips.len() } else { 1.min(tables.tips.len()) }).collect();
    let known = |point: &Point| point.iter().all(|value| value.is_finite());
    let in_depth = tables.depth_factors.iter().flatten().zip(&length).map(|(k, length)| [*length, *k]);
    let in_depth: Vec<Point> = in_depth.collect();
    let read: Vec<Point> = tips
        .iter()
        .flat_map(|tip| [0, 1].map(|mode| points(*tip, mode)))
        .flatten()
        .chain(in_depth.iter().copied())
        .filter(known)
        .collect();
    if read.is_empty() {
        return None;
    }
    let mut sizes: Vec<f64> = read.iter().map(|point| point[1].abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let [usual, largest] = [sizes[(sizes.len() - 1) * USUAL_PERCENT / 100], sizes[sizes.len() - 1]];
    // K diverges as the ligament vanishes; at full scale it would flatten the rest.
    let most = if largest > BEYOND * usual && usual > 0.0 { BEYOND * usual } else { largest };
    let points = |tip: usize, mode: usize| -> Vec<Point> {
        points(tip, mode).into_iter().map(|[x, k]| [x, if k.abs() <= most { k } else { f64::NAN }]).collect()
    };
    let all: Vec<Point> = read.into_iter().filter(|point| point[1].abs() <= most).collect();
    let axes = [
        Axis::linear_in(all.iter().map(|point| point[0]), parts(size.width, 95.0)),
        // A K_II of rounding errors does not extend the axis below zero.
        Axis::linear_in(
            all.iter().map(|point| point[1]).filter(|k| k.abs() > 0.005 * most).chain([0.0]),
            parts(size.height, 45.0),
        ),
    ];
    let names = [if is_by_tip { "Crack extension of the tip, mm" } else { "Crack length a, mm" }, "K at maximum load, MPa√m"];
    let mut frame = Frame::with_names(size, axes, names, if is_by_tip { 13 } else { 5 });
    if let Some([low, high]) = calibrated(run) {
        frame.unknown(high, true, "above the tested ΔK");
        if tips.iter().any(|tip| points(*tip, 0).iter().any(|point| point[1] < low)) {
            frame.unknown(low, false, "below the tested ΔK");
        }
    }
    if largest > most {
        frame.remark(&format!("rises to {largest:.1e} (off scale)"));
    }
    let mut lines: Vec<Vec<Point>> = Vec::new();
    let mut named_ends: Vec<(String, Point, &str)> = Vec::new();
    let of_tips = colours(tables);
    for (mode, name, dash) in [(1, "K_II", "6 3"), (0, "K_I", "")] {
        let colour = |tip: usize| match (is_by_tip, mode) {
            (true, _) => of_tips[tip],
            (false, 0) => COMPUTED,
            (false, _) => SECOND,
        };
        for &tip in &tips {
            let line = points(tip, mode);
            frame.pieces(&line, colour(tip), 2.0, dash);
            lines.push(line);
        }
        let last = |tip: &usize| Some((*tip, points(*tip, mode).into_iter().rfind(known)?));
        let ends: Vec<(usize, Point)> = tips.iter().filter_map(last).collect();
        let named = |(tips, end, of_group): (String, Point, &'static str)| match is_by_tip {
            true => (format!("{name} {tips}"), end, of_group),
            false => (name.to_owned(), end, colour(0)),
        };
        named_ends.extend(tips_together(&ends, spans(&all), &of_tips).into_iter().map(named));
    }
    if let Some(through) = run.part_through.as_ref().and_then(|found| found.crack_length_at_break_through_mm) {
        frame.mark(through, "breakthrough");
    }
    if let Some(last) = in_depth.iter().rfind(|point| known(point)) {
        frame.pieces(&in_depth, THIRD, 2.0, "2 3");
        named_ends.push(("K_I at depth".to_owned(), *last, THIRD));
    }
    frame.names(&named_ends, &lines);
    Some(frame.finish(&format!("{} against {}", names[1], names[0])))
}

/// K at maximum load between which the law was fitted, MPa√m; `None` where that is not known.
fn calibrated(run: &RunRecord) -> Option<[f64; 2]> {
    let share = 1.0 - run.case["loading"]["stress_ratio"].as_f64()?.max(0.0);
    Some(run.law.range()?.map(|k| k / share))
}
