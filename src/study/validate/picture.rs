//! `validate.svg`: predicted over measured lives, a color per kind, bars for the band.

use super::{Kind, Row};
use perilife_results::axis::Axis;
use perilife_results::chart::{COLOURS, Frame, INK, LARGE, Mark, NOTE, Size};

pub fn svg(rows: &[Row]) -> String {
    let of = |kind: Kind| rows.iter().filter(move |row| row.kind == kind.name() && row.ratio.is_some());
    let kinds: Vec<(Kind, &str)> =
        Kind::all().filter(|kind| of(*kind).next().is_some()).zip(COLOURS.iter().copied().cycle()).collect();
    let names: Vec<String> = kinds.iter().map(|(kind, _)| kind.name().replace('_', " ")).collect();
    let mut legend: Vec<(Mark, &str, &str)> =
        kinds.iter().zip(&names).map(|((_, colour), name)| (Mark::Dots, *colour, &**name)).collect();
    legend.push((Mark::Dashes, NOTE, "factor 2"));
    let lives = || rows.iter().flat_map(|row| [row.measured, row.predicted]).flatten();
    let axes = [Axis::logarithmic_wide(lives()), Axis::logarithmic_wide(lives())];
    let [from, to] = axes[0].ends();
    let names = ["Measured life, cycles or passes", "Predicted life, cycles or passes"];
    let size = Size { height: 700.0, ..LARGE };
    let mut frame = Frame::new(size, "Published tests: predicted and measured lives", axes, names, &legend);
    frame.line(&[[from, from], [to, to]], INK, 1.2, "");
    frame.line(&[[from, 2.0 * from], [0.5 * to, to]], NOTE, 1.0, "8 5");
    frame.line(&[[2.0 * from, from], [to, 0.5 * to]], NOTE, 1.0, "8 5");
    for (row, colour) in kinds.into_iter().flat_map(|(kind, colour)| of(kind).map(move |row| (row, colour))) {
        let at = |life: Option<f64>| Some([row.measured?, life?.clamp(from, to)]);
        let band: Vec<[f64; 2]> = [row.predicted_p05, row.predicted_p95].into_iter().filter_map(at).collect();
        frame.line(&band, colour, 1.0, "");
        at(row.predicted).into_iter().for_each(|place| frame.ring(place, colour));
    }
    frame.finish("Predicted over measured lives of published tests, with lines of equality and of a factor of 2")
}
