//! Benchmark: how long everything takes, beside how wrong it is.
//!
//! A group measures runs of one subject: rows of time and error, and figures drawn from them (ratios, exponents). Times are
//! medians of repeats, each taken in turn with the reference run, so that a machine that slows down slows both. A solver too
//! slow to run whole is measured on some blocks along the run ([`extrapolation`]), and its row says so.

pub mod calibration;
pub mod clock;
pub mod exponent;
pub mod extrapolation;
pub mod first_solve;
pub mod hand_calculation;
pub mod machine;
pub mod pareto;
pub mod row;
pub mod runs;
pub mod scene;
pub mod solvers;
pub mod speed_accuracy;
pub mod variant;

use clock::{Reference, Timing, measure};
pub use first_solve::{FirstSolve, Request};
pub use machine::Machine;
pub use row::{Asked, Figure, Row};

use crate::error::{Result, input};

/// What is measured together.
pub struct Group {
    /// Name, as `perilife bench NAME` takes it.
    pub name: &'static str,
    /// What its rows show.
    pub about: &'static str,
    /// Measures them.
    measure: fn(&mut Bench<'_>) -> Result<()>,
}

/// All groups; the first four are the panels of the chart.
pub const GROUPS: &[Group] = &[
    Group {
        name: scene::MIDDLE,
        about: "middle-tension panel: time and error of life by law, solver, spacing, horizon and block",
        measure: speed_accuracy::middle_tension,
    },
    Group {
        name: scene::SINGLE,
        about: "single-edge panel: time and error of life by law, solver, spacing, horizon and block",
        measure: speed_accuracy::single_edge,
    },
    Group {
        name: scene::CRACKED,
        about: "cracked plate: time and error of K_I by law, solver, spacing and horizon",
        measure: speed_accuracy::cracked_plate,
    },
    Group {
        name: scene::TENSION,
        about: "plate in uniform tension: time and error of displacement by law, solver, spacing and horizon",
        measure: speed_accuracy::tension_plate,
    },
    Group { name: "virkler_panel", about: "the Virkler panel from 9 to 45 mm by every solver", measure: runs::virkler_panel },
    Group { name: "slant_plate", about: "the plate with a slant crack, until it is in two", measure: runs::slant_plate },
    Group {
        name: "calibration",
        about: "the fit of A and p to a median curve over one forward run",
        measure: calibration::median,
    },
    Group {
        name: "first_solve",
        about: "set-up and first solve of 30 000 to 1 000 000 points: time, growth exponent, memory",
        measure: first_solve::sizes,
    },
    Group { name: "hand_calculation", about: "prediction and fit by hand calculation", measure: hand_calculation::all },
];

/// The groups of these names, all where no name is given.
///
/// # Errors
/// A name that no group bears.
pub fn groups(names: &[String]) -> Result<Vec<&'static Group>> {
    if names.is_empty() {
        return Ok(GROUPS.iter().collect());
    }
    let known = || GROUPS.iter().map(|group| group.name).collect::<Vec<_>>().join(", ");
    let find = |name: &String| {
        let found = GROUPS.iter().find(|group| group.name == name);
        found.ok_or_else(|| input("NAME", name, "is not a group of the benchmark", format!("known are {}", known())))
    };
    names.iter().map(find).collect()
}

/// How much is measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Effort {
    /// Coarse scenes and few rows: a look at the doors, not at the speed.
    pub quick: bool,
    /// Repeats of a row.
    pub repeats: usize,
    /// Seconds after which a row is not repeated again.
    pub seconds_per_row: f64,
    /// Seconds for the measured blocks of a slow solver.
    pub seconds_of_blocks: f64,
    /// Estimated seconds of a run above which it is extrapolated.
    pub seconds_whole: f64,
}

impl Effort {
    /// About ten minutes in all.
    pub const FULL: Effort =
        Effort { quick: false, repeats: 5, seconds_per_row: 4.0, seconds_of_blocks: 6.0, seconds_whole: 12.0 };
    /// About one minute in all.
    pub const QUICK: Effort =
        Effort { quick: true, repeats: 1, seconds_per_row: 0.5, seconds_of_blocks: 1.0, seconds_whole: 3.0 };
}

/// Measures one size in a process of its own, whose peak of memory is that of this size alone.
pub type Isolated<'a> = &'a dyn Fn(&Request) -> Result<FirstSolve>;

/// Hears of every row and figure as it is measured.
pub trait Observer {
    /// A row is measured.
    fn row(&self, row: &Row);
    /// A figure is known.
    fn figure(&self, figure: &Figure);
}

/// A benchmark in the making.
pub struct Bench<'a> {
    effort: Effort,
    isolated: Isolated<'a>,
    observer: &'a dyn Observer,
    reference: Reference,
    rows: Vec<Row>,
    figures: Vec<Figure>,
}

/// A finished benchmark.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Rows in the order in which they were measured.
    pub rows: Vec<Row>,
    /// Figures drawn from them.
    pub figures: Vec<Figure>,
    /// What it ran on.
    pub machine: Machine,
    /// What the reference run is, in words.
    pub reference: String,
    /// Median of all its runs, s.
    pub reference_s: f64,
}

/// Measures these groups, one after the other.
///
/// # Errors
/// Mechanics that fail where they must not, a process that cannot be started.
pub fn run(groups: &[&'static Group], effort: Effort, isolated: Isolated<'_>, observer: &dyn Observer) -> Result<Outcome> {
    let reference = Reference::new(scene::middle_tension(effort.quick).case(&[])?)?;
    let mut bench = Bench { effort, isolated, observer, reference, rows: Vec::new(), figures: Vec::new() };
    for group in groups {
        let first = bench.rows.len();
        (group.measure)(&mut bench)?;
        pareto::mark(&mut bench.rows[first..]);
    }
    Ok(Outcome {
        reference_s: bench.reference.median(),
        reference: scene::middle_tension(effort.quick).about,
        rows: bench.rows,
        figures: bench.figures,
        machine: Machine::here(),
    })
}

impl Bench<'_> {
    /// Times a run in turn with the reference run; what the last one gave, and the times.
    fn time<T>(&mut self, run: impl FnMut() -> Result<T>) -> Result<(T, Timing)> {
        measure(self.effort.repeats, self.effort.seconds_per_row, &mut self.reference, run)
    }

    fn push(&mut self, row: Row) {
        self.observer.row(&row);
        self.rows.push(row);
    }

    /// Coarse scenes keep what they find to themselves: the demands are on the full ones.
    fn figure(&mut self, mut figure: Figure) {
        if self.effort.quick {
            figure.asked = None;
        }
        self.observer.figure(&figure);
        self.figures.push(figure);
    }
}
