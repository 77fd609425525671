//! Loads and supports on the points of a body.

use std::path::Path;

use perilife_growth::case::Case;
use perilife_points::body::Body;

/// A plate held at the bottom, with a horizontal crack at a height (mm) that decides where the rows of points lie.
fn body(height: f64, correction: &str) -> Body {
    let text = format!(
        "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\n\
         cracks = [{{ from_mm = [-15, {height}], to_mm = [5, {height}] }}]\n[material]\nname = \"al2024-t3\"\n\
         [loading]\nstress_max_mpa = 10\nstress_ratio = 0\n[supports]\nbottom = {{ fix = [\"x\", \"y\"] }}\n\
         [model]\nspacing_mm = 2\nsurface_correction = \"{correction}\"\n[fatigue]\na = 1\np = 2\nhorizon_mm = 1"
    );
    built(&text)
}

fn built(text: &str) -> Body {
    let case = Case::from_toml(text, "plate", Path::new(""), &[]).unwrap();
    let model = case.points();
    Body::build(&case.specimen, &case.material, &model.bond_law, model.spacing, model.horizon_ratio, 0.0).unwrap()
}

/// With rows anywhere against the edge a support holds exactly the nearest one, and the whole load comes in.
#[test]
fn a_support_holds_one_row_wherever_the_rows_lie() {
    for i in 0..16 {
        let height = -57.0 + 0.25 * f64::from(i);
        let body = body(height, "volume_and_surface");
        let mut rows: Vec<usize> =
            body.boundary.fixed.iter().map(|(place, _)| body.lattice.column_row(*place as usize).1).collect();
        let held = rows.len();
        rows.dedup();
        assert_eq!((held, rows.len()), (30, 1), "crack at y = {height} mm");
        let force: f64 = body.boundary.forces.iter().map(|(_, force)| force[1]).sum();
        assert!((force - 0.06 * 0.002).abs() < 1e-12, "crack at y = {height} mm: {force}");
    }
}

/// Resultant, moment and work on uniform strain are those of the traction on the edge itself, wherever the rows lie against it.
#[test]
fn the_balanced_correction_loads_the_true_edge() {
    for i in 0..16 {
        let height = -57.0 + 0.25 * f64::from(i);
        let body = body(height, "balanced");
        let sum = |of: &dyn Fn([f64; 2], [f64; 2]) -> f64| -> f64 {
            body.boundary.forces.iter().map(|&(place, force)| of(body.lattice.position(place as usize), force)).sum()
        };
        let force = 0.06 * 0.002;
        for (what, computed, exact) in [
            ("force", sum(&|_, f| f[1]), force),
            ("side force", sum(&|_, f| f[0]), 0.0),
            ("work along y", sum(&|x, f| x[1] * f[1]), force * 0.06),
            ("moment", sum(&|x, f| x[0] * f[1] - x[1] * f[0]), 0.0),
        ] {
            assert!((computed - exact).abs() < 1e-12 * force, "crack at y = {height} mm, {what}: {computed:e} against {exact:e}");
        }
    }
}

/// Bonds stay positive and bounded, and those with all neighbours about them keep the multiplier of the infinite lattice.
#[test]
fn the_balanced_correction_changes_bonds_near_the_rim_only() {
    let body = body(0.0, "balanced");
    let depth = body.stencil.reach + 1;
    for (bond, &multiplier) in body.multiplier.iter().enumerate().filter(|(_, m)| **m > 0.0) {
        assert!((0.2..=5.0).contains(&multiplier), "{multiplier}");
        let (_, from, to) = body.ends(bond as u32);
        let inside = [from, to].iter().all(|&place| {
            let (column, row) = body.lattice.column_row(place);
            let within = |i: usize, count: usize| i >= depth && i + depth < count;
            within(column, body.lattice.columns) && within(row, body.lattice.rows)
        });
        assert!(!inside || multiplier == 1.0, "{multiplier}");
    }
}

/// Whatever the arc over which a pin touches its hole, its whole force arrives, along its direction, and the narrower the arc
/// the farther from the plate's middle it pushes.
#[test]
fn a_pin_brings_its_force_over_any_arc() {
    let mut reach = Vec::new();
    for half_angle in [15.0, 45.0, 90.0] {
        let text = format!(
            "[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 120\nthickness_mm = 2\n\
             holes = [{{ x_mm = 0, y_mm = 30, diameter_mm = 20 }}, {{ x_mm = 0, y_mm = -30, diameter_mm = 20 }}]\n\
             cracks = [{{ from_mm = [-30, 0], to_mm = [-15, 0] }}]\n[material]\nname = \"al2024-t3\"\n[loading]\nforce_max_n = 100\n\
             stress_ratio = 0\npins = [{{ hole = 0, direction = [0, 1], contact_half_angle_deg = {half_angle} }}, \
             {{ hole = 1, direction = [0, -1], contact_half_angle_deg = {half_angle} }}]\n\
             [model]\nspacing_mm = 1\n[fatigue]\na = 1\np = 2\nhorizon_mm = 1"
        );
        let body = built(&text);
        let upper = |of: &dyn Fn([f64; 2], [f64; 2]) -> f64| -> f64 {
            let forces = body.boundary.forces.iter().map(|&(place, force)| (body.lattice.position(place as usize), force));
            forces.filter(|(at, _)| at[1] > 0.0).map(|(at, force)| of(at, force)).sum()
        };
        let (across, along, moment) = (upper(&|_, f| f[0]), upper(&|_, f| f[1]), upper(&|x, f| x[0] * f[1] - x[1] * f[0]));
        assert!(across.abs() < 1e-9 && (along - 1.0).abs() < 1e-3 && moment.abs() < 1e-9, "{half_angle}°: {across} {along}");
        reach.push(upper(&|x, f| x[1] * f[1]));
    }
    assert!(reach[0] > reach[1] && reach[1] > reach[2], "{reach:?}");
    // The middle of a narrow arc lies at the rim, 40 mm up; of a cosine over half the circle at 30 + 10 · 8/3π mm.
    assert!((reach[0] - 0.04).abs() < 1e-3 && (reach[2] - 0.0385).abs() < 1e-3, "{reach:?}");
}
