//! `perilife calibrate ... --predict ...`, `export` and `rates` on the committed calibration, coarse enough for every check.

use std::fs;
use std::path::Path;

use perilife_growth::case::record::FittedRecord;
use perilife_results::curve::read_a_n;
use tempfile::{TempDir, tempdir};

use crate::interface::cli::{assert_refused, perilife, texts};
use crate::support::daily::panel_without_law;
use crate::support::desk::{done, json};
use crate::support::rows::assert_says;

/// Makes the calibration coarse: a longer first crack keeps six points in front of the load line of a 3 mm lattice.
const COARSE: [&str; 6] =
    ["--set", "model.spacing_mm=3", "--set", "specimen.crack_length_mm=18", "--set", "measured.from_crack_length_mm=18"];

/// The same panel from 20 to 40 mm, which the fit covers.
fn panel() -> String {
    let plate = panel_without_law().replace("crack_length_mm = 9.0", "crack_length_mm = 20.0");
    plate.replace("method = \"handbook\"", "spacing_mm = 3.0") + "[stop]\ncrack_length_mm = 40.0\n"
}

/// A copy of the committed calibration, its measured table and a case to predict.
fn copy_of_the_calibration() -> TempDir {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/al2024-t3");
    let dir = tempdir().unwrap();
    fs::create_dir(dir.path().join("measured")).unwrap();
    for file in ["case.toml", "measured/virkler_median.csv"] {
        fs::copy(from.join(file), dir.path().join(file)).unwrap();
    }
    fs::write(dir.path().join("panel.toml"), panel()).unwrap();
    dir
}

