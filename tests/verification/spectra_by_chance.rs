//! Two thousand spectra by chance, in every form that people write, counted and grown as by a march of every cycle by itself.
//!
//! The reference counts by the four-point method (Amzallag et al. 1994) from the lowest load on, reads no file and knows neither classes nor jumps.

use std::f64::consts::PI;

use perilife_base::input::Folder;
use perilife_growth::case::Case;
use perilife_growth::predict::{Silent, predict};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// Largest load, minimum and how often in a pass.
type Row = [f64; 3];

struct Chance(ChaCha8Rng);

impl Chance {
    fn unit(&mut self) -> f64 {
        self.0.next_u32() as f64 / (u32::MAX as f64 + 1.0)
    }

    fn below(&mut self, most: usize) -> usize {
        (self.unit() * most as f64) as usize
    }

    /// A load in steps of a quarter, so that every form writes it exactly.
    fn load(&mut self, low: f64, high: f64) -> f64 {
        (4.0 * (low + (high - low) * self.unit())).round() / 4.0
    }
}

/// Full cycles of a history that repeats: the range between two neighbors that both others enclose, until none is left.
fn by_four_points(history: &[f64]) -> Vec<[f64; 2]> {
    let lowest = (0..history.len()).min_by(|a, b| history[*a].total_cmp(&history[*b])).unwrap();
    let closed: Vec<f64> = [&history[lowest..], &history[..=lowest]].concat();
    let mut turns: Vec<f64> = Vec::new();
    for (i, x) in closed.iter().enumerate() {
        let before = turns.last().copied();
        let next = closed[i + 1..].iter().find(|next| *next != x);
        let is_turn = before.is_none_or(|before| next.is_none_or(|next| (x - before) * (next - x) < 0.0));
        if is_turn && before != Some(*x) {
            turns.push(*x);
        }
    }
    let mut cycles = Vec::new();
    while let Some(at) = (0..turns.len().saturating_sub(3)).find(|&i| {
        let range = |j: usize| (turns[i + j + 1] - turns[i + j]).abs();
        range(1) <= range(0) && range(1) <= range(2)
    }) {
        cycles.push([turns[at + 1].max(turns[at + 2]), turns[at + 1].min(turns[at + 2])]);
        turns.drain(at + 1..at + 3);
    }
    assert_eq!(turns.len(), 3, "a closed history leaves its largest range: {history:?}");
    cycles.push([turns[1], turns[0]]);
    cycles
}

/// A column of numbers as text.
fn table(names: &str, rows: impl Iterator<Item = Vec<f64>>, separator: &str, decimal: &str) -> String {
    let line = |row: Vec<f64>| row.iter().map(|x| format!("{x}").replace('.', decimal)).collect::<Vec<_>>().join(separator);
    std::iter::once(names.replace(',', separator)).chain(rows.map(line)).collect::<Vec<_>>().join("\n") + "\n"
}

/// Turning points in one of the forms of files.
fn points_file(points: &[f64], chance: &mut Chance) -> (&'static str, Vec<u8>) {
    let column = |name: &str, decimal| table(name, points.iter().map(|x| vec![*x]), ";", decimal);
    match chance.below(7) {
        0 => ("a.csv", column("load", ".").into_bytes()),
        1 => ("a.csv", column("Stress (MPa)", ",").into_bytes()),
        2 => ("a.csv", table("time,load", points.iter().enumerate().map(|(i, x)| vec![i as f64, *x]), ",", ".").into_bytes()),
        3 => (
            "a.csv",
            "\u{feff}load\n"
                .encode_utf16()
                .chain(column("", ".").trim_start().encode_utf16())
                .flat_map(u16::to_le_bytes)
                .collect(),
        ),
        // A number of values is known by being far beyond all of them, and a load that may be one is asked about.
        4 if points.iter().all(|x| 2.0 * x < points.len() as f64) => {
            ("a.txt", column(&points.len().to_string(), ".").into_bytes())
        }
        5 if points[0] != points.len() as f64 - 1.0 => ("a.txt", column("#a test flight", ".").into_bytes()),
        _ => {
            let (low, high) =
                points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
            let whole: Vec<String> = points.iter().map(|x| (4.0 * x).to_string()).collect();
            ("a.txt", format!("by chance\n{} {high} {low} 0 0\n{}\n", points.len(), whole.join(" ")).into_bytes())
        }
    }
}

