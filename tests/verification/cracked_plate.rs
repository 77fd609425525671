//! One suite over `CrackedPlate`: whatever a plate is made of, it reads the right K, its work is what K releases, it parts where cracks go, and
//! a run that is saved goes on as if nothing had been.
//!
//! Right values: finite elements and closed forms of the README beside the shared data, problems of mechanics as users brought them
//! (`field/mechanics4`), kinked, branched and crossing cracks (`field/mechanics/kinked_start`), and plates on which growth was wrong by 2 to 12 %
//! of life (`hard_plates`: mouths on holes, kinks of short cracks, gaps and rims near a tip); slots of nodes are refused by name.

use std::collections::BTreeMap;
use std::path::Path;

use perilife_base::input::Document;
use perilife_base::units::{MM, MPA_SQRT_M};
use perilife_growth::CrackGrowth;
use perilife_growth::case::Case;
use perilife_growth::cracks::steering::equivalent_factor;
use perilife_growth::cracks::{CrackedPlate, Cracks, InitialTips, initial_tips};
use perilife_growth::nodes::NodePlate;
use perilife_growth::points::PointPlate;
use perilife_growth::predict::laws::growth_law;
use perilife_growth::predict::{Silent, StopReason, increment, predict};
use perilife_growth::record::CurvePoint;
use perilife_plate::specimen::Point;
use perilife_plate::specimen::geometry::{distance, distance_to_segment};

use crate::support::plates::{cracked_plate, pulled_plate};
use crate::support::rows::rows;
use crate::support::shared::shared;

/// A plate that the suite runs on.
trait Tried: CrackedPlate<Saved: Clone> {
    /// Its place in the bounds of a row.
    const AT: usize;
    /// Keys of a case on it: of a small plate, of a finer one, and of one that is grown against finite elements.
    const SMALL: &'static str;
    const FINE: &'static str;
    fn grown(case: &Case) -> Vec<String>;
    fn of(document: &Document) -> Case;
}

impl Tried for PointPlate {
    const AT: usize = 0;
    const SMALL: &'static str = "model.spacing_mm=1";
    const FINE: &'static str = "model.spacing_mm=0.5";

    fn grown(_: &Case) -> Vec<String> {
        vec!["model.method=peridynamics".to_owned()]
    }

    fn of(document: &Document) -> Case {
        Case::plate_of(document).unwrap()
    }
}

impl Tried for NodePlate {
    const AT: usize = 1;
    const SMALL: &'static str = "model.method=element_free_galerkin";
    const FINE: &'static str = Self::SMALL;

    /// The spacing of some files is that of points: nodes are refined by themselves.
    fn grown(case: &Case) -> Vec<String> {
        let far = format!("model.spacing_mm={}", 1e3 * case.specimen.width / 14.0);
        ["model.method=element_free_galerkin", "model.tolerance_percent=0.5", &far].map(str::to_owned).to_vec()
    }

    fn of(document: &Document) -> Case {
        Case::plate_on_nodes(document).unwrap()
    }
}

macro_rules! suite {
    ($($name:ident: $plate:ty),*) => { $(mod $name {
        use super::*;

        #[test]
        fn the_right_factors() {
            factors::<$plate>("factors", false);
        }

        /// Flanks that are pressed together carry pressure.
        #[test]
        fn the_right_factors_in_contact() {
            factors::<$plate>("pressed", true);
        }

        #[test]
        fn pressure_is_a_stress_far_away() {
            pressure::<$plate>();
        }

        #[test]
        fn work_is_what_k_releases() {
            work::<$plate>();
        }

        #[test]
        fn a_crack_that_has_gone_through_severs() {
            parts::<$plate>();
        }

        #[test]
        fn a_run_that_is_saved_goes_on() {
            saved::<$plate>();
        }

        #[test]
        #[ignore = "long: two to three minutes"]
        fn the_right_paths_and_cycles() {
            grown::<$plate>(usize::MAX);
        }
    })* };
}

suite! { on_points: PointPlate, on_nodes: NodePlate }

/// K_I and K_II of a tip, MPa√m.
type Factors = [f64; 2];

/// A row of factors.
type Row = (String, Vec<Factors>, [f64; 2]);

fn document(name: &str) -> Option<Document> {
    let path = shared(&format!("field/{name}.toml"))?;
    // A pin that fills its hole, as the file says in words.
    let arc = name.ends_with("lug3").then(|| "loading.pins[0].contact_half_angle_deg=90".to_owned());
    Some(Document::read(&path, arc.as_slice()).unwrap())
}

