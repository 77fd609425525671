// Fields of a form: label, input, unit and the problem that belongs to it, found again by the key of the input file.

import { element, uniqueId } from "./dom.js";
import { parseNumber } from "./format.js";

/** A problem key names a field, a part of it, or something it is a part of: specimen.cracks[1] is told at its first cell. */
function belongs(fieldKey, key) {
  const inside = (whole, part) => part.startsWith(whole) && /^[.[]/.test(part.slice(whole.length));
  return fieldKey === key || inside(key, fieldKey) || inside(fieldKey, key);
}

/** Attributes of an input for numbers. A phone keyboard for decimals has no minus, so signed numbers get the one for text. */
function numeric(signed, value) {
  return { type: "text", inputmode: signed ? "text" : "decimal", autocomplete: "off", spellcheck: "false", value };
}

/** A set of fields that tell `onChange` when the user types. */
export function createForm(onChange) {
  const fields = new Set();

  function add(field) {
    fields.add(field);
    field.input.addEventListener("input", () => {
      field.touched = true;
      say(field, "");
      onChange(field);
    });
    return field;
  }

  function say(field, words) {
    if (field.message.textContent === words && field.wrong === (words !== "")) return;
    field.wrong = words !== "";
    field.message.textContent = words;
    field.message.hidden = words === "";
    if (field.wrong) field.input.setAttribute("aria-invalid", "true");
    else field.input.removeAttribute("aria-invalid");
    field.node.classList.toggle("wrong", field.wrong);
  }

  function wrap(keys, input, { label, unit, hint, optional, id }) {
    const [hintId, messageId] = [`${id}-hint`, `${id}-problem`];
    const message = element("p", { class: "field-problem", id: messageId, hidden: true });
    const note = element("p", { class: "hint", id: hintId, hidden: !hint }, hint ?? "");
    const unitNode = element("span", { class: "unit", hidden: !unit }, unit ?? "");
    input.id = id;
    input.dataset.key = keys[0];
    input.setAttribute("aria-describedby", `${messageId} ${hintId}`);
    const name = element("span", null, label);
    const node = element("div", { class: "field" },
      // The unit belongs to the name that is read out, although it stands beside the input.
      element("label", { for: id }, name, unit ? element("span", { class: "visually-hidden" }, `, ${unit}`) : null,
        optional ? element("span", { class: "optional" }, " optional") : null),
      element("div", { class: "control" }, input, unitNode), message, note);
    return { keys, input, node, message, note, unitNode, name, touched: false, wrong: false };
  }

  const empty = (field) => field.input.value.trim() === "";

  return {
    /** A number with its unit. Left empty it is left out. */
    number(key, options) {
      const input = element("input", numeric(options.signed, options.value ?? ""));
      return add({ ...wrap([key].flat(), input, { id: uniqueId("field"), ...options }), numeric: true, needed: !options.optional });
    },
    /** Several numbers in groups, as `numbersIn` reads them. */
    numbers(key, options) {
      const input = element("input", { type: "text", autocomplete: "off", spellcheck: "false" });
      return add({ ...wrap([key], input, { id: uniqueId("field"), optional: true, ...options }), numeric: true, several: true });
    },
    /** A choice among `options`: {value, title}; `needed` where the empty one is none. */
    choice(key, options) {
      const input = element("select", null, options.options.map(({ value, title }) => element("option", { value }, title)));
      const field = wrap([key].flat(), input, { id: uniqueId("field"), ...options });
      field.node.classList.add("choice");
      return add({ ...field, needed: options.needed });
    },
    /** A line of text. */
    text(key, options) {
      const input = element("input", { type: "text", autocomplete: "off", value: options.value ?? "" });
      return add(wrap([key].flat(), input, { id: uniqueId("field"), ...options }));
    },
    /** An input of a table: its name is spoken, its problem stands below the table. */
    cell(key, name, value, message) {
      const input = element("input", { ...numeric(true, value), "aria-label": name, "data-key": key });
      const node = element("td", { class: "cell" }, input);
      return add({ keys: [key], input, node, message, name: { textContent: name }, numeric: true, needed: true, touched: false, wrong: false });
    },
    /** Forgets fields that left the page. */
    drop(list) {
      list.forEach((field) => fields.delete(field));
    },
    /** Names of the fields that have to be filled in still. */
    missing() {
      return [...fields].filter((field) => field.needed && inUse(field) && empty(field)).map((field) => field.name.textContent);
    },
    /** Whether every number that stands in a visible field is one; says so at those that are not. */
    numbersAreGood() {
      let good = true;
      for (const field of fields) {
        if (!field.numeric || !inUse(field) || empty(field)) continue;
        const wrong = (field.several ? groupsIn(field).flat() : [field.input.value]).find((number) => Number.isNaN(parseNumber(number)));
        if (wrong === undefined) continue;
        say(field, `“${wrong.trim()}” is not a number: give a plain one, such as 12.5 or 1e-7`);
        good = false;
      }
      return good;
    },
    clearProblems() {
      fields.forEach((field) => say(field, ""));
    },
    /** Puts a problem of the service beside its field; true when there is such a field. */
    showProblem(input) {
      const key = input?.key ?? "";
      const found = key && [...fields].find((field) => inUse(field) && field.keys.some((own) => belongs(own, key)));
      if (!found) return false;
      const remedy = input.remedy ? `: ${input.remedy}` : "";
      say(found, `${input.problem ?? "is wrong"}${remedy}`);
      return true;
    },
  };
}

/** A hidden field takes no part, nor does one in a hidden group; but the whole view may be hidden while it is being filled. */
function inUse(field) {
  return field.node.isConnected && !field.node.closest("[hidden]:not(.view)");
}

/** Number in a field, undefined where it is empty or none. */
export function numberIn(field) {
  const value = parseNumber(field.input.value);
  return Number.isNaN(value) ? undefined : value;
}

/** What stands between semicolons, and there between blanks; commas before blanks do not count. */
function groupsIn(field) {
  return field.input.value.split(";").map((group) => group.trim().split(/,?\s+/));
}

/** Numbers in a field of several: a list, or a list of lists where semicolons divide them; undefined where it is empty. */
export function numbersIn(field) {
  if (field.input.value.trim() === "") return undefined;
  const groups = groupsIn(field).map((group) => group.map(parseNumber));
  return groups.length > 1 ? groups : groups[0];
}

/** Sets a field as if it were typed, without telling anybody. */
export function fillIn(field, value) {
  const several = (list) => list.map((item) => (Array.isArray(item) ? several(item) : item)).join(list.some(Array.isArray) ? "; " : " ");
  field.input.value = value === undefined || value === null ? "" : Array.isArray(value) ? several(value) : String(value);
}

/** A group of fields. */
export function group(title, ...children) {
  return element("fieldset", null, element("legend", null, title), ...children);
}

export function grid(...fields) {
  return element("div", { class: "fields" }, ...fields);
}

/** Takes keys with a value only. */
export function compact(object) {
  return Object.fromEntries(Object.entries(object).filter(([, value]) => value !== undefined && value !== ""));
}
