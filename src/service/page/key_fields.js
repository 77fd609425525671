// Fields made from keys: what a section of the input file takes, as fields of a form and back.

import { button, element, show } from "./dom.js";
import { compact, fillIn, grid, group, need, numberIn, numbersIn, tell, untell } from "./form.js";
import { hasOnly, toShown } from "./keys.js";

const text = ({ input }) => input.value.trim() || undefined;
/** Significant digits of a proposed value that is converted. */
const DIGITS = 5;
/** How a value is read, by the shape of its key. */
const READ = {
  number: numberIn, whole: numberIn, numbers: numbersIn, file: (field) => field.given?.name,
  flag: ({ input }) => ({ true: true, false: false })[input.value],
  names: (field) => text(field)?.split(/[\s,;]+/),
  other(field) {
    const numbers = numbersIn(field);
    return [numbers].flat(2).some(Number.isNaN) ? text(field) : numbers?.length === 1 ? numbers[0] : numbers;
  },
};

/** A field of a key of the section at `path`; `more` are further options of the field. */
export function fieldOf(form, path, key, more) {
  const names = [...new Set([key.name, key.metric].map((name) => `${path}.${name}`))];
  if (key.shape === "table" || key.shape === "rows") {
    const inner = key.shape === "table" ? createFields(form, names[0], key.keys) : createRows(form, names[0], key);
    const node = key.shape === "table" ? group(key.label, grid(...inner.nodes)) : inner.element;
    const read = () => {
      const value = inner.collect();
      return Object.keys(value).length > 0 ? value : undefined;
    };
    // What a table needs is needed once something of it is given.
    const require = (is = read() !== undefined) => Object.values(inner.by ?? {}).forEach((field) => need(field, field.key.needed && is));
    node.addEventListener("input", () => require(), { capture: true });
    require(false);
    return { key, node, require, read, drop: inner.drop, write(value) {
      const isWhole = inner.fill(value);
      require();
      return isWhole;
    } };
  }
  const make = { number: form.number, whole: form.number, numbers: form.numbers, choice: form.choice, flag: form.choice, file: form.file }[key.shape] ?? form.text;
  const field = make(names, { label: key.label, unit: key.unit, hint: key.hint, signed: key.signed, optional: !key.needed, needed: key.needed, options: key.choices, ...more });
  const meaning = () => key.choices && tell(field, key.choices.find(({ value }) => value === field.input.value)?.meaning ?? key.hint);
  field.input.addEventListener("input", meaning);
  const write = (value, table, digits) => {
    if (field.pick) field.pick(value);
    else fillIn(field, toShown(key, value, table, digits));
    untell(field);
    meaning();
  };
  // What is proposed is converted to a number that people write: not above the value with `away` −1, not below it with 1.
  const propose = (value, away = 0) => {
    write(value, {}, DIGITS);
    const shown = numberIn(field);
    if ((shown * key.factor - value) * away >= 0) return;
    fillIn(field, Number((shown + away * 10 ** (Math.floor(Math.log10(Math.abs(shown))) + 1 - DIGITS)).toPrecision(DIGITS)));
  };
  return Object.assign(field, { key, write, propose, read: () => (READ[key.shape] ?? text)(field), drop: () => form.drop([field]) });
}

/** Fields of keys, by the metric names of these in `by`. */
export function createFields(form, path, keys) {
  const fields = keys.map((key) => fieldOf(form, path, key));
  const by = Object.fromEntries(fields.map((field) => [field.key.metric, field]));
  const inUse = () => fields.filter((field) => !field.node.hidden);
  const isOther = ({ key: own, values }) => by[own]?.read() !== undefined && !values.includes(by[own].read());
  return {
    by, nodes: fields.map(({ node }) => node), drop: () => fields.forEach((field) => field.drop()),
    /** Hides what does not go with other values, or with `is`. */
    arrange(is = () => true) {
      for (const { key, node } of fields) node.hidden = !is(key) || Boolean(key.only && isOther(key.only));
    },
    /** A group: what is `first`, all else folded. */
    group(title, first, ...others) {
      const [shown, folded] = [true, false].map((is) => fields.filter(({ key }) => first.includes(key.metric) === is).map(({ node }) => node));
      const more = folded.length > 0 && element("details", { class: "more" }, element("summary", null, first.length > 0 ? "More options" : title), grid(...folded));
      return first.length > 0 ? group(title, grid(...shown), ...others, more) : element("fieldset", { "aria-label": title }, more);
    },
    collect: () => compact(Object.fromEntries(inUse().map((field) => [field.key.name, field.read()]))),
    /** Takes metric values over; false when there are others than the fields show. */
    fill(table = {}) {
      const all = fields.map((field) => field.write(table[field.key.metric], table));
      return hasOnly(table, Object.keys(by)) && all.every((is) => is !== false);
    },
  };
}

