//! `.spx` of AFGROW: XML with `<B Mx="" Mn="" C=""/>` in every `<SubSpectrum>`, maximum, minimum and cycles in their order.

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use super::content::{Content, RawCycle};
use super::rows::{fault, number};
use perilife_base::error::Result;

const REMEDY: &str = "give <SubSpectrum> with <B Mx=\"max\" Mn=\"min\" C=\"cycles\"/>";

/// Reads the cycles of all sub-spectra.
pub(super) fn read(text: &str) -> Result<Content> {
    let mut reader = Reader::from_str(text);
    // Lines are counted as far as was read, so that the whole takes one pass.
    let (mut line, mut counted) = (1, 0);
    let mut found = Vec::new();
    loop {
        let event = reader.read_event();
        let place = (reader.buffer_position() as usize).min(text.len());
        line += text.as_bytes()[counted..place].iter().filter(|byte| **byte == b'\n').count();
        counted = place;
        match event {
            Ok(Event::Start(tag) | Event::Empty(tag)) if tag.local_name().as_ref() == "B" => found.push(cycle(&tag, line)?),
            Ok(Event::Eof) => return Ok(Content::Cycles(found)),
            Ok(_) => {}
            Err(error) => return Err(fault(Some(line), "XML", &error.to_string(), "cannot be read", REMEDY)),
        }
    }
}

fn cycle(tag: &BytesStart<'_>, line: usize) -> Result<RawCycle> {
    let value = |name: &str| -> Result<f64> {
        let attribute = tag.try_get_attribute(name).ok().flatten();
        let attribute = attribute.ok_or_else(|| fault(Some(line), name, "", "is missing in <B>", REMEDY))?;
        let text = attribute.value;
        number(line, name, text.trim())
    };
    Ok(RawCycle { line, max: value("Mx")?, min: value("Mn")?, count: value("C")? })
}
