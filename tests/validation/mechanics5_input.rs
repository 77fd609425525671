//! Input of `field/mechanics5` of the shared data: units of formulas, words of refusals, rollers.

use std::fs;
use std::path::Path;

use tempfile::{TempDir, tempdir};

use crate::interface::practice::copy;
use crate::support::field::{command, is_near, predicted};
use crate::support::rows::assert_says;
use crate::support::shared::shared;

/// A folder of the shared data in one of its own.
fn folder(readme: &str) -> Option<TempDir> {
    let from = shared(readme)?;
    let dir = tempdir().unwrap();
    copy(from.parent().unwrap(), dir.path());
    Some(dir)
}

/// A file with one text for another.
fn changed(folder: &Path, file: &str, [old, new]: [&str; 2]) -> String {
    let text = fs::read_to_string(folder.join(file)).unwrap();
    assert!(text.contains(old), "{old} in {file}");
    fs::write(folder.join("changed.toml"), text.replace(old, new)).unwrap();
    "changed.toml".to_owned()
}

#[test]
fn a_formula_of_residual_stress_has_the_units_of_its_key() {
    let Some(dir) = folder("field/mechanics5/formula_units/README.md") else { return };
    let (folder, bare) = (dir.path(), "residual_stress = \"-20*exp(-x^2)\"");
    for set in ["", " --set material.poisson_ratio=0.3"] {
        let (code, said) = command(folder, &format!("predict us_residual.toml{set} --out none"));
        assert_eq!(code, 2, "{said}");
        assert_says(
            &said,
            &[
                "us_residual.toml:15",
                "loading.residual_stress = ",
                "specimen.width_in",
                "residual_stress_ksi",
                "residual_stress_mpa",
            ],
        );
    }
    let rows: String =
        (-150..=150).map(|i| f64::from(i) / 100.0).map(|x| format!("{x},0,{}\n", -20.0 * (-x * x).exp())).collect();
    fs::write(folder.join("field.csv"), format!("x_in,y_in,stress_ksi\n{rows}")).unwrap();
    // One field in five forms: 20 ksi are 137.895 MPa.
    let forms = [
        "residual_stress_ksi = \"-20*exp(-x^2)\"",
        "residual_stress_ksi = { y = \"-20*exp(-x^2)\" }",
        "residual_stress_mpa = \"-137.89514586336*exp(-(x/25.4)^2)\"",
        "residual_stress_file = \"field.csv\"",
    ];
    for (i, form) in forms.into_iter().enumerate() {
        let file = changed(folder, "us_residual.toml", [bare, form]);
        let (said, result) = predicted(folder, &format!("{file} --units us"));
        is_near(&result["life_cycles"], 580_451.0, if i < 3 { 1e-5 } else { 1e-3 }, form);
        assert!(!said.contains("error:"), "{said}");
        fs::remove_dir_all(folder.join("out")).unwrap();
        let (_, said) = command(folder, &format!("check {file} --units us"));
        assert!(said.contains(&format!("loading.{}", form.replace("\"field.csv\"", "field.csv"))), "{said}");
    }
    let file = changed(folder, "us_residual.toml", [bare, "residual_stress_ksi = \"1\"\nresidual_stress_mpa = \"7\""]);
    let (code, said) = command(folder, &format!("check {file}"));
    assert!(
        code == 2 && said.contains("loading.residual_stress_ksi = \"1\"") && said.contains("conflicts with residual_stress_mpa"),
        "{said}"
    );
}

#[test]
fn refusals_do_not_lead_to_another_plate() {
    let Some(dir) = folder("field/mechanics5/refusals/README.md") else { return };
    for file in ["ellipse.toml", "round_rect.toml"] {
        let (code, said) = command(dir.path(), &format!("check {file}"));
        assert!(code == 2 && said.contains("save it as DXF") && said.contains("circles") && !said.contains("remove"), "{said}");
    }
    let loads = [
        ("stress_max_mpa = -100.0", "stress_ratio = minimum / maximum"),
        ("stress_range_mpa = -100.0", "maximum - minimum"),
        ("force_max_kn = -40.0", "stress_ratio = minimum / maximum"),
        ("kind = \"displacement\"\ndisplacement_max_mm = -0.1", "stress_ratio = minimum / maximum"),
    ];
    for (load, remedy) in loads {
        let file = changed(dir.path(), "compress.toml", ["stress_max_mpa = -100.0", load]);
        let (code, said) = command(dir.path(), &format!("check {file}"));
        for word in
            [load.rsplit('\n').next().unwrap().split(' ').next().unwrap(), "compression alone does not grow a crack", remedy]
        {
            assert!(code == 2 && said.contains(word), "{word} in {said}");
        }
    }
    // What is asked for is taken.
    let file = changed(dir.path(), "compress.toml", ["-100.0\nstress_ratio = 0.1", "50.0\nstress_ratio = -2"]);
    let (code, said) = command(dir.path(), &format!("check {file}"));
    assert_eq!(code, 0, "{said}");
}

/// The work of narrow rollers does not depend on how nodes lie beside them, and what is left of a severed plate asks for no warning.
#[test]
fn narrow_rollers_do_work_over_their_width() {
    let Some(dir) = folder("validation/pmma_scb_30/README.md") else { return };
    for width in ["1.0", "0.2"] {
        let file = changed(dir.path(), "case.toml", ["contact_width_mm = 1.0", &format!("contact_width_mm = {width}")]);
        for tolerance in ["2", "0.5"] {
            let (said, result) = predicted(dir.path(), &format!("{file} --set model.tolerance_percent={tolerance}"));
            let check = &result["k_cross_check"]["largest_difference_percent"];
            assert!(check.as_f64().is_some_and(|difference| difference.abs() < 0.5), "{width}, {tolerance}: {check}");
            assert!(result["error_estimate_percent"].as_f64().is_some_and(|error| error < 3.0), "{width}, {tolerance}: {said}");
            assert!(!said.contains("crack-face contact cannot") && result["stop_reason"] == "left_plate", "{said}");
            fs::remove_dir_all(dir.path().join("out")).unwrap();
        }
    }
}
