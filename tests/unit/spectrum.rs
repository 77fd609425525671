//! Spectra: formats, rainflow counting, what is left out, classes and the mean rate of a pass.

use perilife_base::error::Error;
use perilife_base::input::Folder;
use perilife_growth::case::Case;
use perilife_laws::growth_law::{GrowthLaw, Walker};
use perilife_laws::paris::ParisLaw;
use perilife_laws::spectrum_law::SpectrumLaw;
use perilife_plate::loading::Loading;
use perilife_plate::loading::spectrum::rainflow::rainflow;
use perilife_plate::loading::spectrum::{Cycle, Spectrum, SpectrumFormat};
use perilife_results::pictures::spectrum::spectrum_svg;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

/// A case with a spectrum of this content, whatever else `[loading]` has.
fn loading(file: &str, content: &str, more: &str) -> Result<Loading, Error> {
    let text = format!(
        "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 5\n\
         [material]\nname = \"al2024-t3\"\n[model]\nmethod = \"handbook\"\n[fatigue]\ngrowth_law = \"walker\"\n\
         paris_c_mm_per_cycle = 1e-7\nparis_m = 3\nwalker_gamma = 0.5\n\
         [loading]\nkind = \"spectrum\"\nspectrum_file = \"{file}\"\nspectrum_scale_mpa = 2\n{more}"
    );
    let folder = Folder::at_hand([(file.to_owned(), content.as_bytes().to_vec())]);
    Case::from_toml(&text, "spectrum", folder, &[]).map(|case| case.loading)
}

fn cycles(loading: &Loading) -> Vec<[f64; 3]> {
    // As a file with a largest load of 50 has them.
    let spectrum = loading.spectrum.as_ref().unwrap();
    let round = |x: f64| (1e9 * x).round() / 1e9;
    spectrum.cycles.iter().map(|c| [round(50.0 * c.max), round(50.0 * c.min), c.count]).collect()
}

/// The example of ASTM E1049-85, figure 6: ranges 3 (half), 4 (half), 4 (one), 6 (half), 8 (half), 8 (half), 9 (half).
#[test]
fn rainflow_counts_the_example_of_the_standard() {
    let history = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0];
    let mut ranges: Vec<(f64, f64)> = rainflow(&history).iter().map(|cycle| (cycle.range(), cycle.count)).collect();
    ranges.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    assert_eq!(ranges, [(3.0, 0.5), (4.0, 0.5), (4.0, 1.0), (6.0, 0.5), (8.0, 0.5), (8.0, 0.5), (9.0, 0.5)]);
    // Points on the way between two turns, and loads held, change nothing.
    let slow = [-2.0, 0.0, 1.0, 1.0, -1.0, -3.0, 5.0, -1.0, 3.0, 3.0, -4.0, 4.0, -2.0];
    assert_eq!(rainflow(&slow).len(), 7);
}

/// One pass in every format: two cycles of 40/5, one of 50/10, three of 30/-5.
#[test]
fn every_format_says_the_same_cycles() {
    let wanted = [[40.0, 5.0, 2.0], [50.0, 10.0, 1.0], [30.0, -5.0, 3.0]];
    let spx = "<?xml version=\"1.0\"?>\n<Spectrum><SubSpectrum Name=\"a\">\n<B Mx=\"40\" Mn=\"5\" C=\"2\"/>\n<B Mx=\"50\" Mn=\"10\" C=\"1\"/>\
               </SubSpectrum>\n<SubSpectrum><B Mx=\"30\" Mn=\"-5\" C=\"3\"/></SubSpectrum></Spectrum>";
    let files = [
        ("a.csv", "# a comment\nmax,min,cycles\n40,5,2\n50,10,1\n30,-5,3\n", SpectrumFormat::Cycles),
        ("b.csv", "cycles;min;max\n2;5;40\n1;10;50\n3;-5;30\n", SpectrumFormat::Cycles),
        ("c.txt", "40 5 2\n50 10\n30\t-5 3\n", SpectrumFormat::Cycles),
        ("d.sub", "2\n40 5 2\n50 10 1\n1\n30 -5 3\n", SpectrumFormat::Sub),
        ("e.sub", "wing root\n40 5 2\n50 10 1\n30 -5 3\n", SpectrumFormat::Sub),
        ("f.spx", spx, SpectrumFormat::Spx),
        ("f.xml", spx, SpectrumFormat::Spx),
    ];
    for (file, content, format) in files {
        let loading = loading(file, content, "").unwrap_or_else(|error| panic!("{file}: {error}"));
        assert_eq!(cycles(&loading), wanted, "{file}");
        assert_eq!(loading.spectrum.as_ref().unwrap().format, format, "{file}");
        // Scaled by 2 MPa; R of the largest cycle.
        assert!((loading.maximum - 100e6).abs() < 1e-3 && (loading.ratio - 0.2).abs() < 1e-12, "{file}: {loading:?}");
        let [low, high] = loading.ratios();
        assert!((low + 1.0 / 6.0).abs() < 1e-12 && (high - 0.2).abs() < 1e-12);
    }
}

