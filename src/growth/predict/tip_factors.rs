//! K of the tips of the initial cracks at maximum load, by two methods, for `perilife sif`.
//!
//! An integral over a ring around the tip, that of the first row of a prediction ([`crate::points`]); and the same on a plate of
//! nodes, which shares nothing with points and bonds ([`perilife_nodes`]). A crack cut into bonds reaches up to half a spacing farther or less far
//! than asked ([`perilife_points::body::severed`]); the ring therefore looks at other lengths, too: K belongs to the requested one.
//!
//! Signs, in the frame of a tip (x₁ ahead of the tip, x₂ a quarter turn counter-clockwise from it): K_I > 0 opens the
//! crack, K_II > 0 slides the face on the side of x₂ > 0 towards x₁ > 0.

use std::time::Instant;

use crate::case::Case;
use crate::cracks::{InitialTips, initial_tips};
use crate::cross_check::largest_difference;
use crate::nodes::NodePlate;
use crate::part_through::Neighbours;
use crate::points::PointPlate;
use crate::record::TipRecord;
use perilife_base::error::{Error, Result, input, input_missing};
use perilife_base::units::MPA_SQRT_M;
use perilife_plate::specimen::handbook::handbook_beside;
use perilife_plate::specimen::{FrontTip, PartThrough, TipSeed};
use perilife_points::crack_tip::TipState;

perilife_base::kinds! {
    /// Ways to the stress intensity factors.
    pub enum StressIntensityMethod for "sif --method" {
        Ring = "ring": "interaction integral over a ring around the tip, as predict reads it",
        ElementFreeGalerkin = "element_free_galerkin": "interaction integral on a plate of nodes without elements: K_I and K_II independent of points and bonds",
    }
}

/// K_I and K_II, Pa√m; `None` where a method cannot tell.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Intensity {
    /// Opening mode.
    pub k_i: Option<f64>,
    /// In-plane sliding mode.
    pub k_ii: Option<f64>,
}

impl Intensity {
    /// Both modes known.
    pub fn both([k_i, k_ii]: [f64; 2]) -> Self {
        Intensity { k_i: Some(k_i), k_ii: Some(k_ii) }
    }
}

/// A case without its slots, whose end faces have no K.
fn sharp(case: &Case) -> Case {
    let mut sharp = case.clone();
    sharp.specimen.tips.retain(|tip| !tip.from_slot);
    sharp
}

/// Difference from K on nodes, over K, from which points are not fine enough.
const BESIDE_NODES: f64 = 0.02;

/// What nodes say of K of the initial tips of a plate on points, where that is something else. Nothing where nodes cannot say it.
pub(super) fn beside_nodes(case: &Case, own: &[TipRecord]) -> Option<String> {
    let factors = |tips: &[TipRecord]| tips.iter().map(|tip| tip.factors).collect::<Option<Vec<_>>>();
    let tips = initial_tips::<NodePlate>(&sharp(case)).ok()?.tips;
    let (own, nodes) = (factors(own)?, factors(&tips)?);
    let (tip, share) = largest_difference(&own, &nodes);
    (share > BESIDE_NODES).then(|| {
        let [[k_i, k_ii], [of_nodes_i, of_nodes_ii]] = [own[tip], nodes[tip]].map(|factors| factors.map(|k| k / MPA_SQRT_M));
        format!(
            "points: K of tip {tip} differs by {:.1} % from the node model ({k_i:.3} and {k_ii:.3} against {of_nodes_i:.3} and {of_nodes_ii:.3} MPa√m); \
             reduce model.spacing_mm, or use model.method = \"element_free_galerkin\"",
            100.0 * share
        )
    })
}

/// K of every sharp tip and T on a plate of nodes.
fn by_nodes(case: &Case) -> Result<Vec<MethodResult>> {
    let started = Instant::now();
    let InitialTips { tips, warnings, .. } = initial_tips::<NodePlate>(&sharp(case))?;
    Ok(of_tips(StressIntensityMethod::ElementFreeGalerkin, started, &tips, warnings))
}

/// What the tips of a first row say. What is to be said of several tips is said once.
fn of_tips(method: StressIntensityMethod, started: Instant, tips: &[TipRecord], warnings: Vec<String>) -> Vec<MethodResult> {
    let mut note = Some(warnings.join("; ")).filter(|warnings| !warnings.is_empty());
    let wall_s = started.elapsed().as_secs_f64() / tips.len().max(1) as f64;
    let result = |tip: &TipRecord| MethodResult {
        method,
        intensity: tip.factors.map(Intensity::both).unwrap_or_default(),
        t_stress: tip.t_stress,
        note: note.take(),
        is_closed: tip.state == TipState::Closed,
        wall_s,
    };
    tips.iter().map(result).collect()
}

/// What one method says about one tip.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodResult {
    pub method: StressIntensityMethod,
    pub intensity: Intensity,
    /// Stress along the crack T, Pa; `None` where a method cannot tell.
    pub t_stress: Option<f64>,
    /// Whether the load presses its flanks together.
    pub is_closed: bool,
    /// What is to be said of the tip, or why a factor is missing.
    pub note: Option<String>,
    /// Seconds for this tip, with the solutions it rests on.
    pub wall_s: f64,
}

