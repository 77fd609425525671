//! Integrals over a finite interval: adaptive Gauss-Kronrod quadrature.
//!
//! Each panel is integrated by the 15-point Kronrod rule; the 7-point Gauss rule on every second of its points gives the
//! error. Panels whose error is too large are halved (Piessens, de Doncker-Kapenga, Überhuber and Kahaner 1983, QUADPACK,
//! whose tables these are; exact for polynomials up to degree 22).

/// Halvings of the whole interval after which a panel is taken as it is: 2⁻⁴⁰ of the interval.
const DEPTH_MAX: u32 = 40;

/// Positive abscissas of the 15-point Kronrod rule on -1..1; those of odd index also belong to the Gauss rule.
const ABSCISSAS: [f64; 7] = [
    0.991_455_371_120_812_6, 0.949_107_912_342_758_5, 0.864_864_423_359_769_1, 0.741_531_185_599_394_4, 0.586_087_235_467_691_1,
    0.405_845_151_377_397_2, 0.207_784_955_007_898_47,
];
/// Weights of the Kronrod rule at [`ABSCISSAS`] and, last, in the middle.
const KRONROD: [f64; 8] = [
    0.022_935_322_010_529_224, 0.063_092_092_629_978_55, 0.104_790_010_322_250_18, 0.140_653_259_715_525_92,
    0.169_004_726_639_267_9, 0.190_350_578_064_785_4, 0.204_432_940_075_298_9, 0.209_482_141_084_727_82,
];
/// Weights of the Gauss rule at the abscissas of odd index and, last, in the middle.
const GAUSS: [f64; 4] = [0.129_484_966_168_869_7, 0.279_705_391_489_276_64, 0.381_830_050_505_118_9, 0.417_959_183_673_469_4];

/// Value of an integral and a bound of its error as the rules see it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Integral {
    pub value: f64,
    /// Sum over panels of the difference between the two rules.
    pub error: f64,
}

/// `∫ f(x) dx` from `from` to `to`, panels halved until each one's error is below `tolerance` times the whole integral.
///
/// The ends themselves are never asked for, so that `f` may be infinite there. NaN where `f` is.
pub fn integrate(f: impl Fn(f64) -> f64, from: f64, to: f64, tolerance: f64) -> Integral {
    let whole = panel(&f, from, to);
    let bound = tolerance * whole.value.abs();
    let mut sum = Integral::default();
    let mut waiting = vec![(from, to, whole, 0)];
    while let Some((from, to, found, depth)) = waiting.pop() {
        // Written so that NaN, which no halving cures, is taken as it is.
        let halve = found.error > bound && depth < DEPTH_MAX;
        if halve {
            let middle = 0.5 * (from + to);
            waiting.push((from, middle, panel(&f, from, middle), depth + 1));
            waiting.push((middle, to, panel(&f, middle, to), depth + 1));
        } else {
            sum.value += found.value;
            sum.error += found.error;
        }
    }
    sum
}

fn panel(f: &impl Fn(f64) -> f64, from: f64, to: f64) -> Integral {
    let (centre, half) = (0.5 * (from + to), 0.5 * (to - from));
    let middle = f(centre);
    let (mut kronrod, mut gauss) = (KRONROD[7] * middle, GAUSS[3] * middle);
    for (i, (x, weight)) in ABSCISSAS.iter().zip(&KRONROD).enumerate() {
        let pair = f(centre - half * x) + f(centre + half * x);
        kronrod += weight * pair;
        if i % 2 == 1 {
            gauss += GAUSS[i / 2] * pair;
        }
    }
    Integral { value: half * kronrod, error: (half * (kronrod - gauss)).abs() }
}
