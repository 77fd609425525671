//! Does it match the world?

mod examples;
mod fe_plates;
mod fit_engine;
mod fit_virkler;
mod fracture_scenes;
mod fuzz_cases;
mod kept_back;
mod mechanics5_contact;
mod mechanics5_input;
mod mechanics5_pins;
mod mechanics5_plates;
mod median_virkler;
mod notched_plates;
mod plate_band;
mod published;
mod practice5_laws;
mod practice5_spectra;
mod population;
mod practice5_answers;
mod rates_virkler;
mod rivals;
mod stability;
