// Measure and calibrate: measured files, the test they come from, and the start of a fit.

import { getBlob } from "./api.js";
import { createEditor } from "./editor.js";
import { byId, show } from "./dom.js";
import { EXAMPLE_NAME, EXAMPLE_TEST, exampleCsv } from "./example.js";
import { compact, createForm, fillIn, grid, group, tellUntilEdited } from "./form.js";
import { jobToStartFrom } from "./job.js";
import { createFields } from "./key_fields.js";
import { hasOnly, keysOf } from "./keys.js";
import { OF_FILES, createMeasured } from "./measured.js";
import { createLoading, createMaterial, createSpecimen } from "./specimen_form.js";
import { startRun } from "./submit.js";

/** Keys of `[measured]` that are set with the files. */
const BESIDE = ["files", "rates", "columns", "leave_out", ...OF_FILES];
const WINDOW = ["from_crack_length_mm", "to_crack_length_mm"];

/** Builds the view; gives {open(query)}. */
export function createCalibrateView(materials) {
  const form = createForm((field) => {
    if (field === from) proposeLength();
    arrange();
    editor.check.soon();
  });
  const ofMeasured = createFields(form, "measured", keysOf("measured").filter(({ metric }) => !BESIDE.includes(metric)));
  const [from, to] = WINDOW.map((metric) => ofMeasured.by[metric]);
  const specimen = createSpecimen(form);
  const material = createMaterial(form, materials);
  const loading = createLoading(form);
  const model = createFields(form, "model", keysOf("model"));
  const fit = createFields(form, "fit", keysOf("fit").filter(({ metric }) => metric !== "given"));
  const name = form.text("name", { label: "Name of the fit", optional: true });
  let noted = ""; // the file whose preamble was read
  const fields = byId("test-fields");
  const start = byId("calibrate");

  function arrange() {
    loading.suit(specimen.kind());
    model.arrange();
  }

  const collect = () => ({
    measured: compact({ files: measured.names(), ...ofMeasured.collect(), ...measured.said() }),
    specimen: specimen.collect(), material: material.collect(), loading: loading.collect(), model: model.collect(), fit: fit.collect(),
  });

  /** The form as a calibration was submitted; false where it has keys that no field shows, which only its text keeps. */
  function fillAll({ measured: m = {}, fit: given = {}, ...test }) {
    const [ofFiles, own] = [true, false].map((is) => Object.fromEntries(Object.entries(m).filter(([key]) => BESIDE.includes(key) === is)));
    const isWhole = [ofMeasured.fill(own), fit.fill(given), fill(test), !ofFiles.rates];
    setTouched(true);
    return isWhole.every(Boolean);
  }

  function setTouched(is) {
    for (const field of [from, to, specimen.field("crack_length_mm")]) if (field) field.touched = is;
  }

  function fill({ specimen: s, material: m, loading: l, model: given, ...others }) {
    const isWhole = [specimen.fill(s), material.fill(m), hasOnly(others, [])];
    loading.suit(s.kind);
    isWhole.push(loading.fill(l), model.fill(given));
    arrange();
    return isWhole.every(Boolean);
  }

  /** What the first file notes above its table, marked as read from it. */
  function proposeNoted() {
    const { file, preamble } = measured.first() ?? {};
    if (!file || file === noted) return;
    noted = file;
    const { kind, material: of, stress_ratio: ratio, ...sizes } = preamble;
    const from = `read from ${file}`;
    if (kind) specimen.choose(kind);
    for (const [metric, value] of Object.entries(sizes)) {
      const field = specimen.field(metric);
      if (value === null || !field || field.touched) continue;
      field.propose(value);
      tellUntilEdited(field, from);
    }
    // Loads of the readings have their own.
    if (measured.loading().stress_ratio === undefined) loading.propose({ stress_ratio: ratio ?? undefined }, from);
    // No material stands in for one that the library has not.
    if (of && !material.name.touched) {
      material.fill({ name: of.name ?? "" });
      tellUntilEdited(material.name, !of.name ? `Material in the file: ${of.stated}; choose one` : of.orientation ? `${from}; no record of orientation ${of.orientation}` : from);
    }
    arrange();
  }

  /** The crack of the specimen begins with the fit window, unless the user sets another. */
  function proposeLength() {
    const length = specimen.field("crack_length_mm");
    if (length && !length.touched) fillIn(length, from.input.value);
  }

  /** Laws of a list need names that differ. */
  function defaultName() {
    const [first, ...others] = measured.names();
    return `${first.replace(/\.[a-z]+$/i, "")}${others.length > 0 ? ` and ${others.length} more` : ""}`;
  }

  const measured = createMeasured(() => {
    const range = measured.window();
    if (range && !from.touched) from.propose(range[0], -1);
    if (range && !to.touched) to.propose(range[1], 1);
    if (range) proposeLength();
    const names = measured.names();
    loading.propose(measured.loading(), `read from ${names.length > 1 ? `${names.length} files` : names[0]}`);
    proposeNoted();
    editor.check.soon();
  });

  show(fields, specimen.element, material.element, loading.element,
    ofMeasured.group("Fit window", WINDOW), fit.group("Fit", ["law"]), model.group("Method", ["method"]), group("Run", grid(name.node)));

  const editor = createEditor({
    host: byId("test-editor"), fields, panel: byId("test-check"), form, collect,
    // What comes back of a calibration is its case alone: the form keeps its own window and fit.
    fill: () => false,
    context: () => {
      const files = measured.files();
      return files ? { files: [...files, ...form.files(fields.hidden)] } : "Add measured data first.";
    },
    onResult: (ok) => {
      start.disabled = !ok;
    },
  });
  arrange();

  byId("example").addEventListener("click", async () => {
    setTouched(false);
    fill(EXAMPLE_TEST);
    await measured.loadExample(EXAMPLE_NAME, exampleCsv());
  });
  start.addEventListener("click", async () => {
    if (!(await editor.check.now())) return;
    startRun("/v1/calibrations", { ...editor.body(), name: name.input.value.trim() || defaultName() }, {
      button: start, status: byId("calibrate-status"), refuse: editor.check.refuse,
    });
  });

  /** Starts from a calibration: its files, its test, excluded readings. */
  async function openFrom(id) {
    const job = await jobToStartFrom(id);
    const files = await Promise.all(job.inputs.map(async ({ name: own, href }) => {
      const file = await getBlob(href);
      return { name: own, file, text: /\.(xlsx|xlsm)$/i.test(own) ? null : await file.text() };
    }));
    const isMeasured = ({ name: own }) => job.case.measured.files.includes(own);
    form.offer(files.filter((one) => !isMeasured(one)));
    const isShown = fillAll(job.case);
    // What was submitted is not proposed again.
    noted = job.case.measured.files[0];
    await measured.load(files.filter(isMeasured), job.case.measured);
    fillIn(name, job.name);
    if (!isShown) editor.start(job.input);
  }

  editor.check.now();
  return {
    /** `from`: a calibration to start from, as collection/id; `example`: example data. */
    async open(query) {
      if (query.has("example")) byId("example").click();
      if (!query.get("from")) return;
      try {
        await openFrom(query.get("from"));
      } catch (error) {
        editor.check.refuse(error);
      }
    },
  };
}
