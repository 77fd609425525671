//! Computations by name that are no case: fields, scenes and fits, each a few figures from a text and keys `name=value`.

use super::dual_horizon::{counts, momentum, patch_of};
use super::figures::{Figures, Keys};
use super::readings::{exponent_error, fit, rates_of_readings};
use super::scene_strength::{branches, growth_load};
use super::static_scenes::{shear, tension};
use super::subject::Watcher;
use super::{disc, moving, tension_plate};
use perilife_base::error::{Error, Result};

/// A computation from a text and keys.
type Computation = fn(&str, &Keys<'_>, &dyn Watcher) -> Result<Figures>;

const ALL: [(&str, Computation); 17] = [
    ("plate_in_tension", |_, keys, _| tension_plate::plate(keys)),
    ("worst_in_tension", |_, _, _| tension_plate::worst()),
    ("shape_in_tension", |_, keys, _| tension_plate::shape(keys)),
    ("scene_in_tension", |text, keys, _| tension(text, keys.get("nu")?)),
    ("sheared_square", |_, keys, _| shear(keys.get("nu")?, keys.get("rows")?)),
    ("disc", |_, keys, _| disc::figures(keys)),
    ("three_levels", |_, _, _| momentum()),
    ("patch", |_, keys, _| patch_of(&keys.get::<String>("law")?)),
    ("mixed_mode_points", |_, _, _| counts()),
    ("growing_scene", |text, keys, _| Ok(vec![("load", growth_load(text, keys.0)?)])),
    ("branching_scene", |text, keys, _| branches(text, keys.get("x_mm")?)),
    ("moving_scene", |text, keys, observer| moving::energy_lost(text, keys.get("share")?, observer)),
    ("loaded_scene", |text, _, observer| moving::largest_load(text, observer)),
    ("relaxed_plate", |_, keys, _| moving::relaxed(keys.get("factor")?)),
    ("rates", |text, keys, _| rates_of_readings(text, keys.get("method")?, keys.get("length_mm")?)),
    ("virkler_fit", |text, _, _| fit(text)),
    ("noisy_fit", |text, keys, observer| exponent_error(text, keys.get("noise")?, keys.get("count")?, observer)),
];

/// Figures of a computation by its name.
/// Errors: those of the computation; a name that is none.
pub fn computed(name: &str, text: &str, set: &[String], observer: &dyn Watcher) -> Result<Figures> {
    let found = ALL.iter().find(|(known, _)| *known == name);
    let (_, computation) = found.ok_or_else(|| Error::Mechanics(format!("data/studies: by = \"{name}\": no computation")))?;
    computation(text, &Keys(set), observer)
}
