//! Does it match the world?

#[path = "support/shared.rs"]
mod shared;

#[path = "validation/fe_plates.rs"]
mod fe_plates;
#[path = "validation/examples.rs"]
mod examples;
#[path = "validation/fracture_scenes.rs"]
mod fracture_scenes;
#[path = "validation/fit_engine.rs"]
mod fit_engine;
#[path = "validation/fit_virkler.rs"]
mod fit_virkler;
#[path = "validation/fuzz_cases.rs"]
mod fuzz_cases;
#[path = "validation/kept_back.rs"]
mod kept_back;
#[path = "validation/median_virkler.rs"]
mod median_virkler;
#[path = "validation/notched_plates.rs"]
mod notched_plates;
#[path = "validation/rivals.rs"]
mod rivals;
#[path = "validation/stability.rs"]
mod stability;
#[path = "validation/rates_virkler.rs"]
mod rates_virkler;
