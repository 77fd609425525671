// Further analyses of a prediction. A result never changes: each is a run of the same input with an option of its own.

import { inPasses, inspectionsOf, OF_FLEET, promised } from "./answer.js";
import { getText } from "./api.js";
import { createChart } from "./chart.js";
import { button, element, readCsv, section, show, terms } from "./dom.js";
import { createForm, grid, numberIn } from "./form.js";
import { bandOf, bandOfError, deserved, significant, whole } from "./format.js";
import { filesOf, nameOf, pathOf } from "./job.js";
import { keyOf, loadKeys } from "./keys.js";
import { loadInto, problemBox } from "./notices.js";
import { filePicture } from "./picture.js";
import { startRun } from "./submit.js";
import { inShown, isUs, lengthShown, sized, unitShown } from "./units.js";

const STRENGTH = "residual_strength";
const PICTURES = { "fleet.svg": "Fleet", "sensitivities.svg": "Sensitivity of the life", "residual_strength.svg": "Residual strength" };

const hasFile = (job, file) => job.files.some(({ name }) => name === file);
const card = (name, title, content) => element("section", { class: "card", "data-part": name }, element("h2", null, title), content);

/** Quantiles of a remaining life. */
function leftWords({ remaining_cycles_p05: low, remaining_cycles_p50: middle, remaining_cycles_p95: high }) {
  return `${deserved(middle, [low, middle, high])} cycles; ${bandOf([low, middle, high])}`;
}

/** A probability; no POD curve supports a smaller one than 0.001. */
const chance = (value) => (value < 1e-3 ? "< 0.001" : significant(value, 2));

/** When the crack is looked for: as the interval of the inspection, rounded down. */
function inspectionWords(found, { inspection: from, passes, life_cycles: life, error_estimate_percent: error, fleet, tips = [] }) {
  const looks = fleet?.inspections;
  if (looks) return `first after ${promised(looks.first_inspection_cycles, OF_FLEET)} cycles, then every ${inspectionsOf({ fleet, passes, life_cycles: life }).interval}`;
  const every = found.interval_cycles;
  const band = from?.has_band && [from.remaining_cycles_p05, from.remaining_cycles_p50, from.remaining_cycles_p95];
  const rounded = promised(every, band || bandOfError(error));
  const tip = tips.length > 1 && (from?.tip ?? null) !== null ? ` (tip ${from.tip})` : "";
  return `${found.rows.length}${from ? `, from ${lengthShown(from.crack_length_mm, 2)}${tip}` : ""}, every ${rounded} cycles${inPasses(every, passes, life)}`;
}

/** Residual strength over crack length as its table has it, in the units that are shown, with the largest load of the cycle. */
function strengthChart(job, { case: input }, signal) {
  const place = element("div");
  loadInto(place, async () => {
    const columns = readCsv(await getText(`${pathOf(job)}/files/${STRENGTH}.csv`, signal));
    const [key, unit, name] = `${STRENGTH}_mpa` in columns ? ["mpa", "MPa", "gross stress"] : ["kn", "kN", "force"];
    const { stress_ratio: ratio, ...load } = input?.loading ?? {};
    const [most, range] = ["max", "range"].map((one) => load[`stress_${one}_${key}`] ?? load[`force_${one}_${key}`]);
    const top = most ?? range / (1 - ratio);
    const chart = createChart(place, {
      name: "strength", label: "Residual strength against crack length",
      x: { label: "Crack length a", unit: "mm" }, y: { label: `Residual strength (${name})`, unit, from: 0 },
    });
    signal.addEventListener("abort", () => chart.destroy());
    const line = (id, title, column, tone) => column?.some(Number.isFinite) && { id, name: title, kind: "line", tone, dashed: tone > 0, x: columns.crack_length_mm, y: column };
    chart.set([line("strength", "residual strength", columns[`${STRENGTH}_${key}`], 0), line("toughness", "fracture (K_c)", columns[`by_toughness_${key}`], 1),
      line("net-section", "net-section yield", columns[`by_net_section_${key}`], 2), top > 0 && { id: "load", kind: "limit", name: "maximum load of the cycle", y: [top] }].filter(Boolean));
  });
  return place;
}

