//! Bytes of a text file as text: UTF-8 or UTF-16 with or without a byte order mark, else Windows-1252.

use std::borrow::Cow;
use std::path::Path;

use encoding_rs::{Encoding, UTF_16BE, UTF_16LE, WINDOWS_1252};

use super::{Fault, whole_file};
use crate::error::Result;

/// Bytes looked at for the zeros that UTF-16 without a mark is known by.
const LOOKED_AT: usize = 256;

/// The text of a file without byte order mark.
///
/// # Errors
/// Characters that no text has: the file is something else.
pub(super) fn text<'a>(bytes: &'a [u8], file: &Path) -> Result<Cow<'a, str>> {
    let text = match Encoding::for_bom(bytes).map(|(encoding, _)| encoding).or_else(|| unmarked_utf16(bytes)) {
        Some(encoding) => encoding.decode(bytes).0,
        None => match std::str::from_utf8(bytes) {
            Ok(text) => Cow::Borrowed(text),
            // Spreadsheets of Western Europe; every byte is a character in it.
            Err(_) => WINDOWS_1252.decode(bytes).0,
        },
    };
    let strange =
        |c: char| (c.is_control() && !matches!(c, '\t' | '\n' | '\r' | '\u{b}' | '\u{c}' | '\u{85}')) || c == '\u{fffd}';
    if let Some(place) = text.find(strange) {
        let line = 1 + text[..place].matches('\n').count();
        return Err(Fault { line: Some(line), ..whole_file(file) }
            .error("is no text (it has characters that no table has)", "save the table as CSV in UTF-8, or as .xlsx"));
    }
    Ok(text)
}

/// UTF-16 of mostly Latin letters has a zero in every other byte.
fn unmarked_utf16(bytes: &[u8]) -> Option<&'static Encoding> {
    let head = &bytes[..bytes.len().min(LOOKED_AT) & !1];
    let zeros = |offset: usize| head.iter().skip(offset).step_by(2).filter(|&&byte| byte == 0).count();
    let (even, odd, most) = (zeros(0), zeros(1), head.len() / 2 * 3 / 4);
    match head.len() {
        0..8 => None,
        _ if odd > most && even == 0 => Some(UTF_16LE),
        _ if even > most && odd == 0 => Some(UTF_16BE),
        _ => None,
    }
}
