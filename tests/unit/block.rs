//! Keys of the cycle block: one for every kind, refused with words by the others.

use std::path::Path;

use perilife::Error;
use perilife::case::Case;
use perilife::fatigue::BlockKind;

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
