//! Double-notch plates of Q345 steel at 0.5 mm (Li, Lü, Huang and Yang 2024, J. Ship Mech. 28:103, section 4).
//!
//! The source prints the load step of the first broken bond. Its increment, 1.5e-7 mm, breaks nothing within its steps; read as
//! 1.5e-5 mm an end the steps agree, read as 1.5e-4 mm the plates break at the grips after 300. What does not come out: with notches
//! 10 mm apart in height its cracks link at 45°; here they bend towards each other, pass, and run to the far sides.

use super::fracture_scenes::{run, way};
use perilife_scenes::outcome::HistoryRow;
use perilife_scenes::{Fracture, SceneEnd};

/// Load step of the first broken bond, against the source's in percent.
fn onset(run: &Fracture, name: &str, source: f64, percent: f64) -> usize {
    let onset = run.onset_step.unwrap_or_else(|| panic!("{name}: nothing broke"));
    let off = 100.0 * (onset as f64 / source - 1.0);
    println!("{name}: first bond at step {onset}, source {source}, {off:+.1} %; in two at {:?}", run.separated_step);
    assert!(off.abs() <= percent, "{name}: first bond at step {onset}, source {source}");
    onset
}

/// The load grows linearly, then less and less (hardening), then falls.
fn assert_load_curve(run: &Fracture, name: &str) {
    let rows = &run.history;
    let peak = rows.iter().max_by(|a, b| a.load.total_cmp(&b.load)).unwrap();
    let at = |share: f64| rows.iter().find(|row| row.displacement >= share * peak.displacement).unwrap();
    let slope = |a: &HistoryRow, b: &HistoryRow| (b.load - a.load) / (b.displacement - a.displacement);
    let start = slope(at(0.1), at(0.3));
    assert!((slope(at(0.3), at(0.6)) / start - 1.0).abs() < 0.02, "{name}: linear to 0.6 of the peak's displacement");
    let late = slope(at(0.93), peak) / start;
    assert!((0.1..0.9).contains(&late), "{name}: slope before the peak {late:.2} of that at the start");
    assert!(rows.last().unwrap().load < 0.5 * peak.load, "{name}: falls after the peak");
}

/// The last picture up to which damage is its own image under `image` (place in the grid to place), to 1e-9, and its step;
/// pictures without damage count.
fn symmetric_until(run: &Fracture, image: impl Fn(usize, usize) -> (usize, usize)) -> (usize, f64) {
    let grid = &run.grid;
    let same = |damage: &[f64]| {
        let at = |(column, row): (usize, usize)| grid.point_at[row * grid.columns + column].map_or(0.0, |p| damage[p as usize]);
        (0..grid.rows).all(|y| (0..grid.columns).all(|x| (at((x, y)) - at(image(x, y))).abs() <= 1e-9))
    };
    let kept: Vec<_> = run.snapshots.iter().take_while(|state| same(&state.damage)).collect();
    let damaged = kept.iter().filter(|state| state.damage.iter().any(|d| *d > 0.0)).count();
    (damaged, kept.last().map_or(0.0, |state| state.cycles))
}

/// The path of equilibrium on points of so many mm is linear, hardens and falls.
fn coarse(spacing: f64) -> Fracture {
    let path = run("q345_coarse", &[&format!("model.spacing_mm={spacing}")]);
    assert_load_curve(&path, "q345_coarse");
    assert_eq!((path.end, path.separated_step), (SceneEnd::Separated, path.history.last().map(|row| row.step)));
    path
}

#[test]
fn load_curves() {
    coarse(2.0);
}

/// Steps that do not come to rest carry 7 % more (20 % at 0.5 mm): damage lags behind the load.
#[test]
#[ignore = "long: a minute"]
fn steps_that_do_not_come_to_rest_carry_more() {
    let path = coarse(1.0);
    let march = run("q345_offset_0", &["model.spacing_mm=1.0"]);
    let over = march.peak_load() / path.peak_load();
    println!("peak of the path {:.0} N, of the march {over:.3} times that", path.peak_load());
    assert!((1.04..1.1).contains(&over), "{over}");
}

