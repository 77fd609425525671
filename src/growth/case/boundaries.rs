//! Warnings of a case outside the validated range of its method ([`perilife_base::limits`]), and of a plate that fails in the first cycle.

use super::{Case, Engine, Method};
use crate::case::LawSource;
use perilife_base::limits;
use perilife_base::units::round_mm;
use perilife_base::units::{KN, MPA, MPA_SQRT_M};
use perilife_laws::Ageing;
use perilife_nodes::basis::BasisKind;
use perilife_plate::material::Plane;
use perilife_plate::specimen::LoadMeasure;
use perilife_plate::specimen::geometry::{distance, edges, meeting_share, segments_touch};
use perilife_plate::specimen::handbook::handbook;
use perilife_plate::specimen::{FrontTip, PartThrough, Point, Specimen};
use perilife_points::bond_law::BondLawKind;

/// A warning for every validated range that the case is outside of.
pub(super) fn lines(case: &Case) -> Vec<String> {
    let mut lines = Vec::new();
    match case.engine() {
        Engine::Handbook | Engine::PartThrough => {}
        Engine::Nodes => {
            lines.extend(influence_line(case));
            lines.extend(poisson_line(case, Some("element_free_galerkin")));
        }
        Engine::Points => {
            lines.extend(horizon_lines(case));
            lines.extend(ratio_line(case, "tip_field"));
            lines.extend(poisson_line(case, law_name(case)));
            lines.extend(step_line(case));
            lines.extend(exponent_line(case, "exponent", "tip_field"));
        }
        Engine::BondsThenPoints => {
            lines.extend(ratio_line(case, "tip_field"));
            lines.extend(exponent_line(case, "exponent", "tip_field"));
        }
        // `coarse_line` warns of their horizon ratio.
        Engine::Bonds => lines.extend(match case.fatigue.ageing {
            Ageing::Everywhere => exponent_line(case, "ageing", "bond_strain, ageing everywhere"),
            Ageing::CrackTip => exponent_line(case, "exponent", "bond_strain by its own strain"),
        }),
    }
    lines
}

/// Bond law of a case that gives none, as the sweeps over Poisson's ratio name it.
const BY_PROGRAM: &str = "law chosen by the program";

/// The law of a case as the sweeps over Poisson's ratio name it.
fn law_name(case: &Case) -> Option<&'static str> {
    match case.choices.bond_law {
        None => Some(BY_PROGRAM),
        Some(BondLawKind::TwoParameter) => Some("two_parameter"),
        Some(BondLawKind::StateBased) => Some("state_based"),
        Some(BondLawKind::OneBondTwoParameter) => Some("one_bond_two_parameter"),
        Some(BondLawKind::BondBased) => None,
    }
}

/// The horizon against crack, ligament, hole and other cracks.
fn horizon_lines(case: &Case) -> Vec<String> {
    let specimen = &case.specimen;
    let horizon = case.points().horizon_ratio * case.points().spacing;
    let sizes = |has_one_tip: bool| {
        let lines = specimen.crack_lines();
        let of_kind = lines.into_iter().filter(|line| (specimen.tips_of(line) == 1) == has_one_tip);
        of_kind.map(|line| line.length() / specimen.tips_of(&line).max(1) as f64).fold(f64::INFINITY, f64::min)
    };
    let diameter = specimen.holes.iter().map(|hole| 2.0 * hole.radius).fold(f64::INFINITY, f64::min);
    let Gaps { ligament, hole, crack } = Gaps::of(specimen);
    let resolved = [
        ("crack_length", "half crack length", sizes(false)),
        ("edge_crack_length", "length of an edge crack", sizes(true)),
        ("ligament", "ligament ahead of a tip", ligament),
        ("hole_distance", "distance to a hole", hole),
        ("hole_diameter", "diameter of a hole", diameter),
        ("crack_distance", "distance to another crack", crack),
    ];
    let line = |(sweep, what, length): (&str, &str, f64)| {
        let limit = limits::of(sweep, "tip_field")?;
        let end = limit.passed(horizon / length)?;
        Some(format!(
            "horizon {} mm is {:.2} of the {what}, {} mm; beyond {end} the error of K exceeds {} % (m times that in da/dN); reduce model.spacing_mm",
            round_mm(horizon),
            horizon / length,
            round_mm(length),
            limit.bound_percent
        ))
    };
    resolved.into_iter().filter_map(line).collect()
}

