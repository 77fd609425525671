//! Loads and supports on the points of a body.

use std::path::Path;

use perilife::body::Body;
use perilife::case::Case;

/// A plate held at the bottom, with a horizontal crack at a height (mm) that decides where the rows of points lie.
fn body(height: f64) -> Body {
    let text = format!(
        "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\n\
         cracks = [{{ from_mm = [-15, {height}], to_mm = [5, {height}] }}]\n[material]\nname = \"al2024-t3\"\n\
         [loading]\nstress_max_mpa = 10\nstress_ratio = 0\n[supports]\nbottom = {{ fix = [\"x\", \"y\"] }}\n\
         [model]\nspacing_mm = 2\n[fatigue]\na = 1\np = 2\nhorizon_mm = 1"
    );
    let case = Case::from_toml(&text, "plate", Path::new(""), &[]).unwrap();
    let model = &case.model;
    Body::build(&case.specimen, &case.material, &model.bond_law, model.spacing, model.horizon_ratio, 0.0).unwrap()
}

/// With rows anywhere against the edge a support holds exactly the nearest one, and the whole load comes in.
#[test]
fn a_support_holds_one_row_wherever_the_rows_lie() {
    for i in 0..16 {
        let height = -57.0 + 0.25 * f64::from(i);
        let body = body(height);
        let mut rows: Vec<usize> =
            body.boundary.fixed.iter().map(|(place, _)| body.lattice.column_row(*place as usize).1).collect();
        let held = rows.len();
        rows.dedup();
        assert_eq!((held, rows.len()), (30, 1), "crack at y = {height} mm");
        let force: f64 = body.boundary.forces.iter().map(|(_, force)| force[1]).sum();
        assert!((force - 0.06 * 0.002).abs() < 1e-12, "crack at y = {height} mm: {force}");
    }
}
