//! `chart.svg`: a panel a scene, seconds against percent on common logarithmic scales, colour a method, mark a solver.

use std::fmt::Write as _;

use super::{Origin, digits, escaped, seconds};
use crate::chart::{Chart, Family, Point, Scene, Status, schedule};
use crate::report::labels::{Box2, place_labels};

/// Size of a panel, px; margins of its plotting area: left, right, top, bottom.
const PANEL: [f64; 2] = [430.0, 330.0];
const MARGINS: [f64; 4] = [48.0, 14.0, 58.0, 42.0];
const HEAD: f64 = 104.0;
const FOOT: f64 = 44.0;
const COLUMNS: usize = 3;
/// Errors, percent, and seconds between which the scales lie, whatever lies beyond.
const ERRORS: [f64; 2] = [0.002, 100.0];
const SECONDS_LEAST: f64 = 0.02;
/// 95 % quantile of the lives of 34 equal panels over their median of 253 726 cycles from 9 to 49.8 mm, less one, percent (Virkler, Hillberry
/// and Goel 1979).
const SCATTER_PERCENT: f64 = 12.3;
const LABEL: f64 = 11.0;

/// Colours of the families, in their order; told apart without red and green (Okabe and Ito 2008).
const COLOURS: [&str; Family::ALL.len()] = ["#0072b2", "#d55e00", "#222222", "#8a6d00", "#cc79a7", "#56b4e9", "#0072b2"];

/// Scales of all panels.
struct Scales {
    most_s: f64,
}

/// A panel in the making.
struct Panel<'c> {
    scene: &'c Scene,
    points: Vec<&'c Point>,
    at: [f64; 2],
}

/// The picture.
pub fn svg(chart: &Chart, origin: &Origin) -> String {
    let scenes = chart.scenes();
    let columns = scenes.len().clamp(1, COLUMNS);
    let rows = scenes.len().div_ceil(columns).max(1);
    let width = PANEL[0] * columns.max(2) as f64;
    let height = HEAD + PANEL[1] * rows as f64 + FOOT;
    let longest = chart.points.iter().filter_map(|point| Some(point.range_s()?[1])).fold(10.0, f64::max);
    let scales = Scales { most_s: 10.0_f64.powf((1.3 * longest).log10().ceil()) };
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"'IBM Plex Sans', 'Segoe UI', Helvetica, Arial, sans-serif\" font-size=\"12\" fill=\"#1c2430\" role=\"img\" \
         aria-label=\"Time of a run against its error, a panel a scene\">\n<rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    head(&mut text, chart, width);
    for (place, scene) in scenes.into_iter().enumerate() {
        let at = [PANEL[0] * (place % columns) as f64, HEAD + PANEL[1] * (place / columns) as f64];
        Panel { scene, points: chart.of(scene).collect(), at }.draw(&mut text, &scales, chart);
    }
    let footer = escaped(&origin.footer(chart).replace('`', ""));
    line_of_text(&mut text, [16.0, height - 16.0], "start", "#5b6675", &footer);
    text + "</svg>\n"
}

// Writing to a String cannot fail, hence `let _` below.

fn line_of_text(text: &mut String, [x, y]: [f64; 2], anchor: &str, colour: &str, words: &str) {
    let _ = writeln!(text, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"{colour}\">{words}</text>");
}

/// Title, and what colours and marks mean.
fn head(text: &mut String, chart: &Chart, width: f64) {
    let _ = writeln!(
        text,
        "<text x=\"16\" y=\"26\" font-size=\"18\" font-weight=\"600\">What a result costs, and how far off it is</text>"
    );
    let mut x = 16.0;
    for family in schedule::families(&chart.points).into_iter().filter(|family| *family != Family::Solver) {
        let words = family.name();
        let _ = writeln!(text, "<circle cx=\"{:.1}\" cy=\"48\" r=\"5\" fill=\"{}\"/>", x + 5.0, colour(family));
        line_of_text(text, [x + 15.0, 52.0], "start", "#1c2430", words);
        x += 30.0 + width_of(words);
    }
    let marks = ["window", "multigrid", "direct", "adaptive_dynamic_relaxation", "quadrature"];
    x = 16.0;
    for solver in marks {
        let _ = writeln!(text, "<path d=\"{}\" fill=\"none\" stroke=\"#5b6675\"/>", outline(solver, [x + 5.0, 68.0], 5.0));
        line_of_text(text, [x + 15.0, 72.0], "start", "#1c2430", solver);
        x += 30.0 + width_of(solver);
    }
    let note = "Filled and named: no other point is both faster and nearer to the truth. Star: what runs when nothing is asked for. Bars: least \
                and largest time. Dashed: extrapolated.";
    line_of_text(text, [16.0, 92.0], "start", "#5b6675", &note[..note.len().min((width / 5.6) as usize)]);
}