/// Least distances of the tips from what lies around them, m; infinite where there is nothing.
struct Gaps {
    /// To the outline straight ahead.
    ligament: f64,
    /// To the rim of a hole that the crack does not start from.
    hole: f64,
    crack: f64,
}

impl Gaps {
    fn of(specimen: &Specimen) -> Gaps {
        let lines = specimen.crack_lines();
        let mut gaps = Gaps { ligament: f64::INFINITY, hole: f64::INFINITY, crack: f64::INFINITY };
        for tip in 0..specimen.tips.len() {
            let Some(end) = specimen.line_end(tip) else { continue };
            let line = &lines[end.line];
            let at = line.end(end.at_last);
            gaps.ligament = gaps.ligament.min(ahead(specimen, at, specimen.tips[tip].direction));
            let others = lines.iter().enumerate().filter(|(other, _)| *other != end.line);
            gaps.crack = others.map(|(_, other)| other.distance(at)).fold(gaps.crack, f64::min);
            // The mouth of the crack may lie on a hole.
            let mouth = line.end(!end.at_last);
            let holes = specimen.holes.iter().filter(|hole| distance(mouth, hole.centre) >= hole.radius * (1.0 + 1e-6));
            gaps.hole = holes.map(|hole| distance(at, hole.centre) - hole.radius).fold(gaps.hole, f64::min);
        }
        gaps
    }
}

/// Way from a tip to the outline straight ahead, m.
fn ahead(specimen: &Specimen, at: Point, [x, y]: Point) -> f64 {
    let reach = specimen.gross_width + specimen.length();
    let far = [at[0] + reach * x, at[1] + reach * y];
    let met = edges(&specimen.outline).filter(|(a, b)| segments_touch(at, far, *a, *b));
    met.filter_map(|(a, b)| meeting_share(at, far, a, b)).map(|share| share * reach).fold(f64::INFINITY, f64::min)
}

/// Horizon over spacing.
fn ratio_line(case: &Case, method: &str) -> Option<String> {
    let ratio = case.points().horizon_ratio;
    let limit = limits::of("horizon_ratio", method)?;
    let end = limit.passed(ratio)?;
    Some(format!("model.horizon_ratio {ratio}: beyond {end} the life error exceeds {} %; use 3.015", limit.bound_percent))
}

fn poisson_line(case: &Case, method: Option<&str>) -> Option<String> {
    let nu = case.material.poisson_ratio;
    let (sweep, plane) = match case.material.plane {
        Plane::Stress => ("nu_plane_stress", "stress"),
        Plane::Strain => ("nu_plane_strain", "strain"),
    };
    let limit = limits::of(sweep, method?)?;
    let end = limit.passed(nu)?;
    let what = if case.model.method() == Method::ElementFreeGalerkin { "the error of K" } else { "the life error at m = 3" };
    Some(format!("ν {nu} in plane {plane}: beyond {end} {what} exceeds {} %", limit.bound_percent))
}

/// Whether the Poisson's ratio of a case is within the safe range of peridynamics, so that it can serve as a cross-check.
pub fn suits_points(case: &Case) -> bool {
    poisson_line(case, Some(BY_PROGRAM)).is_none()
}

/// Length of cycle blocks.
fn step_line(case: &Case) -> Option<String> {
    let error = case.fatigue.step_error_percent;
    let passed = ["growth_step", "severing_step"].into_iter().find_map(|sweep| {
        let limit = limits::of(sweep, "tip_field")?;
        limit.ends[1].filter(|high| error > *high).map(|high| (high, limit.bound_percent))
    });
    let (end, bound) = passed?;
    Some(format!(
        "fatigue.step_error_percent {error}: beyond {end} increments are too long (life error over {bound} %); use a smaller value"
    ))
}

