// Page of one calibration: readings and fit, constants with their errors, files.

import { kindOfMisfit, mark } from "./answer.js";
import { getJson, getText } from "./api.js";
import { createChart } from "./chart.js";
import { element, readCsv, section, show, showPage, table, terms } from "./dom.js";
import { cycles, deviation, fixed, percent, plain, scientific, significant, words } from "./format.js";
import { createJobHead, describe, downloadList, inputText, pathOf, showAtEnd } from "./job.js";
import { warningList } from "./check.js";
import { placeOf } from "./left_out.js";
import { lawSections } from "./law_page.js";
import { loadInto } from "./notices.js";
import { filePicture } from "./picture.js";
import { reportButton } from "./report.js";
import { inShown, levelShown, sized, spanned, unitShown } from "./units.js";

const STRESS_INTENSITY = "MPa√m";
const SPECIMENS_APART = 6;

export async function openCalibration(root, id, signal) {
  const job = await getJson(`/v1/calibrations/${encodeURIComponent(id)}`, signal);
  const address = `#/predict?law=${encodeURIComponent(id)}`;
  const use = element("a", { class: "button primary", href: address, hidden: true, "data-action": "use-law" }, "Use this law");
  const head = createJobHead(job, { actions: [use] });
  const body = element("div", { class: "job-body" });
  showPage(root, head.node, body);
  const charts = [];
  signal.addEventListener("abort", () => charts.forEach((chart) => chart.destroy()));

  async function finish(whole) {
    use.hidden = false;
    head.offer(reportButton(whole));
    const files = whole.files ?? [];
    const has = (name) => files.some((file) => file.name === name);
    const read = (name) => (has(name) ? getText(`${pathOf(whole)}/files/${name}`, signal).then(readCsv) : null);
    const [curves, rates] = [element("div"), element("div")];
    const warnings = whole.summary.warnings ?? [];
    // Laws over K, which were fitted to rates: there is no curve.
    if (whole.summary.candidates) {
      if (has("da_dn.svg")) show(rates, filePicture(whole, "da_dn.svg", "Growth rate against range of stress intensity, readings and fitted law, logarithmic axes", signal));
      show(body, warnings.length > 0 && warningList(warnings), section("rates", "Growth rates", rates), lawSections(whole.summary), downloadList(whole), inputText(whole));
      return;
    }
    show(body, lawCard(whole.summary),
      element("div", { class: "pictures" }, element("div", { class: "card figure" }, curves), has("rates.csv") && element("div", { class: "card figure" }, rates)),
      element("div", { class: "two" }, element("section", { class: "card", "aria-label": "Constants" }, element("h2", null, "Constants"), constants(whole.summary)),
        element("div", { class: "stack" }, readingsLeftOut(whole.summary), specimens(whole.summary), warnings.length > 0 && warningList(warnings, "Messages"))),
      downloadList(whole), inputText(whole));
    if (has("fit.json")) {
      getText(`${pathOf(whole)}/files/fit.json`, signal).then((text) => head.describe(describe(JSON.parse(text))), () => {});
    }
    loadInto(curves, async () => {
      const [fit, band, quantiles] = await Promise.all(["fit_curves.csv", "fit_band.csv", "quantiles.csv"].map(read));
      charts.push(drawFit(curves, fit, [...scatterBand(quantiles), ...fittedCurve(fit, band), ...leftOut(await read("readings.csv"), fit)]));
    });
    if (has("rates.csv")) loadInto(rates, async () => charts.push(drawRates(rates, await read("rates.csv"), whole.summary)));
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

/** Cycles at which the window of every specimen starts in its file: by its readings that the fit has, which counts from there. */
function startsOf(readings, fit) {
  const starts = new Map();
  readings.specimen.forEach((name, row) => {
    if (readings.left_out?.[row] || starts.has(name)) return;
    const at = fit.specimen.findIndex((own, index) => own === name && Math.abs(fit.crack_length_mm[index] - readings.crack_length_mm[row]) < 1e-6);
    if (at >= 0) starts.set(name, readings.cycles[row] - fit.cycles_measured[at]);
  });
  return starts;
}

/** Readings that were not fitted, in cycles from the start of the window as the fit: those outside it as thin marks, excluded ones crossed out. */
function leftOut(readings, fit) {
  const starts = readings ? startsOf(readings, fit) : new Map();
  const out = (readings?.cycles ?? []).map((_, row) => readings.left_out?.[row] && [readings.cycles[row] - starts.get(readings.specimen[row]), readings.crack_length_mm[row]])
    .filter((point) => point && point.every(Number.isFinite));
  const [from, to] = [Math.min(...fit.crack_length_mm), Math.max(...fit.crack_length_mm)];
  const isOutside = ([, a]) => a < from - 1e-9 || a > to + 1e-9;
  const series = (id, name, more, points) => points.length > 0 && { id, name, ...more, x: points.map((point) => point[0]), y: points.map((point) => point[1]) };
  return [series("outside", "outside the window", { kind: "points", tone: 7 }, out.filter(isOutside)), series("left-out", "excluded", { kind: "crosses" }, out.filter((point) => !isOutside(point)))].filter(Boolean);
}

/** A value to the second digit of its error. */
const withError = (value, error) => fixed(value, error > 0 ? Math.min(4, Math.max(2, 1 - Math.floor(Math.log10(error)))) : 2);

/** Excluded readings, each with its reason. */
function readingsLeftOut({ left_out: windows = [] }) {
  return windows.length > 0 && section("left-out", "Excluded readings", element("ul", null, windows.map((one) =>
    element("li", null, `${placeOf(one)}: ${one.reason}`))));
}

function drawFit(place, fit, curves) {
  const chart = createChart(place, {
    name: "fit", title: "Readings and fitted curve",
    label: "Crack length against cycles: readings, fitted curve and its 95 % band",
    x: { label: "Cycles N", format: cycles, from: 0 },
    y: { label: "Crack length a", unit: "mm", from: 0, format: (value) => fixed(value, 2) },
    note: "Thin lines: specimens. Circles: readings (median of many). Blue: fitted law with 95 % band.",
  });
  const median = "median";
  const names = [...new Set(fit.specimen)];
  const specimens = names.filter((name) => name !== median || names.length === 1);
  const rows = (wanted, column) => column.filter((_, index) => fit.specimen[index] === wanted);
  const isMany = specimens.length > SPECIMENS_APART;
  const curveOf = (own, kind, tone) => ({ id: `${kind}-${own}`, name: `${own}, measured`, kind, tone, x: rows(own, fit.cycles_measured), y: rows(own, fit.crack_length_mm) });
  // Many specimens are thin lines; the median has the marks.
  const thin = isMany ? specimens.map((own) => ({ ...curveOf(own, "thin", 2), name: undefined })) : [];
  const marked = isMany ? names.filter((name) => name === median) : names;
  chart.set([...curves, ...thin, ...marked.map((own, index) => curveOf(own, "points", isMany ? 2 : 2 + index))]);
  return chart;
}

/** Points [ΔK, rate] of the fitted law over its range: a straight line in logarithms, or the cubic pieces of its curve, which rates and exponents at the knots give. */
function fittedLaw(s) {
  if (!s.curve) return [s.delta_k_min_mpa_sqrt_m, s.delta_k_max_mpa_sqrt_m].map((k) => [k, s.rate_at_pivot_mm_per_cycle * (k / s.pivot_delta_k_mpa_sqrt_m) ** s.paris_m]);
  const [x, y] = [s.curve.delta_k_mpa_sqrt_m, s.curve.da_dn_mm_per_cycle].map((values) => values.map(Math.log));
  const pieces = 8, last = x.length - 1;
  return Array.from({ length: pieces * last + 1 }, (_, step) => {
    const i = Math.min(Math.floor(step / pieces), last - 1), t = step / pieces - i, h = x[i + 1] - x[i];
    const rate = y[i] + t * t * (3 - 2 * t) * (y[i + 1] - y[i]) + h * t * (1 - t) * ((1 - t) * s.curve.m[i] - t * s.curve.m[i + 1]);
    return [Math.exp(x[i] + t * h), Math.exp(rate)];
  });
}

/** Rates of the readings, and the law where it was measured. */
function drawRates(place, rates, s) {
  const chart = createChart(place, {
    name: "rates", title: "Growth rate over ΔK", label: "Growth rate against range of stress intensity: readings and fitted law, logarithmic axes",
    x: { label: "ΔK", unit: STRESS_INTENSITY, scale: "log", format: (value) => significant(value, 4) },
    y: { label: "da/dN", unit: "mm/cycle", scale: "log", format: (value) => scientific(value, 3) },
    note: "Circles: rates of the readings. Blue: fitted law in the tested ΔK range.",
  });
  const pairs = rates.delta_k_mpa_sqrt_m.map((k, index) => [k, rates.da_dn_mm_per_cycle[index]]).filter(([k, rate]) => k > 0 && rate > 0);
  const law = fittedLaw(s);
  chart.set([
    { id: "rates", name: "readings", kind: "points", tone: 2, x: pairs.map((pair) => pair[0]), y: pairs.map((pair) => pair[1]) },
    { id: "pivot", name: "reference ΔK", kind: "points", tone: 0, x: [s.pivot_delta_k_mpa_sqrt_m], y: [s.rate_at_pivot_mm_per_cycle] },
    { id: "law", name: "fitted law", kind: "line", tone: 0, x: law.map((point) => point[0]), y: law.map((point) => point[1]) },
  ]);
  return chart;
}

/** The law first: its rate at the best-determined point, its exponent, its tested range. */
function lawCard(s) {
  const remarks = misfit(s.misfit_at_ends);
  return element("section", { class: "card answer", "aria-label": "Answer", "data-part": "result" },
    element("div", null, element("h2", null, `Growth rate at ΔK ${sized(s.pivot_delta_k_mpa_sqrt_m, STRESS_INTENSITY, 4)} (best-determined point)`),
      element("p", { class: "life" }, scientific(inShown(s.rate_at_pivot_mm_per_cycle, "mm/cycle"), 3), " ", element("small", null, unitShown("mm/cycle"))),
      element("p", { class: "beside" }, element("strong", null, `± ${percent(s.rate_at_pivot_relative_error, 1)}`), " (one standard error)"),
      element("p", { class: "quiet" }, `C = ${scientific(levelShown(s.paris_c_mm_per_cycle, s.paris_m), 3)}; always quote C with m.`)),
    element("div", null, element("h2", null, "Exponent m"), element("p", { class: "life" }, withError(s.paris_m, s.paris_m_error)),
      terms([
        s.curve && ["Law", "curve of the rates; C and m are the best power law"],
        Number.isFinite(s.paris_m_error) && ["±", significant(s.paris_m_error, 2)],
        ["Life", `measured ${cycles(s.life_measured)}, fitted ${cycles(Math.round(s.life_fitted))} cycles (${deviation(s.life_fitted / s.life_measured - 1)})`],
        ["Fit error", `${percent(s.rms_life_error, 2)} rms of life`]].filter(Boolean), "exponent")),
    element("div", null, element("h2", null, "Validity"),
      element("p", { class: "verdict" }, `For ΔK ${spanned(s.delta_k_min_mpa_sqrt_m, s.delta_k_max_mpa_sqrt_m, STRESS_INTENSITY, 4)}`),
      element("ul", { class: "checks" }, remarks.map(([name, text, kind]) => element("li", { "data-mark": kind }, mark(kind)[0], element("span", null, mark(kind)[1], element("b", null, `${name}: `), text))))));
}

function constants(s) {
  // An exponent that was not fitted has no error of this fit.
  const isFitted = (s.p_source ?? "fitted") === "fitted";
  const error = (value) => (isFitted && Number.isFinite(value) ? `± ${significant(value, 2)}` : words(isFitted ? "" : s.p_source));
  const name = (text, unit) => [text, element("span", { class: "row-unit" }, unit)];
  const atPivot = `${unitShown("mm/cycle")}, at ΔK = ${sized(s.pivot_delta_k_mpa_sqrt_m, STRESS_INTENSITY, 4)}`;
  const rows = [
    [name("Rate at reference ΔK", atPivot), scientific(inShown(s.rate_at_pivot_mm_per_cycle, "mm/cycle"), 4), `± ${percent(s.rate_at_pivot_relative_error, 2)}`],
    [name("Paris exponent m", "da/dN = C ΔKᵐ"), fixed(s.paris_m, 4), error(s.paris_m_error)],
    [name("Paris C", `${unitShown("mm/cycle")}, at ΔK = 1 ${unitShown(STRESS_INTENSITY)}`), scientific(levelShown(s.paris_c_mm_per_cycle, s.paris_m), 4), ""],
  ];
  const ofBonds = Number.isFinite(s.horizon_mm) && [
    [name("Bond exponent p", "dλ/dN = −A εᵖ"), fixed(s.p, 4), error(s.p_error)],
    [name("Bond constant A", `1/cycle, at a horizon of ${plain(s.horizon_mm, 5)} mm`), scientific(s.a, 4), ""],
  ];
  const columns = [{ title: "Constant" }, { title: "Value", numeric: true }, { title: "Std. error", numeric: true }];
  return element("div", { class: "stack tight" },
    table("Fitted constants", columns, rows, { hidden: true, name: "constants" }),
    element("p", { class: "hint" },
      "C and m are correlated: compare and quote the rate at the reference ΔK (best-determined point) together with m."),
    terms([
      ["Range of ΔK", spanned(s.delta_k_min_mpa_sqrt_m, s.delta_k_max_mpa_sqrt_m, STRESS_INTENSITY, 4)],
      ["Life measured", `${cycles(s.life_measured)} cycles`],
      ["Life fitted", `${cycles(Math.round(s.life_fitted))} cycles (${deviation(s.life_fitted / s.life_measured - 1)})`],
      ["rms life error", `${percent(s.rms_life_error, 2)} over all readings`],
      ...misfit(s.misfit_at_ends),
    ], "fit"),
    ofBonds && element("details", null, element("summary", null, "Constants of bonds"), table("Constants of bonds", columns, ofBonds, { hidden: true })));
}

/** What the law misses at the first and last readings, and what a life that is spent there is off by. */
function misfit({ low = null, high = null } = {}) {
  const end = (name, at) => {
    const share = at.rate_over_law_percent / 100;
    const [faster, longer] = share < 0 ? ["slower", "short"] : ["faster", "long"];
    const range = `ΔK ${spanned(at.delta_k_from_mpa_sqrt_m, at.delta_k_to_mpa_sqrt_m, STRESS_INTENSITY, 4)}`;
    const size = percent(Math.abs(share), 1);
    return [name, `measured growth ${size} ${faster} than the law at ${range}; life there ${size} too ${longer} (${longer === "short" ? "conservative" : "non-conservative"})`, kindOfMisfit(at.rate_over_law_percent)];
  };
  return [["First readings", low], ["Last readings", high]].filter(([, at]) => at).map(([name, at]) => end(name, at));
}

function specimens({ specimens: list = [] }) {
  if (list.length < 2) return null;
  const number = (title, unit) => ({ title, unit, numeric: true });
  const columns = [{ title: "Specimen" }, number(`C, ${unitShown("mm/cycle")}`), number("m"), number("Measured", "cycles"), number("Fitted", "cycles"), number("rms error")];
  const rows = list.map((one) => [
    one.name, scientific(levelShown(one.paris_c_mm_per_cycle, one.paris_m), 4), fixed(one.paris_m, 4), cycles(one.life_measured), cycles(Math.round(one.life_fitted)),
    percent(one.rms_life_error, 2),
  ]);
  return section("specimens", "Specimens", table("Fit of every specimen", columns, rows, { hidden: true, name: "specimens" }));
}
