// Units that the page shows: everything comes in mm, MPa and MPa√m; a switch, kept by the browser, has every figure shown in inch, ksi and ksi√in.
// Words change where they enter the document, charts along their axes; fields have the keys of the shown units.

import { fixed, scientific, significant } from "./format.js";

export const INCH = 25.4; // mm
const KSI = 4.4482216152605e3 / INCH ** 2; // MPa
export const KSI_SQRT_IN = KSI * Math.sqrt(INCH / 1e3); // MPa√m
/** Metric unit: its US one, and how many of it that has. */
const UNITS = {
  "MPa√m": ["ksi√in", KSI_SQRT_IN], "mm/cycle": ["in/cycle", INCH], mm: ["inch", INCH], MPa: ["ksi", KSI],
  GPa: ["Msi", KSI], kN: ["kip", 4.4482216152605], N: ["lbf", 4.4482216152605],
};
const DIGITS_LEAST = 4;
const SUPERSCRIPT = "⁰¹²³⁴⁵⁶⁷⁸⁹";
/** What stays as it is: fields (which have keys of the shown units), input as submitted, lists of files and names by the user. */
const KEPT = "input, select, textarea, pre, code, .field, .row-table, .downloads, .title-row h1, .input-text, [data-metric]";

const NUMBER = "[-−+]?\\d(?:[\\d\u202f]*)(?:\\.\\d+)?(?:e[-+]?\\d+| × 10[⁻⁰¹²³⁴⁵⁶⁷⁸⁹]+)?";
const NAMES = Object.keys(UNITS).map((name) => name.replace("/", "\\/")).join("|");
const QUANTITY = new RegExp(`(?<![\\w.√^])((?:${NUMBER}(?: to | × | x | → |–| ± |, (?=[^()]*\\))))*\\(?${NUMBER}\\)?)([ \u00a0\u202f]?)(${NAMES})(?![\\w√/²^])`, "gu");
const ALONE = new RegExp(`(?<![\\w√/.])(${NAMES.replace("|N", "")})(?![\\w√/²^])`, "gu");
/** A ΔK without its unit, and the second range in a list of them. */
const BARE = new RegExp(`(ΔK |% (?:faster|slower) at )(${NUMBER}(?: to ${NUMBER})?)(?![\\d.]|\\s*(?:to |ksi|MPa))`, "gu");
/** C of a law belongs to both units. */
const LEVEL = new RegExp(`(${NUMBER}) ΔK\\^([\\d.]+) (\\(mm/cycle, MPa√m\\))`, "u");

/** A choice that the browser keeps, after `value` is set where it is given; undefined where its storage is off. */
export function kept(name, value) {
  try {
    if (value) localStorage.setItem(`perilife.${name}`, value);
    return localStorage.getItem(`perilife.${name}`);
  } catch {
    return undefined;
  }
}

export const isUs = kept("units") === "us";

/** A written number as a value. */
function valueOf(text) {
  const plain = text.replaceAll("\u202f", "").replaceAll("−", "-");
  const [mantissa, power] = plain.split(" × 10");
  const exponent = power?.replace("⁻", "-").replace(/[⁰¹²³⁴⁵⁶⁷⁸⁹]/g, (sign) => SUPERSCRIPT.indexOf(sign));
  return Number(mantissa) * 10 ** Number(exponent ?? 0);
}

/** A written number times a factor, in the same form and with as many digits. */
function times(text, factor) {
  const value = valueOf(text) * factor;
  const mantissa = text.split(/e| × /)[0].replace(/^[^1-9]*/, "");
  const digits = Math.max(DIGITS_LEAST, mantissa.replace(/\D/g, "").length);
  if (value === 0) return "0";
  const magnitude = Math.floor(Math.log10(Math.abs(value)));
  if (!/e|×/.test(text) && magnitude >= -3 && magnitude < 9) return value.toFixed(Math.max(0, digits - 1 - magnitude)).replace("-", "−");
  const [head, exponent] = value.toExponential(digits - 1).split("e");
  if (/e/.test(text)) return `${head}e${Number(exponent)}`;
  return `${head.replace("-", "−")} × 10${String(Number(exponent)).replace("-", "⁻").replace(/\d/g, (digit) => SUPERSCRIPT[digit])}`;
}

