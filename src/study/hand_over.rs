//! Cracks that begin at a slot by the lives of their bonds and go on by the K of their tip: what is left of the life then, against nodes
//! without elements from the same length. There the slot is part of the outline.

use super::cases::{self, NODES};
use super::table::Table;
use perilife_base::error::{Error, Result};
use perilife_base::units::MM;

/// Slot of a plate of 60 × 150 mm from its left edge, 1.5 mm wide: how far it reaches, mm.
const SLOT: f64 = -20.0;
const REST: &str = "thickness_mm = 3\n[material]\nname = \"steel-4340\"\n[loading]\nstress_max_mpa = 120\nstress_ratio = 0.1\n\
                    [fatigue]\na = 6450\np = 2.86\nhorizon_mm = 3.015\n";

/// Rows of the topic.
pub fn rows(table: &mut Table) -> Result<()> {
    let slot = format!("notches = [{{ from_mm = [-30, 0], to_mm = [{SLOT}, 0], width_mm = 1.5 }}]\n");
    let slotted = format!("[specimen]\nkind = \"plate\"\nwidth_mm = 60\nlength_mm = 150\n{slot}{REST}");
    for spacing in [1.0, 0.75, 0.5] {
        let run = cases::run(&slotted, &format!("model.spacing_mm={spacing}"))?;
        let row = run.curve.iter().find(|row| row.tips.iter().all(|tip| tip.factors.is_some()));
        let row = row.ok_or_else(|| Error::Mechanics("no crack was handed over".to_owned()))?;
        let to = SLOT + row.tips[0].growth / MM;
        let outline = format!(
            "outline_mm = [[-30, -75], [30, -75], [30, 75], [-30, 75], [-30, 0.75], [{SLOT}, 0.75], [{SLOT}, -0.75], [-30, -0.75]]\n\
             cracks = [{{ from_mm = [{SLOT}, 0], to_mm = [{to}, 0] }}]\n"
        );
        let on_nodes = cases::run(&format!("[specimen]\nkind = \"plate\"\n{outline}{REST}"), NODES)?.life_cycles();
        let quantity = format!("slot of 10 mm, spacing {spacing} mm, crack of {:.2} mm: life left where K takes over", to - SLOT);
        table.compare(quantity, run.life_cycles() - row.cycles, on_nodes, 1.0, "nodes without elements from the same length");
    }
    Ok(())
}
