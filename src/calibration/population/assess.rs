//! What a fit says at the variances that were found: law, scatter, their errors, and every specimen in it.

use nalgebra::{DMatrix, Vector2};

use super::intervals::{Interval, Specimen, rows};
use super::noise::Noise;
use super::reml::{departures, estimate, likelihood, variances};
use super::{Found, Member, Population, SLOPE_SAME, SPECIMENS_FOR_SCATTER, groups, lots, penalty, slope_of_readings};
use crate::median::huber_mean;
use perilife_laws::curve::CurveLaw;

const OWN_STEPS: usize = 12;

/// All results at the variances that were found.
pub(super) fn assess(specimens: &[Specimen], best: &Found, gain: Option<f64>, slope: Option<f64>) -> Option<Population> {
    let Found { law, at, .. } = best;
    let (law, at) = (*law, at);
    let groups = groups(specimens, &law);
    let penalty = penalty(&law, slope);
    let found = estimate(&groups, at, &penalty)?;
    let (between, noise) = variances(at);
    let mut members = vec![None; specimens.len()];
    let mut levels = Vec::with_capacity(specimens.len());
    for group in &groups {
        let of_group = departures(group, at, &found.change)?;
        for (&place, (own, misfit)) in group.members.iter().zip(of_group) {
            let specimen = &specimens[place];
            members[place] = Some(Member {
                name: specimen.name.clone(),
                level: law.level + own[0],
                slope: law.slope + own[1],
                own: own_law(&specimen.intervals, &law, &noise)?,
                intervals: specimen.intervals.len(),
                misfit,
            });
            let by_law: f64 = group.rows.iter().map(|row| row.log_cycles.exp()).sum();
            levels.push((by_law / specimen.intervals.iter().map(|interval| interval.cycles).sum::<f64>()).ln());
        }
    }
    let few = specimens.len() < SPECIMENS_FOR_SCATTER;
    let freedom = specimens.len() as f64 - 1.0 + if few { lots::FREEDOM } else { 0.0 };
    Some(Population {
        law,
        level_of_lives: huber_mean(&levels),
        gain,
        between,
        noise,
        slope_of_readings: if slope.is_some() { 0.0 } else { slope_of_readings(specimens, best)? },
        covariance: found.covariance.transpose().into(),
        freedom,
        assumed_scatter: few,
        restricted_likelihood: likelihood(&groups, at, &penalty)?,
        specimens: members.into_iter().collect::<Option<_>>()?,
    })
}

/// ln rate at the pivot and slope of the readings of one specimen, the shape being that of the lot.
fn own_law(intervals: &[Interval], lot: &CurveLaw, noise: &Noise) -> Option<[f64; 2]> {
    let n = intervals.len();
    let mut law = *lot;
    for _ in 0..OWN_STEPS {
        let rows = rows(&law, intervals);
        let residual = |i: usize| rows[i].log_cycles - intervals[i].cycles.ln();
        let mut white = DMatrix::from_fn(n, 3, |i, k| if k < 2 { rows[i].design[k] } else { residual(i) });
        noise.covariance(&rows).cholesky()?.l_dirty().solve_lower_triangular_mut(&mut white);
        let products = white.tr_mul(&white);
        let (curvature, right) = (products.fixed_view::<2, 2>(0, 0).into_owned(), products.fixed_view::<2, 1>(0, 2).into_owned());
        let level_only = Vector2::new(right[0] / curvature[(0, 0)], 0.0);
        let change = if n < 2 { level_only } else { curvature.try_inverse().map_or(level_only, |inverse| inverse * right) };
        law.level += change[0];
        law.slope += change[1].clamp(-1.0, 1.0);
        if change.amax() < SLOPE_SAME {
            break;
        }
    }
    Some([law.level, law.slope])
}
