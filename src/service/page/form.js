// Fields of a form: label, input, unit, hint and the problem of its key.

import { element, uniqueId } from "./dom.js";
import { parseNumber } from "./format.js";

/** Whether a problem of `key` is shown at a field: the same, a part of it, or a whole that it is a part of. */
function belongs(fieldKey, key) {
  const inside = (whole, part) => part.startsWith(whole) && /^[.[]/.test(part.slice(whole.length));
  return fieldKey === key || inside(key, fieldKey) || inside(fieldKey, key);
}

/** Attributes of an input for numbers. A phone keyboard for decimals has no minus, so signed numbers get the one for text. */
function numeric(signed, value) {
  return { type: "text", inputmode: signed ? "text" : "decimal", autocomplete: "off", spellcheck: "false", value };
}

/** A set of fields; `onChange` is called with the field that was edited. */
export function createForm(onChange) {
  const fields = new Set();
  let offered = []; // files of another run, for fields that name one

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
      // The unit belongs to the name that is read out, although it is shown next to the input.
      element("label", { for: id }, name, unit ? element("span", { class: "visually-hidden" }, `, ${unit}`) : null,
        element("span", { class: "optional", hidden: !optional }, " optional")),
      element("div", { class: "control" }, input, unitNode), message, note);
    return { keys, input, node, message, note, unitNode, name, touched: false, wrong: false };
  }

  const empty = (field) => field.input.value.trim() === "";

  return {
    /** A number with its unit; an empty one is omitted. */
    number(key, options) {
      const input = element("input", numeric(options.signed, options.value ?? ""));
      return add({ ...wrap([key].flat(), input, { id: uniqueId("field"), ...options }), numeric: true, needed: !options.optional });
    },
    /** Several numbers in groups, as `numbersIn` reads them. */
    numbers(key, options) {
      const input = element("input", { type: "text", autocomplete: "off", spellcheck: "false" });
      return add({ ...wrap([key].flat(), input, { id: uniqueId("field"), optional: true, ...options }), numeric: true, several: true });
    },
    /** A file that the input names: {name, file, text} in `given`. */
    file(key, options) {
      const input = element("input", { type: "file" });
      const field = add(wrap([key].flat(), input, { id: uniqueId("field"), ...options }));
      field.pick = (name) => {
        field.given = offered.find((one) => one.name === name);
        tell(field, field.given ? field.given.name : options.hint);
      };
      input.addEventListener("change", async () => {
        const [file] = input.files;
        input.value = ""; // the same file may be chosen again after a correction
        if (!file) return;
        offered = [...offered.filter((one) => one.name !== file.name), { name: file.name, file, text: await file.text() }];
        field.pick(file.name);
        onChange(field);
      });
      return field;
    },
    offer(files) {
      offered = files;
    },
    files: (isText) => (isText ? offered : [...fields].filter((field) => field.given && inUse(field)).map((field) => field.given)),
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
      return add({ ...wrap([key].flat(), input, { id: uniqueId("field"), ...options }), needed: options.needed });
    },
    /** An input of a table, with its problem below the table. */
    cell(key, name, value, message) {
      const input = element("input", { ...numeric(true, value), "aria-label": name, "data-key": key });
      const node = element("td", { class: "cell" }, input);
      return add({ keys: [key], input, node, message, name: { textContent: name }, numeric: true, needed: true, touched: false, wrong: false });
    },
    /** Forgets fields that left the page. */
    drop(list) {
      list.forEach((field) => fields.delete(field));
    },
    /** Names of the required fields that are empty. */
    missing() {
      return [...fields].filter((field) => field.needed && inUse(field) && empty(field)).map((field) => field.name.textContent);
    },
    /** Whether every visible number is one; marks those that are not. */
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
    /** Shows a problem of the service at its field; true when there is such a field. */
    showProblem(input) {
      const key = input?.key ?? "";
      const found = key && [...fields].find((field) => inUse(field) && field.keys.some((own) => belongs(own, key)));
      if (!found) return false;
      const remedy = input.remedy ? `: ${input.remedy}` : "";
      found.node.closest("details")?.setAttribute("open", "");
      say(found, `${input.problem ?? "is wrong"}${remedy}`);
      return true;
    },
  };
}

/** Fields in hidden groups take no part; the whole view may be hidden while it is filled. */
function inUse(field) {
  return field.node.isConnected && !field.node.closest("[hidden]:not(.view)");
}

/** Whether a field has to be filled in. */
export function need(field, is) {
  field.needed = is;
  const optional = field.node.querySelector?.(".optional");
  if (optional) optional.hidden = is;
}

/** The line below a field. */
export function tell(field, text = "") {
  field.note.textContent = text;
  field.note.hidden = text === "";
}

/** The line below a field until its value changes. */
export function tellUntilEdited(field, text) {
  field.hint ??= field.note.textContent;
  tell(field, text);
  field.input.addEventListener("input", () => untell(field), { once: true });
}

/** The line that a field has of its own. */
export function untell(field) {
  if (field.hint !== undefined) tell(field, field.hint);
}

/** Number in a field, undefined where it is empty or none. */
export function numberIn(field) {
  const value = parseNumber(field.input.value);
  return Number.isNaN(value) ? undefined : value;
}

/** Groups between semicolons, of what is between blanks. */
function groupsIn(field) {
  return field.input.value.split(";").map((group) => group.trim().split(/,?\s+/));
}

/** Numbers in a field of several: a list, or a list of lists where semicolons divide them; undefined where it is empty. */
export function numbersIn(field) {
  if (field.input.value.trim() === "") return undefined;
  const groups = groupsIn(field).map((group) => group.map(parseNumber));
  return groups.length > 1 ? groups : groups[0];
}

/** Sets a field without an event. */
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
