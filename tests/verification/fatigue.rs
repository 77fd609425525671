//! What a run must obey whatever its numbers: scaling with A and with load, symmetry, order, named ends, straight paths.

use std::collections::BTreeMap;
use std::sync::LazyLock;

use perilife_base::units::MM;
use perilife_growth::predict::{Prediction, Silent, StopReason, predict};
use perilife_points::bond_law::BondLawKind;
use perilife_points::solver::SolverKind;

use crate::support::plates::{BOND_STRAIN, TIP_FIELD, case, sound};
use crate::support::rows::rows;

const DRIVERS: [&str; 2] = [TIP_FIELD, BOND_STRAIN];

static PLATES: LazyLock<BTreeMap<String, String>> = LazyLock::new(|| rows("fatigue", "plates"));

/// Grows the crack of a plate, one of [`PLATES`] by its name, with run-out at 10⁷ cycles unless the case says otherwise.
fn grow(plate: &str, set: &[&str]) -> Prediction {
    let mut all = vec!["stop.cycles_max=1e7"];
    all.extend(set);
    predict(&case(PLATES.get(plate).map_or(plate, String::as_str), &all), &Silent).unwrap()
}

#[test]
fn doubling_a_halves_every_n() {
    let stop = "stop.crack_length_mm=24";
    for driver in DRIVERS {
        let (once, twice) = (grow("SLANT", &[driver, stop]), grow("SLANT", &[driver, stop, "fatigue.a=12900"]));
        assert_eq!(once.curve.len(), twice.curve.len());
        assert!(once.curve.len() > 3, "{driver}: {}", once.curve.len());
        for (a, b) in once.curve.iter().zip(&twice.curve) {
            assert!((a.cycles - 2.0 * b.cycles).abs() <= 1e-9 * a.cycles, "{driver}: {} against twice {}", a.cycles, b.cycles);
            assert!((a.crack_length - b.crack_length).abs() <= 1e-12, "{driver}: {} and {}", a.crack_length, b.crack_length);
        }
    }
}

/// The length of a plate's cracks grows by all tips; its da/dN is that of one (found by reading: twice that stood beside one ΔK).
#[test]
fn the_rate_of_a_plate_is_that_of_a_tip() {
    let run = grow("TWO", &[BOND_STRAIN, "model.spacing_mm=1", "stop.crack_length_mm=44"]);
    let (first, last) = (&run.curve[run.curve.len() / 4], &run.curve[3 * run.curve.len() / 4]);
    let cycles = last.cycles - first.cycles;
    let mean = |tip: usize| (last.tips[tip].growth - first.tips[tip].growth) / cycles;
    let fastest = (0..4).map(mean).fold(0.0, f64::max);
    let rows = run.curve.windows(2).filter(|pair| pair[0].cycles >= first.cycles && pair[1].cycles <= last.cycles);
    let written = rows.map(|pair| pair[1].growth_rate * (pair[1].cycles - pair[0].cycles)).sum::<f64>() / cycles;
    let all = (last.crack_length - first.crack_length) / cycles;
    assert!(all > 1.5 * fastest, "{all} of all tips, {fastest} of one");
    // At each row the fastest, which need not be one tip throughout.
    assert!((0.95..1.25).contains(&(written / fastest)), "{written} written, {fastest} of the fastest");
}

/// ε is proportional to load, so N goes with load^-p, exactly for a linear plate.
#[test]
fn life_falls_with_the_p_th_power_of_load() {
    let stop = "stop.crack_length_mm=16";
    for driver in DRIVERS {
        let (low, high) = (grow("PANEL", &[driver, stop]), grow("PANEL", &[driver, stop, "loading.stress_max_mpa=84"]));
        let ratio = low.life_cycles() / high.life_cycles();
        // 1.2^2.86; the solver leaves about 1e-9 in the strains.
        assert!((ratio / 1.2_f64.powf(2.86) - 1.0).abs() < 1e-6, "{driver}: {ratio}");
    }
}

#[test]
fn a_symmetric_plate_stays_symmetric() {
    // The line of a crack turns by the residual of K_II over K_I, bonds break on the middle line or beside it.
    for (driver, slack) in [(TIP_FIELD, 1e-8), (BOND_STRAIN, 1e-12)] {
        let run = grow("PANEL", &[driver, "stop.crack_length_mm=24"]);
        for point in &run.curve {
            let [left, right] = [point.tips[0], point.tips[1]];
            assert!((left.growth - right.growth).abs() < 1e-12, "{driver}: {} and {}", left.growth, right.growth);
            assert!((left.position[0] + right.position[0]).abs() < slack, "{driver}: {left:?}, {right:?}");
            assert!(left.position[1].abs() < slack && right.position[1].abs() < slack, "{driver}: {left:?}, {right:?}");
        }
        // Two tips and two halves: mirror twins break in one block.
        assert!(run.figures.blocks * 3 < run.curve.last().unwrap().broken_bonds * 2, "{driver}: {} blocks", run.figures.blocks);
    }
}

#[test]
fn every_scene_ends_with_a_named_stop_and_an_orderly_curve() {
    for (name, plate, set, ends) in rows::<Vec<(String, String, Vec<String>, Vec<String>)>>("fatigue", "ends") {
        let run = grow(&plate, &set.iter().map(String::as_str).collect::<Vec<_>>());
        assert!(ends.iter().any(|end| end == run.stop.name()), "{name} ended as {}", run.stop);
        let first = &run.curve[0];
        assert_eq!(first.cycles, 0.0, "{name}");
        assert_eq!(first.crack_length, case(&PLATES[&plate], &[]).specimen.crack_length, "{name}");
        sound(&name, &run);
        // Pictures count cycles as the curve does.
        let (shown, last) = (run.snapshots.last().unwrap(), run.curve.last().unwrap());
        let early = run.curve.iter().find(|row| row.cycles >= run.snapshots[0].cycles * (1.0 - 1e-12)).unwrap();
        assert!(early.crack_length - first.crack_length <= run.figures.spacing, "{name}: {} mm", early.crack_length / MM);
        assert!(shown.cycles <= last.cycles && shown.cycles >= 0.99 * last.cycles || run.stop == StopReason::RunOut, "{name}");
        if run.stop == StopReason::CrackLengthReached {
            assert!((run.crack_length_final() - 16.4 * MM).abs() < 1e-15);
        }
    }
}

