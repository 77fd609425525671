use crate::made_up_run;
use perilife::report::{chart, csv, damage, vtk};
use std::path::Path;

#[test]
fn pictures() {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR"));
    for (name, angle) in [("straight", 0.0), ("turned", 0.35)] {
        let run = made_up_run::prediction(angle);
        let paths: Vec<Vec<[f64; 2]>> =
            csv::paths(&run, &made_up_run::cracks()).into_iter().map(|p| p.into_iter().map(|(_, p)| p).collect()).collect();
        let cracks = made_up_run::cracks();
        let picture = damage::DamagePicture { grid: &run.grid, snapshot: &run.snapshots[2], cracks: &cracks, paths: &paths };
        picture.write(&dir.join(format!("damage_{name}.png"))).unwrap();
        std::fs::create_dir_all(dir.join(name)).unwrap();
        vtk::write_series(&dir.join(name), &run.grid, &run.snapshots).unwrap();
    }
    let run = made_up_run::prediction(0.0);
    let rows: Vec<csv::Row> = run.curve.iter().map(csv::Row::of).collect();
    let line = chart::Series {
        name: "predicted".into(),
        points: rows.iter().map(|r| (r.cycles, r.crack_length_mm)).collect(),
        mark: chart::Mark::Line,
    };
    let measured = chart::Series {
        name: "measured, 1 specimen".into(),
        points: rows.iter().step_by(9).map(|r| (r.cycles * 1.03, r.crack_length_mm)).collect(),
        mark: chart::Mark::Circles,
    };
    chart::crack_length(&dir.join("a_n.svg"), "slant_crack_plate: crack length over life", &[line, measured]).unwrap();
    let dots = chart::Series {
        name: "per cycle block".into(),
        points: rows.iter().map(|r| (r.delta_k_mpa_sqrt_m, r.da_dn_mm_per_cycle)).collect(),
        mark: chart::Mark::Dots,
    };
    let dash = chart::Series {
        name: "Paris law C = 1.0·10⁻⁸, m = 3.00".into(),
        points: rows.iter().map(|r| (r.delta_k_mpa_sqrt_m, 1e-8 * r.delta_k_mpa_sqrt_m.powi(3))).collect(),
        mark: chart::Mark::Dashes,
    };
    chart::growth_rate(&dir.join("da_dn.svg"), "slant_crack_plate: growth rate", &[dots, dash]).unwrap();
}