impl MethodResult {
    fn nothing(method: StressIntensityMethod, error: &Error) -> Self {
        let note = Some(error.to_string());
        MethodResult { method, intensity: Intensity::default(), t_stress: None, is_closed: false, note, wall_s: 0.0 }
    }
}

/// A crack tip with its factors.
#[derive(Debug, Clone, PartialEq)]
pub struct TipResult {
    /// Tip of the requested crack.
    pub tip: TipSeed,
    /// One entry a method, in the order asked for.
    pub methods: Vec<MethodResult>,
    /// K_I by the handbook, Pa√m, where there is a formula and it holds.
    pub handbook_k_i: Option<f64>,
    /// Which end of its front it is of a crack that does not go through, which no method but the handbook knows.
    pub end: Option<FrontTip>,
}

/// K of the ends of a crack front in the thickness and on the face, by the handbook alone.
/// Errors: [`Error::Input`] where methods are asked for by name.
fn of_front(case: &Case, flaw: &PartThrough, methods: &[StressIntensityMethod]) -> Result<Vec<TipResult>> {
    if let Some(method) = methods.first().filter(|_| methods != StressIntensityMethod::ALL) {
        let problem = "does not support part-through cracks, whose K is that of the handbook";
        return Err(input(StressIntensityMethod::KEY, method, problem, "remove it"));
    }
    let specimen = &case.specimen;
    let compounded = Neighbours::of(case, flaw)?.map_or(1.0, |neighbours| neighbours.factor(flaw.half_length));
    let on_face =
        specimen.tips.last().copied().unwrap_or(TipSeed { position: [0.0; 2], direction: [1.0, 0.0], from_slot: false });
    let deepest = [0, 1].map(|i| on_face.position[i] - flaw.half_length * on_face.direction[i]);
    let at = |end: FrontTip| match end {
        // Seen from the front it points nowhere.
        FrontTip::Depth => TipSeed { position: deepest, direction: [0.0; 2], from_slot: false },
        FrontTip::Surface => on_face,
    };
    let result = |end: FrontTip| {
        let k_i = compounded * flaw.k_i(flaw.start(), case.loading.maximum, end);
        TipResult { tip: at(end), methods: Vec::new(), handbook_k_i: Some(k_i), end: Some(end) }
    };
    Ok(FrontTip::ALL.map(result).to_vec())
}

/// Stress intensity factors of every crack tip of a case at its maximum load.
///
/// End faces of slots are no crack tips and left out.
/// Errors: a case without crack tips, mechanics without equilibrium.
pub fn stress_intensity(case: &Case, methods: &[StressIntensityMethod]) -> Result<Vec<TipResult>> {
    if let Some(flaw) = &case.specimen.part_through {
        return of_front(case, flaw, methods);
    }
    let tips: Vec<usize> = (0..case.specimen.tips.len()).filter(|&tip| !case.specimen.tips[tip].from_slot).collect();
    if tips.is_empty() {
        return Err(input_missing(
            case.specimen.crack_key(),
            "is missing: only the tip of a sharp crack has stress intensity factors, a notch has none",
            "give a crack, such as one that starts in the notch; stresses of a plate without cracks: --method element_free_galerkin alone",
        ));
    }
    let handbook_k_i = handbook_beside(&case.specimen)
        .filter(|formula| formula.holds_at(case.specimen.crack_length))
        .filter(|_| case.loading.displacement().is_none() && case.loading.residual.is_none())
        .map(|formula| formula.k_i(case.specimen.crack_length, case.loading.maximum));
    let mut results: Vec<TipResult> = tips
        .iter()
        .map(|&tip| TipResult {
            tip: case.specimen.tips[tip],
            methods: Vec::with_capacity(methods.len()),
            handbook_k_i,
            end: None,
        })
        .collect();
    for &method in methods {
        let columns = match method {
            // Off its ring, with T: those of the first row of a prediction driven by K.
            StressIntensityMethod::Ring => {
                let started = Instant::now();
                let InitialTips { tips, mut warnings, .. } = initial_tips::<PointPlate>(&sharp(case))?;
                if !methods.contains(&StressIntensityMethod::ElementFreeGalerkin) {
                    warnings.extend(beside_nodes(case, &tips));
                }
                of_tips(method, started, &tips, warnings)
            }
            // Other looks at K: what they cannot tell does not hide the first.
            StressIntensityMethod::ElementFreeGalerkin => by_nodes(case).or_else(|error| match methods {
                [StressIntensityMethod::ElementFreeGalerkin] => Err(error),
                _ => Ok(vec![MethodResult::nothing(method, &error); tips.len()]),
            })?,
        };
        results.iter_mut().zip(columns).for_each(|(tip, result)| tip.methods.push(result));
    }
    Ok(results)
}
