//! Spectra: formats, rainflow counting, what is left out, classes and the mean rate of a pass.

use perilife_base::error::Error;
use perilife_base::input::Folder;
use perilife_growth::case::Case;
use perilife_laws::growth_law::{GrowthLaw, Walker};
use perilife_laws::paris::ParisLaw;
use perilife_laws::response::Response;
use perilife_laws::spectrum_law::SpectrumLaw;
use perilife_plate::loading::Loading;
use perilife_plate::loading::spectrum::rainflow::rainflow;
use perilife_plate::loading::spectrum::{Cycle, Spectrum, SpectrumFormat};
use perilife_results::spectrum::spectrum_svg;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{RngCore, SeedableRng};

use crate::support::rows::{assert_says, rows};

/// A case with a spectrum of this content, whatever else `[loading]` has.
fn loading(file: &str, content: &str, more: &str) -> Result<Loading, Error> {
    loading_of(file, content.as_bytes().to_vec(), more)
}

/// The same of bytes.
fn loading_of(file: &str, content: Vec<u8>, more: &str) -> Result<Loading, Error> {
    let text = format!(
        "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 100\nlength_mm = 300\nthickness_mm = 2\ncrack_length_mm = 5\n\
         [material]\nname = \"al2024-t3\"\n[model]\nmethod = \"handbook\"\n[fatigue]\ngrowth_law = \"walker\"\n\
         paris_c_mm_per_cycle = 1e-7\nparis_m = 3\nwalker_gamma = 0.5\n\
         [loading]\nkind = \"spectrum\"\nspectrum_file = \"{file}\"\nspectrum_scale_mpa = 2\n{more}"
    );
    let folder = Folder::at_hand([(file.to_owned(), content)]);
    Case::from_toml(&text, "spectrum", folder, &[]).map(|case| case.loading)
}

fn cycles(loading: &Loading) -> Vec<[f64; 3]> {
    // As a file with a largest load of 50 has them.
    let spectrum = loading.spectrum.as_ref().unwrap();
    let round = |x: f64| (1e9 * x).round() / 1e9;
    spectrum.cycles.iter().map(|c| [round(50.0 * c.max), round(50.0 * c.min), c.count]).collect()
}

/// The example of ASTM E1049-85, figure 7, a history that repeats: ranges 3, 4, 7 and 9, one cycle of each, wherever the history begins.
#[test]
fn rainflow_counts_the_example_of_the_standard() {
    let history = [-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0];
    for start in 0..history.len() {
        let turned = [&history[start..], &history[..start]].concat();
        let mut ranges: Vec<f64> = rainflow(&turned).iter().map(|cycle| cycle.max - cycle.min).collect();
        ranges.sort_by(f64::total_cmp);
        assert_eq!(ranges, [3.0, 4.0, 7.0, 9.0], "from {start}");
    }
    // Points on the way between two turns, and loads held, change nothing.
    let slow = [-2.0, 0.0, 1.0, 1.0, -1.0, -3.0, 5.0, -1.0, 3.0, 3.0, -4.0, 4.0, -2.0];
    assert_eq!(rainflow(&slow).len(), 4);
}

