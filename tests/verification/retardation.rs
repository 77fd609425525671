//! Growth through overloads, against figures computed cycle by cycle from the printed laws.
//!
//! Cases of a public course on damage tolerance (Wichita State University, AE 737, homework 8 and lecture 20), figures of the shared table
//! `retardation.md`. Law `da/dN = 1e-4 (K_max (1-R)^0.6 / m_T)^3.5` in/cycle, K in ksi√in, σ_Y 68 ksi, plane stress.

use std::f64::consts::PI;

use perilife_base::input::Folder;
use perilife_base::units::{INCH, KSI, MM, MM_PER_CYCLE, MPA, MPA_SQRT_M};
use perilife_growth::case::Case;
use perilife_growth::predict::{Silent, StopReason, predict};
use perilife_laws::growth_law::nasgro::opening;
use perilife_laws::growth_law::{GrowthLaw, Walker};
use perilife_laws::paris::ParisLaw;
use perilife_laws::retardation::{Laws, March, Marched, Retardation, RetardationKind, Underway};
use perilife_laws::spectrum_law::SpectrumLaw;
use perilife_plate::loading::spectrum::{Cycle, Spectrum};
use perilife_plate::material::Plane;
use perilife_plate::specimen::FrontTip;

/// Blocks of a sequence, ksi and cycles.
type Blocks = [[f64; 3]; 3];
/// The overload is one of the 10 000 cycles.
const FIRST: Blocks = [[20.0, 5.0, 5000.0], [40.0, 5.0, 1.0], [20.0, 5.0, 4999.0]];
const SECOND: Blocks = [[18.0, 3.6, 6000.0], [27.0, 5.4, 1.0], [18.0, 3.6, 6000.0]];

fn law(m_t: f64) -> Walker {
    let c = 1e-4 * INCH * (MPA_SQRT_M / (m_t * KSI * INCH.sqrt())).powf(3.5);
    Walker { paris: ParisLaw { c, m: 3.5 }, gamma: 0.6, threshold: 0.0 }
}

fn spectrum(blocks: &Blocks) -> Spectrum {
    let cycles = blocks.iter().map(|[max, min, count]| Cycle { max: *max, min: *min, count: *count }).collect();
    Spectrum::of(cycles, [0.0, 1.0]).unwrap()
}

fn model(name: &str, constants: &[f64]) -> Retardation {
    Retardation::of(name.parse::<RetardationKind>().unwrap(), constants, (68.0 * KSI, Plane::Stress))
}

/// Crack length, in, after so many cycles of a sequence in an infinite plate, K = β σ √(πa); where it passes a length, in, cycles are told too.
fn grown(blocks: &Blocks, (start, beta, m_t): (f64, f64, f64), retardation: Option<&Retardation>, cycles: f64) -> March<'static> {
    let (law, spectrum) = (Box::leak(Box::new(law(m_t))), Box::leak(Box::new(spectrum(blocks))));
    let mean = Box::leak(Box::new(SpectrumLaw::new(Box::new(*law), spectrum)));
    let retardation = retardation.cloned().map(|model| &*Box::leak(Box::new(model)));
    let mut march = March::new(Laws { law, mean, retardation }, spectrum, Underway::start(spectrum));
    let k = |a: f64| beta * spectrum.largest[1] * KSI * (PI * (start * INCH + a)).sqrt();
    assert_ne!(march.advance(&k, 10.0 * INCH, cycles), Marched::Reached);
    march
}

/// Case, history, constants, model and length at the end.
type Row<'a> = (&'a str, &'a Blocks, (f64, f64, f64), Option<Retardation>, f64);

#[test]
fn overloads_slow_a_crack_down_as_each_model_says() {
    let willenborg = |k_th: f64, shutoff: f64| model("willenborg", &[shutoff, k_th * (KSI * INCH.sqrt()) / MPA_SQRT_M]);
    let (plate, edge) = ((0.25, 1.0, 24.0), (0.3, 1.22, 32.0));
    let rows: [Row<'_>; 8] = [
        ("none", &FIRST, plate, None, 0.76635),
        ("wheeler", &FIRST, plate, Some(model("wheeler", &[1.5])), 0.47448),
        ("willenborg", &FIRST, plate, Some(willenborg(3.0, 2.0)), 0.39097),
        ("closure", &FIRST, plate, Some(model("closure", &[0.3])), 0.69134),
        ("none", &SECOND, edge, None, 0.671122),
        ("wheeler", &SECOND, edge, Some(model("wheeler", &[1.43])), 0.617694),
        ("willenborg", &SECOND, edge, Some(willenborg(1.0, 2.3)), 0.636309),
        ("closure", &SECOND, edge, Some(model("closure", &[0.3])), 0.635651),
    ];
    for (name, blocks, of, model, wanted) in rows {
        let cycles: f64 = blocks.iter().map(|block| block[2]).sum();
        let march = grown(blocks, of, model.as_ref(), cycles);
        let length = of.0 + march.at.a / INCH;
        assert!((length / wanted - 1.0).abs() < 1e-3, "{name}: {length} against {wanted}");
        assert_eq!(march.at.cycles, cycles);
    }
    let before = grown(&FIRST, plate, None, 5000.0);
    assert!((0.25 + before.at.a / INCH - 0.390121).abs() < 1e-4 * 0.39);
}

