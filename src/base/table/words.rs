//! Names of columns as plain words, whatever their case, signs and brackets.

/// Lower-case words of a name, and those of a last bracket; one of nothing but words that are part of a name
/// counts as the name.
pub fn words(name: &str, is_part_of_name: impl Fn(&str) -> bool) -> (Vec<String>, Vec<String>) {
    let mut plain = String::with_capacity(name.len());
    for c in name.chars().flat_map(char::to_lowercase) {
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
            '"' | '″' | '”' => plain.push_str(" inch"),
            other => plain.push(other),
        }
    }
    let cut = |text: &str| -> Vec<String> {
        text.split(|c: char| !c.is_alphanumeric()).filter(|word| !word.is_empty()).map(str::to_owned).collect()
    };
    let trimmed = plain.trim_end();
    let open = trimmed.rfind(['(', '[', '{']).filter(|_| trimmed.ends_with([')', ']', '}']));
    match open {
        Some(open) if !cut(&trimmed[..open]).is_empty() => {
            let (before, inside) = (cut(&trimmed[..open]), cut(&trimmed[open..]));
            match inside.as_slice() {
                [] => (before, Vec::new()),
                words if words.iter().all(|word| is_part_of_name(word)) => ([before, inside].concat(), Vec::new()),
                _ => (before, inside),
            }
        }
        _ => (cut(&plain), Vec::new()),
    }
}
