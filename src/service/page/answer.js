// The answer of a prediction in one card: the life with its band, what ends it, validity.

import { element, shape, terms } from "./dom.js";
import { isUs, lengthShown, lengthAlone, sized, toldWithKeys } from "./units.js";
import { bandOf, bandOfError, count, cycles, deserved, sentence, words } from "./format.js";

const CHECKS_SHOWN = 5;
/** What the number is, by the reason of the end. */
const TO_THE_END = { entered_hole: "to the hole", crack_length_reached: "to the set crack length", run_out: "reached (run-out)" };
const BROKEN_OFF = ["ligament_unresolved", "no_growth", "no_convergence", "stopped"];

const MARKS = {
  ok: ["Passed: ", "M9 1a8 8 0 1 0 0.01 0z", "M5.2 9.2l2.6 2.7 5-5.6"],
  note: ["Caution: ", "M9 1.6L17 16H1z", "M9 6.5v4.4M9 12.6v1.6"],
  bad: ["Not valid: ", "M5.8 1h6.4L17 5.8v6.4L12.2 17H5.8L1 12.2V5.8z", "M6 6l6 6m0-6l-6 6"],
};
const OF_VERDICT = { passed: "ok", caution: "note", not_checked: "note", failed: "bad" };

/** A small mark with its word for those who do not see it. */
export function mark(kind) {
  const [said, outline, sign] = MARKS[kind];
  const line = (d) => shape("path", { d, fill: "none", stroke: "currentColor", "stroke-width": 1.6, "stroke-linejoin": "round" });
  return [shape("svg", { class: `mark is-${kind}`, viewBox: "0 0 18 18", "aria-hidden": "true" }, line(outline), line(sign)),
    element("span", { class: "visually-hidden" }, said)];
}

/** Quantiles of the life: 5, 50 and 95 % of specimens; null without a band. */
export const quantilesOf = ({ band }) => (band ? [band.cycles_p05, band.cycles_p50, band.cycles_p95] : null);

/** Median and band on an axis from `low` to `high`, cycles. */
export function bar([from, middle, to], [low, high]) {
  const at = (value) => 4 + (192 * (value - low)) / (high - low);
  return shape("svg", { class: "range", viewBox: "0 0 200 16", role: "img", "aria-label": `Band ${bandOf([from, middle, to])}, median ${deserved(middle, [from, middle, to])}` },
    shape("line", { x1: 4, x2: 196, y1: 8, y2: 8 }), shape("rect", { x: at(from), width: at(to) - at(from), y: 4, height: 8 }), shape("circle", { cx: at(middle), cy: 8, r: 5 }));
}

/** The tip that ends the life, where the plate has lengths of its own; else null. */
export function leadOf(s) {
  const tip = (s.tips ?? []).findIndex((one) => one.leads && one.crack !== null && one.crack !== undefined);
  return tip < 0 ? null : tip;
}

/** Why there is no valid life, without the name of the run. */
export const whyRefused = ({ refused }) => sentence(refused.replace(/^[^:]*: (?=the )/, ""));

/** Lengths at the start and at the end, mm: of the crack that ends the life, or of the specimen. */
export function lengthsOf(s) {
  const of = leadOf(s) === null ? s : s.tips[leadOf(s)];
  return [of.crack_length_initial_mm, of.crack_length_final_mm];
}

/** Cycles of a run without a band in the digits of its life. */
export const byError = (value, s, toWhole, of) => deserved(value, bandOfError(s.error_estimate_percent), toWhole, of);

/** The life with as many digits as its band leaves, or its numerical error without one; in words where it has no end, or none that counts. */
export function lifeShown(s) {
  if (s.refused) return "none";
  if (s.life_cycles === null) return "unlimited";
  const band = quantilesOf(s);
  return `${s.life_is_lower_bound ? "≥ " : ""}${band ? deserved(band[1], band) : byError(s.life_cycles, s)}`;
}