fn colour(family: Family) -> &'static str {
    COLOURS[Family::ALL.iter().position(|other| *other == family).unwrap_or(0)]
}

fn width_of(words: &str) -> f64 {
    6.4 * words.chars().count() as f64
}

/// The mark of a solver about a centre.
fn outline(solver: &str, [x, y]: [f64; 2], r: f64) -> String {
    let polygon = |corners: &[[f64; 2]]| {
        let mut path = String::new();
        for (i, [u, v]) in corners.iter().enumerate() {
            let _ = write!(path, "{}{:.1} {:.1}", if i == 0 { 'M' } else { 'L' }, x + r * u, y + r * v);
        }
        path + "Z"
    };
    match solver {
        "multigrid" => polygon(&[[-0.9, -0.9], [0.9, -0.9], [0.9, 0.9], [-0.9, 0.9]]),
        "direct" => polygon(&[[0.0, -1.25], [1.25, 0.0], [0.0, 1.25], [-1.25, 0.0]]),
        "quadrature" => polygon(&[[0.0, -1.2], [1.1, 0.9], [-1.1, 0.9]]),
        "adaptive_dynamic_relaxation" => polygon(&[
            [-1.2, -0.4],
            [-0.4, -0.4],
            [-0.4, -1.2],
            [0.4, -1.2],
            [0.4, -0.4],
            [1.2, -0.4],
            [1.2, 0.4],
            [0.4, 0.4],
            [0.4, 1.2],
            [-0.4, 1.2],
            [-0.4, 0.4],
            [-1.2, 0.4],
        ]),
        _ => {
            let d = 2.0 * r;
            format!("M{:.1} {y:.1}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z", x - r)
        }
    }
}

