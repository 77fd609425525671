// Remaining life from today's crack length, and the interval to inspect at.

import { getJson } from "./api.js";
import { debounce, element, show, terms } from "./dom.js";
import { bandOf, cycles, deserved, fixed, parseNumber } from "./format.js";
import { pathOf } from "./job.js";
import { problemBox } from "./notices.js";

const SLIDER_STEPS = 1000;
const WAIT_MS = 200;

/** `mark(cycles, length)` shows today on the curve; null takes it away. */
export function createRemaining(job, columns, mark, signal) {
  const steps = columns.cycles;
  const life = steps.at(-1);
  // In a plate the length of the crack of one tip is asked for, first that which ends the life; the sum of all is no length anyone measures.
  const tips = (job.summary.tips ?? []).map((tip, index) => ({ ...tip, index })).filter((tip) => tip.crack !== null && tip.crack !== undefined);
  const leads = tips.find((tip) => tip.leads);
  const choice = leads && tips.length > 1 ? element("select", { id: "today-tip" },
    tips.map((tip) => element("option", { value: String(tip.index), selected: tip === leads }, `Tip ${tip.index}${tip === leads ? ", ends the life" : ""}`))) : null;
  let lengths;
  let [shortest, longest] = [0, 0];
  function follow(tip) {
    const same = tip ? tips.filter((other) => other.crack === tip.crack) : [];
    lengths = tip
      ? steps.map((_, row) => same.reduce((sum, other) => sum + columns[`tip${other.index}_growth_mm`][row], tip.crack_length_initial_mm))
      : columns.crack_length_mm;
    shortest = lengths[0];
    longest = lengths.reduce((most, value) => Math.max(most, value), shortest);
  }
  follow(leads);
  // Rounded inwards: a length outside the curve has no answer.
  const rounded = (value) => Math.min(Math.max(Math.round(value * 100), Math.ceil(shortest * 100)), Math.floor(longest * 100)) / 100;
  const decimal = { type: "text", inputmode: "decimal", autocomplete: "off" };
  const length = element("input", { ...decimal, id: "today-length", value: rounded(shortest).toFixed(2), "aria-describedby": "today-hint" });
  const slider = element("input", { type: "range", id: "today-slider", min: "0", max: String(SLIDER_STEPS), value: "0" });
  const factor = element("input", { ...decimal, id: "inspection-factor", value: "3" });
  const answer = element("div", { "aria-live": "polite", class: "remaining-answer" });
  const field = (label, unit, input, hint) => element("div", { class: input.type === "range" ? "field wide" : "field" },
    element("label", { for: input.id }, label, unit && element("span", { class: "visually-hidden" }, `, ${unit}`)),
    element("div", { class: "control" }, input, unit && element("span", { class: "unit" }, unit)), hint);

  /** Length at a number of cycles, linear between the blocks. */
  function lengthAt(at) {
    let index = steps.findIndex((value) => value >= at);
    if (index <= 0) return lengths[index === 0 ? 0 : lengths.length - 1];
    if (steps[index] === steps[index - 1]) index += 1;
    const share = (at - steps[index - 1]) / (steps[index] - steps[index - 1]);
    return lengths[index - 1] + share * (lengths[index] - lengths[index - 1]);
  }

  async function ask() {
    const [a, f] = [parseNumber(length.value), parseNumber(factor.value)];
    if (!(a > 0) || !(f >= 1)) {
      mark(null);
      show(answer, element("p", { class: "field-problem" }, "Give a crack length in mm and a factor of at least 1."));
      return;
    }
    try {
      const got = await getJson(`${pathOf(job)}/remaining?crack_length_mm=${a}&factor=${f}${choice ? `&tip=${choice.value}` : ""}`, signal);
      mark(got.cycles_at, got.crack_length_of_all_mm);
      // Not while the slider is being dragged: it would jump under the hand.
      if (document.activeElement !== slider) slider.value = String(Math.round((got.cycles_at / life) * SLIDER_STEPS));
      slider.setAttribute("aria-valuetext", `crack length ${fixed(got.crack_length_mm, 2)} mm`);
      const large = (key, text) => element("strong", { class: "large", "data-value": key }, `${text} cycles`);
      const band = got.has_band ? [got.remaining_cycles_p05, got.remaining_cycles_p50, got.remaining_cycles_p95] : null;
      show(answer, terms([
        [got.life_is_lower_bound ? "Remaining life, at least" : "Remaining life", large("remaining_cycles", band ? deserved(band[1], band) : cycles(Math.round(got.remaining_cycles)))],
        ["Band", band ? `median; ${bandOf(band)}` : "no band"],
        // Rounded down: an interval is a promise.
        ["Inspection interval", large("inspection_interval_cycles",
          band ? deserved(got.inspection_interval_cycles, band, Math.floor) : cycles(Math.floor(got.inspection_interval_cycles)))],
        ["Used so far", `${cycles(Math.round(got.cycles_at))} of ${cycles(Math.round(got.life_cycles))} cycles`],
      ], "remaining"));
    } catch (error) {
      if (error.name === "AbortError") return;
      mark(null);
      show(answer, problemBox(error, error.passes ? ask : null));
    }
  }

  const soon = debounce(ask, WAIT_MS);
  length.addEventListener("input", soon);
  factor.addEventListener("input", soon);
  slider.addEventListener("input", () => {
    length.value = rounded(lengthAt((Number(slider.value) / SLIDER_STEPS) * life)).toFixed(2);
    soon();
  });
  const hint = element("p", { class: "hint", id: "today-hint" });
  const tell = () => { hint.textContent = `${fixed(shortest, 2)} to ${fixed(longest, 2)} mm on this curve`; };
  choice?.addEventListener("change", () => {
    follow(tips.find((tip) => String(tip.index) === choice.value));
    length.value = rounded(shortest).toFixed(2);
    tell();
    ask();
  });
  tell();
  ask();

  return element("section", { class: "remaining", "aria-labelledby": "remaining-title", "data-part": "remaining" },
    element("h2", { id: "remaining-title" }, "Remaining life"),
    element("div", { class: "fields" },
      choice && field("Crack tip", "", choice),
      field(leads ? "Length of its crack today" : "Crack length today", "mm", length, hint),
      field("Position along the life", "", slider),
      field("Inspection factor", "", factor, element("p", { class: "hint" }, "interval = 5 % remaining life / factor; without a band remaining life / factor"))),
    answer);
}
