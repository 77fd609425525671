// Several predictions side by side: all curves in one chart, lives and their ratios in one table.

import { getJson, getText } from "./api.js";
import { createChart } from "./chart.js";
import { element, readCsv, section, show, showPage, table } from "./dom.js";
import { cycles, fixed, lifeOf, sentence, significant, words } from "./format.js";
import { hrefOf, nameOf, pathOf } from "./job.js";
import { COMPARE_MAX } from "./runs.js";

export async function openComparison(root, ids, signal) {
  const chosen = ids.slice(0, COMPARE_MAX);
  const jobs = await Promise.all(chosen.map((id) => getJson(`/v1/predictions/${encodeURIComponent(id)}`, signal)));
  const done = jobs.filter((job) => job.state === "succeeded" && !job.summary.refused);
  const curves = await Promise.all(done.map((job) => getText(`${pathOf(job)}/files/a_n.csv?points=600`, signal).then(readCsv)));
  if (signal.aborted) return;
  const chartPlace = element("div");
  const ratios = element("div");
  const names = namesOf(done);
  const base = element("select", { id: "compare-base" }, done.map((job, index) => element("option", { value: job.id }, names[index])));
  base.addEventListener("change", () => show(ratios, tableOf(done, names, base.value)));
  showPage(root,
    element("header", { class: "job-head", id: "comparison" },
      element("div", { class: "title-row" }, element("h1", { tabindex: "-1" }, "Comparison of predictions"),
        element("div", { class: "tool-row end" }, element("a", { class: "button", href: "#/runs" }, "Back to the runs")))),
    done.length < jobs.length && element("p", { class: "notice warn" }, "Runs without a life that counts are left out."),
    section("compare-curves", "Crack length against cycles", chartPlace),
    section("compare-lives", "Lives",
      element("div", { class: "field inline" }, element("label", { for: "compare-base" }, "Ratios to"), base), ratios));
  show(ratios, tableOf(done, names, base.value));
  const chart = createChart(chartPlace, {
    name: "compare",
    label: "Crack length against cycles of the compared predictions",
    x: { label: "Cycles N", format: (value) => cycles(Math.round(value)), from: 0 },
    y: { label: "Crack length a", unit: "mm", from: 0, format: (value) => fixed(value, 2) },
    ratio: 0.42,
  });
  signal.addEventListener("abort", () => chart.destroy());
  chart.set(done.map((job, index) => ({
    id: job.id, name: names[index], kind: "line", tone: index, dashed: true, x: curves[index].cycles, y: curves[index].crack_length_mm,
  })));
}

/** Runs of the same name are told apart by their ids. */
function namesOf(jobs) {
  const all = jobs.map(nameOf);
  return jobs.map((job, index) => (all.filter((name) => name === all[index]).length > 1 ? `${all[index]} (${job.id})` : all[index]));
}

function tableOf(jobs, names, baseId) {
  const base = jobs.find((job) => job.id === baseId)?.summary.life_cycles;
  const number = (title, unit) => ({ title, unit, numeric: true });
  const columns = [{ title: "Prediction" }, number("Life", "cycles"), number("Ratio of lives"), number("Initial length", "mm"),
    number("Final length", "mm"), { title: "Stopped because" }, number("Warnings")];
  const rows = jobs.map((job, index) => {
    const s = job.summary;
    return [element("a", { href: hrefOf(job) }, names[index]), lifeOf(s), s.life_cycles && base ? significant(s.life_cycles / base, 3) : "",
      fixed(s.crack_length_initial_mm, 2), fixed(s.crack_length_final_mm, 2), sentence(s.stop_meaning ?? words(s.stop_reason)),
      String(s.warnings?.length ?? 0)];
  });
  return table("Lives of the compared predictions", columns, rows, { hidden: true, name: "compare" });
}
