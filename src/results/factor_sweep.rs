//! `perilife sif --sweep` as tables: K, T, β and compliance over crack length, and β alone for AFGROW-like programs.

use super::csv::number;
use perilife_base::units::{MM, MPA, MPA_SQRT_M};
use perilife_growth::predict::factor_sweep::{FactorSweep, SweepRow};
use perilife_plate::specimen::beta::HEADER;

/// First line of the table of a sweep.
pub const COLUMNS: &str = "crack_length_mm,tip,x_mm,y_mm,k_i_mpa_sqrt_m,k_ii_mpa_sqrt_m,t_stress_mpa,beta,cmod_mm,beta_length_mm,\
     load_line_displacement_mm,back_face_strain";

/// The table of a sweep: a row for every length and tip; cells are empty of what the specimen has not.
pub fn table(sweep: &FactorSweep) -> String {
    let row = |row: &SweepRow| {
        let known = |value: Option<f64>, unit: f64| number(value.map_or(f64::NAN, |value| value / unit));
        let [x, y] = row.position.map(|place| number(place / MM));
        let [k_i, k_ii] = row.factors.map(|factor| number(factor / MPA_SQRT_M));
        let length = number(row.crack_length / MM);
        let head = [length, row.tip.to_string(), x, y, k_i, k_ii, known(row.t_stress, MPA), number(row.beta)];
        let tail = [
            known(row.mouth_opening, MM),
            number(row.beta_length / MM),
            known(row.load_line, MM),
            known(row.back_face_strain, 1.0),
        ];
        head.into_iter().chain(tail).collect::<Vec<_>>().join(",")
    };
    lines(COLUMNS, sweep.rows.iter().map(row))
}

/// β of the tip that grows farthest over its own a, as [`perilife_plate::specimen::beta`] reads it.
pub fn beta_table(sweep: &FactorSweep) -> String {
    let rows = sweep.rows.iter().filter(|row| row.tip == sweep.lead && row.beta > 0.0);
    lines(HEADER, rows.map(|row| format!("{},{}", number(row.beta_length / MM), number(row.beta))))
}

fn lines(head: &str, rows: impl Iterator<Item = String>) -> String {
    std::iter::once(head.to_owned()).chain(rows).map(|line| line + "\n").collect()
}