#[test]
fn a_calibration_with_a_prediction_and_its_export() {
    let dir = copy_of_the_calibration();
    let fit = dir.path().join("out/fit");
    let arguments = [&["calibrate", "case.toml", "--out", "out/fit", "-v", "--predict", "panel.toml"][..], &COARSE].concat();
    let (stdout, _) = done(dir.path(), &arguments);
    assert_says(&stdout, &["al2024-t3, R = 0.2: da/dN = ", "(fitted to median)", ", p = ", "panel: life", "crack length limit"]);

    // The files that are promised, and no temporary ones.
    for file in ["fitted.toml", "fit.json", "fit_curves.csv", "rates.csv", "fit.svg", "da_dn.svg", "readings.csv", ".perilife"] {
        assert!(fs::metadata(fit.join(file)).unwrap().len() > 0, "{file}");
    }
    for file in
        ["a_n.csv", "crack_path.csv", "result.json", "a_n.svg", "da_dn.svg", "plate.svg", "k.svg", "factors.csv", "beta.txt"]
    {
        assert!(fs::metadata(fit.join("panel").join(file)).unwrap().len() > 0, "{file}");
    }
    assert_eq!(fs::read_dir(dir.path().join("out")).unwrap().count(), 1, "nothing but the fit stands there");

    // The record reads back and says what fit.json says; a case that names it reads it.
    let record: FittedRecord = toml::from_str(&fs::read_to_string(fit.join("fitted.toml")).unwrap()).unwrap();
    let report = json(fit.join("fit.json"));
    // The JSON reader may miss the last bit of a number.
    for (key, value) in [("a", record.a), ("p", record.p)] {
        assert!((report[key].as_f64().unwrap() / value - 1.0).abs() < 1e-15, "{key}: {report}");
    }
    assert!((1.5..8.0).contains(&record.p) && (1.0..5.0).contains(&record.paris_m), "{record:?}");
    assert!(report["rms_life_error"].as_f64().unwrap() < 0.2, "{report}");
    let with_record = panel() + "[fatigue]\nfitted = \"out/fit/fitted.toml\"\n";
    fs::write(dir.path().join("again.toml"), with_record).unwrap();
    done(dir.path(), "check again.toml");

    // The predicted curve, resampled: as many rows as asked for, ending at the life, neither column ever falls.
    let arguments = ["export", "out/fit/panel", "--points", "200", "--out", "a_n.csv"];
    done(dir.path(), &arguments);
    let rows = read_a_n(&dir.path().join("a_n.csv")).unwrap();
    assert_eq!(rows.len(), 200);
    assert_eq!(Some(rows[199].cycles), json(fit.join("panel/result.json"))["life_cycles"].as_f64());
    assert!(rows.windows(2).all(|w| w[0].cycles < w[1].cycles && w[0].crack_length_mm <= w[1].crack_length_mm));
    assert!((rows[0].crack_length_mm - 20.0).abs() < 1e-9 && (rows[199].crack_length_mm - 40.0).abs() < 1e-9);

    // The rates that were fitted are a table of rates: a law of Paris through them is the one of the fit.
    let rates = fs::read_to_string(fit.join("rates.csv")).unwrap();
    let intervals = fs::read_to_string(fit.join("fit_curves.csv")).unwrap().lines().count() - 2;
    assert_eq!(rates.lines().count() - 1, intervals, "{rates}");
    let of_rates = "[measured]\nrates = [\"out/fit/rates.csv\"]\n[fit]\nlaw = \"paris\"\n";
    fs::write(dir.path().join("of_rates.toml"), of_rates).unwrap();
    done(dir.path(), "calibrate of_rates.toml --out out/rates --json");
    let [by_rates, by_lives] = ["out/rates", "out/fit"].map(|folder| json(dir.path().join(folder).join("fit.json")));
    let of = |value: &serde_json::Value| value.as_f64().unwrap();
    assert!((of(&by_rates["constants"]["paris_m"]) / of(&by_lives["paris_m"]) - 1.0).abs() < 0.1, "{by_rates}");
    assert!(dir.path().join("out/rates/rates.csv").is_file());
    // The misfit at both ends, as the reader of the summary sees it.
    for end in ["low", "high"] {
        assert!(by_lives["misfit_at_ends"][end]["rate_over_law_percent"].is_number(), "{by_lives}");
    }
    assert!(stdout.lines().any(|line| line.starts_with("  At the ends    ")), "{stdout}");
    // Fields for ParaView are those of cases and scenes.
    let asked = ["calibrate", "case.toml", "--out", "no", "--set", "output.paraview=true"];
    assert_refused(&perilife(dir.path(), &asked), 2, &["output", "applies only to a case or scene"]);

    // A file inside the folder of the fit is not an export's to replace; the fit itself is no run.
    assert_refused(&perilife(dir.path(), "export out/fit --out b.csv"), 2, &["inside this calibration"]);
}

#[test]
fn a_slip_in_a_case_to_predict_costs_no_calibration() {
    let dir = copy_of_the_calibration();
    fs::write(dir.path().join("slip.toml"), panel().replace("width_mm", "widht_mm")).unwrap();
    let arguments = ["calibrate", "case.toml", "--out", "out", "--predict", "panel.toml", "slip.toml"];
    assert_refused(&perilife(dir.path(), &arguments), 2, &["slip.toml:3", "specimen.widht_mm"]);
    let arguments = ["calibrate", "case.toml", "--out", "out", "--predict", "panel.toml", "panel.toml"];
    assert_refused(&perilife(dir.path(), &arguments), 2, &["--predict", "panel.toml", "same case name"]);
    assert!(!dir.path().join("out").exists());
}

#[test]
fn the_law_behind_three_stress_ratios_is_found() {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("calibration/compact-three-ratios/case.toml");
    let dir = tempdir().unwrap();
    done(dir.path(), &["calibrate", case.to_str().unwrap(), "--out", "fit"]);
    let fit: toml::Table = toml::from_str(&fs::read_to_string(dir.path().join("fit/fitted.toml")).unwrap()).unwrap();
    for (key, wanted) in [("paris_c_mm_per_cycle", 6.0e-8), ("paris_m", 3.1), ("walker_gamma", 0.65)] {
        let of = |section: &str| fit[section][key].as_float().unwrap();
        assert!((of("fatigue") - wanted).abs() < 3.0 * of("errors"), "{key}: {} ± {}", of("fatigue"), of("errors"));
    }
}

