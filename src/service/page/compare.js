// Several predictions side by side: lives with their bands on one axis, what differs in their inputs, all curves in one chart.

import { bar, kindOfVerdict, lifeShown, mark, quantilesOf } from "./answer.js";
import { getJson, getText } from "./api.js";
import { createChart } from "./chart.js";
import { element, readCsv, section, showPage, table } from "./dom.js";
import { NONE, cycles, fixed, plain, sentence, significant, words } from "./format.js";
import { hrefOf, nameOf, pathOf } from "./job.js";
import { keysOf, loadKeys, toShown } from "./keys.js";
import { COMPARE_MAX } from "./runs.js";

const letterOf = (index) => String.fromCharCode(65 + index);

export async function openComparison(root, ids, signal) {
  const chosen = ids.slice(0, COMPARE_MAX);
  const [jobs] = await Promise.all([Promise.all(chosen.map((id) => getJson(`/v1/predictions/${encodeURIComponent(id)}`, signal))), loadKeys()]);
  const done = jobs.filter((job) => job.state === "succeeded" && !job.summary.refused);
  const curves = await Promise.all(done.map((job) => getText(`${pathOf(job)}/files/a_n.csv?points=600`, signal).then(readCsv)));
  const fits = [...new Set(done.map((job) => job.calibration).filter(Boolean))];
  const laws = new Map(await Promise.all(fits.map(async (id) => [id, await getJson(`/v1/calibrations/${encodeURIComponent(id)}`, signal).then(nameOf, () => "a fit that is gone")])));
  if (signal.aborted) return;
  const chartPlace = element("div");
  showPage(root,
    element("header", { class: "job-head", id: "comparison" },
      element("div", { class: "title-row" }, element("h1", { tabindex: "-1" }, "Comparison of lives"),
        element("div", { class: "tool-row end" }, element("a", { class: "button", href: "#/runs" }, "Back to the runs")))),
    done.length < jobs.length && element("p", { class: "notice warn" }, "Runs without a valid life are not compared."),
    element("div", { class: "job-body" }, tableOf(done), element("div", { class: "card figure" }, chartPlace), differences(done, laws)));
  const chart = createChart(chartPlace, {
    name: "compare", title: "Crack length over cycles",
    label: "Crack length against cycles of the compared predictions",
    x: { label: "Cycles N", format: (value) => cycles(Math.round(value)), from: 0 },
    y: { label: "Crack length a", unit: "mm", format: (value) => fixed(value, 2) },
    ratio: 0.42, note: "Curves differ by letter and dash.",
  });
  signal.addEventListener("abort", () => chart.destroy());
  chart.set(done.flatMap((job, index) => {
    const { cycles: x, crack_length_mm: y } = curves[index];
    return [{ id: job.id, name: letterOf(index), kind: "line", tone: index, dashed: true, x, y }, { id: `${job.id}-end`, kind: "end", x: [x.at(-1)], y: [y.at(-1)] }];
  }));
}

/** Values of an input by their keys. */
function leaves(value, path = "") {
  if (value === null || typeof value !== "object" || Array.isArray(value)) return [[path, value]];
  return Object.entries(value).flatMap(([key, inner]) => leaves(inner, path ? `${path}.${key}` : key));
}

/** The key at a path, of the first of these kinds of specimens that has it. */
function keyAt(path, kinds) {
  const [section, ...names] = path.split(".");
  const ofKind = (kind) => names.reduce((found, name) => (found?.keys ?? []).find(({ metric }) => metric === name), { keys: keysOf(section, kind) });
  return section === "law" ? undefined : kinds.map(ofKind).find(Boolean);
}

/** A value of the input in the shown units. */
function inWords(value, key) {
  if (value === undefined) return NONE;
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value === "number") return plain(toShown(key ?? { factor: 1 }, value));
  if (typeof value === "string") return key ? (key.choices ? words(value) : value) : words(value);
  if (Array.isArray(value)) return value.map((one) => (Array.isArray(one) ? `(${inWords(one, key)})` : inWords(one, key))).join(typeof value[0] === "object" ? "; " : ", ");
  const own = (name) => key?.keys.find(({ metric }) => metric === name);
  return Object.entries(value).map(([name, inner]) => `${own(name)?.label ?? words(name)} ${inWords(Array.isArray(inner) ? [inner] : inner, own(name))}`).join(", ");
}

const ORDER = ["loading", "law", "fatigue", "specimen", "material", "supports", "stop", "model"];

/** Inputs that are not the same in all runs, loads first; what differs from the first run is marked. */
function differences(jobs, laws) {
  const maps = jobs.map((job) => new Map(leaves({ ...job.case, law: laws.get(job.calibration) })));
  const kinds = [...new Set(jobs.map((job) => job.case?.specimen?.kind))];
  const place = (path) => (ORDER.indexOf(path.split(".")[0]) + 1 || ORDER.length + 1);
  const text = (map, path) => JSON.stringify(map.get(path));
  const paths = [...new Set(maps.flatMap((map) => [...map.keys()]))].filter((path) => new Set(maps.map((map) => text(map, path))).size > 1)
    .sort((one, other) => place(one) - place(other));
  const rows = paths.map((path) => {
    const key = keyAt(path, kinds);
    const label = key?.label ?? (path === "specimen.kind" ? "Specimen" : sentence(words(path.split(".").pop())));
    return [key?.unit ? `${label}, ${key.unit}` : label,
      ...maps.map((map) => (text(map, path) === text(maps[0], path) ? inWords(map.get(path), key) : element("mark", null, inWords(map.get(path), key))))];
  });
  const columns = [{ title: "Input" }, ...jobs.map((_, index) => ({ title: letterOf(index) }))];
  return rows.length > 0 ? section("differences", "Inputs that differ", table("Inputs that differ, loads first", columns, rows, { hidden: true, name: "differences" }))
    : element("p", { class: "quiet" }, "The inputs are the same.");
}

function tableOf(jobs) {
  const number = (title, unit) => ({ title, unit, numeric: true });
  const bands = jobs.map((job) => quantilesOf(job.summary));
  const lives = jobs.map((job) => job.summary.life_cycles);
  const ends = [0, Math.max(...bands.flatMap((band, index) => band ?? [lives[index] ?? 0]))];
  const inScatter = (life) => bands[0] && life >= bands[0][0] && life <= bands[0][2];
  const columns = [{ title: "Plate" }, number("Life", "cycles"), number("Ratio to A"), { title: "Scatter band (90 %)" },
    { title: "Ends by" }, { title: "Validity" }];
  const rows = jobs.map((job, index) => {
    const s = job.summary;
    const beside = index > 0 && lives[index] && lives[0] ? [significant(lives[index] / lives[0], 3), inScatter(lives[index]) && element("span", { class: "row-unit" }, "in scatter")] : "–";
    return [[element("b", null, letterOf(index)), " ", element("a", { href: hrefOf(job) }, nameOf(job))], lifeShown(s), beside,
      bands[index] ? bar(bands[index], ends) : "no band", words(s.stop_reason), s.verdict_kind ? [mark(kindOfVerdict(s.verdict_kind)), " ", s.verdict.split(":")[0]].flat() : ""];
  });
  return table("Lives of the compared predictions", columns, rows, { hidden: true, name: "compare" });
}
