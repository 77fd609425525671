//! Pins that touch their holes where elasticity says; arcs and K beside their references are the topic `pins`.

use std::path::Path;

use perilife_growth::case::{Case, Model};
use perilife_growth::cracks::initial_tips;
use perilife_growth::nodes::NodePlate;
use perilife_growth::points::PointPlate;
use perilife_plate::specimen::{Bearing, Load};

/// C(T) of 50 x 10 mm under 10 kN with pins of 0.998 of its holes.
fn compact() -> Case {
    let text = "[specimen]\nkind = \"compact_tension\"\nwidth_mm = 50\nthickness_mm = 10\ncrack_length_mm = 15\npin_diameter_mm = 12.475\n\
                pin_friction = 0\n[loading]\nforce_max_kn = 10\nstress_ratio = 0\n[material]\nyoungs_modulus_gpa = 70\n\
                poisson_ratio = 0.3\nplane = \"stress\"\n[fatigue]\nparis_c_mm_per_cycle = 1e-8\nparis_m = 3\n";
    Case::from_toml(text, "compact", Path::new(""), &[]).unwrap()
}

/// Pressure is the force of the pin, and no piece pulls.
#[test]
fn contact_carries_the_force_of_its_pin() {
    for load in compact().specimen.loads {
        let Load::Pin { contact: Bearing::Elastic(pin), .. } = load else { panic!("{load:?}") };
        let contact = pin.found.unwrap();
        let [along, across] = contact.pieces.iter().fold([0.0; 2], |sum, piece| {
            let (sin, cos) = piece.angle.sin_cos();
            [sum[0] + piece.share * cos, sum[1] + piece.share * sin]
        });
        assert!((along - 1.0).abs() < 1e-9 && across.abs() < 1e-9, "{along}, {across}");
        assert!(contact.pieces.iter().all(|piece| piece.share > 0.0));
        // Nodes read what holes without cracks do nearly as it is carried.
        assert!(contact.residual < 0.005, "{}", contact.residual);
    }
}

#[test]
fn points_take_the_contact_of_nodes() {
    let case = compact();
    let points = Case { model: Model::Points(case.points()), ..case.clone() };
    let of_nodes = initial_tips::<NodePlate>(&case).unwrap().tips[0].factors.unwrap()[0];
    let of_points = initial_tips::<PointPlate>(&points).unwrap().tips[0].factors.unwrap()[0];
    assert!((of_points / of_nodes - 1.0).abs() < 0.01);
}