impl Panel<'_> {
    /// Corners of the plotting area.
    fn frame(&self) -> Box2 {
        let [left, right, top, bottom] = MARGINS;
        Box2 { low: [self.at[0] + left, self.at[1] + top], high: [self.at[0] + PANEL[0] - right, self.at[1] + PANEL[1] - bottom] }
    }

    fn x(&self, scales: &Scales, seconds: f64) -> f64 {
        let frame = self.frame();
        let share = (seconds / SECONDS_LEAST).ln() / (scales.most_s / SECONDS_LEAST).ln();
        frame.low[0] + share.clamp(0.0, 1.0) * (frame.high[0] - frame.low[0])
    }

    fn y(&self, percent: f64) -> f64 {
        let frame = self.frame();
        let share = (percent.max(1e-12) / ERRORS[0]).ln() / (ERRORS[1] / ERRORS[0]).ln();
        frame.high[1] - share.clamp(0.0, 1.0) * (frame.high[1] - frame.low[1])
    }

    fn draw(&self, text: &mut String, scales: &Scales, chart: &Chart) {
        let frame = self.frame();
        let title = escaped(self.scene.about);
        let _ = writeln!(
            text,
            "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"13.5\" font-weight=\"600\">{title}</text>",
            frame.low[0] - 32.0,
            self.at[1] + 18.0
        );
        let quantity = self.scene.quantity.split(',').next().unwrap_or_default();
        line_of_text(
            text,
            [frame.low[0] - 32.0, self.at[1] + 36.0],
            "start",
            "#5b6675",
            &format!("Error of {}, %", escaped(quantity)),
        );
        self.grid(text, scales);
        self.limits(text);
        self.front(text, scales);
        self.left_out(text);
        let drawn: Vec<(&Point, [f64; 2])> = self
            .points
            .iter()
            .filter_map(|point| point.place().map(|(time, error)| (*point, [self.x(scales, time), self.y(error)])))
            .collect();
        // What counts is drawn last, on top.
        let rank = |point: &Point| (point.is_on_front, point.choice.is_default());
        let mut ordered = drawn.clone();
        ordered.sort_by_key(|(point, _)| rank(point));
        ordered.iter().for_each(|(point, at)| self.mark(text, scales, chart, point, *at));
        self.names(text, &drawn);
    }

    fn grid(&self, text: &mut String, scales: &Scales) {
        let frame = self.frame();
        for power in -1..=(scales.most_s.log10().round() as i32) {
            let value = 10.0_f64.powi(power);
            let x = self.x(scales, value);
            let _ = writeln!(
                text,
                "<line x1=\"{x:.1}\" x2=\"{x:.1}\" y1=\"{:.1}\" y2=\"{:.1}\" stroke=\"#e3e7ec\"/>",
                frame.low[1], frame.high[1]
            );
            line_of_text(text, [x, frame.high[1] + 16.0], "middle", "#5b6675", &format!("{value}"));
        }
        for value in [0.01, 0.1, 1.0, 10.0, 100.0] {
            let y = self.y(value);
            let _ = writeln!(
                text,
                "<line x1=\"{:.1}\" x2=\"{:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"#e3e7ec\"/>",
                frame.low[0], frame.high[0]
            );
            line_of_text(text, [frame.low[0] - 6.0, y + 4.0], "end", "#5b6675", &format!("{value}"));
        }
        line_of_text(text, [frame.high[0], frame.high[1] + 32.0], "end", "#5b6675", "Time of a run, s");
    }

    /// Scatter of the material, and what the truth cannot tell.
    fn limits(&self, text: &mut String) {
        let frame = self.frame();
        let [left, right] = [frame.low[0], frame.high[0]];
        if self.scene.truth_uncertainty_percent > ERRORS[0] {
            let y = self.y(self.scene.truth_uncertainty_percent);
            let _ = writeln!(
                text,
                "<rect x=\"{left:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"#e9edf2\"/>",
                right - left,
                frame.high[1] - y
            );
            line_of_text(text, [right - 4.0, y + 13.0], "end", "#5b6675", "below the error of the truth");
        }
        if self.scene.grows() {
            let y = self.y(SCATTER_PERCENT);
            let _ = writeln!(
                text,
                "<line x1=\"{left:.1}\" x2=\"{right:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"#7a5300\" stroke-dasharray=\"3 3\"/>"
            );
            line_of_text(text, [right - 4.0, y - 4.0], "end", "#7a5300", "scatter of equal panels, 12 %");
        }
    }

    fn front(&self, text: &mut String, scales: &Scales) {
        let frame = self.frame();
        let mut front: Vec<(f64, f64)> = self.points.iter().filter(|p| p.is_on_front).filter_map(|p| p.place()).collect();
        front.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut path = String::new();
        for (i, (time, error)) in front.iter().enumerate() {
            let (x, y) = (self.x(scales, *time), self.y(*error));
            let _ = if i == 0 { write!(path, "M{x:.1} {:.1}V{y:.1}", frame.low[1]) } else { write!(path, "H{x:.1}V{y:.1}") };
        }
        if !path.is_empty() {
            let _ =
                writeln!(text, "<path d=\"{path}H{:.1}\" fill=\"none\" stroke=\"#1c2430\" stroke-width=\"1.4\"/>", frame.high[0]);
        }
    }

    /// Grey crosses for what was refused, failed or not done.
    fn left_out(&self, text: &mut String) {
        let frame = self.frame();
        let bad: Vec<&&Point> = self.points.iter().filter(|point| point.place().is_none()).collect();
        if bad.is_empty() {
            return;
        }
        let y = frame.low[1] - 10.0;
        line_of_text(text, [frame.high[0] - 12.0 * bad.len() as f64 - 6.0, y + 4.0], "end", "#8893a1", "no result");
        for (i, point) in bad.iter().enumerate() {
            let x = frame.high[0] - 12.0 * (bad.len() - i) as f64 + 4.0;
            let title = escaped(&format!("{}: {}: {}", point.choice.name(), point.status, point.reason));
            let index = self.number(point);
            let _ = writeln!(
                text,
                "<g class=\"p\" data-at=\"{index}\"><path d=\"M{:.1} {:.1}l8 8m0 -8l-8 8\" stroke=\"#8893a1\" stroke-width=\"1.6\"/>\
                 <title>{title}</title></g>",
                x - 4.0,
                y - 4.0
            );
        }
    }

    /// What the page calls a point: scene and choice.
    fn number(&self, point: &Point) -> String {
        escaped(&format!("{}/{}", self.scene.name, point.choice.name()))
    }

    fn mark(&self, text: &mut String, scales: &Scales, chart: &Chart, point: &Point, at: [f64; 2]) {
        let Some(run) = &point.run else { return };
        let colour = colour(point.choice.family);
        let fill = if point.is_on_front { colour } else { "#ffffff" };
        let dash = if point.status == Status::Extrapolated { " stroke-dasharray=\"2 2\"" } else { "" };
        let shape = outline(&run.model.solver, at, 4.6);
        let wall = point.wall_s().unwrap_or(f64::NAN);
        let title = format!(
            "{}: {}, {} %, {} solves, {} times the reference run of {}",
            point.choice.name(),
            seconds(wall),
            digits(run.error_percent),
            run.solves,
            digits(point.time_ratio().unwrap_or(f64::NAN)),
            seconds(chart.reference_s)
        );
        let _ = write!(text, "<g class=\"p\" data-at=\"{}\">", self.number(point));
        if let Some([least, most]) = point.range_s() {
            let [from, to] = [least, most].map(|value| self.x(scales, value));
            let y = at[1];
            let _ = write!(text, "<line x1=\"{from:.1}\" x2=\"{to:.1}\" y1=\"{y:.1}\" y2=\"{y:.1}\" stroke=\"{colour}\"/>");
        }
        if point.choice.is_default() {
            let _ = write!(text, "<path d=\"{}\" fill=\"#f2c14e\" stroke=\"#1c2430\" stroke-width=\"0.8\"/>", star(at, 10.0));
        }
        let _ = writeln!(
            text,
            "<path d=\"{shape}\" fill=\"{fill}\" stroke=\"{colour}\" stroke-width=\"1.3\"{dash}/><title>{}</title></g>",
            escaped(&title)
        );
    }

    /// Names of the points on the front, of the default and of the published law.
    fn names(&self, text: &mut String, drawn: &[(&Point, [f64; 2])]) {
        let is_named = |point: &Point| point.is_on_front || point.choice.is_default() || point.choice.family == Family::Published;
        let named: Vec<usize> = (0..drawn.len()).filter(|&i| is_named(drawn[i].0)).collect();
        let places: Vec<[f64; 2]> = drawn.iter().map(|(_, at)| *at).collect();
        let words: Vec<String> = named.iter().map(|&i| short_name(drawn[i].0)).collect();
        let sizes: Vec<[f64; 2]> = words.iter().map(|words| [0.88 * width_of(words), LABEL + 2.0]).collect();
        for ((&i, spot), words) in named.iter().zip(place_labels(self.frame(), &places, &[], &named, &sizes)).zip(&words) {
            let [x, y] = spot.centre();
            let near = spot.nearest(places[i]);
            if (near[0] - places[i][0]).hypot(near[1] - places[i][1]) > 14.0 {
                let _ = writeln!(
                    text,
                    "<line x1=\"{:.1}\" y1=\"{:.1}\" x2=\"{:.1}\" y2=\"{:.1}\" stroke=\"#8893a1\" stroke-width=\"0.7\"/>",
                    places[i][0], places[i][1], near[0], near[1]
                );
            }
            let colour = colour(drawn[i].0.choice.family);
            // Its white rim first, as text of its own: not every program draws a rim below the letters.
            for paint in ["fill=\"none\" stroke=\"#ffffff\" stroke-width=\"3\"", &format!("fill=\"{colour}\"")] {
                let _ = writeln!(
                    text,
                    "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"{LABEL}\" {paint}>{}</text>",
                    y + 4.0,
                    escaped(words)
                );
            }
            let _ = writeln!(
                text,
                "<text x=\"{x:.1}\" y=\"{:.1}\" text-anchor=\"middle\" font-size=\"{LABEL}\" fill=\"{colour}\" stroke=\"#ffffff\" \
                 stroke-width=\"3\" paint-order=\"stroke\">{}</text>",
                y + 4.0,
                escaped(words)
            );
        }
    }
}

