// Kinds of specimens that the form knows: which keys of the input file each is told by.

import { sentence, words } from "./format.js";

/** Keys of all kinds in the order of the form: label, unit, hint. A hint of one kind stands in its place. */
export const SIZES = {
  width_mm: ["Width W", "mm"],
  length_mm: ["Length L", "mm", "between the loaded ends"],
  arm_width_mm: ["Width of the arms", "mm"],
  thickness_mm: ["Thickness B", "mm"],
  crack_length_mm: ["Initial crack length a", "mm"],
  stopped_crack_length_mm: ["Stopped crack", "mm", "half of its length, to the middles of the holes"],
  crack_angle_deg: ["Angle of the crack", "°", "against x, which is across the load"],
  crack_depth_mm: ["Crack depth a", "mm", "into the thickness"],
  crack_half_length_mm: ["Crack length c", "mm", "along the face; half of it where it has two ends there"],
  holes: ["Number of holes", ""],
  pitch_mm: ["Pitch of the holes", "mm", "from middle to middle"],
  hole_diameter_mm: ["Hole diameter", "mm"],
  hole_offset_mm: ["Hole from the middle", "mm", "across the load"],
  edge_distance_mm: ["Edge distance", "mm", "of a straight head, from the middle of the hole; half of the width where it is left out"],
  formed_length_mm: ["Cracks that form", "mm", "from the rims of the holes, at the end of phase I"],
  notch_depth_mm: ["Depth of the notch", "mm", "from the edge to its root"],
  notch_radius_mm: ["Radius of the notch", "mm", "at its root"],
  fillet_radius_mm: ["Radius of the fillets", "mm", "between the arms"],
  span_mm: ["Span", "mm", "of the outer rollers; 4 W where it is left out"],
  inner_span_mm: ["Inner span", "mm", "between two rollers; one in the middle where it is left out"],
  pin_diameter_mm: ["Pin diameter", "mm", "its clearance decides where it touches the hole; left out, an arc is assumed and what it matters is said"],
};

/** Keys of several numbers, in the place of the one length of all cracks. */
export const LISTS = {
  crack_lengths_mm: ["Cracks of unlike lengths", "mm", "left and right from the rim, such as 1 4, and 0 without one; of every hole of a row: 1 1; 1 4; 1 1"],
};

/** Keys that are chosen from a list. */
export const CHOICES = {
  cracks: ["Cracks at the hole", [["1", "One"], ["2", "Two, one on each side"]]],
  head: ["Head of the lug", [["straight", "Straight"], ["round", "Round, its middle that of the hole"]]],
  ends: ["Ends", [["", "choose …"], ["pinned", "Pinned grips, free to rotate"], ["clamped", "Clamped grips"], ["uniform_stress", "Uniform stress"]]],
};

const AT_RIM = "from the rim of the hole";
const FROM_EDGE = "from the edge";
const THREE_WIDTHS = "along the load; left out: three widths";
const FLAW = ["width_mm", "thickness_mm", "crack_depth_mm", "crack_half_length_mm"];
const ALONG = { length_mm: "along the load" };
const UNLIKE = "crack_lengths_mm";
const PIN = ["pin_diameter_mm"];
const PLATE = ["width_mm", "length_mm", "thickness_mm"];

/** Of every kind: keys that it needs, those that it may have, hints of its own, `force` where it bears forces alone, `flaw` where its crack is not through, `initiation` where a crack has to form first. */
export const KINDS = {
  middle_tension: { needs: [...PLATE, "crack_length_mm"], hints: { crack_length_mm: "half of the length from tip to tip" } },
  compact_tension: { needs: ["width_mm", "thickness_mm", "crack_length_mm"], may: PIN, force: true,
    hints: { width_mm: "from the load line to the back face", crack_length_mm: "from the load line" } },
  single_edge_tension: { needs: [...PLATE, "crack_length_mm", "ends"], hints: { crack_length_mm: FROM_EDGE } },
  double_edge_tension: { needs: [...PLATE, "crack_length_mm"], hints: { crack_length_mm: "of each crack, from its edge" } },
  plate: { needs: PLATE, hints: ALONG, title: "Plate drawn here" },
  crack_at_hole: { needs: [...PLATE, "crack_length_mm", "hole_diameter_mm", "cracks"], may: [UNLIKE, "hole_offset_mm"], hints: { ...ALONG, crack_length_mm: AT_RIM } },
  row_of_holes: { needs: [...PLATE, "crack_length_mm", "holes", "pitch_mm", "hole_diameter_mm"], may: [UNLIKE], hints: { ...ALONG, crack_length_mm: "of all, from the rims of the holes" } },
  stop_hole: { needs: [...PLATE, "stopped_crack_length_mm", "hole_diameter_mm", "formed_length_mm"], hints: ALONG, initiation: true },
  lug: { needs: [...PLATE, "crack_length_mm", "hole_diameter_mm", "head", "cracks"], may: [UNLIKE, "edge_distance_mm", ...PIN], force: true,
    hints: { length_mm: "from the middle of the hole to the held end", crack_length_mm: AT_RIM } },
  edge_notch: { needs: [...PLATE, "crack_length_mm", "notch_depth_mm", "notch_radius_mm"], hints: { ...ALONG, crack_length_mm: "from the root of the notch" } },
  single_edge_bend: { needs: ["width_mm", "thickness_mm", "crack_length_mm"], may: ["length_mm", "span_mm", "inner_span_mm"], force: true,
    hints: { length_mm: "of the beam; 0.5 W beyond its span where it is left out", crack_length_mm: FROM_EDGE } },
  eccentric_single_edge_tension: { needs: ["width_mm", "thickness_mm", "crack_length_mm"], force: true, hints: { crack_length_mm: FROM_EDGE } },
  wedge_opening: { needs: ["width_mm", "thickness_mm", "crack_length_mm"], force: true,
    hints: { width_mm: "from the load line to the back face", crack_length_mm: "from the load line" } },
  cruciform: { needs: ["length_mm", "arm_width_mm", "thickness_mm", "crack_length_mm", "fillet_radius_mm"], may: ["crack_angle_deg"], biaxial: true,
    hints: { length_mm: "from end to end", crack_length_mm: "half of the length from tip to tip" } },
  surface_crack: { needs: FLAW, may: ["length_mm"], hints: { length_mm: THREE_WIDTHS }, flaw: true },
  corner_crack: { needs: FLAW, may: ["length_mm"], hints: { length_mm: THREE_WIDTHS }, flaw: true },
  embedded_crack: { needs: FLAW, may: ["length_mm"], hints: { length_mm: THREE_WIDTHS }, flaw: true },
  corner_crack_at_hole: { needs: [...FLAW, "hole_diameter_mm", "cracks"], may: ["length_mm"], hints: { length_mm: THREE_WIDTHS }, flaw: true },
};

/** Kinds that a test of a material has. */
export const OF_TESTS = ["middle_tension", "compact_tension", "single_edge_tension", "double_edge_tension"];
/** Those of which K under bending is known. */
export const BENDING = ["surface_crack", "corner_crack", "corner_crack_at_hole"];

/** Whether a crack of that kind of specimen goes through the plate. */
export const isThrough = (kind) => !KINDS[kind]?.flaw;
/** Whether a specimen is loaded by forces, so that no stress is its load. */
export const bearsForce = (kind) => Boolean(KINDS[kind]?.force);
export const titleOf = (kind) => KINDS[kind].title ?? sentence(words(kind));
