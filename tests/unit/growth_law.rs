//! Laws over K: their formulas at points that can be done by hand, their files, and what is refused.

use std::path::Path;

use perilife_base::input::Folder;
use perilife_base::quadrature::integrate;
use perilife_base::units::{MM, MM_PER_CYCLE, MPA_SQRT_M};
use perilife_growth::case::{Case, LawSource};
use perilife_growth::predict::{Silent, predict};
use perilife_laws::growth_law::nasgro::opening;
use perilife_laws::growth_law::table::{Curve, Table};
use perilife_laws::growth_law::{FactorLaw, GrowthLaw, GrowthLawKind};
use perilife_measured::rates::RateFile;

use crate::support::rows::{assert_refusal, assert_says, rows};

fn near(a: f64, b: f64, relative: f64) {
    assert!((a / b - 1.0).abs() < relative, "{a} against {b}");
}

fn law(name: &str, constants_si: &[f64]) -> FactorLaw {
    FactorLaw::new(name.parse::<GrowthLawKind>().unwrap().0, constants_si.to_vec())
}

#[test]
fn forman_becomes_unstable_at_its_toughness() {
    let law = law("forman", &[1e-8, 2.5, 60.0 * MPA_SQRT_M]);
    // ΔK = 18 of K_max = 20 at R = 0.1: 1e-8 18^2.5 / (0.9 60 - 18).
    near(law.rate(20.0 * MPA_SQRT_M, 0.1), 1e-8 * 18.0_f64.powf(2.5) / 36.0, 1e-12);
    assert_eq!(law.rate(20.0 * MPA_SQRT_M, -1.0), law.rate(20.0 * MPA_SQRT_M, 0.0), "ΔK = K_max for R < 0");
    assert_eq!(law.rate(60.0 * MPA_SQRT_M, 0.1), f64::INFINITY);
}

/// Newman (1984) as Forman and Mettu (1992) use it.
#[test]
fn nasgro_closes_and_opens() {
    let constants = [1e-10, 3.0, 0.5, 1.0, 1.5, 0.3, 3.0 * MPA_SQRT_M, 1.5, 0.1, 80.0 * MPA_SQRT_M];
    let law = law("nasgro", &constants);
    let opening = |ratio: f64| opening(1.5, 0.3, ratio);
    let threshold_at = |ratio: f64| (law.kind.0.threshold)(&constants, ratio);
    // A₀ = (0.825 - 0.51 + 0.1125) cos(0.15 π)^(2/3), A₁ = (0.415 - 0.1065) 0.3, by hand.
    let a0 = 0.4275 * (0.15 * std::f64::consts::PI).cos().powf(1.0 / 1.5);
    let (f, alone) = opening(0.0);
    near(f, a0, 1e-12);
    near(alone, a0, 1e-12);
    near(opening(-1.0).0, a0 - 0.09255, 1e-12);
    // At R -> 1 the crack is always open: f = R.
    near(opening(0.999).0, 0.999, 1e-3);
    near(threshold_at(0.0), 3.0 * MPA_SQRT_M, 1e-12);
    assert!(threshold_at(0.5) < threshold_at(0.0) && threshold_at(-1.0) > threshold_at(0.0));
    // Far above the threshold and below K_c it is nearly Paris growth of the effective range.
    let (k, rate) = (20.0, law.rate(20.0 * MPA_SQRT_M, 0.0));
    near(rate, 1e-10 * ((1.0 - a0) * k).powi(3) * (1.0 - 3.0 / k).sqrt() / (1.0 - k / 80.0), 1e-12);
    assert_eq!(law.rate(2.9 * MPA_SQRT_M, 0.0), 0.0);
    assert_eq!(law.rate(80.0 * MPA_SQRT_M, 0.0), f64::INFINITY);
    assert_eq!(law.rate(-1.0, 0.0), 0.0);
}

