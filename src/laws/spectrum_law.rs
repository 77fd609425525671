//! A spectrum as one law: the mean of da/dN over the cycles of a pass.
//!
//! `da/dN = Σ n_i v(f_i K_max, R_i) / Σ n_i`, K_max being that of the largest load, f_i the maximum of a cycle over the largest and R_i its
//! ratio, of a tip whose K is in proportion to the load; else both ends of every cycle have their K from its [`Response`]. A crack that grows
//! little in a pass grows by this mean in every cycle, so that whoever grows it needs no loop over cycles.

use std::sync::OnceLock;

use super::growth_law::{Acting, GrowthLaw};
use super::response::Response;
use perilife_plate::loading::spectrum::{Class, Spectrum};

/// Classes up to which they are summed at every K; of more, sums are tabulated.
const SUMMED: usize = 24;
/// Distance of the tabulated K, of ln K.
const STEP: f64 = 0.02;
/// ln of the smallest and the largest K that are tabulated, Pa√m: 1e-3 and 1e5 MPa√m.
const ENDS: [f64; 2] = [6.907_755_278_982_137, 25.328_436_022_934_5];
/// Exponent of the rate over K from which the table is not trusted: at a threshold, or at K_c.
const STEEP: f64 = 30.0;
/// Share of the mean rate that a class beyond what the law knows may have without a word.
const BEYOND: f64 = 0.01;

#[derive(Debug)]
pub struct SpectrumLaw {
    law: Box<dyn GrowthLaw>,
    classes: Vec<Class>,
    /// Least stress ratio that the law knows.
    least: f64,
    /// ln of mean rates at K in equal steps of ln K, computed when they are asked for; empty where sums are short.
    table: Vec<OnceLock<f64>>,
}

impl SpectrumLaw {
    /// The law of the cycles of a spectrum; ratios below the least that it knows count as that.
    pub fn new(law: Box<dyn GrowthLaw>, spectrum: &Spectrum) -> Self {
        let (classes, least) = (spectrum.classes.clone(), law.least_ratio());
        let nodes = if classes.iter().filter(|class| class.max > 0.0).count() > SUMMED {
            ((ENDS[1] - ENDS[0]) / STEP) as usize
        } else {
            0
        };
        SpectrumLaw { law, classes, least, table: (0..nodes).map(|_| OnceLock::new()).collect() }
    }

    fn mean(&self, k_max: f64, response: &Response) -> f64 {
        self.classes.iter().map(|class| self.growth(k_max, class, response)).sum()
    }

    fn growth(&self, k_max: f64, class: &Class, response: &Response) -> f64 {
        self.felt(k_max, class, response).map_or(0.0, |[k, ratio]| class.share * self.law.rate(k, ratio))
    }

    /// Largest K, Pa√m, and stress ratio of the cycles of a class; `None` of those that do not open the crack.
    fn felt(&self, k_max: f64, class: &Class, response: &Response) -> Option<[f64; 2]> {
        let [largest, least] = response.cycle([class.max, class.min]);
        (largest > 0.0 && largest > least).then(|| [k_max * largest, (least / largest).max(self.least)])
    }

    fn node(&self, place: usize) -> f64 {
        *self.table[place].get_or_init(|| self.mean((ENDS[0] + STEP * place as f64).exp(), &Response::PROPORTIONAL).ln())
    }

    /// The mean by a monotone cubic through four neighbours of the table (slopes after Fritsch and Butland 1984); `None` where that is no
    /// smooth curve.
    fn tabulated(&self, k_max: f64) -> Option<f64> {
        let at = (k_max.ln() - ENDS[0]) / STEP;
        let place = at.floor();
        if !(place >= 1.0 && place + 2.0 < self.table.len() as f64) {
            return None;
        }
        let (place, t) = (place as usize, at - place);
        let nodes = [place - 1, place, place + 1, place + 2].map(|place| self.node(place));
        let rises = [nodes[1] - nodes[0], nodes[2] - nodes[1], nodes[3] - nodes[2]];
        if !rises.iter().all(|rise| rise.is_finite() && rise.abs() < STEEP * STEP) {
            return None;
        }
        let slope = |a: f64, b: f64| if a * b > 0.0 { 2.0 * a * b / (a + b) } else { 0.0 };
        let [from, to] = [slope(rises[0], rises[1]), slope(rises[1], rises[2])];
        let bend = [rises[1] - from, to - rises[1]];
        let u = 1.0 - t;
        // Cubic with these values and slopes at its ends.
        Some((nodes[1] + t * rises[1] - t * u * (t * bend[1] - u * bend[0])).exp())
    }
}

impl GrowthLaw for SpectrumLaw {
    fn rate(&self, k_max: f64, _: f64) -> f64 {
        self.tabulated(k_max).unwrap_or_else(|| self.mean(k_max, &Response::PROPORTIONAL))
    }

    fn mean_rate(&self, k_max: f64, ratio: f64, response: &Response) -> f64 {
        if response.is_proportional() { self.rate(k_max, ratio) } else { self.mean(k_max, response) }
    }

    /// Of the first class, by size, of which the law says nothing, where a share of the growth that counts is by such.
    fn beyond(&self, k_max: f64, ratio: f64) -> Option<String> {
        let response = &Response::PROPORTIONAL;
        let told = |class: &Class| {
            let [k, ratio] = self.felt(k_max, class, response).filter(|_| self.growth(k_max, class, response) > 0.0)?;
            self.law.beyond(k, ratio)
        };
        self.classes.iter().find_map(told).filter(|_| self.share_beyond(k_max, ratio, response) > BEYOND)
    }

    fn is_refused_beyond(&self) -> bool {
        self.law.is_refused_beyond()
    }

    fn acting(&self, k_max: f64, _: f64, response: &Response) -> Vec<Acting> {
        let all = self.mean(k_max, response);
        let of = |class: &Class| {
            let [k, ratio] = self.felt(k_max, class, response)?;
            Some(Acting::new(k, ratio, self.growth(k_max, class, response) / all))
        };
        self.classes.iter().filter_map(of).filter(|acting| acting.share > 0.0).collect()
    }

    fn share_beyond(&self, k_max: f64, _: f64, response: &Response) -> f64 {
        let is_beyond =
            |class: &&Class| self.felt(k_max, class, response).is_some_and(|[k, ratio]| self.law.beyond(k, ratio).is_some());
        let beyond: f64 = self.classes.iter().filter(is_beyond).map(|class| self.growth(k_max, class, response)).sum();
        // Most laws know every K, and the mean over all classes is asked of the others alone.
        if beyond > 0.0 { beyond / self.mean(k_max, response) } else { 0.0 }
    }
}
