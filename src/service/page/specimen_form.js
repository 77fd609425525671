// Specimen, material and loading of a test or a plate, from their keys.

import { element, show } from "./dom.js";
import { compact, need, tell, tellUntilEdited, untell } from "./form.js";
import { plain } from "./format.js";
import { createFields, fieldOf } from "./key_fields.js";
import { choicesOf, keyOf, keysOf, traitsOf } from "./keys.js";
import { LISTS } from "./plate_form.js";
import { spectrumKeys } from "./spectrum_form.js";

/** Kinds that no test of a material has. */
const NO_TESTS = ["plate", "stop_hole", "row_of_holes"];
const UNLIKE = "crack_lengths_mm";
const ONE_LENGTH = ["crack_length_mm", "cracks"];

/** Whether the crack of a kind is a through crack. */
export const isThrough = (kind) => !traitsOf(kind).is_part_through;

/** Specimen: kinds of tests, or all where `plate` ({element, collect(), fill()}) is given. */
export function createSpecimen(form, { plate } = {}) {
  const kinds = choicesOf("specimen.kind").filter(({ value }) => plate || (isThrough(value) && !NO_TESTS.includes(value)));
  const kind = form.choice("specimen.kind", { label: "Kind", options: kinds, hint: " " });
  kind.node.classList.add("wide");
  const place = element("div");
  let fields = null;
  const typed = {}; // by the metric names of keys

  /** Fields of the chosen kind, with what was typed in others of the same name. */
  function draw() {
    for (const [metric, { input, touched }] of Object.entries(fields?.by ?? {})) if (input) typed[metric] = [input.value, touched];
    fields?.drop();
    const chosen = kind.input.value;
    const keys = keysOf("specimen", chosen).filter(({ metric }) => chosen !== "plate" || !LISTS.includes(metric));
    fields = createFields(form, "specimen", keys);
    for (const [metric, { key, input }] of Object.entries(fields.by)) {
      if (input && metric in typed && key.shape !== "file") [input.value, fields.by[metric].touched] = typed[metric];
    }
    const first = keys.filter(({ metric, needed, group: one }) => needed || (one && chosen !== "plate") || ONE_LENGTH.includes(metric)).map(({ metric }) => metric);
    show(place, fields.group("Specimen", first.concat(chosen === "plate" ? ["width_mm", "length_mm"] : []), chosen === "plate" && plate.element));
    tell(kind, kinds.find(({ value }) => value === chosen)?.meaning);
    place.firstChild.querySelector(".fields").prepend(kind.node);
    arrange();
  }

  function arrange() {
    const isGiven = (metric) => Boolean(fields.by[metric]?.input?.value.trim() || fields.by[metric]?.given);
    // Of keys of which one is given the first number is asked for.
    const groups = Map.groupBy(Object.values(fields.by).filter((field) => field.key.group), (field) => field.key.group);
    for (const all of groups.values()) {
      const [first, ...others] = [...all].sort((one, other) => (other.key.shape === "number") - (one.key.shape === "number"));
      need(first, !others.some(({ key }) => isGiven(key.metric)));
    }
    fields.arrange(({ metric }) => !(isGiven(UNLIKE) && ONE_LENGTH.includes(metric)));
  }
  kind.input.addEventListener("input", draw);
  place.addEventListener("input", arrange);
  draw();

  return {
    element: place, kind: () => kind.input.value,
    field: (metric) => fields.by[metric],
    choose(wanted) {
      if (kinds.some(({ value }) => value === wanted)) kind.input.value = wanted;
      draw();
    },
    /** Values as they are shown, by metric names. */
    values: () => Object.fromEntries(Object.entries(fields.by).map(([metric, field]) => [metric, field.read()])),
    collect: () => compact({ kind: kind.input.value, ...fields.collect(), ...(kind.input.value === "plate" ? plate.collect() : {}) }),
    /** Takes a specimen over; false when it has keys that no field shows. */
    fill({ kind: wanted, ...specimen }, loading) {
      if (!kinds.some(({ value }) => value === wanted)) return false;
      this.choose(wanted);
      const isPlate = wanted === "plate";
      const own = Object.fromEntries(Object.entries(specimen).filter(([metric]) => !isPlate || !LISTS.includes(metric)));
      const isWhole = [fields.fill(own), !isPlate || plate.fill(specimen, loading)].every(Boolean);
      arrange();
      return isWhole;
    },
  };
}