#[test]
fn a_table_is_straight_in_logarithms() {
    let curve = |ratio: f64, scale: f64| Curve {
        ratio,
        rows: [5.0, 10.0, 40.0].map(|k: f64| [k * MPA_SQRT_M, scale * 1e-10 * k.powi(3)]).to_vec(),
    };
    let one = Table::new(vec![curve(0.1, 1.0)], false, None, false);
    // Three rows of a power law give that power law between them, at any ratio.
    for (k, ratio) in [(7.0, 0.1), (23.0, 0.1), (23.0, 0.4)] {
        near(one.rate(k / (1.0 - ratio) * MPA_SQRT_M, ratio), 1e-10 * f64::powi(k, 3), 1e-12);
    }
    assert!(one.beyond(7.0 * MPA_SQRT_M, 0.0).is_none());
    assert!(one.beyond(41.0 * MPA_SQRT_M, 0.0).unwrap().contains("5.0000 to 40.0000"));
    near(one.rate(80.0 * MPA_SQRT_M, 0.0), 1e-10 * 40.0_f64.powi(3), 1e-12);
    // Between two ratios at equal rate: ln ΔK by halves.
    let two = Table::new(vec![curve(0.0, 1.0), curve(0.5, 8.0)], true, None, true);
    let k = (20.0_f64 * 10.0).sqrt();
    near(two.rate(k / 0.75 * MPA_SQRT_M, 0.25), 1e-10 * 8000.0, 1e-12);
    // Known are the rates that both have: 1000 to 64 000 of 1e-10, at R = 0 ΔK 10 to 40, at R = 0.5 ΔK 5 to 20.
    assert!(two.beyond(0.99 * 50.0_f64.sqrt() / 0.75 * MPA_SQRT_M, 0.25).is_some());
    assert!(two.beyond(1.01 * 50.0_f64.sqrt() / 0.75 * MPA_SQRT_M, 0.25).is_none());
    near(two.rate(7.0 * MPA_SQRT_M, 0.002), 1e-10 * (7.0 * 0.998_f64).powi(3), 1e-12);
    // Compression counts as nothing; beyond the ratios those of the nearest one, said.
    near(two.rate(7.0 * MPA_SQRT_M, -0.5), two.rate(7.0 * MPA_SQRT_M, 0.0), 1e-15);
    near(two.rate(30.0 * MPA_SQRT_M, 0.6), 8.0e-10 * 12.0_f64.powi(3), 1e-12);
    let [held, with_gamma] = [None, Some(0.5)].map(|gamma| Table::new(one.curves.clone(), false, gamma, true));
    for (table, ratio, words) in [
        (&two, 0.51, None),
        (&two, -0.5, None),
        (&one, 0.6, None),
        (&two, 0.6, Some("above 0 to 0.5, the ratios of the table of rates; rates of R = 0.5 used (non-conservative)")),
        (&held, -0.1, Some("below 0.1, the ratio of the table of rates; rates of R = 0.1 used (conservative)")),
        (&with_gamma, 0.6, None),
    ] {
        let said = table.beyond_ratio(ratio);
        assert_eq!(said.as_deref().map(|said| said.split_once(" is ").unwrap().1), words, "{said:?}");
    }
    // Above the rates that both have the lower ratio may know more: there its rate counts, and nothing falls back.
    let short = Curve { rows: curve(0.5, 8.0).rows[..2].to_vec(), ..curve(0.5, 8.0) };
    let uneven = Table::new(vec![curve(0.0, 1.0), short], true, None, true);
    near(uneven.rate(35.0 / 0.75 * MPA_SQRT_M, 0.25), 1e-10 * 35.0_f64.powi(3), 1e-12);
    // Two ratios without a rate in common: nothing is known between them.
    let apart = Table::new(vec![curve(0.0, 1.0), curve(0.5, 1e6)], true, None, true);
    assert!(apart.beyond(20.0 / 0.75 * MPA_SQRT_M, 0.25).is_none());
}

/// A table with a curve of compression uses it, down to its ratio.
#[test]
fn a_table_may_have_negative_ratios() {
    let rows: String = [(-1.0, 4.0), (0.0, 1.0)]
        .map(|(ratio, scale)| [5.0_f64, 50.0].map(|k| format!("{k},{},{ratio}\n", scale * 1e-8 * k.powi(3))).concat())
        .concat();
    let text = format!("delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,stress_ratio\n{rows}");
    let keys = "growth_table = { file = \"rates.csv\", delta_k = \"tensile\" }\n";
    for (ratio, rate, words) in [(-1.0, 4e-5, ""), (-1.4, 4e-5, "R = -1.4 is below -1 to 0"), (0.0, 1e-5, "")] {
        let case = read_with(&text, keys, &[&format!("loading.stress_ratio={ratio:?}"), "model.method=handbook"]).unwrap();
        let LawSource::Factor(law) = &case.law else { panic!() };
        near(law.rate(10.0 * MPA_SQRT_M, ratio) / MM_PER_CYCLE, rate, 1e-9);
        let said = case.warnings.join("\n");
        assert!(said.contains(words) && said.contains("(non-conservative)") != words.is_empty(), "{ratio}: {said}");
        assert!(!said.contains("is ignored"), "{ratio}: {said}");
    }
}