/** Words with their quantities in the units that are shown. */
export function told(text) {
  if (!isUs) return text;
  return text
    .replace(LEVEL, (_, c, m, units) => `${times(c, KSI_SQRT_IN ** Number(m) / INCH)} ΔK^${m} ${units}`)
    .replace(QUANTITY, (_, numbers, space, name) => numbers.replace(new RegExp(NUMBER, "gu"), (one) => times(one, 1 / UNITS[name][1])) + space + UNITS[name][0])
    .replace(BARE, (_, symbol, numbers) => `${symbol}${numbers.replace(new RegExp(NUMBER, "gu"), (one) => times(one, 1 / KSI_SQRT_IN))} ksi√in`)
    .replace(ALONE, (name) => UNITS[name][0]);
}

/** A number without its unit, as in a table. */
export function apart(text, unit) {
  return isUs && UNITS[unit] && typeof text === "string" ? told(`${text} ${unit}`).replace(` ${UNITS[unit][0]}`, "") : text;
}

/** The unit that is shown in place of a metric one. */
export const unitShown = (unit) => (isUs && UNITS[unit]?.[0]) || unit;

/** A number that is written apart from its unit. */
export const inShown = (value, unit) => value / ((isUs && UNITS[unit]?.[1]) || 1);

/** A length, mm, with its unit: `decimals` of a millimetre, two more of an inch. What is rounded is the number that is shown. */
export const lengthShown = (mm, decimals) => `${lengthAlone(mm, decimals)} ${unitShown("mm")}`;
export const lengthAlone = (mm, decimals) => fixed(inShown(mm, "mm"), decimals + (isUs ? 2 : 0));

/** A metric value with its unit and so many significant digits of the number that is shown. */
export const sized = (value, unit, digits) => `${significant(inShown(value, unit), digits)} ${unitShown(unit)}`;

/** The same of a range. */
export const spanned = (from, to, unit, digits) => `${significant(inShown(from, unit), digits)} to ${sized(to, unit, digits)}`;

/** A growth rate, mm/cycle, with its unit. */
export const rateShown = (rate, digits) => `${scientific(inShown(rate, "mm/cycle"), digits)} ${unitShown("mm/cycle")}`;

/** Ends of keys, metric and in US units, longer ones first. */
const KEYS = { mpa_sqrt_m: "ksi_sqrt_in", mm_per_cycle: "in_per_cycle", mm: "in", mpa: "ksi", gpa: "msi", kn: "kip" };
const KEY = new RegExp(`(?<![\\w/\\\\-])([a-z][\\w.[\\]]*_)(${Object.keys(KEYS).join("|")})(?![\\w.]*\\w| *=)`, "g");

/** Words with keys as the forms have them: stop.crack_length_mm is stop.crack_length_in. */
export const toldWithKeys = (text) => (isUs && text ? told(text).replace(KEY, (_, stem, unit) => stem + KEYS[unit]) : text);

/** C of C ΔK^m, mm/cycle at 1 MPa√m, in the units that are shown. */
export const levelShown = (c, m) => (isUs ? (c * KSI_SQRT_IN ** m) / INCH : c);

/** An axis of a chart with its unit and what its values are multiplied by. */
export function axisShown(axis) {
  return { ...axis, unit: unitShown(axis.unit), per: inShown(1, axis.unit) };
}

/** Changes the words of a node, unless they are kept; a unit in an element of its own goes with the number before it. */
function change(node) {
  const parent = node.parentElement;
  if (!parent || parent.closest(KEPT) || parent.closest("style, script")) return;
  const before = parent.previousSibling?.previousSibling ?? parent.previousSibling;
  const unit = node.data.trim();
  if (UNITS[unit] && parent.localName === "small" && before?.nodeType === Node.TEXT_NODE) {
    before.data = apart(before.data, unit);
    node.data = UNITS[unit][0];
    return;
  }
  const next = told(node.data);
  if (next !== node.data) node.data = next;
}

function changeAll(root) {
  if (root.nodeType === Node.TEXT_NODE) return change(root);
  const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
  const nodes = [];
  while (walker.nextNode()) nodes.push(walker.currentNode);
  nodes.forEach(change);
}

/** Shows what comes into the document in the units of choice, and lets `button` change them. */
export function startUnits(button) {
  button.textContent = isUs ? "inch, ksi" : "mm, MPa";
  button.title = "Units of forms and figures; files stay metric";
  button.addEventListener("click", () => {
    if (kept("units", isUs ? "si" : "us")) location.reload();
  });
  if (!isUs) return;
  changeAll(document.getElementById("main"));
  new MutationObserver((changes) => changes.forEach(({ type, target, addedNodes }) => (type === "characterData" ? change(target) : addedNodes.forEach(changeAll))))
    .observe(document.getElementById("main"), { childList: true, subtree: true, characterData: true });
}
