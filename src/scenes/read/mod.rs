//! A scene file to a checked [`Scene`]: each section is read by itself, then they are checked against each other.
//!
//! ```toml
//! [specimen]                  # as in a case; a plate needs no crack or notch; standard kinds lend their geometry alone
//! kind = "plate"
//! width_mm = 50.0             # with length_mm; or outline_mm, or diameter_mm: a disc about 0
//! length_mm = 50.0
//! thickness_mm = 1.0
//! cracks = [{ from_mm = [-5.0, 0.0], to_mm = [5.0, 0.0] }]
//! [material]                  # as in a case; also density_kg_m3, fracture_energy_j_m2, tensile_strength_mpa where they are asked for
//! youngs_modulus_gpa = 192.0
//! poisson_ratio = 0.3
//! density_kg_m3 = 8000.0
//! fracture_energy_j_m2 = 83000.0
//! [model]                     # optional
//! bond_law = "two_parameter"  # bond_based, two_parameter, one_bond_two_parameter, correspondence
//! kernel = "conical"          # default: conical for two_parameter, else constant
//! spacing_mm = 0.5            # default: the smaller of crack length / 9 and width / 100
//! [loading]                   # one load, or parts = [{ ... }, { ... }] with the keys of one load each
//! kind = "velocity"           # traction, displacement, velocity, platens
//! velocity_mm_s = 20000.0     # along the outward normal of the side, or along direction = [x, y]
//! edges = ["top", "bottom"]   # with grip_mm, range_mm; or regions = [{ from_mm = [x, y], to_mm = [x, y] }]
//! transverse = "free"         # or "held": the component across the motion
//! duration_s = 4e-5           # motion, with time_step_s; or steps = load steps, to rest or with iterations_per_step; neither:
//!                             # one equilibrium
//! ramp_s = 2e-6               # motion: the load rises linearly over so long; one of parts may have its own
//! from_s = 1e-6               # motion: and begins then; its points stand still before
//! [supports]                  # sides { rows_mm, range_mm, fix } or, by any other name, boxes { from_mm, to_mm, fix }
//! left = { range_mm = [-1.0, 1.0], fix = ["x"] }
//! [damage]                    # optional; default law "none"
//! law = "critical_energy"
//! calibration = "growth"      # or "bond_energy": how the critical stretch follows from fracture_energy_j_m2
//! [micro_cracks]              # optional
//! seed = 1
//! count = 60
//! regions = [{ from_mm = [-20.0, -10.0], to_mm = [20.0, -5.0] }]
//! [output]                    # optional
//! paraview = true             # also the fields of some moments, for ParaView
//! ```

mod checks;
mod damage;
mod load;
mod loading;
pub mod micro_cracks;
mod model;
mod region;

pub use load::LoadKind;
pub use model::Kinematics;
pub use region::around;

use std::path::Path;

use toml::{Table, Value};

use super::scene::{Scene, SceneLaw};
use perilife_base::error::{Result, input, input_missing};
use perilife_base::input::{Document, Folder, ForeignSections, Output, Provenance, Sections, value_at};
use perilife_base::keys::{Key, Section};
use perilife_plate::specimen::beta::KEY as BETA_FILE;
use perilife_plate::{material, specimen};
use perilife_points::refinement;

/// Sections of a scene file.
pub const SECTIONS: &[&str] =
    &["specimen", "material", "model", "loading", "supports", "damage", "refinement", "micro_cracks", "output"];

/// Sections that only a scene file has.
pub const SCENE_SECTIONS: &[&str] = &["damage", "micro_cracks"];

/// Sections of other files.
const STRANGERS: &[ForeignSections] = &[
    (&["fatigue", "stop", "fleet"], "applies only to fatigue cases", "remove the section, or run `perilife predict`"),
    (&["measured", "fit"], "applies only to calibration files", "run `perilife calibrate` on it, or remove the section"),
];

/// Sections that only a scene has, or that have other keys in it.
pub fn keys() -> Vec<(&'static str, &'static [Key])> {
    vec![
        ("model", model::ModelKeys::KEYS),
        ("loading", loading::CommonKeys::KEYS),
        ("loading.parts[]", load::LoadKeys::KEYS),
        ("damage", damage::DamageKeys::KEYS),
        ("refinement", refinement::RefinementKeys::KEYS),
        ("micro_cracks", micro_cracks::MicroCrackKeys::KEYS),
        ("supports.SIDE", region::SideKeys::KEYS),
        ("supports.BOX", region::HeldBoxKeys::KEYS),
    ]
}

