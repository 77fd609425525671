//! The vocabulary of column names: every form of the data file means its role, and nothing but a whole form does.

use std::collections::BTreeMap;

use perilife_base::table::names::{Column, Kind, Named, Role};

/// Forms by kind of table, role and measure.
type Forms = BTreeMap<String, BTreeMap<String, toml::Value>>;

const KINDS: [(&str, Kind); 5] = [
    ("readings", Kind::Readings),
    ("rates", Kind::Rates),
    ("spectrum", Kind::Spectrum),
    ("residual_stress", Kind::ResidualStress),
    ("beta", Kind::Beta),
];

/// `StressY` as `stress_y`.
fn name(role: Role) -> String {
    format!("{role:?}").chars().fold(String::new(), |name, c| match c.is_uppercase() {
        true if !name.is_empty() => name + "_" + &c.to_lowercase().to_string(),
        _ => name + &c.to_lowercase().to_string(),
    })
}

/// What may stand behind a form, its unit, and what is another unit.
fn unit(measure: &str) -> [&'static str; 3] {
    match measure {
        "text" => [" (id)", "", ""],
        "number" => ["", "", ""],
        "length" | "length_said" => [" [mm]", "mm", " (kN)"],
        "cycles" => [" (x1000)", "kilocycles", " (mm)"],
        "kilocycles" => ["", "kilocycles", " (millions)"],
        "megacycles" => ["", "megacycles", " (thousands)"],
        "force" | "force_said" => ["/kN", "kN", " (MPa)"],
        "stress" | "stress_said" => [", ksi", "ksi", " (lbf)"],
        "load" => [" in MPa", "MPa", " (mm)"],
        "intensity" => [" (MPa√m)", "MPa sqrt(m)", " (MPa)"],
        "rate" => [" (in/cycle)", "in/cycle", " (mm)"],
        other => panic!("{other}"),
    }
}

#[test]
fn every_form_means_its_role_and_no_part_of_one_does() {
    let data: Forms = toml::from_str(include_str!("../../data/columns.toml")).unwrap();
    let mut count = 0;
    for (part, kind) in KINDS {
        let mut seen: Vec<String> = Vec::new();
        for (role, measures) in &data[part] {
            for (measure, forms) in measures.as_table().unwrap().iter().filter(|(measure, _)| !measure.ends_with("words")) {
                let [behind, in_unit, other] = unit(measure);
                for form in forms.as_str().unwrap().split(',').map(str::trim) {
                    let said = Column::named(kind, 3, &format!("{form}{behind}"));
                    assert_eq!((name(said.role), said.index), (role.clone(), 3), "{part}: {form}{behind}");
                    let own = if let Named::Is(unit) = said.unit { unit.name() } else { "" };
                    assert_eq!(own, in_unit, "{part}: {form}{behind}");
                    // In capitals, too; without a unit where none is wanted.
                    let bare = Column::named(kind, 0, &form.to_uppercase()).role;
                    let is_bare = !measure.ends_with("said") && form != "a";
                    assert_eq!(name(bare) == *role, is_bare, "{part}: {form}: {bare:?}");
                    let strange = Column::named(kind, 0, &format!("{form}{other}"));
                    let is_strange = strange.unit == Named::Strange && name(strange.role) == *role;
                    assert!(other.is_empty() || is_strange || measure.ends_with("said"), "{part}: {form}{other}: {strange:?}");
                    for longer in [format!("{form} xyz"), format!("xyz {form}")] {
                        let role = Column::named(kind, 0, &longer).role;
                        assert!(matches!(role, Role::Unknown | Role::Unclear | Role::Other), "{part}: {longer}: {role:?}");
                    }
                    assert!(
                        !seen.contains(&form.to_owned()) || measure.ends_with("said") || role == "unclear",
                        "{part}: {form} twice"
                    );
                    seen.push(form.to_owned());
                    count += 1;
                }
            }
        }
    }
    assert!(count > 800, "{count}");
}

#[test]
fn lengths_tip_to_tip_logarithms_and_long_names_are_told_apart() {
    let named = |name: &str| Column::named(Kind::Readings, 0, name);
    for (whole, role) in [("2a (mm)", Role::Length), ("Crack length 2a [mm]", Role::Length), ("2a left (mm)", Role::Side)] {
        assert!(named(whole).role == role && named(whole).is_tip_to_tip() && !named(&whole.replace("2a", "a")).is_tip_to_tip());
    }
    assert!(named("log10 da/dN (mm/cycle)").is_log && !named("da/dN (mm/cycle)").is_log);
    assert_eq!(named("log a (mm)").role, Role::Unknown);
    // A bare capital letter is a specimen, a cell of a remark is no name.
    assert_eq!([named("A").role, named("A (mm)").role], [Role::Unknown, Role::Length]);
    assert_eq!(named(&format!("cycles{}", " ".repeat(200))).role, Role::Unknown);
}
