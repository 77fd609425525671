//! Random cases end in a result or in a refusal with a name: none panics, hangs, ends without words or in a number that is none.

use std::path::Path;

use perilife_base::error::Error;
use perilife_growth::case::Case;
use perilife_growth::predict::{Prediction, predict};
use perilife_study::stability::{Budget, within};
use perilife_study::tasks::Outcome;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Of every case: most take less than a second. A run that is ended by its budget has obeyed; one that has not never comes back.
const BUDGET: Budget = Budget { seconds: 20.0, blocks: 300 };

/// Numbers of one case.
struct Draw(ChaCha8Rng);

impl Draw {
    fn between(&mut self, low: f64, high: f64) -> f64 {
        let share = (self.0.next_u64() >> 11) as f64 / (1_u64 << 53) as f64;
        // Three digits, so that a case can be written down.
        ((low + (high - low) * share) * 1e3).round() / 1e3
    }

    fn below(&mut self, count: usize) -> usize {
        (self.0.next_u64() % count as u64) as usize
    }

    fn one_of<'a>(&mut self, all: &[&'a str]) -> &'a str {
        all[self.below(all.len())]
    }

    fn chance(&mut self, share: f64) -> bool {
        self.between(0.0, 1.0) < share
    }

    /// Outline, holes and cracks of a plate of 20 to 50 mm; its width, and whether it is a rectangle.
    fn plate(&mut self) -> (String, f64, bool) {
        let [w, h] = [self.between(20.0, 50.0), self.between(24.0, 60.0)];
        let (x, y) = (0.5 * w, 0.5 * h);
        let mut text = "[specimen]\nkind = \"plate\"\nthickness_mm = 2\n".to_owned();
        let shape = self.below(4);
        // Ends stay alike, so that loads on them balance.
        text += &match shape {
            0 => {
                let c = self.between(0.05, 0.2) * w.min(h);
                format!(
                    "outline_mm = [[{}, {}], [{x}, {}], [{x}, {y}], [{}, {y}], [{}, {}], [{}, {}]]\n",
                    c - x,
                    -y,
                    -y,
                    c - x,
                    -x,
                    y - c,
                    -x,
                    c - y
                )
            }
            1 => {
                let (c, d) = (self.between(0.05, 0.2) * w, self.between(0.1, 0.3) * h);
                let z = x - c;
                format!(
                    "outline_mm = [[{}, {}], [{x}, {}], [{x}, {}], [{z}, {}], [{z}, {d}], [{x}, {d}], [{x}, {y}], [{}, {y}]]\n",
                    -x, -y, -y, -d, -d, -x
                )
            }
            _ => format!("width_mm = {w}\nlength_mm = {h}\n"),
        };
        let holes: Vec<String> = (0..self.below(3))
            .map(|_| {
                let [a, b] = [self.between(-0.7, 0.7) * x, self.between(-0.7, 0.7) * y];
                format!("{{ x_mm = {a}, y_mm = {b}, diameter_mm = {} }}", self.between(2.0, 0.2 * w))
            })
            .collect();
        if !holes.is_empty() {
            text += &format!("holes = [{}]\n", holes.join(", "));
        }
        let cracks: Vec<String> = (0..1 + self.below(3)).map(|_| self.crack([x, y])).collect();
        text += &format!("cracks = [{}]\n", cracks.join(", "));
        (text, w, shape > 1)
    }

    /// From an edge, inside, or kinked.
    fn crack(&mut self, [x, y]: [f64; 2]) -> String {
        let at = |draw: &mut Draw| [draw.between(-0.75, 0.75) * x, draw.between(-0.5, 0.5) * y];
        let ([a, b], [c, d]) = (at(self), at(self));
        let share = self.between(0.5, 0.95);
        let [e, f] = [a + share * (c - a), b + share * (d - b)];
        match self.below(4) {
            0 => format!("{{ from_mm = [{}, {b}], to_mm = [{}, {}] }}", -x, -x + share * 0.6 * x, b + 0.2 * (f - b)),
            1 => format!("{{ path_mm = [[{a}, {b}], [{e}, {f}], [{}, {}]] }}", e + 0.2 * (d - b), f + 0.2 * (c - a)),
            _ => format!("{{ from_mm = [{a}, {b}], to_mm = [{e}, {f}] }}"),
        }
    }

    fn loading(&mut self, is_rectangle: bool) -> String {
        let ratio = self.between(-1.0, 0.7);
        let more = match self.below(8) {
            0 if is_rectangle => format!("stress_parallel_ratio = {}\n", self.between(-1.0, 2.0)),
            1 if is_rectangle => "edges = [\"left\", \"right\"]\n".to_owned(),
            2 => format!("crack_pressure_mpa = {}\n", self.between(0.0, 30.0)),
            _ => String::new(),
        };
        let load = match self.below(8) {
            0 => format!("force_max_n = {}", self.between(100.0, 9e3)),
            1 => format!("stress_range_mpa = {}", self.between(1.0, 80.0)),
            2 => {
                let most = self.between(0.001, 0.1);
                return format!("[loading]\nkind = \"displacement\"\ndisplacement_max_mm = {most}\nstress_ratio = 0.1\n");
            }
            _ => format!("stress_max_mpa = {}", self.between(1.0, 150.0)),
        };
        format!("[loading]\n{load}\nstress_ratio = {ratio}\n{more}")
    }

    /// `[material]` and `[model]`, whose laws of bonds have their own Poisson's ratios.
    fn model(&mut self, width: f64) -> String {
        let plane = self.one_of(&["stress", "strain"]);
        let most = if plane == "stress" { 1.0 / 3.0 } else { 0.25 };
        let mut nu = self.between(0.05, 0.49);
        let nodes = self.chance(0.25);
        let limits = if self.chance(0.3) { "yield_strength_mpa = 350\ntoughness_mpa_sqrt_m = 40\n" } else { "" };
        let mut text = String::new();
        if nodes {
            let (basis, enrichment) = (self.one_of(&["linear", "quadratic"]), self.one_of(&["tip", "tip", "none"]));
            text += &format!("[model]\nmethod = \"element_free_galerkin\"\nbasis = \"{basis}\"\nenrichment = \"{enrichment}\"\n");
        } else {
            text += &format!("[model]\nspacing_mm = {}\n", width / self.between(22.0, 34.0));
            let law = self.one_of(&["", "two_parameter", "state_based", "one_bond_two_parameter", "bond_based"]);
            match law {
                "two_parameter" | "one_bond_two_parameter" => nu = nu.min(most),
                "bond_based" => nu = most,
                _ => {}
            }
            if !law.is_empty() {
                text += &format!("bond_law = \"{law}\"\n");
            }
            if self.chance(0.3) {
                text += &format!("horizon_ratio = {}\n", self.between(1.5, 5.0));
            }
            if self.chance(0.3) {
                text += &format!("lattice_angle_deg = {}\n", self.between(-90.0, 90.0));
            }
            if self.chance(0.2) {
                text += &format!("kernel = \"{}\"\n", self.one_of(&["constant", "conical"]));
            }
            if self.chance(0.5) {
                text += &format!("solver = \"{}\"\n", self.one_of(&["window", "multigrid"]));
            } else if self.chance(0.4) {
                text += &format!("surface_correction = \"{}\"\n", self.one_of(&["none", "volume_and_surface", "balanced"]));
            }
        }
        format!("[material]\nyoungs_modulus_gpa = 70\npoisson_ratio = {nu}\nplane = \"{plane}\"\n{limits}{text}")
    }

    fn fatigue(&mut self) -> String {
        let m = self.between(1.5, 8.0);
        let law = match self.below(5) {
            0 => format!("a = 6000\np = {m}\nhorizon_mm = 3.015\n"),
            1 => format!("growth_law = \"forman\"\nforman_c_mm_per_cycle = 1e-6\nforman_m = {m}\nk_c_mpa_sqrt_m = 60\n"),
            2 => format!("paris_c_mm_per_cycle = 1e-8\nparis_m = {m}\nwalker_gamma = 0.5\ndelta_k_threshold_mpa_sqrt_m = 2\n"),
            _ => format!("paris_c_mm_per_cycle = 1e-8\nparis_m = {m}\n"),
        };
        let driver = if self.chance(0.15) { "driver = \"bond_strain\"\n" } else { "" };
        format!("[fatigue]\n{law}{driver}")
    }

    fn case(&mut self) -> String {
        let (plate, width, is_rectangle) = self.plate();
        let (loading, model, fatigue) = (self.loading(is_rectangle), self.model(width), self.fatigue());
        format!("{plate}{loading}{model}{fatigue}[stop]\ncycles_max = 1e9\n")
    }
}