fn exponent_line(case: &Case, sweep: &str, method: &str) -> Option<String> {
    let exponent = match &case.law {
        LawSource::Inline(law) => law.p,
        LawSource::Paris(law) => law.m,
        LawSource::Fitted(record) => record.p,
        LawSource::Factor(_) | LawSource::Missing(_) => return None,
    };
    let limit = limits::of(sweep, method)?;
    let bound = limit.bound_percent;
    if limit.is_safe == Some(false) {
        return Some(format!("{method}: the life error exceeds {bound} % at every exponent tested"));
    }
    let end = limit.passed(exponent)?;
    Some(format!("exponent {exponent} by {method}: beyond {end} the life error exceeds {bound} %"))
}

/// Radius of influence of nodes.
fn influence_line(case: &Case) -> Option<String> {
    let resolution = &case.nodes().resolution;
    let method = match resolution.basis {
        BasisKind::Linear => "element_free_galerkin, linear basis",
        BasisKind::Quadratic => "element_free_galerkin, quadratic basis",
    };
    let limit = limits::of("influence_radius", method)?;
    let end = limit.passed(resolution.support)?;
    Some(format!(
        "model.influence_radius {}: beyond {end} node spacings the error of K exceeds {} %; remove the key",
        resolution.support, limit.bound_percent
    ))
}

/// Warning of failure in the first cycle, by handbook K and net section; `None` where the plate carries the load, or nothing is known.
pub(super) fn first_load_warning(case: &Case) -> Option<String> {
    if case.loading.displacement().is_some() {
        return None;
    }
    let (length, load) = (case.specimen.crack_length, case.loading.maximum);
    let of_front =
        |flaw: &PartThrough| FrontTip::ALL.map(|tip| flaw.k_i(flaw.start(), load, tip)).into_iter().fold(0.0, f64::max);
    let by_formula = || handbook(&case.specimen).map(|formula| formula.k_i(length, load));
    let factor = case.specimen.part_through.as_ref().map(of_front).or_else(by_formula);
    first_load(case, load, factor.filter(|k| k.is_finite()))
}

/// The strengths that a largest nominal load (Pa or N) with this K_max, Pa√m, exceeds at N = 0, and the load at the lowest of them.
pub fn first_load(case: &Case, load: f64, k_max: Option<f64>) -> Option<String> {
    let limit = case.limit_load(case.specimen.crack_length, &case.specimen.crack_lines());
    let by_toughness = k_max.zip(case.toughness_at_end()).filter(|(k_max, toughness)| k_max >= toughness);
    let by_yield = limit.zip(case.yield_strength_at_end()).filter(|(limit, _)| load >= *limit);
    let in_words = |load: f64| match case.specimen.load_measure {
        LoadMeasure::Stress => format!("{:.2} MPa", load / MPA),
        LoadMeasure::Force => format!("{:.4} kN", load / KN),
    };
    let mut causes = Vec::new();
    if let Some((k_max, toughness)) = by_toughness {
        causes.push(format!("K_max {:.2} MPa√m exceeds the toughness {:.2} MPa√m", k_max / MPA_SQRT_M, toughness / MPA_SQRT_M));
    }
    if let Some((limit, strength)) = by_yield {
        causes.push(format!(
            "load {} exceeds the plastic collapse load of the net section, {} (yield strength {:.1} MPa)",
            in_words(load),
            in_words(limit),
            strength / MPA
        ));
    }
    let by_toughness = by_toughness.map(|(is, may)| load * may / is);
    let borne = in_words([by_toughness, by_yield.map(|(limit, _)| limit)].into_iter().flatten().fold(f64::INFINITY, f64::min));
    (!causes.is_empty()).then(|| {
        format!(
            "fails in the first cycle: {}; the limit at this crack length is {borne}. No life computed.",
            causes.join(", and ")
        )
    })
}
