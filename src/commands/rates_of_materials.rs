//! `perilife rates --materials`: growth laws of the library beside measured rates.

use std::path::Path;

use perilife_base::error::Result;
use perilife_base::input::Folder;
use perilife_base::units::shown::{column, per};
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::library_law;
use perilife_results::chart::{Mark, Series, growth_rate};

/// ΔK between which a law is drawn, MPa√m, and the points over them.
const RANGE: [f64; 2] = [1.0, 200.0];
const POINTS: usize = 240;
/// Rates beyond which nothing is drawn, mm/cycle.
const RATES: [f64; 2] = [1e-8, 1e-1];
/// ΔK of the table, MPa√m.
const LISTED: [f64; 4] = [5.0, 10.0, 20.0, 30.0];

/// One law over ΔK.
pub struct MaterialRates {
    name: String,
    /// ΔK, MPa√m, and da/dN, mm/cycle.
    points: Vec<(f64, f64)>,
    listed: [Option<f64>; 4],
}

impl MaterialRates {
    /// Of materials by name, or by the path of a file, a `fitted.toml` too, or of a folder of files, at a stress ratio and a thickness, mm; and what is to be said of
    /// them, and of those that cannot be drawn.
    /// Errors: as [`library_law`], where none can be drawn.
    pub fn all(names: &[String], ratio: f64, thickness_mm: f64) -> Result<(Vec<MaterialRates>, Vec<String>)> {
        let folder = Folder::from(Path::new(""));
        let (mut all, mut lines, mut first) = (Vec::new(), Vec::new(), None);
        for name in names.iter().flat_map(|name| files(name)) {
            let (law, fitted) = match library_law(&name, thickness_mm * MM, ratio, &folder) {
                Ok(found) => found,
                Err(error) => {
                    lines.push(format!("{name}: no growth rates: {error}"));
                    first = first.or(Some(error));
                    continue;
                }
            };
            lines.extend(law.beyond_ratio(ratio).map(|words| format!("{name}: {words}")));
            let k_max = |delta_k: f64| delta_k * MPA_SQRT_M / (1.0 - ratio.max(0.0));
            let rate = |delta_k: f64| law.rate(k_max(delta_k), ratio) / MM_PER_CYCLE;
            let at = |k: usize| RANGE[0] * (RANGE[1] / RANGE[0]).powf(k as f64 / POINTS as f64);
            let is_fitted = |k: f64| (fitted[0]..=fitted[1]).contains(&(k * MPA_SQRT_M));
            let known = |(k, rate): &(f64, f64)| {
                is_fitted(*k) && (RATES[0]..=RATES[1]).contains(rate) && law.beyond(k_max(*k), ratio).is_none()
            };
            let points = (0..=POINTS).map(|k| (at(k), rate(at(k)))).filter(known).collect();
            let listed = LISTED.map(|k| Some(k / per("MPa√m")).filter(|k| is_fitted(*k)).map(rate));
            all.push(MaterialRates { name, points, listed });
        }
        match first {
            Some(error) if all.is_empty() => Err(error),
            _ => Ok((all, lines)),
        }
    }
}

/// A name itself, or every material file of a folder.
fn files(name: &str) -> Vec<String> {
    let Ok(entries) = std::fs::read_dir(name) else { return vec![name.to_owned()] };
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut files: Vec<String> =
        paths.filter(|path| path.extension().is_some_and(|end| end == "toml")).map(|path| path.display().to_string()).collect();
    files.sort();
    files
}

/// A line a material: rates at some ΔK, these in the unit that is shown.
pub fn table(materials: &[MaterialRates], ratio: f64) -> String {
    let head: String = LISTED.iter().map(|k| format!(",{}", column(&format!("da_dn_at_{k}_mm_per_cycle")))).collect();
    let row = |one: &MaterialRates| {
        format!(
            "{},{ratio}{}\n",
            one.name,
            one.listed
                .iter()
                .map(|rate| rate.map_or(",".to_owned(), |rate| format!(",{:.4e}", rate * per("mm/cycle"))))
                .collect::<String>()
        )
    };
    format!("material,stress_ratio{head}\n{}", materials.iter().map(row).collect::<String>())
}

/// Laws as lines, measured rates `(ΔK, da/dN)` as circles.
pub fn draw(path: &Path, materials: &[MaterialRates], ratio: f64, measured: Vec<(f64, f64)>) -> Result<()> {
    let mut series: Vec<Series> =
        materials.iter().map(|one| Series { name: one.name.clone(), mark: Mark::Line, points: one.points.clone() }).collect();
    if !measured.is_empty() {
        series.push(Series { name: "measured".to_owned(), mark: Mark::Circles, points: measured });
    }
    growth_rate(path, &format!("Growth rates at R = {ratio}"), &series)
}
