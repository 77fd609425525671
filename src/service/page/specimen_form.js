// Form of a test or a plate: specimen, material, loading. Keys are those of the input file.

import { element, show } from "./dom.js";
import { compact, fillIn, grid, group, numberIn, numbersIn } from "./form.js";
import { plain } from "./format.js";
import { BENDING, CHOICES, KINDS, LISTS, OF_TESTS, SIZES, bearsForce, isThrough, titleOf } from "./kinds.js";
import { isOfSpectrum } from "./spectrum_form.js";

const MAGNITUDES = [
  ["stress_range_mpa", "Stress range Δσ", "MPa", "gross section, maximum − minimum"],
  ["stress_max_mpa", "Maximum stress σmax", "MPa", "gross section"],
  ["force_range_kn", "Force range ΔP", "kN", "maximum − minimum"],
  ["force_max_kn", "Maximum force Pmax", "kN", ""],
  ["force_range_n", "Force range ΔP", "N", "maximum − minimum"],
  ["force_max_n", "Maximum force Pmax", "N", ""],
  ["displacement_max_mm", "Maximum displacement δmax", "mm", "of the loaded places against each other"],
  ["displacement_range_mm", "Displacement range Δδ", "mm", "of the loaded places against each other"],
  ["crack_pressure_mpa", "Pressure in the cracks p", "MPa", "on their faces, alone"],
];

/** A load that is told by the scale of a spectrum. */
const OF_SPECTRUM = [
  ["spectrum_scale_mpa", "Spectrum: scale σ", "MPa", "gross stress that a value of 1 in the file stands for"],
  ["spectrum_scale_n", "Spectrum: scale P", "N", "force that a value of 1 in the file stands for"],
];

/** True when every key of `object` is one of `known`. */
function onlyKnown(object, known) {
  return Object.keys(object).every((key) => known.includes(key));
}

/** Specimen: the kinds of tests, and all others where `plate` ({element, collect, fill}) is given. */
export function createSpecimen(form, { plate } = {}) {
  const kinds = plate ? Object.keys(KINDS) : OF_TESTS;
  const kind = form.choice("specimen.kind", { label: "Kind", options: kinds.map((value) => ({ value, title: titleOf(value) })) });
  const keysOf = (of) => [...KINDS[of].needs, ...(KINDS[of].may ?? [])];
  const used = new Set(kinds.flatMap(keysOf));
  const pick = (table, make) => Object.entries(table).filter(([key]) => used.has(key)).map(([key, about]) => [key, make(`specimen.${key}`, about)]);
  const fields = Object.fromEntries([
    ...pick(SIZES, (key, [label, unit]) => form.number(key, { label, unit, optional: true, signed: key.includes("angle") || key.includes("offset") })),
    ...pick(LISTS, (key, [label, unit, hint]) => form.numbers(key, { label, unit, hint })),
    ...pick(CHOICES, (key, [label, options]) => form.choice(key, { label, options: options.map(([value, title]) => ({ value, title })) })),
  ]);

  function arrange() {
    const { needs, hints = {} } = KINDS[kind.input.value];
    // Lengths of their own say how many cracks there are and how long each is.
    const areUnlike = fields.crack_lengths_mm?.input.value.trim() && keysOf(kind.input.value).includes("crack_lengths_mm");
    const shown = keysOf(kind.input.value).filter((key) => !(areUnlike && ["crack_length_mm", "cracks"].includes(key)));
    for (const [key, field] of Object.entries(fields)) {
      field.node.hidden = !shown.includes(key);
      field.needed = needs.includes(key);
      const optional = field.node.querySelector(".optional");
      if (optional) optional.hidden = field.needed;
      const hint = hints[key] ?? (SIZES[key] ?? LISTS[key])?.[2] ?? "";
      field.note.textContent = hint;
      field.note.hidden = hint === "";
    }
    if (plate) plate.element.hidden = kind.input.value !== "plate";
  }
  for (const field of [kind, fields.crack_lengths_mm]) field?.input.addEventListener("input", arrange);
  arrange();

  return {
    element: group("Specimen", grid(kind.node, ...Object.values(fields).map((field) => field.node)), plate?.element),
    fields: { kind, ...fields },
    collect() {
      const chosen = kind.input.value;
      const given = ([key, field]) => [key, key in CHOICES && key !== "cracks" ? field.input.value : key in LISTS ? numbersIn(field) : numberIn(field)];
      return compact({
        kind: chosen,
        ...Object.fromEntries(Object.entries(fields).filter(([, field]) => !field.node.hidden).map(given)),
        ...(chosen === "plate" ? plate.collect() : {}),
      });
    },
    /** Takes a specimen over; false when it says something the form cannot show. */
    fill(specimen, loading) {
      if (!kinds.includes(specimen.kind)) return false;
      const isPlate = specimen.kind === "plate";
      const own = keysOf(specimen.kind);
      if (!onlyKnown(specimen, ["kind", ...own, ...(isPlate ? ["holes", "cracks"] : [])])) return false;
      fillIn(kind, specimen.kind);
      for (const key of own) fillIn(fields[key], specimen[key] ?? (key === "cracks" ? 1 : undefined));
      arrange();
      if (isPlate) plate.fill(specimen, loading);
      return true;
    },
  };
}

