//! A plate of nodes with cracks ([`perilife_nodes`]): nodes are placed anew for every equilibrium, as fine as the room of every tip
//! asks for, so that a tip is read where it stands, kinks are resolved whatever their length, and nothing is extrapolated.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::cracks::scales::Scales;
use super::cracks::tip::{AtLoad, CracksState, Reading};
use super::cracks::{CrackedPlate, Cracks, Parted, Segment};
use super::{Fields, SolverStatistics};
use crate::case::{Case, REFINED, suits_points};
use crate::cross_check::largest_difference;
use perilife_base::error::{Error, Result};
use perilife_base::raster::PointGrid;
use perilife_laws::response::Response;
use perilife_nodes::crack::Tip;
use perilife_nodes::factors::{self, TipFactors};
use perilife_nodes::field::{Discretisation, Local};
use perilife_nodes::resolution::{ElementFreeSettings, Resolution, room};
use perilife_nodes::solve::{Loaded, Solution, raster, raster_fields, solve_with};
use perilife_nodes::stress_field::{Corner, stress_pieces};
use perilife_plate::specimen::{CrackLine, Point};
use perilife_plate::williams::Elasticity;
use perilife_points::solver::SolverUsed;

/// Factor by which nodes get finer where K asks for it.
const FINER: f64 = REFINED;
/// Times that they do at the most: of few nodes, and of many.
const REFINEMENTS_MOST: [usize; 2] = [4, 2];
/// Nodes from which they are many.
const MANY: usize = 2000;
/// Nodes beyond which they do not.
const NODES_MOST: f64 = 2e4;

/// Distance from a tip, over its room, within which corners and kinks do not refine the nodes.
const UNSEEN: f64 = 1e-3;

pub struct NodePlate {
    settings: ElementFreeSettings,
    elasticity: Elasticity,
    /// Loads over the largest, below it, at which K is asked for where it does not follow the load in proportion.
    lower: Vec<f64>,
    /// The nodes of the last equilibrium, and that.
    solved: Option<(Discretisation, Solution)>,
    state: NodeState,
}

/// What a run carries of its plate of nodes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NodeState {
    /// How much finer nodes are than usual near tips and rims, and far from them, as K of the initial tips asks.
    fineness: [f64; 2],
    /// Work of the loads of the last equilibrium at the nominal load, J.
    work: f64,
    solves: usize,
    nodes: usize,
    warnings: Vec<String>,
}

/// Growth by the field of every tip on nodes.
pub type ElementFree<'a> = Cracks<'a, NodePlate>;

impl NodePlate {
    /// How fine the nodes are.
    fn resolution(&self) -> Resolution {
        self.settings.resolution.finer(self.state.fineness)
    }

    /// The cracks and their active tips as nodes see them: without corners that are next to a tip.
    fn cracks(case: &Case, cracks: &CracksState) -> (Vec<CrackLine>, Vec<Tip>) {
        let mut lines = cracks.lines.clone();
        let of_tip = |(_, tip): (usize, &super::cracks::tip::Tip)| {
            let least = UNSEEN * cracks.room(&case.specimen, tip).min(tip.length + tip.growth);
            lines[tip.end.line] = lines[tip.end.line].blunted(tip.end.at_last, least);
            Tip { end: tip.end, length: tip.own_length(least) }
        };
        let tips = cracks.active().map(of_tip).collect();
        (lines, tips)
    }

    /// Displacement at a place under the maximum load, m, of the last equilibrium; `None` before one, and where nodes do not reach.
    pub fn displacement(&self, case: &Case, at: Point) -> Option<Point> {
        let (plate, solution) = self.solved.as_ref()?;
        let (displacement, _) = plate.displacement(&solution.whole.u, at, &mut Local::default())?;
        Some(displacement.map(|u| case.loading.share(self.state.work, case.specimen.crack_length) * u))
    }

    /// Stress and displacement under the maximum load, of the last equilibrium.
    pub fn stress(&self, case: &Case) -> Vec<Vec<Corner>> {
        let share = case.loading.share(self.state.work, case.specimen.crack_length);
        let of = |(plate, solution): &(Discretisation, Solution)| {
            stress_pieces(&case.specimen, plate, &solution.whole.u, case.material.plane, share)
        };
        self.solved.as_ref().map(of).unwrap_or_default()
    }

    fn factors(&mut self, case: &Case, cracks: &CracksState, fineness: [f64; 2]) -> Result<Vec<[f64; 2]>> {
        self.state.fineness = fineness;
        self.solve(case, cracks)?;
        // A tip that is shut has none, and K_II of its last places in contact is noise.
        let of = |reading: Reading| if reading.is_closed { [0.0; 2] } else { reading.factors };
        Ok(self.read(case, cracks)?.into_iter().map(|reading| reading.map_or([f64::NAN; 2], of)).collect())
    }
}