/// Reads K of the first tips of a plate and compares it with what is right, over the size of the tip's own K or, of flanks in contact, of the largest:
/// a tip that is nearly shut has next to none. Gives what was read.
fn compare<P: Tried>((name, right, most): &Row, document: &Document, in_contact: bool) -> InitialTips {
    let read = initial_tips::<P>(&P::of(document)).unwrap();
    assert!(read.tips.len() >= right.len() && (read.in_contact || !in_contact), "{name}");
    let size = |[k_i, k_ii]: &Factors| k_i.hypot(*k_ii);
    let largest = right.iter().map(size).fold(0.0, f64::max);
    for (tip, right) in read.tips.iter().zip(right) {
        let [a, b] = tip.factors.unwrap().map(|k| k / MPA_SQRT_M);
        let off = (a - right[0]).hypot(b - right[1]) / if in_contact { largest } else { size(right) };
        assert!(off < most[P::AT], "{name}: {off} of {right:?}: {:?}", tip.factors);
    }
    read
}

fn factors<P: Tried>(table: &str, in_contact: bool) {
    for row in rows::<Vec<Row>>("cracked_plate", table) {
        let Some(mut document) = document(&row.0) else { return };
        // Half a percent of K is 1.5 % of life: that is not what the default of 2 % stands for.
        if P::AT == 1 && row.2[1] <= 0.005 && !in_contact {
            document.set_all(&["model.tolerance_percent=1".to_owned()]).unwrap();
        }
        let tips = compare::<P>(&row, &document, in_contact).tips.len();
        assert!(tips == row.1.len() || in_contact, "{}: {tips} tips", row.0);
    }
}

#[test]
fn nodes_read_what_points_cannot() {
    for row in rows::<Vec<Row>>("cracked_plate", "on_nodes") {
        let Some(document) = document(&row.0) else { return };
        compare::<NodePlate>(&row, &document, false);
    }
    // Open stars have no contact.
    let Some(document) = document("mechanics4/guards/star3") else { return };
    let star = compare::<NodePlate>(&("star3".to_owned(), vec![[24.23, 0.0]], [0.0, 0.005]), &document, false);
    assert!(star.warnings.is_empty() && !star.in_contact, "{star:?}");
}

fn small(text: &str, key: &str) -> Case {
    Case::from_toml(text, "small", Path::new(""), &[key.to_owned()]).unwrap()
}

/// A pressure on the faces makes the K of a uniform stress of this size far away, since a plate without crack is uniform under that: of
/// all directions if the crack is slanted. T of a stress across the crack is the same too; along it the uniform field adds its own.
fn pressure<P: Tried>() {
    let straight = "stress_max_mpa = 60";
    let all_round = "stress_max_mpa = 60\nstress_parallel_ratio = 1";
    let plates = [
        ("{ from_mm = [-8, 0], to_mm = [8, 0] }", straight, 0.0),
        ("{ from_mm = [-30, 0], to_mm = [-15, 0] }", straight, 0.0),
        ("{ from_mm = [-8, -3], to_mm = [8, 4] }", all_round, 60.0),
        ("{ path_mm = [[-8, 0], [0, 0], [8, 6]] }", all_round, 60.0),
    ];
    for (crack, far, along) in plates {
        let plate = pulled_plate(&format!("width_mm = 60\nlength_mm = 120\ncracks = [{crack}]"));
        let [pressed, pulled] = ["crack_pressure_mpa = 60", far].map(|loading| {
            let tips = initial_tips::<P>(&small(&plate.replace(straight, loading), P::FINE)).unwrap().tips;
            tips.iter().map(|tip| [tip.factors.unwrap()[0], tip.factors.unwrap()[1], tip.t_stress.unwrap()]).collect::<Vec<_>>()
        });
        for (pressed, pulled) in pressed.iter().zip(&pulled) {
            let size = pulled[0].hypot(pulled[1]);
            assert!((0..2).all(|i| (pressed[i] - pulled[i]).abs() < 0.006 * size), "{crack}: {pressed:?}, {pulled:?}");
            assert!((pressed[2] + 1e6 * along - pulled[2]).abs() < 0.02 * 60e6, "{crack}: {pressed:?}, {pulled:?}");
        }
    }
}

