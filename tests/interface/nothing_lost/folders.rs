//! A folder of results is replaced by the next run of its kind; whatever else lies there is not.

use std::fs;
use std::os::unix::fs::symlink;
use std::path::Path;

use crate::interface::cli::{assert_refused, perilife};
use crate::support::daily::{KINDS, content, inputs, names};
use crate::support::desk::done;

/// A file, a hidden one, a folder, one below a folder of the run, a link, a project: each is named, and stays with all else as it was.
#[test]
fn what_a_user_laid_there_stays() {
    type Lay = fn(&Path);
    let things: [(&str, Lay); 6] = [
        ("notes.txt", |out| fs::write(out.join("notes.txt"), "what I found").unwrap()),
        (".notes", |out| fs::write(out.join(".notes"), "what I found").unwrap()),
        ("mine", |out| fs::create_dir(out.join("mine")).unwrap()),
        ("mine/deep.txt", |out| {
            fs::create_dir(out.join("mine")).unwrap();
            fs::write(out.join("mine/deep.txt"), "deep").unwrap();
        }),
        ("link", |out| symlink("../panel.toml", out.join("link")).unwrap()),
        ("other", |out| drop(done(out.parent().unwrap(), &["predict", "panel.toml", "--out", "out/other", "-q"]))),
    ];
    let dir = inputs();
    let (here, out) = (dir.path(), dir.path().join("out"));
    for (call, table) in KINDS {
        let call = [call, &["--out", "out", "-q"]].concat();
        for (name, lay) in things {
            done(here, &call);
            lay(&out);
            let before = content(here);
            let named = format!("contains other files ({})", name.split('/').next().unwrap());
            assert_refused(&perilife(here, &call), 2, &["--out = out", &named, "move it out of this one"]);
            assert!(content(here) == before, "{call:?} beside {name}: something has changed");
            fs::remove_dir_all(&out).unwrap();
        }
        done(here, &call);
        done(here, &call);
        assert!(out.join(table).is_file(), "its own results are replaced");
        fs::remove_dir_all(&out).unwrap();
    }
}

#[test]
fn another_kind_is_not_replaced() {
    let dir = inputs();
    let here = dir.path();
    for (call, _) in KINDS {
        done(here, &[call, &["--out", call[0], "-q"]].concat());
    }
    let before = content(here);
    for (theirs, _) in KINDS {
        for (call, _) in KINDS.iter().filter(|(call, _)| call[0] != theirs[0]) {
            let output = perilife(here, &[*call, &["--out", theirs[0], "-q"]].concat());
            assert_refused(&output, 2, &["--out = ", "contains a", "never replaces", "give a new or empty folder"]);
        }
    }
    assert!(content(here) == before);
    // A calibration without predictions takes those of an earlier one along: they are its own.
    done(here, "calibrate fit.toml --out calibrate -q");
    assert!(!here.join("calibrate/panel").exists());
}

#[test]
fn a_run_of_another_input_is_replaced_by_force_alone() {
    let dir = inputs();
    let here = dir.path();
    let predict = |input: &str, more: &[&str]| perilife(here, &[&["predict", input, "--out", "other", "-q"], more].concat());
    assert!(predict("panel.toml", &[]).status.success());
    // The same file, changed by an override or in itself, and a copy of it.
    let text = fs::read_to_string(here.join("panel.toml")).unwrap();
    fs::write(here.join("copy.toml"), &text).unwrap();
    fs::write(here.join("changed.toml"), text.clone() + "\n# another\n").unwrap();
    assert!(predict("panel.toml", &["--set", "loading.stress_ratio=0.3"]).status.success());
    assert!(predict("copy.toml", &[]).status.success() && predict("panel.toml", &[]).status.success());
    let before = content(&here.join("other"));
    let refused = predict("changed.toml", &[]);
    assert_refused(&refused, 2, &["--out = other", "a prediction of another input", "panel.toml", "--force"]);
    assert!(content(&here.join("other")) == before);
    assert!(predict("changed.toml", &["--force"]).status.success());
}

