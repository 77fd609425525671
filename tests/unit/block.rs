//! Keys of the cycle block: one for every kind, refused with words by the others; what past blocks teach about strains.

use std::path::Path;

use perilife::Error;
use perilife::case::Case;
use perilife::fatigue::BlockKind;
use perilife::fatigue::block_control::foresight::Foresight;

const TEXT: &str = "[specimen]\nkind = \"middle_tension\"\nwidth_mm = 152.4\nlength_mm = 300\nthickness_mm = 2.54\ncrack_length_mm = 9\n\
                    [material]\nyoungs_modulus_gpa = 73.1\npoisson_ratio = 0.33\n[loading]\nstress_range_mpa = 48.28\nstress_ratio = 0.2\n\
                    [fatigue]\na = 6450\np = 2.86\nhorizon_mm = 3\n";

/// The kind, its own key, a value, and how the block then reads.
const OWN: [(BlockKind, &str, &str, &str); 3] = [
    (BlockKind::Controlled, "block_error_percent", "2.5", "controlled to 2.5 % of life"),
    (BlockKind::UntilNextBreak, "bonds_per_block", "6", "until_next_break, 6 a block"),
    (BlockKind::Fixed, "block_cycles", "250", "fixed, 250 cycles"),
];

fn read(block: Option<BlockKind>, key: &str, value: &str) -> Result<Case, Error> {
    let mut set = vec![format!("fatigue.{key}={value}")];
    set.extend(block.map(|block| format!("fatigue.block={block}")));
    Case::from_toml(TEXT, "panel", Path::new(""), &set)
}

#[test]
fn every_kind_takes_its_own_key_only() {
    assert_eq!(OWN.map(|own| own.0).len(), BlockKind::ALL.len());
    for &kind in BlockKind::ALL {
        for (owner, key, value, words) in OWN {
            let case = read(Some(kind), key, value);
            if kind == owner {
                assert_eq!(case.unwrap().fatigue.block.to_string(), words);
            } else {
                let message = case.unwrap_err().to_string();
                for word in [key, value, kind.name(), owner.name(), "leave it out"] {
                    assert!(message.contains(word), "{kind} with {key}, lacks \"{word}\": {message}");
                }
            }
        }
    }
}

#[test]
fn a_key_of_another_kind_says_what_the_default_is() {
    assert_eq!(read(None, "block_error_percent", "5").unwrap().fatigue.block.error_percent, 5.0);
    let message = read(None, "bonds_per_block", "2").unwrap_err().to_string();
    assert!(message.contains("\"controlled\", the default") && message.contains("until_next_break"), "{message}");
}

#[test]
fn errors_and_sizes_out_of_range_are_refused() {
    for (kind, key, value) in [
        (BlockKind::Controlled, "block_error_percent", "0"),
        (BlockKind::Controlled, "block_error_percent", "-1"),
        (BlockKind::Controlled, "block_error_percent", "50"),
        (BlockKind::UntilNextBreak, "bonds_per_block", "0"),
        (BlockKind::Fixed, "block_cycles", "0"),
    ] {
        let message = read(Some(kind), key, value).unwrap_err().to_string();
        assert!(message.contains(&format!("fatigue.{key} = {value}")), "{message}");
    }
}

/// Blocks of any size with a β that falls along a line: the next block is foreseen within a percent of what is corrected.
#[test]
fn a_falling_bias_is_carried_on() {
    let beta = |w: f64| 6.0 - 0.8 * w;
    let (mut tip, mut at) = (Foresight::default(), 0.0);
    for (i, w) in [0.01, 0.1, 0.05, 0.2, 0.3, 0.25, 0.4, 0.3, 0.5].into_iter().enumerate() {
        tip.open();
        assert!(tip.is_at_rest());
        tip.grow(1e-3, 0.5 * w);
        tip.grow(1e-3, 0.5 * w);
        let truth = w * beta(at + 0.5 * w);
        if i > 4 {
            assert!((tip.correction() / truth - 1.0).abs() < 0.02, "block {i}: {} and {truth}", tip.correction());
        }
        tip.learn(truth);
        assert!(tip.is_known());
        at += w;
    }
    assert!((tip.grown - 2e-3).abs() < 1e-15 && (tip.grown_in_all - 18e-3).abs() < 1e-15);
}

/// A constant bias is found from the first block, however small.
#[test]
fn a_constant_bias_is_found_at_once() {
    let mut tip = Foresight::default();
    assert_eq!(tip.correction(), 0.0);
    for w in [1e-6, 0.3, 2.0] {
        tip.grow(1e-3, w);
        if tip.is_known() {
            assert!((tip.correction() / (4.0 * w) - 1.0).abs() < 1e-9);
        }
        tip.learn(4.0 * w);
        tip.open();
    }
}
