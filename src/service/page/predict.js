// A plate that nobody tested: its form, the law to use, and the start of a prediction.

import { getJson } from "./api.js";
import { byId, element, show } from "./dom.js";
import { createEditor } from "./editor.js";
import { compact, createForm, fillIn, grid, group, numberIn } from "./form.js";
import { percent, scientific, sentence, significant, words } from "./format.js";
import { createPlate } from "./plate_form.js";
import { problemBox } from "./notices.js";
import { createLoading, createMaterial, createSpecimen } from "./specimen_form.js";
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
  const loading = createLoading(form);
  const law = form.choice("calibration", { label: "Taken from", options: [{ value: "", title: "Constants given here" }] });
  const constants = {
    a: form.number("fatigue.a", { label: "A", unit: "1/cycle" }),
    p: form.number("fatigue.p", { label: "Exponent p", hint: "not the Paris exponent m" }),
    horizon_mm: form.number("fatigue.horizon_mm", { label: "At horizon", unit: "mm", hint: "A holds for this horizon" }),
  };
  law.node.classList.add("wide");
  const lawNote = element("div", { class: "law-note" });
  const length = { unit: "mm", optional: true };
  const spacing = form.number("model.spacing_mm", {
    ...length, label: "Spacing of points", hint: "left empty: the program chooses the model",
  });
  const stopLength = form.number("stop.crack_length_mm", { ...length, label: "Stop at crack length" });
  const stopCycles = form.number("stop.cycles_max", { label: "Stop after", unit: "cycles", optional: true });
  const name = form.text("name", { label: "Name of the prediction", optional: true });
  const fields = byId("plate-fields");
  const start = byId("predict");
  let calibrations = [];

  function arrange() {
    const kind = specimen.fields.kind.input.value;
    loading.suit(kind);
    if (kind === "plate") plate.draw();
    for (const field of Object.values(constants)) field.node.hidden = law.input.value !== "" || fields.hidden;
    const chosen = calibrations.find((one) => one.id === law.input.value);
    show(lawNote, chosen?.summary ? describe(chosen) : calibrations.length === 0 && element("p", { class: "quiet" },
      "No calibration has been made here yet: ", element("a", { href: "#/measure" }, "fit measured curves"), ", or give constants."));
  }

  function describe({ id, summary: s }) {
    const rate = `${scientific(s.rate_at_pivot_mm_per_cycle)} mm/cycle ± ${percent(s.rate_at_pivot_relative_error)}`;
    const range = `${significant(s.delta_k_min_mpa_sqrt_m, 3)} to ${significant(s.delta_k_max_mpa_sqrt_m, 3)} MPa√m`;
    return element("p", { class: "quiet" },
      `${rate} at ΔK ${significant(s.pivot_delta_k_mpa_sqrt_m)} MPa√m, m ${significant(s.paris_m)} ± ${significant(s.paris_m_error, 2)}; `,
      `fitted for ΔK from ${range}. `,
      element("a", { href: `#/calibrations/${encodeURIComponent(id)}` }, "Open the calibration"));
  }

  function collect() {
    const given = Object.fromEntries(Object.entries(constants).map(([key, field]) => [key, numberIn(field)]));
    return {
      specimen: specimen.collect(),
      material: material.collect(),
      loading: loading.collect(),
      model: compact({ spacing_mm: numberIn(spacing) }),
      ...(law.input.value ? {} : { fatigue: compact(given) }),
      stop: compact({ crack_length_mm: numberIn(stopLength), cycles_max: numberIn(stopCycles) }),
    };
  }

  /** Only what the form can show: anything else stays text. */
  function fill(input) {
    const { specimen: s, material: m, loading: l, model = {}, fatigue = {}, stop = {}, ...others } = input;
    const filled = (table) => Object.keys(table ?? {}).length > 0;
    const beyond = (table, known) => Object.keys(table).some((key) => !known.includes(key));
    const lawHere = law.input.value === "";
    const tooMuch = Object.values(others).some(filled) || beyond(model, ["spacing_mm"]) || beyond(stop, ["crack_length_mm", "cycles_max"]) ||
      (lawHere && beyond(fatigue, Object.keys(constants))) || (!lawHere && beyond(fatigue, ["fitted"]));
    if (tooMuch || !specimen.fill(s) || !material.fill(m) || !loading.fill(l)) return false;
    fillIn(spacing, model.spacing_mm);
    fillIn(stopLength, stop.crack_length_mm);
    fillIn(stopCycles, stop.cycles_max);
    if (lawHere) Object.entries(constants).forEach(([key, field]) => fillIn(field, fatigue[key]));
    arrange();
    return true;
  }

  show(fields, specimen.element, material.element, loading.element,
    group("Model and stop", grid(spacing.node, stopLength.node, stopCycles.node, name.node)));
  show(byId("law-fields"), group("Growth law", grid(law.node, ...Object.values(constants).map((field) => field.node)), lawNote));

  // While another run's input is on its way, what stands in the form is not what the user means to start.
  let opening = false;
  const editor = createEditor({
    host: byId("plate-editor"), fields, panel: byId("plate-check"), form, collect, fill,
    context: () => (law.input.value ? { calibration: law.input.value } : {}),
    onResult: (ok) => {
      start.disabled = !ok || opening;
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
      calibrations = (await getJson("/v1/calibrations?limit=100&state=succeeded")).items;
      // One that is asked for by its address may be older than these.
      const known = calibrations.some((one) => one.id === wanted);
      if (wanted && !known) calibrations.push(await getJson(`/v1/calibrations/${encodeURIComponent(wanted)}`));
      show(byId("law-problem"));
    } catch (error) {
      show(byId("law-problem"), problemBox(error, () => loadLaws(wanted)));
      return;
    }
    const chosen = wanted ?? (law.touched ? law.input.value : calibrations[0]?.id ?? "");
    show(law.input, calibrations.map((one) => element("option", { value: one.id }, one.name || one.id)),
      element("option", { value: "" }, "Constants given here"));
    law.input.value = calibrations.some((one) => one.id === chosen) ? chosen : "";
    arrange();
    editor.check.soon();
  }

  start.addEventListener("click", async () => {
    if (!(await editor.check.now())) return;
    startRun("/v1/predictions", { ...editor.body(), name: name.input.value.trim() || defaultName() }, {
      button: start, status: byId("predict-status"), refuse: editor.check.refuse,
    });
  });

  let opened = false;
  return {
    setMaterials(list) {
      material.setMaterials(list);
      if (!opened) editor.startFrom(START);
      opened = true;
    },
    /** `law`: a calibration to use; `from`: a prediction to start from. */
    async open(query) {
      const from = query.get("from");
      opening = Boolean(from);
      start.disabled = true;
      await loadLaws(query.get("law") ?? undefined);
      if (!from) return;
      try {
        const job = await getJson(`/v1/predictions/${encodeURIComponent(from)}`);
        if (job.calibration) await loadLaws(job.calibration);
        else fillIn(law, "");
        opened = true;
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
