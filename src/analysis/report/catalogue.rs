//! Every kind of every key of the input files.

use serde_json::{Value, json};

use crate::bond_law::{BondLawKind, Kernel, Rotation, SurfaceCorrection};
use crate::calibration::criterion::Criterion;
use crate::calibration::exponent::Parameter;
use crate::calibration::laws::FitLaw;
use crate::calibration::rates::RateMethod;
use crate::case::record::Estimate;
use crate::case::{Failure, LIBRARY, Lot, Method};
use crate::element_free::basis::{BasisKind, Enrichment};
use crate::fatigue::crack_tip::TipState;
use crate::fatigue::growth_law::GrowthLawKind;
use crate::fatigue::growth_law::description::Constant;
use crate::fatigue::growth_law::table::TableEnds;
use crate::fatigue::retardation::{Constant as Retarding, RetardationKind};
use crate::fatigue::{Ageing, Driver};
use crate::fracture::SceneEnd;
use crate::fracture::read::{Kinematics, LoadKind};
use crate::fracture::scene::{Calibration, DamageEntry, DamageLaw, Discretisation, PointLaw, SceneSolver, ZeroEnergyControl};
use crate::input::{Folder, Quantity};
use crate::kinds::KindLine;
use crate::loading::spectrum::SpectrumFormat;
use crate::loading::{Grip, LoadingKind, Transverse};
use crate::material::growth_data::{self, GrowthRecord};
use crate::material::{Plane, library};
use crate::measured::{CycleUnit, Decimal, IntensityUnit, LengthUnit, LoadUnit, RangeKind, RateUnit};
use crate::predict::StopReason;
use crate::predict::tip_factors::StressIntensityMethod;
use crate::solver::{SolverKind, SolverUsed, Symmetry};
use crate::specimen::beta;
use crate::specimen::drawing::{DrawingUnit, SymmetryPlane};
use crate::specimen::{Component, Edge, Ends, Head, SpecimenKind};
use crate::sweep::{DesignKind, DistributionKind, Scale, Scatter};
use crate::units::shown::told;
use crate::units::us::System;
use crate::verify::TOPICS;
use crate::verify::chart::{Family, SCENES, Status};
use crate::verify::stability::SWEEPS;

