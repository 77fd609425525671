//! All that tells a user of keys: lines of `perilife list keys`, JSON Schema and form of the page, table of the guide, sections of Python.

use serde_json::{Map, Value as Json, json};

use super::{Key, Need, Shape, all};
use crate::kinds::KindLine;
use crate::units::us::{System, Unit, renamed};

/// Keys of one section, or of one of its kinds.
#[derive(Debug, Clone)]
pub struct Told {
    /// Its name: `stop`, `specimen.lug`.
    pub section: String,
    pub meaning: String,
    /// The key that tells the kind, with the name of it.
    pub tag: Option<(&'static str, &'static str)>,
    pub is_needed: bool,
    pub keys: Vec<Key>,
}

impl Key {
    pub fn label_and_hint(&self) -> (&'static str, &'static str) {
        self.text.split_once(": ").unwrap_or((self.text, ""))
    }

    /// Its name in US units and metric units in one of these; of the level C of a law at the exponent 0, with the key of that.
    fn twin(&self) -> Option<(String, f64, Option<String>)> {
        let twin = renamed(self.name, System::Us)?;
        let (factor, exponent) = (twin.factor(|_| Some(0.0)).ok()?, twin.factor(|_| None).err().map(str::to_owned));
        Some((twin.name, 1.0 / factor, exponent))
    }

    /// Range and unit, names, or sort of value.
    pub fn range(&self) -> String {
        match (self.quantity, self.shape) {
            (Some(of), Shape::Number | Shape::Whole) => format!("{} to {} {}", of.low, of.high, of.unit).trim_end().to_owned(),
            (_, Shape::Choice(lines) | Shape::List(&Shape::Choice(lines))) => {
                lines().iter().map(|line| line.name).collect::<Vec<_>>().join(" | ")
            }
            (Some(of), shape) if !of.unit.is_empty() => format!("{}, {}", shape.words(), of.unit),
            (_, Shape::Other(_)) if !self.remedy.is_empty() => self.remedy.trim_start_matches("give ").to_owned(),
            (_, shape) => shape.words().to_owned(),
        }
    }

    /// Whether it is needed, or what stands for it.
    pub fn left_out(&self) -> String {
        let own = match self.need {
            Need::Required if self.group.is_none() => "needed".to_owned(),
            Need::Or(words) => words.to_owned(),
            _ => "-".to_owned(),
        };
        let group = self.group.map(|what| format!("one key of {what}"));
        let only = self.only.map(|(of, with)| format!("with {of} = {}", with.join(", ")));
        [Some(own).filter(|own| own != "-" || (group.is_none() && only.is_none())), group, only]
            .into_iter()
            .flatten()
            .collect::<Vec<_>>()
            .join("; ")
    }
}

impl Told {
    /// Keys with those of tables below them, each with its path in the section.
    fn rows(&self) -> Vec<(String, Key)> {
        fn below(above: &str, keys: &[Key], rows: &mut Vec<(String, Key)>) {
            for key in all(keys) {
                let path = format!("{above}{}", key.name);
                rows.push((path.clone(), key));
                match key.shape {
                    Shape::Table(keys) => below(&format!("{path}."), keys, rows),
                    Shape::List(Shape::Table(keys)) => below(&format!("{path}[]."), keys, rows),
                    _ => {}
                }
            }
        }
        let mut rows = Vec::new();
        below("", &self.keys, &mut rows);
        rows
    }

    /// Lines of the list: key, range or names, what is taken where it is left out, meaning.
    pub fn lines(&self) -> Vec<[String; 4]> {
        let line =
            |(path, key): (String, Key)| [format!("{}.{path}", self.section), key.range(), key.left_out(), key.text.to_owned()];
        self.rows().into_iter().map(line).collect()
    }

    pub fn choices(&self) -> Vec<KindLine> {
        let of = |(_, key): (String, Key)| match key.shape {
            Shape::Choice(lines) | Shape::List(&Shape::Choice(lines)) => lines(),
            _ => Vec::new(),
        };
        self.rows().into_iter().flat_map(of).collect()
    }

    pub fn manual(&self) -> String {
        let row = |(path, key): (String, Key)| {
            let twin = key.twin().map(|(twin, ..)| format!(", `{twin}`")).unwrap_or_default();
            format!("| `{path}`{twin} | {} | {} | {} |\n", key.text, key.range().replace('|', "\\|"), key.left_out())
        };
        let rows: String = self.rows().into_iter().map(row).collect();
        let head = "| key | meaning | values | default |\n|---|---|---|---|";
        format!("### `[{}]`\n\n{}\n\n{head}\n{rows}\n", self.section, self.meaning)
    }

    pub fn stub(&self) -> String {
        class(&class_name("", &self.section), &self.keys, self.tag)
    }

    pub fn schema(&self) -> Json {
        let mut own = object(&self.keys);
        own["title"] = json!(self.section);
        own["description"] = json!(self.meaning);
        if let Some((tag, name)) = self.tag {
            own["properties"][tag] = json!({ "const": name });
            own["required"].as_array_mut().into_iter().for_each(|list| list.push(json!(tag)));
        }
        own
    }
}

pub fn schema(title: &str, sections: &[Told]) -> Json {
    let (mut properties, mut required) = (Map::new(), Vec::new());
    for told in sections {
        let name = told.section.split('.').next().unwrap_or("");
        match (told.tag, properties.get_mut(name)) {
            (None, _) => drop(properties.insert(name.to_owned(), told.schema())),
            (Some(_), Some(known)) => known["oneOf"].as_array_mut().into_iter().for_each(|list| list.push(told.schema())),
            (Some(_), None) => drop(properties.insert(name.to_owned(), json!({ "oneOf": [told.schema()] }))),
        }
        if told.is_needed && !required.contains(&json!(name)) {
            required.push(json!(name));
        }
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema", "title": title, "type": "object",
        "properties": properties, "required": required, "additionalProperties": false,
    })
}