/// Cycles in one of the forms of files.
fn cycles_file(rows: &[Row], chance: &mut Chance) -> (&'static str, Vec<u8>) {
    let written =
        |names, of: fn(&Row) -> Vec<f64>, separator, decimal| table(names, rows.iter().map(of), separator, decimal).into_bytes();
    match chance.below(6) {
        0 => ("a.csv", written("max,min,cycles", |row| row.to_vec(), ",", ".")),
        1 => ("a.csv", written("Smin (MPa),N,Smax (MPa)", |[max, min, count]| vec![*min, *count, *max], ";", ",")),
        2 => {
            ("a.csv", written(",range,mean,count", |[max, min, count]| vec![0.0, max - min, 0.5 * (max + min), *count], ",", "."))
        }
        3 => (
            "a.txt",
            written("amplitude,mean,cycles", |[max, min, count]| vec![0.5 * (max - min), 0.5 * (max + min), *count], "\t", "."),
        ),
        4 => {
            let element = |[max, min, count]: &Row| format!("<B Mx=\"{max}\" Mn=\"{min}\" C=\"{count}\"/>\n");
            let all: String = rows.iter().map(element).collect();
            ("a.spx", format!("<S><SubSpectrum>{all}</SubSpectrum></S>").into_bytes())
        }
        _ => ("a.sub", table(&rows.len().to_string(), rows.iter().map(|row| row.to_vec()), " ", ".").into_bytes()),
    }
}

const WIDTH: f64 = 0.1524;
const ENDS: [f64; 2] = [0.009, 0.02];
const STRENGTH: f64 = 345.0;
const M: f64 = 2.874;
const GAMMA: f64 = 0.6;

/// K over stress (Feddersen 1966), √m.
fn geometry(a: f64) -> f64 {
    (PI * a / (PI * a / WIDTH).cos()).sqrt()
}

/// Cycles from one end to the other, every cycle by itself; `wheeler` is the exponent of Wheeler, in plane stress.
fn march(rows: &[Row], c: f64, wheeler: Option<f64>) -> f64 {
    let (mut a, mut cycles, mut pass) = (ENDS[0], 0.0, 0.0);
    let mut zone: Option<[f64; 2]> = None;
    loop {
        for [max, min, count] in rows {
            let times = match wheeler {
                Some(_) => (count * (pass + 1.0) + 1e-6).floor() - (count * pass + 1e-6).floor(),
                None => *count,
            };
            let mut left = times;
            while left > 0.0 {
                let part = left.min(1.0);
                left -= part;
                cycles += part;
                if *max <= 0.0 {
                    continue;
                }
                let k = max * geometry(a);
                let mut growth = c * (k * (1.0 - (min / max).max(0.0)).powf(GAMMA)).powf(M);
                let size = (k / STRENGTH).powi(2) / (2.0 * PI);
                let within = zone.filter(|[from, zone]| a + size < from + zone);
                if let (Some([from, zone]), Some(exponent)) = (within, wheeler) {
                    growth *= (size / (from + zone - a)).powf(exponent);
                }
                if a + part * growth >= ENDS[1] {
                    return cycles - part + (ENDS[1] - a) / growth;
                }
                a += part * growth;
                zone = within.or(Some([a, size]));
            }
        }
        pass += 1.0;
    }
}

