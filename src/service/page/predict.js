// A plate that nobody tested: its form, the law to use, and the start of a prediction.

import { getJson } from "./api.js";
import { byId, element, show } from "./dom.js";
import { createEditor } from "./editor.js";
import { compact, createForm, fillIn, grid, group, numberIn } from "./form.js";
import { percent, scientific, sentence, significant, words } from "./format.js";
import { filesOf, jobToStartFrom } from "./job.js";
import { KINDS, isThrough } from "./kinds.js";
import { createPlate } from "./plate_form.js";
import { problemBox } from "./notices.js";
import { createLoading, createMaterial, createSpecimen } from "./specimen_form.js";
import { createSides } from "./sides_form.js";
import { createSpectrum } from "./spectrum_form.js";
import { startRun } from "./submit.js";

const START = {
  specimen: {
    kind: "plate", width_mm: 100, length_mm: 200, thickness_mm: 2,
    holes: [{ x_mm: 0, y_mm: 0, diameter_mm: 12 }],
    cracks: [{ from_mm: [6, 0], to_mm: [11, 0] }],
  },
  material: { name: "al2024-t3", plane: "stress" },
  loading: { kind: "constant_amplitude", stress_max_mpa: 70, stress_ratio: 0.2 },
  model: {},
};

/** An S-N line of local stress: label, unit, hint. */
const INITIATION = {
  range_mpa: ["Range of local stress Δσ", "MPa", "at a point of the S-N line, of specimens with the surface of drilled holes"],
  cycles: ["Cycles N there", "cycles"],
  slope: ["Slope k", "", "of log N over log Δσ"],
  limit_mpa: ["Endurance limit", "MPa", "range of local stress up to which no crack forms"],
};

