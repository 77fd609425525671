//! Quantities in sentences: every number that stands before its unit, and the names of units alone.

use super::us::{Renamed, System, UNITS, Unit, clean, renamed};

/// Significant digits that a converted number has at least, so that a round one (2 mm) stays what it was.
const DIGITS_LEAST: usize = 4;
/// What may stand between two numbers of one unit.
const TIES: [&str; 8] = [" to ", " → ", " × ", " x ", "–", " ± ", " and ", " for "];
/// Ties that also join a number of something else, as in "tips 1 and 5 mm": before them only a number with decimals counts.
const LOOSE: [&str; 2] = [" and ", " for "];
/// Spaces that a number and its unit are set apart by.
const SPACES: [char; 4] = [' ', '\u{a0}', '\u{202f}', '\u{2009}'];
/// What stands before a number with the unit of K, where none is written: its symbol, and words before a second range of it.
const BARE: [&str; 3] = ["ΔK ", "% faster at ", "% slower at "];

struct Number {
    from: usize,
    to: usize,
    factor: f64,
    unit: Option<&'static Unit>,
}

/// A sentence with its quantities in the units of `to`: every number, pair or range before a unit of the other system, a ΔK that stands
/// without one, C of `da/dN = C ΔK^m (unit of rate, unit of ΔK)`, and names of units that stand alone.
pub fn in_units(text: &str, to: System) -> String {
    let from = to.other();
    let mut numbers = numbers(text);
    let places = places(text, from);
    for (place, unit) in &places {
        mark(text, &mut numbers, *place, unit.factor(to));
    }
    if to == System::Us {
        mark_bare(text, &mut numbers);
    }
    mark_level(text, &mut numbers, to);
    // What is replaced, in order.
    let mut parts: Vec<(usize, usize, String)> = places
        .iter()
        // A unit of one letter may stand for something else: N is also a number of cycles.
        .filter(|(place, unit)| {
            unit.word[0].len() > 1 || before(text, &numbers, *place).is_some_and(|[_, last]| numbers[last].factor != 1.0)
        })
        .map(|(place, unit)| (*place, place + unit.word(from).len(), unit.word(to).to_owned()))
        .collect();
    parts.extend(numbers.iter().filter(|number| number.factor != 1.0).map(|number| {
        let unit = number.unit.map_or_else(String::new, |unit| format!(" {}", unit.word(to)));
        (number.from, number.to, times(&text[number.from..number.to], number.factor) + &unit)
    }));
    parts.sort_by_key(|part| part.0);
    let (mut out, mut done) = (String::with_capacity(text.len() + 16), 0);
    for (from, to, new) in parts {
        out.push_str(&text[done..from]);
        out.push_str(&new);
        done = to;
    }
    out + &text[done..]
}

/// The same of words that name keys for whoever writes in the units of `to`: a key has the name that it has there (`crack_length_in`), and a
/// number that is said to be its value goes with it.
pub fn with_keys(text: &str, to: System) -> String {
    let text = in_units(text, to);
    let mut out = String::with_capacity(text.len() + 16);
    let mut rest = text.as_str();
    while let Some(start) = rest.find(|c: char| c.is_ascii_alphanumeric() || c == '_') {
        let word = &rest[start..];
        let word = &word[..word.find(|c: char| !(c.is_ascii_alphanumeric() || "_.[]".contains(c))).unwrap_or(word.len())];
        let word = word.trim_end_matches(['.', '[', ']']);
        let is_apart = !rest[..start].ends_with(['/', '\\', '-']);
        out.push_str(&rest[..start]);
        let behind = &rest[start + word.len()..];
        let new = Some(word).filter(|word| is_apart && is_key(word)).and_then(|word| renamed(word, to));
        let (new, behind) = new.and_then(|new| key_and_value(new, behind, to)).unwrap_or((word.to_owned(), behind));
        out.push_str(&new);
        rest = behind;
    }
    out + rest
}

/// Whether a word can be a key with a unit: one in its section, or one whose unit has more than a letter, as `a_n` has not.
fn is_key(word: &str) -> bool {
    let unit = word.rsplit('_').next().unwrap_or("");
    word.starts_with(|c: char| c.is_ascii_lowercase()) && unit.len() < word.len() && (unit.len() > 1 || word.contains('.'))
}

