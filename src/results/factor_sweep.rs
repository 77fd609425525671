//! `perilife sif --sweep` as tables: K, T, β and compliance over crack length, and β alone for AFGROW-like programs.

use perilife_base::columns::Table;
use perilife_base::units::{MM, MPA, MPA_SQRT_M};
use perilife_growth::predict::factor_sweep::{FactorSweep, SweepRow};

/// What stands in the header of such a table, and of no other file.
pub const SIGN: &str = "crack_length_mm,tip,x_mm,y_mm,k_i_mpa_sqrt_m,k_ii_mpa_sqrt_m,t_stress_mpa,beta,cmod_mm";

/// The table of a sweep: a row for every length and tip; cells are empty of what the specimen has not.
pub fn table(sweep: &FactorSweep) -> Table {
    let of = |value: &dyn Fn(&SweepRow) -> Option<f64>| sweep.rows.iter().map(value).collect::<Vec<_>>();
    Table::new("sweep.csv")
        .numbers("crack_length_mm", of(&|row| Some(row.crack_length / MM)))
        .counts("tip", sweep.rows.iter().map(|row| row.tip))
        .numbers("x_mm", of(&|row| Some(row.position[0] / MM)))
        .numbers("y_mm", of(&|row| Some(row.position[1] / MM)))
        .numbers("k_i_mpa_sqrt_m", of(&|row| Some(row.factors[0] / MPA_SQRT_M)))
        .numbers("k_ii_mpa_sqrt_m", of(&|row| Some(row.factors[1] / MPA_SQRT_M)))
        .numbers("t_stress_mpa", of(&|row| Some(row.t_stress? / MPA)))
        .numbers("beta", of(&|row| Some(row.beta)))
        .numbers("cmod_mm", of(&|row| Some(row.mouth_opening? / MM)))
        .numbers("beta_length_mm", of(&|row| Some(row.beta_length / MM)))
        .numbers("load_line_displacement_mm", of(&|row| Some(row.load_line? / MM)))
        .numbers("back_face_strain", of(&|row| row.back_face_strain))
}

/// β of the tip that grows farthest over its own a, as [`perilife_plate::specimen::beta`] reads it.
pub fn beta_table(sweep: &FactorSweep) -> Table {
    let rows = || sweep.rows.iter().filter(|row| row.tip == sweep.lead && row.beta > 0.0);
    Table::new("beta.csv")
        .numbers("crack_length_mm", rows().map(|row| row.beta_length / MM))
        .numbers("beta", rows().map(|row| row.beta))
}
