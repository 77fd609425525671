// Prediction: the form of a plate, the law to use, and the start of a run.

import { getJson } from "./api.js";
import { button, byId, element, show } from "./dom.js";
import { createEditor } from "./editor.js";
import { compact, createForm, grid, group, need } from "./form.js";
import { percent, plain, sentence, significant, words } from "./format.js";
import { filesOf, jobToStartFrom } from "./job.js";
import { createFields } from "./key_fields.js";
import { choicesOf, hasOnly, keyOf, keysOf, known, toShown } from "./keys.js";
import { createPlateForm } from "./plate_form.js";
import { problemBox } from "./notices.js";
import { createLoading, createMaterial, createSpecimen, isThrough } from "./specimen_form.js";
import { createSides } from "./sides_form.js";
import { createSpectrum } from "./spectrum_form.js";
import { startRun } from "./submit.js";
import { inShown, kept, rateShown, sized, spanned, unitShown } from "./units.js";

/** The plate of the button Example. */
const EXAMPLE = {
  specimen: { kind: "plate", width_mm: 100, length_mm: 200, thickness_mm: 2, holes: [{ x_mm: 0, y_mm: 0, diameter_mm: 12 }], cracks: [{ from_mm: [6, 0], to_mm: [11, 0] }] },
  material: { name: "al2024-t3", plane: "stress" },
  loading: { kind: "constant_amplitude", stress_max_mpa: 70, stress_ratio: 0.2 },
};
const EXAMPLE_LAW = { paris_c_mm_per_cycle: 1.1e-7, paris_m: 2.9 };

const BY_HAND = "law:paris";
const THRESHOLD = "delta_k_threshold_mpa_sqrt_m";
const GAMMA = "walker_gamma";
/** Keys of `[fatigue]` that the choice of a law has. */
const OF_CHOICE = ["fitted", "growth_law"];
/** Sections without a form of their own: title, and keys that are not folded. */
const SECTIONS = {
  stop: ["End", ["crack_length_mm", "crack_depth_mm", "at_break_through", "cycles_max"]],
  model: ["Method", ["method", "tolerance_percent", "spacing_mm"]],
  fleet: ["Fleet", []], output: ["Output", []],
};
/** The kind whose crack has to form again. */
const STOPPED = "stop_hole";
/** Keys for part-through cracks alone. */
const OF_FLAWS = ["crack_depth_mm", "at_break_through"];