/// Life of a case, cycles, and the rows that were read, in MPa.
fn life(file: &str, content: Vec<u8>, c: f64, wheeler: Option<f64>) -> (f64, Vec<Row>) {
    let retardation = wheeler.map_or_else(String::new, |m| format!("retardation = \"wheeler\"\nwheeler_exponent = {m}\n"));
    let text = format!(
        "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 400\nthickness_mm = 2.54\ncrack_length_mm = 9\n\
         [material]\nyoungs_modulus_gpa = 72\npoisson_ratio = 0.33\nyield_strength_mpa = {STRENGTH}\nplane = \"stress\"\n\
         [loading]\nkind = \"spectrum\"\nspectrum_file = \"{file}\"\nspectrum_scale_mpa = 1\n{retardation}\
         [model]\nmethod = \"handbook\"\n[fatigue]\nparis_c_mm_per_cycle = {:e}\nparis_m = {M}\nwalker_gamma = {GAMMA}\n\
         [stop]\ncrack_length_mm = 20\ntoughness = false\nnet_section = false\ncycles_max = 1e15\n",
        c * 1e3
    );
    let case = Case::from_toml(&text, "chance", Folder::at_hand([(file.to_owned(), content)]), &[]).unwrap();
    let spectrum = case.loading.spectrum.clone().unwrap();
    let rows =
        spectrum.cycles.iter().map(|cycle| [cycle.max * spectrum.largest[1], cycle.min * spectrum.largest[1], cycle.count]);
    (predict(&case, &Silent).unwrap().life_cycles(), rows.collect())
}

/// m/cycle at K = 1 MPa√m that makes a life of so many passes.
fn rate_of(rows: &[Row], passes: f64) -> f64 {
    let of = |[max, min, count]: &Row| count * (max * (1.0 - (min / max).max(0.0)).powf(GAMMA)).powf(M);
    let mean: f64 = rows.iter().filter(|row| row[0] > 0.0).map(of).sum();
    let way: f64 = (0..1000)
        .map(|i| 1e-3 * (ENDS[1] - ENDS[0]) / geometry(ENDS[0] + (i as f64 + 0.5) * 1e-3 * (ENDS[1] - ENDS[0])).powf(M))
        .sum();
    way / (mean * passes)
}

#[test]
fn spectra_by_chance_are_counted_and_grown_as_cycle_by_cycle() {
    let mut worst = 0.0_f64;
    for seed in 0..2000 {
        let mut chance = Chance(ChaCha8Rng::seed_from_u64(seed));
        let wheeler = (chance.below(3) == 0).then(|| 0.5 + chance.unit());
        let (wanted, (file, content)): (Vec<Row>, _) = if chance.below(2) == 0 {
            let low = chance.load(-40.0, 20.0);
            let mut points: Vec<f64> = (0..4 + chance.below(40)).map(|_| chance.load(low, 110.0)).collect();
            points[0] = if points[0] == points[1] { points[0] + 0.25 } else { points[0] };
            let cycles = by_four_points(&points);
            (cycles.iter().map(|[max, min]| [*max, *min, 1.0]).collect(), points_file(&points, &mut chance))
        } else {
            let mut row = |fraction: bool| {
                let max = chance.load(5.0, 110.0);
                let min = (max - 0.25 - chance.load(0.0, 100.0)).max(-60.0);
                [max, min, if fraction { [0.5, 0.25, 0.1, 0.02][chance.below(4)] } else { 1.0 + chance.below(8) as f64 }]
            };
            let mut rows: Vec<Row> = (0..3).map(|_| row(false)).collect();
            rows.extend((0..2).map(|i| row(i == 1)));
            (rows.clone(), cycles_file(&rows, &mut chance))
        };
        if wanted.iter().all(|[max, ..]| *max <= 0.0) {
            continue;
        }
        // A jump over passes may end one pass off, which is to be a small share of the life.
        let c = rate_of(&wanted, if wheeler.is_some() { 6000.0 } else { 2000.0 });
        let (found, read) = life(file, content.clone(), c, wheeler);
        let sorted = |rows: &[Row]| {
            let mut rows: Vec<[i64; 3]> = rows.iter().map(|row| row.map(|x| (1e6 * x).round() as i64)).collect();
            rows.sort_unstable();
            rows
        };
        let told = || format!("seed {seed}, {file}:\n{}", String::from_utf8_lossy(&content));
        assert_eq!(sorted(&read), sorted(&wanted), "{}", told());
        // The order in which cycles close is that of the program; everything else is the reference's.
        let right = march(&read, c, wheeler);
        let error = (found / right - 1.0).abs();
        worst = worst.max(error);
        assert!(error < 1e-3, "seed {seed}, Wheeler {wheeler:?}: {found} cycles for {right}\n{}", told());
    }
    println!("largest difference of 2000 lives: {worst:.1e}");
}