const CONSTANTS = ["youngs_modulus_gpa", "poisson_ratio", "yield_strength_mpa", "toughness_mpa_sqrt_m"];

/** Material: one of the library, or constants, which override those of the name. */
export function createMaterial(form, materials) {
  const fields = createFields(form, "material", keysOf("material").filter(({ metric }) => metric !== "name"));
  const options = [...materials.map(({ name: value, title }) => ({ value, title: `${value} – ${title}` })), { value: "", title: "Custom" }];
  const name = form.choice("material.name", { label: keyOf("material", "name").label, options });
  name.node.classList.add("wide");
  const listed = element("div");
  const root = fields.group("Material", ["plane", ...CONSTANTS], listed);
  root.querySelector(".fields").prepend(name.node);

  /** What the library has is shown in the empty fields. */
  function arrange() {
    const chosen = materials.find((material) => material.name === name.input.value);
    const has = Object.values(fields.by).filter(({ key }) => chosen?.[key.metric]);
    const shown = ({ metric }) => plain(chosen[metric].value / keyOf("material", metric).factor, 4);
    for (const field of Object.values(fields.by)) {
      if (field.key.shape !== "number") continue;
      field.input.placeholder = has.includes(field) ? shown(field.key) : "";
      need(field, !chosen && CONSTANTS.slice(0, 2).includes(field.key.metric));
    }
    show(listed, chosen && element("details", { class: "quiet" }, element("summary", null, "Sources of the constants"),
      element("ul", null, has.map(({ key }) => element("li", null, `${key.label} ${shown(key)} ${key.unit}: ${chosen[key.metric].source}${chosen[key.metric].note ? ` (${chosen[key.metric].note})` : ""}`)))));
  }

  name.input.addEventListener("input", arrange);
  arrange();

  return {
    element: root, name,
    /** Whether a model needs the yield strength, which the library may have. */
    needStrength: (is) => need(fields.by.yield_strength_mpa, is && fields.by.yield_strength_mpa.input.placeholder === ""),
    collect: () => compact({ name: name.input.value, ...fields.collect() }),
    fill({ name: wanted = "", ...constants }) {
      if (wanted && !materials.some((one) => one.name === wanted)) return false;
      name.input.value = wanted;
      untell(name);
      const isWhole = fields.fill(constants);
      arrange();
      return isWhole;
    },
  };
}

const BY_PLATE = ["edges", "pins", "rollers"];