/// What is wrong with a result.
fn fault(run: &Prediction) -> Option<String> {
    if run.curve.is_empty() {
        return Some("no row".to_owned());
    }
    for pair in run.curve.windows(2) {
        if !(pair[1].cycles >= pair[0].cycles && pair[1].crack_length >= pair[0].crack_length) {
            return Some(format!("row falls: {:?} to {:?}", pair[0].cycles, pair[1].cycles));
        }
    }
    let numbers = run.curve.iter().flat_map(|row| {
        let tips = row.tips.iter().flat_map(|tip| [tip.position[0], tip.position[1], tip.growth]);
        let factors = row.tips.iter().filter_map(|tip| tip.factors).flatten();
        [row.cycles, row.crack_length].into_iter().chain(tips).chain(factors).collect::<Vec<f64>>()
    });
    let moved = run.snapshots.iter().flat_map(|shot| shot.displacement.iter().flatten().copied());
    numbers.chain(moved).find(|number| !number.is_finite()).map(|number| format!("{number} in the result"))
}

/// What is wrong with a refusal.
fn nameless(error: &Error) -> Option<String> {
    let words = error.to_string();
    let is_named = match error {
        Error::Input(trouble) => trouble.key.is_some() && !trouble.problem.is_empty(),
        Error::Mechanics(words) => !words.is_empty(),
        Error::LossOfStiffness => true,
        Error::File { .. } => false,
    };
    (!is_named || words.contains("NaN") || words.contains("report this case")).then_some(words)
}

