// What the lines above the table of a laboratory's file say of the test: width, thickness, stress ratio, kind of specimen, material.

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

/** A material is behind a separator, or a designation with a digit behind a blank. */
const MATERIAL = /(?:^|[ \t,;])(?:material|alloy|werkstoff|legierung)\b(?:[ \t]+(?:name|grade|spec\w*|no)\b\.?)?[ \t"]*(?:[=:;,\t][ \t"=:;,]*|[ \t](?=\S*\d))([^\s"=:;,][^\n";\t]*)/im;
const ORIENTATION = /(?:^|[ \t,;])(?:orientation|crack plane|rissebene|probenlage)\b[ \t"=:;,]+([LTSCR])[- ]?([LTSCR])\b/im;

/** The alloy of a material of the library, without its family: 2024-T3, Ti-6Al-4V. */
const alloyOf = ({ title }) => title.split(",")[0].match(/\S*\d.*/)?.[0] ?? title;

/** Whether words name an alloy, however its parts are set apart: EN AW-2024 T3 is 2024-T3, 2024-T351 is not. */
function names(text, alloy) {
  const parts = alloy.match(/\d+|[a-z]+/gi).join("[\\s-]*");
  return new RegExp(`(?<![a-z\\d])(?:AA|AL|EN AW|AW)?[\\s-]*${parts}(?!-?[a-z]*\\d|[a-z])`, "i").test(text);
}

/**
 * The material of the library that the lines name: {stated, name, orientation}. Without `name` what is `stated` is none of the library, or
 * several; `orientation` is one that no record of this alloy is of.
 */
function materialOf(text, materials) {
  const stated = text.match(MATERIAL)?.[1].replace(/[\s,]+$/, "");
  const orientation = text.match(ORIENTATION)?.slice(1).join("-").toUpperCase();
  const alloys = [...new Set(materials.map(alloyOf))];
  const named = alloys.filter((alloy) => names(stated ?? (alloy.includes("-") ? text : ""), alloy));
  // Of names that hold each other the longest.
  const own = named.filter((alloy) => !named.some((other) => other !== alloy && names(other, alloy)));
  if (own.length === 0) return { stated };
  const all = materials.filter((material) => own.length === 1 && alloyOf(material) === own[0]);
  const orientations = ({ title }) => title.match(/\b[LTSCR]-[LTSCR]\b/g) ?? [];
  const [same, any] = [all.filter((one) => orientations(one).includes(orientation)), all.filter((one) => orientations(one).length === 0)];
  const chosen = [same, any, all].find((list) => list.length > 0) ?? [];
  return { stated: stated ?? own.join(", "), name: chosen.length === 1 ? chosen[0].name : undefined, orientation: same.length === 0 ? orientation : undefined };
}

/** {width_mm, thickness_mm, stress_ratio, kind, material} as far as they are said; `materials` are those of the library. */
export function preambleOf(text, materials) {
  const lines = linesOf(text);
  const whole = lines.join("\n");
  const designation = whole.match(/\b(M|C|ESE|SE|DE)[ -]?\(?(T|B)\)?(?![\w)])/)?.slice(1, 3);
  const named = designation && `${designation[0]}(${designation[1]})`;
  return {
    ...Object.fromEntries(Object.entries(NAMES).map(([key, names]) => [key, numberOf(lines, names)])),
    kind: named && choicesOf("specimen.kind").find(({ meaning }) => meaning.split(/[ ,;]/).includes(named))?.value,
    material: materialOf(whole, materials),
  };
}
