//! Spacing and horizon of a plate of points: what they are where nothing is said, and which spacing resolves it.

use perilife_base::error::{Result, input};
use perilife_base::units::round_mm;
use perilife_plate::specimen::Specimen;

/// Horizon over spacing where the case says nothing: the value of the literature, just above 3 so that the third
/// neighbour along a row belongs to the family whatever the round-off.
pub const HORIZON_RATIO: f64 = 3.015;
/// More points than this do not fit into the memory of an ordinary machine.
const POINTS_MAX: f64 = 4e6;
/// Fewer spacings than this across the plate say nothing about a crack in it.
const COLUMNS_MIN: f64 = 8.0;
/// Share of the longest flaw below which a flaw does not decide the life: its rate is an eighth or less of that of the longest at m = 3.
const SMALL_FLAW: f64 = 0.25;
/// Points on a flaw that does not decide.
const POINTS_ON_FLAW: f64 = 6.0;
/// Flaws up to which a plate may have as many points as the shortest that decides asks for.
const FEW_FLAWS: usize = 2;
/// Points on the shortest of more flaws. K of ten cracks of 1 to 5.5 mm at holes errs by 2 % at the shortest and by 0.4 % at the others.
const POINTS_ON_SHORT: f64 = 3.0;
/// Points on the least gap beside a tip. Lives of two plates with gaps of 3 mm err by 2.1 and 3.8 % with six, by 1.3 and 2.3 % with nine.
const POINTS_ON_GAP: f64 = 9.0;
/// Points across a plate that is shorter than wide, and so bent by loads along its length: K of a beam errs by 4 % with 18, by 1 % with 40.
const POINTS_ACROSS: f64 = 40.0;
/// Points on the way over which a bent crack is straight behind its tip: its ring fits into that.
const POINTS_ON_BEND: f64 = 5.0;
/// Points to which a gap beside a tip refines a plate at the most.
const POINTS_FOR_GAP: f64 = 3e5;

/// Spacing where an input file says nothing: a ninth of the smallest flaw that can decide the life and of the least gap between a
/// tip and a rim, another tip or another crack, a sixth of every other flaw, a fifth of the way over which a bent crack is straight behind its tip, a hundredth of the width and a fortieth of the length at the most. What is said where a gap asks
/// for more than 3e5 points or a small flaw for too many comes beside.
pub fn default_spacing(specimen: &Specimen) -> (f64, Option<String>) {
    let sizes = specimen.flaw_sizes();
    let longest = sizes.iter().copied().fold(0.0, f64::max);
    let deciding = sizes.iter().copied().filter(|size| *size >= SMALL_FLAW * longest).fold(f64::INFINITY, f64::min);
    let usual = (deciding / 9.0).min(specimen.width / 100.0).min(specimen.length() / POINTS_ACROSS);
    let smallest = sizes.iter().copied().fold(f64::INFINITY, f64::min);
    let gap = specimen.least_gap();
    let bend = specimen.shortest_path();
    let wanted = usual.min(smallest / POINTS_ON_FLAW).min(gap / POINTS_ON_GAP).min(bend / POINTS_ON_BEND);
    // Among many flaws a short one grows beside others that are read well.
    let most = if sizes.len() > FEW_FLAWS { smallest / POINTS_ON_SHORT } else { usual };
    let finest = (specimen.area() / POINTS_FOR_GAP).sqrt().min(most);
    if wanted >= finest {
        return (wanted, None);
    }
    // A flaw has at least a point of its own.
    let spacing = finest.min(smallest);
    let warning = format!(
        "spacing: {} mm used ({} mm needs more than {POINTS_FOR_GAP:.0e} points); a gap of {} mm at a tip has fewer \
         than {POINTS_ON_GAP} spacings or a flaw of {} mm fewer than {POINTS_ON_FLAW}; set model.spacing_mm if its growth \
         decides the life",
        round_mm(spacing),
        round_mm(wanted),
        round_mm(gap),
        round_mm(smallest)
    );
    (spacing, Some(warning))
}

/// The spacing resolves crack and plate, and the number of points can be held.
/// Errors: `Error::Input` on `model.spacing_mm`.
pub fn check_spacing(spacing: f64, specimen: &Specimen) -> Result<()> {
    const KEY: &str = "model.spacing_mm";
    const NODES: &str = "use model.method = \"element_free_galerkin\", which refines at the crack only";
    let (given, flaw) = (round_mm(spacing), specimen.smallest_flaw());
    let finest = (specimen.area() / POINTS_MAX).sqrt();
    if spacing > flaw {
        let problem = format!("is larger than the crack ({} mm)", round_mm(flaw));
        let ninth = format!("use {} mm or less (crack length / 9)", round_mm(flaw / 9.0));
        return Err(input(KEY, given, problem, if flaw / 9.0 < finest { NODES.to_owned() } else { ninth }));
    }
    let thinnest = specimen.gross_width.min(specimen.length());
    if thinnest < COLUMNS_MIN * spacing {
        let problem = format!("leaves fewer than {COLUMNS_MIN} points across the plate ({} mm)", round_mm(thinnest));
        return Err(input(KEY, given, problem, format!("give {} mm or less", round_mm(thinnest / 100.0))));
    }
    let tips = specimen.tips.iter().filter(|tip| !tip.from_slot && specimen.kind.is_plate());
    let gap = tips.map(|tip| specimen.rim_distance(tip.position)).fold(f64::INFINITY, f64::min);
    if spacing > gap * (1.0 + 1e-9) {
        let problem = format!("is larger than the {} mm between tip and edge", round_mm(gap));
        let remedy = format!(
            "give {} mm or less, end the crack at the edge, or use model.method = \"element_free_galerkin\"",
            round_mm(gap / POINTS_ON_GAP)
        );
        return Err(input(KEY, given, problem, remedy));
    }
    let points = specimen.area() / (spacing * spacing);
    if points > POINTS_MAX {
        let problem = format!("gives about {points:.1e} points; limit {POINTS_MAX:.0e}");
        let remedy = if finest > flaw { NODES.to_owned() } else { format!("give {} mm or more, or {NODES}", round_mm(finest)) };
        return Err(input(KEY, given, problem, remedy));
    }
    Ok(())
}