/** Loading: one magnitude, the ratio, and all else folded; `sides` and `plate` are where it acts on a custom plate, `spectrum` how it varies. */
export function createLoading(form, { sides, plate, spectrum } = {}) {
  const all = keysOf("loading");
  const isLoad = (key) => key.group && key.group === keyOf("loading", "stress_max_mpa").group;
  const magnitudes = all.filter((key) => isLoad(key) && (spectrum || !key.only?.values.includes("spectrum")));
  const kindOf = (metric) => magnitudes.find((key) => key.metric === metric)?.only?.values[0];
  const isSpectrum = () => kindOf(quantity.input.value) === "spectrum";
  const options = [...magnitudes.map(({ metric, label, unit }) => ({ value: metric, title: `${label}, ${unit}` })), ...(plate ? [{ value: "", title: "Crack-face pressure only" }] : [])];
  const quantity = form.choice("loading.kind", { label: "Load", options });
  quantity.node.classList.add("wide");
  const place = element("div", { class: "contents" });
  const isOfSpectrum = (metric) => spectrumKeys().includes(metric);
  const others = createFields(form, "loading", all.filter((key) => !isLoad(key) && !isOfSpectrum(key.metric) && !["kind", ...BY_PLATE].includes(key.metric)));
  const root = others.group(spectrum ? "Loading" : "Loading, constant amplitude", ["stress_ratio", "bending_ratio"], spectrum?.element, sides?.element);
  root.querySelector(".fields").prepend(quantity.node, place);
  const ratio = others.by.stress_ratio;
  let magnitude = null;
  let suits = ""; // the kind of specimen

  /** The field of the chosen magnitude keeps what was typed. */
  function draw() {
    const key = magnitudes.find(({ metric }) => metric === quantity.input.value);
    const typed = magnitude?.input.value ?? "";
    magnitude?.drop();
    magnitude = key ? fieldOf(form, "loading", { ...key, needed: true }) : null;
    if (magnitude) magnitude.input.value = typed;
    show(place, magnitude?.node);
    arrange();
  }

  function arrange() {
    const kind = kindOf(quantity.input.value) ?? "constant_amplitude";
    const isOfPlate = !plate || suits === "plate";
    const suited = {
      stress_ratio: !isSpectrum(), bending_ratio: Boolean(traitsOf(suits).takes_bending), crack_pressure_mpa: isOfPlate && Boolean(plate), direction: isOfPlate && Boolean(plate),
      edge_bending_ratio: isOfPlate && Boolean(plate), stress_parallel_ratio: !traitsOf(suits).takes_force,
    };
    others.arrange(({ metric, only }) => (suited[metric] ?? true) && (!only || only.key !== "kind" || only.values.includes(kind)));
    need(ratio, !isSpectrum());
    spectrum?.arrange(isSpectrum());
  }
  quantity.input.addEventListener("input", draw);
  draw();
  const isDrawn = () => sides && suits === "plate";

  return {
    element: root,
    /** The load of the readings or the ratio of a law, unless the user typed any; `from` says where it is from. */
    propose({ stress_ratio: given, ...load }, from) {
      const [[metric, value] = []] = Object.entries(load);
      if (metric && !magnitude?.touched && !quantity.touched && magnitudes.some((key) => key.metric === metric)) {
        quantity.input.value = metric;
        draw();
        magnitude.propose(value);
        if (from) tellUntilEdited(magnitude, from);
      }
      if (given === undefined || ratio.touched) return;
      ratio.write(given);
      if (from) tellUntilEdited(ratio, from);
    },
    /** Specimens on pins or rollers take no stress. */
    suit(kind) {
      const [was, is] = [suits, kind].map((one) => Boolean(traitsOf(one).takes_force));
      suits = kind;
      if (sides) sides.element.hidden = !isDrawn();
      arrange();
      const wrong = is ? quantity.input.value.startsWith("stress") : was && quantity.input.value.startsWith("force");
      if (!wrong) return;
      const how = quantity.input.value.includes("range") ? "range" : "max";
      quantity.input.value = is ? `force_${how}_kn` : `stress_${how}_mpa`;
      if (magnitude) magnitude.input.value = "";
      draw();
    },
    collect() {
      return compact({ kind: kindOf(quantity.input.value) ?? "constant_amplitude", ...(magnitude ? { [magnitude.key.name]: magnitude.read() } : {}), ...others.collect(),
        ...(isSpectrum() ? spectrum.collect() : {}), ...(isDrawn() ? { edges: sides.edges(), ...plate.loads() } : {}) });
    },
    /** Takes a load over; false when it has keys that no field shows. */
    fill(loading, supports) {
      const given = magnitudes.filter(({ metric }) => metric in loading);
      if (given.length > 1 || (given.length === 0 && !("crack_pressure_mpa" in loading))) return false;
      quantity.input.value = given[0]?.metric ?? "";
      draw();
      magnitude?.write(loading[given[0].metric]);
      const rest = (names) => Object.fromEntries(Object.entries(loading).filter(([metric]) => names(metric)));
      const known = ["kind", ...given.map(({ metric }) => metric), ...(sides ? BY_PLATE : [])];
      const isWhole = [others.fill(rest((metric) => !isOfSpectrum(metric) && !known.includes(metric))), spectrum ? spectrum.fill(rest(isOfSpectrum)) : Object.keys(rest(isOfSpectrum)).length === 0,
        sides ? sides.fill(loading, supports) : !supports];
      arrange();
      return isWhole.every(Boolean);
    },
  };
}
