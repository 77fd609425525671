//! What cycle blocks of several breaks cost in life.
//!
//! Bonds are linear elastic, so strains are constant from one break to the next: a block of one break (mirror twins break
//! together) is exact in time, and the reference here.

use super::scene::{PANEL, SMALL};
use crate::error::Result;
use crate::predict::{Prediction, Silent, predict};
use crate::verify::Table;
use crate::verify::scene::case;

/// A plate with a slanted crack, whose tips break bonds at different times.
const SLANT: &str = r#"
[specimen]
kind = "plate"
width_mm = 60.0
length_mm = 120.0
thickness_mm = 2.0
cracks = [{ from_mm = [-8.0, -5.0], to_mm = [8.0, 5.0] }]
[material]
youngs_modulus_gpa = 72.0
poisson_ratio = 0.3
[loading]
stress_max_mpa = 70.0
stress_ratio = 0.1
[supports]
bottom = { rows_mm = 3.0, fix = ["x", "y"] }
[model]
spacing_mm = 1.0
[fatigue]
a = 6450.0
p = 2.86
horizon_mm = 3.015
driver = "bond_strain"
[stop]
crack_length_mm = 32.0
"#;

const SINGLE: [&str; 1] = ["fatigue.block=until_next_break"];

/// Error of the block controller against its bounds, and of blocks of several breaks or of fixed length.
///
/// # Errors
/// As [`predict`].
pub fn rows(table: &mut Table) -> Result<()> {
    let panel = |set: &[&str]| run(PANEL, &[&SMALL[..], &["model.spacing_mm=1"], set].concat());
    controlled(table, "M(T) W 110, a 20-27 mm, 1 mm", &panel)?;
    controlled(table, "slant crack, W 60, 19-32 mm, 1 mm", &|set| run(SLANT, set))?;
    uncontrolled(table, &panel)
}

/// Solves saved at the default bound and at 5 %, by a solver that takes long; nothing to save, and nothing lost, with the window.
fn controlled(table: &mut Table, scene: &str, run: &dyn Fn(&[&str]) -> Result<Prediction>) -> Result<()> {
    let single = run(&SINGLE)?;
    for percent in [1.0, 5.0] {
        let error = format!("fatigue.block_error_percent={percent}");
        let run = run(&["model.solver=multigrid", "fatigue.block=controlled", &error])?;
        let (blocks, of) = (run.figures.blocks, single.figures.blocks);
        let quantity = format!("{scene}: life with blocks controlled to {percent} %, {blocks} blocks for {of}");
        table.compare(quantity, run.life_cycles() / single.life_cycles(), 1.0, percent, "single breaks");
    }
    let exact = run(&["fatigue.block=controlled"])?.life_cycles() / single.life_cycles();
    table.compare(format!("{scene}: life with controlled blocks by the window"), exact, 1.0, 1e-9, "single breaks");
    Ok(())
}

/// Blocks of several breaks with frozen strains, and blocks of fixed length.
fn uncontrolled(table: &mut Table, run: &dyn Fn(&[&str]) -> Result<Prediction>) -> Result<()> {
    let single = run(&SINGLE)?;
    let mut row = |what: String, set: &[&str], reason: &str| -> Result<()> {
        let ratio = run(set)?.life_cycles() / single.life_cycles();
        table.compare(
            format!("M(T) W 110, a 20-27 mm, 1 mm: life with {what} over single breaks"),
            ratio,
            1.0,
            1.0,
            "single breaks",
        );
        table.known_miss(reason);
        Ok(())
    };
    for bonds in [2, 6, 24] {
        let set = [SINGLE[0], &format!("fatigue.bonds_per_block={bonds}")];
        row(
            format!("{bonds} breaks a block"),
            &set,
            "bonds spent in one block do not feel each other's break; \"controlled\" is the default",
        )?;
    }
    for parts in [1000.0, 100.0] {
        let set = ["fatigue.block=fixed", &format!("fatigue.block_cycles={}", single.life_cycles() / parts)];
        row(
            format!("blocks of 1/{parts} of life"),
            &set,
            "bonds break at the end of their block only, and the next to break wait; \"controlled\" is the default",
        )?;
    }
    Ok(())
}

fn run(text: &str, set: &[&str]) -> Result<Prediction> {
    predict(&case(text, set)?, &Silent)
}
