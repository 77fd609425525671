//! Pixels of a picture, and the colours of its fields.

/// An image of so many columns and rows as PNG; four bytes a pixel: red, green, blue, cover.
pub fn png([columns, rows]: [usize; 2], pixels: &[u8]) -> Result<Vec<u8>, png::EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, columns as u32, rows as u32);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.write_header()?.write_image_data(pixels)?;
    Ok(bytes)
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
