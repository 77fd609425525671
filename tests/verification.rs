//! Is the mathematics solved right?

#[path = "support/hand_cases.rs"]
mod hand_cases;
#[path = "support/plates.rs"]
mod plates;
#[path = "support/noise.rs"]
mod noise;
#[path = "support/statics.rs"]
mod statics;
#[path = "support/scenes.rs"]
mod scenes;
#[path = "support/shared.rs"]
mod shared;
#[path = "support/correspondence.rs"]
mod correspondence_bodies;

#[path = "verification/scene_checkpoint.rs"]
mod scene_checkpoint;
#[path = "verification/dynamics.rs"]
mod dynamics;
#[path = "verification/correspondence.rs"]
mod correspondence;
#[path = "verification/disc.rs"]
mod disc;
#[path = "verification/rigid_turn.rs"]
mod rigid_turn;
#[path = "verification/contact.rs"]
mod contact;
#[path = "verification/scene_default_law.rs"]
mod scene_default_law;
#[path = "verification/elasticity.rs"]
mod elasticity;
#[path = "verification/tip_field.rs"]
mod tip_field;
#[path = "verification/tip_field_solvers.rs"]
mod tip_field_solvers;
#[path = "verification/tension_plate.rs"]
mod tension_plate;
#[path = "verification/rate_constant.rs"]
mod rate_constant;
#[path = "verification/product.rs"]
mod product;
#[path = "verification/solvers.rs"]
mod solvers;
#[path = "verification/symmetry.rs"]
mod symmetry;
#[path = "verification/pressed_cracks.rs"]
mod pressed_cracks;
#[path = "verification/mirror_images.rs"]
mod mirror_images;
#[path = "verification/loads.rs"]
mod loads;
#[path = "verification/element_free.rs"]
mod element_free;
#[path = "verification/hard_plates.rs"]
mod hard_plates;
#[path = "verification/joined_cracks.rs"]
mod joined_cracks;
#[path = "verification/near_tip_fields.rs"]
mod near_tip_fields;
#[path = "verification/stress_intensity.rs"]
mod stress_intensity;
#[path = "verification/readme_accuracy.rs"]
mod readme_accuracy;
#[path = "verification/topics.rs"]
mod topics;
#[path = "verification/stability.rs"]
mod stability;
#[path = "verification/fatigue.rs"]
mod fatigue;
#[path = "verification/checkpoint.rs"]
mod checkpoint;
#[path = "verification/drawn_plates.rs"]
mod drawn_plates;
#[path = "verification/round_trip.rs"]
mod round_trip;
#[path = "verification/crack_length.rs"]
mod crack_length;
#[path = "verification/hand_calculation.rs"]
mod hand_calculation;
#[path = "verification/dual_horizon.rs"]
mod dual_horizon;
#[path = "verification/fracture_relaxation.rs"]
mod fracture_relaxation;
#[path = "verification/quasi_static.rs"]
mod quasi_static;