/// Rows in any order, ratios that are one, and rates that scatter, with an outlier: the law that they come from.
#[test]
fn measured_rates_are_a_table() {
    let law = |k: f64| if k < 12.0 { 1e-8 * k.powi(4) } else { 1e-8 * 144.0 * k.powi(2) };
    let row = |i: usize, scatter: f64| {
        let k = 5.0 * 10.0_f64.powf(i as f64 / 59.0);
        let noise = (scatter * ((7919 * i % 101) as f64 / 50.0 - 1.0)).exp() * if scatter > 0.0 && i == 20 { 8.0 } else { 1.0 };
        format!("{k},{},{}\n", law(k) * noise, [0.094, 0.1, 0.106][i % 3])
    };
    for scatter in [0.0, 0.2] {
        let rows: String = (0..60).map(|i| row(37 * i % 60, scatter)).collect();
        let text = format!("delta_k_mpa_sqrt_m,da_dn_mm_per_cycle,stress_ratio\n{rows}");
        let case = read_with(&text, TABLE, &["model.method=handbook"]).unwrap();
        let LawSource::Factor(of_table) = &case.law else { panic!() };
        for k in [6.0, 10.0, 14.0, 25.0, 45.0] {
            near(of_table.rate(k / 0.9 * MPA_SQRT_M, 0.1) / MM_PER_CYCLE, law(k), if scatter > 0.0 { 0.15 } else { 0.01 });
        }
        let said = case.warnings.iter().any(|line| line.contains("scatter; rising curve") && line.contains("of 60 rates"));
        assert_eq!(said, scatter > 0.0, "{:?}", case.warnings);
    }
}

const PANEL: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 200\nthickness_mm = 2\ncrack_length_mm = 12\n\
    [material]\nyoungs_modulus_gpa = 71\npoisson_ratio = 0.3\n[loading]\nstress_max_mpa = 80\nstress_ratio = 0.1\n\
    [stop]\ncrack_length_mm = 30\n";

const FORMAN: &str = "forman_c_mm_per_cycle = 3e-5\nforman_m = 2.5\nk_c_mpa_sqrt_m = 60\n";
const NASGRO: &str = "nasgro_c_mm_per_cycle = 2e-7\nnasgro_n = 3\nnasgro_p = 0.5\nnasgro_q = 1\nnasgro_alpha = 1.5\n\
    nasgro_smax_over_flow = 0.3\nnasgro_delta_k_0_mpa_sqrt_m = 3\nnasgro_c_th = 1.5\nk_c_mpa_sqrt_m = 80\n";
const TABLE: &str = "growth_table = \"rates.csv\"\n";
const RATES: &str = "# rates of a sheet\ndelta_k_mpa_sqrt_m,da_dn_mm_per_cycle\n10,1e-4\n20,9e-4\n40,1.2e-2\n";

fn read_with(rates: &str, fatigue: &str, set: &[&str]) -> perilife_base::error::Result<Case> {
    let folder = Folder::at_hand([("rates.csv".to_owned(), rates.as_bytes().to_vec())]);
    let set: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Case::from_toml(&format!("{PANEL}[fatigue]\n{fatigue}"), "panel", folder, &set)
}

fn read(fatigue: &str, set: &[&str]) -> perilife_base::error::Result<Case> {
    read_with(RATES, fatigue, set)
}