function large(s) {
  const value = (text, unit) => element("p", { class: "life", "data-value": "life_cycles" }, text, unit && [" ", element("small", null, unit)]);
  const said = (title, text, more) => [element("h2", null, title), element("p", { class: "life words", "data-value": "life_cycles" }, text), element("p", { class: "beside" }, more)];
  const [from, to] = lengthsOf(s);
  if (s.refused) return said("Life", "Not computed", element("span", { "data-value": "refused" }, whyRefused(s)));
  if (s.life_cycles === null) return said("Life", "No growth", "ΔK of every tip is below the threshold: unlimited life.");
  const [band, run] = [quantilesOf(s), lifeShown(s)];
  if (s.fleet) return ofFleet(s, run);
  const start = `from a crack of ${lengthShown(from, 2)}`;
  const end = TO_THE_END[s.stop_reason];
  const title = BROKEN_OFF.includes(s.stop_reason) ? `Stopped early at ${lengthShown(to, 1)}` : end ? `Cycles ${start} ${end}` : `Life ${start}`;
  return [element("h2", null, title), value(run, "cycles"),
    element("p", { class: "beside" }, bandWords(s)), band && bar(band, [0, 1.05 * band[2]]),
    element("p", { class: "quiet" }, errorWords(s) && `Numerical error: ${errorWords(s)}`)];
}

/** Cycles of a fleet at 5, 50 and 95 % of its plates, in words. */
const quantileWords = ({ words: said }) => [said.p05, said.p50, said.p95].map((text) => (Number.isFinite(Number(text ?? NaN)) ? cycles(Math.round(Number(Number(text).toPrecision(4)))) : text ?? "unknown"));
export const fleetOf = ({ fleet }) => quantileWords(fleet.life_cycles);

/** Figures of a fleet have four digits. */
export const OF_FLEET = [1, 1, 1];

/** A promise, rounded down to the digits that its band deserves; whole cycles are those that a user gave. */
export const promised = (value, band) => (Number.isInteger(value) ? cycles(value) : deserved(value, band, Math.floor));

/** Inspections of a fleet in words: {from, interval, left}; null where none were asked for. */
export function inspectionsOf({ fleet: { inspections: looks }, passes, life_cycles: life }) {
  if (!looks) return null;
  const p05 = looks.detectable_to_critical_cycles.p05;
  const every = looks.interval_cycles ?? (p05 === null ? null : p05 / looks.factor);
  return {
    from: sized(looks.detectable_mm, "mm", 4), rule: `5 % remaining life of the fleet / ${looks.factor}`,
    interval: every === null ? looks.detectable_to_critical_cycles.words.p05 ?? "unknown" : `${promised(every, OF_FLEET)} cycles${inPasses(every, passes, life)}`,
    left: quantileWords(looks.detectable_to_critical_cycles),
  };
}

/** An interval in passes, under a spectrum. */
export const inPasses = (every, passes, life) => (passes > 0 ? ` (${Math.floor((100 * every * passes) / life) / 100} passes)` : "");

/** A fleet is its 5 % and median life; the run is one plate. */
function ofFleet(s, run) {
  const [low, middle, high] = fleetOf(s);
  const looks = inspectionsOf(s);
  return [element("h2", null, "Life of the fleet, 5 % of plates"), element("p", { class: "life", "data-value": "fleet_p05" }, low, " ", element("small", null, "cycles")),
    element("p", { class: "beside" }, `Median ${middle}, 95 % ${high} cycles (${count(s.fleet.plates, "plate")})`),
    looks && element("p", { class: "quiet" }, `Inspect from ${looks.from} every ${looks.interval}`),
    element("p", { class: "quiet" }, `Life with nominal inputs: ${run} cycles`)];
}

function bandWords(s) {
  const band = quantilesOf(s);
  if (!band) return [element("strong", null, "No scatter band: "), s.no_band ?? "result of an earlier version"];
  const { specimens, assumed_scatter: assumed, lot } = s.band;
  return [element("strong", null, bandOf(band)), ` (${count(specimens, "specimen")}, ${lot === "same" ? "their lot" : "another lot"}${assumed ? ", assumed scatter" : ""})`];
}

/** Estimated numerical error of life and path. */
export function errorWords(s) {
  if (typeof s.error_estimate_percent === "number") {
    const path = s.path_error_estimate_mm > 0 ? `, ≤ ${isUs ? sized(s.path_error_estimate_mm, "mm", 2) : `${s.path_error_estimate_mm} mm`} in the path` : "";
    return `≤ ${s.error_estimate_percent} % of life${path} (estimate)`;
  }
  return s.no_error_estimate && `not stated: ${s.no_error_estimate}`;
}

