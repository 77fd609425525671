//! Does each part do its job?

#[path = "support/fatigue_test.rs"]
mod fatigue_test;
#[path = "support/hand_cases.rs"]
mod hand_cases;
#[path = "support/made_up_case.rs"]
mod made_up_case;
#[path = "support/made_up_run.rs"]
mod made_up_run;
#[path = "support/noise.rs"]
mod noise;
#[path = "support/shared.rs"]
mod shared;

#[path = "unit/chart_parts.rs"]
mod chart_parts;
#[path = "unit/speed_chart.rs"]
mod speed_chart;
#[path = "unit/collinear.rs"]
mod collinear;
#[path = "unit/boundary.rs"]
mod boundary;
#[path = "unit/budget.rs"]
mod budget;
#[path = "unit/calibration_case.rs"]
mod calibration_case;
#[path = "unit/commands.rs"]
mod commands;
#[path = "unit/confidence.rs"]
mod confidence;
#[path = "unit/cross_check.rs"]
mod cross_check;
#[path = "unit/guard.rs"]
mod guard;
#[path = "unit/layering.rs"]
mod layering;
#[path = "unit/belonging.rs"]
mod belonging;
#[cfg(feature = "tables")]
#[path = "unit/cells.rs"]
mod cells;
#[path = "unit/import.rs"]
mod import;
#[path = "unit/laws.rs"]
mod laws;
#[path = "unit/malformed.rs"]
mod malformed;
#[path = "unit/measured.rs"]
mod measured;
#[path = "unit/pairs.rs"]
mod pairs;
#[path = "unit/practice.rs"]
mod practice;
#[path = "unit/misfit.rs"]
mod misfit;
#[path = "unit/monotone.rs"]
mod monotone;
#[path = "unit/obstacles.rs"]
mod obstacles;
#[path = "unit/output.rs"]
mod output;
#[path = "unit/pictures.rs"]
mod pictures;
#[path = "unit/rates.rs"]
mod rates;
#[path = "unit/report.rs"]
mod report;
#[path = "unit/residual_strength.rs"]
mod residual_strength;
#[path = "unit/case.rs"]
mod case;
#[path = "unit/exponent.rs"]
mod exponent;
#[path = "unit/fit_use.rs"]
mod fit_use;
#[path = "unit/floats.rs"]
mod floats;
#[path = "unit/growth_law.rs"]
mod growth_law;
#[path = "unit/growth_rate.rs"]
mod growth_rate;
#[path = "unit/hand_case.rs"]
mod hand_case;
#[path = "unit/handbook.rs"]
mod handbook;
#[path = "unit/quadrature.rs"]
mod quadrature;
#[path = "unit/limits.rs"]
mod limits;
#[path = "unit/loading.rs"]
mod loading;
#[path = "unit/specimen.rs"]
mod specimen;
#[cfg(feature = "tables")]
#[path = "unit/tables.rs"]
mod tables;
#[path = "unit/scene_results.rs"]
mod scene_results;
#[path = "unit/scene.rs"]
mod scene;
#[path = "unit/micro_cracks.rs"]
mod micro_cracks;
#[path = "unit/sweep.rs"]
mod sweep;
#[path = "unit/verification_table.rs"]
mod verification_table;
#[path = "unit/watch.rs"]
mod watch;
#[path = "unit/length_average.rs"]
mod length_average;
#[path = "unit/record.rs"]
mod record;