/// The same law drives points and hand calculation, and both agree with quadrature of its formula.
#[test]
fn every_law_drives_points_and_hand_calculation() {
    for (text, kind) in [(FORMAN, "forman"), (NASGRO, "nasgro"), (TABLE, "table")] {
        let case = read(text, &["model.spacing_mm=1.5"]).unwrap();
        let LawSource::Factor(law) = &case.law else { panic!("{text}") };
        assert_eq!(law.kind.name(), kind);
        let named = read(&format!("growth_law = \"{kind}\"\n{text}"), &["model.spacing_mm=1.5"]).unwrap();
        assert_eq!(named.law, case.law);
        let by_points = predict(&case, &Silent).unwrap();
        let by_hand = predict(&read(text, &["model.method=handbook"]).unwrap(), &Silent).unwrap();
        println!("{kind}: {:.1} by points, {:.1} by hand", by_points.life_cycles(), by_hand.life_cycles());
        assert_eq!((by_points.stop, by_hand.stop), (by_hand.stop, perilife_growth::predict::StopReason::CrackLengthReached));
        near(by_points.life_cycles(), by_hand.life_cycles(), 0.02);
        let last = by_hand.curve.last().unwrap();
        assert!(last.growth_rate > by_hand.curve[0].growth_rate && last.growth_rate.is_finite());
        // The secant formula of the panel, with the law of the case at each length.
        let rate = |a: f64| {
            let k = case.loading.maximum * (std::f64::consts::PI * a / (std::f64::consts::PI * a / 0.1).cos()).sqrt();
            let LawSource::Factor(law) = &case.law else { return f64::NAN };
            law.rate(k, 0.1)
        };
        near(by_hand.life_cycles(), integrate(|a| 1.0 / rate(a), 12.0 * MM, 30.0 * MM, 1e-9).value, 1e-4);
    }
}

#[test]
fn k_c_is_where_the_plate_breaks() {
    let case = read(FORMAN, &["fatigue.k_c_mpa_sqrt_m=20", "model.spacing_mm=1.5"]).unwrap();
    assert_eq!(case.material.toughness, Some(20.0 * MPA_SQRT_M));
    for method in ["peridynamics", "handbook"] {
        let method = format!("model.method={method}");
        let run =
            predict(&read(FORMAN, &["fatigue.k_c_mpa_sqrt_m=20", "model.spacing_mm=1.5", &method]).unwrap(), &Silent).unwrap();
        assert_eq!(run.stop, perilife_growth::predict::StopReason::Toughness, "{method}");
        let last = run.curve.iter().rev().find(|row| row.delta_k.is_finite()).unwrap();
        assert!(last.delta_k <= 18.0 * MPA_SQRT_M * 1.01 && run.life_cycles() > 0.0, "{method}: {}", last.delta_k);
    }
    let tough = read(FORMAN, &["material.toughness_mpa_sqrt_m=30"]).unwrap();
    assert_eq!(tough.material.toughness, Some(30.0 * MPA_SQRT_M), "the lower of both");
}

/// Two laws, whichever they are, and a law beside the kind of another.
#[test]
fn a_second_law_is_refused() {
    const LAWS: [(&str, &str, &[&str]); 6] = [
        ("fitted", "fitted = \"fitted.toml\"\n", &["bond_law", "paris", "walker"]),
        ("a", "a = 6450\np = 2.86\nhorizon_mm = 3\n", &["bond_law"]),
        ("paris_c_mm_per_cycle", "paris_c_mm_per_cycle = 1e-7\nparis_m = 3\n", &["paris", "walker"]),
        ("forman_c_mm_per_cycle", "forman_c_mm_per_cycle = 3e-5\nforman_m = 2.5\n", &["forman"]),
        ("nasgro_c_mm_per_cycle", NASGRO, &["nasgro"]),
        ("growth_table", TABLE, &["table"]),
    ];
    let refused = |text: &str, words: [&str; 3]| {
        for method in ["handbook", "peridynamics"] {
            let error = read(text, &[&format!("model.method={method}")]).unwrap_err();
            assert_eq!(error.exit_code(), 2, "{text}: {error}");
            words.iter().for_each(|words| assert!(error.to_string().contains(words), "{words} in {error} of\n{text}"));
        }
    };
    for (i, (key, text, kinds)) in LAWS.into_iter().enumerate() {
        for (second, other, _) in &LAWS[i + 1..] {
            let both = format!("fatigue.{key}: a second growth law");
            refused(&format!("{text}{other}"), [&format!("fatigue.{second} = "), &both, "give one law"]);
        }
        for kind in GrowthLawKind::all().filter(|kind| !kinds.contains(&kind.name())) {
            let named = format!("growth_law = \"{kind}\"");
            refused(&format!("{named}\n{text}"), [&format!("fatigue.{key} = "), &named, "remove growth_law"]);
        }
    }
}

