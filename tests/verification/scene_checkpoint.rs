//! A scene taken up from any of its checkpoints gives what the undisturbed scene gives, bit for bit.

use std::path::Path;
use std::sync::Mutex;

use perilife_growth::predict::Silent;
use perilife_scenes::checkpoint::SceneCheckpoint;
use perilife_scenes::outcome::SceneFigures;
use perilife_scenes::{Fracture, Scene, SceneObserver, SceneProgress};

/// Keeps every checkpoint as the bytes of its file.
#[derive(Default)]
struct Keeping(Mutex<Vec<Vec<u8>>>);

impl Keeping {
    fn kept(self) -> Vec<Vec<u8>> {
        self.0.into_inner().unwrap()
    }
}

impl SceneObserver for Keeping {
    fn step_done(&self, _: &SceneProgress) -> bool {
        true
    }

    fn may_keep(&self, checkpoint: &dyn Fn() -> SceneCheckpoint) {
        self.0.lock().unwrap().push(checkpoint().to_bytes());
    }
}

/// All of an outcome but time and memory; Debug output of floats says them to the last bit.
fn text(run: &Fracture) -> String {
    let figures = SceneFigures { wall_s: 0.0, memory_mb: 0.0, ..run.figures };
    format!("{:?}", Fracture { figures, ..run.clone() })
}

fn read(bytes: &[u8]) -> SceneCheckpoint {
    SceneCheckpoint::from_bytes(bytes).unwrap()
}

const CRACKED: &str = "kind=\"plate\"\nwidth_mm=20\nlength_mm=20\nthickness_mm=1\ncracks=[{from_mm=[-10,0.3],to_mm=[-1,0.3]}]\n";
const NOTCHED: &str = "kind=\"plate\"\nwidth_mm=14\nlength_mm=16\nthickness_mm=4\n\
                       notches=[{from_mm=[-7,0],to_mm=[-3,0],width_mm=2},{from_mm=[7,0],to_mm=[3,0],width_mm=2}]\n";
const SLANT: &str = "kind=\"plate\"\nwidth_mm=14\nlength_mm=18\nthickness_mm=1\ncracks=[{from_mm=[-3,-3.2],to_mm=[3,3.2]}]\n";
const DISC: &str = "kind=\"plate\"\ndiameter_mm=16\nthickness_mm=6\n";
const GLASS: &str = "youngs_modulus_gpa=65\npoisson_ratio=0.2\ndensity_kg_m3=2235\nfracture_energy_j_m2=204\n";
const STEEL: &str =
    "youngs_modulus_gpa=203\npoisson_ratio=0.3\ndensity_kg_m3=7850\nyield_strength_mpa=345\ntensile_strength_mpa=572\n";
const SOFT: &str = "youngs_modulus_gpa=1\npoisson_ratio=0.35\ndensity_kg_m3=1830\ntensile_strength_mpa=1.66\n";
const TORN: &str = "kind=\"velocity\"\nvelocity_mm_s=5000\nedges=[\"top\",\"bottom\"]\ntransverse=\"held\"\nduration_s=3e-5\n";
const PULLED: &str = "kind=\"displacement\"\nedges=[\"top\",\"bottom\"]\ntransverse=\"held\"\n";
const PLATENS: &str = "kind=\"platens\"\nedges=[\"top\",\"bottom\"]\n";
const SOFTENING: &str = "law=\"nonlinear_two_parameter\"\nfinal_ratio=3\n";
const STRESS: &str = "law=\"principal_stress\"\nenters=\"influence\"\n";

