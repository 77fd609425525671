// What the lines above the table of a laboratory's file say of the test: width, thickness, stress ratio, kind of specimen, alloy.

import { parseNumber } from "./format.js";
import { choicesOf } from "./keys.js";
import { INCH } from "./units.js";

const LINES_MAX = 60;
const NUMBER = "([-+]?\\d+(?:[.,]\\d+)?)";
/** Names of a quantity, by the metric key that it is. */
const NAMES = { width_mm: "W|width", thickness_mm: "B|thickness", stress_ratio: "R|stress ratio|load ratio|R[- ]ratio" };

/** Lines before the first that has numbers alone. */
function linesOf(text) {
  const lines = text.split(/\r?\n/).slice(0, LINES_MAX);
  const first = lines.findIndex((line) => /\d/.test(line) && !/[a-z]/i.test(line.replace(/\d[eE][-+]?\d/g, "")));
  return lines.slice(0, Math.max(first, 0)).map((line) => line.replace(/^[#%*"\s]+/, ""));
}

function numberOf(lines, names) {
  const pattern = new RegExp(`(?:^|[\\s,;])(?:${names})\\s*(?:[[(]?(mm|inch|in)[\\])]?\\.?)?\\s*(?:[=:;,\\t]\\s*)+"?${NUMBER}\\s*(mm|inch|in)?\\b`, "i");
  const [, before, number, behind] = lines.map((line) => line.match(pattern)).find(Boolean) ?? [];
  return number && parseNumber(number) * (/in/i.test(before ?? behind ?? "") ? INCH : 1);
}

/** {width_mm, thickness_mm, stress_ratio, kind, material} as far as they are said; `materials` are those of the library. */
export function preambleOf(text, materials) {
  const lines = linesOf(text);
  const whole = lines.join("\n");
  const designation = whole.match(/\b(M|C|ESE|SE|DE)[ -]?\(?(T|B)\)?(?![\w)])/)?.slice(1, 3);
  const named = designation && `${designation[0]}(${designation[1]})`;
  const alloy = whole.match(/\b\d{4}-T\d+/i)?.[0].toLowerCase();
  return {
    ...Object.fromEntries(Object.entries(NAMES).map(([key, names]) => [key, numberOf(lines, names)])),
    kind: named && choicesOf("specimen.kind").find(({ meaning }) => meaning.split(/[ ,;]/).includes(named))?.value,
    material: alloy && materials.find(({ name, title }) => new RegExp(`${alloy}(?!\\d)`, "i").test(`${name} ${title}`))?.name,
  };
}