/** Builds the view; gives {body(), ready(), checked(), open(query)}. */
export function createPredictView(materials) {
  const form = createForm(() => {
    arrange();
    editor.check.soon();
  });
  const plate = createPlateForm(form, { size: () => specimen.values(), whole: () => specimen.collect(), onChange: () => editor.check.soon() });
  const specimen = createSpecimen(form, { plate });
  const material = createMaterial(form, materials);
  const sides = createSides(form, () => editor.check.soon());
  const spectrum = createSpectrum(form, () => editor.check.soon());
  const loading = createLoading(form, { sides, plate, spectrum });
  const sections = Object.fromEntries(Object.keys(SECTIONS).map((name) => [name, createFields(form, name, keysOf(name))]));
  const laws = choicesOf("fatigue.growth_law").map(({ value, meaning }) => ({ name: value, meaning, constants: known.laws.find((one) => one.name === value)?.constants ?? [] }));
  const law = form.choice("calibration", { label: keyOf("fatigue", "growth_law").label, options: [{ value: BY_HAND, title: titleOf("paris") }], hint: " " });
  law.node.classList.add("wide");
  const lawNote = element("div", { class: "law-note" });
  const constantsOf = (one) => (one?.name === "table" ? ["growth_table", "growth_table_ends"] : one?.constants.map(({ key }) => key) ?? []);
  const allConstants = [...new Set(laws.flatMap(constantsOf))];
  const place = ({ metric }) => (allConstants.includes(metric) ? allConstants.indexOf(metric) : allConstants.length);
  const ofFatigue = createFields(form, "fatigue", keysOf("fatigue").filter(({ metric }) => !OF_CHOICE.includes(metric)).sort((one, other) => place(one) - place(other)));
  const name = form.text("name", { label: "Name of the prediction", optional: true });
  const fields = byId("plate-fields");
  const start = byId("predict");
  const factors = byId("factors");
  let calibrations = [];
  let isStopped = false;

  const isFitted = () => !law.input.value.startsWith("law:");
  const chosenLaw = () => laws.find((one) => `law:${one.name}` === law.input.value);

  function arrange() {
    const kind = specimen.kind();
    loading.suit(kind);
    if (kind === "plate") plate.draw();
    const own = chosenLaw();
    const constants = constantsOf(own);
    ofFatigue.arrange(({ metric }) => (constants.includes(metric) || !allConstants.includes(metric) || (metric === GAMMA))
      && (metric !== THRESHOLD || (own && !constants.some((key) => key.includes("delta_k")))) && (metric !== "initiation" || isThrough(kind)));
    for (const metric of allConstants) need(ofFatigue.by[metric], Boolean(own?.constants.find(({ key }) => key === metric)?.needed));
    const initiation = ofFatigue.by.initiation;
    if (isStopped && kind !== STOPPED) initiation.write();
    isStopped = kind === STOPPED;
    initiation.require(isStopped || undefined);
    if (isStopped) initiation.node.closest("details")?.setAttribute("open", "");
    sections.stop.arrange(({ metric }) => !OF_FLAWS.includes(metric) || !isThrough(kind));
    sections.model.arrange();
    material.needStrength(spectrum.isRetarded());
    const chosen = calibrations.find((one) => one.id === law.input.value);
    show(lawNote, chosen?.summary ? describe(chosen) : element("p", { class: "quiet" }, own?.meaning ?? "",
      calibrations.length === 0 && ["; ", element("a", { href: "#/measure" }, "fit a law to test data")]));
  }

  function describe({ id, summary: s }) {
    const rate = `${rateShown(s.rate_at_pivot_mm_per_cycle, 4)} ± ${percent(s.rate_at_pivot_relative_error)}`;
    const range = spanned(s.delta_k_min_mpa_sqrt_m, s.delta_k_max_mpa_sqrt_m, "MPa√m", 4);
    return element("p", { class: "quiet" },
      `${rate} at ΔK ${sized(s.pivot_delta_k_mpa_sqrt_m, "MPa√m", 4)}, m ${significant(s.paris_m)} ± ${significant(s.paris_m_error, 2)}; `,
      `tested ΔK range ${range}. `,
      element("a", { href: `#/calibrations/${encodeURIComponent(id)}` }, "Open the calibration"));
  }

  function fatigueOf() {
    const own = law.input.value.replace("law:", "");
    // Bonds and powers of ΔK are known by their constants.
    return compact({ ...(isFitted() || ["paris", "bond_law"].includes(own) ? {} : { growth_law: own }), ...ofFatigue.collect() });
  }

  const collect = () => ({
    specimen: specimen.collect(), material: material.collect(), loading: loading.collect(),
    supports: specimen.kind() === "plate" ? sides.supports() : undefined,
    fatigue: fatigueOf(), ...Object.fromEntries(Object.entries(sections).map(([key, own]) => [key, own.collect()]).filter(([, own]) => Object.keys(own).length > 0)),
  });

  /** The law that a case names, or whose constants it gives. */
  function lawOf(fatigue) {
    const has = (one) => one.constants.filter(({ needed }) => needed).every(({ key }) => key in fatigue);
    return laws.find((one) => one.name === fatigue.growth_law) ?? laws.find((one) => ["paris", "bond_law"].includes(one.name) && has(one));
  }

  /** Takes a case over; false where it has what the form cannot show: that stays text. */
  function fill({ specimen: s, material: m, loading: l = {}, supports, fatigue: { growth_law: growthLaw, fitted, ...fatigue } = {}, ...others }) {
    const own = isFitted() || fitted ? null : lawOf({ growth_law: growthLaw, ...fatigue });
    if (own) law.input.value = `law:${own.name}`;
    const isWhole = [isFitted() || !fitted, specimen.fill(s, l), material.fill(m), hasOnly(others, Object.keys(SECTIONS))];
    loading.suit(s.kind);
    isWhole.push(loading.fill(l, supports), ofFatigue.fill(fatigue), ...Object.entries(sections).map(([key, one]) => one.fill(others[key])));
    arrange();
    return isWhole.every(Boolean);
  }

  show(byId("law-fields"), group(keyOf("fatigue", "growth_law").label, grid(law.node), lawNote));
  show(fields, ofFatigue.group("Constants", [...allConstants, THRESHOLD, GAMMA]), specimen.element, material.element, loading.element,
    ...Object.entries(SECTIONS).map(([key, [title, first]]) => sections[key].group(title, first)), group("Run", grid(name.node)));

  // While another run's input is on its way, what is in the form is not what the user means to start.
  let opening = false;
  let further = {}; // options of the run it starts from: a further analysis
  const furtherNote = element("p", { class: "quiet" });
  name.node.after(furtherNote);
  function takeFurther(job) {
    further = Object.fromEntries((job?.options ?? []).map((one) => one.split(/=(.*)/s)));
    show(furtherNote, Object.keys(further).length > 0 && [`Further analysis: ${Object.entries(further).map(([key, value]) => (value === "true" ? words(key) : `${words(key)} ${value}`)).join(", ")} `,
      button("Remove", () => takeFurther(), { class: "button small" })]);
  }
  const files = () => Object.values(Object.fromEntries([...form.files(fields.hidden), ...spectrum.files(fields.hidden), ...form.files(true).filter((one) => one.name === further.measured)].map((one) => [one.name, one])));
  const editor = createEditor({
    host: byId("plate-editor"), fields, panel: byId("plate-check"), form, collect, fill,
    context: () => (!fields.hidden && spectrum.missing()) || { ...(isFitted() ? { calibration: law.input.value } : {}), files: files().length > 0 ? files() : undefined },
    onResult: (ok) => {
      start.disabled = !ok || opening;
      factors.disabled = start.disabled;
    },
    onMode: arrange,
  });

  /** Kind, width, material and load as they were checked, for the list of runs. */
  function defaultName() {
    const { specimen: { kind, width_mm: width } = {}, material: { name: of } = {}, loading: load = {} } = editor.check.last?.case ?? {};
    const key = keysOf("loading").find(({ group: one, metric }) => one && typeof load[metric] === "number");
    const size = key && `${plain(toShown(key, load[key.metric]))} ${key.unit}`;
    const ratio = load.stress_ratio !== undefined && `R ${load.stress_ratio}`;
    return kind ? [`${sentence(words(kind))}${width ? ` W ${plain(inShown(width, "mm"))} ${unitShown("mm")}` : ""}`, of, size, ratio].filter(Boolean).join(", ") : "Prediction";
  }

  /** Finished calibrations as laws to choose from; the newest is the choice until the user makes one. */
  async function loadLaws(wanted) {
    try {
      calibrations = (await getJson("/v1/calibrations?limit=100&state=succeeded")).items;
      // One that is asked for by its address may be older than these.
      if (wanted && wanted !== BY_HAND && !calibrations.some((one) => one.id === wanted)) calibrations.push(await getJson(`/v1/calibrations/${encodeURIComponent(wanted)}`));
      show(byId("law-problem"));
    } catch (error) {
      show(byId("law-problem"), problemBox(error, () => loadLaws(wanted)));
      return;
    }
    const chosen = wanted ?? (law.touched ? law.input.value : calibrations[0]?.id ?? BY_HAND);
    const option = (value, title) => element("option", { value }, title);
    show(law.input, option(BY_HAND, titleOf("paris")),
      calibrations.length > 0 && element("optgroup", { label: "Fitted here" }, calibrations.map((one) => option(one.id, one.name || one.id))),
      element("optgroup", { label: "Other laws" }, laws.filter((one) => one.name !== "paris").map((one) => option(`law:${one.name}`, titleOf(one.name)))));
    law.input.value = [...law.input.options].some((one) => one.value === chosen) ? chosen : BY_HAND;
    await proposeOf(calibrations.find((one) => one.id === law.input.value));
    arrange();
    editor.check.soon();
  }

  /** What a plate with a fitted law begins with: material, thickness and stress ratio of its tests, as long as nothing else was typed. */
  async function proposeOf(calibration) {
    if (!calibration || material.name.touched || editor.check.last) return;
    const { case: tested } = calibration.case ? calibration : await getJson(`/v1/calibrations/${encodeURIComponent(calibration.id)}`);
    material.fill(tested?.material ?? {});
    const thickness = specimen.field("thickness_mm");
    if (thickness && !thickness.touched) thickness.write(tested?.specimen?.thickness_mm);
    loading.propose({ stress_ratio: tested?.loading?.stress_ratio });
  }

  law.input.addEventListener("input", () => proposeOf(calibrations.find((one) => one.id === law.input.value)));
  const starts = (own, path, what, options = () => undefined) => own.addEventListener("click", async () => {
    if (!(await editor.check.now())) return;
    kept("kind", specimen.kind());
    startRun(path, { ...editor.body(), name: name.input.value.trim() || `${what}${defaultName()}`, options: options() }, {
      button: own, status: byId("predict-status"), refuse: editor.check.refuse,
    });
  });
  starts(start, "/v1/predictions", "", () => further);
  starts(factors, "/v1/sif", "K of ");
  byId("plate-example").addEventListener("click", () => editor.startFrom({ ...EXAMPLE, fatigue: isFitted() ? {} : EXAMPLE_LAW }));
  specimen.choose(kept("kind")); // the one that was predicted last

  return {
    /** The case as it is here, {input, calibration?, files?}, or a sentence that says what is missing. */
    body: () => editor.body(),
    /** Waits until the case was checked once. */
    async ready() {
      if (calibrations.length === 0) await loadLaws();
      if (!editor.check.last) await editor.check.now();
    },
    /** The same as the service understood it, null where it did not. */
    checked: () => editor.check.last?.case ?? null,
    /** `law`: a calibration to use; `from`: a run to start from, as collection/id. */
    async open(query) {
      const from = query.get("from");
      opening = Boolean(from);
      start.disabled = true;
      await loadLaws(query.get("law") ?? undefined);
      if (!from) return;
      try {
        const job = await jobToStartFrom(from);
        takeFurther(job);
        if (job.calibration) await loadLaws(job.calibration);
        else law.input.value = BY_HAND;
        const own = (await filesOf(job)).filter(({ name: one }) => !job.calibration || !["fitted.toml", "fit.json"].includes(one));
        form.offer(own);
        await spectrum.load(own, job.input);
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

const titleOf = (name) => sentence(words(name));