/// Cycles at which the own zone passes that of the overload; with Willenborg's model, at its shut-off ratio, never.
#[test]
fn retardation_ends_where_the_zone_of_the_overload_is_passed() {
    let rows = [(model("wheeler", &[1.5]), 9352.0), (model("closure", &[0.3]), 6671.0)];
    for (model, wanted) in rows {
        let is_in = |cycles: f64| {
            let zone = grown(&FIRST, (0.25, 1.0, 24.0), Some(&model), cycles).at.zone.unwrap();
            (zone.k_max / (40.0 * KSI * (PI * 0.390121 * INCH).sqrt()) - 1.0).abs() < 1e-3
        };
        assert!(is_in(wanted * 0.999) && !is_in(wanted * 1.001), "{wanted}");
    }
}

/// The same through a case: a panel of 5 m by its handbook K, a file with the three blocks, one pass.
#[test]
fn a_case_with_a_spectrum_is_retarded_alike() {
    let rows = [
        ("retardation = \"wheeler\"\nwheeler_exponent = 1.5", 0.47448),
        ("retardation = \"willenborg\"\nshutoff_ratio = 2\nwillenborg_k_th_mpa_sqrt_m = 3.2965", 0.39097),
        ("retardation = \"closure\"\nclosure_cf0 = 0.3", 0.69134),
        ("retardation = \"none\"", 0.76635),
    ];
    for (keys, wanted) in rows {
        let text = format!(
            "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 5000\nlength_mm = 20000\nthickness_mm = 2\ncrack_length_mm = 6.35\n\
             [material]\nyoungs_modulus_gpa = 72\npoisson_ratio = 0.33\nyield_strength_mpa = {}\n[model]\nmethod = \"handbook\"\n\
             [loading]\nkind = \"spectrum\"\nspectrum_file = \"blocks.csv\"\nspectrum_scale_mpa = {}\nrepeats = 1\n{keys}\n\
             [fatigue]\ngrowth_law = \"walker\"\nparis_c_mm_per_cycle = {:e}\nparis_m = 3.5\nwalker_gamma = 0.6\n",
            68.0 * KSI / MPA,
            KSI / MPA,
            law(24.0).paris.c / MM_PER_CYCLE
        );
        let blocks = FIRST.map(|[max, min, count]| format!("{max},{min},{count}\n")).concat();
        let folder = Folder::at_hand([("blocks.csv".to_owned(), format!("max,min,cycles\n{blocks}").into_bytes())]);
        let case = Case::from_toml(&text, "blocks", folder, &[]).unwrap();
        let run = predict(&case, &Silent).unwrap();
        let length = run.crack_length_final() / INCH;
        // Without order the mean rate of the pass grows the crack, whose overload is then everywhere.
        let bound = if keys.contains("none") { 5e-3 } else { 1e-3 };
        assert!((length / wanted - 1.0).abs() < bound, "{keys}: {length} against {wanted}");
        assert_eq!((run.stop, run.life_cycles()), (StopReason::RunOut, 10_000.0));
        assert!(
            run.curve.windows(2).all(|rows| rows[0].cycles <= rows[1].cycles && rows[0].crack_length <= rows[1].crack_length)
        );
    }
}

/// Passes that are jumped over, against every one of them marched: a long life under an overload in every pass.
#[test]
fn passes_that_are_alike_may_be_jumped_over() {
    let blocks: Blocks = [[10.0, 2.0, 300.0], [16.0, 2.0, 1.0], [9.0, 3.0, 200.0]];
    let of = (0.25, 1.0, 24.0);
    for model in
        [model("wheeler", &[1.5]), model("closure", &[0.3]), model("newman", &[1.0, 0.3]), model("willenborg", &[2.5, 2.0])]
    {
        let per_pass: f64 = blocks.iter().map(|block| block[2]).sum();
        let cycles = 200.0 * per_pass;
        let jumped = grown(&blocks, of, Some(&model), cycles).at.a / MM;
        let every = by_hand(&blocks, of, &model, 200);
        assert!((jumped / every - 1.0).abs() < 2e-3, "{}: {jumped} against {every}", model.kind);
        let plain = grown(&blocks, of, None, cycles).at.a / MM;
        assert!(jumped < 0.98 * plain, "{}: {jumped} against {plain} alone", model.kind);
    }
}