/// Grows the crack of a case by every solver, a solve a break: the same bonds break at the same cycles, to 1e-6 of life.
fn assert_same_growth(name: &str, specimen: &str, set: &[&str]) {
    let grown_by = |solver: &SolverKind| {
        let chosen = format!("model.solver={solver}");
        let set = [set, &[&*chosen, BOND_STRAIN]].concat();
        let run = grow(specimen, &set);
        let last = run.curve.last().unwrap();
        (*solver, run.life_cycles(), last.broken_bonds, last.crack_length, run.stop)
    };
    let runs: Vec<_> = SolverKind::ALL.iter().map(grown_by).collect();
    let (_, life, broken, length, stop) = runs[0];
    assert!(life > 0.0 && broken > 0, "{name}: {runs:?}");
    for &(solver, other_life, other_broken, other_length, other_stop) in &runs[1..] {
        assert!((other_life / life - 1.0).abs() < 1e-6, "{name}: {runs:?}");
        assert!((other_length / length - 1.0).abs() < 1e-6, "{name}: {runs:?}");
        assert_eq!((other_broken, other_stop), (broken, stop), "{name}, {solver}");
    }
}

/// The window is exact: the same bonds break at the same cycles as with a solve of the whole plate per block. Every solver by every law
/// under the default driver: `tip_field_solvers.rs`.
#[test]
fn every_solver_grows_the_same_crack() {
    let set = ["stop.crack_length_mm=22", "model.spacing_mm=3"];
    assert_same_growth("slant", "SLANT", &set);
}

/// The same on finer plates.
#[test]
#[ignore = "long: a minute and a half"]
fn every_solver_grows_the_same_crack_on_every_plate() {
    let clamped = PLATES["EDGE"].replace("uniform_stress", "clamped");
    for (name, specimen, set) in [
        ("slant", "SLANT", vec!["stop.crack_length_mm=22"]),
        ("clamped", &clamped, vec!["stop.crack_length_mm=18"]),
        // Until K of the tip takes over.
        ("slot", "SLOT", vec!["stop.crack_length_mm=18"]),
        ("state-based", "SLANT", vec!["model.bond_law=state_based", "material.poisson_ratio=0.4", "stop.crack_length_mm=22"]),
    ] {
        assert_same_growth(name, specimen, &set);
    }
}

/// Every solver with every bond law on small cases: life equal to 1e-6.
#[test]
#[ignore = "long: a minute"]
fn every_solver_grows_the_same_crack_by_every_law() {
    for kind in BondLawKind::ALL {
        let law = format!("model.bond_law={kind}");
        let ratio = if *kind == BondLawKind::BondBased {
            "material.poisson_ratio=0.3333333333333333"
        } else {
            "material.poisson_ratio=0.3"
        };
        for (name, specimen, stop) in [
            ("middle tension", "PANEL", "stop.crack_length_mm=16"),
            ("compact", "COMPACT", "stop.crack_length_mm=24"),
            ("hole", "HOLE", "stop.crack_length_mm=18"),
            ("two cracks", "TWO", "stop.crack_length_mm=36"),
        ] {
            // Coarse, so that the direct solver takes milliseconds.
            let set = [&*law, ratio, stop, "model.spacing_mm=3"];
            assert_same_growth(&format!("{name}, {kind}"), specimen, &set);
        }
    }
}

/// Cyclic growth follows handbook ΔK with the exponent p: rate over ΔK^p per interval of a, 4 spacings each.
#[test]
fn a_centre_crack_grows_by_the_power_law() {
    let panel = "kind=\"middle_tension\"\nwidth_mm=152\nlength_mm=300\nthickness_mm=2.54\ncrack_length_mm=18\n";
    let p = 2.0;
    let run = grow(panel, &["stop.crack_length_mm=51", "stop.cycles_max=1e12", &format!("fatigue.p={p}")]);
    let formula = perilife_plate::specimen::handbook::handbook(&case(panel, &[]).specimen).unwrap();
    let cycles_at = |length: f64| {
        let pair = run.curve.windows(2).find(|pair| pair[1].crack_length >= length).unwrap();
        let share = (length - pair[0].crack_length) / (pair[1].crack_length - pair[0].crack_length);
        pair[0].cycles + share * (pair[1].cycles - pair[0].cycles)
    };
    // ∫ da/K^p over the interval (midpoints), over the cycles it took.
    let constants: Vec<f64> = (0..4)
        .map(|i| {
            let (low, step) = (18.0 * MM + i as f64 * 8.0 * MM, 0.08 * MM);
            let integral: f64 = (0..100).map(|j| step / formula.k_i(low + (j as f64 + 0.5) * step, 1.0).powf(p)).sum();
            integral / (cycles_at(low + 8.0 * MM) - cycles_at(low))
        })
        .collect();
    let mean = constants.iter().sum::<f64>() / 4.0;
    let relative: Vec<f64> = constants.iter().map(|c| c / mean).collect();
    assert!(relative.iter().all(|r| (r - 1.0).abs() < 0.03), "p {p}: {relative:?}");
}
