//! SVG: lines with the layers that their ids or those of their groups name.
//!
//! Lengths of a path are turned into millimetres by `width` and `viewBox`; y points upwards from the lower edge of the `viewBox`. The layer
//! of a line is the innermost `inkscape:label` or `id` of itself or a group around it that names one.

use std::str::FromStr;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};
use svgtypes::{Length, LengthUnit, PathParser, PathSegment, Transform, ViewBox};

use super::curve::{Arc, Curve, Piece};
use super::{Drawing, Drawn, Fault, known_layer, place};
use crate::specimen::Point;
use crate::specimen::geometry::distance;

/// Elements that say nothing of a shape; what stands in the others of them is no drawing.
const SILENT: [&str; 6] = ["svg", "g", "a", "title", "desc", "metadata"];
/// Elements whose content is not drawn.
const HIDDEN: [&str; 7] = ["defs", "metadata", "style", "namedview", "symbol", "clipPath", "mask"];
/// Attributes that change what is seen of an element and are not read, where they are not `none`.
const CHANGING: [&str; 4] = ["clip-path", "mask", "filter", "transform-origin"];
/// Beginnings of the names of properties that a style may declare: they paint. Any other may move a line, cut it or set its size.
const PAINT: [&str; 26] = [
    "fill",
    "stroke",
    "color",
    "marker",
    "paint-order",
    "font",
    "text",
    "line-height",
    "letter-spacing",
    "word-spacing",
    "white-space",
    "writing-mode",
    "direction",
    "baseline",
    "dominant-baseline",
    "alignment-baseline",
    "shape-",
    "image-rendering",
    "enable-background",
    "isolation",
    "mix-blend-mode",
    "solid-",
    "stop-",
    "vector-effect",
    "clip-rule",
    "-inkscape",
];
/// Share by which two scales may differ that are one.
const ALIKE: f64 = 1e-4;

/// What an element inherits: the names around it from the outside in, and its places in those of the drawing.
#[derive(Clone)]
struct Around {
    names: Vec<String>,
    /// The innermost name that a user has given a layer.
    label: Option<String>,
    map: Transform,
    /// `display: none`, of the element or a group around it.
    is_left_out: bool,
    /// `visibility: hidden`, which an element within may end.
    is_invisible: bool,
    /// `opacity: 0`, of the element or a group around it.
    is_clear: bool,
}

/// Reads a file.
/// Errors: text that is no SVG; elements that are no plain lines.
pub fn read(text: &str) -> Result<Drawing, Fault> {
    let mut reader = Reader::from_str(text);
    let mut drawing = Drawing { lines: Vec::new(), millimetres: None };
    let mut around: Vec<Around> = Vec::new();
    let (mut hidden, mut is_svg, mut is_style) = (0, false, false);
    let broken = |problem: String| Fault::of(problem, "save it as plain SVG");
    loop {
        let (tag, is_empty) = match reader.read_event() {
            Ok(Event::Start(tag)) => (tag, false),
            Ok(Event::Empty(tag)) => (tag, true),
            Ok(Event::End(_)) if hidden > 0 => {
                (hidden, is_style) = (hidden - 1, false);
                continue;
            }
            Ok(Event::End(_)) => {
                around.pop();
                continue;
            }
            Ok(Event::Text(text)) if is_style => {
                check_style(text.as_ref())?;
                continue;
            }
            Ok(Event::CData(text)) if is_style => {
                check_style(text.as_ref())?;
                continue;
            }
            Ok(Event::PI(instruction)) if instruction.target() == "xml-stylesheet" => {
                return Err(broken("has a style sheet in another file, which is not read".to_owned()));
            }
            Ok(Event::Eof) if is_svg && around.is_empty() => return Ok(drawing),
            Ok(Event::Eof) => return Err(broken("is no whole SVG".to_owned())),
            Ok(_) => continue,
            Err(error) => return Err(broken(format!("cannot be read: {error}"))),
        };
        let name = tag.local_name();
        let name: &str = name.as_ref();
        if hidden > 0 || HIDDEN.contains(&name) {
            hidden += usize::from(!is_empty);
            is_style = name == "style" && !is_empty;
            continue;
        }
        let element = Element { tag: &tag, name };
        let inside = match around.last() {
            None if name == "svg" => {
                is_svg = true;
                let (map, millimetres) = element.view()?;
                drawing.millimetres = millimetres;
                element.check_map()?;
                element.shown(Around {
                    names: Vec::new(),
                    label: None,
                    map,
                    is_left_out: false,
                    is_invisible: false,
                    is_clear: false,
                })
            }
            None => return Err(broken(format!("begins with <{name}>"))),
            Some(outside) if name == "svg" => {
                let at = ["x", "y"].map(|name| element.attribute(name).unwrap_or_else(|| "0".to_owned()));
                let what = format!("svg at ({})", at.join(", "));
                return Err(Fault::at(
                    &outside.layer(),
                    &what,
                    "is a drawing within the drawing",
                    "place its lines in the outer one",
                ));
            }
            Some(outside) => element.within(outside)?,
        };
        if !SILENT.contains(&name) {
            element.draw(&inside, &mut drawing.lines)?;
        }
        if !is_empty {
            around.push(inside);
        }
    }
}

