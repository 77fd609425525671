//! `chart.csv`.

use crate::cells::defused;
use crate::chart::{Chart, Point, Status};
use crate::report::csv::exact;

/// Columns of `chart.csv`.
pub const COLUMNS: &str = "scene,method,driver,bond_law,solver,discretisation,spacing_mm,horizon_ratio,step,points,solves,error_percent,\
                           path_rms_mm,truth,truth_uncertainty_percent,wall_s,time_ratio,runs,spread_percent,memory_mb,threads,version,\
                           extrapolated,status,command,choice,on_front,reason";

/// One row a point, in the order of scenes and choices.
pub fn csv(chart: &Chart) -> String {
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing into memory cannot fail.
    let _ = writer.write_record(COLUMNS.split(','));
    for point in &chart.points {
        let _ = writer.write_record(fields(point, chart).iter().map(|text| defused(text).into_owned()));
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

fn fields(point: &Point, chart: &Chart) -> Vec<String> {
    let (scene, run) = (point.scene, point.run.as_ref());
    let model = |of: fn(&crate::chart::run::Model) -> &str| run.map_or_else(String::new, |run| of(&run.model).to_owned());
    let number = |value: Option<f64>| value.map_or_else(String::new, exact);
    let count = |value: Option<usize>| value.map_or_else(String::new, |count| count.to_string());
    vec![
        scene.name.to_owned(),
        point.choice.family.name().to_owned(),
        model(|model| &model.driver),
        model(|model| &model.bond_law),
        model(|model| &model.solver),
        model(|model| &model.discretisation),
        number(run.and_then(|run| run.model.spacing_mm)),
        number(run.and_then(|run| run.model.horizon_ratio)),
        number(run.and_then(|run| run.model.step)),
        count(run.map(|run| run.points)),
        count(run.map(|run| run.solves)),
        number(run.map(|run| run.error_percent)),
        number(run.and_then(|run| run.path_rms_mm)),
        scene.truth.to_owned(),
        exact(scene.truth_uncertainty_percent),
        number(point.wall_s()),
        number(point.time_ratio()),
        point.walls.len().to_string(),
        number(point.spread_percent()),
        number(run.map(|run| run.memory_mb)),
        chart.machine.threads.to_string(),
        chart.machine.version.to_owned(),
        (point.status == Status::Extrapolated).to_string(),
        point.status.name().to_owned(),
        point.command(),
        point.choice.name(),
        point.is_on_front.to_string(),
        point.reason.clone(),
    ]
}
