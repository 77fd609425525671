// Remaining life from a crack length, and the inspection interval.

import { inPasses, inspectionsOf } from "./answer.js";
import { getJson } from "./api.js";
import { debounce, element, show, terms } from "./dom.js";
import { bandOf, cycles, deserved, fixed, parseNumber } from "./format.js";
import { pathOf } from "./job.js";
import { problemBox } from "./notices.js";
import { inShown, unitShown } from "./units.js";

const WAIT_MS = 200;

const cardOf = (...content) => element("section", { class: "card", "aria-labelledby": "remaining-title", "data-part": "remaining" },
  element("h2", { id: "remaining-title" }, "Inspection"), ...content);

/** The inspection of a fleet as it was computed: another length or factor is another run. Null where it was not asked for. */
export function fleetInspection(result) {
  const looks = inspectionsOf(result);
  if (!looks) return null;
  const [low, middle, high] = looks.left;
  return cardOf(terms([
    ["Detectable crack length", looks.from],
    ["Remaining life from there", `${middle} cycles; 90 % of plates ${low} to ${high}`],
    ["Inspection interval", [element("strong", { "data-value": "inspection_interval_cycles" }, looks.interval), ` (${looks.rule})`]],
  ], "remaining"));
}

/** `go(cycles)` moves the place along the life. Gives {node, setLength(mm)}. */
export function createRemaining(job, { columns, lengths: ofLead, lead }, go, signal) {
  // In a plate the length of the crack of one tip, first the governing one.
  const tips = (job.summary.tips ?? []).map((tip, index) => ({ ...tip, index })).filter((tip) => tip.crack !== null && tip.crack !== undefined);
  const choice = lead !== null && tips.length > 1 ? element("select", { id: "today-tip" },
    tips.map((tip) => element("option", { value: String(tip.index), selected: tip.index === lead }, `Tip ${tip.index}${tip.index === lead ? " (governing)" : ""}`))) : null;
  const lengthsOf = (index) => {
    const same = tips.filter((tip) => tip.crack === tips[index].crack);
    return columns.cycles.map((_, row) => same.reduce((sum, tip) => sum + columns[`tip${tip.index}_growth_mm`][row], tips[index].crack_length_initial_mm));
  };
  let [shortest, longest] = [0, 0];
  function follow(lengths) {
    shortest = lengths[0];
    longest = lengths.reduce((most, value) => Math.max(most, value), shortest);
  }
  follow(ofLead);
  // Rounded inwards: a length outside the curve has no answer.
  const [per, digits] = [inShown(1, "mm"), inShown(1, "mm") === 1 ? 2 : 4];
  const least = (round, value) => round(value * per * 10 ** digits) / 10 ** digits;
  const rounded = (value) => Math.min(Math.max(least(Math.round, value), least(Math.ceil, shortest)), least(Math.floor, longest));
  const decimal = { type: "text", inputmode: "decimal", autocomplete: "off" };
  const length = element("input", { ...decimal, id: "today-length", value: rounded(shortest).toFixed(digits), "aria-describedby": "today-hint" });
  const factor = element("input", { ...decimal, id: "inspection-factor", value: "3" });
  const answer = element("div", { "aria-live": "polite" });
  const field = (label, unit, input, hint) => element("div", { class: "field" },
    element("label", { for: input.id }, label, unit && element("span", { class: "visually-hidden" }, `, ${unit}`)),
    element("div", { class: "control" }, input, unit && element("span", { class: "unit" }, unit)), hint);

  async function ask() {
    if (!wanted()) {
      show(answer, element("p", { class: "field-problem" }, `Give a crack length in ${unitShown("mm")} and a factor of at least 1.`));
      return;
    }
    try {
      const got = await getJson(`${pathOf(job)}/remaining${wanted().query}`, signal);
      if (document.activeElement === length) go(got.cycles_at);
      // Under a spectrum an interval is planned in passes.
      const { passes, life_cycles: life } = job.summary ?? {};
      const value = (key, text) => element("strong", { "data-value": key }, `${text} cycles`);
      const band = got.has_band ? [got.remaining_cycles_p05, got.remaining_cycles_p50, got.remaining_cycles_p95] : null;
      show(answer, terms([
        [got.life_is_lower_bound ? "Remaining life ≥" : "Remaining life", value("remaining_cycles", band ? deserved(band[1], band) : cycles(Math.round(got.remaining_cycles)))],
        ["Band", band ? `median; ${bandOf(band)}` : "no band"],
        // Rounded down: an interval is a promise.
        ["Inspection interval", element("span", null, value("inspection_interval_cycles",
          band ? deserved(got.inspection_interval_cycles, band, Math.floor) : cycles(Math.floor(got.inspection_interval_cycles))), inPasses(got.inspection_interval_cycles, passes, life))],
        ["Life used", `${cycles(Math.round(got.cycles_at))} of ${cycles(Math.round(got.life_cycles))} cycles`],
      ], "remaining"));
    } catch (error) {
      if (error.name !== "AbortError") show(answer, problemBox(error, error.passes ? ask : null));
    }
  }

  let isChosen = false;
  /** The inspection as it was entered, null where it is none. */
  function wanted() {
    const [a, f] = [parseNumber(length.value), parseNumber(factor.value)];
    if (!(a > 0) || !(f >= 1)) return null;
    const options = { inspect_from_mm: a / per, factor: f, ...(choice ? { tip: Number(choice.value) } : {}) };
    const { inspect_from_mm: from, ...others } = options;
    return { options, isChosen, query: `?${new URLSearchParams({ crack_length_mm: from, ...others })}`, words: `Inspection interval from ${length.value} ${unitShown("mm")}, factor ${factor.value}` };
  }

  const soon = debounce(ask, WAIT_MS);
  for (const input of [length, factor]) input.addEventListener("input", () => { isChosen = true; });
  length.addEventListener("input", soon);
  factor.addEventListener("input", soon);
  const hint = element("p", { class: "hint", id: "today-hint" });
  const tell = () => { hint.textContent = `${fixed(shortest * per, digits)} to ${fixed(longest * per, digits)} ${unitShown("mm")} on this curve`; };
  choice?.addEventListener("change", () => {
    isChosen = true;
    follow(lengthsOf(tips.findIndex((tip) => String(tip.index) === choice.value)));
    length.value = rounded(shortest).toFixed(digits);
    tell();
    ask();
  });
  tell();
  ask();

  const node = cardOf(element("div", { class: "columns" },
    element("div", { class: "fields" },
      choice && field("Crack tip", "", choice),
      field("Current crack length", unitShown("mm"), length, hint),
      field("Inspection factor", "", factor, element("p", { class: "hint" }, "interval = 5 % remaining life / factor (median if no band)"))),
    answer));
  return {
    node, wanted,
    /** The slider has moved: of the tip that ends the life. */
    setLength(value) {
      if (choice && choice.value !== String(lead)) return;
      length.value = rounded(value).toFixed(digits);
      soon();
    },
  };
}