/** A list of tables as rows of cells, their values under metric names: `first` columns are shown from the beginning, keys of `shift` count from there. */
export function createRows(form, path, key, { first = [], shift = {}, onChange = () => {} } = {}) {
  const one = key.label.replace(/(?<=ch)es$|s$/, "");
  const [head, body, message] = [element("tr"), element("tbody"), element("p", { class: "field-problem", hidden: true })];
  const isFirst = ({ metric, needed }) => needed || first.includes(metric);
  let rows = []; // of cells {own, part, field}
  let isWide = false;

  function draw(list) {
    form.drop(rows.flat().map(({ field }) => field));
    const shown = key.keys.filter((own) => isWide || isFirst(own) || list.some((row) => row[own.metric] !== undefined));
    const columns = shown.flatMap((own) => (own.size ? ["x", "y"].map((axis, part) => ({ own, part, title: `${own.label} ${axis}` })) : [{ own, title: own.label }]));
    const cell = (row, index, { own, part, title }) => {
      const value = part === undefined ? row[own.metric] : row[own.metric]?.[part];
      const name = [`${one} ${index + 1}`, title, own.unit].filter(Boolean).join(", ");
      const field = form.cell(`${path}[${index}].${own.name}${part === undefined ? "" : `[${part}]`}`, name, value === undefined ? "" : String(own.metric in shift ? value + shift[own.metric] : value), message);
      return { own, part, field: Object.assign(field, { needed: isFirst(own), numeric: own.shape !== "text" && own.shape !== "choice" }) };
    };
    rows = list.map((row, index) => columns.map((column) => cell(row, index, column)));
    const title = ({ own, title: name }) => element("th", { scope: "col" }, name, own.unit && element("span", { class: "unit" }, ` ${own.unit}`));
    show(head, element("th", { scope: "col" }, "No."), columns.map(title), element("th", { scope: "col" }, element("span", { class: "visually-hidden" }, "Remove")));
    const remove = (index) => button("Remove", () => put(values().filter((_, other) => other !== index)), { class: "button small", "aria-label": `Remove ${one.toLowerCase()} ${index + 1}` });
    show(body, rows.length === 0 ? element("tr", null, element("td", { class: "quiet", colspan: columns.length + 2 }, "none"))
      : rows.map((cells, index) => element("tr", null, element("th", { scope: "row" }, String(index + 1)), cells.map(({ field }) => field.node), element("td", { class: "cell-button" }, remove(index)))));
    more.hidden = isWide || shown.length === key.keys.length;
  }

  function values() {
    return rows.map((cells) => {
      const row = {};
      for (const { own, part, field } of cells) {
        const value = field.numeric ? numberIn(field) : text(field);
        if (part !== undefined && value !== undefined) (row[own.metric] ??= [])[part] = value;
        else if (value !== undefined) row[own.metric] = own.metric in shift ? value - shift[own.metric] : value;
      }
      return row;
    });
  }

  function put(list) {
    draw(list);
    onChange();
  }

  const add = button(`Add a ${one.toLowerCase()}`, () => {
    put([...values(), {}]);
    rows.at(-1)[0].field.input.focus();
  }, { class: "button small" });
  const more = button("More columns", () => {
    isWide = true;
    draw(values());
  }, { class: "button small" });
  draw([]);

  return {
    element: element("div", { class: "row-table", "data-rows": path.split(".").pop() },
      element("div", { class: "table-scroll" }, element("table", null, element("caption", null, key.label), element("thead", null, head), body)),
      message, element("p", { class: "tool-row" }, add, more)),
    values, put, drop: () => form.drop(rows.flat().map(({ field }) => field)),
    /** Sets a number of a row, or a pair of them. */
    move(index, metric, value) {
      rows[index].filter(({ own }) => own.metric === metric).forEach(({ part, field }) => fillIn(field, part === undefined ? value : value[part]));
      onChange();
    },
    /** Rows for the input file. */
    collect: () => values().map((row) => Object.fromEntries(key.keys.filter(({ metric }) => metric in row).map(({ metric, name }) => [name, row[metric]]))),
    fill(list = []) {
      const names = key.keys.map(({ metric }) => metric);
      draw(list.map((row) => Object.fromEntries(key.keys.filter(({ metric }) => metric in row).map((own) => [own.metric, toShown(own, row[own.metric], row)]))));
      return list.every((row) => hasOnly(row, names));
    },
  };
}
