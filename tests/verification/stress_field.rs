//! Stress over a plate in pieces: they tile it, its loaded edges carry the load, flanks carry nothing and are open.

use perilife_base::units::{MM, MPA};
use perilife_growth::predict::moment::stress_field;
use perilife_growth::predict::{Silent, predict};
use perilife_nodes::stress_field::Corner;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::{distance, polygon_area};

use crate::support::plates;

const PLATE: &str =
    "kind = \"plate\"\nwidth_mm = 60\nlength_mm = 100\nthickness_mm = 2\ncracks = [{ from_mm = [-9, 0], to_mm = [9, 0] }]\n";

#[test]
fn pieces_tile_the_plate_and_flanks_are_open() {
    let case = plates::case(PLATE, &["model.method=element_free_galerkin", "stop.crack_length_mm=24"]);
    let field = stress_field(&case, &predict(&case, &Silent).unwrap()).unwrap().unwrap();
    let half = 0.5 * field.cracks[0].length();
    assert!(half > 9.0 * MM && half < 12.0 * MM, "the crack of a row late in the life");
    let places = |piece: &[Corner]| piece.iter().map(|corner| corner.at).collect::<Vec<Point>>();
    let area: f64 = field.pieces.iter().map(|piece| polygon_area(&places(piece))).sum();
    assert!((area / (60.0 * MM * 100.0 * MM) - 1.0).abs() < 1e-6, "{area}");
    let sides = |piece: &Vec<Corner>| {
        let side = |k: usize| distance(piece[k].at, piece[(k + 1) % piece.len()].at);
        (0..piece.len()).filter(|k| piece[*k].is_free).map(side).sum::<f64>()
    };
    let free: f64 = field.pieces.iter().map(sides).sum();
    assert!((free / (320.0 * MM + 4.0 * half) - 1.0).abs() < 1e-3, "rims and both flanks: {} mm", free / MM);
    // The stress of the load at the loaded edges.
    let corners = || field.pieces.iter().flatten();
    let loaded: Vec<f64> = corners().filter(|corner| corner.at[1] > 49.9999 * MM).map(|corner| corner.stress.y / MPA).collect();
    let mean = loaded.iter().sum::<f64>() / loaded.len() as f64;
    assert!(loaded.len() > 20 && (mean / 70.0 - 1.0).abs() < 0.02, "{mean}");
    // Flanks are 4 σ a V(2a/W) / E apart in the middle (Tada, Paris and Irwin, stress analysis of cracks, 0.6 %); no stress across them.
    let opening = |side: f64| -> Vec<(f64, f64)> {
        let is_above = |piece: &&Vec<Corner>| side * piece.iter().map(|corner| corner.at[1]).sum::<f64>() > 0.0;
        let on_flank = |corner: &&Corner| corner.at[1].abs() < 1e-9 && corner.at[0].abs() < 0.5 * half;
        let own = field.pieces.iter().filter(is_above).flatten().filter(on_flank);
        own.inspect(|corner| assert!(corner.stress.y.abs() < 0.1 * 70.0 * MPA, "{corner:?}"))
            .map(|corner| (corner.at[0], corner.displacement[1]))
            .collect()
    };
    let (above, below) = (opening(1.0), opening(-1.0));
    let middle = |side: &[(f64, f64)]| side.iter().min_by(|a, b| a.0.abs().total_cmp(&b.0.abs())).unwrap().1;
    let open = (middle(&above) - middle(&below)) / (4.0 * 70.0 * MPA * half / 72e9);
    let x = half / (30.0 * MM);
    let expected = -0.071 - 0.535 * x + 0.169 * x * x + 0.020 * x.powi(3) - 1.071 / x * (1.0 - x).ln();
    assert!(above.len() > 4 && (open / expected - 1.0).abs() < 0.02, "{open} for {expected}");
}