struct Element<'a> {
    tag: &'a BytesStart<'a>,
    name: &'a str,
}

impl Element<'_> {
    fn attribute(&self, name: &str) -> Option<String> {
        self.tag.try_get_attribute(name).ok().flatten().map(|attribute| attribute.value.trim().to_owned())
    }

    /// The value that `style` declares of a property.
    fn of_style(&self, name: &str) -> Option<String> {
        declared(&self.attribute("style")?).rfind(|(key, _)| key == name).map(|(_, value)| value)
    }

    /// The value of a property, from `style` before the attribute of that name.
    fn property(&self, name: &str) -> Option<String> {
        self.of_style(name).or_else(|| self.attribute(name).map(|value| value.to_ascii_lowercase()))
    }

    /// What of the element is shown.
    fn shown(&self, around: Around) -> Around {
        let is_left_out = around.is_left_out || self.property("display").is_some_and(|value| value == "none");
        let is_invisible = match self.property("visibility").as_deref() {
            Some("visible") => false,
            Some("hidden" | "collapse") => true,
            _ => around.is_invisible,
        };
        let is_clear = around.is_clear || self.property("opacity").is_some_and(|value| is_zero(&value));
        Around { is_left_out, is_invisible, is_clear, ..around }
    }

    /// Refuses what moves or cuts the element other than by the attribute `transform`, and that of the whole drawing.
    fn check_map(&self) -> Result<(), Fault> {
        let style = self.attribute("style").unwrap_or_default();
        let of_style = declared(&style).find(|(name, value)| is_unread(name, value)).map(|(name, _)| name);
        let of_whole = ["transform"].into_iter().filter(|_| self.name == "svg");
        let is_set = |name: &&str| self.attribute(name).is_some_and(|value| !value.eq_ignore_ascii_case("none"));
        let of_attributes = || CHANGING.into_iter().chain(of_whole).find(is_set).map(str::to_owned);
        let Some(name) = of_style.or_else(of_attributes) else { return Ok(()) };
        Err(Fault::of(
            format!("has a <{}> with {name}, which is not read", self.name),
            "apply transforms and clips before saving, and give places and sizes as attributes",
        ))
    }

    /// The number of an attribute; 0 where that is left out.
    fn number(&self, around: &Around, name: &str) -> Result<f64, Fault> {
        let Some(text) = self.attribute(name) else { return Ok(0.0) };
        let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
        number.ok_or_else(|| {
            Fault::at(&around.layer(), self.name, format!("{name} = \"{text}\" is no plain number"), "save it without units")
        })
    }

    /// From the places of the file to those of the drawing, in its unit: millimetres where the size says so.
    fn view(&self) -> Result<(Transform, Option<f64>), Fault> {
        let fault = |problem: String| Fault::of(problem, "give width, height and viewBox, such as width=\"100mm\"");
        let size = |name: &str| {
            let length =
                self.attribute(name).map(|text| Length::from_str(&text).map_err(|_| fault(format!("has the {name} \"{text}\""))));
            length.transpose().map(|length| length.and_then(millimetres))
        };
        let view = self
            .attribute("viewBox")
            .map(|text| ViewBox::from_str(&text).map_err(|_| fault(format!("has the viewBox \"{text}\""))));
        let (width, height, view) = (size("width")?, size("height")?, view.transpose()?);
        if width.is_some() && view.is_none() {
            return Err(fault("has a width without viewBox, so that no unit of its numbers is said".to_owned()));
        }
        let (Some(view), Some(width)) = (view, width) else {
            let (x, top) = view.map_or((0.0, 0.0), |view| (view.x, view.y + view.h));
            return Ok((Transform::new(1.0, 0.0, 0.0, -1.0, -x, top), None));
        };
        let scale = width / view.w;
        if height.is_some_and(|height| (height / view.h / scale - 1.0).abs() > ALIKE) {
            return Err(fault("is stretched: width and height do not go with the viewBox".to_owned()));
        }
        Ok((Transform::new(scale, 0.0, 0.0, -scale, -scale * view.x, scale * (view.y + view.h)), Some(1.0)))
    }

    fn within(&self, outside: &Around) -> Result<Around, Fault> {
        self.check_map()?;
        let mut inside = self.shown(outside.clone());
        inside.label = self.attribute("inkscape:label").filter(|_| self.name == "g").or(inside.label);
        inside.names.extend(["id", "inkscape:label"].into_iter().filter_map(|name| self.attribute(name)));
        let Some(text) = self.attribute("transform") else { return Ok(inside) };
        let fault = |problem: String| Fault::at(&inside.layer(), self.name, problem, "apply transforms before saving");
        let own = Transform::from_str(&text).map_err(|_| fault(format!("has the transform \"{text}\"")))?;
        let (Transform { a, b, c, d, e, f }, out) = (own, outside.map);
        let (along, across) = (a.hypot(b), c.hypot(d));
        if along <= 0.0 || (across / along - 1.0).abs() > ALIKE || (a * c + b * d).abs() > ALIKE * along * across {
            return Err(fault(format!("is stretched by the transform \"{text}\"")));
        }
        let turned = |x: f64, y: f64| (out.a * x + out.c * y, out.b * x + out.d * y);
        let ((a, b), (c, d), (e, f)) = (turned(a, b), turned(c, d), turned(e, f));
        inside.map = Transform::new(a, b, c, d, e + out.e, f + out.f);
        Ok(inside)
    }

    fn draw(&self, around: &Around, lines: &mut Vec<Drawn>) -> Result<(), Fault> {
        let number = |name| self.number(around, name);
        let refused = |problem: &str, remedy: &str| {
            let what = self.attribute("id").map_or_else(|| self.name.to_owned(), |id| format!("{} {id}", self.name));
            Fault::at(&around.layer(), &what, problem, remedy)
        };
        let curves = match self.name {
            "circle" if number("r")? <= 0.0 => return Err(refused("has no radius above zero", "draw it larger, or remove it")),
            "circle" => vec![Curve::circle([number("cx")?, number("cy")?], number("r")?)],
            "line" => {
                let [from, to] = [["x1", "y1"], ["x2", "y2"]].map(|names| names.map(number));
                let point = |[x, y]: [Result<f64, Fault>; 2]| Ok::<Point, Fault>([x?, y?]);
                vec![Curve { from: point(from)?, pieces: vec![Piece::straight(point(to)?)] }]
            }
            "rect" if number("rx")? != 0.0 || number("ry")? != 0.0 => {
                return Err(refused("has round corners", "draw it as a path of lines and arcs"));
            }
            "rect" => {
                let [x, y, width, height] = [number("x")?, number("y")?, number("width")?, number("height")?];
                path(&format!("M {x} {y} H {} V {} H {x} Z", x + width, y + height)).map_err(|problem| refused(&problem, DRAW))?
            }
            "polyline" | "polygon" => {
                let end = if self.name == "polygon" { "Z" } else { "" };
                let points = self.attribute("points").unwrap_or_default();
                path(&format!("M {points} {end}")).map_err(|problem| refused(&problem, DRAW))?
            }
            "path" => path(&self.attribute("d").unwrap_or_default()).map_err(|problem| refused(&problem, DRAW))?,
            _ => return Err(refused("is no line, polyline, polygon, rect, circle or path", "remove it from the drawing")),
        };
        let Transform { a, b, c, d, e, f } = around.map;
        for curve in curves {
            let curve = curve.mapped(|[x, y]| [a * x + c * y + e, b * x + d * y + f], a * d - b * c < 0.0);
            let what = format!("{} at {}", self.name, place(curve.from));
            if let Some(property) = around.hidden_by() {
                let problem = format!("is hidden ({property})");
                return Err(Fault::at(&around.layer(), &what, problem, "show it, or remove it from the drawing"));
            }
            lines.push(Drawn { layer: around.layer(), what, curve });
        }
        Ok(())
    }
}

