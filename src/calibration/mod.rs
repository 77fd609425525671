//! From measured curves to the constants of the fatigue law.

pub mod record;
