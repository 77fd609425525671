//! Shape functions on the linear basis, eight nodes at a time ([`super::basis`] has the formulas): half of the work of a plate of nodes.
//! Positions and supports of the nodes in reach of a leaf are stored side by side; at every point of the leaf all of them get a weight, 0
//! beyond their support.

use super::basis::{PIVOT_LEAST, Value};
use super::cuts::Near;
use perilife_plate::specimen::Point;

/// Nodes at a time.
const LANES: usize = 8;
type Lanes = [f64; LANES];

/// Nodes of a leaf, and what they are to a point.
#[derive(Debug, Clone, Default)]
pub struct Workspace {
    /// Positions, and 1 over supports, filled up with a node that nothing sees.
    x: Vec<Lanes>,
    y: Vec<Lanes>,
    over_support: Vec<Lanes>,
    /// Length of the way to the point and its gradient, which becomes the slope of the weight.
    length: Vec<Lanes>,
    slope: [Vec<Lanes>; 2],
    weight: Vec<Lanes>,
    values: [Vec<Lanes>; 3],
}

impl Workspace {
    /// Takes up the nodes of a leaf.
    pub fn load(&mut self, nodes: &[u32], positions: &[Point], supports: &[f64]) {
        let size = nodes.len().div_ceil(LANES);
        for (own, far) in [(&mut self.x, 1e30), (&mut self.y, 1e30), (&mut self.over_support, 1.0)] {
            own.resize(size, [far; LANES]);
            own.iter_mut().next_back().into_iter().for_each(|last| *last = [far; LANES]);
        }
        let Workspace { x, y, over_support, .. } = self;
        let to = x.as_flattened_mut().iter_mut().zip(y.as_flattened_mut()).zip(over_support.as_flattened_mut());
        for (((x, y), over), &node) in to.zip(nodes) {
            ([*x, *y], *over) = (positions[node as usize], 1.0 / supports[node as usize]);
        }
        let [a, b] = &mut self.slope;
        let [c, d, e] = &mut self.values;
        for own in [&mut self.length, &mut self.weight, a, b, c, d, e] {
            own.resize(size, [0.0; LANES]);
        }
    }
}

/// As `basis::shape_functions` with the linear basis, of the nodes that are loaded. `clear` says of every node whether nothing parts it
/// from any point of the leaf; it is empty where nothing is near.
pub fn shape_functions(
    at: Point,
    nodes: &[u32],
    (near, clear): (&Near, &[bool]),
    scale: f64,
    room: &mut Workspace,
    values: &mut Vec<Value>,
) -> bool {
    values.clear();
    let arch = pulp::Arch::new();
    arch.dispatch(Ways { room, at });
    for (k, _) in clear.iter().enumerate().filter(|(_, clear)| !**clear) {
        let (chunk, k) = (k / LANES, k % LANES);
        let over = room.over_support[chunk][k];
        if room.length[chunk][k] * over >= 1.0 {
            continue;
        }
        match near.way([room.x[chunk][k], room.y[chunk][k]], at, 1.0 / over) {
            Some((length, [x, y])) => {
                (room.length[chunk][k], room.slope[0][chunk][k], room.slope[1][chunk][k]) = (length, x, y);
            }
            None => room.length[chunk][k] = f64::INFINITY,
        }
    }
    let [a, a_x, a_y] = arch.dispatch(Moments { room, at, scale });
    let Some(inverse) = inverse(&a) else { return false };
    let times = |m: &[f64; 6], [x, y, z]: [f64; 3]| {
        [m[0] * x + m[1] * y + m[2] * z, m[1] * x + m[3] * y + m[4] * z, m[2] * x + m[4] * y + m[5] * z]
    };
    let gamma = times(&inverse, [1.0, 0.0, 0.0]);
    let [of_x, of_y] = [times(&a_x, gamma), times(&a_y, gamma)];
    let gamma_x = times(&inverse, [-of_x[0], 1.0 / scale - of_x[1], -of_x[2]]);
    let gamma_y = times(&inverse, [-of_y[0], -of_y[1], 1.0 / scale - of_y[2]]);
    arch.dispatch(Values { room, at, scale, gammas: [gamma, gamma_x, gamma_y] });
    let [weight, value, x, y] = [&room.weight, &room.values[0], &room.values[1], &room.values[2]].map(|of| of.as_flattened());
    let all = nodes.iter().zip(weight).zip(value).zip(x.iter().zip(y));
    values.extend(all.filter(|(((_, weight), _), _)| **weight > 0.0).map(|(((&node, _), &value), (&x, &y))| Value {
        node,
        value,
        gradient: [x, y],
    }));
    true
}

/// Inverse of a symmetric matrix, both as 11 21 31 22 32 33; `None` if it is not positive definite by its pivots.
fn inverse(&[a11, a21, a31, a22, a32, a33]: &[f64; 6]) -> Option<[f64; 6]> {
    // L D Lᵀ
    let (l21, l31) = (a21 / a11, a31 / a11);
    let d2 = a22 - l21 * a21;
    let l32 = (a32 - l31 * a21) / d2;
    let d3 = a33 - l31 * a31 - l32 * l32 * d2;
    let spans = a11 > 0.0 && d2 > PIVOT_LEAST * a22 && d3 > PIVOT_LEAST * a33;
    spans.then(|| {
        let (i1, i2, i3) = (1.0 / a11, 1.0 / d2, 1.0 / d3);
        // L⁻¹ below its diagonal.
        let (m21, m32, m31) = (-l21, -l32, l21 * l32 - l31);
        [i1 + m21 * m21 * i2 + m31 * m31 * i3, m21 * i2 + m31 * m32 * i3, m31 * i3, i2 + m32 * m32 * i3, m32 * i3, i3]
    })
}

