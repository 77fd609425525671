//! Whether a straight path is stable.
//!
//! A crack in mode I with a positive T leaves its line (Cotterell and Rice 1980, Int. J. Fract. 16:155): an error of direction grows with
//! the way x as `exp(β² x)`, `β = 2√2 T/K_I`. Where T and K_I change, the exponent is `∫ 8 (T/K_I)² dx`.

use crate::growth::record::CurvePoint;
use crate::units::{MPA, MPA_SQRT_M};

/// Exponent from which small causes decide: an error of direction of a tenth of a degree has become some 10° at 2 e³.
const DECISIVE: f64 = 3.0;
/// |K_II| over K_I up to which a path counts as one in mode I.
const STRAIGHT: f64 = 0.05;

/// Share of the life, at its end, in which a path does not matter any more.
const END: f64 = 0.05;

/// What the user should know of tips whose straight path is unstable, with T where it has become so.
pub fn warning(curve: &[CurvePoint]) -> Option<String> {
    let tips = curve.first().map_or(0, |row| row.tips.len());
    let counts = (1.0 - END) * curve.last().map_or(0.0, |row| row.cycles);
    let unstable = |tip: usize| {
        let mut exponent = 0.0;
        curve.windows(2).take_while(|rows| rows[1].cycles <= counts).find_map(|rows| {
            let [before, now] = [&rows[0].tips[tip], &rows[1].tips[tip]];
            let ([k_i, k_ii], t_stress) = (now.factors?, now.t_stress?);
            if t_stress > 0.0 && k_i > 0.0 && k_ii.abs() < STRAIGHT * k_i {
                exponent += 8.0 * (t_stress / k_i).powi(2) * (now.growth - before.growth);
            }
            (exponent > DECISIVE).then_some((tip, k_i, t_stress))
        })
    };
    (0..tips).find_map(unstable).map(|(tip, k_i, t_stress)| {
        format!(
            "tip {tip} grows straight with T = {:.1} MPa along it at K_I = {:.2} MPa√m, where a straight path is unstable (T > 0): small causes \
             decide where it turns, in a test as in this run, and its mirror image is as likely",
            t_stress / MPA,
            k_i / MPA_SQRT_M
        )
    })
}
