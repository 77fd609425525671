//! A run taken up from any of its checkpoints gives what the undisturbed run gives, bit for bit.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Mutex;

use perilife_base::error::Result;
use perilife_growth::case::Case;
use perilife_growth::predict::checkpoint::Checkpoint;
use perilife_growth::predict::{Observer, Prediction, Progress, Silent, predict, resume};

use crate::support::plates::{BOND_STRAIN, case};
use crate::support::rows::rows;

/// Keeps every checkpoint as the bytes of its file, and the blocks before it.
#[derive(Default)]
pub struct Keeping {
    kept: Mutex<Vec<(Vec<u8>, usize)>>,
    blocks: Mutex<usize>,
    /// Blocks after which the run is cancelled.
    last: Option<usize>,
    /// Whether it is cancelled once something is kept.
    first_only: bool,
}

impl Keeping {
    pub fn kept(self) -> Vec<(Vec<u8>, usize)> {
        self.kept.into_inner().unwrap()
    }
}

impl Observer for Keeping {
    fn block_done(&self, _: &Progress) -> bool {
        let mut blocks = self.blocks.lock().unwrap();
        *blocks += 1;
        let enough = self.first_only && !self.kept.lock().unwrap().is_empty();
        !enough && self.last.is_none_or(|last| *blocks < last)
    }

    fn may_keep(&self, checkpoint: &dyn Fn() -> Checkpoint) {
        self.kept.lock().unwrap().push((checkpoint().to_bytes(), *self.blocks.lock().unwrap()));
    }
}

/// All numbers of a prediction but time and memory, to the last bit; floats by their bits, so that NaN equals NaN.
fn bits(run: &Prediction) -> Vec<u64> {
    let mut all = Vec::new();
    for row in &run.curve {
        all.extend([row.cycles, row.crack_length, row.delta_k, row.growth_rate, row.work].map(f64::to_bits));
        all.push(row.broken_bonds as u64);
        all.extend(row.tips.iter().flat_map(|tip| [tip.position[0], tip.position[1], tip.growth]).map(f64::to_bits));
        all.extend(row.tips.iter().filter_map(|tip| tip.factors).flatten().map(f64::to_bits));
    }
    for picture in &run.snapshots {
        all.extend([picture.cycles, picture.crack_length].map(f64::to_bits));
        all.extend(picture.displacement.iter().flatten().chain(&picture.damage).map(|x| x.to_bits()));
    }
    let figures = &run.figures;
    all.extend([figures.points, figures.points_solved, figures.bonds, figures.blocks].map(|n| n as u64));
    all.extend([figures.solves, figures.iterations].map(|n| n as u64));
    all.extend([figures.spacing, figures.horizon].map(f64::to_bits));
    all
}

fn assert_same(name: &str, run: &Prediction, whole: &Prediction) {
    assert_eq!(run.curve.len(), whole.curve.len(), "{name}: rows");
    for (i, (a, b)) in run.curve.iter().zip(&whole.curve).enumerate() {
        assert_eq!(a.cycles.to_bits(), b.cycles.to_bits(), "{name}, row {i}: {} and {} cycles", a.cycles, b.cycles);
    }
    assert_eq!(run.stop, whole.stop, "{name}");
    assert_eq!((run.figures.solves, run.figures.iterations), (whole.figures.solves, whole.figures.iterations), "{name}");
    assert_eq!(run.snapshots.len(), whole.snapshots.len(), "{name}: pictures");
    assert!(bits(run) == bits(whole), "{name}: differs in some bit");
    assert_eq!(run.warnings, whole.warnings, "{name}");
    assert!(run.grid == whole.grid, "{name}: grid");
}

fn read(bytes: &[u8]) -> Checkpoint {
    Checkpoint::from_bytes(bytes).unwrap()
}

const FINE: &str = "model.spacing_mm=1";

fn plate(name: &str) -> String {
    rows::<BTreeMap<String, String>>("checkpoint", "plates").remove(name).unwrap()
}

/// Scenes of a table; every one has a checkpoint at least.
fn taken_up(scenes: &str) {
    for (number, (name, specimen, set)) in rows::<Vec<(String, String, Vec<String>)>>("checkpoint", scenes).iter().enumerate() {
        let set: Vec<&str> = set.iter().map(String::as_str).chain(["stop.cycles_max=1e12"]).collect();
        let case = case(&plate(specimen), &set);
        let keeping = Keeping::default();
        let whole = predict(&case, &keeping).unwrap();
        let kept = keeping.kept();
        assert!(!kept.is_empty(), "{name}: no checkpoint, so this scene tests nothing");
        // One that keeps nothing goes the same way.
        if number % 4 == 0 {
            assert_same(name, &predict(&case, &Silent).unwrap(), &whole);
        }
        // Early in the run and at its end, in turn.
        let at = if number % 2 == 0 { kept.len() / 3 } else { kept.len() - 1 };
        let again = Keeping::default();
        let run = resume(&case, read(&kept[at].0), &again).unwrap();
        assert_same(&format!("{name}, checkpoint {at}"), &run, &whole);
        // It goes on where the other stood, and comes by the same places.
        assert_eq!(again.kept().len(), kept.len() - at - 1, "{name}");
    }
}

#[test]
fn a_run_taken_up_is_the_undisturbed_one() {
    taken_up("quick");
}

#[test]
#[ignore = "long: half a minute"]
fn a_run_taken_up_is_the_undisturbed_one_in_every_scene() {
    taken_up("all");
}

