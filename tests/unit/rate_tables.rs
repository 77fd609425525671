//! Tables of da/dN over ΔK in every dress: read to the last digit, or refused by name.

use std::path::Path;
use std::sync::LazyLock;

use perilife_base::units::{MM_PER_CYCLE, MPA_SQRT_M};
use perilife_measured::rates::read;
use perilife_measured::{RangeKind, RateFileKeys, RateTable};

use crate::support::noise::Chance;
use crate::support::rows::{assert_refusal, rows};

/// Names of ΔK and of da/dN, each with MPa√m or mm/cycle in a unit of theirs.
static NAMES: LazyLock<[Vec<(String, f64)>; 2]> = LazyLock::new(|| ["delta_k", "rate"].map(|of| rows("rate_tables", of)));

/// Writes a table of rates by chance, reads it, and holds it against the truth; `true` where it was read.
fn try_table(seed: u64) -> bool {
    let mut chance = Chance::new(seed);
    let [(mut k_name, k_unit), (mut rate_name, rate_unit)] = NAMES.each_ref().map(|of| chance.of(of));
    let [log_k, log_rate] = [chance.below(6) == 0, chance.below(6) == 0];
    if log_k {
        k_name = format!("log10 {k_name}");
    }
    if log_rate {
        rate_name = format!("log {rate_name}");
    }
    let is_comma = chance.below(3) == 0;
    let separators: &[&str] = if is_comma { &[";", "\t", "; "] } else { &[",", ";", "\t", ", ", "|"] };
    let separator = chance.of(separators);
    // A name with the separator in it stands in quotes, which begin where the cell does.
    let separator = if k_name.contains(',') { separator.trim_end_matches(' ') } else { separator };
    let quoted = |name: &str| {
        if name.contains(separator.trim()) && !separator.trim().is_empty() { format!("\"{name}\"") } else { name.to_owned() }
    };
    let number = |value: f64, digits: usize| {
        let text = format!("{value:.digits$e}");
        if is_comma { text.replace('.', ",") } else { text }
    };
    let (says_ratio, swapped, count) = (chance.below(2) == 0, chance.below(2) == 0, 4 + chance.below(20));
    let damage = chance.below(8);
    let hurt = chance.below(count);
    let truth: Vec<(f64, f64)> =
        (0..count).map(|i| 6.0 * 7.0_f64.powf(i as f64 / (count - 1) as f64)).map(|k| (k, 3e-8 * k.powf(3.2))).collect();
    let row = |(i, (k, rate)): (usize, &(f64, f64))| {
        let scaled = |value: f64, is_log: bool| if is_log { value.log10() } else { value };
        let mut cells = vec![number(scaled(k / k_unit, log_k), 9), number(scaled(rate / rate_unit, log_rate), 9)];
        if swapped {
            cells.swap(0, 1);
        }
        if says_ratio {
            cells.push(number(0.1, 3));
        }
        match damage {
            0 if i == hurt => cells[0].clear(),
            1 if i == hurt => cells[1] = "n/a".to_owned(),
            2 if i == hurt => drop(cells.pop()),
            _ => {}
        }
        cells.join(separator)
    };
    let mut names = vec![quoted(&k_name), quoted(&rate_name)];
    if swapped {
        names.swap(0, 1);
    }
    if says_ratio {
        names.push(chance.of(&["stress_ratio", "R", "R ratio"]).to_owned());
    }
    let rows: Vec<String> = truth.iter().enumerate().map(row).collect();
    let text = format!("{}\n{}\n", names.join(separator), rows.join("\n"));
    let keys = RateFileKeys { stress_ratio: (!says_ratio).then_some(0.1), ..RateFileKeys::default() };
    match read(text.as_bytes(), Path::new("chance.csv"), &keys) {
        Err(error) => {
            assert!(error.exit_code() == 2 && error.to_string().contains("chance.csv"), "{error}\n{text}");
            assert!(damage < 3, "refused without a fault: {error}\n{text}");
            false
        }
        Ok(table) => {
            assert_eq!(table.rows.len(), count, "{text}");
            for (row, (k, rate)) in table.rows.iter().zip(&truth) {
                let (own_k, own_rate) = (row.delta_k / MPA_SQRT_M, row.rate / MM_PER_CYCLE);
                assert!((own_k / k - 1.0).abs() < 1e-7 && (own_rate / rate - 1.0).abs() < 1e-7, "{own_k} {own_rate}\n{text}");
                assert_eq!(row.ratio, 0.1, "{text}");
            }
            true
        }
    }
}

