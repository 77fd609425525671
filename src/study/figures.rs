//! What computations that are no case are given and give: keys `name=value`, and figures by name.

use std::str::FromStr;

use perilife_base::error::{Error, Result};

pub type Figures = Vec<(&'static str, f64)>;

pub struct Keys<'a>(pub &'a [String]);

impl Keys<'_> {
    /// The value of a key.
    pub fn get<T: FromStr>(&self, name: &str) -> Result<T> {
        let value = self.0.iter().find_map(|key| key.strip_prefix(name)?.strip_prefix('='));
        let read = value.and_then(|value| value.parse().ok());
        read.ok_or_else(|| Error::Mechanics(format!("data/studies: keys \"{}\": no {name}", self.0.join(" "))))
    }
}