function why(s, more) {
  const [from, to] = lengthsOf(s);
  const lead = leadOf(s);
  const tips = s.tips ?? [];
  // The length of all cracks together is none that anyone measures.
  const isEnd = s.critical && Math.abs(s.critical.crack_length_mm - s.crack_length_final_mm) < 1e-6;
  const critical = s.critical && (lead === null || isEnd) && lengthShown(isEnd ? to : s.critical.crack_length_mm, 2);
  const facts = [
    [tips.length > 1 && lead !== null ? `Crack of tip ${lead}` : "Crack length", `${lengthAlone(from, 2)} to ${lengthShown(to, 2)}`],
    critical && ["Critical", `${critical}: ${words(s.critical.criterion)}`],
    ...more,
  ].filter(Boolean);
  return [element("h2", null, s.life_cycles === null ? "Because" : "Ends by"),
    element("p", { class: "why", "data-value": "stop" }, toldWithKeys(s.stop_meaning) ?? words(s.stop_reason)), terms(facts, "result")];
}

/** Crack lengths that checks name rounded, mm. */
const LENGTHS = {
  small_scale_yielding: ({ plastic_zone: zone }) => zone?.too_large_to_mm ?? zone?.too_large_from_mm,
  cross_check: ({ k_cross_check: compared }) => compared?.crack_length_mm,
};

/** Words of a check; in inches a length is rounded once, of the number that the result has. */
function wordsOf({ name, words: said }, result) {
  const length = isUs && LENGTHS[name]?.(result);
  return toldWithKeys(length > 0 ? said.replace(/a = [\d.]+ mm/, `a = ${lengthShown(length, length < 10 ? 1 : 0)}`) : said);
}

export const line = (check, result = {}) => element("li", { "data-check": check.name, "data-verdict": check.verdict },
  mark(OF_VERDICT[check.verdict] ?? "note")[0],
  element("span", null, mark(OF_VERDICT[check.verdict] ?? "note")[1], sentence(wordsOf(check, result)), check.remedy && element("span", { class: "quiet" }, ` – ${toldWithKeys(check.remedy)}`)));

/** Growth at an end of the tested ΔK against the law, percent, beyond which a life is cautioned: as `lack_of_fit` of a result has it. */
const MISFIT_CAUTION = 5;

/** Mark of a law by its misfit at its ends, percent; undefined where none is known. */
export const kindOfMisfit = (...ends) => ends.length > 0 ? (ends.some((percent) => Math.abs(percent) > MISFIT_CAUTION) ? "note" : "ok") : undefined;

/** Misfits of a law at those ends where they are known, percent. */
export const misfitsOf = ({ misfit_at_ends: ends }) => [ends?.low, ends?.high].filter(Boolean).map((at) => at.rate_over_law_percent);

/** Mark of a verdict. */
export const kindOfVerdict = (kind) => ({ valid: "ok", not_valid: "bad" })[kind] ?? "note";

function valid(s) {
  const { verdict, verdict_kind: validity, checks = [] } = s;
  const own = (check) => line(check, s);
  if (!validity) return element("p", { class: "quiet" }, "Result of an earlier version.");
  const kind = kindOfVerdict(validity);
  const [shown, rest] = [checks.slice(0, CHECKS_SHOWN), checks.slice(CHECKS_SHOWN)];
  return [element("h2", null, "Validity"), element("p", { class: `verdict is-${kind}`, "data-value": "verdict" }, sentence(verdict)),
    element("ul", { class: "checks" }, shown.map(own)),
    rest.length > 0 && element("details", null, element("summary", null, `${count(rest.length, "more check")}`), element("ul", { class: "checks" }, rest.map(own)))];
}

/** The card. `more`: further terms of the end. */
export function answerCard(s, more = []) {
  return element("section", { class: "card answer", "aria-label": "Answer", "data-part": "result" },
    element("div", null, large(s)), element("div", null, why(s, more)), element("div", { "data-part": "checks" }, valid(s)));
}
