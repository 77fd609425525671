// The few helpers that build elements. Text always goes in as text, so nothing a user or a file says can become markup.

import { apart, unitShown } from "./units.js";

const SVG = "http://www.w3.org/2000/svg";

function fill(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes ?? {})) {
    if (value === null || value === undefined || value === false) continue;
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else if (name === "value") node.value = value;
    else node.setAttribute(name, value === true ? "" : value);
  }
  node.append(...children.flat(2).filter((child) => child !== null && child !== undefined && child !== false));
  return node;
}

/** An HTML element. */
export function element(tag, attributes, ...children) {
  return fill(document.createElement(tag), attributes, children);
}

/** An SVG element. */
export function shape(tag, attributes, ...children) {
  return fill(document.createElementNS(SVG, tag), attributes, children);
}

/** A button; `attributes` may say more, or another class. */
export function button(title, onclick, attributes) {
  return element("button", { type: "button", class: "button", ...attributes, onclick }, title);
}

/** A section with its heading. */
export function section(id, title, ...content) {
  return element("section", { "aria-labelledby": `${id}-title`, "data-part": id }, element("h2", { id: `${id}-title` }, title), ...content);
}

export function byId(id) {
  return document.getElementById(id);
}

/** Replaces the children of `parent`, dropping what is null or false. */
export function show(parent, ...children) {
  parent.replaceChildren(...children.flat(2).filter((child) => child !== null && child !== undefined && child !== false));
}

/** Replaces a whole page; the focus stays at its heading where it had been in the page. */
export function showPage(root, ...children) {
  const had = root.contains(document.activeElement);
  show(root, ...children);
  if (had) root.querySelector("h1").focus({ preventScroll: true });
}

/** Gives files that are dropped on a node to `add`. */
export function takeDrops(node, add) {
  for (const name of ["dragenter", "dragover", "dragleave", "drop"]) {
    node.addEventListener(name, (event) => {
      event.preventDefault();
      node.classList.toggle("over", name === "dragenter" || name === "dragover");
      if (name === "drop") add(event.dataTransfer.files);
    });
  }
}

let lastNumber = 0;

/** A unique id, for labels and descriptions. */
export function uniqueId(stem) {
  lastNumber += 1;
  return `${stem}-${lastNumber}`;
}

/** Calls `action` once things have been quiet for `wait` milliseconds. */
export function debounce(action, wait) {
  let timer = 0;
  return (...values) => {
    clearTimeout(timer);
    timer = setTimeout(() => action(...values), wait);
  };
}

/** A table that scrolls inside itself. `columns`: {title, unit?, numeric?}; `rows`: arrays of text or nodes. */
export function table(caption, columns, rows, { hidden = false, rowHeader = true, name } = {}) {
  // A column of numbers changes its unit; one of other elements keeps it.
  const changes = (index) => rows.every((row) => typeof row[index] === "string");
  const heads = columns.map(({ title, unit, numeric }, index) =>
    element("th", { scope: "col", class: numeric ? "number" : null }, title,
      unit && element("span", { class: "unit", "data-metric": true }, ` ${changes(index) ? unitShown(unit) : unit}`)));
  const body = rows.map((row) => element("tr", null, row.map((cell, index) => {
    const attributes = { class: columns[index].numeric ? "number" : null };
    const words = changes(index) ? apart(cell, columns[index].unit) : cell;
    return rowHeader && index === 0 ? element("th", { scope: "row", ...attributes }, words) : element("td", attributes, words);
  })));
  // A region that scrolls must be reachable by keyboard.
  return element("div", { class: "table-scroll", tabindex: "0", role: "region", "aria-label": caption, "data-table": name },
    element("table", null,
      element("caption", { class: hidden ? "visually-hidden" : null }, caption),
      element("thead", null, element("tr", null, heads)),
      element("tbody", null, body)));
}

/** A list of terms and values. */
export function terms(pairs, name) {
  return element("dl", { class: "terms", "data-terms": name },
    pairs.map(([term, value]) => element("div", null, element("dt", null, term), element("dd", null, value))));
}

/** Numbered columns of a CSV text of ours: no quotes in it, one header line. Gives columns by name, numbers where they are. */
export function readCsv(text) {
  const lines = text.split(/\r?\n/).filter((line) => line !== "");
  const names = (lines.shift() ?? "").split(",");
  const columns = Object.fromEntries(names.map((name) => [name, []]));
  for (const line of lines) {
    const cells = line.split(",");
    names.forEach((name, index) => {
      const number = cells[index] === "" ? NaN : Number(cells[index]);
      columns[name].push(Number.isNaN(number) && cells[index] !== "NaN" ? cells[index] : number);
    });
  }
  return columns;
}