/// Level notches of 10 mm, 0, 10 and 20 mm apart in height: straight through, past each other, to the far sides; the plate lasts
/// the longer the farther they are apart.
#[test]
#[ignore = "long: three plates of 0.5 mm, a minute"]
fn notches_apart_in_height() {
    let level = run("q345_offset_0", &[]);
    for tip in 0..2 {
        assert!(way(&level, tip).iter().all(|place| place[1].abs() < 1.0), "tip {tip} leaves the line of the notches");
    }
    let size = [level.grid.columns, level.grid.rows];
    let (damaged, last) = symmetric_until(&level, |x, y| (size[0] - 1 - x, y));
    println!("q345_offset_0: mirrored to step {last}, {damaged} pictures with broken bonds");
    assert!(damaged > 0 && last as usize >= level.separated_step.unwrap(), "mirrored to step {last}, until it is in two");

    let near = run("q345_offset_10", &[]);
    let near_onset = onset(&near, "q345_offset_10", 2100.0, 2.0);
    let (left, right) = (way(&near, 0), way(&near, 1));
    let bend = [left.last().unwrap()[1] + 5.0, 5.0 - right.last().unwrap()[1]];
    assert!(bend.iter().all(|bend| (0.5..4.0).contains(bend)), "towards each other, but past: {bend:?} mm");
    let far = run("q345_offset_20", &[]);
    let far_onset = onset(&far, "q345_offset_20", 2230.0, 6.0);
    for (tip, height) in [(0, -10.0), (1, 10.0)] {
        assert!(way(&far, tip).iter().all(|place| (place[1] - height).abs() < 1.0), "20 mm apart: tip {tip} runs straight");
    }
    assert!(near_onset < far_onset, "{near_onset} {far_onset}");
    assert!(level.separated_step.unwrap() < far.separated_step.unwrap());
}

/// Notches of 5 and 5, 5 and 10 mm: short ones start later and carry more, and of unequal ones the longer starts first.
#[test]
#[ignore = "long: ten seconds"]
fn notches_of_other_lengths() {
    let short = run("q345_lengths_5_5", &[]);
    let short_onset = onset(&short, "q345_lengths_5_5", 2400.0, 10.0);
    let unequal = run("q345_lengths_5_10", &[]);
    let unequal_onset = onset(&unequal, "q345_lengths_5_10", 2100.0, 2.0);
    assert!(unequal_onset < short_onset && unequal.peak_load() < short.peak_load());
    let started = |tip: usize| unequal.path.iter().find(|place| place.tip == tip && place.step > 0).unwrap().step;
    assert!(started(1) < started(0), "the longer one is the right one");
    assert!(unequal.separated_step.unwrap() < short.separated_step.unwrap());
}

/// A level notch and a slanting one: cracks leave the slanting one first; its angle changes neither the way nor the life much.
#[test]
#[ignore = "long: three plates of 0.5 mm, a minute"]
fn slanting_notches() {
    let plates = [("q345_angle_30", Some(2220.0)), ("q345_angle_45", None), ("q345_angle_60", Some(2150.0))];
    let separated = plates.map(|(name, source)| {
        let run = run(name, &[]);
        // Earlier than in the source, probably since the corner of the slanting notch is sharper than its level end.
        if let Some(source) = source {
            onset(&run, name, source, 13.0);
        }
        let first = run.snapshots.iter().find(|state| state.damage.iter().any(|d| *d > 0.0)).unwrap();
        let mut worst = (0.0, 0.0);
        for (place, point) in run.grid.point_at.iter().enumerate() {
            let y = run.grid.origin[1] + (place / run.grid.columns) as f64 * run.grid.spacing;
            let damage = point.map_or(0.0, |p| first.damage[p as usize]);
            worst = if damage > worst.1 { (y, damage) } else { worst };
        }
        assert!(worst.0 > 0.0, "{name}: first damage at a height of {} m", worst.0);
        run.separated_step.unwrap() as f64
    });
    let (least, most) = separated.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), s| (a.min(*s), b.max(*s)));
    assert!(most < 1.05 * least, "in two at {separated:?}");
}
