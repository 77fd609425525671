// A sweep over the plate of the form Predict: which keys vary, how, and how many cases there are.

import { getText } from "./api.js";
import { button, element, show } from "./dom.js";
import { createEditor } from "./editor.js";
import { compact, createForm, fillIn, grid, group, need } from "./form.js";
import { plain, sentence, words } from "./format.js";
import { createFields } from "./key_fields.js";
import { keysOf } from "./keys.js";
import { startRun } from "./submit.js";
import { writeToml } from "./toml.js";

const CASE = "case.toml";
/** Numbers that say how a key varies: of a grid, and of every distribution. */
const OF_GRID = ["from", "to", "count"];
const OF_DISTRIBUTION = { uniform: ["from", "to"], log_uniform: ["from", "to"], normal: ["mean", "standard_deviation"], log_normal: ["median", "factor"] };
const VARIES_MAX = 4;

/** `base()` gives the case as {input, calibration?, files?} or a sentence, `checked()` as it was understood. Gives {fromBase()}. */
export function createSweep({ host, fields, panel, start, status, base, checked }) {
  const form = createForm(() => {
    arrange();
    editor.check.soon();
  });
  const ofDesign = createFields(form, "design", keysOf("sweep.design"));
  // Of any fit the constants have errors, few have specimens enough.
  ofDesign.fill({ kind: "grid", scatter: "constants", samples: 100, seed: 1 });
  const design = ofDesign.by.kind;
  const name = form.text("name", { label: "Name of the sweep", optional: true });
  const rows = element("div", { class: "stack tight" });
  const about = element("p", { class: "quiet" });
  let vary = []; // {key, own, node}
  const files = new Map(); // of calibrations, by their address

  const isGrid = () => design.input.value === "grid";

  /** Numbers of the case by their keys, with what they are now. */
  function numbersOf(value, path) {
    if (typeof value === "number") return [[path, value]];
    if (typeof value !== "object" || value === null || Array.isArray(value)) return [];
    return Object.entries(value).flatMap(([key, inner]) => numbersOf(inner, path ? `${path}.${key}` : key));
  }

  function addRow(given = {}) {
    const index = vary.length;
    const known = numbersOf(checked() ?? base().input ?? {}, "");
    const key = form.choice(`vary[${index}].key`, { label: "Varied", options: [...known.map(([path, value]) => ({ value: path, title: `${path}, now ${plain(value)}` })),
      ...(given.key && !known.some(([path]) => path === given.key) ? [{ value: given.key, title: given.key }] : [])] });
    const own = createFields(form, `vary[${index}]`, keysOf("sweep.vary[]").filter(({ metric }) => metric !== "key" && metric !== "values"));
    const remove = button("Remove", () => rebuild(vary.map(collectRow).filter((_, other) => other !== index)), { class: "button small end", "aria-label": `Remove varied key ${index + 1}` });
    const row = { key, own, node: element("div", { class: "fields", "data-vary": index }, key.node, own.nodes, remove) };
    fillIn(key, given.key ?? known.find(([path]) => path.startsWith("loading."))?.[0] ?? known[0]?.[0]);
    // Around the value of the case, to start from something sensible.
    const now = known.find(([path]) => path === key.input.value)?.[1];
    const around = Number.isFinite(now) ? { from: 0.9 * now, to: 1.1 * now, mean: now, standard_deviation: Math.abs(0.05 * now), median: now } : {};
    const start = { count: 5, factor: 1.1, scale: "linear", distribution: "normal", ...around };
    own.fill(given.key ? { scale: start.scale, distribution: start.distribution, ...given, key: undefined }
      : Object.fromEntries(Object.entries(start).map(([one, value]) => [one, Number.isFinite(value) ? Number(value.toPrecision(6)) : value])));
    vary.push(row);
  }

  const used = ({ own }) => (isGrid() ? ["scale", ...OF_GRID] : ["distribution", ...(OF_DISTRIBUTION[own.by.distribution.read()] ?? [])]);
  const collectRow = ({ key, own }) => compact({ key: key.input.value, ...own.collect() });

  function rebuild(list) {
    form.drop(vary.map((row) => row.key));
    vary.forEach((row) => row.own.drop());
    vary = [];
    list.forEach((given) => addRow(given));
    show(rows, vary.map((row) => row.node));
    arrange();
    editor.check.soon();
  }

  function arrange() {
    const suits = { scatter: design.input.value === "fitted_scatter", samples: !isGrid(), seed: !isGrid() };
    ofDesign.arrange(({ metric }) => suits[metric] ?? true);
    for (const row of vary) {
      row.own.arrange(({ metric }) => used(row).includes(metric));
      for (const field of Object.values(row.own.by)) need(field, OF_GRID.concat(Object.values(OF_DISTRIBUTION).flat()).includes(field.key.metric));
    }
  }

  const collect = () => ({ case: CASE, design: ofDesign.collect(), vary: vary.length > 0 ? vary.map(collectRow) : undefined });

  /** A file of a calibration; undefined until it is there, null where it has none. */
  function fileOf(id, file) {
    const address = `/v1/calibrations/${encodeURIComponent(id)}/files/${file}`;
    if (!files.has(address)) {
      files.set(address, undefined);
      getText(address).catch(() => null).then((text) => {
        files.set(address, text);
        editor.check.soon();
      });
    }
    return files.get(address);
  }

  /** The case and the law it names, as files of the sweep. */
  function context() {
    if (!checked()) return "Complete the case on Predict first.";
    const given = base();
    if (typeof given === "string") return given;
    const fitted = given.calibration && ["fitted.toml", "fit.json"].map((file) => [file, fileOf(given.calibration, file)]);
    if (fitted?.some(([, text]) => text === undefined)) return "The law is being fetched.";
    const input = fitted && typeof given.input === "string" ? checked() : given.input;
    const text = typeof input === "string" ? input : writeToml({ ...input, ...(fitted ? { fatigue: { ...input.fatigue, fitted: "fitted.toml" } } : {}) });
    const sent = [[CASE, text], ...(fitted ?? [])].filter(([, content]) => content !== null);
    return { files: [...sent.map(([file, content]) => ({ name: file, text: content, file: new Blob([content]) })), ...(given.files ?? [])] };
  }

  const add = button("Vary a key", () => rebuild([...vary.map(collectRow), {}].slice(0, VARIES_MAX)), { class: "button small", "data-action": "vary" });
  show(fields, about, group(design.key.label, grid(...ofDesign.nodes, name.node)), group("What varies", rows, element("p", { class: "tool-row" }, add)));
  const editor = createEditor({
    host, fields, panel, form, collect, fill: () => false, context,
    onResult: (ok) => {
      start.disabled = !ok;
    },
  });
  const nameOf = (specimen) => (specimen ? sentence(words(specimen.kind)) : "the plate of Predict");
  start.addEventListener("click", async () => {
    if (!(await editor.check.now())) return;
    const keys = vary.map((row) => words(row.key.input.value.split(".").pop().replace(/_(mm|mpa|gpa|kn|n)$/, ""))).join(", ");
    startRun("/v1/sweeps", { ...editor.body(), name: name.input.value.trim() || `${nameOf(checked()?.specimen)}: ${keys || "scatter of the law"}` }, { button: start, status, refuse: editor.check.refuse });
  });

  return {
    /** Begins with the case of the form Predict as it is now. */
    fromBase() {
      const understood = checked();
      const { kind, width_mm: width, length_mm: length } = understood?.specimen ?? {};
      show(about, "The case is that of ", element("a", { href: "#/predict" }, "Predict"),
        kind ? `: ${words(kind)}, ${[width, length].filter(Boolean).map((value) => plain(value)).join(" × ")} mm.` : ", which is not complete yet.");
      rebuild(vary.length > 0 ? vary.map(collectRow) : [{}]);
    },
  };
}