/// Turning points of a closed pass: whole cycles stand at the place of their maximum, the largest as two halves that share it.
#[test]
fn turning_points_are_counted_in_their_order() {
    let points = [0.0, 50.0, 20.0, 30.0, 0.0, 40.0];
    let wanted = [[50.0, 0.0, 0.5], [50.0, 0.0, 0.5], [30.0, 20.0, 1.0], [40.0, 0.0, 1.0]];
    let column: String = points.map(|point| format!("{point}\n")).concat();
    // FASTRAN: -20 stands for 0 and 80 for 50.
    let whole = points.map(|point| (2.0 * point - 20.0).to_string()).join(" ");
    let files = [
        ("a.csv", column.clone(), SpectrumFormat::TurningPoints),
        ("b.txt", format!("stress in units of 2 MPa\n{column}"), SpectrumFormat::TurningPoints),
        ("c.txt", format!("made up\n6 50.0 0.0 0 0\n{whole}\n"), SpectrumFormat::Fastran),
    ];
    for (file, content, format) in files {
        let loading = loading(file, &content, "").unwrap_or_else(|error| panic!("{file}: {error}"));
        let mut found = cycles(&loading);
        assert_eq!(loading.spectrum.as_ref().unwrap().format, format, "{file}");
        found[..2].sort_by(|a, b| a[1].total_cmp(&b[1]));
        assert_eq!(found, wanted, "{file}");
    }
    // Again and again 50, 0 is one cycle a pass, not half of one.
    assert_eq!(loading("d.txt", "50\n0\n", "").unwrap().spectrum.unwrap().per_pass, 1.0);
}

#[test]
fn small_ranges_are_left_out_and_peaks_cut() {
    let content = "max,min,cycles\n40,5,2\n50,10,1\n30,27,100\n";
    let found = loading("a.csv", content, "omission_percent = 10\ntruncation_percent = 80\nrepeats = 7\n").unwrap();
    let spectrum = found.spectrum.as_ref().unwrap();
    assert_eq!((spectrum.per_pass, spectrum.omitted, spectrum.repeats), (3.0, 100.0, Some(7.0)));
    assert!((found.maximum - 80e6).abs() < 1e-3);
    assert_eq!(cycles(&found), [[50.0, 6.25, 2.0], [50.0, 12.5, 1.0]]);
    assert_eq!(found.ratio, 5.0 / 40.0);
}

/// A hundred thousand cycles of sizes that all differ against their sum, for powers 2 to 5 and two exponents of Walker.
#[test]
fn means_over_classes_are_those_over_all_cycles() {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let mut uniform = || random.next_u32() as f64 / u32::MAX as f64;
    let mut cycle = || {
        let max = 0.05 + 0.95 * uniform().powi(3);
        Cycle { max, min: max * (1.2 * uniform() - 0.3), count: 1.0 + (4.0 * uniform()).floor() }
    };
    let all: Vec<Cycle> = (0..100_000).map(|_| cycle()).collect();
    let spectrum = Spectrum::of(all, [0.0, 1.0]).unwrap();
    assert!(spectrum.kinds > 99_000 && spectrum.classes.len() < 40_000, "{} classes", spectrum.classes.len());
    for m in [2.0, 3.0, 4.0, 5.0] {
        for gamma in [0.4, 1.0] {
            let law = Walker { paris: ParisLaw { c: 1e-10, m }, gamma, threshold: 0.0 };
            let of_cycles = |k: f64| {
                let rate = |c: &Cycle| c.ratio().map_or(0.0, |ratio| c.count * law.rate(k * c.max, ratio));
                spectrum.cycles.iter().map(rate).sum::<f64>() / spectrum.per_pass
            };
            let mean = SpectrumLaw::new(Box::new(law), &spectrum, f64::NEG_INFINITY);
            for k in [3.1e6, 27.7e6] {
                let error = mean.rate(k, 0.0) / of_cycles(k) - 1.0;
                assert!(error.abs() < 1e-4, "m {m}, gamma {gamma}: {error:e}");
            }
        }
    }
}

#[test]
fn compression_and_a_threshold_count_as_the_law_says() {
    let cycle = |max: f64, min: f64| Cycle { max, min, count: 1.0 };
    let spectrum = Spectrum::of(vec![cycle(1.0, 0.0), cycle(0.5, 0.0), cycle(-0.2, -1.0), cycle(0.3, -3.0)], [0.0, 1.0]).unwrap();
    let law = Walker { paris: ParisLaw { c: 1e-10, m: 2.0 }, gamma: 1.0, threshold: 4e6 };
    let mean = SpectrumLaw::new(Box::new(law), &spectrum, f64::NEG_INFINITY);
    // At 10 MPa√m the third opens nothing and the fourth, 3 MPa√m, lies below the threshold.
    assert!((mean.rate(10e6, 0.0) / (1e-10 * 125.0 / 4.0) - 1.0).abs() < 1e-12);
    assert_eq!(mean.rate(3.9e6, 0.0), 0.0);
    assert_eq!((spectrum.ratios, spectrum.smallest()), ([-10.0, 0.0], -3.0));
    let svg = spectrum_svg(&spectrum, perilife_results::chart::LARGE);
    assert!(svg.contains("Maxima of a pass") && svg.contains("Range over the largest load") && !svg.contains("NaN"), "{svg}");
}