#[test]
fn tables_of_rates_by_chance_are_read_or_refused() {
    let read = (0..300).filter(|&seed| try_table(seed)).count();
    assert!(read > 150, "only {read} of 300 were read");
}

#[test]
#[ignore = "long: 2000 tables of rates by chance, cargo test --test all -- --ignored unit::rate_tables"]
fn many_tables_of_rates_by_chance_are_read_or_refused() {
    let read = (0..2000).filter(|&seed| try_table(seed)).count();
    println!("{read} of 2000 tables were read, the others refused by name");
    assert!(read > 1000);
}

fn table(text: &str, keys: &RateFileKeys) -> perilife_base::error::Result<RateTable> {
    read(text.as_bytes(), Path::new("rates.csv"), keys)
}

/// What a table does not say is asked for, and two answers are refused.
#[test]
fn what_a_table_of_rates_does_not_say_is_asked_for() {
    let plain = RateFileKeys::default();
    let with = |text: &str, keys: &RateFileKeys, words: &str| {
        assert_refusal(table(text, keys), &[words]);
    };
    with("dK,da/dN (mm/cycle),R\n6,1e-5,0.1\n", &plain, "has no unit");
    with("dK (Pa),da/dN (mm/cycle),R\n6,1e-5,0.1\n", &plain, "has an unknown unit");
    with("dK (MPa√m),da/dN (mm/cycle),R\n-0.7,1e-5,0.1\n", &plain, "log10");
    with("dK (MPa√m),da/dN (mm/cycle),R\n6,1e-5,1.1\n", &plain, "not a stress ratio below 1");
    let given = RateFileKeys { stress_ratio: Some(0.1), ..RateFileKeys::default() };
    with("dK (MPa√m),da/dN (mm/cycle),R\n6,1e-5,0.1\n", &given, "is a column, and stress_ratio = 0.1");
    let negative = "dK (MPa√m),da/dN (mm/cycle),R\n12,1e-5,-0.5\n";
    with(negative, &plain, "delta_k = \"full\"");
    for (range, tensile) in [(RangeKind::Full, 8.0), (RangeKind::Tensile, 12.0)] {
        let keys = RateFileKeys { delta_k: Some(range), ..RateFileKeys::default() };
        let found = table(negative, &keys).unwrap();
        assert!((found.rows[0].delta_k / MPA_SQRT_M / tensile - 1.0).abs() < 1e-12 && found.range == Some(range));
    }
}