/// One pass in every format: two cycles of 40/5, one of 50/10, three of 30/-5.
#[test]
fn every_format_says_the_same_cycles() {
    let wanted = [[40.0, 5.0, 2.0], [50.0, 10.0, 1.0], [30.0, -5.0, 3.0]];
    let spx = "<?xml version=\"1.0\"?>\n<Spectrum><SubSpectrum Name=\"a\">\n<B Mx=\"40\" Mn=\"5\" C=\"2\"/>\n<B Mx=\"50\" Mn=\"10\" C=\"1\"/>\
               </SubSpectrum>\n<SubSpectrum><B Mx=\"30\" Mn=\"-5\" C=\"3\"/></SubSpectrum></Spectrum>";
    let ksi = "\"Peak\",\"Valley\",\"N\"\nksi,ksi,-\n5.8015095,0.7251887,2\n7.2518869,1.4503774,1\n4.3511321,-0.7251887,3\n";
    let ratios = "# flight\tsmax\tstress ratio\tcycles\n1\t40\t0.125\t2\n1\t50\t0.2\t1\n2\t30\t-0.16666666667\t3\n";
    let files = [
        ("a.csv", "# a comment\nmax,min,cycles\n40,5,2\n50,10,1\n30,-5,3\n", SpectrumFormat::Cycles),
        ("b.csv", "cycles;min;max\n2;5;40\n1;10;50\n3;-5;30\n", SpectrumFormat::Cycles),
        ("c.txt", "40 5 2\n50 10 1\n30 -5 3\n", SpectrumFormat::Cycles),
        ("g.csv", "Range (MPa);Mean (MPa);Count\n35,0;22,5;2\n40,0;30,0;1\n35,0;12,5;3\n", SpectrumFormat::Cycles),
        ("h.csv", ksi, SpectrumFormat::Cycles),
        ("i.txt", ratios, SpectrumFormat::Cycles),
        ("j.csv", "amplitude,mean,n\n17.5,22.5,2 # of the first flight\n20,30,1\n17.5,12.5,3\n", SpectrumFormat::Cycles),
        ("d.sub", "2\n40 5 2\n50 10 1\n1\n30 -5 3\n", SpectrumFormat::Sub),
        ("e.sub", "wing root\n40 5 2\n50 10 1\n30 -5 3\n", SpectrumFormat::Sub),
        ("f.spx", spx, SpectrumFormat::Spx),
        ("f.xml", spx, SpectrumFormat::Spx),
    ];
    for (file, content, format) in files {
        let more = if file == "c.txt" { "spectrum_format = \"cycles\"\n" } else { "" };
        let loading = loading(file, content, more).unwrap_or_else(|error| panic!("{file}: {error}"));
        let near = |(found, wanted): (&[f64; 3], &[f64; 3])| (0..3).all(|i| (found[i] - wanted[i]).abs() < 1e-5);
        let found = cycles(&loading);
        assert!(found.len() == 3 && found.iter().zip(&wanted).all(near), "{file}: {found:?}");
        assert_eq!(loading.spectrum.as_ref().unwrap().format, format, "{file}");
        // Scaled by 2 MPa; R of the largest cycle.
        assert!((loading.maximum / 100e6 - 1.0).abs() < 1e-7 && (loading.ratio - 0.2).abs() < 1e-7, "{file}: {loading:?}");
        let [low, high] = loading.ratios();
        assert!((low + 1.0 / 6.0).abs() < 1e-7 && (high - 0.2).abs() < 1e-7);
    }
}

