//! Wall and processor time of runs, each taken in turn with a reference run.

use std::time::Instant;

use crate::calibration::median::median;
use crate::case::Case;
use crate::error::Result;
use crate::predict::{Silent, predict};

/// Share of its seconds that a row has to itself, whatever the reference runs beside it take.
const OWN_SHARE: f64 = 0.25;

/// Times of a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Timing {
    /// Median of the wall times, s.
    pub wall_s: f64,
    /// Mean of the processor times over all threads, s; NaN where the system does not tell.
    pub cpu_s: f64,
    /// Median of the wall time over that of the reference run beside it.
    pub ratio: f64,
    /// Times the run was measured.
    pub repeats: usize,
    /// What the measured blocks of a slow solver say of the whole run, s.
    pub estimated_s: Option<f64>,
    /// Blocks measured where the run is extrapolated from them.
    pub extrapolated_from: Option<usize>,
}

/// The run that all others are compared with.
#[derive(Debug)]
pub struct Reference {
    case: Case,
    walls: Vec<f64>,
    ended: Instant,
}

/// Age, s, up to which a reference run counts as beside a run: short runs need not each have their own.
const FRESH_S: f64 = 2.0;

impl Reference {
    /// A case as reference, run twice to warm up caches and threads.
    ///
    /// # Errors
    /// As [`predict`].
    pub fn new(case: Case) -> Result<Self> {
        let mut reference = Reference { case, walls: Vec::new(), ended: Instant::now() };
        reference.run()?;
        reference.walls.clear();
        reference.run()?;
        Ok(reference)
    }

    /// Seconds of one run.
    ///
    /// # Errors
    /// As [`predict`].
    pub fn run(&mut self) -> Result<f64> {
        let started = Instant::now();
        predict(&self.case, &Silent)?;
        let wall = started.elapsed().as_secs_f64();
        self.walls.push(wall);
        self.ended = Instant::now();
        Ok(wall)
    }

    /// Seconds of a run just ended, or of a new one.
    ///
    /// # Errors
    /// As [`predict`].
    pub fn beside(&mut self) -> Result<f64> {
        match self.walls.last() {
            Some(&wall) if self.ended.elapsed().as_secs_f64() < FRESH_S => Ok(wall),
            _ => self.run(),
        }
    }

    /// Median of all its runs, s.
    #[must_use]
    pub fn median(&self) -> f64 {
        median(&self.walls)
    }
}

/// Runs until there are enough repeats or no more time (at least once), each beside a reference run; what the last run gave.
///
/// # Errors
/// Those of the run.
pub(super) fn measure<T>(
    repeats: usize,
    seconds: f64,
    reference: &mut Reference,
    mut run: impl FnMut() -> Result<T>,
) -> Result<(T, Timing)> {
    let (mut walls, mut ratios, mut cpu) = (Vec::new(), Vec::new(), 0.0);
    let begun = Instant::now();
    loop {
        let beside = reference.beside()?;
        let (before, started) = (cpu_seconds(), Instant::now());
        let result = run()?;
        let wall = started.elapsed().as_secs_f64();
        cpu += cpu_seconds() - before;
        walls.push(wall);
        ratios.push(wall / beside);
        let spent = begun.elapsed().as_secs_f64() >= seconds && walls.iter().sum::<f64>() >= OWN_SHARE * seconds;
        if walls.len() >= repeats || spent {
            let timing = Timing {
                wall_s: median(&walls),
                cpu_s: cpu / walls.len() as f64,
                ratio: median(&ratios),
                repeats: walls.len(),
                estimated_s: None,
                extrapolated_from: None,
            };
            return Ok((result, timing));
        }
    }
}

impl Timing {
    /// Of a run that failed.
    pub const NONE: Timing =
        Timing { wall_s: f64::NAN, cpu_s: f64::NAN, ratio: f64::NAN, repeats: 0, estimated_s: None, extrapolated_from: None };

    /// The time of one of `count` equal runs that were measured together.
    #[must_use]
    pub fn of_one_in(self, count: usize) -> Self {
        let count = count as f64;
        Timing { wall_s: self.wall_s / count, cpu_s: self.cpu_s / count, ratio: self.ratio / count, ..self }
    }
}

/// Processor time of the process, all threads, s; NaN where the system does not tell (it is read from `/proc`, in ticks of
/// 1/100 s).
#[must_use]
pub fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name of the process, in parentheses, may hold spaces; user and system time are the 12th and 13th field after it.
    let fields = stat.rsplit_once(')').map_or("", |(_, rest)| rest).split_whitespace();
    let ticks: Vec<f64> = fields.skip(11).take(2).filter_map(|ticks| ticks.parse().ok()).collect();
    if ticks.len() == 2 { ticks.iter().sum::<f64>() / 100.0 } else { f64::NAN }
}
