//! Closure of a constant factor.

use super::description::{Constant, RetardationSpec};
use perilife_base::input::number;

/// `da/dN = v(K_max, C_f)` within the zone of an overload: the crack is open from C_f K_max on, `C_f = 1 - (1 - C_f0)(1 + 0.6 R)(1 - R)` (Bell
/// and Creager 1974, AFFDL-TR-74-129), and the law takes that for its R. R is at least -1 here.
pub static MODEL: RetardationSpec = RetardationSpec {
    name: "closure",
    meaning: "stress ratio C_f = 1 - (1 - closure_cf0)(1 + 0.6 R)(1 - R) within the zone of an overload",
    constants: &[Constant {
        key: "closure_cf0",
        quantity: number("a closure factor Cf0", 0.0, 0.99),
        default: |_, _| None,
        remedy: "give opening load over maximum at R = 0, 0.3 for many aluminum alloys",
    }],
    rate: Some(|constants, law, now, _| {
        let ratio = now.ratio.max(-1.0);
        let factor = 1.0 - (1.0 - constants[0]) * (1.0 + 0.6 * ratio) * (1.0 - ratio);
        law.rate(now.k_max, factor.max(now.ratio))
    }),
    underload: "not modeled",
};
