//! Checkpoints as bytes: with the version of the program that wrote them and a checksum, so that no other takes them back.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
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
        let form = u32::from_le_bytes(*form);
        if (form, version) != (self.form, VERSION.as_bytes()) {
            let other = String::from_utf8_lossy(version);
            return Err(refused(format!(
                "written by perilife {other}; this is {VERSION} (checkpoint form {form}, not {})",
                self.form
            )));
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

/// What a run leaves to go on from.
pub trait Kept: Serialize + DeserializeOwned {
    /// What such a run is of.
    type Input;
    const SEAL: Seal;
    /// What is wrong with the checkpoint of another input.
    const OF_ANOTHER: &'static str;

    /// Hash of all that decides how the run of an input goes; its name and where its file lies do not.
    fn hash(input: &Self::Input) -> [u8; 32];
}

/// State of a run at a place where it can be taken up.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint<K> {
    input: [u8; 32],
    /// Time spent on the run so far, s.
    pub wall_s: f64,
    pub kept: K,
}

impl<K: Kept> Checkpoint<K> {
    /// That of a run of an input with this [`Kept::hash`].
    pub fn new(input: [u8; 32], wall_s: f64, kept: K) -> Self {
        Checkpoint { input, wall_s, kept }
    }

    /// Whether it is that of a run of this input.
    pub fn belongs_to(&self, input: &K::Input) -> bool {
        self.input == K::hash(input)
    }

    /// Refuses the checkpoint of another input.
    pub fn check(&self, input: &K::Input) -> Result<()> {
        if self.belongs_to(input) { Ok(()) } else { Err(refused(K::OF_ANOTHER)) }
    }

    /// As bytes, with a checksum.
    pub fn to_bytes(&self) -> Vec<u8> {
        K::SEAL.to_bytes(self)
    }

    /// That of a run of this input, from its bytes.
    /// Errors: bytes that are no checkpoint, or one of another input.
    pub fn of(input: &K::Input, bytes: &[u8]) -> Result<Self> {
        let checkpoint = Self::from_bytes(bytes)?;
        checkpoint.check(input).map(|()| checkpoint)
    }

    /// From what [`Checkpoint::to_bytes`] gave.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self> {
        K::SEAL.read(bytes)
    }
}

/// Hash of text: debug output of floats says them to the last bit.
pub fn hash_of(words: &impl std::fmt::Debug) -> [u8; 32] {
    Sha256::digest(format!("{words:?}")).into()
}

/// Forms of many values of which most are the usual one: their count, and the others with their places.
macro_rules! mostly {
    ($($name:ident: $usual:literal),*) => { $(pub mod $name {
        use serde::de::Error;
        use serde::{Deserialize, Deserializer, Serialize, Serializer};

        pub fn serialize<S: Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
            let others = values.iter().enumerate().filter(|(_, value)| **value != $usual);
            (values.len(), others.map(|(at, value)| (at as u32, *value)).collect::<Vec<_>>()).serialize(to)
        }

        pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
            let (count, others): (usize, Vec<(u32, f64)>) = Deserialize::deserialize(from)?;
            let mut values = vec![$usual; count];
            for (at, value) in others {
                *values.get_mut(at as usize).ok_or_else(|| D::Error::custom("a place beyond the values"))? = value;
            }
            Ok(values)
        }
    })* };
}

mostly! { mostly_zero: 0.0, mostly_one: 1.0 }
