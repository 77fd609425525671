//! An error in words: one line for logs and pipes, on a terminal with the line of the input file it is about.

use std::fmt;
use std::io::IsTerminal;

use miette::{Diagnostic, GraphicalReportHandler, LabeledSpan, NamedSource, SourceCode};

use crate::error::{Error, InputError};

/// The message for stderr.
pub fn of(error: &Error) -> String {
    let plain = format!("error: {error}");
    if !std::io::stderr().is_terminal() {
        return plain;
    }
    match error {
        Error::Input(input) => with_source_line(input).unwrap_or(plain),
        _ => plain,
    }
}

/// The message with the file's line shown; `None` if file or line are not known or the file has gone.
pub fn with_source_line(input: &InputError) -> Option<String> {
    let (file, line) = (input.file.as_ref()?, input.line?);
    // A pipe is empty by now, and a terminal would wait.
    let text = Some(file).filter(|file| file.is_file()).and_then(|file| std::fs::read_to_string(file).ok())?;
    let start: usize = text.split_inclusive('\n').take(line.checked_sub(1)?).map(str::len).sum();
    let length = text.lines().nth(line - 1)?.len();
    // Where the trouble stands is part of the message already; the shown line takes their place.
    let message = InputError { file: None, line: None, remedy: String::new(), ..input.clone() }.to_string();
    let shown = Shown {
        message,
        remedy: input.remedy.clone(),
        source: NamedSource::new(file.display().to_string(), text),
        span: LabeledSpan::new(Some("here".to_owned()), start, length),
    };
    let mut words = String::new();
    GraphicalReportHandler::new().render_report(&mut words, &shown).ok()?;
    Some(words)
}

#[derive(Debug)]
struct Shown {
    message: String,
    remedy: String,
    source: NamedSource<String>,
    span: LabeledSpan,
}

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Shown {}

impl Diagnostic for Shown {
    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        (!self.remedy.is_empty()).then(|| Box::new(&self.remedy) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        Some(&self.source)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        Some(Box::new(std::iter::once(self.span.clone())))
    }
}