impl CrackedPlate for NodePlate {
    type Saved = NodeState;

    fn build(case: &Case, _cracks: &CracksState) -> Result<Self> {
        let state = NodeState { fineness: [1.0; 2], work: 0.0, solves: 0, nodes: 0, warnings: Vec::new() };
        let settings = case.nodes();
        Ok(NodePlate {
            settings,
            elasticity: Elasticity::of(&case.material),
            lower: case.loading.lower_loads().0,
            solved: None,
            state,
        })
    }

    fn scales(&self, case: &Case) -> Scales {
        Scales::of_nodes(case, self.settings.resolution.far)
    }

    /// Refines nodes until K of the initial tips changes by less than the tolerance; warns of what remains.
    fn open(&mut self, case: &Case, cracks: &CracksState) -> Result<()> {
        if self.settings.is_final {
            return self.solve(case, cracks);
        }
        // Where they are too coarse to tell anything, the next ones say so.
        let unknown = |_| vec![[f64::NAN; 2]; cracks.tips.len()];
        let mut before = self.factors(case, cracks, [1.0 / FINER; 2]).unwrap_or_else(unknown);
        // How much finer many nodes get far from tips and rims; not at all where finer ones there do not change K.
        let mut elsewhere = FINER;
        for refinement in 0..=REFINEMENTS_MOST[0] {
            let [tips, others] = self.state.fineness;
            let mut now = self.factors(case, cracks, [FINER * tips, elsewhere * others])?;
            if refinement > 0 && elsewhere > 1.0 && self.state.nodes >= MANY {
                let all = (self.solved.take(), self.state.work);
                let at_tips = self.factors(case, cracks, [FINER * tips, others])?;
                if largest_difference(&now, &at_tips).1 <= self.settings.tolerance {
                    (now, elsewhere) = (at_tips, 1.0);
                } else {
                    self.state.fineness[1] *= FINER;
                    (self.solved, self.state.work) = all;
                }
            }
            let (tip, change) = largest_difference(&before, &now);
            let nodes = self.state.nodes;
            let most = REFINEMENTS_MOST[usize::from(nodes >= MANY)];
            let is_last = refinement >= most || self.settings.is_given || nodes as f64 * FINER * FINER > NODES_MOST;
            if change <= self.settings.tolerance || is_last && change.is_nan() {
                break;
            }
            if is_last {
                let other = if suits_points(case) { "; cross-check with model.method = \"peridynamics\"" } else { "" };
                self.state.warnings.push(format!(
                    "nodes: K of tip {tip} changes by {:.1} % on nodes {FINER} times finer ({nodes} nodes); its error may be as large{other}",
                    100.0 * change,
                ));
                break;
            }
            before = now;
        }
        Ok(())
    }

    fn part(&mut self, _case: &Case, _cracks: &CracksState, _segments: &[Option<Segment>], _has_met: bool) -> Parted {
        // Nodes are placed by `solve`, which needs the cracks alone.
        Parted::default()
    }

    fn solve(&mut self, case: &Case, cracks: &CracksState) -> Result<()> {
        self.solved = None;
        let specimen = &case.specimen;
        let (lines, tips) = NodePlate::cracks(case, cracks);
        let resolution = self.resolution();
        let plate = Discretisation::new(specimen, self.elasticity, &lines, &tips, &resolution, case.loading.residual.as_deref())?;
        let lower = (case.loading.residual.as_deref(), &self.lower[..]);
        let solution = solve_with(specimen, &plate, resolution.far, case.loading.maximum, lower)?;
        self.state.solves += 1;
        self.state.nodes = self.state.nodes.max(plate.nodes.at.len());
        self.state.work = solution.whole.work;
        self.solved = Some((plate, solution));
        Ok(())
    }

