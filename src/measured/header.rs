//! Which column of a header is which: as the user says, else by its name; and headers of pairs, cycles and crack length of every specimen
//! beside each other, `N1, a1, N2, a2`, or `N, a, N, a`.

use super::import::Import;
use perilife_base::table::names::{Column, Kind, Named, Role};
use perilife_base::table::{Sheet, Vocabulary};

/// Columns of a header as it stands in the file, and with the units of the row below.
pub(super) fn columns_of(header: &[String], names: &[String], import: &Import) -> Vec<Column> {
    let kind = if import.of_rates { Kind::Rates } else { Kind::Readings };
    let mut columns: Vec<Column> = names.iter().enumerate().map(|(index, name)| Column::named(kind, index, name)).collect();
    for (_, role, _) in import.columns.given() {
        let same = |column: &&mut Column| column.role == role || (role == Role::Length && column.is_length());
        columns.iter_mut().filter(same).for_each(|column| *column = Column::new(column.index, Role::Other, Named::No));
    }
    for (_, role, name) in import.columns.given() {
        if let Some(index) = place_of(name, header, names) {
            let role = if role == Role::Length && import.columns.has_sides() { Role::Side } else { role };
            columns[index] = Column::given(index, role, &names[index]);
        }
    }
    columns
}

/// Whether all columns behind the first are names of specimens, and perhaps what several of them have.
pub(super) fn is_wide(columns: &[Column]) -> bool {
    let (statistics, specimens): (Vec<&Column>, Vec<&Column>) =
        columns.iter().skip(1).partition(|column| column.role == Role::Statistic);
    !specimens.is_empty() && specimens.len() + statistics.len() > 1 && specimens.iter().all(|column| column.role == Role::Unknown)
}

/// Whether a row of names, with what the user says, names cycles and crack length, starts a wide table or is one of pairs; of a table of
/// rates, K and da/dN, or one of them at stress ratios.
fn names_a_test(names: &[String], import: &Import) -> bool {
    let import = &Import { columns: import.columns.by_name(), ..import.clone() };
    if import.of_rates {
        let columns = columns_of(names, names, import);
        let has = |role: Role| columns.iter().any(|column| column.role == role);
        let is_wide = || names.iter().any(|name| ratio_of_name(name).is_some());
        return match has(Role::Rate) {
            true => has(Role::DeltaK) || has(Role::KMax) || is_wide(),
            false => has(Role::DeltaK) && is_wide(),
        };
    }
    if pairs_of(names).is_some() {
        return true;
    }
    let columns = columns_of(names, names, import);
    let first = |wanted: fn(&Column) -> bool| columns.iter().position(wanted);
    match (first(|column| column.role == Role::Cycles), first(Column::is_length)) {
        (Some(_), Some(_)) => true,
        (Some(0), None) | (None, Some(0)) => is_wide(&columns) && names.iter().all(|name| !name.is_empty()),
        _ => false,
    }
}

impl Vocabulary for Import {
    fn leaves_out(&self, line: usize) -> bool {
        self.left_out.iter().any(|one| one.line == Some(line))
    }

    fn is_header(&self, names: &[String]) -> bool {
        names_a_test(names, self)
    }

    fn sheet(&self) -> Option<&Sheet> {
        self.sheet.as_ref()
    }
}

/// Place of a column that the user names: as written, else whatever its case and blanks, else by number.
pub(super) fn place_of(wanted: &str, header: &[String], names: &[String]) -> Option<usize> {
    let plain = |name: &str| name.to_lowercase().split_whitespace().collect::<Vec<_>>().join(" ");
    let exact = header.iter().position(|name| name == wanted);
    let alike = || [header, names].iter().find_map(|list| list.iter().position(|name| plain(name) == plain(wanted)));
    exact.or_else(alike).or_else(|| {
        let number = wanted.parse::<usize>().ok()?;
        (1..=names.len()).contains(&number).then(|| number - 1)
    })
}

/// A name without its number, and the number: `a1 (mm)` is `a (mm)` and 1.
pub(super) fn cut(name: &str) -> (String, Option<&str>) {
    let end = name.find(['(', '[', '{']).unwrap_or(name.len());
    let (words, unit) = (name[..end].trim_end(), &name[end..]);
    let base = words.trim_end_matches(|c: char| c.is_ascii_digit());
    let number = &words[base.len()..];
    match base.trim_end_matches([' ', '_', '-', '#', '.']) {
        base if !base.is_empty() && !number.is_empty() => (format!("{base} {unit}"), Some(number)),
        _ => (name.to_owned(), None),
    }
}

/// Names that are cycles and length in turn: the number of each pair, or its place, with its columns. All have a number and no other the
/// same, or none has.
pub(super) fn pairs_of(names: &[String]) -> Option<Vec<(String, [Column; 2])>> {
    // Tables beside each other have an empty column between them.
    let (places, names): (Vec<usize>, Vec<(String, Option<&str>)>) =
        names.iter().enumerate().filter(|(_, name)| !name.is_empty()).map(|(place, name)| (place, cut(name))).unzip();
    let columns: Vec<Column> =
        places.iter().zip(&names).map(|(&index, (base, _))| Column::named(Kind::Readings, index, base)).collect();
    let count = names.len() / 2;
    let is_pair = |pair: usize| {
        let [cycles, length] = [2 * pair, 2 * pair + 1];
        (columns[cycles].role, columns[length].role) == (Role::Cycles, Role::Length) && names[cycles].1 == names[length].1
    };
    let numbers: Vec<Option<&str>> = (0..count).map(|pair| names[2 * pair].1).collect();
    let is_own = |i: usize| numbers[i].is_some() && !numbers[..i].contains(&numbers[i]);
    let have_names = numbers.iter().all(Option::is_none) || (0..count).all(is_own);
    if count < 2 || !names.len().is_multiple_of(2) || !have_names || !(0..count).all(is_pair) {
        return None;
    }
    let pair = |pair: usize| {
        let name = numbers[pair].map_or_else(|| (pair + 1).to_string(), str::to_owned);
        (name, [columns[2 * pair], columns[2 * pair + 1]])
    };
    Some((0..count).map(pair).collect())
}

/// The stress ratio of a column that is named by it, and the bracket behind it: `R=0.1`, `R 0.5 (MPa√m)`, `ΔK at R0.7`.
pub(super) fn ratio_of_name(name: &str) -> Option<(&str, &str)> {
    let is_word = |place: &usize| name[*place..].starts_with(['R', 'r']) && !name[..*place].ends_with(char::is_alphanumeric);
    let place = name.char_indices().map(|(place, _)| place).find(is_word)?;
    let text = name[place + 1..].trim_start_matches(['=', ' ', '_', ':']);
    let (number, rest) = text.split_at(text.find([' ', '(', '[', '{']).unwrap_or(text.len()));
    let is_ratio = number.replace(',', ".").replace('\u{2212}', "-").parse().is_ok_and(|ratio: f64| ratio < 1.0);
    let rest = rest.trim_start();
    (is_ratio && (rest.is_empty() || rest.starts_with(['(', '[', '{']))).then_some((number, rest))
}