const DRAW: &str = "draw it as lines and circular arcs (M L H V A Z)";

impl Around {
    /// The property that hides what is in it.
    fn hidden_by(&self) -> Option<&'static str> {
        let hidden =
            [(self.is_left_out, "display: none"), (self.is_invisible, "visibility: hidden"), (self.is_clear, "opacity: 0")];
        hidden.into_iter().find_map(|(is_so, property)| is_so.then_some(property))
    }

    /// The innermost name that is a layer, else the innermost one.
    fn layer(&self) -> String {
        let known = self.names.iter().rev().find_map(|name| known_layer(name));
        known.or(self.label.as_deref()).or(self.names.last().map(String::as_str)).unwrap_or_default().to_owned()
    }
}

/// Names and values that a style declares, in small letters.
fn declared(style: &str) -> impl DoubleEndedIterator<Item = (String, String)> {
    let plain = |text: &str| text.trim().trim_end_matches("!important").trim().to_ascii_lowercase();
    style.split(';').filter_map(move |part| part.split_once(':').map(|(name, value)| (plain(name), plain(value))))
}

/// Whether a property changes the shape that is seen in a way that is not read.
fn is_unread(name: &str, value: &str) -> bool {
    const READ: [&str; 3] = ["display", "visibility", "opacity"];
    // What cuts an element off at the edge of the picture.
    let is_harmless = value == "none" || name == "overflow" || name == "pointer-events" || name == "cursor";
    !READ.contains(&name) && !is_harmless && !PAINT.iter().any(|paint| name.starts_with(paint))
}

