// Page of a run that is one of a command as a whole (scene, sweep, stress intensity factors): its answer, its pictures and files.

import { getJson } from "./api.js";
import { warningList } from "./check.js";
import { element, section, show, showPage, table, terms } from "./dom.js";
import { count, cycles, significant, words } from "./format.js";
import { createJobHead, downloadList, inputText, showAtEnd } from "./job.js";
import { filePicture } from "./picture.js";
import { inShown, sized, unitShown } from "./units.js";

const PICTURES_MAX = 12;

export const openOther = (collection) => async (root, id, signal) => {
  const job = await getJson(`/v1/${collection}/${encodeURIComponent(id)}`, signal);
  const head = createJobHead(job);
  const body = element("div", { class: "job-body" });
  showPage(root, head.node, body);

  function finish(whole) {
    const names = (whole.files ?? []).map((file) => file.name).filter((name) => /\.(png|svg)$/i.test(name)).slice(0, PICTURES_MAX);
    const pictures = names.map((name) => filePicture(whole, name, name, signal));
    const warnings = (whole.summary?.warnings ?? []).filter((warning) => typeof warning === "string");
    show(body, whole.kind === "sif" && factorsOf(whole.summary), whole.kind === "sweep" && livesOf(whole.summary), warnings.length > 0 && warningList(warnings), pictures.length > 0 && section("pictures", "Pictures", element("div", { class: "pictures" }, pictures)),
      downloadList(whole), inputText(whole));
  }

  await showAtEnd(job, { head, body, announced: "Pictures and files appear here when the run is done.", finish, signal });
};

/** K of every tip by every method, the largest first. */
function factorsOf({ tips = [] }) {
  // K II of a crack in pure mode I is what rounding leaves.
  const mode = ({ k_i_mpa_sqrt_m: one, k_ii_mpa_sqrt_m: two }) => (Math.abs(two) < 1e-6 * Math.abs(one) ? 0 : two);
  const rows = tips.flatMap((tip, number) => Object.entries(tip.methods).map(([method, read]) => ({ number, tip, method, ...read, k_ii_mpa_sqrt_m: mode(read) })));
  const known = rows.filter((row) => typeof row.k_i_mpa_sqrt_m === "number");
  if (known.length === 0) return null;
  const [first] = known.filter((row) => row.method === known[0].method).sort((one, other) => other.k_i_mpa_sqrt_m - one.k_i_mpa_sqrt_m);
  const others = known.filter((row) => row.number === first.number && row !== first);
  const figure = (value, unit) => (typeof value === "number" ? significant(inShown(value, unit), 4) : "–");
  const apart = others.map((row) => Math.abs(row.k_i_mpa_sqrt_m / first.k_i_mpa_sqrt_m - 1));
  const handbook = first.tip.handbook_k_i_mpa_sqrt_m;
  const column = (title, unit) => ({ title, unit: unitShown(unit), numeric: true });
  return [
    element("section", { class: "card answer", "aria-label": "Answer", "data-part": "result" },
      element("div", null, element("h2", null, `K of tip ${first.number} at maximum load, by ${words(first.method)}`),
        element("p", { class: "life", "data-value": "k_i" }, figure(first.k_i_mpa_sqrt_m, "MPa√m"), " ", element("small", null, unitShown("MPa√m")))),
      element("div", null, element("h2", null, "Other values"), terms([
        ["K II", `${figure(first.k_ii_mpa_sqrt_m, "MPa√m")} ${unitShown("MPa√m")}`], ["T-stress", `${figure(first.t_stress_mpa, "MPa")} ${unitShown("MPa")}`],
        ["Handbook", typeof handbook === "number" ? sized(handbook, "MPa√m", 4) : "no formula for this plate"]], "factors")),
      element("div", null, element("h2", null, "Validity"), element("p", { class: `verdict ${apart.length > 0 && Math.max(...apart) < 0.01 ? "is-ok" : "is-note"}` },
        apart.length > 0 ? `Methods agree within ${significant(100 * Math.max(...apart), 2)} %` : "One method alone"))),
    table("Stress intensity factors at maximum load", [{ title: "Tip" }, { title: "Method" }, column("K I", "MPa√m"), column("K II", "MPa√m"), column("T", "MPa"), { title: "Remark" }],
      rows.map((row) => [String(row.number), words(row.method), figure(row.k_i_mpa_sqrt_m, "MPa√m"), figure(row.k_ii_mpa_sqrt_m, "MPa√m"), figure(row.t_stress_mpa, "MPa"), row.note ?? ""]), { name: "factors" }),
  ];
}

/** Lives of the cases of a sweep. */
function livesOf({ life_cycles: lives, cases, succeeded, failed, missing, unlimited, run_outs: runOuts, design }) {
  if (typeof lives?.p50 !== "number") return null;
  const figure = (value) => (typeof value === "number" ? cycles(Math.round(value)) : "unlimited");
  const open = failed + missing;
  return element("section", { class: "card answer", "aria-label": "Answer", "data-part": "result" },
    element("div", null, element("h2", null, `Life, median of ${count(cases, "case")}`),
      element("p", { class: "life", "data-value": "life_cycles" }, figure(lives.p50), " ", element("small", null, "cycles")),
      element("p", { class: "beside" }, "90 % of cases: ", element("strong", null, `${figure(lives.p05)} to ${figure(lives.p95)}`))),
    element("div", null, element("h2", null, "Varied"), terms([
      ["Design", `${words(design?.design?.kind)}${(design?.vary ?? []).length > 0 ? `: ${design.vary.map((one) => words(one.key.split(".").pop())).join(", ")}` : ""}`], ["Min, max", `${figure(lives.least)} and ${figure(lives.most)}`],
      unlimited > 0 && ["Unlimited", count(unlimited, "case")], runOuts > 0 && ["Run out", count(runOuts, "case")]].filter(Boolean), "sweep")),
    element("div", null, element("h2", null, "Completeness"),
      element("p", { class: `verdict ${open === 0 ? "is-ok" : "is-note"}` }, open === 0 ? `All ${count(succeeded, "case")} succeeded` : `${failed} failed, ${missing} missing of ${cases}`)));
}
