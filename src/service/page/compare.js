// Several predictions side by side: lives with their bands on one axis, what differs in their inputs, all curves in one chart.

import { bar, kindOfVerdict, mark, quantilesOf } from "./answer.js";
import { getJson, getText } from "./api.js";
import { createChart } from "./chart.js";
import { element, readCsv, showPage, table } from "./dom.js";
import { cycles, deserved, fixed, lifeOf, plain, sentence, significant, words } from "./format.js";
import { hrefOf, nameOf, pathOf } from "./job.js";
import { COMPARE_MAX } from "./runs.js";

const KEYS_MAX = 6;
const letterOf = (index) => String.fromCharCode(65 + index);

export async function openComparison(root, ids, signal) {
  const chosen = ids.slice(0, COMPARE_MAX);
  const jobs = await Promise.all(chosen.map((id) => getJson(`/v1/predictions/${encodeURIComponent(id)}`, signal)));
  const done = jobs.filter((job) => job.state === "succeeded" && !job.summary.refused);
  const curves = await Promise.all(done.map((job) => getText(`${pathOf(job)}/files/a_n.csv?points=600`, signal).then(readCsv)));
  const fits = [...new Set(done.map((job) => job.calibration).filter(Boolean))];
  const laws = new Map(await Promise.all(fits.map(async (id) => [id, await getJson(`/v1/calibrations/${encodeURIComponent(id)}`, signal).then(nameOf, () => "a fit that is gone")])));
  if (signal.aborted) return;
  const chartPlace = element("div");
  showPage(root,
    element("header", { class: "job-head", id: "comparison" },
      element("div", { class: "title-row" }, element("h1", { tabindex: "-1" }, "Comparison of lives"),
        element("div", { class: "tool-row end" }, element("a", { class: "button", href: "#/runs" }, "Back to the runs"))),
      element("p", { class: "quiet" }, "Of the inputs only what differs is listed.")),
    done.length < jobs.length && element("p", { class: "notice warn" }, "Runs without a life that counts are left out."),
    element("div", { class: "job-body" }, tableOf(done, laws), element("div", { class: "card figure" }, chartPlace)));
  const chart = createChart(chartPlace, {
    name: "compare", title: "Crack length over cycles",
    label: "Crack length against cycles of the compared predictions",
    x: { label: "Cycles N", format: (value) => cycles(Math.round(value)), from: 0 },
    y: { label: "Crack length a", unit: "mm", format: (value) => fixed(value, 2) },
    ratio: 0.42, note: "Each curve has its letter; dashes differ too, so that a copy in grey can be read.",
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

const UNITS = { _mpa_sqrt_m: "MPa√m", _mm_per_cycle: "mm/cycle", _mm: "mm", _mpa: "MPa", _gpa: "GPa", _kn: "kN", _n: "N", _percent: "%" };

/** The name of a key in words, and its unit. */
function nameOfKey(key) {
  const last = key.split(".").pop();
  const end = Object.keys(UNITS).find((one) => last.endsWith(one)) ?? "";
  return [sentence(words(last.slice(0, last.length - end.length))), UNITS[end]];
}

/** Keys whose values are not those of all runs. */
function differing(jobs, laws) {
  const maps = jobs.map((job) => new Map(leaves({ ...job.case, law: laws.get(job.calibration) })));
  const keys = [...new Set(maps.flatMap((map) => [...map.keys()]))];
  const shown = (map, key) => JSON.stringify(map.get(key)) ?? "";
  return keys.filter((key) => new Set(maps.map((map) => shown(map, key))).size > 1).slice(0, KEYS_MAX)
    .map((key) => ({ key, values: maps.map((map) => map.get(key)) }));
}

function tableOf(jobs, laws) {
  const number = (title, unit) => ({ title, unit, numeric: true });
  const differences = differing(jobs, laws);
  const bands = jobs.map((job) => quantilesOf(job.summary));
  const lives = jobs.map((job) => job.summary.life_cycles);
  const ends = [0, Math.max(...bands.flatMap((band, index) => band ?? [lives[index] ?? 0]))];
  const isSame = (value, base) => JSON.stringify(value) === JSON.stringify(base);
  const cell = (value, base) => {
    const text = value === undefined ? "–" : typeof value === "number" ? plain(value) : typeof value === "string" ? value : JSON.stringify(value);
    return isSame(value, base) ? text : element("mark", null, text);
  };
  const inScatter = (life) => bands[0] && life >= bands[0][0] && life <= bands[0][2];
  const columns = [{ title: "Plate" }, number("Life", "cycles"), number("Beside A"), { title: "9 of 10 specimens" },
    ...differences.map(({ key }) => number(...nameOfKey(key))), { title: "Ends because" }, { title: "Valid?" }];
  const rows = jobs.map((job, index) => {
    const s = job.summary;
    const beside = index > 0 && lives[index] && lives[0] ? [significant(lives[index] / lives[0], 3), inScatter(lives[index]) && element("span", { class: "row-unit" }, "in scatter")] : "–";
    return [[element("b", null, letterOf(index)), " ", element("a", { href: hrefOf(job) }, nameOf(job))], bands[index] ? deserved(bands[index][1], bands[index]) : lifeOf(s), beside,
      bands[index] ? bar(bands[index], ends) : "no band", ...differences.map(({ values }) => cell(values[index], values[0])),
      words(s.stop_reason), s.verdict ? [mark(kindOfVerdict(s.verdict_kind)), " ", s.verdict.split(":")[0]].flat() : ""];
  });
  return table("Lives of the compared predictions", columns, rows, { hidden: true, name: "compare" });
}
