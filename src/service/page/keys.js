// Keys of input files as the service declares them: the one source of labels, units, hints, choices and defaults of all forms.

import { getJson } from "./api.js";
import { sentence, words } from "./format.js";
import { INCH, KSI_SQRT_IN, isUs, unitShown } from "./units.js";

/** What the service says of keys, kinds, growth laws and models of retardation. */
export let known = null;

export async function loadKeys() {
  known ??= await getJson("/v1/kinds");
}

/** Keys of a section of a case or calibration (of one kind of it), or of a section of a sweep. */
export function keysOf(section, kind) {
  const own = known.form.properties[section] ?? known.others[section];
  return keysIn((own.oneOf?.find((one) => one.title === `${section}.${kind}`) ?? own).properties);
}

/** One of them by its metric name. */
export const keyOf = (section, metric) => keysOf(section).find((key) => key.metric === metric);

/** Names of a key of which every name has a meaning: {value, title, meaning}. */
export const choicesOf = (key) => known.kinds.filter((one) => one.key === key).map(({ name, meaning }) => ({ value: name, title: sentence(words(name)), meaning }));

/** Traits of a kind of specimen. */
export const traitsOf = (kind) => known.specimens.find((one) => one.name === kind) ?? {};

/** Whether an object has keys of these names only. */
export const hasOnly = (object, names) => Object.keys(object ?? {}).every((name) => names.includes(name));

function keysIn(properties, above = 1) {
  const all = Object.entries(properties).filter(([, own]) => own.title && (!own["x-twin"] || own["x-factor"])).map(([metric, own]) => toKey(metric, own, properties, above));
  // A formula has a key in each system.
  const alike = (key) => all.filter((other) => key.group && other.group === key.group && other.label === key.label && other.unit === key.unit);
  return all.filter((key) => alike(key).length < 2 || alike(key).at(isUs ? -1 : 0) === key);
}

/** A key under the name of the shown units; `factor`: metric units in one of these. */
function toKey(metric, own, properties, above) {
  const twin = isUs ? own["x-twin"] : undefined;
  const factor = twin ? own["x-factor"] : own["x-unit"] === "mm" ? above : 1;
  const [shape, choices, inner] = [shapeOf(metric, own), choicesIn(own), own.type === "array" ? own.items : own];
  return {
    metric, name: twin ?? metric, factor, exponent: twin && own["x-exponent"], shape, size: own.maxItems,
    label: sentence(own.title), hint: [own["x-hint"], !choices && own["x-default"] && `default ${own["x-default"]}`].filter(Boolean).join("; "),
    unit: twin ? properties[twin]["x-unit"] : factor === 1 ? own["x-unit"] : unitShown(own["x-unit"]),
    needed: own["x-needed"], signed: !(own.minimum >= 0), group: own["x-one-of"], only: own["x-only"],
    choices, keys: ["table", "rows"].includes(shape) ? keysIn(inner.properties ?? {}, factor) : [],
  };
}

function shapeOf(metric, own) {
  if (own.enum) return "choice";
  if (own["x-values"]) return "other";
  if (own.type === "array") return own.items.properties ? "rows" : own.items.type === "string" ? "names" : "numbers";
  if (own.type === "string") return /_file$|^growth_table$/.test(metric) ? "file" : "text";
  return { boolean: "flag", integer: "whole", object: "table" }[own.type] ?? "number";
}

function choicesIn({ enum: names, type, "x-meanings": meanings, "x-default": value, "x-needed": needed }) {
  const none = { value: "", title: needed ? "choose …" : value ? `Default: ${{ true: "yes", false: "no" }[value] ?? words(value)}` : "Automatic" };
  if (type === "boolean") return [none, { value: "true", title: "Yes" }, { value: "false", title: "No" }];
  return names && [none, ...names.map((name, index) => ({ value: name, title: sentence(words(name)), meaning: meanings[index] }))];
}

/** A metric value of the key in the units that are shown, with so many digits; C of a law by its exponent in `table`. */
export function toShown({ factor, exponent, shape }, value, table = {}, digits = 9) {
  if (!isUs || (factor === 1 && !exponent)) return value;
  const size = exponent ? factor / KSI_SQRT_IN ** (table[exponent] ?? table.paris_m ?? 0) : factor;
  const change = (number, by) => (Array.isArray(number) ? number.map((one) => change(one, by)) : typeof number === "number" ? Number((number / by).toPrecision(digits)) : number);
  // Rows of loads have a crack length first.
  return shape === "other" && Array.isArray(value) && Array.isArray(value[0]) ? value.map(([length, load]) => [change(length, INCH), change(load, size)]) : change(value, size);
}
