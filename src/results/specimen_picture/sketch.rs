//! Lines, arrows and words in an SVG, placed by the plate's own coordinates; words with their quantities in the units that are shown.

use std::fmt::Write;

use perilife_base::units::MM;
use perilife_base::units::shown::told;
use perilife_plate::specimen::Point;

pub const PLATE: &str = "#e4e7eb";
pub const EDGE: &str = "#2f3b48";
pub const CRACK: &str = "#d0021b";
pub const LOAD: &str = "#1257a8";
/// Colour of supports.
pub const HELD: &str = "#5f6b2d";
pub const WORDS: &str = "#4a5560";

/// A drawing to scale: metres of the plate (y up) to pixels (y down).
pub struct Sketch {
    body: String,
    /// Pixels in a metre.
    pub scale: f64,
    /// Pixel of the plate's (0, 0).
    pub origin: Point,
}

impl Sketch {
    pub fn new(scale: f64, origin: Point) -> Self {
        Sketch { body: String::new(), scale, origin }
    }

    /// Pixel of a point of the plate.
    pub fn place(&self, p: Point) -> Point {
        [self.origin[0] + p[0] * self.scale, self.origin[1] - p[1] * self.scale]
    }

    /// Draws what has its coordinates in millimetres into a drawing in metres.
    pub fn in_mm(&mut self, draw: impl FnOnce(&mut Sketch)) {
        self.scale *= MM;
        draw(self);
        self.scale /= MM;
    }

    /// What is drawn as a group with these attributes: its class, by which a page colors it, and data that a page needs of it.
    pub fn group(&mut self, attributes: &str, draw: impl FnOnce(&mut Sketch)) {
        self.push(format_args!("<g {attributes}>"));
        draw(self);
        self.push(format_args!("</g>"));
    }

    fn push(&mut self, element: std::fmt::Arguments<'_>) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.body, "  {element}");
    }