/// Growth, mm, in so many passes with every cycle by itself.
fn by_hand(blocks: &Blocks, of: (f64, f64, f64), model: &Retardation, passes: usize) -> f64 {
    let singles: Vec<Cycle> = (0..passes)
        .flat_map(|_| {
            blocks.iter().flat_map(|[max, min, count]| (0..*count as usize).map(|_| Cycle { max: *max, min: *min, count: 1.0 }))
        })
        .collect();
    let (law, spectrum) = (law(of.2), Spectrum::of(singles, [0.0, 1.0]).unwrap());
    let mean = SpectrumLaw::new(Box::new(law), &spectrum);
    let mut march = March::new(Laws { law: &law, mean: &mean, retardation: Some(model) }, &spectrum, Underway::start(&spectrum));
    let k = |a: f64| of.1 * spectrum.largest[1] * KSI * (PI * (of.0 * INCH + a)).sqrt();
    march.advance(&k, 10.0 * INCH, spectrum.per_pass);
    march.at.a / MM
}

/// A crack that a whole pass does not grow has no end of its life.
#[test]
fn a_crack_that_stands_still_is_arrested() {
    let blocks: Blocks = [[40.0, 5.0, 1.0], [10.0, 5.0, 1000.0], [9.0, 5.0, 10.0]];
    let model = model("willenborg", &[1.5, 3.0]);
    let spectrum = Spectrum::of(vec![Cycle { max: 1.0, min: 0.0, count: 5.0 }], [0.0, 1.0]).unwrap();
    let law = Walker { threshold: 5e6, ..law(24.0) };
    let mean = SpectrumLaw::new(Box::new(law), &spectrum);
    let mut march = March::new(Laws { law: &law, mean: &mean, retardation: Some(&model) }, &spectrum, Underway::start(&spectrum));
    assert_eq!(march.advance(&|_| 4e6, 1.0, 1e12), Marched::Arrested);
    // Small cycles behind the overload of every pass stand still; the overload itself grows.
    let (slow, plain) =
        (grown(&blocks, (0.25, 1.0, 24.0), Some(&model), 10_110.0), grown(&blocks, (0.25, 1.0, 24.0), None, 10_110.0));
    let (slow, plain) = (slow.at.a, plain.at.a);
    assert!(slow < 0.9 * plain && slow > 0.0, "{slow} against {plain}");
}

/// Both ends of the front of a surface crack, each with its zone, against every cycle taken by itself: Wheeler's model, an overload in every 121
/// cycles. Zones are of plane strain at the deepest point and of plane stress at the face.
#[test]
fn both_ends_of_a_front_are_retarded_by_their_own_overloads() {
    let blocks = [[1.0, 0.1, 1.0], [0.6, 0.06, 120.0]];
    let (exponent, strength, stress, passes) = (1.5, 350.0 * MPA, 180.0, 1200);
    let case = |keys: &str| {
        let text = format!(
            "[specimen]\nkind = \"surface_crack\"\nwidth_mm = 100\nthickness_mm = 8\ncrack_depth_mm = 1\ncrack_half_length_mm = 2\n\
             [material]\nyoungs_modulus_gpa = 72\npoisson_ratio = 0.33\nyield_strength_mpa = {}\n\
             [loading]\nkind = \"spectrum\"\nspectrum_file = \"blocks.csv\"\nspectrum_scale_mpa = {stress}\nrepeats = {passes}\n{keys}\n\
             [fatigue]\ngrowth_law = \"walker\"\nparis_c_mm_per_cycle = {:e}\nparis_m = 3.5\nwalker_gamma = 0.6\n",
            strength / MPA,
            law(24.0).paris.c / MM_PER_CYCLE
        );
        let blocks = blocks.map(|[max, min, count]| format!("{max},{min},{count}\n")).concat();
        let folder = Folder::at_hand([("blocks.csv".to_owned(), format!("max,min,cycles\n{blocks}").into_bytes())]);
        Case::from_toml(&text, "blocks", folder, &[]).unwrap()
    };
    let axes = |keys: &str| {
        let run = predict(&case(keys), &Silent).unwrap();
        let last = run.curve.last().unwrap();
        assert_eq!((run.stop, last.cycles), (StopReason::RunOut, 121.0 * passes as f64));
        [last.depth.unwrap().depth, last.crack_length]
    };
    let retarded = axes(&format!("retardation = \"wheeler\"\nwheeler_exponent = {exponent}"));
    let flaw = case("").specimen.part_through.unwrap();
    let law = law(24.0);
    let mut front = flaw.start();
    // End of the zone of the last overload of both ends, m from the middle of the crack.
    let mut ends = [0.0; 2];
    for [max, _, _] in (0..passes).flat_map(|_| [[blocks[0]; 1].to_vec(), vec![blocks[1]; 120]].concat()) {
        let k = FrontTip::ALL.map(|tip| flaw.k_i(front, max * stress * MPA, tip));
        for end in 0..2 {
            let size = (k[end] / strength).powi(2) / (2.0 * PI * [3.0, 1.0][end]);
            let left = ends[end] - front[end];
            let rate = law.rate(k[end], 0.1);
            front[end] += if size < left { (size / left).powf(exponent) * rate } else { rate };
            if size >= left {
                ends[end] = front[end] + size;
            }
        }
    }
    let alone = axes("retardation = \"none\"");
    for end in 0..2 {
        let grown = |axes: [f64; 2]| axes[end] - flaw.start()[end];
        assert!((grown(retarded) / grown(front) - 1.0).abs() < 2e-3, "{retarded:?} against {front:?}");
        assert!(grown(retarded) < 0.9 * grown(alone), "{retarded:?} against {alone:?} alone");
    }
}

