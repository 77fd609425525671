//! A small canvas: pixels, smooth lines, text; written as PNG.

use super::colour::Rgb;
use super::glyphs;

/// An RGB image.
#[derive(Debug, Clone)]
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<u8>,
}

impl Canvas {
    /// White canvas.
    pub fn new(width: usize, height: usize) -> Canvas {
        Canvas { width, height, pixels: vec![255; 3 * width * height] }
    }

    /// Sets one pixel; outside the canvas nothing happens.
    pub fn set(&mut self, x: i64, y: i64, colour: Rgb) {
        self.blend(x, y, colour, 1.0);
    }

    /// Lays a colour over a pixel with the given cover, 0 to 1.
    fn blend(&mut self, x: i64, y: i64, colour: Rgb, cover: f64) {
        let (Ok(column), Ok(row)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if column >= self.width || row >= self.height {
            return;
        }
        let at = 3 * (row * self.width + column);
        for (pixel, new) in self.pixels[at..at + 3].iter_mut().zip(colour) {
            *pixel = (f64::from(*pixel) + cover * (f64::from(new) - f64::from(*pixel))).round() as u8;
        }
    }

    /// Filled rectangle from (x, y), width by height.
    pub fn fill(&mut self, [x, y]: [i64; 2], [width, height]: [i64; 2], colour: Rgb) {
        for row in y..y + height {
            for column in x..x + width {
                self.set(column, row, colour);
            }
        }
    }

    /// Line of the given width through the points, with round ends and smooth edges.
    pub fn line(&mut self, points: &[[f64; 2]], width: f64, colour: Rgb) {
        // One cover map for the whole line, so that joints are not painted twice.
        let reach = 0.5 * width + 1.0;
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for point in points.iter().filter(|p| p[0].is_finite() && p[1].is_finite()) {
            for axis in 0..2 {
                low[axis] = low[axis].min(point[axis] - reach).max(0.0);
                high[axis] = high[axis].max(point[axis] + reach).min([self.width, self.height][axis] as f64);
            }
        }
        if low[0] >= high[0] || low[1] >= high[1] {
            return;
        }
        let origin = low.map(|v| v.floor() as i64);
        let size = [0, 1].map(|axis| (high[axis].ceil() as i64 - origin[axis]).max(0) as usize);
        let mut cover = vec![0.0f64; size[0] * size[1]];
        for pair in points.windows(2) {
            let [from, to] = [pair[0], pair[1]];
            let span = |axis: usize| {
                let start = (from[axis].min(to[axis]) - reach).floor() as i64 - origin[axis];
                let end = (from[axis].max(to[axis]) + reach).ceil() as i64 - origin[axis];
                start.clamp(0, size[axis] as i64)..end.clamp(0, size[axis] as i64)
            };
            for row in span(1) {
                for column in span(0) {
                    let centre = [(column + origin[0]) as f64 + 0.5, (row + origin[1]) as f64 + 0.5];
                    let share = (0.5 * width + 0.5 - distance(centre, from, to)).clamp(0.0, 1.0);
                    let cell = &mut cover[row as usize * size[0] + column as usize];
                    *cell = cell.max(share);
                }
            }
        }
        for (at, share) in cover.into_iter().enumerate().filter(|(_, share)| *share > 0.0) {
            self.blend((at % size[0]) as i64 + origin[0], (at / size[0]) as i64 + origin[1], colour, share);
        }
    }

    /// Text with its upper left corner at (x, y); each dot of the letters is `scale` pixels wide.
    pub fn text(&mut self, text: &str, [x, y]: [i64; 2], scale: i64, colour: Rgb) {
        for (place, letter) in (0i64..).zip(text.chars()) {
            for (row, bits) in (0i64..).zip(glyphs::rows(letter)) {
                for column in (0..5i64).filter(|column| bits >> (4 - column) & 1 == 1) {
                    let corner = [x + scale * (place * glyphs::ADVANCE + column), y + scale * row];
                    self.fill(corner, [scale, scale], colour);
                }
            }
        }
    }

    /// The picture as a PNG file.
    pub fn png(&self) -> Result<Vec<u8>, png::EncodingError> {
        let mut bytes = Vec::new();
        let mut encoder = png::Encoder::new(&mut bytes, self.width as u32, self.height as u32);
        encoder.set_color(png::ColorType::Rgb);
        encoder.set_depth(png::BitDepth::Eight);
        encoder.write_header()?.write_image_data(&self.pixels)?;
        Ok(bytes)
    }
}

/// Distance of a point from a straight stretch.
fn distance(p: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length_squared = along[0] * along[0] + along[1] * along[1];
    let dot = (p[0] - from[0]) * along[0] + (p[1] - from[1]) * along[1];
    let t = if length_squared > 0.0 { (dot / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    (p[0] - from[0] - t * along[0]).hypot(p[1] - from[1] - t * along[1])
}