const BY_HAND = "law:paris";
const NAMES = { nasgro: "NASGRO", bond_law: "A and p of fatigue bonds", library: "Growth data of the material" };
const LIBRARY = { name: "library", meaning: "Of a material that has growth data: a batch may differ by a factor of 2 in rate.", constants: [] };
const SYMBOLS = {
  paris_c_mm_per_cycle: "C", paris_m: "m", walker_gamma: "γ", forman_c_mm_per_cycle: "C", forman_m: "m", k_c_mpa_sqrt_m: "Kc",
  nasgro_c_mm_per_cycle: "C", nasgro_n: "n", nasgro_p: "p", nasgro_q: "q", nasgro_alpha: "α", nasgro_smax_over_flow: "Smax/σ0",
  nasgro_delta_k_0_mpa_sqrt_m: "ΔK0", nasgro_c_th: "Cth", nasgro_c_th_negative: "Cth, R below 0", a: "A", p: "p", horizon_mm: "Horizon of A",
};
/** Builds the view; gives {setMaterials, open(query)}. */
export function createPredictView() {
  const form = createForm(() => {
    arrange();
    editor.check.soon();
  });
  const plate = createPlate(form, {
    size: () => ({ width_mm: numberIn(specimen.fields.width_mm), length_mm: numberIn(specimen.fields.length_mm) }),
    onChange: () => editor.check.soon(),
  });
  const specimen = createSpecimen(form, { plate });
  const material = createMaterial(form);
  const sides = createSides(form, () => editor.check.soon());
  const spectrum = createSpectrum(form, () => editor.check.soon());
  const loading = createLoading(form, { places: sides, plate, spectrum });
  const law = form.choice("calibration", { label: "Growth law", options: [{ value: "law:paris", title: "C and m (Paris)" }] });
  law.node.classList.add("wide");
  const lawNote = element("div", { class: "law-note" });
  // Constants of every law, as the service lists them; A and p with the horizon that A holds for.
  const constants = element("div", { class: "fields" });
  const threshold = form.number("fatigue.delta_k_threshold_mpa_sqrt_m", { label: "Threshold ΔK", unit: "MPa√m", optional: true, hint: "without it nothing stands still" });
  const gamma = form.number("fatigue.walker_gamma", { label: "Walker’s γ", optional: true, hint: "for a law of another stress ratio" });
  const beyond = form.choice("fatigue.allow_extrapolation", { label: "ΔK the law was not measured at", options: [{ value: "", title: "up to 25 % of the life" }, { value: "true", title: "allowed" }] });
  const besides = grid(gamma.node, beyond.node); // what holds for every law
  const initiation = Object.fromEntries(Object.entries(INITIATION).map(([key, [label, unit, hint]]) =>
    [key, form.number(`fatigue.initiation.${key}`, { label, unit, hint, optional: key === "limit_mpa" })]));
  const formation = group("Formation of cracks (phase I)", grid(...Object.values(initiation).map((field) => field.node)));
  let laws = [];
  let fieldsOfLaw = {};
  const length = { unit: "mm", optional: true };
  const spacing = form.number("model.spacing_mm", { ...length, label: "Spacing of points", hint: "of points and bonds only" });
  const method = form.choice("model.method", {
    label: "Method", options: [["", "Chosen by the program"], ["handbook", "Handbook formula"], ["element_free_galerkin", "Nodes"], ["peridynamics", "Points and bonds"]]
      .map(([value, title]) => ({ value, title })),
  });
  const tolerance = form.number("model.tolerance_percent", { label: "Error of life wanted", unit: "%", optional: true, hint: "2 where nothing is given" });
  const stopLength = form.number("stop.crack_length_mm", { ...length, label: "Stop at crack length" });
  const stopDepth = form.number("stop.crack_depth_mm", { ...length, label: "Stop at crack depth" });
  const breakThrough = form.choice("stop.at_break_through", { label: "Where the crack is through", options: [{ value: "", title: "go on as a through crack" }, { value: "true", title: "stop" }] });
  const stopCycles = form.number("stop.cycles_max", { label: "Stop after", unit: "cycles", optional: true });
  const name = form.text("name", { label: "Name of the prediction", optional: true });
  const fields = byId("plate-fields");
  const start = byId("predict");
  const factors = byId("factors");
  let calibrations = [];

  function arrange() {
    const kind = specimen.fields.kind.input.value;
    loading.suit(kind);
    if (kind === "plate") plate.draw();
    for (const field of [stopDepth, breakThrough]) field.node.hidden = isThrough(kind);
    formation.hidden = fields.hidden || !KINDS[kind]?.initiation;
    material.needStrength(spectrum.isRetarded());
    const own = laws.find((one) => `law:${one.name}` === law.input.value);
    if (constants.dataset.law !== (own?.name ?? "")) drawConstants(own);
    constants.hidden = fields.hidden;
    besides.hidden = fields.hidden;
    gamma.node.hidden = "walker_gamma" in fieldsOfLaw;
    spacing.node.hidden = !["", "peridynamics"].includes(method.input.value);
    tolerance.node.hidden = !["", "element_free_galerkin"].includes(method.input.value);
    const chosen = calibrations.find((one) => one.id === law.input.value);
    show(lawNote, chosen?.summary ? describe(chosen) : element("p", { class: "quiet" }, own?.meaning ?? "",
      calibrations.length === 0 && [" No calibration has been made here yet: ", element("a", { href: "#/measure" }, "fit measured curves"), "."]));
  }

  /** Fields for the constants of a law. */
  function drawConstants(own) {
    form.drop(Object.values(fieldsOfLaw));
    fieldsOfLaw = Object.fromEntries((own?.constants ?? []).map(({ key, unit, what, needed }) => [key,
      form.number(`fatigue.${key}`, { label: SYMBOLS[key] ?? words(key), unit, hint: what, optional: !needed, signed: true })]));
    constants.dataset.law = own?.name ?? "";
    const hasOwn = Object.keys(fieldsOfLaw).some((key) => key.includes("delta_k"));
    show(constants, Object.values(fieldsOfLaw).map((field) => field.node), own && !hasOwn && threshold.node);
  }

  function describe({ id, summary: s }) {
    const rate = `${scientific(s.rate_at_pivot_mm_per_cycle)} mm/cycle ± ${percent(s.rate_at_pivot_relative_error)}`;
    const range = `${significant(s.delta_k_min_mpa_sqrt_m, 3)} to ${significant(s.delta_k_max_mpa_sqrt_m, 3)} MPa√m`;
    return element("p", { class: "quiet" },
      `${rate} at ΔK ${significant(s.pivot_delta_k_mpa_sqrt_m)} MPa√m, m ${significant(s.paris_m)} ± ${significant(s.paris_m_error, 2)}; `,
      `fitted for ΔK from ${range}. `,
      element("a", { href: `#/calibrations/${encodeURIComponent(id)}` }, "Open the calibration"));
  }

  const isFitted = () => !law.input.value.startsWith("law:");

  const initiationOf = () => compact(Object.fromEntries(Object.entries(initiation).map(([key, field]) => [key, numberIn(field)])));

  const besidesOf = () => ({ initiation: formation.hidden ? undefined : initiationOf(), walker_gamma: gamma.node.hidden ? undefined : numberIn(gamma), allow_extrapolation: beyond.input.value === "true" || undefined });

  function fatigueOf() {
    const name = law.input.value.replace("law:", "");
    const given = Object.fromEntries(Object.entries(fieldsOfLaw).map(([key, field]) => [key, numberIn(field)]));
    // Bonds and powers of ΔK are told by their constants.
    const named = ["paris", "bond_law"].includes(name) ? {} : { growth_law: name };
    return compact({ ...besidesOf(), ...named, ...given, delta_k_threshold_mpa_sqrt_m: threshold.node.isConnected ? numberIn(threshold) : undefined });
  }

  function collect() {
    return {
      specimen: specimen.collect(),
      material: material.collect(),
      loading: loading.collect(),
      supports: specimen.fields.kind.input.value === "plate" ? sides.supports() : undefined,
      model: compact({ method: method.input.value, tolerance_percent: tolerance.node.hidden ? undefined : numberIn(tolerance),
        spacing_mm: spacing.node.hidden ? undefined : numberIn(spacing) }),
      fatigue: isFitted() ? compact(besidesOf()) : fatigueOf(),
      stop: compact({ crack_length_mm: numberIn(stopLength), cycles_max: numberIn(stopCycles), ...(isThrough(specimen.fields.kind.input.value) ? {}
        : { crack_depth_mm: numberIn(stopDepth), at_break_through: breakThrough.input.value === "true" || undefined }) }),
    };
  }

  /** The law that a case names, or whose constants it gives. */
  function lawOf(fatigue) {
    const has = (one) => one.constants.filter(({ needed }) => needed).every(({ key }) => key in fatigue);
    return laws.find((one) => one.name === fatigue.growth_law) ?? laws.find((one) => ["paris", "bond_law"].includes(one.name) && has(one));
  }

  /** Only what the form can show: anything else stays text. */
  function fill(input) {
    const { specimen: s, material: m, loading: l, supports, model = {}, fatigue = {}, stop = {}, ...others } = input;
    const filled = (table) => Object.keys(table ?? {}).length > 0;
    const isBeyond = (table, known) => Object.keys(table).some((key) => !known.includes(key));
    const besideLaw = ["walker_gamma", "allow_extrapolation", ...(KINDS[s?.kind]?.initiation ? ["initiation"] : [])];
    const own = isFitted() || !filled(fatigue) ? null : lawOf(fatigue);
    const tooMuch = Object.values(others).some(filled) || isBeyond(model, ["spacing_mm", "method", "tolerance_percent"]) || isBeyond(stop, ["crack_length_mm", "cycles_max", "crack_depth_mm", "at_break_through"]) ||
      (own && isBeyond(fatigue, ["growth_law", "delta_k_threshold_mpa_sqrt_m", ...besideLaw, ...own.constants.map(({ key }) => key)])) ||
      (!own && isBeyond(fatigue, ["fitted", ...besideLaw])) || isBeyond(fatigue.initiation ?? {}, Object.keys(INITIATION));
    if (tooMuch || !specimen.fill(s, l) || !material.fill(m)) return false;
    loading.suit(s.kind);
    if (!loading.fill(l, supports)) return false;
    fillIn(method, model.method === "auto" ? "" : model.method);
    fillIn(tolerance, model.tolerance_percent);
    fillIn(spacing, model.spacing_mm);
    fillIn(stopLength, stop.crack_length_mm);
    fillIn(stopCycles, stop.cycles_max);
    fillIn(stopDepth, stop.crack_depth_mm);
    fillIn(breakThrough, stop.at_break_through ? "true" : "");
    if (own) fillIn(law, `law:${own.name}`);
    arrange();
    if (own) Object.entries(fieldsOfLaw).forEach(([key, field]) => fillIn(field, fatigue[key]));
    fillIn(gamma, fatigue.walker_gamma);
    Object.entries(initiation).forEach(([key, field]) => fillIn(field, fatigue.initiation?.[key]));
    fillIn(beyond, fatigue.allow_extrapolation ? "true" : "");
    if (own) fillIn(threshold, fatigue.delta_k_threshold_mpa_sqrt_m);
    return true;
  }

  show(fields, specimen.element, material.element, loading.element,
    group("End", grid(stopLength.node, stopDepth.node, breakThrough.node, stopCycles.node, name.node)),
    group("How it is computed", grid(method.node, tolerance.node, spacing.node)));
  show(byId("law-fields"), group("Growth law", grid(law.node), constants, besides, lawNote), formation);

  // While another run's input is on its way, what stands in the form is not what the user means to start.
  let opening = false;
  const editor = createEditor({
    host: byId("plate-editor"), fields, panel: byId("plate-check"), form, collect, fill,
    // Before its laws are known the form is not whole.
    context: () => (laws.length === 0 ? "The growth laws are being read." : (!fields.hidden && spectrum.missing())
      || { ...(isFitted() ? { calibration: law.input.value } : {}), files: fields.hidden || spectrum.isUsed() ? spectrum.files() : undefined }),
    onResult: (ok) => {
      start.disabled = !ok || opening;
      factors.disabled = start.disabled;
    },
    onMode: arrange,
  });

  /** Kind and size of the specimen as it was checked, so that runs without a name can be told apart. */
  function defaultName() {
    const { kind, width_mm: width, length_mm: length } = editor.check.last?.case?.specimen ?? {};
    const size = width && length ? ` ${width} × ${length} mm` : width ? ` W ${width} mm` : "";
    return kind ? `${sentence(words(kind))}${size}` : "Prediction";
  }

  /** Finished calibrations as laws to choose from; the newest is the choice until the user makes one. */
  async function loadLaws(wanted) {
    try {
      if (laws.length === 0) {
        const known = await getJson("/v1/kinds");
        laws = [...known.laws.filter((one) => one.constants.length > 0), LIBRARY];
        sides.setKinds(known.kinds);
        spectrum.setKinds(known);
      }
      calibrations = (await getJson("/v1/calibrations?limit=100&state=succeeded")).items;
      // One that is asked for by its address may be older than these.
      const known = calibrations.some((one) => one.id === wanted);
      if (wanted && !known) calibrations.push(await getJson(`/v1/calibrations/${encodeURIComponent(wanted)}`));
      show(byId("law-problem"));
    } catch (error) {
      show(byId("law-problem"), problemBox(error, () => loadLaws(wanted)));
      return;
    }
    const chosen = wanted ?? (law.touched ? law.input.value : calibrations[0]?.id ?? BY_HAND);
    const option = (value, title) => element("option", { value }, title);
    show(law.input, option(BY_HAND, "C and m (Paris)"),
      calibrations.length > 0 && element("optgroup", { label: "Fitted here" }, calibrations.map((one) => option(one.id, one.name || one.id))),
      element("optgroup", { label: "Other laws" }, laws.filter((one) => one.name !== "paris")
        .map((one) => option(`law:${one.name}`, NAMES[one.name] ?? sentence(words(one.name))))));
    law.input.value = [...law.input.options].some((one) => one.value === chosen) ? chosen : BY_HAND;
    arrange();
    editor.check.soon();
  }

  const starts = (own, path, what) => own.addEventListener("click", async () => {
    if (!(await editor.check.now())) return;
    startRun(path, { ...editor.body(), name: name.input.value.trim() || `${what}${defaultName()}` }, {
      button: own, status: byId("predict-status"), refuse: editor.check.refuse,
    });
  });
  starts(start, "/v1/predictions", "");
  starts(factors, "/v1/sif", "K of ");

  let opened = false;
  return {
    /** The case as it stands here, {input, calibration?, files?}, or a sentence that says what is missing. */
    body: () => editor.body(),
    /** Waits until the case was checked once. */
    async ready() {
      if (laws.length === 0) await loadLaws();
      if (!editor.check.last) await editor.check.now();
    },
    /** The same as the service understood it, null where it did not. */
    checked: () => editor.check.last?.case ?? null,
    setMaterials(list) {
      material.setMaterials(list);
      if (!opened) editor.startFrom(START);
      opened = true;
    },
    /** `law`: a calibration to use; `from`: a run to start from, as collection/id. */
    async open(query) {
      const from = query.get("from");
      opening = Boolean(from);
      start.disabled = true;
      await loadLaws(query.get("law") ?? undefined);
      if (!from) return;
      try {
        const job = await jobToStartFrom(from);
        if (job.calibration) await loadLaws(job.calibration);
        else fillIn(law, BY_HAND);
        opened = true;
        await spectrum.load(await filesOf(job), job.input);
        await editor.start(job.input);
      } catch (error) {
        editor.check.refuse(error);
      } finally {
        opening = false;
        editor.check.soon();
      }
    },
  };
}
