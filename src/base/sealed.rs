//! Checkpoints as bytes: with the version of the program that wrote them and a checksum, so that no other takes them back.

use serde::Serialize;
use serde::de::DeserializeOwned;
use sha2::{Digest, Sha256};

use crate::error::{Error, InputError, Result, fail_if};

/// Program by which a checkpoint can be taken up.
const VERSION: &str = env!("CARGO_PKG_VERSION");

#[derive(Debug, Clone, Copy)]
pub struct Seal {
    /// What a file that does not begin with `magic` is no checkpoint of, in words.
    pub of: &'static str,
    pub magic: &'static [u8],
    /// Form of what follows; one higher with every change of it, or of what the program does with it.
    pub form: u32,
}

impl Seal {
    pub fn to_bytes(self, checkpoint: &impl Serialize) -> Vec<u8> {
        // Numbers, text, lists and options of known length can always be written to memory.
        let content = postcard::to_stdvec(checkpoint).unwrap_or_default();
        let head = [self.magic, &self.form.to_le_bytes(), &[VERSION.len() as u8], VERSION.as_bytes(), &Sha256::digest(&content)];
        [&head.concat()[..], &content].concat()
    }

    /// From what [`Seal::to_bytes`] gave.
    /// Errors: [`Error::Input`] that says what is wrong: no such checkpoint at all, one of another version of the program, or a damaged
    /// one.
    pub fn read<T: DeserializeOwned>(self, bytes: &[u8]) -> Result<T> {
        let damaged = || refused("is damaged");
        let rest = bytes.strip_prefix(self.magic).ok_or_else(|| refused(format!("is not a checkpoint of {}", self.of)))?;
        let (form, rest) = rest.split_first_chunk().ok_or_else(damaged)?;
        let (length, rest) = rest.split_first().ok_or_else(damaged)?;
        let (version, rest) = rest.split_at_checked(usize::from(*length)).ok_or_else(damaged)?;
        if (u32::from_le_bytes(*form), version) != (self.form, VERSION.as_bytes()) {
            let other = String::from_utf8_lossy(version);
            return Err(refused(format!("written by perilife {other}; this is {VERSION}")));
        }
        let (sum, content) = rest.split_first_chunk::<32>().ok_or_else(damaged)?;
        fail_if!(Sha256::digest(content)[..] != sum[..], damaged());
        postcard::from_bytes(content).map_err(|_| damaged())
    }
}

pub fn refused(problem: impl Into<String>) -> Error {
    Error::Input(Box::new(InputError {
        problem: problem.into(),
        remedy: "remove it, or use another file, to start the run again".to_owned(),
        ..InputError::default()
    }))
}

/// The points whose value is not the usual one.
pub fn sparse(values: &[f64], usual: f64) -> Vec<(u32, f64)> {
    values.iter().enumerate().filter(|(_, value)| **value != usual).map(|(point, value)| (point as u32, *value)).collect()
}

/// All values from those that are not the usual one, each below `points`.
pub fn dense(sparse: &[(u32, f64)], usual: f64, points: usize) -> Vec<f64> {
    let mut values = vec![usual; points];
    sparse.iter().for_each(|&(point, value)| values[point as usize] = value);
    values
}