/** What further analyses found: their pictures and figures. */
export const foundFurther = (job, { inspections: found, measured: own, ...result }, signal) => [
  ...Object.entries(PICTURES).filter(([file]) => hasFile(job, file)).map(([file, title]) => card(file.replace(".svg", ""), title, isUs && file === `${STRENGTH}.svg` ? strengthChart(job, result, signal) : filePicture(job, file, title, signal))),
  ...(found ? [card("detection", "Detection", terms([
    ["All inspections miss", `probability ${chance(result.fleet?.missed ?? found.missed)} (${result.fleet ? "mean of the fleet; " : ""}independence assumed)`],
    ["POD", `a50 ${sized(found.a50_mm, "mm", 3)}, a90 ${sized(found.a90_mm, "mm", 3)}`],
    ["Inspections", inspectionWords(found, result)]], "detection"))] : []),
  ...(own ? [card("readings", "Remaining life by readings of this plate", terms([
    [`From ${sized(own.crack_length_mm, "mm", 4)} at ${whole(own.cycles)} cycles`, leftWords(own)], ["Without readings", leftWords(own.of_lot)]], "readings"))] : []),
];

/** Options by which the inspections of a result were asked for. */
const ofResult = ({ inspection: one }) => one && { options: { inspect_from_mm: one.crack_length_mm, factor: one.factor, ...((one.tip ?? null) === null ? {} : { tip: one.tip }) } };

/** The cards of analyses that the run has not; `inspection()` is that of the page, without it that of the result. */
export async function furtherCards(job, result, inspection = () => ofResult(result)) {
  await loadKeys();
  const form = createForm(() => {});
  const { label, hint } = keyOf("fleet", "plates");
  const plates = form.number("fleet.plates", { label, hint, value: "1000" });
  const [half, most] = ["50", "90"].map((share) => form.number(`a${share}`, { label: `a${share}, found with ${share} %`, unit: unitShown("mm") }));
  const readings = form.file("measured", { label: "Readings" });
  const detectable = form.number("inspect_from_mm", { label: "Detectable crack length", unit: unitShown("mm") });

  /** `wish()` gives {options, input, files}, or null where a field is missing. */
  function offer(name, text, fields, wish) {
    const [status, trouble] = [element("p", { class: "quiet", role: "status" }), element("div")];
    const refuse = (error) => show(trouble, problemBox(error));
    const start = button(`Compute ${name}`, async () => {
      const wanted = wish();
      show(trouble, !wanted && element("p", { class: "field-problem" }, `Required: ${fields.map((field) => field.name.textContent).join(", ")}.`));
      if (!wanted) return;
      const { options = {}, input = job.input, files = [] } = wanted;
      const all = await filesOf(job).catch(refuse);
      const body = { name: `${nameOf(job)}, ${name}`, input, calibration: job.calibration ?? undefined, options, files: all?.length + files.length > 0 ? [...all, ...files] : undefined };
      if (all) await startRun("/v1/predictions", body, { button: start, status, refuse });
    }, { class: "button small", "data-action": name.replace(" ", "-") });
    return element("div", { class: "card" }, element("p", null, text), fields.length > 0 && grid(...fields.map(({ node }) => node)), start, status, trouble);
  }

  const cards = [
    !result.sensitivities && offer("sensitivities", "Effect of load, initial crack and growth law on the life.", [], () => ({ options: { sensitivities: true } })),
    !hasFile(job, "residual_strength.svg") && offer("residual strength", "Load the cracked plate can carry, over crack length.", [], () => ({ options: { residual_strength: true } })),
    !result.fleet && offer("fleet", "Life distribution: scatter of law, initial crack and load.", [plates],
      () => numberIn(plates) > 0 && { input: `${job.input}\n[fleet]\nplates = ${numberIn(plates)}\n` }),
    result.fleet && !result.fleet.inspections && offer("inspection interval", "Interval of the fleet: from a detectable crack to the end, 5 % of plates, divided by 3.", [detectable],
      () => numberIn(detectable) > 0 && { options: { inspect_from_mm: numberIn(detectable) / inShown(1, "mm") } }),
    !result.inspections && (inspection() || !result.fleet) && offer("detection", "Probability that all inspections miss the crack; interval as in Inspection.", [half, most], () => {
      const [from, lengths] = [inspection()?.options, [half, most].map((field) => numberIn(field) / inShown(1, "mm"))];
      return from && lengths.every((one) => one > 0) && { options: { ...from, pod: lengths.join(",") } };
    }),
    result.band && !result.measured && offer("remaining life", "Inspection readings of this plate narrow its band.", [readings],
      () => readings.given && { options: { measured: readings.given.name }, files: [readings.given] }),
  ].filter(Boolean);
  return cards.length > 0 ? [section("further", "Further analyses", element("p", { class: "hint" }, "Each is a new run of the same input."), element("div", { class: "choices" }, cards))] : [];
}
