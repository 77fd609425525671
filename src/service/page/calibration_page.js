// Page of one calibration: the fit beside the readings, its constants with their errors, files to take away.

import { getBlob, getJson, getText } from "./api.js";
import { createChart } from "./chart.js";
import { element, readCsv, section, show, showPage, table, terms } from "./dom.js";
import { cycles, deviation, fixed, percent, plain, scientific, significant, words } from "./format.js";
import { createJobHead, downloadList, inputText, pathOf, showAtEnd } from "./job.js";
import { warningList } from "./check.js";
import { lawSections } from "./law_page.js";
import { loadInto, problemBox } from "./notices.js";
import { createPicture, showBlob } from "./picture.js";

const STRESS_INTENSITY = "MPa√m";
const SPECIMENS_APART = 6;

export async function openCalibration(root, id, signal) {
  const job = await getJson(`/v1/calibrations/${encodeURIComponent(id)}`, signal);
  const address = `#/predict?law=${encodeURIComponent(id)}`;
  const use = element("a", { class: "button primary", href: address, hidden: true, "data-action": "use-law" }, "Predict a plate with this law");
  const head = createJobHead(job, { actions: [use] });
  const body = element("div", { class: "job-body" });
  showPage(root, head.node, body);
  let chart = null;
  signal.addEventListener("abort", () => chart?.destroy());

  async function finish(whole) {
    use.hidden = false;
    const curves = element("div");
    const { node: rates, image } = createPicture("Growth rate against range of stress intensity, readings and fitted law, logarithmic axes");
    const files = whole.files ?? [];
    const has = (name) => files.some((file) => file.name === name);
    const path = (name) => `${pathOf(whole)}/files/${name}`;
    if (has("da_dn.svg")) {
      getBlob(path("da_dn.svg"), signal).then((blob) => showBlob(image, blob))
        .catch((error) => error.name === "AbortError" || rates.after(problemBox(error)));
    }
    // Laws over K, which were fitted to rates: there is no curve.
    if (whole.summary.candidates) {
      show(body,
        whole.summary.warnings?.length > 0 && warningList(whole.summary.warnings),
        section("rates", "Growth rates", rates), lawSections(whole.summary), downloadList(whole), inputText(whole));
      return;
    }
    show(body,
      whole.summary.warnings?.length > 0 && warningList(whole.summary.warnings),
      element("div", { class: "columns wide-left" },
        element("div", { class: "stack" }, section("fit", "Readings and fitted curve", curves),
          has("da_dn.svg") && section("rates", "Growth rates", rates)),
        element("div", { class: "stack" }, section("constants", "Constants", constants(whole.summary)))),
      specimens(whole.summary),
      downloadList(whole), inputText(whole));
    loadInto(curves, async () => {
      const names = ["fit_curves.csv", "fit_band.csv", "quantiles.csv"];
      const [fit, band, quantiles] = await Promise.all(names.map((name) => (has(name) ? getText(path(name), signal).then(readCsv) : null)));
      chart = drawFit(curves, fit, [...scatterBand(quantiles), ...fittedCurve(fit, band)]);
    });
  }

  const announced = "The fit, its band and its constants appear here when the calibration is done.";
  await showAtEnd(job, { head, body, announced, finish, signal });
}

/** Fitted curve with the band that the errors of its constants leave it. */
function fittedCurve(fit, band) {
  const line = { id: "fitted", name: "Fitted", kind: "line", tone: 0 };
  if (band) {
    const y = band.crack_length_mm;
    return [
      { id: "band", name: "95 % band of the fitted curve", kind: "band", tone: 0, x: band.cycles_low, y, x2: band.cycles_high, y2: y },
      { ...line, x: band.cycles_fitted, y },
    ];
  }
  const first = (column) => column.filter((_, index) => fit.specimen[index] === fit.specimen[0]);
  return [{ ...line, x: first(fit.cycles_fitted), y: first(fit.crack_length_mm) }];
}

/** Band between the outer quantiles of the specimens: columns cycles_p05, cycles_p50, cycles_p95. */
function scatterBand(quantiles) {
  const columns = Object.keys(quantiles ?? {}).filter((name) => /^cycles_p\d+$/.test(name));
  if (columns.length < 2) return [];
  const [low, high] = [columns[0], columns.at(-1)];
  const share = (name) => Number(name.slice("cycles_p".length));
  return [{ id: "scatter", name: `${share(low)} to ${share(high)} % of the specimens`, kind: "band", tone: 7,
    x: quantiles[low], y: quantiles.crack_length_mm, x2: quantiles[high], y2: quantiles.crack_length_mm }];
}