    /// Closed polygon, plate coordinates.
    pub fn polygon(&mut self, corners: &[Point], fill: &str, stroke: &str) {
        let points = self.points(corners);
        self.push(format_args!(r#"<polygon points="{points}" fill="{fill}" stroke="{stroke}" stroke-width="1.4"/>"#));
    }

    fn points(&self, corners: &[Point]) -> String {
        let points: Vec<String> = corners.iter().map(|p| self.place(*p)).map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
        points.join(" ")
    }

    /// Circle, plate coordinates.
    pub fn circle(&mut self, centre: Point, radius: f64, fill: &str, stroke: &str) {
        let [x, y] = self.place(centre);
        let r = radius * self.scale;
        self.push(format_args!(
            r#"<circle cx="{x:.2}" cy="{y:.2}" r="{r:.2}" fill="{fill}" stroke="{stroke}" stroke-width="1.4"/>"#
        ));
    }

    /// Dot of fixed size in pixels.
    pub fn dot(&mut self, [x, y]: Point, radius: f64, fill: &str) {
        self.push(format_args!(r#"<circle cx="{x:.2}" cy="{y:.2}" r="{radius}" fill="{fill}"/>"#));
    }

    /// A cross of this half size about a place of the picture, px.
    pub fn cross(&mut self, [x, y]: Point, half: f64, stroke: &str, width: f64) {
        for up in [half, -half] {
            self.path(&[[x - half, y - up], [x + half, y + up]], stroke, width, "");
        }
    }

    /// Line between two pixels.
    pub fn line(&mut self, [x1, y1]: Point, [x2, y2]: Point, stroke: &str, width: f64) {
        self.push(format_args!(
            r#"<line x1="{x1:.2}" y1="{y1:.2}" x2="{x2:.2}" y2="{y2:.2}" stroke="{stroke}" stroke-width="{width}" stroke-linecap="round"/>"#
        ));
    }

    /// Arrow between two pixels, its head at the second.
    pub fn arrow(&mut self, from: Point, to: Point, stroke: &str, width: f64) {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = dx.hypot(dy).max(1e-9);
        let (ux, uy) = (dx / length, dy / length);
        let head = 4.0 + 2.0 * width;
        let wing = |side: f64| [to[0] - head * ux + side * 0.45 * head * uy, to[1] - head * uy - side * 0.45 * head * ux];
        let ([x1, y1], [x2, y2]) = (wing(1.0), wing(-1.0));
        self.line(from, [to[0] - 0.7 * head * ux, to[1] - 0.7 * head * uy], stroke, width);
        self.push(format_args!(
            r#"<polygon points="{:.2},{:.2} {x1:.2},{y1:.2} {x2:.2},{y2:.2}" fill="{stroke}"/>"#,
            to[0], to[1]
        ));
    }

    /// A piece of a line through two pixels whose width its group has, and the cycles at its end.
    pub fn step(&mut self, [from, to]: [Point; 2], stroke: &str, cycles: f64) {
        let way = corners(&[from, to]);
        self.push(format_args!(r#"<path d="M{way}" stroke="{stroke}" data-cycles="{cycles:.1}"/>"#));
    }

    /// Line through pixels; `dash` as in SVG, empty for a full line.
    pub fn path(&mut self, places: &[Point], stroke: &str, width: f64, dash: &str) {
        let points = pixels(places);
        let dash = if dash.is_empty() { String::new() } else { format!(r#" stroke-dasharray="{dash}""#) };
        self.push(format_args!(
            r#"<polyline points="{points}" fill="none" stroke="{stroke}" stroke-width="{width}" stroke-linejoin="round"{dash}/>"#
        ));
    }

    /// Sides of an upright rectangle between two corners, pixels.
    pub fn frame(&mut self, [[x0, y0], [x1, y1]]: [Point; 2], dash: &str) {
        self.path(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], EDGE, 1.0, dash);
    }

    /// Filled polygon of pixels without an edge, that lets what is below shine through.
    pub fn area(&mut self, places: &[Point], fill: &str, opacity: f64) {
        let points = pixels(places);
        self.push(format_args!(r#"<polygon points="{points}" fill="{fill}" fill-opacity="{opacity}"/>"#));
    }

    /// Filled polygons of pixels that share sides: a thin edge of their colour hides these. Written in tenths of a pixel, from corner to corner.
    pub fn areas(&mut self, polygons: &[Vec<Point>], fill: &str) {
        let mut way = String::new();
        for polygon in polygons {
            let mut corners: Vec<[i64; 2]> = polygon.iter().map(|corner| corner.map(|x| (10.0 * x).round() as i64)).collect();
            corners.dedup();
            // What is smaller than a tenth of a pixel is no polygon.
            if corners.len() < 3 {
                continue;
            }
            // Writing to a String cannot fail.
            let _ = write!(way, "M{} {}l", corners[0][0], corners[0][1]);
            for (k, pair) in corners.windows(2).enumerate() {
                let [x, y] = [0, 1].map(|axis| pair[1][axis] - pair[0][axis]);
                let _ = write!(way, "{}{x}{}{y}", if x < 0 || k == 0 { "" } else { " " }, if y < 0 { "" } else { " " });
            }
            way.push('z');
        }
        if !way.is_empty() {
            self.push(format_args!(
                r#"<path transform="scale(.1)" d="{way}" fill="{fill}" stroke="{fill}" stroke-width="7" stroke-linejoin="round"/>"#
            ));
        }
    }

    /// Many lines through pixels of one colour.
    pub fn lines(&mut self, lines: &[Vec<Point>], stroke: &str, width: f64) {
        let way: String = lines.iter().map(|line| format!("M{}", corners(line))).collect();
        if !way.is_empty() {
            self.push(format_args!(
                r#"<path d="{way}" fill="none" stroke="{stroke}" stroke-width="{width}" stroke-linecap="round"/>"#
            ));
        }
    }

    /// Open circle of fixed size in pixels.
    pub fn ring(&mut self, [x, y]: Point, radius: f64, stroke: &str, width: f64) {
        self.push(format_args!(
            r#"<circle cx="{x:.1}" cy="{y:.1}" r="{radius}" fill="white" stroke="{stroke}" stroke-width="{width}"/>"#
        ));
    }

    /// Lines at 45 degrees over an upright rectangle of pixels between two corners: not known there.
    pub fn hatch(&mut self, [x0, y0]: Point, [x1, y1]: Point, stroke: &str) {
        let (width, height) = (x1 - x0, y1 - y0);
        let count = ((width + height) / 7.0).clamp(0.0, 2000.0) as usize;
        for line in 1..=count {
            let along = line as f64 * 7.0;
            let from = [x0 + along.min(width), y0 + (along - width).max(0.0)];
            let to = [x0 + (along - height).max(0.0), y0 + along.min(height)];
            self.push(format_args!(
                r#"<path d="M{:.1} {:.1}L{:.1} {:.1}" stroke="{stroke}" stroke-opacity="0.35"/>"#,
                from[0], from[1], to[0], to[1]
            ));
        }
    }

    /// Words at a pixel that stay readable over lines; `K_I` is written with a lowered index.
    pub fn name(&mut self, [x, y]: Point, words: &str, anchor: &str, size: f64, fill: &str) {
        let words = lowered(&escaped(&told(words)));
        self.push(format_args!(
            r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size}" fill="{fill}" paint-order="stroke" stroke="white" stroke-width="3" stroke-linejoin="round">{words}</text>"#
        ));
    }

    /// A PNG, base64, with its upper left corner at a pixel, turned clockwise about it by degrees; its pixels stay squares.
    pub fn image(&mut self, [x, y]: Point, [width, height]: Point, turned: f64, png: &str) {
        self.push(format_args!(
            r#"<image x="0" y="0" width="{width:.3}" height="{height:.3}" transform="translate({x:.3} {y:.3}) rotate({turned:.4})" preserveAspectRatio="none" style="image-rendering:pixelated" href="data:image/png;base64,{png}"/>"#
        ));
    }

    /// A line that grows along its pixels as time goes, `at` which share of the time each is reached; again and again.
    pub fn growing(&mut self, places: &[Point], at: &[f64], stroke: &str, width: f64) {
        let mut ways = vec![0.0];
        for pair in places.windows(2) {
            ways.push(ways[ways.len() - 1] + (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]));
        }
        let whole = ways[ways.len() - 1];
        let left: Vec<f64> = ways.iter().map(|way| if whole > 0.0 { 1.0 - way / whole } else { 0.0 }).collect();
        let (points, time) = (pixels(places), animated("stroke-dashoffset", &left, at));
        self.push(format_args!(
            r#"<polyline points="{points}" fill="none" stroke="{stroke}" stroke-width="{width}" stroke-linejoin="round" pathLength="1" stroke-dasharray="1 1">{time}</polyline>"#
        ));
    }

    /// A dot that moves along pixels as time goes, as [`Self::growing`].
    pub fn moving(&mut self, places: &[Point], at: &[f64], radius: f64, fill: &str) {
        let [x, y] =
            [("cx", 0), ("cy", 1)].map(|(name, axis)| animated(name, &places.iter().map(|p| p[axis]).collect::<Vec<_>>(), at));
        self.push(format_args!(r#"<circle r="{radius}" fill="{fill}">{x}{y}</circle>"#));
    }

    /// Puts another drawing into an upright rectangle of pixels; nothing of it shows outside.
    pub fn within(&mut self, [x, y]: Point, [width, height]: Point, inner: Sketch) {
        self.push(format_args!(r#"<svg x="{x:.1}" y="{y:.1}" width="{width:.1}" height="{height:.1}" overflow="hidden">"#));
        self.body.push_str(&inner.body);
        self.push(format_args!("</svg>"));
    }

    /// The whole picture of this size, with a sentence for those who do not see it.
    pub fn picture(self, [width, height]: Point, sentence: &str) -> String {
        let sentence = escaped(&told(sentence)).replace('"', "&quot;");
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {width:.0} {height:.0}\" \
             role=\"img\" aria-label=\"{sentence}\" font-family=\"IBM Plex Sans, Segoe UI, Helvetica, Arial, sans-serif\">\n  \
             <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n{}</svg>\n",
            self.body
        )
    }

    /// Measure line with arrows at both ends between two pixels, and its words beside the middle.
    pub fn measure(&mut self, from: Point, to: Point, words: &str) {
        let middle = [(from[0] + to[0]) / 2.0, (from[1] + to[1]) / 2.0];
        let reach = (to[0] - from[0]).hypot(to[1] - from[1]);
        if reach > 24.0 {
            self.arrow(middle, from, WORDS, 1.0);
            self.arrow(middle, to, WORDS, 1.0);
        } else {
            self.line(from, to, WORDS, 1.0);
        }
        if (to[0] - from[0]).abs() > (to[1] - from[1]).abs() {
            self.name([middle[0], middle[1] - 6.0], words, "middle", 13.0, WORDS);
        } else {
            self.name([middle[0] + 7.0, middle[1] + 4.0], words, "start", 13.0, WORDS);
        }
    }
}

fn pixels(places: &[Point]) -> String {
    places.iter().map(|[x, y]| format!("{x:.1},{y:.1}")).collect::<Vec<_>>().join(" ")
}

/// Seconds in which an animation goes once from its start to its end, and the share of them after which it waits there.
const SECONDS: f64 = 10.0;
const MOVES: f64 = 0.85;

/// An attribute that takes values at shares of the time, rising, then keeps the last one until it begins anew.
fn animated(attribute: &str, values: &[f64], at: &[f64]) -> String {
    let list = |numbers: &mut dyn Iterator<Item = f64>| numbers.map(|x| format!("{x:.4}")).collect::<Vec<_>>().join(";");
    let last = values.last().copied();
    let values = list(&mut values.iter().copied().chain(last));
    let times = list(&mut at.iter().map(|time| MOVES * time.clamp(0.0, 1.0)).chain([1.0]));
    format!(
        r#"<animate attributeName="{attribute}" dur="{SECONDS}s" repeatCount="indefinite" values="{values}" keyTimes="{times}"/>"#
    )
}

/// Pixels of a path, half of a tenth of a pixel apart at the most from where they are.
fn corners(places: &[Point]) -> String {
    places.iter().map(|[x, y]| format!("{x:.1} {y:.1}")).collect::<Vec<_>>().join("L")
}

/// Text as markup takes it.
pub fn escaped(text: &str) -> String {
    // What no document of markup may hold is left out.
    let text: String = text.chars().filter(|c| !c.is_control() || *c == '\n').collect();
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The index of K lowered.
fn lowered(text: &str) -> String {
    let low = |index: &str| format!("<tspan dy=\"3\" font-size=\"75%\">{index}</tspan><tspan dy=\"-3\">\u{200b}</tspan>");
    ["II", "I"].iter().fold(text.to_owned(), |text, index| text.replace(&format!("K_{index}"), &format!("K{}", low(index))))
}