/// K_max with another one of ΔK, K_min and R says all; ratios may stand side by side, and rates may be too small to be measured.
#[test]
fn ends_of_k_ratios_side_by_side_and_unmeasured_rates() {
    let plain = RateFileKeys::default();
    // ΔK 9 and R 0.1 at K_max 10; of R = -0.5 the tensile range is K_max, whatever ΔK is.
    for (header, row, ratio, delta_k) in [
        ("ΔK (MPa√m),Kmax (MPa√m)", "9,10", 0.1, 9.0),
        ("Delta K (MPa√m),K_max [MPa√m]", "9,10", 0.1, 9.0),
        ("dK (MPa√m),Max K (MPa√m)", "15,10", -0.5, 10.0),
        ("Kmax (MPa√m),R", "10,0.1", 0.1, 9.0),
        ("Kmax (MPa√m),R", "10,-0.5", -0.5, 10.0),
        ("Kmax (MPa√m),Kmin (MPa√m)", "10,1", 0.1, 9.0),
        ("K max (ksi√in),K min (MPa√m)", "9.1004773,-5", -0.5, 10.0),
        ("ΔK (MPa√m),Kmin (MPa√m)", "9,1", 0.1, 9.0),
        ("ΔK (MPa√m),Kmax (MPa√m),R", "9,10,0.1", 0.1, 9.0),
    ] {
        let found = table(&format!("{header},da/dN (mm/cycle)\n{row},1e-5\n"), &plain).unwrap();
        let [own, of_k] = [found.rows[0].ratio, found.rows[0].delta_k / MPA_SQRT_M];
        assert!(found.says_ratio && (own - ratio).abs() < 1e-4 && (of_k / delta_k - 1.0).abs() < 1e-6, "{header}: {own}, {of_k}");
    }
    // K_min below zero leaves open what ΔK is; R is then said to be -1 or -0.5.
    let text = "ΔK (MPa√m),Kmin (MPa√m),da/dN (mm/cycle)\n20,-10,1e-4\n";
    assert!(table(text, &plain).unwrap_err().to_string().contains("delta_k = \"full\""));
    for (range, ratio, delta_k) in [(RangeKind::Full, -1.0, 10.0), (RangeKind::Tensile, -0.5, 20.0)] {
        let keys = RateFileKeys { delta_k: Some(range), ..plain.clone() };
        let row = table(text, &keys).unwrap().rows.remove(0);
        assert!((row.ratio - ratio).abs() < 1e-9 && (row.delta_k / MPA_SQRT_M - delta_k).abs() < 1e-9, "{row:?}");
    }
    let refused = table("ΔK (MPa√m),Kmax (MPa√m),R,da/dN (mm/cycle)\n7,10,0.1,1e-5\n", &plain);
    assert_refusal(refused, &["gives a stress ratio of 0.300; the row has 0.1"]);
    assert_refusal(table("Kmax (MPa√m),da/dN (mm/cycle)\n10,1e-5\n", &plain), &["has no columns"]);
    for (text, first, said) in [
        ("da/dN (mm/cycle),R=0.1,R=0.5\n1e-6,5,4\n1e-5,9,\n", [0.1, 5.0], true),
        ("da/dN (mm/cycle),ΔK at R 0.1 (MPa√m)\n1e-6,5\n1e-5,9\n", [0.1, 5.0], false),
        ("da/dN (in/cycle);R0,1;R0,5\n3,937008e-8;4,550239;3,1\n", [0.1, 5.0], true),
        ("ΔK (MPa√m),R=-1 (mm/cycle),R=0.5 (mm/cycle)\n5,1e-6,2e-6\n", [-1.0, 5.0], false),
    ] {
        let keys = RateFileKeys { delta_k: Some(RangeKind::Tensile), ..plain.clone() };
        let found = table(text, &keys).unwrap();
        let row = &found.rows[0];
        assert!((row.rate / 1e-6 / MM_PER_CYCLE - 1.0).abs() < 1e-6 && row.ratio == first[0], "{text}: {row:?}");
        assert!((row.delta_k / first[1] / MPA_SQRT_M - 1.0).abs() < 1e-5, "{text}: {row:?}");
        assert_eq!(
            found.warnings.iter().any(|line| line.contains("the unit that matches the rates")),
            said,
            "{:?}",
            found.warnings
        );
    }
    assert_eq!(table("da/dN (mm/cycle),R=0.1,R=0.5\n1e-6,5,4\n1e-5,9,\n", &plain).unwrap().rows.len(), 3);
    for cell in ["<1e-8", "< 1e-8", "ND", "n.d.", "run-out", "Run out", "BDL", "< LOD", "no growth"] {
        let text = format!("ΔK (MPa√m),da/dN (mm/cycle),R\n3.25,{cell},0.1\n5,1e-6,0.1\n");
        let found = table(&text, &plain).unwrap();
        assert!(found.rows.len() == 1 && found.warnings[0].contains(&format!("= 3.25: {cell} (line 2)")), "{:?}", found.warnings);
    }
    assert_refusal(table("ΔK (MPa√m),da/dN (mm/cycle),R\n3.25,slow,0.1\n5,1e-6,0.1\n", &plain), &["is not a number"]);
}