/// A key with the value that stands behind its sign of equality, and what follows; `None` where that is no number, or one whose size is not
/// known here.
fn key_and_value(new: Renamed, behind: &str, to: System) -> Option<(String, &str)> {
    let Some(value) = behind.trim_start_matches(' ').strip_prefix('=') else { return Some((new.name, behind)) };
    let value = value.trim_start_matches(' ');
    let digit = usize::from(value.starts_with('-'));
    if !value[digit..].starts_with(|c: char| c.is_ascii_digit()) {
        return None;
    }
    let (number, after) = value.split_at(end_of_number(value, digit));
    if UNITS.iter().any(|unit| after.trim_start_matches(SPACES).starts_with(unit.word(to))) {
        // It has a unit of its own, and has been told.
        return Some((new.name, behind));
    }
    let factor = new.factor(|_| None).ok()?;
    Some((format!("{}{}{}", new.name, &behind[..behind.len() - value.len()], times(number, factor)), after))
}

/// Where units of a system are named, the longest name at a place.
fn places(text: &str, of: System) -> Vec<(usize, &'static Unit)> {
    let is_apart = |c: Option<char>| c.is_none_or(|c| !(c.is_alphanumeric() || "_/√·^-.".contains(c)));
    let mut found: Vec<(usize, &'static Unit)> = Vec::new();
    for (place, _) in text.char_indices() {
        let rest = &text[place..];
        let unit = UNITS.iter().filter(|unit| rest.starts_with(unit.word(of))).max_by_key(|unit| unit.word(of).len());
        let Some(unit) = unit else { continue };
        let mut after = rest[unit.word(of).len()..].chars();
        let next = after.next();
        // A full stop ends a sentence where nothing follows it.
        let ends = is_apart(next) || (next == Some('.') && is_apart(after.next()));
        if ends && is_apart(text[..place].chars().next_back()) {
            found.push((place, unit));
        }
    }
    found
}

/// Numbers of a text; digits that are part of a word are none.
fn numbers(text: &str) -> Vec<Number> {
    let mut found = Vec::new();
    let mut at = 0;
    while let Some(step) = text[at..].find(|c: char| c.is_ascii_digit()) {
        let digit = at + step;
        let to = end_of_number(text, digit);
        let sign = text[..digit].chars().next_back().filter(|c| "-−+".contains(*c)).map_or(0, char::len_utf8);
        let is_word = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || "_.^".contains(c));
        // A dash behind a word or a number is no sign.
        let sign = if is_word(text[..digit - sign].chars().next_back()) { 0 } else { sign };
        let is_apart =
            !is_word(text[..digit].chars().next_back()) && !text[to..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
        if is_apart {
            found.push(Number { from: digit - sign, to, factor: 1.0, unit: None });
        }
        at = to;
    }
    found
}

/// Where a number ends that begins at a digit: thousands apart, decimals, power of ten.
fn end_of_number(text: &str, from: usize) -> usize {
    let digits = |at: usize| at + text[at..].bytes().take_while(u8::is_ascii_digit).count();
    let mut to = digits(from);
    while let Some(space) = text[to..].chars().next().filter(|c| SPACES[2..].contains(c)) {
        let group = to + space.len_utf8();
        if digits(group) != group + 3 {
            break;
        }
        to = group + 3;
    }
    if text[to..].starts_with('.') && digits(to + 1) > to + 1 {
        to = digits(to + 1);
    }
    if let Some(rest) = text[to..].strip_prefix('e') {
        let exponent = to + 1 + usize::from(rest.starts_with(['-', '+']));
        if digits(exponent) > exponent {
            to = digits(exponent);
        }
    }
    to
}

/// The numbers that a unit at `place` belongs to, the first and the last: one, or all in brackets before it.
fn before(text: &str, numbers: &[Number], place: usize) -> Option<[usize; 2]> {
    let near = text[..place].trim_end_matches(SPACES);
    let last = numbers.iter().rposition(|number| number.to <= near.len())?;
    if let Some(open) = near.strip_suffix(')').and_then(|within| within.rfind('(')) {
        let first = numbers.iter().position(|number| number.from > open)?;
        return (first <= last).then_some([first, last]);
    }
    (numbers[last].to == near.len()).then_some([last; 2])
}

/// Gives the numbers before a unit its factor, and those tied to them.
fn mark(text: &str, numbers: &mut [Number], place: usize, factor: f64) {
    let Some([mut first, mut last]) = before(text, numbers, place) else { return };
    loop {
        numbers[first..=last].iter_mut().for_each(|number| number.factor = factor);
        let Some(earlier) = first.checked_sub(1) else { return };
        let between = &text[numbers[earlier].to..numbers[first].from];
        let is_tied = TIES.contains(&between.trim_end_matches('(').trim_start_matches(')')) || is_listed(text, numbers, earlier);
        if !is_tied || (LOOSE.contains(&between) && !is_surely_one(text, &numbers[earlier])) {
            return;
        }
        // Both coordinates of a pair.
        let is_pair = between.starts_with(')') && earlier > 0 && is_listed(text, numbers, earlier - 1);
        (first, last) = (earlier - usize::from(is_pair), earlier);
    }
}

/// Whether a number and the next stand in one pair of brackets: coordinates.
fn is_listed(text: &str, numbers: &[Number], place: usize) -> bool {
    &text[numbers[place].to..numbers[place + 1].from] == ", " && text[..numbers[place].from].ends_with('(')
}

/// Whether a number before a loose tie is a quantity: it has decimals, or follows "between".
fn is_surely_one(text: &str, number: &Number) -> bool {
    text[number.from..number.to].contains(['.', 'e']) || text[..number.from].ends_with("between ")
}

/// A ΔK without a unit has that of K; it is written then.
fn mark_bare(text: &str, numbers: &mut [Number]) {
    let unit = &UNITS[0];
    for place in 0..numbers.len() {
        let head = text[..numbers[place].from].trim_end_matches("= ");
        if numbers[place].factor != 1.0 || !BARE.iter().any(|symbol| head.ends_with(symbol)) {
            continue;
        }
        let mut last = place;
        while last + 1 < numbers.len() && &text[numbers[last].to..numbers[last + 1].from] == TIES[0] {
            last += 1;
        }
        // It may have been told already.
        if text[numbers[last].to..].trim_start_matches(SPACES).starts_with(unit.word(System::Us)) {
            continue;
        }
        numbers[place..=last].iter_mut().for_each(|number| number.factor = unit.factor(System::Us));
        numbers[last].unit = Some(unit);
    }
}

/// C of Paris, which belongs to both units behind its formula.
fn mark_level(text: &str, numbers: &mut [Number], to: System) {
    let [intensity, rate] = [&UNITS[0], &UNITS[1]];
    let (from, level) = (to.other(), renamed(&format!("paris_c_{}", rate.suffix(to.other())), to));
    let units = format!(" ({}, {})", rate.word(from), intensity.word(from));
    let Some(level) = level else { return };
    let Some(place) = text.find(&units) else { return };
    let Some(formula) = text[..place].rfind(" ΔK^") else { return };
    let exponent = text[formula + " ΔK^".len()..place].parse::<f64>().ok();
    if let (Some(c), Ok(factor)) = (numbers.iter_mut().find(|number| number.to == formula), level.factor(|_| exponent)) {
        c.factor = factor;
    }
}

fn times(written: &str, factor: f64) -> String {
    let plain: String = written.replace('−', "-").chars().filter(|c| !SPACES.contains(c)).collect();
    let Ok(value) = plain.parse::<f64>() else { return written.to_owned() };
    let mantissa = plain.split('e').next().unwrap_or("");
    let significant = mantissa.trim_start_matches(['-', '+', '0', '.']).bytes().filter(u8::is_ascii_digit).count();
    let (value, digits) = (clean(value * factor), significant.max(DIGITS_LEAST));
    if value == 0.0 {
        return "0".to_owned();
    }
    // Its size is that of the rounded number: 9.9999 with four digits is 10.00.
    let rounded = format!("{value:.*e}", digits - 1);
    let size = rounded.split_once('e').and_then(|(_, size)| size.parse::<i32>().ok()).unwrap_or(0);
    let is_plain = !plain.contains('e') && (-4..7).contains(&size);
    let decimals = usize::try_from(digits as i32 - 1 - size).unwrap_or(0);
    let text = if is_plain { format!("{value:.decimals$}") } else { rounded };
    if written.contains('−') { text.replace('-', "−") } else { text }
}
