//! The three troubles a caller can act on: wrong input, mechanics that gave no result, file or network.

use std::fmt;
use std::path::{Path, PathBuf};

/// Everything a public function of this crate can fail with.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// Wrong input: the caller changes the input and tries again (exit code 2).
    #[error(transparent)]
    Input(#[from] Box<InputError>),
    /// No convergence, or the mechanics stopped the run before there was a result (exit code 3).
    #[error("{0}")]
    Mechanics(String),
    /// What is left of a plate is a mechanism, or nearly one: it carries no load (exit code 3).
    #[error("the plate is cut in two or is a mechanism")]
    LossOfStiffness,
    /// A file could not be read or written (exit code 4).
    #[error("{}: {action}: {source}", path.display())]
    File {
        path: PathBuf,
        /// What was tried, for example "cannot read" (reads well after the path and a colon).
        action: &'static str,
        #[source]
        source: std::io::Error,
    },
}

/// Result of the crate's fallible functions.
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// Process exit code of this trouble: 2 wrong input, 3 mechanics, 4 file.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Input(_) => 2,
            Error::Mechanics(_) | Error::LossOfStiffness => 3,
            Error::File { .. } => 4,
        }
    }

    /// A file that could not be read or written.
    pub fn file(path: &Path, action: &'static str, source: std::io::Error) -> Self {
        Error::File { path: path.to_path_buf(), action, source }
    }

    /// Several mistakes as one error.
    /// Errors: these; none where there is none.
    pub fn of_all(mistakes: Vec<InputError>) -> Result<()> {
        let mut all = mistakes.into_iter();
        all.next().map_or(Ok(()), |first| Err(Error::Input(Box::new(InputError { more: all.collect(), ..first }))))
    }

    /// Names the file an input error came from, where it is not named yet.
    pub fn in_file(self, path: &Path) -> Self {
        match self {
            Error::Input(mut input) => {
                std::iter::once(&mut input.file).chain(input.more.iter_mut().map(|one| &mut one.file)).for_each(|file| {
                    file.get_or_insert_with(|| path.to_path_buf());
                });
                Error::Input(input)
            }
            other => other,
        }
    }
}

/// Wrong input: where it stands, which value, what is wrong with it and what would be right.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct InputError {
    pub file: Option<PathBuf>,
    pub line: Option<usize>,
    /// Key (`specimen.crack_length_mm`) or column (`cycles`).
    pub key: Option<String>,
    pub value: Option<String>,
    /// What is wrong, said so that it reads on after "key = value:".
    pub problem: String,
    pub remedy: String,
    /// Other mistakes of the same file, which do not depend on this one.
    pub more: Vec<InputError>,
}

/// Mistakes of one file that are told at once; the rest is counted.
const TOLD_AT_ONCE: usize = 10;
/// Most characters of a key or value that a message repeats: what a user gave may be a whole file.
pub const VALUE_MAX: usize = 200;
/// Most characters of a sentence of a message, which may repeat names.
pub const SENTENCE_MAX: usize = 2000;

impl std::error::Error for InputError {}

impl InputError {
    /// This mistake and all beside it, one by one.
    pub fn each(mut self) -> Vec<InputError> {
        let more = std::mem::take(&mut self.more);
        std::iter::once(self).chain(more).collect()
    }
}

impl fmt::Display for InputError {
    /// `file:line: key = value: problem; remedy`, leaving out what is not known; of several mistakes a numbered line each.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.more.is_empty() {
            let count = 1 + self.more.len();
            write!(f, "{count} mistakes")?;
            for (i, one) in self.clone().each().iter().enumerate().take(TOLD_AT_ONCE) {
                write!(f, "\n{}. {one}", i + 1)?;
            }
            let rest = count.saturating_sub(TOLD_AT_ONCE);
            return if rest == 0 { Ok(()) } else { write!(f, "\nand {rest} more") };
        }
        if let Some(file) = &self.file {
            write!(f, "{}", file.display())?;
            if let Some(line) = self.line {
                write!(f, ":{line}")?;
            }
            write!(f, ": ")?;
        }
        match (&self.key, &self.value) {
            (Some(key), Some(value)) => write!(f, "{key:.VALUE_MAX$} = {value:.VALUE_MAX$}: ")?,
            (Some(key), None) => write!(f, "{key:.VALUE_MAX$}: ")?,
            (None, Some(value)) => write!(f, "{value:.VALUE_MAX$}: ")?,
            (None, None) => {}
        }
        write!(f, "{:.SENTENCE_MAX$}", self.problem)?;
        if !self.remedy.is_empty() {
            write!(f, "; {:.SENTENCE_MAX$}", self.remedy)?;
        }
        Ok(())
    }
}

/// Input error about a key and its value.
///
/// ```
/// let error = perilife_base::error::input("specimen.crack_length_mm", 90.0, "is beyond the half width 76.2 mm", "give a shorter crack");
/// assert_eq!(error.to_string(), "specimen.crack_length_mm = 90: is beyond the half width 76.2 mm; give a shorter crack");
/// assert_eq!(error.exit_code(), 2);
/// ```
pub fn input(key: &str, value: impl fmt::Display, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
    Error::Input(Box::new(InputError {
        key: Some(key.to_owned()),
        value: Some(value.to_string()),
        problem: problem.into(),
        remedy: remedy.into(),
        ..InputError::default()
    }))
}

pub fn input_missing(key: &str, problem: impl Into<String>, remedy: impl Into<String>) -> Error {
    Error::Input(Box::new(InputError {
        key: Some(key.to_owned()),
        problem: problem.into(),
        remedy: remedy.into(),
        ..InputError::default()
    }))
}

/// Returns an error where something is wrong: `fail_if!(length <= 0.0, input(KEY, length, problem, remedy));`, or
/// `fail_if!(let Some(second) = columns.next(), fault(second));`.
#[macro_export]
macro_rules! fail_if {
    (let $wrong:pat = $value:expr, $error:expr) => {
        if let $wrong = $value {
            return Err($error);
        }
    };
    ($wrong:expr, $error:expr) => {
        if $wrong {
            return Err($error);
        }
    };
}
pub use crate::fail_if;
