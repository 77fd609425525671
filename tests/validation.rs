//! Does it match the world?

mod examples;
mod fe_plates;
mod fracture_scenes;
mod fuzz_cases;
mod kept_back;
mod notched_plates;
mod plate_band;
mod population;
mod virkler;
mod mechanics5;
mod practice5;
mod published;