fn object(keys: &[Key]) -> Json {
    let (mut properties, mut required, mut either) = (Map::new(), Vec::new(), Vec::new());
    for key in all(keys) {
        let mut own = value(&key, key.shape, 1.0);
        let (label, hint) = key.label_and_hint();
        own["title"] = json!(label);
        own["description"] =
            json!([hint, &key.left_out()].into_iter().filter(|part| !["", "-"].contains(part)).collect::<Vec<_>>().join("; "));
        own["x-hint"] = json!(hint);
        own["x-unit"] = json!(key.quantity.map_or("", |quantity| quantity.unit));
        own["x-default"] = json!(if let Need::Or(words) = key.need { words } else { "" });
        own["x-needed"] = json!(key.need == Need::Required && key.group.is_none());
        if let Some(group) = key.group {
            own["x-one-of"] = json!(group);
        }
        if let Some((of, with)) = key.only {
            own["x-only"] = json!({ "key": of, "values": with });
        }
        let is_needed = own["x-needed"] == json!(true);
        match key.twin() {
            Some((twin, factor, exponent)) => {
                let mut other = own.clone();
                for (name, bound) in value(&key, key.shape, factor).as_object().into_iter().flatten() {
                    other[name] = bound.clone();
                }
                other["x-twin"] = json!(key.name);
                let unit = key.quantity.and_then(|quantity| Unit::named(quantity.unit, System::Si));
                other["x-unit"] = json!(unit.map_or("", |unit| unit.word(System::Us)));
                own["x-twin"] = json!(twin);
                own["x-factor"] = json!(factor);
                own["x-exponent"] = json!(exponent);
                if is_needed {
                    either.push(json!({ "anyOf": [{ "required": [key.name] }, { "required": [twin] }] }));
                }
                properties.insert(twin, other);
            }
            None if is_needed => required.push(json!(key.name)),
            None => {}
        }
        properties.insert(key.name.to_owned(), own);
    }
    let mut own = json!({ "type": "object", "properties": properties, "required": required, "additionalProperties": false });
    if !either.is_empty() {
        own["allOf"] = json!(either);
    }
    own
}

/// Values of a shape; bounds in units of which one is `size` metric ones.
fn value(key: &Key, shape: Shape, size: f64) -> Json {
    let number = |sort: &str| match key.quantity {
        Some(of) => json!({ "type": sort, "minimum": of.low / size, "maximum": of.high / size }),
        None => json!({ "type": sort }),
    };
    match shape {
        Shape::Number => number("number"),
        Shape::Whole => number("integer"),
        Shape::Flag => json!({ "type": "boolean" }),
        Shape::Text => json!({ "type": "string" }),
        Shape::Choice(lines) => {
            let (names, meanings): (Vec<_>, Vec<_>) = lines().into_iter().map(|line| (line.name, line.meaning)).unzip();
            json!({ "type": "string", "enum": names, "x-meanings": meanings })
        }
        Shape::Numbers(n) => json!({ "type": "array", "items": number("number"), "minItems": n, "maxItems": n }),
        Shape::Other(words) => json!({ "x-values": words }),
        Shape::List(inner) => json!({ "type": "array", "items": value(key, *inner, size) }),
        Shape::Table([]) => json!({ "type": "object" }),
        Shape::Table(keys) => object(keys),
    }
}

fn class_name(class: &str, key: &str) -> String {
    let words = key.split(['_', '.']).filter_map(|word| Some(word.get(..1)?.to_uppercase() + word.get(1..)?));
    format!("{class}{}", words.collect::<String>())
}

/// A class of keys, with those of the tables below it before it.
fn class(name: &str, keys: &[Key], tag: Option<(&str, &str)>) -> String {
    let (mut before, mut own) = (String::new(), format!("class {name}(TypedDict, total=False):\n"));
    if let Some((tag, kind)) = tag {
        own.push_str(&format!("    {tag}: Literal[\"{kind}\"]\n"));
    }
    for key in all(keys) {
        if let Shape::Table(keys @ [_, ..]) | Shape::List(&Shape::Table(keys)) = key.shape {
            before.push_str(&class(&class_name(name, key.name), keys, None));
        }
        let plain = python(name, &key, key.shape);
        // With a twin in other units neither of both is needed by itself.
        let is_needed = key.need == Need::Required && key.group.is_none() && key.twin().is_none();
        let whole = if is_needed { format!("Required[{plain}]") } else { plain.clone() };
        own.push_str(&format!("    {}: {whole}  # {}; {}\n", key.name, key.text, key.left_out()));
        if let Some((twin, ..)) = key.twin() {
            own.push_str(&format!("    {twin}: {plain}\n"));
        }
    }
    if own.lines().count() == 1 {
        own.push_str("    pass\n");
    }
    format!("{before}{own}\n\n")
}

fn python(class: &str, key: &Key, shape: Shape) -> String {
    match shape {
        Shape::Number => "float".into(),
        Shape::Whole => "int".into(),
        Shape::Flag => "bool".into(),
        Shape::Text => "str".into(),
        Shape::Choice(lines) => {
            format!("Literal[{}]", lines().iter().map(|line| format!("\"{}\"", line.name)).collect::<Vec<_>>().join(", "))
        }
        Shape::Numbers(n) => format!("tuple[{}]", vec!["float"; n].join(", ")),
        Shape::Other(_) => "object".into(),
        Shape::List(inner) => format!("list[{}]", python(class, key, *inner)),
        Shape::Table([]) => "dict[str, object]".into(),
        Shape::Table(_) => class_name(class, key.name),
    }
}