const PROPERTIES = [
  ["youngs_modulus_gpa", "Young’s modulus E", "GPa"],
  ["poisson_ratio", "Poisson’s ratio ν", ""],
  ["yield_strength_mpa", "Yield strength", "MPa"],
  ["toughness_mpa_sqrt_m", "Toughness", "MPa√m"],
];

const PLANES = [{ value: "stress", title: "Plane stress" }, { value: "strain", title: "Plane strain" }];
const SHORT = { youngs_modulus_gpa: "E", poisson_ratio: "ν", yield_strength_mpa: "yield strength", toughness_mpa_sqrt_m: "toughness" };

/** Material: one of the library, or constants. */
export function createMaterial(form, { toughness = true } = {}) {
  const name = form.choice("material.name", { label: "Material", options: [{ value: "", title: "Own constants" }] });
  const plane = form.choice("material.plane", { label: "State", options: PLANES });
  const fields = Object.fromEntries(PROPERTIES.map(([key, label, unit]) => [key,
    form.number(`material.${key}`, { label, unit, optional: ["yield_strength_mpa", "toughness_mpa_sqrt_m"].includes(key) })]));
  name.node.classList.add("wide");
  const listed = element("div");
  let materials = [];

  function arrange() {
    const chosen = materials.find((material) => material.name === name.input.value);
    for (const [key, field] of Object.entries(fields)) {
      // A toughness depends on thickness and heat treatment, so the library seldom has one, and it may be given beside a name.
      field.node.hidden = key === "toughness_mpa_sqrt_m" ? !toughness : Boolean(chosen);
    }
    show(listed, chosen && element("details", { class: "quiet" },
      element("summary", null, constantsOf(chosen)),
      element("ul", null, PROPERTIES.filter(([key]) => chosen[key]).map(([key, label, unit]) => {
        const { value, source, note } = chosen[key];
        return element("li", null, `${label} ${plain(value)} ${unit}: ${source}${note ? ` (${note})` : ""}`);
      }))));
  }

  function constantsOf(material) {
    const known = PROPERTIES.filter(([key]) => material[key]);
    return known.map(([key, , unit]) => `${SHORT[key]} ${plain(material[key].value)} ${unit}`.trim()).join(", ");
  }

  name.input.addEventListener("input", arrange);
  arrange();

  return {
    /** Whether a model asks for the yield strength. */
    needStrength(is) {
      const field = fields.yield_strength_mpa;
      field.needed = is;
      field.node.querySelector(".optional").hidden = is;
    },
    element: group("Material", grid(name.node, plane.node, ...Object.values(fields).map((field) => field.node)), listed),
    /** Materials of the library; the first becomes the choice. */
    setMaterials(list) {
      const chosen = materials.length === 0 ? list.find((material) => material.name === "al2024-t3")?.name ?? list[0]?.name : name.input.value;
      materials = list;
      show(name.input, list.map((material) => element("option", { value: material.name }, `${material.name} – ${material.title}`)),
        element("option", { value: "" }, "Own constants"));
      name.input.value = chosen ?? "";
      arrange();
    },
    collect() {
      const given = Object.entries(fields).filter(([, field]) => !field.node.hidden).map(([key, field]) => [key, numberIn(field)]);
      return compact({ name: name.input.value, ...Object.fromEntries(given), plane: plane.input.value });
    },
    fill(material) {
      const named = materials.some((one) => one.name === material.name);
      const beside = named ? ["toughness_mpa_sqrt_m"] : Object.keys(fields);
      if ((material.name && !named) || !onlyKnown(material, ["name", "plane", ...beside])) return false;
      fillIn(name, material.name ?? "");
      fillIn(plane, material.plane ?? "stress");
      for (const [key, field] of Object.entries(fields)) fillIn(field, material[key]);
      arrange();
      return true;
    },
  };
}

