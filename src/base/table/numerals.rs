//! Numbers as they are written: digits, a decimal sign, signs between thousands, an exponent.

crate::kinds! {
    pub enum Decimal for "measured.decimal" {
        Point = ".": "1234.5",
        Comma = ",": "1234,5",
    }
}

impl Decimal {
    pub fn sign(self) -> char {
        match self {
            Decimal::Point => '.',
            Decimal::Comma => ',',
        }
    }

    pub fn words(self) -> &'static str {
        match self {
            Decimal::Point => "point",
            Decimal::Comma => "comma",
        }
    }

    /// The sign that separates thousands beside it.
    pub fn other(self) -> Decimal {
        match self {
            Decimal::Point => Decimal::Comma,
            Decimal::Comma => Decimal::Point,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Evidence {
    NoNumber,
    Whole,
    Proves(Decimal),
    /// Three digits behind the only sign, which may separate thousands.
    Open(Decimal),
}

/// Blanks and apostrophes that separate thousands.
pub(super) const GROUPING: [char; 7] = [' ', '\u{a0}', '\u{202f}', '\u{2009}', '\'', '\u{2019}', '\u{2d9}'];

/// Whether a cell is a number in some writing.
pub fn is_number(cell: &str) -> bool {
    evidence(cell) != Evidence::NoNumber
}

/// Digits in front of and behind the first of groups of three.
fn are_groups(text: &str, separator: impl Fn(char) -> bool) -> bool {
    text.split(separator).enumerate().all(|(place, group)| {
        let digits = group.bytes().all(|byte| byte.is_ascii_digit());
        digits && if place == 0 { (1..=3).contains(&group.len()) } else { group.len() == 3 }
    })
}

pub(super) fn evidence(cell: &str) -> Evidence {
    match simple(cell) {
        Some((digits, None)) if digits > 0 => return Evidence::Whole,
        Some((digits, Some((place, decimal)))) if digits > 0 => {
            let open = cell.len() - place == 4 && (1..=3).contains(&place) && !cell.starts_with('0');
            return if open { Evidence::Open(decimal) } else { Evidence::Proves(decimal) };
        }
        _ => {}
    }
    let unsigned = cell.strip_prefix(['+', '-', '\u{2212}']).unwrap_or(cell);
    let (mantissa, has_exponent) = match unsigned.split_once(['e', 'E']) {
        None => (unsigned, false),
        Some((mantissa, exponent)) => {
            let digits = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
            if digits.is_empty() || !digits.bytes().all(|byte| byte.is_ascii_digit()) {
                return Evidence::NoNumber;
            }
            (mantissa, true)
        }
    };
    if !mantissa.bytes().any(|byte| byte.is_ascii_digit()) {
        return Evidence::NoNumber;
    }
    if mantissa.bytes().all(|byte| byte.is_ascii_digit()) {
        return Evidence::Whole;
    }
    let count = |sign: char| mantissa.matches(sign).count();
    let decimal = match (count('.'), count(',')) {
        (0, 0) => return if are_groups(mantissa, is_grouping) { Evidence::Whole } else { Evidence::NoNumber },
        (1, 0) => Decimal::Point,
        (0, 1) => Decimal::Comma,
        (_, 0) => return if are_groups(mantissa, |c| c == '.') { Evidence::Proves(Decimal::Comma) } else { Evidence::NoNumber },
        (0, _) => return if are_groups(mantissa, |c| c == ',') { Evidence::Proves(Decimal::Point) } else { Evidence::NoNumber },
        (points, commas) => {
            let last = if mantissa.rfind('.') > mantissa.rfind(',') { Decimal::Point } else { Decimal::Comma };
            if (if last == Decimal::Point { points } else { commas }) > 1 {
                return Evidence::NoNumber;
            }
            last
        }
    };
    let Some((whole, fraction)) = mantissa.split_once(decimal.sign()) else { return Evidence::NoNumber };
    let grouped = !whole.bytes().all(|byte| byte.is_ascii_digit());
    if !fraction.bytes().all(|byte| byte.is_ascii_digit())
        || (grouped && !are_groups(whole, |c| is_grouping(c) || c == decimal.other().sign()))
    {
        return Evidence::NoNumber;
    }
    let open = !grouped && !has_exponent && fraction.len() == 3 && (1..=3).contains(&whole.len()) && !whole.starts_with('0');
    if open { Evidence::Open(decimal) } else { Evidence::Proves(decimal) }
}

/// Digits with at most one sign between them, as most cells are: number of digits, place of the sign. A million readings are to be read
/// in a second or two.
fn simple(cell: &str) -> Option<(usize, Option<(usize, Decimal)>)> {
    let mut sign = None;
    for (place, byte) in cell.bytes().enumerate() {
        match byte {
            b'0'..=b'9' => {}
            b'.' if sign.is_none() => sign = Some((place, Decimal::Point)),
            b',' if sign.is_none() => sign = Some((place, Decimal::Comma)),
            _ => return None,
        }
    }
    Some((cell.len() - usize::from(sign.is_some()), sign))
}

fn is_grouping(character: char) -> bool {
    GROUPING.contains(&character)
}

/// The number in a cell; `None` if it is none in this writing.
pub fn number(cell: &str, decimal: Decimal) -> Option<f64> {
    match simple(cell) {
        Some((_, None)) => return cell.parse().ok(),
        Some((_, Some((_, Decimal::Point)))) if decimal == Decimal::Point => return cell.parse().ok(),
        Some((_, Some((_, Decimal::Comma)))) if decimal == Decimal::Comma => return cell.replace(',', ".").parse().ok(),
        _ => {}
    }
    match evidence(cell) {
        Evidence::Proves(proved) if proved != decimal => return None,
        Evidence::NoNumber => return None,
        _ => {}
    }
    let digits: String = cell.chars().filter(|&c| !is_grouping(c) && c != decimal.other().sign()).collect();
    digits.replace(',', ".").replace('\u{2212}', "-").parse().ok()
}