/// A table in place of a calibration file: the file to write is in the message, filled with what the table says, and can be used.
#[test]
fn a_table_gets_its_calibration_file() {
    let dir = tempdir().unwrap();
    let rows: String = (0..12).map(|i| format!("{},{},50,10,6.0,0.1\n", 5000 * i, 12.0 * 1.05_f64.powi(i))).collect();
    fs::write(dir.path().join("lab.csv"), format!("N,a (mm),W (mm),B (mm),Pmax (kN),R\n{rows}")).unwrap();
    for call in [&["check", "lab.csv"][..], &["calibrate", "lab.csv", "--out", "fit"]] {
        let output = perilife(dir.path(), call);
        let words = ["lab.csv: is a table of readings", "save these lines in its folder as lab.toml, fill in <...>"];
        assert_refused(&output, 2, &words);
        let (_, message) = texts(&output);
        let (_, lines) = message.split_once("\n\n").unwrap();
        for line in [
            "files = [\"lab.csv\"]",
            "# columns: N (cycles), a (mm) (length), Pmax (kN) (force_max), R (stress_ratio)",
            "width_mm = 50",
            "thickness_mm = 10",
            "crack_length_mm = 12 # first reading",
            "force_max_kn = 6",
            "stress_ratio = 0.1",
        ] {
            assert!(lines.lines().any(|written| written == line), "{line}: {lines}");
        }
        let lines = lines.replace("kind = <...>", "kind = \"compact_tension\"").replace("name = <...>", "name = \"al2024-t3\"");
        fs::write(dir.path().join("lab.toml"), lines.replace("length_mm = <...>", "")).unwrap();
        done(dir.path(), "check lab.toml");
    }
    // So do the lines above the table: what is certain is read, an alloy that the library does not have is a comment.
    let german = "Werkstoff;7075-T652\nProbenform;C(T)\nW (mm);50,00\nB (mm);6,35\nR;0,1\n";
    let rows: String = (0..6).map(|i| format!("{},0;{},0\n", i, 12 + i)).collect();
    let english =
        "# Specimen type: compact tension\n# Material: al2024-t3\n# W = 2 in, B = 6.35 mm, R = 0.1\n# B: 1,250 mm, R = 3 mm\n";
    for (above, table, lines) in [
        (
            german,
            format!("N (x1000);a (mm)\n{rows}"),
            [
                "kind = \"compact_tension\"",
                "width_mm = 50",
                "thickness_mm = 6.35",
                "name = <...> # Material in the file: 7075-T652; ",
            ],
        ),
        (
            english,
            "cycles,a (mm)\n0,9\n1000,9.5\n2000,10\n3000,10.6\n".to_owned(),
            ["kind = \"compact_tension\"", "width_mm = 50.8", "thickness_mm = 6.35", "name = \"al2024-t3\"\n"],
        ),
    ] {
        fs::write(dir.path().join("lab.csv"), above.to_owned() + &table).unwrap();
        let message = texts(&perilife(dir.path(), "calibrate lab.csv --out fit")).1;
        assert_says(&message, &lines);
        assert!(message.contains("stress_ratio = 0.1") && !message.contains("length_mm = <...> # of"), "{message}");
    }
    // What the table does not say stays open.
    fs::write(dir.path().join("lab.csv"), "cycles,crack_length_mm\n0,9\n1000,9.5\n2000,10\n3000,10.6\n4000,11.3\n").unwrap();
    let message = texts(&perilife(dir.path(), "check lab.csv")).1;
    assert_says(&message, &["width_mm = <...>", "force_max_kn = <...>", "stress_ratio = <...>"]);
}