function drawFit(place, fit, curves) {
  const chart = createChart(place, {
    name: "fit",
    label: "Crack length against cycles: readings, fitted curve and its 95 % band",
    x: { label: "Cycles N", format: cycles, from: 0 },
    y: { label: "Crack length a", unit: "mm", from: 0, format: (value) => fixed(value, 2) },
  });
  const median = "median";
  const names = [...new Set(fit.specimen)];
  const specimens = names.filter((name) => name !== median || names.length === 1);
  const points = (id, name, tone, wanted) => {
    const only = (column) => column.filter((_, index) => wanted(fit.specimen[index]));
    return { id, name: `${name}, measured`, kind: "points", tone, x: only(fit.cycles_measured), y: only(fit.crack_length_mm) };
  };
  // Dozens of specimens are told apart by nobody: they share a mark, and the median has its own.
  const readings = specimens.length > SPECIMENS_APART
    ? [points("all", `${specimens.length} specimens`, 1, (name) => name !== median), points(median, median, 2, (name) => name === median)]
    : names.map((own, index) => points(`measured-${own}`, own, index + 1, (name) => name === own));
  chart.set([...curves, ...readings]);
  return chart;
}

function constants(s) {
  // An exponent that was not fitted has no error of this fit.
  const isFitted = (s.p_source ?? "fitted") === "fitted";
  const error = (value, decimals) => (isFitted && Number.isFinite(value) ? `± ${fixed(value, decimals)}` : words(isFitted ? "" : s.p_source));
  const name = (text, unit) => [text, element("span", { class: "row-unit" }, unit)];
  const horizon = Number.isFinite(s.horizon_mm) ? `, at a horizon of ${plain(s.horizon_mm, 5)} mm` : "";
  const atPivot = `mm/cycle, at ΔK = ${significant(s.pivot_delta_k_mpa_sqrt_m, 4)} ${STRESS_INTENSITY}`;
  const rows = [
    [name("Rate at the pivot", atPivot), scientific(s.rate_at_pivot_mm_per_cycle, 4), `± ${percent(s.rate_at_pivot_relative_error, 2)}`],
    [name("Paris exponent m", "da/dN = C ΔKᵐ"), fixed(s.paris_m, 4), error(s.paris_m_error, 4)],
    [name("Paris C", `mm/cycle, at ΔK = 1 ${STRESS_INTENSITY}`), scientific(s.paris_c_mm_per_cycle, 4), ""],
    [name("Bond exponent p", "dλ/dN = −A εᵖ"), fixed(s.p, 4), error(s.p_error, 4)],
    [name("Bond constant A", `1/cycle${horizon}`), scientific(s.a, 4), ""],
  ];
  const columns = [{ title: "Constant" }, { title: "Value", numeric: true }, { title: "Std. error", numeric: true }];
  return element("div", { class: "stack tight" },
    table("Fitted constants", columns, rows, { hidden: true, name: "constants" }),
    element("p", { class: "hint" },
      "C and m are correlated: compare and quote the rate at the pivot, where the readings fix it best, together with m."),
    terms([
      ["Range of ΔK", `${significant(s.delta_k_min_mpa_sqrt_m, 4)} to ${significant(s.delta_k_max_mpa_sqrt_m, 4)} ${STRESS_INTENSITY}`],
      ["Life measured", `${cycles(s.life_measured)} cycles`],
      ["Life fitted", `${cycles(Math.round(s.life_fitted))} cycles (${deviation(s.life_fitted / s.life_measured - 1)})`],
      ["rms life error", `${percent(s.rms_life_error, 2)} over all readings`],
      ...misfit(s.misfit_at_ends),
    ], "fit"));
}

/** What the law misses at the first and last readings, and what a life that is spent there is off by. */
function misfit({ low = null, high = null } = {}) {
  const end = (name, at) => {
    const share = at.rate_over_law_percent / 100;
    const [faster, longer] = share < 0 ? ["slower", "short"] : ["faster", "long"];
    const range = `ΔK ${significant(at.delta_k_from_mpa_sqrt_m, 3)} to ${significant(at.delta_k_to_mpa_sqrt_m, 3)}`;
    const size = percent(Math.abs(share), 1);
    return [name, `grows ${size} ${faster} than the law at ${range}: a life spent there is computed ${size} too ${longer}`];
  };
  return [["First readings", low], ["Last readings", high]].filter(([, at]) => at).map(([name, at]) => end(name, at));
}

function specimens({ specimens: list = [] }) {
  if (list.length < 2) return null;
  const number = (title, unit) => ({ title, unit, numeric: true });
  const columns = [{ title: "Specimen" }, number("A", "1/cycle"), number("p"), number("Measured", "cycles"), number("Fitted", "cycles"), number("rms error")];
  const rows = list.map((one) => [
    one.name, scientific(one.a, 4), fixed(one.p, 4), cycles(one.life_measured), cycles(Math.round(one.life_fitted)),
    percent(one.rms_life_error, 2),
  ]);
  return section("specimens", "Specimens", table("Fit of every specimen", columns, rows, { hidden: true, name: "specimens" }));
}