/// A marker that came along with a copy covers nothing else, and a list that cannot be read covers nothing at all.
#[test]
fn a_marker_in_a_strange_folder_covers_its_files_alone() {
    let dir = inputs();
    let here = dir.path();
    let call = ["predict", "panel.toml", "--out", "thesis", "-q"];
    done(here, &call);
    fs::write(here.join("thesis/thesis.tex"), "years of work").unwrap();
    for marker in [None, Some("made by perilife 0.1.0; replaced by the next run that writes here\n"), Some("")] {
        if let Some(text) = marker {
            fs::write(here.join("thesis/.perilife"), text).unwrap();
        }
        let before = content(here);
        assert_refused(
            &perilife(here, &call),
            2,
            &["--out = thesis", "remove this one yourself\n"]
                .map(|w| if marker.is_none() && w.starts_with("remove") { "thesis.tex" } else { w }),
        );
        assert!(content(here) == before);
    }
}

/// The input itself, and files that it names, by whatever way.
#[test]
fn an_input_in_the_folder_is_refused() {
    let dir = inputs();
    let here = dir.path();
    for (call, _) in KINDS.iter().filter(|(call, _)| call[0] != "verify") {
        done(here, &[*call, &["--out", "out", "-q"]].concat());
        for input in &call[1..] {
            if input.starts_with('-') {
                continue;
            }
            // The input in the folder, or a link from outside to it.
            for by_link in [false, true] {
                fs::rename(here.join(input), here.join("out").join(input)).unwrap();
                let inside = format!("out/{input}");
                if by_link {
                    symlink(&inside, here.join(input)).unwrap();
                } else {
                    // What it names lies beside it.
                    ["readings.csv", "panel.toml"].iter().filter(|name| *name != input).for_each(|name| {
                        fs::copy(here.join(name), here.join("out").join(name)).unwrap();
                    });
                }
                let given: Vec<&str> =
                    call.iter().map(|word| if word == input && !by_link { inside.as_str() } else { word }).collect();
                let before = content(here);
                let output = perilife(here, &[&given[..], &["--out", "out", "-q"]].concat());
                assert_refused(&output, 2, &["--out = out", "contains an input of this run", "give another folder"]);
                assert!(content(here) == before, "{given:?}");
                let _ = fs::remove_file(here.join(input));
                fs::rename(here.join("out").join(input), here.join(input)).unwrap();
                ["readings.csv", "panel.toml"].iter().for_each(|name| drop(fs::remove_file(here.join("out").join(name))));
            }
        }
        fs::remove_dir_all(here.join("out")).unwrap();
    }
    // A table that the case names.
    let table = "delta_k_mpa_sqrt_m,da_dn_mm_per_cycle\n1,1e-9\n100,1e-2\n";
    let (plate, _) = crate::support::daily::PANEL.split_once("[fatigue]").unwrap();
    fs::write(here.join("t.toml"), format!("{plate}[fatigue]\ngrowth_law = \"table\"\ngrowth_table = \"data/rates.csv\"\n"))
        .unwrap();
    fs::create_dir(here.join("data")).unwrap();
    fs::write(here.join("data/rates.csv"), table).unwrap();
    let output = perilife(here, "predict t.toml --out data -q");
    assert_refused(&output, 2, &["--out = data", "contains an input of this run, data/rates.csv"]);
}

/// An empty folder, a link to a folder, and one that points to nothing yet.
#[test]
fn links_lead_to_the_place() {
    let dir = inputs();
    let here = dir.path();
    fs::create_dir(here.join("empty")).unwrap();
    symlink("empty", here.join("to_empty")).unwrap();
    symlink("nowhere/below", here.join("dangling")).unwrap();
    symlink("circle", here.join("circle")).unwrap();
    for (out, place) in [("empty", "empty"), ("to_empty", "empty"), ("dangling", "nowhere/below"), ("dangling", "nowhere/below")]
    {
        done(here, &format!("predict panel.toml --out {out} -q"));
        assert!(here.join(place).join("a_n.csv").is_file(), "{out}");
    }
    for link in ["to_empty", "dangling"] {
        assert!(fs::symlink_metadata(here.join(link)).unwrap().is_symlink());
    }
    assert_refused(&perilife(here, "predict panel.toml --out circle -q"), 4, &["circle"]);
    assert_refused(&perilife(here, "predict panel.toml --out - -q"), 2, &["--out = -", "name of a folder"]);
    assert!(names(here).iter().all(|name| !name.starts_with('.')), "{:?}", names(here));
}