impl Scene {
    /// Reads a scene file; `overrides` are `section.key=value`.
    pub fn from_file(path: &Path, overrides: &[String]) -> Result<Self> {
        Self::from_document(&Document::read(path, overrides)?)
    }

    /// Reads a scene from text; files it names lie in `folder`.
    pub fn from_toml(text: &str, name: &str, folder: impl Into<Folder>, overrides: &[String]) -> Result<Self> {
        Self::from_document(&Document::parse(text, name, folder, overrides)?)
    }

    /// Reads a scene from a parsed document, which gives errors their line.
    pub fn from_document(document: &Document) -> Result<Self> {
        read(&document.table, &document.name, &document.folder).map_err(|error| document.locate(error))
    }
}

/// Whether a file describes a fracture scene rather than a fatigue case: by a section or a kind of loading that only scenes have.
/// Displacements of cases have a maximum, or a range, and a ratio.
pub fn is_scene(table: &Table) -> bool {
    const OF_CYCLES: [&str; 3] = ["displacement_max_mm", "displacement_range_mm", "stress_ratio"];
    let loading = table.get("loading").and_then(Value::as_table);
    let is_of_cycles = loading.is_some_and(|loading| OF_CYCLES.iter().any(|key| loading.contains_key(*key)));
    let kind = loading.and_then(|loading| loading.get("kind")).and_then(Value::as_str).filter(|_| !is_of_cycles);
    SCENE_SECTIONS.iter().any(|section| table.contains_key(*section))
        || loading.is_some_and(|loading| loading.contains_key("parts"))
        || kind.is_some_and(|kind| kind.parse::<LoadKind>().is_ok())
}

fn read(table: &Table, name: &str, folder: &Folder) -> Result<Scene> {
    let sections = Sections::of(table, SECTIONS, STRANGERS)?;
    let echo = sections.echo()?;
    let mut warnings = Vec::new();
    let mut specimen = specimen::from_value(sections.required("specimen")?, folder, &mut warnings)?;
    if value_at(sections.required("specimen")?, "beta_file").is_some() {
        return Err(input_missing(BETA_FILE, "gives K, which fracture scenes do not use", "remove it"));
    }
    if !specimen.is_through() {
        let problem = "part-through cracks are not supported in fracture scenes";
        return Err(input("specimen.kind", format!("\"{}\"", specimen.kind), problem, "use a through crack"));
    }
    // The standard kinds serve as geometry: their loads and grips belong to fatigue tests.
    specimen.loads.clear();
    specimen.supports.clear();
    let material = material::from_value(sections.required("material")?, folder, &mut warnings)?;
    let loading = loading::from_value(sections.required("loading")?, &mut specimen)?;
    let holds = region::supports(sections.optional("supports"), &specimen)?;
    let model = model::from_value(sections.optional("model"), &specimen, &material, &loading.procedure)?;
    let damage = damage::from_value(sections.optional("damage"), &material)?;
    let refinement = sections.given("refinement").map(|value| refinement::from_value(value, &specimen)).transpose()?;
    if sections.given("damage").is_some() && !matches!(model.law, SceneLaw::Correspondence { .. }) {
        damage::refuse_entry(sections.optional("damage"))?;
    }
    let mut scene = Scene {
        name: name.to_owned(),
        specimen,
        material,
        model,
        drives: loading.drives,
        holds,
        damage,
        procedure: loading.procedure,
        refinement,
        output: read_output(sections.optional("output"))?,
        warnings,
        echo,
        provenance: Provenance::default(),
    };
    checks::check(&scene)?;
    checks::settle_balance(&mut scene)?;
    if let Some(value) = sections.given("micro_cracks") {
        micro_cracks::put_in(value, &mut scene)?;
    }
    let lines = checks::lines(&scene);
    scene.warnings.extend(lines);
    scene.provenance = folder.opened().so_far();
    Ok(scene)
}

/// `[output]` of a scene, which has no cycles over which cracks would be shown to grow.
fn read_output(value: &Value) -> Result<Output> {
    let output = Output::from_value(value)?;
    if output.animation {
        return Err(input("output.animation", true, "applies only to fatigue cases", "remove it; use paraview = true"));
    }
    Ok(output)
}
