//! Cycles of a run under a spectrum whose order counts: its rows again, tip by tip, cycle by cycle.
//!
//! The run itself grows its cracks by the mean rate of a pass, which gives their ways and K along them. Between two rows the tip that grows most
//! is then marched through the spectrum with the zones of its overloads ([`perilife_laws::retardation::March`]); the other tips keep the share of
//! its growth that they have by the mean rates.

use super::laws::{growth_law, law_of_cycle};
use super::plastic_zone::other_plane;
use super::{CurvePoint, StopReason};
use crate::case::Case;
use crate::cracks::steering::equivalent_factor;
use perilife_base::error::Result;
use perilife_base::units::MM;
use perilife_laws::growth_law::GrowthLaw;
use perilife_laws::retardation::{Laws, March, Marched, Underway, Zone, between};
use perilife_plate::material::Plane;

/// Difference between K of tips that grow, from which the pace of the slower ones is worth a word.
const UNLIKE: f64 = 0.01;

/// A curve whose cycles were counted anew.
pub(super) struct Recounted {
    pub curve: Vec<CurvePoint>,
    pub stop: StopReason,
    pub warning: Option<String>,
}

/// The rows of a run with the cycles of the retarded tip, ended where no cycles or no growth are left; `None` where nothing is retarded. Rows of a
/// front that does not go through have their cycles already; `counted` is where its end at the face is after them.
/// Errors: a case without law.
pub(super) fn recount(
    case: &Case,
    curve: &[CurvePoint],
    stop: StopReason,
    counted: Option<Underway>,
) -> Result<Option<Recounted>> {
    let (Some(retardation), Some(spectrum)) = (&case.retardation, &case.loading.spectrum) else { return Ok(None) };
    let of_front = curve.iter().take_while(|row| row.is_of_front()).count();
    let Some(first) = curve.get(of_front) else { return Ok(None) };
    let (law, mean): (Box<dyn GrowthLaw>, _) = (law_of_cycle(case)?, growth_law(case)?);
    let laws = Laws { law: &*law, mean: &*mean, retardation: Some(retardation) };
    let mut march = March::new(laws, spectrum, counted.unwrap_or_else(|| Underway::start(spectrum)));
    if counted.is_none() {
        march.at.cycles = first.cycles;
    }
    let mut zones: Vec<Option<Zone>> = vec![march.at.zone; first.tips.len()];
    let mut rows: Vec<CurvePoint> = curve[..=of_front].to_vec();
    let mut lead = 0;
    for pair in curve[of_front..].windows(2) {
        let [from, to] = [&pair[0], &pair[1]];
        let grown = |tip: usize| to.tips[tip].growth - from.tips[tip].growth;
        let fastest = (0..zones.len()).max_by(|a, b| grown(*a).total_cmp(&grown(*b)).then(b.cmp(a))).unwrap_or(0);
        if fastest != lead && grown(fastest) > grown(lead) * (1.0 + UNLIKE) {
            zones[lead] = march.at.zone;
            march.at.take_over(from.tips[fastest].growth, zones[fastest]);
            lead = fastest;
        }
        let way = [from.tips[lead].growth, to.tips[lead].growth];
        march.at.a = march.at.a.max(way[0]);
        let [first, last] = factors(case, [from, to], lead);
        let k = between([first, last], way);
        let before = march.at.cycles;
        march.start = from.crack_length - way[0];
        march.response = from.tips[lead].response.between(&to.tips[lead].response, 0.5);
        if !(first > 0.0 && last > 0.0) {
            // Nothing is known of K there: the cycles are those of the run.
            (march.at.a, march.at.cycles) = (way[1], (march.at.cycles + to.cycles - from.cycles).min(case.stop.cycles_max));
        }
        let end = match march.advance(&k, way[1], case.stop.cycles_max) {
            Marched::Reached => None,
            Marched::RunOut => Some(StopReason::RunOut),
            Marched::Arrested => Some(StopReason::NothingAges),
        };
        let share = if way[1] > way[0] { ((march.at.a - way[0]) / (way[1] - way[0])).min(1.0) } else { 1.0 };
        let mut row = if share < 1.0 { to.clone().between(from, share) } else { to.clone() };
        row.cycles = march.at.cycles;
        let cycles = march.at.cycles - before;
        if cycles > 0.0 && march.at.a > way[0] && row.growth_rate.is_finite() {
            row.growth_rate = (march.at.a - way[0]) / cycles;
        }
        rows.push(row);
        if let Some(end) = end {
            return Ok(Some(recounted(rows, end, of_front)));
        }
    }
    Ok(Some(recounted(rows, stop, of_front)))
}