fn is_zero(value: &str) -> bool {
    value.trim_end_matches('%').parse::<f64>().is_ok_and(|number| number <= 0.0)
}

/// Refuses a style sheet that hides, moves, cuts or sets sizes: which elements its rules are for is not looked at.
fn check_style(text: &str) -> Result<(), Fault> {
    let mut plain = String::new();
    for (i, part) in text.split("/*").enumerate() {
        plain.push_str(if i == 0 { part } else { part.split_once("*/").map_or("", |(_, after)| after) });
    }
    let remedy = "remove what is hidden, apply transforms and clips, or save with attributes in place of a style sheet";
    let refused = |name: &str| Err(Fault::of(format!("has a style sheet with {name}, which is not read"), remedy));
    if plain.contains("@import") {
        return refused("@import");
    }
    let rules: Vec<(String, String)> =
        plain.split('}').filter_map(|rule| rule.rsplit_once('{')).flat_map(|(_, style)| declared(style)).collect();
    let hides = |name: &str, value: &str| matches!(name, "display" | "visibility") || name == "opacity" && is_zero(value);
    rules.iter().find(|(name, value)| is_unread(name, value) || hides(name, value)).map_or(Ok(()), |(name, _)| refused(name))
}

fn millimetres(length: Length) -> Option<f64> {
    match length.unit {
        LengthUnit::Mm => Some(length.number),
        LengthUnit::Cm => Some(10.0 * length.number),
        LengthUnit::In => Some(25.4 * length.number),
        LengthUnit::Pc => Some(25.4 / 6.0 * length.number),
        LengthUnit::Pt => Some(25.4 / 72.0 * length.number),
        _ => None,
    }
}