/** Loading: one magnitude, named as what it is, and the ratio; `places` ({element, edges(), fill()}) and `plate` ({pins()}) say where it acts on a drawn plate, `spectrum` how it varies. */
export function createLoading(form, { places, plate, spectrum } = {}) {
  const withoutSymbol = (label) => label.replace(/ \S+$/, "");
  const magnitudes = [...MAGNITUDES, ...(spectrum ? OF_SPECTRUM : [])];
  const options = magnitudes.map(([key, label, unit]) => ({ value: key, title: `${withoutSymbol(label)}, ${unit}` }));
  const quantity = form.choice("loading.kind", { label: "Load given as", options });
  const magnitude = form.number(magnitudes.map(([key]) => `loading.${key}`), { label: "Load", unit: "MPa", hint: "gross section" });
  const ratio = form.number("loading.stress_ratio", { label: "Stress ratio R", signed: true, hint: "minimum / maximum" });
  const bending = form.number("loading.bending_ratio", { label: "Bending Sb / St", optional: true, hint: "stress of the bending at the face of the crack over the tension; the run then ends where the crack is through" });
  const across = form.number("loading.stress_parallel_ratio", { label: "Stress across / along", optional: true, signed: true, hint: "of the arms across the load over those along it; 0 where it is left out" });
  let suits = ""; // the specimen that it is for
  const isSpectrum = () => isOfSpectrum(quantity.input.value);

  function arrange() {
    const [key, label, unit, hint] = magnitudes.find(([candidate]) => candidate === quantity.input.value);
    magnitude.name.textContent = label;
    magnitude.node.querySelector("label .visually-hidden").textContent = `, ${unit}`;
    magnitude.unitNode.textContent = unit;
    magnitude.note.textContent = hint;
    magnitude.note.hidden = hint === "";
    magnitude.input.dataset.key = `loading.${key}`;
    ratio.node.hidden = isSpectrum();
    bending.node.hidden = !BENDING.includes(suits);
    across.node.hidden = !KINDS[suits]?.biaxial;
    spectrum?.arrange({ used: isSpectrum(), isThrough: isThrough(suits) });
  }
  quantity.input.addEventListener("input", arrange);
  arrange();
  const isDrawn = () => places && suits === "plate";

  return {
    element: group(spectrum ? "Loading" : "Loading, constant amplitude", grid(quantity.node, magnitude.node, ratio.node, bending.node, across.node), spectrum?.element, places?.element),
    /** What the readings say of the load, where nobody has said anything yet. */
    propose({ stress_ratio: given, ...load }) {
      const [[key, value] = []] = Object.entries(load);
      if (key && !magnitude.touched && !quantity.touched) {
        fillIn(quantity, key);
        arrange();
        fillIn(magnitude, value);
      }
      if (given !== undefined && !ratio.touched) fillIn(ratio, given);
    },
    /** What is pulled by pins or bent by rollers takes no stress. */
    suit(specimenKind) {
      const [was, is] = [suits, specimenKind].map(bearsForce);
      suits = specimenKind;
      if (places) places.element.hidden = !isDrawn();
      arrange();
      const wrong = is ? quantity.input.value.startsWith("stress") : was && quantity.input.value.startsWith("force");
      if (!wrong) return;
      quantity.input.value = is ? "force_range_kn" : "stress_range_mpa";
      fillIn(magnitude, "");
      arrange();
    },
    collect() {
      const kind = isSpectrum() ? "spectrum" : quantity.input.value.startsWith("displacement") ? "displacement" : "constant_amplitude";
      const shown = (field) => (field.node.hidden ? undefined : numberIn(field));
      return compact({ kind, [quantity.input.value]: numberIn(magnitude), stress_ratio: shown(ratio), bending_ratio: shown(bending), stress_parallel_ratio: shown(across), ...(isSpectrum() ? spectrum.collect() : {}), ...(isDrawn() ? { edges: places.edges(), pins: plate.pins() } : {}) });
    },
    fill(loading, supports) {
      const keys = magnitudes.map(([key]) => key).filter((key) => key in loading);
      const isPinned = (loading.pins ?? []).every((pin) => onlyKnown(pin, ["hole", "direction"]));
      const known = ["kind", "stress_ratio", "bending_ratio", ...(KINDS[suits]?.biaxial ? ["stress_parallel_ratio"] : []), ...keys, ...(places ? ["edges", "pins"] : [])];
      const others = Object.fromEntries(Object.entries(loading).filter(([key]) => !known.includes(key)));
      if (keys.length !== 1 || !isPinned || Array.isArray(loading[keys[0]])) return false;
      if (isOfSpectrum(keys[0]) ? !spectrum.fill(others) : !onlyKnown(others, [])) return false;
      if (places ? !places.fill(loading, supports) : supports) return false;
      fillIn(quantity, keys[0]);
      arrange();
      fillIn(magnitude, loading[keys[0]]);
      fillIn(ratio, loading.stress_ratio);
      fillIn(bending, loading.bending_ratio);
      fillIn(across, loading.stress_parallel_ratio);
      return true;
    },
  };
}