/// A gust that comes in one of 3333 passes ends the standstill below the threshold, wherever passes are compared.
#[test]
fn a_rare_gust_ends_a_standstill() {
    let cycle = |max: f64, min: f64, count: f64| Cycle { max, min, count };
    let spectrum = Spectrum::of(vec![cycle(30.0, 27.0, 100.0), cycle(110.0, 6.0, 3e-4)], [0.0, 1.0]).unwrap();
    let law = Walker { paris: ParisLaw { c: 1e-12, m: 3.0 }, gamma: 1.0, threshold: 5e6 };
    let (mean, wheeler) = (SpectrumLaw::new(Box::new(law), &spectrum), model("wheeler", &[1.0]));
    let laws = Laws { law: &law, mean: &mean, retardation: Some(&wheeler) };
    let mut march = March::new(laws, &spectrum, Underway::start(&spectrum));
    let growth = law.rate(20e6, 6.0 / 110.0);
    assert_eq!(march.advance(&|_| 20e6, 2.5 * growth, 1e15), Marched::Reached);
    // Gusts 1, 2 and half of 3, in the passes 3334, 6667 and 10 000.
    let passes = march.at.cycles / 100.0;
    assert!((passes / 10_000.0 - 1.0).abs() < 1e-3, "{passes}");
    // One that grows nothing either is arrested.
    let still = Walker { threshold: 50e6, ..law };
    let laws = Laws { law: &still, mean: &still, ..laws };
    assert_eq!(March::new(laws, &spectrum, Underway::start(&spectrum)).advance(&|_| 20e6, 1.0, 1e15), Marched::Arrested);
}

/// Newman's opening with the stress of each cycle by its own K and crack length: 0.6 of yield at the overload, 0.3 at a cycle of half its load.
#[test]
fn newman_takes_the_stress_of_each_cycle_from_k_and_crack_length() {
    let cycle = |max: f64, min: f64, count: f64| Cycle { max, min, count };
    let spectrum = Spectrum::of(vec![cycle(20.0, 5.0, 1.0), cycle(10.0, 2.0, 1e6)], [0.0, 1.0]).unwrap();
    let (start, yielded) = (0.1, 68.0 * KSI);
    let k = 0.6 * yielded * (PI * start).sqrt();
    let law = Walker { paris: ParisLaw { c: 1e-16, m: 3.0 }, gamma: 0.6, threshold: 0.0 };
    let (mean, newman) = (SpectrumLaw::new(Box::new(law), &spectrum), model("newman", &[1.0, f64::INFINITY]));
    let of_each = Laws { law: &law, mean: &mean, retardation: Some(&newman) };
    let grown = |laws: Laws<'_>| {
        let mut march = March::new(laws, &spectrum, Underway::start(&spectrum));
        march.start = start;
        assert_eq!(march.advance(&|_| k, 1.0, 1e4), Marched::RunOut);
        (march.at.a - law.rate(k, 0.25)) / (1e4 - 1.0)
    };
    let open = |share: f64, ratio: f64| opening(1.0, share, ratio).0;
    // The cycle of half the load has its own minimum, below that of the overload.
    let wanted = 2.0 * open(0.6, 2.0 / 20.0);
    let ratio = (0..=1_000_000).map(|i| f64::from(i) * 1e-6).find(|ratio| open(0.3, *ratio) >= wanted).unwrap();
    let rate = grown(of_each);
    assert!((rate / law.rate(0.5 * k, ratio) - 1.0).abs() < 1e-4, "{rate} for {}", law.rate(0.5 * k, ratio));
    let fixed = model("newman", &[1.0, 0.3]);
    assert!(grown(Laws { retardation: Some(&fixed), ..of_each }) < 0.99 * rate, "a given share is another");
}