/// The ends of a table: an error that names the length, or the rate of the end, and how often.
#[test]
fn beyond_a_table() {
    let short = "delta_k_mpa_sqrt_m,da_dn_mm_per_cycle\n10,1e-4\n18,6e-4\n";
    for method in ["peridynamics", "handbook"] {
        let set = [&*format!("model.method={method}"), "model.spacing_mm=1.5"];
        let error = predict(&read_with(short, TABLE, &set).unwrap(), &Silent).unwrap_err();
        assert_eq!(error.exit_code(), 2);
        assert_says(&error.to_string(), &["growth_table", "18.0000 MPa√m", "at a crack length of", "held"]);
        let held = read_with(short, &format!("{TABLE}growth_table_ends = \"held\"\n"), &set).unwrap();
        let run = predict(&held, &Silent).unwrap();
        assert!(run.warnings.iter().any(|line| line.contains("beyond the table of rates")), "{:?}", run.warnings);
    }
}

#[test]
fn wrong_laws_are_refused() {
    for (rates, text, set, words) in rows::<Vec<(String, String, Vec<String>, Vec<String>)>>("growth_law", "wrong") {
        let set: Vec<&str> = set.iter().map(String::as_str).collect();
        let error = read_with(if rates.is_empty() { RATES } else { &rates }, &text, &set).unwrap_err();
        assert_eq!(error.exit_code(), 2, "{error}");
        assert_says(&format!("{text}: {error}"), &words);
    }
    let missing = Case::from_toml(&format!("{PANEL}[fatigue]\n{TABLE}"), "panel", Path::new("/nowhere"), &[]).unwrap_err();
    assert_eq!(missing.exit_code(), 4, "{missing}");
}

/// Tables of other programs, several ratios side by side: the rows that they stand for.
#[test]
fn wide_tables_of_other_programs_are_read() {
    let dadn = "# easigrow\n0.0 0.5\n1e-10 5.0 3.0\n1e-9 10.0 6.0\n1e-8 20.0 12.0\n";
    let lkpx = r#"<?xml version="1.0"?><Material units="English"><PropertyData property="tlookup"><DataTable>
        <Fields><Field pos="1" property="dadn"/><Field pos="2" property="r_0.5"/><Field pos="3" property="r_0.0"/></Fields>
        <Data><row><FieldData pos="1">1e-8</FieldData><FieldData pos="2">3</FieldData><FieldData pos="3">5</FieldData></row>
        <row><FieldData pos="1">1e-7</FieldData><FieldData pos="2">6</FieldData><FieldData pos="3">10</FieldData></row></Data>
        </DataTable></PropertyData></Material>"#;
    let read = |name: &str, text: &str| {
        let folder = Folder::at_hand([(name.to_owned(), text.as_bytes().to_vec())]);
        RateFile::Name(name.to_owned()).keys().read(&folder, "fatigue.growth_table").map(|(table, _)| table)
    };
    let table = read("a.dadn", dadn).unwrap();
    assert_eq!(table.rows.len(), 6);
    let row = &table.rows[4];
    near(row.delta_k, 6.0 * MPA_SQRT_M, 1e-12);
    near(row.rate, 1e-9, 1e-12);
    assert_eq!(row.ratio, 0.5);
    let table = read("a.lkpx", lkpx).unwrap();
    assert_eq!(table.rows.iter().map(|row| row.ratio).collect::<Vec<_>>(), [0.0, 0.0, 0.5, 0.5]);
    near(table.rows[1].delta_k, 10.0 * 1.098_843 * MPA_SQRT_M, 1e-5);
    near(table.rows[1].rate, 1e-7 * 0.0254, 1e-9);
    for (name, text, problem) in [
        ("a.dadn", "0.0 0.5\n1e-10 5.0\n", "has 2 numbers, expected 3"),
        ("a.dadn", "0.0\n1e-10 five\n", "is not a number"),
        ("a.dadn", "# nothing\n", "has no rows"),
        ("a.lkpx", "<Material></Material>", "no table of rates"),
        ("a.lkpx", "<Material><a></b></Material>", "is not XML"),
    ] {
        assert_refusal(read(name, text), &[problem]);
    }
}
