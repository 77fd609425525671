//! Laws over K fitted to tables of rates: known constants are found again, the right law wins, and what rates do not tell is named.

use std::fmt::Write as _;
use std::path::Path;

use crate::support::fits::read_back;
use perilife_base::input::{Document, Folder};
use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M};
use perilife_calibration::laws::case::LawCase;
use perilife_calibration::laws::fit::LawFit;
use perilife_calibration::laws::{FitLaw, Given, LawFits, fit_laws};
use perilife_calibration::record::{FitRecord, RatesRecord};
use perilife_calibration::results::{law_record, rates_beside_law};
use perilife_growth::case::Case;
use perilife_growth::predict::{Silent, predict};
use perilife_laws::growth_law::nasgro::opening;
use perilife_laws::growth_law::{FactorLaw, GrowthLaw, GrowthLawKind, Walker};
use perilife_laws::paris::ParisLaw;
use perilife_measured::rates::read;
use perilife_measured::{RateFileKeys, RateRow};

use crate::support::noise::Noise;
use crate::support::rows::assert_refusal;
use crate::support::shared::shared;

const RATIOS: [f64; 4] = [0.0, 0.3, 0.5, 0.7];
const NASGRO: [(&str, f64); 9] = [
    ("nasgro_c_mm_per_cycle", 1.5e-7),
    ("nasgro_n", 3.2),
    ("nasgro_p", 0.25),
    ("nasgro_q", 0.8),
    ("nasgro_alpha", 2.0),
    ("nasgro_smax_over_flow", 0.3),
    ("nasgro_delta_k_0_mpa_sqrt_m", 3.2),
    ("nasgro_c_th", 1.2),
    ("k_c_mpa_sqrt_m", 70.0),
];

