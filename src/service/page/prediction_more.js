// Further terms of a prediction: passes and retardation of a spectrum, breakthrough of a part-through crack.

import { element, terms } from "./dom.js";
import { cycles, deserved, percent, plain, sentence, significant, whole, words } from "./format.js";
import { createSpectrumPicture } from "./spectrum_picture.js";
import { lengthAlone, lengthShown, sized } from "./units.js";

/** Breakthrough, its rule, and the effect of the error of K on the life: terms of the answer card. */
export function partThroughTerms({ part_through: found, life_cycles: life }) {
  if (!found) return [];
  const through = found.cycles_at_break_through;
  const [shorter, longer] = [found.life_cycles_if_k_is_larger, found.life_cycles_if_k_is_smaller];
  const rounded = (value) => deserved(value, [shorter, life, longer ?? 2 * life]);
  return [
    ["Depth a", `${lengthAlone(found.crack_depth_initial_mm, 2)} to ${lengthShown(found.crack_depth_final_mm, 2)}`],
    ["Breakthrough", through === null ? "not reached" : `after ${cycles(Math.round(through))} cycles (a/t = 1), c ${lengthShown(found.crack_length_at_break_through_mm, 2)}`],
    [`K ±${plain(found.k_error_percent)} %`, `life ${rounded(shorter)} to ${longer === null ? "unlimited" : rounded(longer)}`],
  ];
}

const nameOf = ({ retardation }) => (retardation?.model && retardation.model !== "none" ? sentence(words(retardation.model)) : "none");

/** The largest load of a spectrum with its unit. */
function largestOf({ spectrum, case: input }) {
  const { spectrum_scale_mpa: stress, spectrum_scale_n: force } = input?.loading ?? {};
  return stress === undefined ? sized(force * spectrum.largest, "N", 4) : sized(stress * spectrum.largest, "MPa", 4);
}

/** Passes, the largest cycle and the model of retardation: terms of the answer card. */
export function spectrumTerms(result) {
  const { spectrum, passes } = result;
  if (!spectrum) return [];
  return [
    passes !== null && passes !== undefined && ["Passes", `${significant(passes)} of ${plain(spectrum.cycles_per_pass)} cycles`],
    ["Largest load", largestOf(result)],
    ["Retardation", nameOf(spectrum)],
  ].filter(Boolean);
}

/** The card of the spectrum with its pictures: {node, destroy()}; null under other loads. */
export function spectrumCard(result) {
  const { spectrum, life_cycles: life } = result;
  if (!spectrum) return null;
  const place = element("div", { class: "two" });
  const picture = createSpectrumPicture(place);
  picture.set(spectrum.curves ?? null);
  const mean = spectrum.life_cycles_without_retardation;
  const { model: _, ...constants } = spectrum.retardation ?? {};
  const facts = [
    ["File", `${spectrum.file} (${words(spectrum.format)})`],
    ["A pass", `${plain(spectrum.cycles_per_pass)} cycles of ${plain(spectrum.kinds_of_cycles)} kinds, stress ratios ${significant(spectrum.stress_ratio_min, 3)} to ${significant(spectrum.stress_ratio_max, 3)}`],
    ["Omitted", spectrum.cycles_omitted_per_pass > 0 ? `${plain(spectrum.cycles_omitted_per_pass)} cycles of a pass` : "nothing"],
    spectrum.truncated_at && ["Clipped", `peaks above ${percent(spectrum.truncated_at, 0)} of the largest of the file`],
    ["Retardation", [nameOf(spectrum), ...Object.entries(constants).map(([key, value]) => `${words(key)} ${plain(value)}`)].join(", ")],
    mean > 0 && ["Without load interaction", `${whole(mean)} cycles${life ? `; the life is ${significant(life / mean, 3)} times that` : ""}`],
  ].filter(Boolean);
  return {
    node: element("section", { class: "card stack tight", "aria-labelledby": "spectrum-title", "data-part": "spectrum" },
      element("h2", { id: "spectrum-title" }, "Spectrum"), place, terms(facts, "spectrum")),
    destroy: picture.destroy,
  };
}