/// Every line, in the order of an input file: key, name, meaning.
pub fn lines() -> Vec<(String, String, String)> {
    let of_the_test = [
        SpecimenKind::lines(),
        DrawingUnit::lines(),
        SymmetryPlane::lines(),
        Ends::lines(),
        Head::lines(),
        Plane::lines(),
        LoadingKind::lines(),
        SpectrumFormat::lines(),
        RetardationKind::lines(),
        LoadKind::lines(),
        Grip::lines(),
        Edge::lines(),
        Transverse::lines(),
        Component::lines(),
    ];
    let of_the_model = [
        Method::lines(),
        BasisKind::lines(),
        Enrichment::lines(),
        BondLawKind::lines(),
        PointLaw::lines(),
        ZeroEnergyControl::lines(),
        Kernel::lines(),
        Rotation::lines(),
        SurfaceCorrection::lines(),
        Kinematics::lines(),
        Discretisation::lines(),
        Symmetry::lines(),
        SolverKind::lines(),
        beside(&SolverKind::lines(), SceneSolver::lines()),
        DamageLaw::lines(),
        Calibration::lines(),
        DamageEntry::lines(),
        Driver::lines(),
        GrowthLawKind::lines(),
        TableEnds::lines(),
        Ageing::lines(),
        Failure::lines(),
        Lot::lines(),
    ];
    let of_calibration = [
        Parameter::lines(),
        Criterion::lines(),
        FitLaw::lines(),
        System::lines(),
        LengthUnit::lines(),
        CycleUnit::lines(),
        LoadUnit::lines(),
        IntensityUnit::lines(),
        RateUnit::lines(),
        RangeKind::lines(),
        Decimal::lines(),
        Estimate::lines(),
        RateMethod::lines(),
        SolverUsed::lines(),
        StopReason::lines(),
        TipState::lines(),
        beside(&StopReason::lines(), SceneEnd::lines()),
    ];
    let of_sweeps = [DesignKind::lines(), Scatter::lines(), Scale::lines(), DistributionKind::lines()];
    let of_the_tips = StressIntensityMethod::lines();
    let words = |line: KindLine| (line.key.to_owned(), line.name.to_owned(), line.meaning.to_owned());
    let mut all: Vec<_> = of_the_test.into_iter().flatten().map(words).collect();
    all.extend(library::names().into_iter().map(|name| {
        let meaning = library::find(&name, &Folder::none()).map_or_else(
            |error| error.to_string(),
            |file| told(&format!("{}; E {} GPa, nu {}", file.title, file.youngs_modulus_gpa.value, file.poisson_ratio.value)),
        );
        ("material.name".to_owned(), name, meaning)
    }));
    let record =
        |record: GrowthRecord| ("material.name".to_owned(), record.name.clone(), format!("{}; with growth data", record.title()));
    all.extend(growth_data::records().into_iter().map(record));
    all.extend(of_the_model.into_iter().flatten().map(words));
    all.push((
        GrowthLawKind::KEY.to_owned(),
        LIBRARY.to_owned(),
        "the growth data of the material that material.name names".to_owned(),
    ));
    all.push((
        "specimen.outline_file".to_owned(),
        "part.dxf".to_owned(),
        "a plate from a drawing, DXF or SVG: layers outline, holes (full circles), cracks".to_owned(),
    ));
    all.push((
        beta::KEY.to_owned(),
        "beta.csv".to_owned(),
        "K = β σ √(πa) by a table crack_length_mm,beta, for hand calculation; `perilife sif --sweep` writes one".to_owned(),
    ));
    all.push(("output.animation".to_owned(), "true".to_owned(), "also growth.svg: the cracks as they grow".to_owned()));
    all.push(("output.paraview".to_owned(), "true".to_owned(), "also the fields of some moments, for ParaView".to_owned()));
    all.extend(of_calibration.into_iter().flatten().map(words));
    all.extend(of_sweeps.into_iter().flatten().map(words));
    all.extend(of_the_tips.into_iter().map(words));
    all.extend(TOPICS.iter().map(|topic| ("verify NAME".to_owned(), topic.name.to_owned(), topic.about.to_owned())));
    all.extend(SCENES.iter().map(|scene| ("chart SCENE".to_owned(), scene.name.to_owned(), scene.about.to_owned())));
    all.extend([Family::lines(), Status::lines()].into_iter().flatten().map(words));
    all.extend(SWEEPS.iter().map(|sweep| ("stability NAME".to_owned(), sweep.name.to_owned(), sweep.about.to_owned())));
    all
}

/// The same as one object, with the constants of every growth law and model of retardation: keys of `[fatigue]` and `[loading]`, units, and whether a
/// case has to give them.
pub fn json() -> Value {
    let kinds = lines().into_iter().map(|(key, name, meaning)| json!({ "key": key, "name": name, "meaning": meaning }));
    let constant = |key: &str, quantity: &Quantity, needed: bool| json!({ "key": key, "unit": quantity.unit, "what": quantity.what, "needed": needed });
    let law = |law: GrowthLawKind| {
        let of_law = |own: &Constant| constant(own.key, &own.quantity, own.default.is_none());
        json!({ "name": law.name(), "meaning": law.meaning(), "constants": law.0.constants.iter().map(of_law).collect::<Vec<_>>() })
    };
    let retardation = |model: RetardationKind| {
        // A threshold of the law, which it may have, stands for a constant.
        let of_model = |own: &Retarding| constant(own.key, &own.quantity, (own.default)(Plane::Stress, Some(1.0)).is_none());
        let constants: Vec<Value> = model.0.constants.iter().map(of_model).collect();
        json!({ "name": model.name(), "meaning": model.meaning(), "constants": constants })
    };
    json!({
        "kinds": kinds.collect::<Vec<_>>(),
        "laws": GrowthLawKind::all().map(law).collect::<Vec<_>>(),
        "retardations": RetardationKind::all().map(retardation).collect::<Vec<_>>(),
    })
}

/// The lines of a second choice for a key that do not stand in the first one already.
fn beside(first: &[KindLine], second: Vec<KindLine>) -> Vec<KindLine> {
    second.into_iter().filter(|line| first.iter().all(|known| (known.key, known.name) != (line.key, line.name))).collect()
}