/// Turning points of a pass that repeats: whole cycles, each at the place of its maximum.
#[test]
fn turning_points_are_counted_in_their_order() {
    let points = [0.0, 50.0, 20.0, 30.0, 0.0, 40.0];
    let wanted = [[50.0, 0.0, 1.0], [30.0, 20.0, 1.0], [40.0, 0.0, 1.0]];
    let column: String = points.map(|point| format!("{point}\n")).concat();
    // FASTRAN: -20 stands for 0 and 80 for 50.
    let whole = points.map(|point| (2.0 * point - 20.0).to_string()).join(" ");
    let files = [
        ("a.csv", column.clone(), SpectrumFormat::TurningPoints),
        ("b.txt", format!("stress in units of 2 MPa\n{column}"), SpectrumFormat::TurningPoints),
        ("c.txt", format!("made up\n6 50.0 0.0 0 0\n{whole}\n"), SpectrumFormat::Fastran),
        ("d.csv", format!("load\n{}", column.replace('\n', ",0\n")), SpectrumFormat::TurningPoints),
        ("e.txt", format!("load\n{column}"), SpectrumFormat::TurningPoints),
    ];
    for (file, content, format) in files {
        let loading = loading(file, &content, "").unwrap_or_else(|error| panic!("{file}: {error}"));
        assert_eq!(loading.spectrum.as_ref().unwrap().format, format, "{file}");
        assert_eq!(cycles(&loading), wanted, "{file}");
    }
    // The number of values in the first line, beyond any of them; 4 may be either.
    let counted = loading("g.txt", "8\n1\n3\n1\n2\n1\n3\n1\n2\n", "").unwrap().spectrum.unwrap();
    assert!(counted.per_pass == 4.0 && counted.notes[0].contains("line 1, 8, is the number of values"), "{:?}", counted.notes);
    let named = loading("h.txt", "load\n4\n1\n3\n1\n2\n", "").unwrap().spectrum.unwrap();
    assert_eq!((named.per_pass, named.largest[0]), (2.0, 4.0));
    // Time beside the load, as UTF-16 with a byte order mark.
    let text =
        points.iter().enumerate().fold("Time [s],Load [MPa]\n".to_owned(), |text, (i, point)| format!("{text}{i},{point}\n"));
    let wide: Vec<u8> = "\u{feff}".encode_utf16().chain(text.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    assert_eq!(cycles(&loading_of("f.csv", wide, "").unwrap()), wanted);
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
            let mean = SpectrumLaw::new(Box::new(law), &spectrum);
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
    let mean = SpectrumLaw::new(Box::new(law), &spectrum);
    // At 10 MPa√m the third opens nothing and the fourth, 3 MPa√m, lies below the threshold.
    assert!((mean.rate(10e6, 0.0) / (1e-10 * 125.0 / 4.0) - 1.0).abs() < 1e-12);
    assert_eq!(mean.rate(3.9e6, 0.0), 0.0);
    assert_eq!((spectrum.ratios, spectrum.smallest()), ([-10.0, 0.0], -3.0));
    let svg = spectrum_svg(&spectrum, perilife_results::chart::LARGE);
    assert!(svg.contains("Peak exceedances per pass") && svg.contains("Range / maximum load") && !svg.contains("NaN"), "{svg}");
}

/// What may be either is asked about, by the key that settles it or the name to give.
#[test]
fn what_may_be_either_is_asked_about() {
    for (content, more, words) in rows::<Vec<(String, String, Vec<String>)>>("spectrum", "either") {
        let error = loading("a.csv", &content, &more).unwrap_err();
        assert_says(&format!("{content:?}: {error}"), &words);
    }
    // Numbers of rows under another name, and cycles whose format is given.
    for (content, more) in
        [("row,max,min\n1,100,0\n2,60,10\n3,55,20\n", ""), ("n,max,min\n1,9,0\n2,6,1\n3,5,2\n", "spectrum_format = \"cycles\"\n")]
    {
        let per_pass = loading("a.csv", content, more).unwrap().spectrum.unwrap().per_pass;
        assert_eq!(per_pass, if more.is_empty() { 3.0 } else { 6.0 }, "{content}");
    }
    // Peaks that the cut leaves no range are gone, and the largest that is left is the load.
    let cut = loading("a.csv", "max,min,cycles\n100,50,1\n20,0,1\n", "truncation_percent = 30\n").unwrap();
    assert!((cut.maximum - 40e6).abs() < 1.0 && cut.ratio == 0.0, "{} {}", cut.maximum, cut.ratio);
    // A unit is converted, and a scale that would convert once more is refused.
    let converted = loading("a.csv", "smax [ksi],smin [ksi]\n10,1\n", "").unwrap();
    assert!((converted.maximum / (2.0 * 10.0 * 6.894_757e6) - 1.0).abs() < 1e-6, "{}", converted.maximum);
    let passed_over = loading("a.csv", "max,min,cycles\n2,1,5\n2,2,7\n3,1,0\n", "").unwrap().spectrum.unwrap();
    assert!(passed_over.cycles.len() == 1 && passed_over.notes[0].contains("2 rows are omitted"), "{:?}", passed_over.notes);
}

/// Shares of the growth by class of cycle: a law of one cycle asked of every class.
#[test]
fn the_cycles_that_act_are_told_with_their_shares() {
    let cycle = |max: f64, min: f64, count: f64| Cycle { max, min, count };
    let spectrum = Spectrum::of(vec![cycle(1.0, 0.0, 1.0), cycle(0.5, 0.25, 30.0), cycle(-0.1, -0.2, 9.0)], [0.0, 1.0]).unwrap();
    let law = Walker { paris: ParisLaw { c: 1e-10, m: 2.0 }, gamma: 0.5, threshold: 0.0 };
    let acting = SpectrumLaw::new(Box::new(law), &spectrum).acting(10e6, 0.0, &Response::PROPORTIONAL);
    // C (K_max √(1-R))²: 100 for one, 30 · 25/2 for thirty.
    let wanted = [(2.5e6, 0.5, 375.0 / 475.0), (10e6, 0.0, 100.0 / 475.0)];
    assert_eq!(acting.len(), 2);
    for (found, (delta_k, ratio, share)) in acting.iter().zip(wanted) {
        assert!((found.delta_k - delta_k).abs() < 1.0 && found.ratio == ratio, "{found:?}");
        assert!((found.share - share).abs() < 1e-12, "{found:?}");
    }
}