/// A slant crack in the middle, one at an edge, and two that grow towards each other, in plates of 60 x 100 mm.
fn plates() -> [(&'static str, String); 3] {
    let plate = |ends: &[[Point; 2]]| cracked_plate(60.0, 100.0, ends);
    [
        ("slant", plate(&[[[-7.0, -5.0], [7.0, 5.0]]])),
        ("edge", plate(&[[[-30.0, 0.0], [-18.0, 0.0]]])),
        ("two", plate(&[[[-16.0, -3.0], [-7.0, -3.0]], [[6.0, 3.0], [17.0, 3.0]]])),
    ]
}

/// Grows the cracks of a case by so many increments, or until there is a reason to stop.
fn grow<P: CrackedPlate>(cracks: &mut Cracks<'_, P>, increments: usize) -> Option<StopReason> {
    (0..increments).find_map(|_| increment(cracks))
}

fn opened<P: Tried>(case: &Case) -> Cracks<'_, P> {
    let mut cracks = Cracks::<P>::start(case, growth_law(case).unwrap()).unwrap();
    cracks.open().unwrap();
    cracks
}

/// `½ ΔW = B Σ ∫ K_eq²/E' da` over growth of all tips by some millimetres under a constant load (Irwin 1957).
fn work<P: Tried>() {
    for (name, text) in plates() {
        let case = small(&text, P::SMALL);
        let mut cracks = opened::<P>(&case);
        assert_eq!(grow(&mut cracks, 5), None, "{name}");
        let rows: Vec<CurvePoint> = cracks.curve().into_iter().filter(|row| row.is_solved).collect();
        let (first, last) = (&rows[0], &rows[rows.len() - 1]);
        let mut released = 0.0;
        for (from, to) in rows.windows(2).flat_map(|rows| rows[0].tips.iter().zip(&rows[1].tips)) {
            let [a, b] = [from, to].map(|tip| equivalent_factor(tip.factors.unwrap()).powi(2));
            released += 0.5 * (a + b) / case.material.plane_modulus() * (to.growth - from.growth) * case.specimen.thickness;
        }
        let (ratio, growth) = (0.5 * (last.work - first.work) / released, last.growth() / MM);
        assert!(growth > 1.0 && (ratio - 1.0).abs() < 0.03, "{name}: {ratio} after {growth} mm");
    }
}

/// A crack that goes on and on leaves two pieces, and no tip in the material; before, the plate is one.
fn parts<P: Tried>() {
    for (name, text) in plates().into_iter().skip(1) {
        let case = small(&text, P::SMALL);
        let mut cracks = opened::<P>(&case);
        let reason = grow(&mut cracks, 1000);
        let curve = cracks.curve();
        let (last, others) = curve.split_last().unwrap();
        println!("{name}: {reason:?} after {} rows, {:.2} mm grown", curve.len(), last.growth() / MM);
        // The last tip may leave a plate of nodes before anything is solved for.
        assert!(matches!(reason, Some(StopReason::Severed | StopReason::LeftPlate)), "{name}: {reason:?}");
        assert!(others.iter().all(|row| row.work > 0.0) && others.windows(2).all(|rows| rows[1].cycles >= rows[0].cycles));
        assert!(last.crack_length > 0.9 * case.specimen.width, "{name}: {} m", last.crack_length);
    }
}

/// What is saved in the midst of a run goes on to the same rows, bit for bit; another plate does not take it.
fn saved<P: Tried>() {
    for (name, text) in plates() {
        let case = small(&text, P::SMALL);
        let mut cracks = opened::<P>(&case);
        assert_eq!(grow(&mut cracks, 4), None, "{name}");
        let kept = cracks.run();
        cracks.rebuild_solver().unwrap();
        let ends = grow(&mut cracks, 4);
        let mut again = Cracks::<P>::start(&case, growth_law(&case).unwrap()).unwrap();
        assert!(again.restore(kept.clone()), "{name}");
        assert_eq!(grow(&mut again, 4), ends, "{name}");
        // Text of floats says them to the last bit, and NaN is NaN.
        assert_eq!(format!("{:?}", again.curve()), format!("{:?}", cracks.curve()), "{name}");
        let other = small(&cracked_plate(60.0, 100.0, &[[[-30.0, 9.0], [-20.0, 9.0]], [[30.0, 0.0], [20.0, 0.0]]]), P::SMALL);
        let mut other = Cracks::<P>::start(&other, growth_law(&other).unwrap()).unwrap();
        assert!(name == "slant" || !other.restore(kept), "{name}");
    }
}

