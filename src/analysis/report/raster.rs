//! A small canvas: pixels, smooth lines, text; written as PNG; and the colours of its fields.

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
            for (row, bits) in (0i64..).zip(rows(letter)) {
                for column in (0..5i64).filter(|column| bits >> (4 - column) & 1 == 1) {
                    let corner = [x + scale * (place * ADVANCE + column), y + scale * row];
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

/// An opaque colour, 8 bits a channel.
pub type Rgb = [u8; 3];

/// Colour of a share from 0 (pale sand) to 1 (deep violet).
///
/// The path runs through OKLab (Ottosson 2020) with lightness falling linearly, so equal steps of damage look equally large,
/// also in grey print; hue turns from yellow over red to violet.
pub fn of_share(share: f64) -> Rgb {
    let t = if share.is_nan() { 0.0 } else { share.clamp(0.0, 1.0) };
    let lightness = 0.94 - 0.70 * t;
    let chroma = 0.03 + 0.145 * (std::f64::consts::PI * t.powf(0.8)).sin().max(0.0) + 0.05 * t;
    let hue = (95.0 - 170.0 * t).to_radians();
    from_oklab(lightness, chroma * hue.cos(), chroma * hue.sin())
}

/// OKLab to sRGB (matrices of Ottosson 2020); colours beyond the screen's range are clipped.
fn from_oklab(lightness: f64, a: f64, b: f64) -> Rgb {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    let linear = [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ];
    linear.map(|value| {
        let v = value.clamp(0.0, 1.0);
        let encoded = if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 };
        (255.0 * encoded).round() as u8
    })
}

/// Dots from one letter to the next.
const ADVANCE: i64 = 6;

/// Rows of a letter of 5 x 8 dots, drawn for this program, top first; the lowest five bits are its dots from left to right. The last row lies below the line.
/// A letter that is not in the table is a small box.
fn rows(letter: char) -> [u8; 8] {
    TABLE.iter().find(|(known, _)| *known == letter).map_or([31, 17, 17, 17, 17, 17, 31, 0], |(_, rows)| *rows)
}

#[rustfmt::skip]
const TABLE: [(char, [u8; 8]); 50] = [
    (' ', [0; 8]),
    ('0', [0b01110, 0b10001, 0b10011, 0b10101, 0b11001, 0b10001, 0b01110, 0]),
    ('1', [0b00100, 0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110, 0]),
    ('2', [0b01110, 0b10001, 0b00001, 0b00110, 0b01000, 0b10000, 0b11111, 0]),
    ('3', [0b11111, 0b00010, 0b00100, 0b00110, 0b00001, 0b10001, 0b01110, 0]),
    ('4', [0b00010, 0b00110, 0b01010, 0b10010, 0b11111, 0b00010, 0b00010, 0]),
    ('5', [0b11111, 0b10000, 0b11110, 0b00001, 0b00001, 0b10001, 0b01110, 0]),
    ('6', [0b00110, 0b01000, 0b10000, 0b11110, 0b10001, 0b10001, 0b01110, 0]),
    ('7', [0b11111, 0b00001, 0b00010, 0b00100, 0b01000, 0b01000, 0b01000, 0]),
    ('8', [0b01110, 0b10001, 0b10001, 0b01110, 0b10001, 0b10001, 0b01110, 0]),
    ('9', [0b01110, 0b10001, 0b10001, 0b01111, 0b00001, 0b00010, 0b01100, 0]),
    ('.', [0, 0, 0, 0, 0, 0b01100, 0b01100, 0]),
    (',', [0, 0, 0, 0, 0, 0b01100, 0b00100, 0b01000]),
    (':', [0, 0b01100, 0b01100, 0, 0, 0b01100, 0b01100, 0]),
    ('=', [0, 0, 0b11111, 0, 0b11111, 0, 0, 0]),
    ('-', [0, 0, 0, 0b11111, 0, 0, 0, 0]),
    ('(', [0b00010, 0b00100, 0b01000, 0b01000, 0b01000, 0b00100, 0b00010, 0]),
    (')', [0b01000, 0b00100, 0b00010, 0b00010, 0b00010, 0b00100, 0b01000, 0]),
    ('_', [0, 0, 0, 0, 0, 0, 0, 0b11111]),
    ('/', [0b00001, 0b00010, 0b00010, 0b00100, 0b01000, 0b01000, 0b10000, 0]),
    ('M', [0b10001, 0b11011, 0b10101, 0b10101, 0b10001, 0b10001, 0b10001, 0]),
    ('P', [0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000, 0b10000, 0]),
    ('N', [0b10001, 0b11001, 0b11001, 0b10101, 0b10011, 0b10011, 0b10001, 0]),
    ('a', [0, 0, 0b01110, 0b00001, 0b01111, 0b10001, 0b01111, 0]),
    ('b', [0b10000, 0b10000, 0b11110, 0b10001, 0b10001, 0b10001, 0b11110, 0]),
    ('c', [0, 0, 0b01110, 0b10001, 0b10000, 0b10001, 0b01110, 0]),
    ('d', [0b00001, 0b00001, 0b01111, 0b10001, 0b10001, 0b10001, 0b01111, 0]),
    ('e', [0, 0, 0b01110, 0b10001, 0b11111, 0b10000, 0b01110, 0]),
    ('f', [0b00110, 0b01001, 0b01000, 0b11100, 0b01000, 0b01000, 0b01000, 0]),
    ('g', [0, 0, 0b01111, 0b10001, 0b10001, 0b01111, 0b00001, 0b01110]),
    ('h', [0b10000, 0b10000, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001, 0]),
    ('i', [0b00100, 0, 0b01100, 0b00100, 0b00100, 0b00100, 0b01110, 0]),
    ('j', [0b00010, 0, 0b00110, 0b00010, 0b00010, 0b00010, 0b10010, 0b01100]),
    ('k', [0b10000, 0b10000, 0b10010, 0b10100, 0b11000, 0b10100, 0b10010, 0]),
    ('l', [0b01100, 0b00100, 0b00100, 0b00100, 0b00100, 0b00100, 0b01110, 0]),
    ('m', [0, 0, 0b11010, 0b10101, 0b10101, 0b10101, 0b10101, 0]),
    ('n', [0, 0, 0b10110, 0b11001, 0b10001, 0b10001, 0b10001, 0]),
    ('o', [0, 0, 0b01110, 0b10001, 0b10001, 0b10001, 0b01110, 0]),
    ('p', [0, 0, 0b11110, 0b10001, 0b10001, 0b11110, 0b10000, 0b10000]),
    ('q', [0, 0, 0b01111, 0b10001, 0b10001, 0b01111, 0b00001, 0b00001]),
    ('r', [0, 0, 0b10110, 0b11001, 0b10000, 0b10000, 0b10000, 0]),
    ('s', [0, 0, 0b01111, 0b10000, 0b01110, 0b00001, 0b11110, 0]),
    ('t', [0b01000, 0b01000, 0b11100, 0b01000, 0b01000, 0b01001, 0b00110, 0]),
    ('u', [0, 0, 0b10001, 0b10001, 0b10001, 0b10011, 0b01101, 0]),
    ('v', [0, 0, 0b10001, 0b10001, 0b10001, 0b01010, 0b00100, 0]),
    ('w', [0, 0, 0b10001, 0b10001, 0b10101, 0b10101, 0b01010, 0]),
    ('x', [0, 0, 0b10001, 0b01010, 0b00100, 0b01010, 0b10001, 0]),
    ('y', [0, 0, 0b10001, 0b10001, 0b10001, 0b01111, 0b00001, 0b01110]),
    ('µ', [0, 0, 0b10001, 0b10001, 0b10001, 0b10011, 0b11101, 0b10000]),
    ('z', [0, 0, 0b11111, 0b00010, 0b00100, 0b01000, 0b11111, 0]),
];
