//! A scene taken up from any of its checkpoints gives what the undisturbed scene gives, bit for bit.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;

use perilife_growth::predict::Silent;
use perilife_scenes::checkpoint::SceneCheckpoint;
use perilife_scenes::outcome::SceneFigures;
use perilife_scenes::{Fracture, Scene, SceneObserver, SceneProgress};

use crate::support::rows::rows;

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

/// Name; `[specimen]`; `[material]`; `[model]`; `[loading]`; more of it; `[damage]`.
type Setting = [String; 7];

/// One scene or more of every procedure, law and law of damage that remember different things. All of them break bonds.
fn settings() -> Vec<Setting> {
    rows("scene_checkpoint", "settings")
}

fn scene(setting: &Setting, set: &[&str]) -> Scene {
    let texts: BTreeMap<String, String> = rows("scene_checkpoint", "texts");
    let [name, specimen, material, model, loading, more, damage] = setting.each_ref().map(|part| texts.get(part).unwrap_or(part));
    let text = format!(
        "[specimen]\n{specimen}[material]\n{material}[model]\n{model}\nspacing_mm=1\n[loading]\n{loading}{more}\n[damage]\n{damage}\n"
    );
    let set: Vec<String> = set.iter().map(|key| (*key).to_owned()).collect();
    Scene::from_toml(&text, name, Path::new("."), &set).unwrap_or_else(|error| panic!("{name}: {error}"))
}

#[test]
fn a_scene_taken_up_is_the_undisturbed_one() {
    for (number, setting) in settings().iter().enumerate() {
        let (name, scene) = (&setting[0], scene(setting, &[]));
        let keeping = Keeping::default();
        let whole = perilife_scenes::run(&scene, &keeping).unwrap();
        let kept = keeping.kept();
        let last = *whole.history.last().unwrap();
        assert!(kept.len() >= 3 && last.broken_bonds > 0, "{name}: nothing to take up, so this scene tests nothing");
        // One that keeps nothing goes the same way.
        if number % 3 == 0 {
            assert!(text(&perilife_scenes::run(&scene, &Silent).unwrap()) == text(&whole), "{name}: it matters who watches");
        }
        // Also where bonds break in the very next row: what was looked back at shows only there.
        let rows = &whole.history;
        let breaks_next = |at: &usize| {
            let row = rows.iter().position(|row| row.step == read(&kept[*at]).kept.step()).unwrap();
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
    let setting = &settings()[4];
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
    let others = "specimen.width_mm=22 material.fracture_energy_j_m2=205 model.spacing_mm=0.9 model.solver=secant \
                  loading.displacement_mm=0.0061 loading.steps=21 loading.iterations_per_step=2 loading.edges=[\"top\"] \
                  damage.law=critical_energy supports.left={fix=[\"x\"]}";
    for other in others.split_whitespace() {
        let other_scene = scene(setting, &[other]);
        assert!(!read(&bytes).belongs_to(&other_scene), "{other}");
        let error = perilife_scenes::resume(&other_scene, read(&bytes), &Silent).expect_err(other);
        assert_eq!(error.exit_code(), 2, "{other}: {error}");
        assert!(error.to_string().contains("another scene"), "{other}: {error}");
    }
    assert!(read(&bytes).belongs_to(&Scene { name: "renamed".to_owned(), ..own }));
}