/// From a slot: taken up before the crack is handed over from bonds to K, and after.
#[test]
fn a_run_taken_up_hands_its_crack_over_alike() {
    let slot =
        "kind=\"plate\"\nwidth_mm=60\nlength_mm=100\nthickness_mm=2\nnotches=[{from_mm=[-10,-4],to_mm=[10,4],width_mm=2}]\n";
    let case =
        case(slot, &["model.spacing_mm=1", "model.solver=window", "fatigue.step_error_percent=0.02", "stop.cycles_max=1e12"]);
    let keeping = Keeping::default();
    let whole = predict(&case, &keeping).unwrap();
    let handed_over = whole.curve.iter().find(|row| row.tips.iter().all(|tip| tip.factors.is_some())).unwrap().cycles;
    let kept: Vec<Checkpoint> = keeping.kept().iter().map(|(bytes, _)| read(bytes)).collect();
    let early = kept.iter().filter(|checkpoint| checkpoint.kept.progress.cycles < handed_over).count();
    println!("{early} of {} checkpoints before the hand-over at {handed_over:.0} cycles", kept.len());
    assert!(early > 0 && early < kept.len(), "{early} of {}", kept.len());
    for at in BTreeSet::from([early / 2, early - 1, early, kept.len() - 1]) {
        assert_same(&format!("checkpoint {at}"), &resume(&case, kept[at].clone(), &Silent).unwrap(), &whole);
    }
}

/// The first checkpoint of a run, which goes no farther.
fn first(case: &Case) -> Vec<u8> {
    let keeping = Keeping { first_only: true, ..Keeping::default() };
    assert!(predict(case, &keeping).unwrap_err().to_string().contains("was canceled"));
    keeping.kept().swap_remove(0).0
}

/// A service cancels a run and goes on later; what is kept can be older than where it was cancelled.
#[test]
fn a_cancelled_run_goes_on() {
    let case = case(&plate("clamped"), &["fatigue.step_error_percent=0.01", "model.spacing_mm=2"]);
    let whole = predict(&case, &Silent).unwrap();
    let mut checkpoint: Option<Vec<u8>> = None;
    let mut parts = 0;
    let run = loop {
        let keeping = Keeping { last: Some(40), ..Keeping::default() };
        let run = match &checkpoint {
            None => predict(&case, &keeping),
            Some(bytes) => resume(&case, read(bytes), &keeping),
        };
        parts += 1;
        match run {
            Ok(run) => break run,
            Err(error) => assert!(error.to_string().contains("was canceled"), "{error}"),
        }
        let newer = keeping.kept().pop().map(|(bytes, _)| bytes);
        assert!(newer.is_some(), "no way on within 40 blocks");
        checkpoint = newer;
    };
    println!("{parts} parts, {:.3} s of {:.3} s", run.figures.wall_s, whole.figures.wall_s);
    assert!(parts >= 3, "{parts} parts");
    assert_same("parts", &run, &whole);
}

fn refused(checkpoint: Result<Checkpoint>, words: &str) {
    let error = checkpoint.expect_err(words);
    assert_eq!(error.exit_code(), 2, "{error}");
    assert!(error.to_string().contains(words), "{words} in {error}");
}

#[test]
fn damaged_and_foreign_checkpoints_are_refused() {
    let case = |set: &[&str]| case(&plate("slant"), &[&[BOND_STRAIN, FINE, "stop.crack_length_mm=40"], set].concat());
    let own = case(&[]);
    let bytes = first(&own);
    assert_eq!(read(&bytes).to_bytes(), bytes);
    for length in (0..200).chain((200..bytes.len()).step_by(4999)) {
        let word = if length < 20 { "is not a checkpoint" } else { "damaged" };
        // A version that is cut short is another one.
        let cut = Checkpoint::from_bytes(&bytes[..length]);
        refused(cut, word);
    }
    for at in (0..200).chain((200..bytes.len()).step_by(4999)) {
        for bit in [1, 128] {
            let mut changed = bytes.clone();
            changed[at] ^= bit;
            let error = Checkpoint::from_bytes(&changed).expect_err("a changed bit");
            assert_eq!(error.exit_code(), 2, "byte {at}: {error}");
        }
    }
    refused(Checkpoint::from_bytes(&[&bytes[..], &[0]].concat()), "damaged");
    let mut older = bytes.clone();
    let at = older.windows(5).position(|window| window == env!("CARGO_PKG_VERSION").as_bytes()).unwrap();
    older[at] = b'9';
    refused(Checkpoint::from_bytes(&older), "written by perilife 9.1.0; this is ");

    // Whatever says something else about the run makes it another case; the name of a case does not.
    let others = "loading.stress_max_mpa=71 fatigue.a=6451 model.solver=multigrid stop.crack_length_mm=41 \
                  specimen.width_mm=62 material.poisson_ratio=0.31";
    for other in others.split_whitespace() {
        let other_case = case(&[other]);
        assert!(!read(&bytes).belongs_to(&other_case), "{other}");
        let error = resume(&other_case, read(&bytes), &Silent).expect_err(other);
        assert_eq!(error.exit_code(), 2, "{other}: {error}");
        assert!(error.to_string().contains("for a different case"), "{other}: {error}");
    }
    let mut renamed = own.clone();
    renamed.name = "renamed".to_owned();
    assert!(read(&bytes).belongs_to(&renamed));
}