    fn read(&mut self, case: &Case, cracks: &CracksState) -> Result<Vec<Option<Reading>>> {
        let Some((plate, solution)) = &self.solved else { return Ok(vec![None; cracks.tips.len()]) };
        let Solution { whole, lower, .. } = solution;
        let (lines, tips) = NodePlate::cracks(case, cracks);
        let length = cracks.crack_length(&case.specimen);
        let has_residual = case.loading.residual.is_some();
        let released = |at| case.loading.residual.as_ref().map_or([0.0; 3], |residual| residual.at(at));
        let reading = |index: usize| {
            let axes = &plate.axes[index];
            let room = room(&case.specimen, &lines, &tips[index]);
            let read = |loaded: &Loaded, u: &[f64], is_free: bool| {
                let share = case.loading.share(loaded.work / (loaded.share * loaded.share), length);
                let pressure = case.specimen.crack_pressure * case.loading.maximum * loaded.share;
                let stress = |at| {
                    let ([xx, yy, xy], pressure) = (released(at), pressure + if is_free { 0.0 } else { loaded.pressure_at(at) });
                    [xx + pressure, yy + pressure, xy]
                };
                let read = factors::read(plate, u, index, room, &stress)?;
                let factors = read.factors.map(|factor| share * factor);
                Ok::<_, Error>(TipFactors { factors, t_stress: share * read.t_stress, of_faces: share * read.of_faces, ..read })
            };
            // The stress along the crack that the plate had before it.
            let along = case.loading.residual.as_ref().map_or(0.0, |residual| residual.along(axes.at, axes.ahead));
            let at_load = |loaded: &Loaded| {
                let (found, is_closed) = (read(loaded, &loaded.u, false)?, loaded.is_closed(axes.at));
                let [k_i, k_ii] = found.factors;
                let factors = [if is_closed { 0.0 } else { k_i }, k_ii];
                let of_free = || Ok::<_, Error>(read(loaded, &loaded.free, true)?.factors);
                let free = (is_closed && has_residual).then(of_free).transpose()?;
                let at = AtLoad { load: loaded.share, factors, t_stress: found.t_stress + along, is_closed, free };
                Ok::<_, Error>((at, found.of_faces))
            };
            let (own, of_pressure) = at_load(whole)?;
            let AtLoad { factors, t_stress, is_closed, .. } = own;
            let lower = lower.iter().map(|loaded| Ok(at_load(loaded)?.0)).collect::<Result<Vec<AtLoad>>>()?;
            let reading = Reading {
                factors,
                t_stress,
                // K_II is that of the axes in which it was read: the crack without corners that nodes do not see.
                ahead: axes.ahead,
                spacing: axes.spacing,
                length_offset: 0.0,
                is_closed,
                of_pressure,
                response: Response::PROPORTIONAL,
            };
            Ok(reading.beside(own, &lower, !has_residual))
        };
        let read = (0..tips.len()).into_par_iter().map(reading).collect::<Result<Vec<Reading>>>()?;
        let mut readings = vec![None; cracks.tips.len()];
        cracks.active().zip(read).for_each(|((tip, _), read)| readings[tip] = Some(read));
        Ok(readings)
    }

    fn work(&self) -> f64 {
        self.state.work
    }

    fn is_in_contact(&self) -> bool {
        self.solved.as_ref().is_some_and(|(_, solution)| !solution.whole.pressed.is_empty())
    }

    fn contact_residual(&self) -> f64 {
        let contacts = self.solved.iter().flat_map(|(_, solution)| &solution.whole.contacts);
        contacts.map(|(_, contact)| contact.residual).fold(0.0, f64::max)
    }

    fn save(&self) -> NodeState {
        self.state.clone()
    }

    fn restore(&mut self, saved: NodeState) -> bool {
        self.state = saved;
        true
    }

    fn grid(&self, case: &Case) -> Option<PointGrid> {
        case.output.paraview.then(|| raster(&case.specimen, self.resolution().far))
    }

    fn fields(&mut self, case: &Case, cracks: &CracksState) -> Result<Option<Fields>> {
        if !case.output.paraview {
            return Ok(None);
        }
        if self.solved.is_none() {
            // Of a resumed run: no solve of its increments.
            let state = self.state.clone();
            self.solve(case, cracks)?;
            self.state = state;
        }
        let length = cracks.crack_length(&case.specimen);
        let (share, far) = (case.loading.share(self.state.work, length), self.resolution().far);
        let of_plate = |(plate, solution): &(Discretisation, Solution)| {
            raster_fields(&case.specimen, plate, &solution.whole.u, far, case.material.plane, share)
        };
        let (displacement, stress) = self.solved.as_ref().map(of_plate).unwrap_or_default();
        Ok(Some(Fields { damage: vec![0.0; displacement.len()], remaining_life: Vec::new(), displacement, stress }))
    }

    fn statistics(&self) -> SolverStatistics {
        let NodeState { solves, nodes, .. } = self.state;
        let refined = self.state.fineness.map(|fineness| (fineness.ln() / FINER.ln()).round().max(0.0) as u32);
        SolverStatistics { points_solved: nodes, solves, refined, solver: Some(SolverUsed::Direct), ..Default::default() }
    }

    fn warnings(&self) -> Vec<String> {
        self.state.warnings.clone()
    }
}