/// A law with its constants, and largest K_max of the rates in MPa√m.
type Truth = (GrowthLawKind, Box<dyn GrowthLaw>, Vec<(&'static str, f64)>, f64);

fn kind(name: &str) -> GrowthLawKind {
    name.parse().unwrap()
}

fn fit_by(name: &str) -> FitLaw {
    name.parse().unwrap()
}

fn truths() -> Vec<Truth> {
    let paris = ParisLaw { c: 1e-8 * MM_PER_CYCLE, m: 3.1 };
    let of = |gamma| Box::new(Walker { paris, gamma, threshold: 0.0 });
    let forman = kind("forman").0.of([6e-6, 2.7, 62.0].into_iter());
    let [c, n, p, q, alpha, s, threshold, c_th, k_c] = NASGRO.map(|(_, value)| value);
    let nasgro = kind("nasgro").0.of([c, n, p, q, alpha, s, threshold, c_th, 0.0, k_c].into_iter());
    let of_forman = [("forman_c_mm_per_cycle", 6e-6), ("forman_m", 2.7), ("k_c_mpa_sqrt_m", 62.0)];
    let c_m = [("paris_c_mm_per_cycle", 1e-8), ("paris_m", 3.1)];
    vec![
        (kind("paris"), of(1.0), c_m.to_vec(), 50.0),
        (kind("walker"), of(0.45), [&c_m[..], &[("walker_gamma", 0.45)]].concat(), 50.0),
        (kind("forman"), Box::new(forman), of_forman.to_vec(), 59.0),
        (kind("nasgro"), Box::new(nasgro), NASGRO.to_vec(), 68.0),
    ]
}

/// A table of rates of a law, those without growth left out; `scatter` is the standard deviation of ln da/dN.
fn table(law: &dyn GrowthLaw, ratios: &[f64], k_max: [f64; 2], rows: usize, scatter: f64, seed: u64) -> String {
    let mut noise = Noise::new(seed);
    let mut text = "delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,stress_ratio\n".to_owned();
    for &ratio in ratios {
        for i in 0..rows {
            let k = k_max[0] * (k_max[1] / k_max[0]).powf(i as f64 / (rows - 1) as f64);
            let rate = law.rate(k * MPA_SQRT_M, ratio) / MM_PER_CYCLE * (scatter * noise.normal()).exp();
            if rate > 0.0 && rate.is_finite() {
                writeln!(text, "{:.10},{rate:.10e},{ratio}", k * (1.0 - ratio)).unwrap();
            }
        }
    }
    text
}

fn rows(text: &str) -> Vec<RateRow> {
    read(text.as_bytes(), Path::new("rates.csv"), &RateFileKeys::default()).unwrap().rows
}

fn of_kind(fits: &LawFits, kind: GrowthLawKind) -> &LawFit {
    fits.candidates.iter().find(|law| law.kind == kind).unwrap()
}

fn constant(law: &LawFit, key: &str) -> (f64, f64) {
    let found = law.constants.iter().find(|constant| constant.key == key).unwrap();
    (found.value, found.error.unwrap_or(0.0))
}

#[test]
fn known_constants_are_found_and_their_law_wins() {
    for (kind, law, constants, k_max) in truths() {
        let fits = fit_laws(&rows(&table(&*law, &RATIOS, [4.0, k_max], 30, 0.0, 1)), fit_by("best"), &Given::new()).unwrap();
        assert_eq!(fits.law().kind, kind, "{:#?}", fits.candidates);
        for (key, truth) in constants {
            let (value, _) = constant(fits.law(), key);
            assert!((value / truth - 1.0).abs() < 1e-4, "{kind}: {key} {value} for {truth}");
        }
        assert!(fits.margin.is_none_or(|(_, margin)| margin > 2.0), "{kind}: {:?}", fits.margin);
    }
}

/// Scatter of one laboratory, 10 % of the rate.
fn scattered(truths: impl Iterator<Item = Truth>) {
    for (kind, law, constants, k_max) in truths {
        let (mut outside, mut all, mut wins) = (0, 0, 0);
        for seed in 1..=12 {
            let rows = rows(&table(&*law, &RATIOS, [4.0, k_max], 30, 0.1, seed));
            let fits = fit_laws(&rows, fit_by("best"), &Given::new()).unwrap();
            wins += usize::from(fits.law().kind == kind);
            let own = of_kind(&fits, kind);
            for (key, truth) in constants.iter().filter(|_| own.left_out.is_none()) {
                let (value, error) = constant(own, key);
                all += usize::from(error > 0.0);
                outside += usize::from(error > 0.0 && (value - truth).abs() > 2.5 * error);
            }
        }
        // Curvature makes a linear error too small now and then.
        assert!(outside * 8 <= all && all >= 12, "{kind}: {outside} of {all} constants are off by more than 2.5 errors");
        assert!(wins >= 9, "{kind} wins {wins} of 12 times");
    }
}

/// The second of the laws; all are fitted to it.
#[test]
fn scatter_moves_constants_by_no_more_than_their_errors() {
    scattered(truths().into_iter().skip(1).take(1));
}

#[test]
#[ignore = "long: a minute; cargo test unit::laws -- --ignored"]
fn scatter_moves_constants_of_every_law_by_no_more_than_their_errors() {
    scattered(truths().into_iter());
}

#[test]
fn what_rates_do_not_tell_is_named() {
    let laws = truths();
    let (paris, walker, nasgro) = (&laws[0].1, &laws[1].1, &laws[3].1);
    let one_ratio = table(&**walker, &[0.1], [5.0, 40.0], 25, 0.05, 3);
    let middle = table(&**nasgro, &RATIOS, [12.0, 25.0], 25, 0.02, 4);
    let straight = table(&**paris, &RATIOS, [5.0, 40.0], 25, 0.05, 5);
    let cases = [
        (&one_ratio, fit_by("walker"), "walker_gamma cannot be determined: all rates are at one stress ratio, R = 0.100"),
        (&one_ratio, fit_by("nasgro"), "nasgro_alpha, nasgro_c_th cannot be determined: all rates are at one stress ratio"),
        (&one_ratio, fit_by("forman"), "k_c_mpa_sqrt_m cannot be determined"),
        (&straight, fit_by("forman"), "k_c_mpa_sqrt_m cannot be determined: best fit at the limit of its range, 19 times the "),
        (&middle, fit_by("nasgro"), "cannot be determined"),
    ];
    for (text, law, words) in cases {
        let error = fit_laws(&rows(text), law, &Given::new()).unwrap_err();
        assert_eq!(error.exit_code(), 3, "{law}: {error}");
        assert!(error.to_string().contains(words), "{law}: {words} in {error}");
        // The best law is one of the others, with the reason beside it.
        let best = fit_laws(&rows(text), fit_by("best"), &Given::new()).unwrap();
        let reasons: Vec<&String> = best.candidates.iter().filter_map(|law| law.left_out.as_ref()).collect();
        assert!(reasons.iter().any(|reason| reason.contains(words)), "{law}: {reasons:?}");
    }
}

/// NASGRO of rates that tell nothing of fracture is fitted without that factor; without either factor it would be another law.
#[test]
fn a_factor_that_no_rate_tells_is_left_out() {
    let (key, constants) = (
        GrowthLawKind::all().find(|kind| kind.name() == "nasgro").unwrap(),
        [3e-8, 3.0, 0.5, 0.0, 2.0, 0.3, 2.6, 1.0, 0.0, f64::INFINITY],
    );
    let law = key.0.of(constants.into_iter());
    let near_threshold = table(&law, &RATIOS, [3.0, 25.0], 30, 0.02, 7);
    let fits = fit_laws(&rows(&near_threshold), fit_by("best"), &Given::new()).unwrap();
    assert_eq!((fits.law().kind, fits.law().lacks), (key, Some("fracture")), "{:#?}", fits.candidates);
    assert!(fits.warnings.iter().any(|line| line.contains("without its fracture factor")), "{:?}", fits.warnings);
    for (name, truth) in [("nasgro_n", 3.0), ("nasgro_p", 0.5), ("nasgro_delta_k_0_mpa_sqrt_m", 2.6)] {
        assert!((constant(fits.law(), name).0 / truth - 1.0).abs() < 0.1, "{name}: {:?}", constant(fits.law(), name));
    }
    assert!(fits.law().known_constants().all(|constant| constant.key != "k_c_mpa_sqrt_m"));
    // A K_c that is given is kept, and one below a K_max of the rates is refused.
    let given = |k_c: f64| Given::from([("k_c_mpa_sqrt_m".to_owned(), k_c)]);
    let kept = fit_laws(&rows(&near_threshold), fit_by("nasgro"), &given(500.0)).unwrap();
    assert_eq!(constant(kept.law(), "k_c_mpa_sqrt_m").0, 500.0);
    assert_refusal(fit_laws(&rows(&near_threshold), fit_by("nasgro"), &given(5.0)), &["is below the tested K_max"]);
}

/// What rates do not tell can be given, and then it is not a constant of the fit.
#[test]
fn constants_can_be_given() {
    let laws = truths();
    let text = table(&*laws[3].1, &RATIOS, [12.0, 25.0], 25, 0.02, 4);
    let given: Given = NASGRO[2..].iter().map(|(key, value)| ((*key).to_owned(), *value)).collect();
    let fits = fit_laws(&rows(&text), fit_by("nasgro"), &given).unwrap();
    let (n, error) = constant(fits.law(), "nasgro_n");
    assert!((n - 3.2).abs() < 3.0 * error && error < 0.05, "n {n} ± {error}");
    assert_eq!(fits.law().fitted, 2);
    let low = Given::from([("k_c_mpa_sqrt_m".to_owned(), 20.0)]);
    assert_refusal(fit_laws(&rows(&text), fit_by("nasgro"), &low), &["is below the tested K_max = 25.000"]);
}

/// Neighbouring rates of a parabola share readings: they count as fewer, and errors grow.
#[test]
fn correlated_rates_count_as_fewer() {
    let laws = truths();
    let mut noise = Noise::new(8);
    let mut rows = rows(&table(&*laws[0].1, &[0.1], [5.0, 40.0], 200, 0.0, 1));
    let white: Vec<f64> = (0..rows.len() + 6).map(|_| 0.2 * noise.normal()).collect();
    let mut errors = Vec::new();
    for smooth in [1, 7] {
        for (i, row) in rows.iter_mut().enumerate() {
            let mean = white[i..i + smooth].iter().sum::<f64>() / smooth as f64;
            row.rate = laws[0].1.rate(row.k_max(), 0.1) * mean.exp();
        }
        let fits = fit_laws(&rows, fit_by("paris"), &Given::new()).unwrap();
        errors.push((fits.effective_rates, constant(fits.law(), "paris_m").1 / fits.law().rms()));
        assert_eq!(fits.warnings.iter().any(|line| line.contains("correlated")), smooth > 1, "{:?}", fits.warnings);
    }
    assert!(errors[0].0 == 200.0 && (10.0..40.0).contains(&errors[1].0), "{errors:?}");
    assert!(errors[1].1 > 2.0 * errors[0].1, "{errors:?}");
}

/// Every so many records of the shared table of constants, computed as rates and fitted; so many at least are found.
fn shared_constants(every: usize, found: usize) {
    const KSI_SQRT_IN: f64 = 1.098_843_5;
    let Some(file) = shared("growth_constants/nasgro_4.csv") else { return };
    let mut reader = csv::Reader::from_path(file).unwrap();
    let header = reader.headers().unwrap().clone();
    let mut seen = 0;
    for record in reader.records().step_by(every) {
        let record = record.unwrap();
        let at = |name: &str| record[header.iter().position(|column| column == name).unwrap()].parse::<f64>().unwrap();
        let (k_1c, thick) = (at("k1c_ksi_sqrt_in"), 2.5 * (at("k1c_ksi_sqrt_in") / at("yield_ksi")).powi(2));
        let k_c = k_1c * (1.0 + at("bk") * (-(at("ak") * 0.1 / thick).powi(2)).exp()) * KSI_SQRT_IN;
        let (n, alpha, s, c_th) = (at("n"), at("alpha"), at("smax_s0"), at("cth_plus"));
        let c = at("c_in_per_cycle") * 25.4 / KSI_SQRT_IN.powf(n);
        // DK1 is the threshold at R -> 1; that at R = 0 is larger by (1-A0)^-(1+Cth).
        let (_, a0) = opening(alpha, s, 0.0);
        let threshold = at("dk1_ksi_sqrt_in") * KSI_SQRT_IN * (1.0 - a0).powf(-1.0 - c_th);
        let law: FactorLaw = kind("nasgro").0.of([c, n, at("p"), at("q"), alpha, s, threshold, c_th, 0.0, k_c].into_iter());
        let lowest = (law.kind.0.threshold)(&law.constants, 0.7) / MPA_SQRT_M / 0.3;
        let text = table(&law, &[0.0, 0.1, 0.4, 0.7], [lowest.min(4.0) * 1.02, 0.97 * k_c], 60, 0.0, 1);
        let given = Given::from([("nasgro_smax_over_flow".to_owned(), s)]);
        let name = [&record[0], &record[1], &record[2], &record[3]].join(", ");
        let rows = rows(&text);
        match fit_laws(&rows, fit_by("nasgro"), &given) {
            Ok(fits) => {
                assert!(fits.law().rms() < 1e-6, "{name}: rms {}", fits.law().rms());
                let of = |key: &str| constant(fits.law(), key).0;
                for (key, truth) in [("nasgro_n", n), ("nasgro_alpha", alpha), ("k_c_mpa_sqrt_m", k_c)] {
                    assert!((of(key) / truth - 1.0).abs() < 1e-3, "{name}: {key} {} for {truth}", of(key));
                }
                seen += 1;
            }
            // A constraint factor that is an end of its range.
            Err(error) => assert!(alpha >= 2.99 && error.to_string().contains("nasgro_alpha"), "{name}: {error}"),
        }
    }
    assert!(seen >= found, "{seen} records");
}

#[test]
fn shared_constants_are_found_from_their_rates() {
    shared_constants(8, 3);
}

#[test]
#[ignore = "long: a minute; cargo test unit::laws -- --ignored"]
fn all_shared_constants_are_found_from_their_rates() {
    shared_constants(1, 25);
}

fn case(text: &str, tables: &[(&str, String)]) -> perilife_base::error::Result<LawCase> {
    let files = tables.iter().map(|(name, text)| ((*name).to_owned(), text.clone().into_bytes()));
    LawCase::from_document(&Document::parse(text, "laws", Folder::at_hand(files), &[]).unwrap())
}

#[test]
fn tables_come_in_one_file_or_one_a_ratio() {
    let law = &truths()[1].1;
    let all = table(&**law, &[0.1, 0.5], [5.0, 40.0], 12, 0.0, 1);
    let alone = |ratio: f64| {
        table(&**law, &[ratio], [5.0, 40.0], 12, 0.0, 1).replace(&format!(",{ratio}\n"), "\n").replace(",stress_ratio", "")
    };
    let one = case("[measured]\nrates = [\"all.csv\"]\n[fit]\nlaw = \"walker\"\n", &[("all.csv", all.clone())]).unwrap();
    let text = "[measured]\nrates = [{ file = \"a.csv\", stress_ratio = 0.1 }, { file = \"b.csv\", stress_ratio = 0.5 }]\n[fit]\nlaw = \"walker\"\n";
    let two = case(text, &[("a.csv", alone(0.1)), ("b.csv", alone(0.5))]).unwrap();
    let values = |case: &LawCase| case.fit().unwrap().law().constants.iter().map(|constant| constant.value).collect::<Vec<_>>();
    assert!(values(&one).iter().zip(values(&two)).all(|(a, b)| (a / b - 1.0).abs() < 1e-9));
    // A window takes rates of its ΔK; rows of `perilife rates` that are flagged do not count.
    let narrow = "[measured]\nrates = [\"all.csv\"]\nfrom_delta_k_mpa_sqrt_m = 8\nto_delta_k_mpa_sqrt_m = 12\n";
    let narrow = case(narrow, &[("all.csv", all.clone())]).unwrap();
    assert!(narrow.rows.len() > 3 && narrow.rows.iter().all(|row| (8.0..=12.0).contains(&(row.delta_k / MPA_SQRT_M))));
    let flagged = "specimen,delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,flags,stress_ratio\ns,10,1e-5,,0.1\ns,,1e-5,not_growing,0.1\n\
                   s,11,1.4e-5,load_changes,0.1\ns,12,2e-5,,0.1\ns,13,2.4e-5,,0.1\n";
    let flagged = case("[measured]\nrates = [\"f.csv\"]\n", &[("f.csv", flagged.to_owned())]).unwrap();
    assert_eq!(flagged.rows.len(), 4);
    assert!(flagged.warnings.iter().any(|line| line.contains("1 of 5 flagged rates excluded")), "{:?}", flagged.warnings);
}

#[test]
fn wrong_files_say_what_would_be_right() {
    let good = "delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,stress_ratio\n10,1e-5,0.1\n12,2e-5,0.1\n14,3e-5,0.5\n16,4e-5,0.5\n";
    let all = "[measured]\nrates = [\"r.csv\"]\n";
    let of_ratio = "[measured]\nrates = [{ file = \"r.csv\", stress_ratio = 0.1 }]\n";
    let cases = [
        (all.to_owned(), good.replace("12,", "x,"), "r.csv:3: delta_k_mpa_sqrt_m = x: is not a number"),
        (all.to_owned(), good.replace("2e-5", "-2e-5"), "r.csv:3: da_dn_mm_per_cycle = -2e-5: is not above zero"),
        (all.to_owned(), good.replace("16,4e-5,0.5", "16,4e-5,1.5"), "stress_ratio = 1.5: is not a stress ratio below 1"),
        (all.to_owned(), good.replace(",stress_ratio", ",x"), "is not a column, and no stress_ratio is set for the file"),
        (all.to_owned(), good.replace("delta_k_mpa", "kk_mpa"), "has no columns delta_k_mpa_sqrt_m and da_dn_mm_per_cycle"),
        (all.to_owned(), good.replace("12,", ","), "`perilife rates --specimen CASE.toml` computes it"),
        (of_ratio.to_owned(), good.to_owned(), "is a column, and stress_ratio = 0.1"),
        (format!("{all}[fit]\nlaw = \"pariss\"\n"), good.to_owned(), "unknown kind"),
        (format!("{all}[fit]\ngiven = {{ nasgro_c = 1 }}\n"), good.to_owned(), "fit.given.nasgro_c = 1: is not a constant"),
        (format!("{all}[fit]\ngiven = {{ nasgro_alpha = 4 }}\n"), good.to_owned(), "fit.given.nasgro_alpha = 4"),
        (format!("{all}[fit]\np = 3\n"), good.to_owned(), "fit.p: is not a key of a fit to tables of rates"),
        (format!("{all}[loading]\nstress_ratio = 0.1\n"), good.to_owned(), "loading: does not apply to tables of rates"),
        (format!("{all}from_delta_k_mpa_sqrt_m = 15\n"), good.to_owned(), "rates remain"),
        ("[measured]\n[fit]\nlaw = \"best\"\n".to_owned(), good.to_owned(), "measured.rates: is missing"),
    ];
    for (text, rates, words) in cases {
        let error = case(&text, &[("r.csv", rates)]).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
        assert!(error.to_string().contains(words), "{words} in {error}");
    }
}

const PANEL: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 8\n\
                     [material]\nyoungs_modulus_gpa = 71\npoisson_ratio = 0.33\n[loading]\nstress_max_mpa = 80\nstress_ratio = 0.3\n\
                     [model]\nmethod = \"handbook\"\n[stop]\ncrack_length_mm = 30\n";

/// The record makes the same life as the constants that the rates came from.
#[test]
fn predictions_read_the_fitted_law() {
    for (kind, law, constants, k_max) in truths() {
        let all = table(&*law, &RATIOS, [4.0, k_max], 30, 0.0, 1);
        let text = format!("[measured]\nrates = [\"all.csv\"]\n[material]\nname = \"sheet\"\n[fit]\nlaw = \"{kind}\"\n");
        let calibration = case(&text, &[("all.csv", all)]).unwrap();
        let fits = calibration.fit().unwrap();
        let found = FitRecord::Rates(Box::new(RatesRecord::of(&calibration, &fits, 0.1)));
        let report = read_back(&found);
        assert_eq!(report["candidates"].as_array().unwrap().len(), 4);
        assert_eq!(report["law"], kind.name());
        assert!(report["constants"].as_object().unwrap().len() >= 2 && report["material"] == "sheet", "{report}");
        assert_eq!(rates_beside_law(&calibration, &fits).rows(), calibration.rows.len());
        assert!(found.words()[1].iter().any(|line| line.contains("ΔAICc")));
        let record = toml::to_string(&law_record(&calibration, &fits)).unwrap();
        let folder = Folder::at_hand([("fitted.toml".to_owned(), record.into_bytes())]);
        let life = |fatigue: &str, set: &[&str]| {
            let set: Vec<String> = set.iter().map(|set| (*set).to_owned()).collect();
            let case = Case::from_toml(&format!("{PANEL}[fatigue]\n{fatigue}\n"), "panel", folder.clone(), &set)?;
            Ok::<_, perilife_base::error::Error>((predict(&case, &Silent)?.life_cycles(), case))
        };
        let inline: String = constants.iter().map(|(key, value)| format!("{key} = {value:e}\n")).collect();
        let (truth, _) = life(&format!("growth_law = \"{kind}\"\n{inline}"), &[]).unwrap();
        let (fitted, case) = life("fitted = \"fitted.toml\"", &[]).unwrap();
        assert!((fitted / truth - 1.0).abs() < 1e-4, "{kind}: {fitted} for {truth}");
        assert_eq!(case.law_record.as_ref().unwrap().kind(), kind.name());
        // A stress ratio beyond the rates, and a law given twice.
        let beyond = life("fitted = \"fitted.toml\"", &["loading.stress_ratio=0.9"]);
        match kind.name() {
            "paris" => assert!(beyond.unwrap_err().to_string().contains("is outside the fitted stress ratios"), "{kind}"),
            _ => assert!(beyond.unwrap().1.warnings.iter().any(|line| line.contains("used at R = 0.9")), "{kind}"),
        }
        let twice = life("fitted = \"fitted.toml\"\nparis_m = 3\n", &[]).unwrap_err();
        assert!(twice.to_string().contains("fatigue.paris_m: conflicts with fatigue.fitted"), "{twice}");
        let other = life("fitted = \"fitted.toml\"\ngrowth_law = \"table\"\n", &[]).unwrap_err();
        assert!(other.to_string().contains("is not the law of fitted.toml"), "{other}");
    }
}
