//! Texts as plain words, whatever their case, accents, signs and brackets.

use std::sync::LazyLock;

/// Names of columns and spellings of units; empty where the file is damaged, which a test sees.
pub(super) static COLUMNS: LazyLock<toml::Table> =
    LazyLock::new(|| include_str!("../../../data/columns.toml").parse().unwrap_or_default());

/// Lower-case words of a text, and how many of them stand before a bracket at its end; all where nothing does.
pub fn words(text: &str) -> (Vec<String>, usize) {
    let mut plain = String::with_capacity(text.len());
    for c in text.chars().flat_map(char::to_lowercase) {
        match c {
            'ä' => plain.push_str("ae"),
            'ö' => plain.push_str("oe"),
            'ü' => plain.push_str("ue"),
            'ß' => plain.push_str("ss"),
            'é' | 'è' | 'ê' => plain.push('e'),
            'ó' | 'ô' => plain.push('o'),
            'ú' => plain.push('u'),
            'σ' => plain.push_str("sigma"),
            'δ' | '∆' => plain.push_str("delta "),
            'µ' | 'μ' => plain.push('u'),
            '²' if plain.ends_with("mm") => plain.push('2'),
            '√' => plain.push_str(" sqrt "),
            '³' => plain.push_str(" 3"),
            '⁶' => plain.push_str(" 6"),
            '×' => plain.push_str(" x"),
            '"' | '″' | '”' => plain.push_str(" inch"),
            other => plain.push(other),
        }
    }
    let cut = |text: &str| -> Vec<String> {
        text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let trimmed = plain.trim_end();
    let open = trimmed.rfind(['(', '[', '{']).filter(|_| trimmed.ends_with([')', ']', '}'])).unwrap_or(plain.len());
    let (all, before) = (cut(&plain), cut(&plain[..open]).len());
    let before = if before == 0 { all.len() } else { before };
    (all, before)
}
