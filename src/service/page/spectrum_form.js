// A spectrum of loads: its file, chosen or pasted, what is left out of it, and how large cycles slow down those after them. Formats, models and
// their constants are those that the service lists.

import { element, show, uniqueId } from "./dom.js";
import { compact, fillIn, grid, numberIn } from "./form.js";
import { bytes, plain, sentence, words } from "./format.js";

/** Name of a spectrum that was pasted. */
const PASTED = "spectrum.csv";
const SAMPLE = "max,min,cycles\n1,-0.1,1\n0.7,0.2,40\n0.5,0.1,300";
const LABELS = {
  wheeler_exponent: "Wheeler’s exponent m", shutoff_ratio: "Shut-off ratio S", willenborg_k_th_mpa_sqrt_m: "K at the threshold, R = 0",
  closure_cf0: "Closure factor Cf0", newman_alpha: "Constraint factor α", newman_smax_over_flow: "Smax / flow stress",
};
const OF_FILE = ["spectrum_format", "omission_percent", "truncation_percent", "repeats"];

/** Whether a key of the load is one of a spectrum. */
export const isOfSpectrum = (key) => key.startsWith("spectrum_scale");

/** `onChange` is told when another file or model stands there. Gives {element, setKinds(known), arrange({used, isThrough}), model(), files(), missing(), load(files), collect(), fill(loading)}. */
export function createSpectrum(form, onChange) {
  let file = null; // {name, text}
  let models = [];
  let constants = {}; // fields by key, those of the chosen model
  let [used, isThrough] = [false, true];

  const [inputId, areaId] = [uniqueId("spectrum-file"), uniqueId("spectrum-text")];
  const input = element("input", { type: "file", id: inputId, "data-key": "loading.spectrum_file" });
  const area = element("textarea", { id: areaId, rows: "5", spellcheck: "false", autocapitalize: "off", placeholder: SAMPLE, "data-spectrum": "text" });
  const told = element("p", { class: "quiet", role: "status" });
  const drop = element("div", { class: "drop" }, element("label", { for: inputId }, "Spectrum file"), input,
    element("p", { class: "hint" }, "Cycles max, min, cycles in their order; turning points in one column; AFGROW .spx or .sub; FASTRAN. Chosen or dropped here, or pasted below. ",
      "Values are shares of the stress or force above."),
    element("div", { class: "field" }, element("label", { for: areaId }, "Text of the file"), area), told);

  const format = form.choice("loading.spectrum_format", { label: "Written as", options: [{ value: "", title: "as recognised" }] });
  const percent = (key, label, hint) => form.number(`loading.${key}`, { label, unit: "%", optional: true, hint });
  const omission = percent("omission_percent", "Leave out ranges below", "of the largest range");
  const truncation = percent("truncation_percent", "Cut off peaks above", "of the largest load");
  const repeats = form.number("loading.repeats", { label: "Passes at the most", optional: true, hint: "left out: again and again" });
  const ofFile = { spectrum_format: format, omission_percent: omission, truncation_percent: truncation, repeats };

  const model = form.choice("loading.retardation", { label: "Retardation by overloads", options: [{ value: "none", title: "None" }] });
  model.node.classList.add("wide");
  const ofModel = element("div", { class: "fields" });
  const meaning = element("p", { class: "hint" });
  const retardation = element("div", { class: "stack tight" }, grid(model.node), ofModel, meaning);
  const notThrough = element("p", { class: "hint", hidden: true }, "No retardation: both ends of a crack that is not through grow by the mean rate of a pass.");

  const chosen = () => models.find((one) => one.name === model.input.value);
  const isRetarded = () => isThrough && model.input.value !== "none";

  /** Fields for the constants of the chosen model. */
  function drawConstants() {
    form.drop(Object.values(constants));
    constants = Object.fromEntries((chosen()?.constants ?? []).map(({ key, unit, what, needed }) => [key,
      form.number(`loading.${key}`, { label: LABELS[key] ?? sentence(words(key)), unit, hint: what, optional: !needed })]));
    show(ofModel, Object.values(constants).map((field) => field.node));
    ofModel.hidden = Object.keys(constants).length === 0;
    meaning.textContent = chosen() ? `${sentence(chosen().meaning)}.${isRetarded() ? " Needs the yield strength of the material." : ""}` : "";
  }
  model.input.addEventListener("input", drawConstants);

  function take(next) {
    file = next && next.text.trim() !== "" ? next : null;
    if (area.value !== (file?.text ?? "")) area.value = file?.text ?? "";
    told.textContent = file ? `${file.name}, ${bytes(new Blob([file.text]).size)}, ${plain(file.text.trim().split(/\n/).length)} lines` : "";
    onChange();
  }

  async function add([first]) {
    if (first) take({ name: first.name, text: await first.text() });
  }

  input.addEventListener("change", async () => {
    await add(input.files);
    input.value = ""; // the same file may be chosen again after a correction
  });
  area.addEventListener("input", () => take({ name: file?.name ?? PASTED, text: area.value }));
  for (const name of ["dragenter", "dragover", "dragleave", "drop"]) {
    drop.addEventListener(name, (event) => {
      event.preventDefault();
      drop.classList.toggle("over", name.startsWith("drage") || name === "dragover");
    });
  }
  drop.addEventListener("drop", (event) => add(event.dataTransfer.files));

  const root = element("div", { class: "stack tight spectrum-form", hidden: true }, drop, grid(...Object.values(ofFile).map((field) => field.node)), retardation, notThrough);
  drawConstants();

  return {
    element: root,
    setKinds({ kinds, retardations }) {
      if (models.length > 0) return;
      models = retardations;
      const options = (list) => list.map(({ name, title }) => element("option", { value: name }, title));
      const formats = kinds.filter((one) => one.key === "loading.spectrum_format");
      show(format.input, options([{ name: "", title: "as recognised" }, ...formats.map(({ name }) => ({ name, title: sentence(words(name)) }))]));
      show(model.input, options(models.map(({ name }) => ({ name, title: sentence(words(name)) }))));
      drawConstants();
    },
    /** `used`: the load is a spectrum; `isThrough`: the crack goes through the plate. */
    arrange(now) {
      ({ used, isThrough } = now);
      root.hidden = !used;
      retardation.hidden = !isThrough;
      notThrough.hidden = isThrough;
    },
    isUsed: () => used,
    isRetarded: () => used && isRetarded(),
    files: () => (file ? [{ name: file.name, text: file.text, file: new Blob([file.text]) }] : undefined),
    /** What is still missing, in a sentence. */
    missing: () => (used && !file ? "Choose or paste the file of the spectrum." : null),
    /** The file of another run, among all that it named: {name, file}. */
    async load(files, text) {
      const found = files.find(({ name }) => text.includes(JSON.stringify(name)) && name !== "fitted.toml");
      if (found) take({ name: found.name, text: await found.file.text() });
    },
    collect() {
      const given = Object.entries({ omission_percent: omission, truncation_percent: truncation, repeats }).map(([key, field]) => [key, numberIn(field)]);
      const own = isRetarded() ? Object.entries(constants).map(([key, field]) => [key, numberIn(field)]) : [];
      return compact({
        spectrum_file: file?.name, spectrum_format: format.input.value, ...Object.fromEntries(given),
        retardation: isRetarded() ? model.input.value : undefined, ...Object.fromEntries(own),
      });
    },
    /** Takes over what `[loading]` says; false when it says something that no field shows. */
    fill({ spectrum_file: name, retardation: wanted = "none", ...loading }) {
      const own = models.find((one) => one.name === wanted)?.constants.map(({ key }) => key) ?? [];
      const others = Object.keys(loading).filter((key) => ![...OF_FILE, ...own].includes(key));
      if (others.length > 0 || (name && name !== file?.name)) return false;
      for (const [key, field] of Object.entries(ofFile)) fillIn(field, loading[key]);
      fillIn(model, wanted);
      drawConstants();
      for (const [key, field] of Object.entries(constants)) fillIn(field, loading[key]);
      return true;
    },
  };
}