struct Ways<'a> {
    room: &'a mut Workspace,
    at: Point,
}

impl pulp::NullaryFnOnce for Ways<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Ways { room: Workspace { x, y, length, slope: [slope_x, slope_y], .. }, at } = self;
        let n = x.len();
        let (x, y, length, slope_x, slope_y) = (&x[..n], &y[..n], &mut length[..n], &mut slope_x[..n], &mut slope_y[..n]);
        for c in 0..n {
            for k in 0..LANES {
                let (x, y) = (at[0] - x[c][k], at[1] - y[c][k]);
                let squared = x * x + y * y;
                let root = squared.sqrt();
                let over = if squared > 0.0 { 1.0 / root } else { 0.0 };
                length[c][k] = root;
                slope_x[c][k] = x * over;
                slope_y[c][k] = y * over;
            }
        }
    }
}

/// Weights, their slopes and the moments of both.
struct Moments<'a> {
    room: &'a mut Workspace,
    at: Point,
    scale: f64,
}

impl pulp::NullaryFnOnce for Moments<'_> {
    type Output = [[f64; 6]; 3];

    #[inline(always)]
    fn call(self) -> Self::Output {
        let Moments { room: Workspace { x, y, over_support, length, slope: [slope_x, slope_y], weight, .. }, at, scale } = self;
        let mut sums = [[[0.0; LANES]; 6]; 3];
        let over_scale = 1.0 / scale;
        let n = x.len();
        let (x, y, over_support, length) = (&x[..n], &y[..n], &over_support[..n], &length[..n]);
        let (slope_x, slope_y, weight) = (&mut slope_x[..n], &mut slope_y[..n], &mut weight[..n]);
        for c in 0..n {
            let (mut factors, mut p) = ([[0.0; LANES]; 3], [[0.0; LANES]; 2]);
            for k in 0..LANES {
                let over = over_support[c][k];
                let s = length[c][k] * over;
                let left = 1.0 - s;
                let inner = (2.0 / 3.0 + s * s * (4.0 * s - 4.0), s * (12.0 * s - 8.0));
                let outer = (4.0 / 3.0 * left * left * left, -4.0 * left * left);
                let (w, slope) = if s <= 0.5 { inner } else { outer };
                let is_in = s < 1.0;
                let slope = if is_in { slope * over } else { 0.0 };
                factors[0][k] = if is_in { w } else { 0.0 };
                factors[1][k] = slope * slope_x[c][k];
                factors[2][k] = slope * slope_y[c][k];
                p[0][k] = if is_in { (x[c][k] - at[0]) * over_scale } else { 0.0 };
                p[1][k] = if is_in { (y[c][k] - at[1]) * over_scale } else { 0.0 };
            }
            [weight[c], slope_x[c], slope_y[c]] = factors;
            for (sum, factor) in sums.iter_mut().zip(factors) {
                for k in 0..LANES {
                    let (f, x, y) = (factor[k], p[0][k], p[1][k]);
                    let (fx, fy) = (f * x, f * y);
                    sum[0][k] += f;
                    sum[1][k] += fx;
                    sum[2][k] += fy;
                    sum[3][k] += fx * x;
                    sum[4][k] += fx * y;
                    sum[5][k] += fy * y;
                }
            }
        }
        sums.map(|moment| moment.map(|lanes| lanes.iter().sum::<f64>()))
    }
}

/// Values and gradients of the shape functions.
struct Values<'a> {
    room: &'a mut Workspace,
    at: Point,
    scale: f64,
    gammas: [[f64; 3]; 3],
}

impl pulp::NullaryFnOnce for Values<'_> {
    type Output = ();

    #[inline(always)]
    fn call(self) {
        let Values {
            room: Workspace { x, y, slope: [slope_x, slope_y], weight, values: [value, of_x, of_y], .. },
            at,
            scale,
            gammas,
        } = self;
        let [g, g_x, g_y] = gammas;
        let over_scale = 1.0 / scale;
        let n = x.len();
        let (x, y, w) = (&x[..n], &y[..n], &weight[..n]);
        let (slope_x, slope_y) = (&slope_x[..n], &slope_y[..n]);
        let (value, of_x, of_y) = (&mut value[..n], &mut of_x[..n], &mut of_y[..n]);
        for c in 0..n {
            for k in 0..LANES {
                let (x, y) = ((x[c][k] - at[0]) * over_scale, (y[c][k] - at[1]) * over_scale);
                let along = g[0] + g[1] * x + g[2] * y;
                value[c][k] = along * w[c][k];
                of_x[c][k] = (g_x[0] + g_x[1] * x + g_x[2] * y) * w[c][k] + along * slope_x[c][k];
                of_y[c][k] = (g_y[0] + g_y[1] * x + g_y[2] * y) * w[c][k] + along * slope_y[c][k];
            }
        }
    }
}
