// A load spectrum: its file, chosen or pasted, what is omitted and clipped, and the retardation model with its constants.

import { element, takeDrops, uniqueId } from "./dom.js";
import { compact, grid, need } from "./form.js";
import { bytes, plain, sentence } from "./format.js";
import { createFields } from "./key_fields.js";
import { keyOf, keysOf, known } from "./keys.js";

/** Name of a spectrum that was pasted. */
const PASTED = "spectrum.csv";
const SAMPLE = "max,min,cycles\n1,-0.1,1\n0.7,0.2,40\n0.5,0.1,300";
const FILE = "spectrum_file";
const MODEL = "retardation";

const modelKeys = () => [MODEL, ...known.retardations.flatMap(({ constants }) => constants.map(({ key }) => key))];
const fileKeys = () => keysOf("loading").filter(({ only, group }) => only?.values.includes("spectrum") && !group).map(({ metric }) => metric);

/** Keys of `[loading]` that this form has, by their metric names. */
export const spectrumKeys = () => [...fileKeys(), ...modelKeys()];

/** `onChange` is called when the file is another. Gives {element, arrange(used), isRetarded(), files(), missing(), load(files), collect(), fill(loading)}. */
export function createSpectrum(form, onChange) {
  let file = null; // {name, text}
  let used = false;

  const [inputId, areaId] = [uniqueId("spectrum-file"), uniqueId("spectrum-text")];
  const input = element("input", { type: "file", id: inputId, "data-key": `loading.${FILE}` });
  const area = element("textarea", { id: areaId, rows: "5", spellcheck: "false", autocapitalize: "off", placeholder: SAMPLE, "data-spectrum": "text" });
  const told = element("p", { class: "quiet", role: "status" });
  const drop = element("div", { class: "drop" }, element("label", { for: inputId }, keyOf("loading", FILE).label), input,
    element("p", { class: "hint" }, `${sentence(keyOf("loading", FILE).hint)}. Values are fractions of the stress or force above.`),
    element("div", { class: "field" }, element("label", { for: areaId }, "Text of the file"), area), told);

  const keys = (names) => keysOf("loading").filter(({ metric }) => names.includes(metric));
  const ofFile = createFields(form, "loading", keys(fileKeys().filter((metric) => metric !== FILE)));
  const ofModel = createFields(form, "loading", keys(modelKeys()));
  const model = ofModel.by[MODEL];
  model.node.classList.add("wide");
  const chosen = () => known.retardations.find((one) => one.name === model.read());
  const isRetarded = () => (chosen()?.constants.length ?? 0) > 0;

  function arrange() {
    const constants = chosen()?.constants ?? [];
    ofModel.arrange(({ metric }) => metric === MODEL || constants.some(({ key }) => key === metric));
    for (const { key, needed } of constants) need(ofModel.by[key], needed);
  }
  model.input.addEventListener("input", arrange);

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
  takeDrops(drop, add);

  const root = element("div", { class: "stack tight spectrum-form", hidden: true }, drop, grid(...ofFile.nodes), grid(...ofModel.nodes));
  arrange();

  return {
    element: root,
    arrange(isUsed) {
      used = isUsed;
      root.hidden = !used;
    },
    isRetarded: () => used && isRetarded(),
    files: (isText) => ((used || isText) && file ? [{ name: file.name, text: file.text, file: new Blob([file.text]) }] : []),
    /** What is still missing, in a sentence. */
    missing: () => (used && !file ? "Choose or paste the file of the spectrum." : null),
    /** The file of another run, among all that it named: {name, file}. */
    async load(files, text) {
      const found = files.find(({ name }) => text.split("\n").some((line) => line.includes(FILE) && line.includes(JSON.stringify(name))));
      if (found) take({ name: found.name, text: await found.file.text() });
    },
    collect: () => compact({ [FILE]: file?.name, ...ofFile.collect(), ...ofModel.collect() }),
    /** Takes keys of `[loading]` over; false when they name another file. */
    fill({ [FILE]: name, ...loading }) {
      const [own, others] = [true, false].map((is) => Object.fromEntries(Object.entries(loading).filter(([metric]) => modelKeys().includes(metric) === is)));
      const isWhole = [ofModel.fill(own), ofFile.fill(others), !name || name === file?.name];
      arrange();
      return isWhole.every(Boolean);
    },
  };
}