fn fuzz(seeds: &[u64]) {
    let (mut faults, mut results, mut refused, mut cut_short) = (Vec::new(), 0, Vec::new(), Vec::new());
    for seed in seeds.iter().copied() {
        let text = Draw(ChaCha8Rng::seed_from_u64(seed)).case();
        let mut end = None;
        let outcome = within(BUDGET, |run| {
            let done = Case::from_toml(&text, "fuzz", Path::new("."), &[]).and_then(|case| predict(&case, run));
            end = Some(match &done {
                Ok(run) => fault(run).map_or(Ok(None), Err),
                Err(error) => nameless(error).map_or(Ok(Some(error.to_string())), Err),
            });
            Ok(0.0)
        });
        match (outcome, end) {
            (Outcome::Stopped(_), _) => cut_short.push(seed),
            (Outcome::Refused(why) | Outcome::Failed(why), _) => faults.push(format!("seed {seed}: {why}\n{text}")),
            (_, Some(Err(why))) => faults.push(format!("seed {seed}: {why}\n{text}")),
            (_, Some(Ok(None))) => results += 1,
            (_, Some(Ok(Some(why)))) => refused.push(format!("seed {seed}: {why}")),
            (_, None) => faults.push(format!("seed {seed}: no end\n{text}")),
        }
    }
    println!(
        "{}\n{results} results, {} refused, beyond {} s or {} blocks: {cut_short:?}",
        refused.join("\n"),
        refused.len(),
        BUDGET.seconds,
        BUDGET.blocks
    );
    assert!(faults.is_empty(), "{} of {}:\n{}", faults.len(), seeds.len(), faults.join("\n"));
    // A generator whose cases are all refused tests nothing.
    assert!(2 * results >= seeds.len(), "{results} results only");
}

#[test]
fn random_cases_end_in_a_result_or_a_named_refusal() {
    // The fifth takes all of its budget.
    fuzz(&[0, 1, 2, 3, 5, 6, 7, 8]);
}

#[test]
#[ignore = "long: some ten minutes; cargo test fuzz_cases -- --ignored --nocapture"]
fn two_hundred_random_cases_end_in_a_result_or_a_named_refusal() {
    fuzz(&(0..200).collect::<Vec<_>>());
}
