// Remaining life from a crack length, and the inspection interval.

import { byError, inPasses, inspectionsOf, lifeShown, promised, quantilesOf } from "./answer.js";
import { getJson } from "./api.js";
import { debounce, element, show, terms } from "./dom.js";
import { bandOf, bandOfError, deserved, fixed, parseNumber } from "./format.js";
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
  // An inspection that was asked for with the run is what the card starts with.
  const asked = job.summary.inspection;
  const start = asked?.tip ?? lead;
  const choice = lead !== null && tips.length > 1 ? element("select", { id: "today-tip" },
    tips.map((tip) => element("option", { value: String(tip.index), selected: tip.index === start }, `Tip ${tip.index}${tip.index === lead ? " (governing)" : ""}`))) : null;
  const lengthsOf = (index) => {
    const same = tips.filter((tip) => tip.crack === tips[index].crack);
    return columns.cycles.map((_, row) => same.reduce((sum, tip) => sum + columns[`tip${tip.index}_growth_mm`][row], tips[index].crack_length_initial_mm));
  };
  let [shortest, longest] = [0, 0];
  function follow(lengths) {
    shortest = lengths[0];
    longest = lengths.reduce((most, value) => Math.max(most, value), shortest);
  }
  follow(choice && start !== lead ? lengthsOf(tips.findIndex((tip) => tip.index === start)) : ofLead);
  // Rounded inwards: a length outside the curve has no answer.
  const [per, digits] = [inShown(1, "mm"), inShown(1, "mm") === 1 ? 2 : 4];
  const [nearest, up, down] = [(value) => Math.round(value), (value) => Math.ceil(value - 1e-6), (value) => Math.floor(value + 1e-6)]
    .map((round) => (value) => round(value * per * 10 ** digits) / 10 ** digits);
  const decimal = { type: "text", inputmode: "decimal", autocomplete: "off" };
  const length = element("input", { ...decimal, id: "today-length", "aria-describedby": "today-hint" });
  const factor = element("input", { ...decimal, id: "inspection-factor", value: String(asked?.factor ?? 3) });
  let exact = {}; // the length, mm, that the text in the field is rounded from
  function put(mm) {
    length.value = Math.min(Math.max(nearest(mm), up(shortest)), down(longest)).toFixed(digits);
    exact = { text: length.value, mm };
  }
  put(asked?.crack_length_mm ?? shortest);
  const answer = element("div", { "aria-live": "polite" });
  const field = (label, unit, input, hint) => element("div", { class: "field" },
    element("label", { for: input.id }, label, unit && element("span", { class: "visually-hidden" }, `, ${unit}`)),
    element("div", { class: "control" }, input, unit && element("span", { class: "unit" }, unit)), hint);

  /** Cycles in the digits of the life that they are part of. */
  function used(at) {
    const { life_cycles: life, ...of } = job.summary;
    const band = quantilesOf(of);
    return band ? deserved(at, band, Math.round, band[1]) : byError(at, of, Math.round, life);
  }

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
        [got.life_is_lower_bound ? "Remaining life ≥" : "Remaining life", value("remaining_cycles", band ? deserved(band[1], band) : byError(got.remaining_cycles, job.summary))],
        ["Band", band ? `median; ${bandOf(band)}` : "no band"],
        ["Inspection interval", element("span", null, value("inspection_interval_cycles",
          promised(got.inspection_interval_cycles, band ?? bandOfError(job.summary?.error_estimate_percent))), inPasses(got.inspection_interval_cycles, passes, life))],
        ["Life used", `${used(got.cycles_at)} of ${lifeShown(job.summary)} cycles`],
      ], "remaining"));
    } catch (error) {
      if (error.name !== "AbortError") show(answer, problemBox(error, error.passes ? ask : null));
    }
  }

  let isChosen = Boolean(asked);
  /** The inspection as it was entered, null where it is none. */
  function wanted() {
    const [a, f] = [parseNumber(length.value), parseNumber(factor.value)];
    if (!(a > 0) || !(f >= 1)) return null;
    const options = { inspect_from_mm: length.value === exact.text ? exact.mm : a / per, factor: f, ...(choice ? { tip: Number(choice.value) } : {}) };
    const { inspect_from_mm: from, ...others } = options;
    return { options, isChosen, query: `?${new URLSearchParams({ crack_length_mm: from, ...others })}`, words: `Inspection interval from ${length.value} ${unitShown("mm")}, factor ${factor.value}` };
  }

  const soon = debounce(ask, WAIT_MS);
  for (const input of [length, factor]) input.addEventListener("input", () => { isChosen = true; });
  length.addEventListener("input", soon);
  factor.addEventListener("input", soon);
  const hint = element("p", { class: "hint", id: "today-hint" });
  const tell = () => { hint.textContent = `${fixed(up(shortest), digits)} to ${fixed(down(longest), digits)} ${unitShown("mm")} on this curve`; };
  choice?.addEventListener("change", () => {
    isChosen = true;
    follow(lengthsOf(tips.findIndex((tip) => String(tip.index) === choice.value)));
    put(shortest);
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
      put(value);
      soon();
    },
  };
}