/// Warning of a thickness that needs another plane state than the zones of `own` have; with the life by those, marched to this end.
pub(super) fn other_zones(case: &Case, curve: &[CurvePoint], own: &Recounted, end: Option<StopReason>) -> Option<String> {
    let (plane, [first, last]) = other_plane(case, curve)?;
    let mut other = case.clone();
    let model = other.retardation.as_mut()?;
    (other.material.plane, model.plane) = (plane, plane);
    // Constants that the case does not give are the defaults of the other state.
    for (constant, value) in model.kind.0.constants.iter().zip(&mut model.constants) {
        let [here, there] = [case.material.plane, plane].map(|plane| (constant.default)(plane, None));
        let is_given = !case.echo["loading"][constant.key].is_null();
        *value = there.filter(|_| here != there && !is_given).unwrap_or(*value);
    }
    let other = end.and_then(|end| recount(&other, curve, end, None).ok()?);
    let life = |counted: &Recounted| match counted.stop {
        StopReason::NothingAges => "unlimited".to_owned(),
        _ => format!("{:.0} cycles", counted.curve.last().map_or(0.0, |row| row.cycles)),
    };
    let [sense, side] = if plane == Plane::Strain { ["thicker", "non-conservative"] } else { ["thinner", "conservative"] };
    let lives = other.map_or_else(String::new, |other| {
        format!("; with zones of plane {plane} the life is {} instead of {} ({side})", life(&other), life(own))
    });
    let [thickness, first, last] = [case.specimen.thickness, first, last].map(|size| size / MM);
    Some(format!(
        "plane: retardation uses plastic zones of plane {}, but the plate of {thickness:.2} mm is {sense} than plane strain at the tip needs, \
         {first:.2} mm at the start and {last:.2} mm at the end (2.5 (K_max/yield)², ASTM E399){lives}; set material.plane = \"{plane}\"",
        case.material.plane
    ))
}

/// K of the largest load at a tip at both ends of an interval, Pa√m; what is not read is that of the other end, or of the row.
fn factors(case: &Case, rows: [&CurvePoint; 2], tip: usize) -> [f64; 2] {
    let read = rows.map(|row| row.tips[tip].factors.map(equivalent_factor).filter(|k| *k > 0.0));
    let of_row = rows.map(|row| Some(row.k_max(&case.loading)).filter(|k| k.is_finite() && *k > 0.0));
    let [first, last] = [0, 1].map(|end| read[end].or(of_row[end]));
    let otherwise = first.or(last).unwrap_or(0.0);
    [first.unwrap_or(otherwise), last.unwrap_or(otherwise)]
}

fn recounted(mut curve: Vec<CurvePoint>, stop: StopReason, of_front: usize) -> Recounted {
    if let [first, second, ..] = &mut curve[of_front..] {
        first.growth_rate = second.growth_rate;
    }
    let warning = unlike(&curve[of_front..])
        .then(|| "tips: retardation is computed for the fastest tip only; the others keep their share of its growth".to_owned());
    Recounted { curve, stop, warning }
}

/// Whether tips of unlike K grow in the same rows.
fn unlike(curve: &[CurvePoint]) -> bool {
    let grown = |pair: &[CurvePoint]| -> Vec<f64> {
        let growths = pair[0].tips.iter().zip(&pair[1].tips).map(|(from, to)| to.growth - from.growth);
        growths.filter(|growth| *growth > 0.0).collect()
    };
    let differ = |growths: &[f64]| {
        let [low, high] = growths.iter().fold([f64::INFINITY, 0.0], |[low, high], x| [low.min(*x), x.max(high)]);
        high > low * (1.0 + UNLIKE)
    };
    curve.windows(2).any(|pair| differ(&grown(pair)))
}
