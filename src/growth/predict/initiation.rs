//! Phase I of a life: the cycles until the cracks of a case have formed at the rims of holes ([`perilife_laws::initiation::SnLaw`]), before they grow.
//!
//! The plate is solved without the cracks that have tips; cuts between holes, such as a crack that was stopped by drilled holes, stay. The hole with the
//! largest stress decides: once its crack has formed, all cracks of the case are taken to be there, which is on the safe side for the others.

use crate::case::Case;
use crate::stress_concentration::stressed;
use perilife_base::error::{Error, Result, input_missing};
use perilife_base::units::{MM, MPA, round_off};
use perilife_laws::initiation::KEY;
use perilife_nodes::rim_stress::{Rim, StressAt};
use perilife_plate::specimen::geometry::distance;
use perilife_plate::specimen::{CrackLine, Point, Specimen};

/// Distance of an end of a crack from the rim of a hole up to which it starts there, over the radius.
const ON_RIM: f64 = 1e-3;
/// Distance of the largest stress from where a crack starts, over the radius, from which it is worth a word: 15°.
const ASIDE: f64 = 0.26;

/// Phase I of a run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PhaseOne {
    /// Cycles N_I; `None` where no crack forms.
    pub cycles: Option<f64>,
    /// Range of the local stress, Pa.
    pub range: f64,
    /// Local stress at maximum load over the gross stress, where edges carry one.
    pub concentration: Option<f64>,
    /// Where it is, m.
    pub at: Point,
    /// Distance from there to the nearest start of a crack, over the radius of the hole.
    aside: f64,
    /// Whether the stress had settled as nodes got finer.
    is_settled: bool,
}

/// Phase I of a case that has a law for it.
/// Errors: a crack that does not start at a hole; no equilibrium.
pub fn phase_one(case: &Case) -> Result<Option<PhaseOne>> {
    let Some(law) = case.fatigue.initiation else { return Ok(None) };
    let mouths = mouths(&case.specimen)?;
    let mut before = case.clone();
    let cuts: Vec<CrackLine> = case.specimen.crack_lines().into_iter().filter(|line| case.specimen.tips_of(line) == 0).collect();
    before.specimen.set_crack_lines(&cuts);
    before.specimen.tips.clear();
    let found = stressed(&before)?;
    let of_hole = |hole: usize| found.rims.iter().find(|rim| rim.rim == Rim::Hole(hole)).map(|rim| (hole, rim.largest));
    let largest = mouths.iter().filter_map(|(hole, _)| of_hole(*hole)).max_by(|a, b| a.1.stress.total_cmp(&b.1.stress));
    let Some((hole, StressAt { at, stress })) = largest else {
        return Err(Error::Mechanics(format!("{}: the stress at the holes was not read", case.name)));
    };
    let range = (1.0 - case.loading.ratio) * stress.max(0.0);
    let rim = case.specimen.holes[hole];
    // Of two equal peaks at the sides of a hole one is found, and either may have the crack.
    let sides = [at, [2.0 * rim.centre[0] - at[0], at[1]]];
    let aside = |mouth: Point| sides.iter().map(|side| distance(mouth, *side)).fold(f64::INFINITY, f64::min);
    let starts = mouths.iter().filter(|(own, _)| *own == hole).map(|(_, mouth)| aside(*mouth));
    Ok(Some(PhaseOne {
        cycles: law.cycles_at(range),
        range,
        concentration: found.concentration(stress),
        at,
        aside: starts.fold(f64::INFINITY, f64::min) / rim.radius,
        is_settled: found.is_settled(),
    }))
}

/// Hole and place at which every crack with a tip starts.
fn mouths(specimen: &Specimen) -> Result<Vec<(usize, Point)>> {
    let lines = specimen.crack_lines();
    let growing = lines.iter().enumerate().filter(|(_, line)| specimen.tips_of(line) > 0);
    let start = |(i, line): (usize, &CrackLine)| {
        let rim = |end: Point| {
            let is_at = |(_, hole): &(usize, &perilife_plate::specimen::Hole)| {
                (distance(end, hole.centre) - hole.radius).abs() < ON_RIM * hole.radius
            };
            specimen.holes.iter().enumerate().find(is_at).map(|(hole, _)| (hole, end))
        };
        rim(line.end(false)).or_else(|| rim(line.end(true))).ok_or_else(|| {
            let problem = format!("needs the stress at the hole edge where a crack forms, and crack {i} starts at no hole");
            input_missing(KEY, problem, "remove it, or let every crack that grows start at a hole")
        })
    };
    growing.map(start).collect()
}

impl PhaseOne {
    /// What the user should know.
    pub(super) fn warnings(&self, case: &Case) -> Vec<String> {
        let limit = case.fatigue.initiation.map_or(0.0, |law| law.limit);
        let mut words = vec![match self.cycles {
            Some(_) => "initiation: life from the given S-N curve; its scatter is in neither the band nor the error".to_owned(),
            None => format!(
                "initiation: none, local stress range {:.1} MPa ≤ fatigue.initiation.limit_mpa = {:.1} MPa",
                self.range / MPA,
                limit / MPA
            ),
        }];
        if self.aside > ASIDE {
            let [x, y] = self.at.map(|x| x / MM);
            words.push(format!("initiation: the largest stress is at ({x:.2}, {y:.2}) mm, where no crack of the case starts"));
        }
        if !self.is_settled {
            words.push("initiation: the stress at the hole edge still changed by 0.3 % or more on finer nodes".to_owned());
        }
        words.push(format!("initiation: S-N curve assumed valid at R = {}", round_off(case.loading.ratio)));
        let largest = self.range / (1.0 - case.loading.ratio);
        if let Some(strength) = case.material.yield_strength.filter(|strength| largest > *strength) {
            words.push(format!(
                "initiation: elastic local stress {:.1} MPa exceeds the yield strength {:.1} MPa; an elastic S-N curve is not valid there: treat \
                 the initiation life as a guess, or give the curve of tests at the same concentration and load",
                largest / MPA,
                strength / MPA
            ));
        }
        words
    }
}
