"""Sections of input files as dicts (written by a test from the keys of the program)."""

from __future__ import annotations

from typing import TYPE_CHECKING, Literal, TypedDict

if TYPE_CHECKING:
    from typing_extensions import Required


class SpecimenMiddleTension(TypedDict, total=False):
    kind: Literal["middle_tension"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; needed
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_length_mm: float  # Initial crack length a: half of a central crack, that of each edge crack; needed
    crack_length_in: float
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenSingleEdgeTension(TypedDict, total=False):
    kind: Literal["single_edge_tension"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; needed
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_length_mm: float  # Initial crack length a: half of a central crack, that of each edge crack; needed
    crack_length_in: float
    ends: Required[Literal["pinned", "clamped", "uniform_stress"]]  # Ends: clamped, pinned or under uniform stress; needed
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenDoubleEdgeTension(TypedDict, total=False):
    kind: Literal["double_edge_tension"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; needed
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_length_mm: float  # Initial crack length a: half of a central crack, that of each edge crack; needed
    crack_length_in: float
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenCompactTension(TypedDict, total=False):
    kind: Literal["compact_tension"]
    width_mm: float  # Width W: from the load line to the back face; needed
    width_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_length_mm: float  # Initial crack length a: from the load line; needed
    crack_length_in: float
    pin_half_angle_deg: float  # Half angle of the contact arc, °: 90 for a close-fitting pin; -
    pin_diameter_mm: float  # Pin diameter: its clearance sets the contact arc; -
    pin_diameter_in: float
    pin_friction: float  # Friction of the pin: 0 only; -
    pin_youngs_modulus_gpa: float  # Young's modulus of the pin; 210 (steel)
    pin_youngs_modulus_msi: float
    pin_poisson_ratio: float  # Poisson's ratio of the pin; 0.3 (steel)
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenPlateHoles(TypedDict, total=False):
    x_mm: float  # Hole center, x; needed
    x_in: float
    y_mm: float  # Hole center, y; needed
    y_in: float
    diameter_mm: float  # Hole diameter; needed
    diameter_in: float


class SpecimenPlateCracks(TypedDict, total=False):
    from_mm: tuple[float, float]  # One end: [x, y]; -
    from_in: tuple[float, float]
    to_mm: tuple[float, float]  # Other end: [x, y]; -
    to_in: tuple[float, float]
    path_mm: list[tuple[float, float]]  # Corners of a kinked crack: both ends included; -
    path_in: list[tuple[float, float]]


class SpecimenPlateNotches(TypedDict, total=False):
    from_mm: tuple[float, float]  # One end: [x, y]; needed
    from_in: tuple[float, float]
    to_mm: tuple[float, float]  # Other end: [x, y]; needed
    to_in: tuple[float, float]
    width_mm: float  # Width across; needed
    width_in: float


class SpecimenPlate(TypedDict, total=False):
    kind: Literal["plate"]
    outline_mm: list[tuple[float, float]]  # Outline: corners in order; one key of the outline
    outline_in: list[tuple[float, float]]
    outline_file: str  # Drawing of the plate: DXF with layers outline, holes (full circles), cracks; one key of the outline
    outline_unit: Literal["mm", "inch"]  # Unit of the drawing: where the file has none; -
    outline_symmetry: Literal["x=0", "y=0"]  # Symmetry of the drawing: half of the plate drawn; -
    width_mm: float  # Width W: of a rectangle about 0, with its length; one key of the outline
    width_in: float
    length_mm: float  # Length L: of a rectangle about 0, along y; -
    length_in: float
    diameter_mm: float  # Diameter: of a disc about 0; one key of the outline
    diameter_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    holes: list[SpecimenPlateHoles]  # Circular holes; none
    cracks: list[SpecimenPlateCracks]  # Cracks: straight or kinked; none
    notches: list[SpecimenPlateNotches]  # Notches: straight slots with square ends; none
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenSurfaceCrackHoles(TypedDict, total=False):
    x_mm: float  # Hole center, x; needed
    x_in: float
    y_mm: float  # Hole center, y; needed
    y_in: float
    diameter_mm: float  # Hole diameter; needed
    diameter_in: float


class SpecimenSurfaceCrack(TypedDict, total=False):
    kind: Literal["surface_crack"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; default 3 W; -
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_depth_mm: float  # Crack depth a: into the thickness; needed
    crack_depth_in: float
    crack_half_length_mm: float  # Surface length c: half length where both ends are on the surface; needed
    crack_half_length_in: float
    holes: list[SpecimenSurfaceCrackHoles]  # Further holes of the plate; none


class SpecimenCornerCrackHoles(TypedDict, total=False):
    x_mm: float  # Hole center, x; needed
    x_in: float
    y_mm: float  # Hole center, y; needed
    y_in: float
    diameter_mm: float  # Hole diameter; needed
    diameter_in: float


class SpecimenCornerCrack(TypedDict, total=False):
    kind: Literal["corner_crack"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; default 3 W; -
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_depth_mm: float  # Crack depth a: into the thickness; needed
    crack_depth_in: float
    crack_half_length_mm: float  # Surface length c: half length where both ends are on the surface; needed
    crack_half_length_in: float
    holes: list[SpecimenCornerCrackHoles]  # Further holes of the plate; none


class SpecimenEmbeddedCrackHoles(TypedDict, total=False):
    x_mm: float  # Hole center, x; needed
    x_in: float
    y_mm: float  # Hole center, y; needed
    y_in: float
    diameter_mm: float  # Hole diameter; needed
    diameter_in: float


class SpecimenEmbeddedCrack(TypedDict, total=False):
    kind: Literal["embedded_crack"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; default 3 W; -
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_depth_mm: float  # Crack depth a: into the thickness; needed
    crack_depth_in: float
    crack_half_length_mm: float  # Surface length c: half length where both ends are on the surface; needed
    crack_half_length_in: float
    holes: list[SpecimenEmbeddedCrackHoles]  # Further holes of the plate; none


class SpecimenCornerCrackAtHoleHoles(TypedDict, total=False):
    x_mm: float  # Hole center, x; needed
    x_in: float
    y_mm: float  # Hole center, y; needed
    y_in: float
    diameter_mm: float  # Hole diameter; needed
    diameter_in: float


class SpecimenCornerCrackAtHole(TypedDict, total=False):
    kind: Literal["corner_crack_at_hole"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; default 3 W; -
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_depth_mm: float  # Crack depth a: into the thickness; needed
    crack_depth_in: float
    crack_half_length_mm: float  # Surface length c: half length where both ends are on the surface; needed
    crack_half_length_in: float
    holes: list[SpecimenCornerCrackAtHoleHoles]  # Further holes of the plate; none
    hole_diameter_mm: float  # Hole diameter; needed
    hole_diameter_in: float
    cracks: Required[int]  # Cracks at the hole: 1 or 2 sides; needed


class SpecimenCrackAtHole(TypedDict, total=False):
    kind: Literal["crack_at_hole"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; needed
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    hole_diameter_mm: float  # Hole diameter; needed
    hole_diameter_in: float
    hole_offset_mm: float  # Hole center: distance from the midline, across the load; 0
    hole_offset_in: float
    crack_length_mm: float  # Initial crack length a: from the hole edge; one key of the length of the cracks
    crack_length_in: float
    cracks: int  # Cracks at the hole: 1 (right) or 2; default 1; -
    crack_lengths_mm: tuple[float, float]  # Crack lengths: left and right from the hole edge, 0 for no crack; one key of the length of the cracks
    crack_lengths_in: tuple[float, float]
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenRowOfHoles(TypedDict, total=False):
    kind: Literal["row_of_holes"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; needed
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    holes: Required[int]  # Holes: in one row across the load; needed
    pitch_mm: float  # Pitch: between hole centers; needed
    pitch_in: float
    hole_diameter_mm: float  # Hole diameter; needed
    hole_diameter_in: float
    crack_length_mm: float  # Initial crack length a: from the hole edge; one key of the length of the cracks
    crack_length_in: float
    crack_lengths_mm: list[tuple[float, float]]  # Crack lengths: [left, right] of every hole, 0 for no crack; one key of the length of the cracks
    crack_lengths_in: list[tuple[float, float]]


class SpecimenLug(TypedDict, total=False):
    kind: Literal["lug"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: from the hole center to the clamped end; needed
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    hole_diameter_mm: float  # Hole diameter; needed
    hole_diameter_in: float
    head: Required[Literal["straight", "round"]]  # Head: end beyond the hole; needed
    edge_distance_mm: float  # Edge distance: of a straight head, from the hole center; default W/2; -
    edge_distance_in: float
    crack_length_mm: float  # Initial crack length a: from the hole edge; one key of the length of the cracks
    crack_length_in: float
    cracks: int  # Cracks at the hole: 1 (right) or 2; default 1; -
    crack_lengths_mm: tuple[float, float]  # Crack lengths: left and right from the hole edge, 0 for no crack; one key of the length of the cracks
    crack_lengths_in: tuple[float, float]
    pin_half_angle_deg: float  # Half angle of the contact arc, °: 90 for a close-fitting pin; -
    pin_diameter_mm: float  # Pin diameter: its clearance sets the contact arc; -
    pin_diameter_in: float
    pin_friction: float  # Friction of the pin: 0 only; -
    pin_youngs_modulus_gpa: float  # Young's modulus of the pin; 210 (steel)
    pin_youngs_modulus_msi: float
    pin_poisson_ratio: float  # Poisson's ratio of the pin; 0.3 (steel)
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenEdgeNotch(TypedDict, total=False):
    kind: Literal["edge_notch"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; needed
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    notch_depth_mm: float  # Depth of the notch: from the edge to the root; needed
    notch_depth_in: float
    notch_radius_mm: float  # Radius of the root: half circle that ends the notch; needed
    notch_radius_in: float
    crack_length_mm: float  # Initial crack length a: from the notch root; default no crack; -
    crack_length_in: float
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenStopHole(TypedDict, total=False):
    kind: Literal["stop_hole"]
    width_mm: float  # Width W; needed
    width_in: float
    length_mm: float  # Length L: along the load; needed
    length_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    stopped_crack_length_mm: float  # Stopped crack: half length, to the hole centers; needed
    stopped_crack_length_in: float
    hole_diameter_mm: float  # Hole diameter; needed
    hole_diameter_in: float
    formed_length_mm: float  # Crack length after initiation: from the hole edges; needed
    formed_length_in: float


class SpecimenSingleEdgeBend(TypedDict, total=False):
    kind: Literal["single_edge_bend"]
    width_mm: float  # Width W; needed
    width_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_length_mm: float  # Initial crack length a: from the edge; needed
    crack_length_in: float
    span_mm: float  # Span: of the outer rollers; 4 W
    span_in: float
    inner_span_mm: float  # Inner span: between two rollers; default one roller at midspan; -
    inner_span_in: float
    length_mm: float  # Length L: of the beam; span + W/2
    length_in: float
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenEccentricSingleEdgeTension(TypedDict, total=False):
    kind: Literal["eccentric_single_edge_tension"]
    width_mm: float  # Width W: from the edge (ESE(T)) or the load line (WOL); needed
    width_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_length_mm: float  # Initial crack length a: from the same line as W; needed
    crack_length_in: float
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenWedgeOpening(TypedDict, total=False):
    kind: Literal["wedge_opening"]
    width_mm: float  # Width W: from the edge (ESE(T)) or the load line (WOL); needed
    width_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_length_mm: float  # Initial crack length a: from the same line as W; needed
    crack_length_in: float
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class SpecimenCruciform(TypedDict, total=False):
    kind: Literal["cruciform"]
    length_mm: float  # Length L: end to end of two arms; needed
    length_in: float
    arm_width_mm: float  # Width of an arm; needed
    arm_width_in: float
    fillet_radius_mm: float  # Radius of the inner corners; needed
    fillet_radius_in: float
    thickness_mm: float  # Thickness B; needed
    thickness_in: float
    crack_length_mm: float  # Initial crack length a: half length; needed
    crack_length_in: float
    crack_angle_deg: float  # Angle of the crack, °: against x; 0
    beta_file: str  # Table of β: K = β σ √(πa), CSV of crack_length_mm and beta; `perilife sif --sweep` writes one; -


class Material(TypedDict, total=False):
    name: str  # Material: a name of `perilife list materials`, or the path of your own .toml file; -
    youngs_modulus_gpa: float  # Young's modulus E; -
    youngs_modulus_msi: float
    poisson_ratio: float  # Poisson's ratio ν; -
    yield_strength_mpa: float  # Yield strength σY; -
    yield_strength_ksi: float
    toughness_mpa_sqrt_m: float  # Fracture toughness K_c: at this thickness; -
    toughness_ksi_sqrt_in: float
    fracture_energy_j_m2: float  # Fracture energy: of scenes; -
    fracture_energy_lbf_in: float
    density_kg_m3: float  # Density: of scenes with inertia; -
    density_lb_in3: float
    tensile_strength_mpa: float  # Tensile strength: of scenes; -
    tensile_strength_ksi: float
    plane: Literal["stress", "strain"]  # Plane state; stress


class LoadingPins(TypedDict, total=False):
    hole: Required[int]  # Hole: counted from 0 in specimen.holes; needed
    direction: Required[tuple[float, float]]  # Direction: [x, y] of the force on the plate; needed
    share: float  # Share of the force: default 1; -
    bearing_ratio: float  # Bearing stress P/(d h) over the remote stress: with loaded edges; -
    contact_half_angle_deg: float  # Half angle of the contact arc, °: 90 for a close-fitting pin; -
    pin_diameter_mm: float  # Pin diameter: its clearance sets the contact arc; -
    pin_diameter_in: float
    friction: float  # Friction of the pin: 0 only; -
    pin_youngs_modulus_gpa: float  # Young's modulus of the pin; 210 (steel)
    pin_youngs_modulus_msi: float
    pin_poisson_ratio: float  # Poisson's ratio of the pin; 0.3 (steel)


class LoadingRollers(TypedDict, total=False):
    at_mm: tuple[float, float]  # Contact center: [x, y] on the outline; needed
    at_in: tuple[float, float]
    contact_width_mm: float  # Width of the contact; needed
    contact_width_in: float
    direction: tuple[float, float]  # Direction: [x, y] of the force; default normal to the outline; -
    share: float  # Share of the force; 1


class Loading(TypedDict, total=False):
    kind: Literal["constant_amplitude", "spectrum", "displacement"]  # Kind of cycles; constant_amplitude
    stress_max_mpa: object  # Maximum stress σmax: gross section; one key of one load
    stress_max_ksi: object
    stress_range_mpa: object  # Stress range Δσ: gross section, maximum − minimum; one key of one load
    stress_range_ksi: object
    force_max_n: object  # Maximum force Pmax; one key of one load
    force_max_lbf: object
    force_range_n: object  # Force range ΔP: maximum − minimum; one key of one load
    force_range_lbf: object
    force_max_kn: object  # Maximum force Pmax; one key of one load
    force_max_kip: object
    force_range_kn: object  # Force range ΔP: maximum − minimum; one key of one load
    force_range_kip: object
    displacement_max_mm: float  # Maximum displacement δ_max: relative, of the loaded sides; one key of one load; with kind = displacement
    displacement_max_in: float
    displacement_range_mm: float  # Displacement range Δδ: relative, of the loaded sides; one key of one load; with kind = displacement
    displacement_range_in: float
    spectrum_scale_mpa: float  # Scale of the spectrum: gross stress of the value 1; one key of one load; with kind = spectrum
    spectrum_scale_ksi: float
    spectrum_scale_n: float  # Scale of the spectrum: force of the value 1; one key of one load; with kind = spectrum
    spectrum_scale_lbf: float
    stress_ratio: float  # Stress ratio R: minimum / maximum, below 1; -
    grip: Literal["straight", "mean"]  # Grip: of moved edges; straight; with kind = displacement
    transverse: Literal["free", "held"]  # Motion across the displacement; free; with kind = displacement
    crack_pressure_mpa: float  # Crack-face pressure: at maximum load; -
    crack_pressure_ksi: float
    spectrum_file: str  # File of the spectrum: CSV, workbook, .spx, .sub or FASTRAN; with kind = spectrum
    spectrum_format: Literal["cycles", "turning_points", "spx", "sub", "fastran"]  # Format of the spectrum: default by name and content; with kind = spectrum
    omission_percent: float  # Omission level, % of the largest range; 0; with kind = spectrum
    truncation_percent: float  # High-load truncation, % of the largest peak; 100; with kind = spectrum
    repeats: float  # Number of passes; with kind = spectrum
    residual_stress: object  # Residual stress: formula of x and y, mm, in MPa; one key of the residual stress
    residual_stress_mpa: object  # Residual stress: formula of x and y, mm, in MPa; one key of the residual stress
    residual_stress_ksi: object  # Residual stress: formula of x and y, inch, in ksi; one key of the residual stress
    residual_stress_file: str  # File of residual stress: columns x_mm, y_mm, stress_mpa; one key of the residual stress
    stress_parallel_ratio: float  # Biaxiality: stress along the crack over stress across it; 0
    bending_ratio: float  # Out-of-plane bending: bending stress over tension, of part-through cracks; -
    edge_bending_ratio: object  # In-plane bending of loaded edges: bending stress over mean stress, or "pure"; -
    edges: list[Literal["top", "bottom", "left", "right"]]  # Loaded sides; -
    direction: object  # Direction of the stress on edges: [x, y], or one for each of them; -
    pins: list[LoadingPins]  # Pins: in holes of the plate; -
    rollers: list[LoadingRollers]  # Rollers: on the outline of the plate; -
    retardation: Literal["none", "wheeler", "willenborg", "closure", "newman"]  # Retardation: load interaction of a spectrum; default none; -
    wheeler_exponent: float  # Wheeler exponent m; -
    shutoff_ratio: float  # shut-off ratio S; -
    willenborg_k_th_mpa_sqrt_m: float  # threshold K_max at R = 0; -
    willenborg_k_th_ksi_sqrt_in: float
    closure_cf0: float  # closure factor Cf0; -
    newman_alpha: float  # constraint factor α; -
    newman_smax_over_flow: float  # ratio Smax/flow stress; -


class Model(TypedDict, total=False):
    method: Literal["auto", "peridynamics", "element_free_galerkin", "handbook"]  # Method; auto
    spacing_mm: float  # Spacing: of points, or of nodes far from cracks; -
    spacing_in: float
    symmetry: Literal["auto", "off"]  # Symmetry: model half or a quarter of the plate; with method = peridynamics, handbook
    bond_law: Literal["bond_based", "two_parameter", "one_bond_two_parameter", "state_based"]  # Bond law: default by Poisson's ratio; with method = peridynamics, handbook
    kernel: Literal["constant", "conical"]  # Kernel: weight of bonds over their length; with method = peridynamics, handbook
    rotation: Literal["free", "resisted"]  # Rotation: free or resisted rigid rotation of bonds; with method = peridynamics, handbook
    surface_correction: Literal["none", "volume_and_surface", "balanced"]  # Surface correction: at the boundary; with method = peridynamics, handbook
    horizon_ratio: float  # Horizon ratio: horizon over spacing; default 3.015; with method = peridynamics, handbook
    lattice_angle_deg: float  # Lattice angle, °: of rows of points against x; with method = peridynamics, handbook
    solver: Literal["window", "multigrid"]  # Solver; with method = peridynamics, handbook
    nodes: float  # Number of nodes: far from cracks; with method = element_free_galerkin
    tolerance_percent: float  # Target accuracy, % of life; 2; with method = element_free_galerkin, handbook
    basis: Literal["linear", "quadratic"]  # Basis: polynomials of the nodes; with method = element_free_galerkin
    enrichment: Literal["tip", "intrinsic", "none"]  # Enrichment: functions of the tips; with method = element_free_galerkin
    influence_radius: float  # Radius of influence: of a node, in spacings; with method = element_free_galerkin


class FatigueInitiation(TypedDict, total=False):
    range_mpa: float  # Range Δσ_D: local stress range at one point of the S-N line; needed
    range_ksi: float
    cycles: Required[float]  # Cycles N_D: at the same point; needed
    slope: Required[float]  # Slope k: of log N over −log Δσ; needed
    limit_mpa: float  # Fatigue limit: local stress range without initiation; none
    limit_ksi: float


class Fatigue(TypedDict, total=False):
    driver: Literal["tip_field", "bond_strain"]  # Driver: of crack growth; -
    ageing: Literal["crack_tip", "everywhere"]  # Ageing: bonds that lose life; with driver = bond_strain
    zone_radius_horizons: float  # Zone of ageing bonds, horizons; with driver = bond_strain
    step_error_percent: float  # Error of an increment, %; -
    critical_stretch: float  # Critical stretch: beyond which a bond breaks at once; with driver = bond_strain
    walker_gamma: float  # Walker exponent γ: effect of the stress ratio; -
    delta_k_threshold_mpa_sqrt_m: float  # Threshold ΔK_th: no growth below; 0 for none; -
    delta_k_threshold_ksi_sqrt_in: float
    allow_extrapolation: bool  # Extrapolation: of a fitted law outside its range; false
    lot: Literal["same", "other"]  # Lot of material: against that of the tests; same
    initiation: FatigueInitiation  # Initiation life: S-N law of the local stress, phase I; -
    failure: Literal["stretch"]  # Failure: criterion of bonds; -
    fitted: str  # Fitted law: file that `perilife calibrate` wrote; -
    growth_law: Literal["bond_law", "paris", "walker", "forman", "nasgro", "table", "library"]  # Growth law: default by the constants given; -
    a: float  # bond constant A; -
    p: float  # bond exponent p; -
    horizon_mm: float  # horizon of A; -
    horizon_in: float
    paris_c_mm_per_cycle: float  # Paris C; -
    paris_c_in_per_cycle: float
    paris_m: float  # Paris exponent m; -
    forman_c_mm_per_cycle: float  # Forman C; -
    forman_c_in_per_cycle: float
    forman_m: float  # Forman exponent m; -
    k_c_mpa_sqrt_m: float  # fracture toughness Kc; -
    k_c_ksi_sqrt_in: float
    nasgro_c_mm_per_cycle: float  # NASGRO C; -
    nasgro_c_in_per_cycle: float
    nasgro_n: float  # NASGRO exponent n; -
    nasgro_p: float  # threshold exponent p; -
    nasgro_q: float  # fracture exponent q; -
    nasgro_alpha: float  # constraint factor α; -
    nasgro_smax_over_flow: float  # ratio Smax/σ0; -
    nasgro_delta_k_0_mpa_sqrt_m: float  # threshold ΔK0 at R = 0; -
    nasgro_delta_k_0_ksi_sqrt_in: float
    nasgro_c_th: float  # threshold slope Cth over R; -
    nasgro_c_th_negative: float  # threshold slope Cth over R; -
    growth_table: str  # Table of rates: its file; -
    growth_table_ends: Literal["refused", "held"]  # Ends of the table: beyond its rows; default refused; -


class Stop(TypedDict, total=False):
    crack_length_mm: float  # Final crack length; -
    crack_length_in: float
    crack_depth_mm: float  # Final crack depth: of a part-through crack; -
    crack_depth_in: float
    at_break_through: bool  # Stop at breakthrough: of a part-through crack; -
    cycles_max: float  # Maximum cycles: run-out; 1e9
    required_strength_mpa: float  # Required strength: gross stress; one key of the load
    required_strength_ksi: float
    limit_load_factor: float  # Required load: over the maximum load of the cycles; one key of the load
    toughness: bool  # Fracture ends the life; true
    net_section: bool  # Net-section yield ends the life; true


class FleetInitialLengthMm(TypedDict, total=False):
    median: float  # Median: of a normal logarithm; -
    standard_deviation_ln: float  # Standard deviation of ln; -
    mean: float  # Mean: of a normal distribution above zero; -
    standard_deviation: float  # Standard deviation; -


class Fleet(TypedDict, total=False):
    plates: int  # Plates: how many; 1000
    seed: int  # Seed of all draws; 0
    initial_length_mm: FleetInitialLengthMm  # Initial crack length: distribution; default that of the case; -
    initial_length_in: FleetInitialLengthMm
    load_scatter: float  # Scatter of the load: standard deviation over the load; 0


class Output(TypedDict, total=False):
    paraview: bool  # ParaView files: fields at several stages; false
    animation: bool  # Animation: growth.svg of the growing cracks; false
    tables_only: bool  # Tables only: no pictures; false


class SupportsTop(TypedDict, total=False):
    rows_mm: float  # Depth of the support: from the side into the plate; one row
    rows_in: float
    fix: Required[list[Literal["x", "y"]]]  # Fixed components; needed


class SupportsBottom(TypedDict, total=False):
    rows_mm: float  # Depth of the support: from the side into the plate; one row
    rows_in: float
    fix: Required[list[Literal["x", "y"]]]  # Fixed components; needed


class SupportsLeft(TypedDict, total=False):
    rows_mm: float  # Depth of the support: from the side into the plate; one row
    rows_in: float
    fix: Required[list[Literal["x", "y"]]]  # Fixed components; needed


class SupportsRight(TypedDict, total=False):
    rows_mm: float  # Depth of the support: from the side into the plate; one row
    rows_in: float
    fix: Required[list[Literal["x", "y"]]]  # Fixed components; needed


class Supports(TypedDict, total=False):
    top: SupportsTop  # Support of this side; -
    bottom: SupportsBottom  # Support of this side; -
    left: SupportsLeft  # Support of this side; -
    right: SupportsRight  # Support of this side; -


class MeasuredLeaveOut(TypedDict, total=False):
    specimen: str  # Specimen: optional with a single specimen; -
    from_cycles: float  # First cycles: as the file counts them; -
    to_cycles: float  # Last cycles; -
    file: str  # File of the row: optional with a single file; -
    line: int  # Line of the row; -
    value: str  # A cell of the row: confirms the line; -
    reason: Required[str]  # Reason; needed


class Measured(TypedDict, total=False):
    files: list[str]  # Files of readings: CSV or workbooks, one or more specimens each; -
    from_crack_length_mm: float  # From crack length: start of the fit window; -
    from_crack_length_in: float
    to_crack_length_mm: float  # To crack length: end of the fit window; -
    to_crack_length_in: float
    length_unit: Literal["mm", "inch", "m"]  # Unit of crack length: where the header has none; -
    cycle_unit: Literal["cycles", "kilocycles", "megacycles"]  # Unit of cycles: where the header has none; -
    precision_mm: float  # Precision of the crack lengths; -
    precision_in: float
    load_unit: Literal["N", "kN", "lbf", "kip", "kgf", "MPa", "ksi"]  # Unit of loads: where the header has none; -
    columns: object  # Columns: by their names or numbers; -
    decimal: Literal[".", ","]  # Decimal sign; -
    sheet: object  # Sheet of a workbook: its name or number; -
    leave_out: list[MeasuredLeaveOut]  # Excluded readings: with the reason; -
    rates: list[object]  # Tables of rates: da/dN over ΔK; -
    intensity_unit: Literal["MPa sqrt(m)", "ksi sqrt(in)", "N/mm^1.5", "kgf/mm^1.5"]  # Unit of ΔK: of all tables; -
    rate_unit: Literal["mm/cycle", "m/cycle", "in/cycle", "um/cycle", "nm/cycle"]  # Unit of da/dN: of all tables; -
    delta_k: Literal["tensile", "full"]  # ΔK at negative R: of all tables; -
    from_delta_k_mpa_sqrt_m: float  # Fit window: from this ΔK; -
    from_delta_k_ksi_sqrt_in: float
    to_delta_k_mpa_sqrt_m: float  # Fit window: to this ΔK; -
    to_delta_k_ksi_sqrt_in: float


class Fit(TypedDict, total=False):
    parameters: list[Literal["a", "p"]]  # Fitted constants; a, p
    p: float  # Exponent p: given, not fitted; -
    record: str  # Record of the exponent: fitted.toml of another calibration; -
    criterion: Literal["both_ends", "first_reading"]  # Criterion: lives to be fitted; both_ends
    law: Literal["paris", "walker", "forman", "nasgro", "best"]  # Growth law to fit: default paris; -
    given: dict[str, object]  # Given constants: by their keys of [fatigue]; none