/// The curves of a path.
/// Errors: what is wrong with it.
fn path(text: &str) -> Result<Vec<Curve>, String> {
    let mut curves: Vec<Curve> = Vec::new();
    let (mut at, mut start): (Point, Point) = ([0.0; 2], [0.0; 2]);
    // After a move or a closed line the next piece begins a curve.
    let mut is_open = false;
    for segment in PathParser::from(text) {
        let segment = segment.map_err(|_| "is no path that can be read".to_owned())?;
        let from = |abs: bool| if abs { [0.0; 2] } else { at };
        let piece = match segment {
            PathSegment::MoveTo { abs, x, y } => {
                at = [from(abs)[0] + x, from(abs)[1] + y];
                (start, is_open) = (at, false);
                continue;
            }
            PathSegment::LineTo { abs, x, y } => Piece::straight([from(abs)[0] + x, from(abs)[1] + y]),
            PathSegment::HorizontalLineTo { abs, x } => Piece::straight([from(abs)[0] + x, at[1]]),
            PathSegment::VerticalLineTo { abs, y } => Piece::straight([at[0], from(abs)[1] + y]),
            PathSegment::ClosePath { .. } => Piece::straight(start),
            PathSegment::EllipticalArc { abs, rx, ry, large_arc, sweep, x, y, .. } => {
                if (rx - ry).abs() > ALIKE * rx.abs() {
                    return Err(format!("has an arc of an ellipse at {}", place(at)));
                }
                arc(at, [from(abs)[0] + x, from(abs)[1] + y], rx.abs(), [large_arc, sweep])
            }
            _ => return Err(format!("has a curve that is no circular arc at {}", place(at))),
        };
        let closes = matches!(segment, PathSegment::ClosePath { .. });
        if piece.to != at || piece.arc.is_some() {
            match curves.last_mut().filter(|_| is_open) {
                Some(curve) => curve.pieces.push(piece),
                None => curves.push(Curve { from: at, pieces: vec![piece] }),
            }
        }
        (at, is_open) = (piece.to, !closes);
    }
    if curves.is_empty() { Err("has no line".to_owned()) } else { Ok(curves) }
}

/// An arc by its ends (SVG 1.1, F.6.5), y downwards as in the file: `is_large` and `is_positive` are its flags.
fn arc(from: Point, to: Point, radius: f64, [is_large, is_positive]: [bool; 2]) -> Piece {
    let chord = distance(from, to);
    if radius == 0.0 || chord == 0.0 {
        return Piece::straight(to);
    }
    // Too small a radius is that of the half circle.
    let over = ((radius.max(0.5 * chord) / chord).powi(2) - 0.25).max(0.0).sqrt();
    let side = if is_large == is_positive { -over } else { over };
    let centre = [0.5 * (from[0] + to[0]) - side * (to[1] - from[1]), 0.5 * (from[1] + to[1]) + side * (to[0] - from[0])];
    let angle = |at: Point| (at[1] - centre[1]).atan2(at[0] - centre[0]);
    let turn = (angle(to) - angle(from)).rem_euclid(std::f64::consts::TAU);
    let sweep = if is_positive { turn } else { turn - std::f64::consts::TAU };
    Piece { to, arc: Some(Arc { centre, sweep }) }
}