/// Cycles and place (mm) of a tip with its growth, mm.
type Grown = (f64, f64, Point);

fn reference(path: &Path) -> BTreeMap<usize, Vec<Grown>> {
    let mut tips: BTreeMap<usize, Vec<Grown>> = BTreeMap::new();
    for record in csv::Reader::from_path(path).unwrap().deserialize() {
        let (cycles, tip, x, y): (f64, usize, f64, f64) = record.unwrap();
        let rows = tips.entry(tip).or_default();
        let growth = rows.last().map_or(0.0, |(_, growth, at)| growth + distance(*at, [x, y]));
        rows.push((cycles, growth, [x, y]));
    }
    tips
}

fn cycles_at(rows: &[Grown], growth: f64) -> Option<f64> {
    let pair = rows.windows(2).find(|pair| (pair[0].1..=pair[1].1).contains(&growth))?;
    let share = (growth - pair[0].1) / (pair[1].1 - pair[0].1).max(f64::MIN_POSITIVE);
    Some(pair[0].0 + share * (pair[1].0 - pair[0].0))
}

fn grown<P: Tried>(most: usize) {
    for (name, bounds) in rows::<Vec<(String, [(f64, f64); 2])>>("cracked_plate", "grown").into_iter().take(most) {
        let Some(path) = shared(&format!("hard_plates/{name}.toml")) else { return };
        let right = reference(&path.with_extension("csv"));
        let given = Case::from_file(&path, &[]).unwrap();
        let run = predict(&Case::from_file(&path, &P::grown(&given)).unwrap(), &Silent).unwrap();
        let (leading, tip) = right.iter().max_by(|a, b| a.1.last().unwrap().1.total_cmp(&b.1.last().unwrap().1)).unwrap();
        let row = |row: &CurvePoint| {
            let record = &row.tips[*leading];
            (row.cycles, 1e3 * record.growth, record.position.map(|metres| 1e3 * metres))
        };
        let found: Vec<Grown> = run.curve.iter().map(row).collect();
        let whole = tip.last().unwrap().1;
        let error = |share: f64| {
            let [found, right] = [&found, tip].map(|rows| cycles_at(rows, share * whole).unwrap());
            100.0 * (found / right - 1.0)
        };
        let [half, late] = [0.5, 0.95].map(error);
        let away =
            |at: Point| tip.windows(2).map(|pair| distance_to_segment(at, pair[0].2, pair[1].2)).fold(f64::INFINITY, f64::min);
        let places: Vec<Point> = found.iter().filter(|row| row.1 <= whole).map(|row| row.2).collect();
        let off = (places.iter().map(|at| away(*at).powi(2)).sum::<f64>() / places.len() as f64).sqrt();
        let (bound, bound_of_path) = bounds[P::AT];
        assert!(half.abs() < bound && late.abs() < bound && off < bound_of_path, "{name}: {half:+.2}, {late:+.2} %, {off:.3} mm");
    }
}

#[test]
fn a_mouth_on_a_hole_on_nodes() {
    grown::<NodePlate>(1);
}

fn lives(table: &str) {
    for (name, axis, places) in rows::<Vec<(String, usize, [(f64, f64); 2])>>("cracked_plate", table) {
        let Some(path) = shared(&format!("field/mechanics4/{name}.toml")) else { return };
        let nodes = ["model.method=element_free_galerkin".to_owned()];
        let run = predict(&Case::from_file(&path, &nodes).unwrap(), &Silent).unwrap();
        // The tips that go out on one side: in the plates there are twins.
        let way = |row: &CurvePoint| row.tips.iter().map(|tip| tip.position[axis].abs() / MM).fold(0.0, f64::max);
        for (at, right) in places {
            let (from, to) = run.curve.windows(2).map(|pair| (&pair[0], &pair[1])).find(|(_, to)| way(to) >= at).unwrap();
            let share = (at - way(from)) / (way(to) - way(from));
            let cycles = from.cycles + share * (to.cycles - from.cycles);
            assert!((cycles / right - 1.0).abs() < 0.01, "{name}: {cycles} for {right} at {at} mm");
        }
    }
}

#[test]
fn flanks_in_contact_have_the_right_lives() {
    lives("lives");
}

#[test]
#[ignore = "long: half a minute"]
fn shut_tips_that_slide_have_the_right_lives() {
    lives("sliding_lives");
}