/// The name of a point beside its mark.
fn short_name(point: &Point) -> String {
    let family = match point.choice.family {
        Family::TipField => "tips",
        Family::ElementFree => "nodes",
        Family::Handbook => "handbook",
        Family::BondStrain => "bond strain",
        Family::Published => "published law",
        Family::BondLaw | Family::Solver => "",
    };
    match (family, point.choice.words.as_str()) {
        (family, "") if point.wall_s().is_some_and(|wall| wall < SECONDS_LEAST) => {
            format!("{family}, {}", seconds(point.wall_s().unwrap_or(f64::NAN)))
        }
        (family, "") => family.to_owned(),
        ("", words) => words.replace("adaptive_dynamic_", ""),
        (family, words) => format!("{family}, {words}"),
    }
}

/// A star of five points about a centre.
fn star([x, y]: [f64; 2], r: f64) -> String {
    let corner = |i: usize| {
        let (sin, cos) = (std::f64::consts::PI * i as f64 / 5.0).sin_cos();
        let r = if i.is_multiple_of(2) { r } else { 0.45 * r };
        format!("{}{:.1} {:.1}", if i == 0 { 'M' } else { 'L' }, x + r * sin, y - r * cos)
    };
    (0..10).map(corner).collect::<String>() + "Z"
}
