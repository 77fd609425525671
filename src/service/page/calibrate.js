// Measure and calibrate: measured files, the test they come from, and the start of a fit.

import { getBlob } from "./api.js";
import { createEditor } from "./editor.js";
import { byId, show } from "./dom.js";
import { EXAMPLE_NAME, EXAMPLE_TEST, exampleCsv } from "./example.js";
import { compact, createForm, fillIn, grid, group, numberIn } from "./form.js";
import { jobToStartFrom } from "./job.js";
import { createMeasured } from "./measured.js";
import { createLoading, createMaterial, createSpecimen } from "./specimen_form.js";
import { startRun } from "./submit.js";

const PARAMETERS = [
  { value: "a,p", title: "A and p" },
  { value: "a", title: "A, p given" },
];

/** Builds the view; gives {setMaterials}. */
export function createCalibrateView() {
  const form = createForm((field) => {
    if (field === from && !specimen.fields.crack_length_mm.touched) fillIn(specimen.fields.crack_length_mm, from.input.value);
    arrange();
    editor.check.soon();
  });
  const length = { unit: "mm", optional: true };
  const from = form.number("measured.from_crack_length_mm", { ...length, label: "From crack length", hint: "first reading that every specimen has" });
  const to = form.number("measured.to_crack_length_mm", { ...length, label: "To crack length", hint: "last reading that every specimen has" });
  const specimen = createSpecimen(form);
  // Toughness ends a prediction; a test that was measured is known to have got where it got.
  const material = createMaterial(form, { toughness: false });
  const loading = createLoading(form);
  const spacing = form.number("model.spacing_mm", { ...length, label: "Spacing of points", hint: "left empty: the program chooses the model" });
  const parameters = form.choice("fit.parameters", { label: "Fitted", options: PARAMETERS });
  const exponent = form.number("fit.p", { label: "Exponent p", hint: "of the law in use, not the Paris m" });
  const name = form.text("name", { label: "Name of the fit", optional: true });
  const fields = byId("test-fields");
  const start = byId("calibrate");

  function arrange() {
    loading.suit(specimen.fields.kind.input.value);
    exponent.node.hidden = parameters.input.value !== "a";
  }

  function collect() {
    const fitted = parameters.input.value.split(",");
    return {
      measured: compact({ files: measured.names(), from_crack_length_mm: numberIn(from), to_crack_length_mm: numberIn(to), ...measured.said() }),
      specimen: specimen.collect(),
      material: material.collect(),
      loading: loading.collect(),
      model: compact({ spacing_mm: numberIn(spacing) }),
      fit: compact({ parameters: fitted, p: fitted.length === 1 ? numberIn(exponent) : undefined }),
    };
  }

  /** The form as a calibration was submitted; false where it says what no field shows, which is then lost but for its text. */
  function fillAll({ measured: m = {}, fit = {}, ...test }) {
    fillIn(from, m.from_crack_length_mm);
    fillIn(to, m.to_crack_length_mm);
    [from, to, specimen.fields.crack_length_mm].forEach((field) => {
      field.touched = true;
    });
    fillIn(parameters, (fit.parameters ?? ["a", "p"]).join(","));
    fillIn(exponent, fit.p);
    return fill(test) && !m.rates;
  }

  function fill(test) {
    const known = specimen.fill(test.specimen) && material.fill(test.material) && loading.fill(test.loading);
    fillIn(spacing, test.model?.spacing_mm);
    arrange();
    return known;
  }

  /** A list of laws is of use only when they can be told apart. */
  function defaultName() {
    const [first, ...others] = measured.names();
    return `${first.replace(/\.[a-z]+$/i, "")}${others.length > 0 ? ` and ${others.length} more` : ""}`;
  }

  const measured = createMeasured(() => {
    const range = measured.window();
    if (range && !from.touched) fillIn(from, range[0]);
    if (range && !to.touched) fillIn(to, range[1]);
    if (range && !specimen.fields.crack_length_mm.touched) fillIn(specimen.fields.crack_length_mm, from.input.value);
    loading.propose(measured.loading());
    editor.check.soon();
  });

  show(fields, specimen.element, material.element, loading.element,
    group("Fit", grid(from.node, to.node, spacing.node, parameters.node, exponent.node, name.node)));

  const editor = createEditor({
    host: byId("test-editor"), fields, panel: byId("test-check"), form, collect,
    // What comes back of a calibration is its case alone: the form keeps its own window and fit.
    fill: () => false,
    context: () => {
      const files = measured.files();
      return files ? { files } : "Load measured data first: the test is checked together with it.";
    },
    onResult: (ok) => {
      start.disabled = !ok;
    },
  });
  arrange();

  byId("example").addEventListener("click", async () => {
    for (const field of [from, to, specimen.fields.crack_length_mm]) field.touched = false;
    fill(EXAMPLE_TEST);
    await measured.loadExample(EXAMPLE_NAME, exampleCsv());
  });
  start.addEventListener("click", async () => {
    if (!(await editor.check.now())) return;
    startRun("/v1/calibrations", { ...editor.body(), name: name.input.value.trim() || defaultName() }, {
      button: start, status: byId("calibrate-status"), refuse: editor.check.refuse,
    });
  });

  /** Starts from a calibration: its files, its test, what was left out. */
  async function openFrom(id) {
    const job = await jobToStartFrom(id);
    const files = await Promise.all(job.inputs.map(async ({ name: own, href }) => {
      const file = await getBlob(href);
      return { name: own, file, text: /\.(xlsx|xlsm)$/i.test(own) ? null : await file.text() };
    }));
    const isShown = fillAll(job.case);
    await measured.load(files, job.case.measured);
    fillIn(name, job.name);
    if (!isShown) editor.start(job.input);
  }

  editor.check.now();
  return {
    setMaterials(list) {
      material.setMaterials(list);
      editor.check.soon();
    },
    /** `from`: a calibration to start from, as collection/id. */
    async open(query) {
      if (!query.get("from")) return;
      try {
        await openFrom(query.get("from"));
      } catch (error) {
        editor.check.refuse(error);
      }
    },
  };
}