/// Name; `[specimen]`; `[material]`; `[model]`; `[loading]`; more of it; `[damage]`.
type Setting = (&'static str, &'static str, &'static str, &'static str, &'static str, &'static str, &'static str);

/// One scene or more of every procedure, law and law of damage that remember different things. All of them break bonds.
const SETTINGS: [Setting; 9] = [
    ("motion, list of bonds", CRACKED, GLASS, "bond_law=\"two_parameter\"", TORN, "", "law=\"critical_energy\""),
    (
        "motion, lattice",
        CRACKED,
        GLASS,
        "bond_law=\"one_bond_two_parameter\"\nrotation=\"resisted\"",
        TORN,
        "",
        "law=\"critical_energy\"",
    ),
    ("motion, softening", NOTCHED, STEEL, "bond_law=\"two_parameter\"", TORN, "", SOFTENING),
    (
        "motion, platens",
        DISC,
        SOFT,
        "bond_law=\"correspondence\"",
        PLATENS,
        "displacement_mm=0.3\nramp_s=1e-4\nduration_s=1e-4",
        STRESS,
    ),
    (
        "rest",
        CRACKED,
        GLASS,
        "bond_law=\"two_parameter\"\nsolver=\"adaptive_dynamic_relaxation\"",
        PULLED,
        "displacement_mm=0.006\nsteps=20",
        "law=\"critical_stretch\"",
    ),
    (
        "rest, correspondence, platens",
        DISC,
        SOFT,
        "bond_law=\"correspondence\"\nsolver=\"adaptive_dynamic_relaxation\"",
        PLATENS,
        "displacement_mm=0.15\nsteps=15",
        STRESS,
    ),
    (
        "march",
        NOTCHED,
        STEEL,
        "bond_law=\"two_parameter\"\nsolver=\"adaptive_dynamic_relaxation\"",
        PULLED,
        "displacement_mm=0.06\nsteps=300\niterations_per_step=2",
        SOFTENING,
    ),
    (
        "path",
        NOTCHED,
        STEEL,
        "bond_law=\"two_parameter\"\nsolver=\"secant\"",
        PULLED,
        "displacement_mm=0.03\nsteps=40",
        SOFTENING,
    ),
    (
        "path, flanks pressed",
        SLANT,
        GLASS,
        "bond_law=\"two_parameter\"\nsolver=\"secant\"",
        PULLED,
        "displacement_mm=-0.04\nsteps=40",
        "law=\"critical_energy\"",
    ),
];

fn scene((name, specimen, material, model, loading, more, damage): Setting, set: &[&str]) -> Scene {
    let text = format!(
        "[specimen]\n{specimen}[material]\n{material}[model]\n{model}\nspacing_mm=1\n[loading]\n{loading}{more}\n[damage]\n{damage}\n"
    );
    let set: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Scene::from_toml(&text, name, Path::new("."), &set).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn a_scene_taken_up_is_the_undisturbed_one() {
    for (number, setting) in SETTINGS.into_iter().enumerate() {
        let (name, scene) = (setting.0, scene(setting, &[]));
        let keeping = Keeping::default();
        let whole = perilife_scenes::run(&scene, &keeping).unwrap();
        let kept = keeping.kept();
        let (last, size) = (*whole.history.last().unwrap(), kept.last().map_or(0, Vec::len) / 1000);
        println!(
            "{name}: {}, {} rows, {} broken bonds, {} checkpoints of {size} kB, {:.2} s",
            whole.end,
            whole.history.len(),
            last.broken_bonds,
            kept.len(),
            whole.figures.wall_s
        );
        assert!(kept.len() >= 3 && last.broken_bonds > 0, "{name}: nothing to take up, so this scene tests nothing");
        // One that keeps nothing goes the same way.
        if number % 3 == 0 {
            assert!(text(&perilife_scenes::run(&scene, &Silent).unwrap()) == text(&whole), "{name}: it matters who watches");
        }
        // Also where bonds break in the very next row: what was looked back at shows only there.
        let rows = &whole.history;
        let breaks_next = |at: &usize| {
            let row = rows.iter().position(|row| row.step == read(&kept[*at]).step()).unwrap();
            rows.get(row + 1).is_some_and(|next| next.broken_bonds > rows[row].broken_bonds)
        };
        let breaking = (kept.len() / 4..kept.len()).find(breaks_next);
        for at in [2 * kept.len() / 3].into_iter().chain(breaking) {
            let again = Keeping::default();
            let run = perilife_scenes::resume(&scene, read(&kept[at]), &again).unwrap();
            assert_eq!(run.history.len(), whole.history.len(), "{name}, checkpoint {at}: rows");
            for (row, other) in run.history.iter().zip(&whole.history) {
                assert_eq!(row, other, "{name}, checkpoint {at}");
            }
            assert!(text(&run) == text(&whole), "{name}, checkpoint {at}: differs in some bit");
            // It goes on where the other stood, and comes by the same places.
            assert_eq!(again.kept().len(), kept.len() - at - 1, "{name}, checkpoint {at}");
        }
    }
}

#[test]
fn damaged_and_foreign_checkpoints_of_scenes_are_refused() {
    let setting = SETTINGS[4];
    let own = scene(setting, &[]);
    let keeping = Keeping::default();
    perilife_scenes::run(&own, &keeping).unwrap();
    let bytes = keeping.kept().swap_remove(1);
    assert_eq!(read(&bytes).to_bytes(), bytes);
    let places = || (0..200).chain((200..bytes.len()).step_by(4999));
    for at in places() {
        let mut changed = bytes.clone();
        changed[at] ^= 1;
        for (what, content) in [("cut", &bytes[..at]), ("changed", &changed)] {
            let error = SceneCheckpoint::from_bytes(content).expect_err(what);
            assert_eq!(error.exit_code(), 2, "{what} at byte {at}: {error}");
            assert!(error.to_string().contains("to start the run again"), "{what} at byte {at}: {error}");
        }
    }
    let others = [
        "specimen.width_mm=22",
        "material.fracture_energy_j_m2=205",
        "model.spacing_mm=0.9",
        "model.solver=secant",
        "loading.displacement_mm=0.0061",
        "loading.steps=21",
        "loading.iterations_per_step=2",
        "loading.edges=[\"top\"]",
        "damage.law=critical_energy",
        "supports.left={fix=[\"x\"]}",
    ];
    for other in others {
        let other_scene = scene(setting, &[other]);
        assert!(!read(&bytes).belongs_to(&other_scene), "{other}");
        let error = perilife_scenes::resume(&other_scene, read(&bytes), &Silent).expect_err(other);
        assert_eq!(error.exit_code(), 2, "{other}: {error}");
        assert!(error.to_string().contains("another scene"), "{other}: {error}");
    }
    assert!(read(&bytes).belongs_to(&Scene { name: "renamed".to_owned(), ..own }));
}
