// The sides of a custom plate: which are loaded, and along which axes each is supported. Sides and axes are those of the keys.

import { element, show } from "./dom.js";
import { compact, fillIn, numberIn } from "./form.js";
import { sentence } from "./format.js";
import { choicesOf, hasOnly, keyOf, keysOf, toShown } from "./keys.js";

/** Gives {element, edges(), supports(), fill(loading, supports)}. */
export function createSides(form, onChange) {
  const message = element("p", { class: "field-problem", hidden: true });
  const components = choicesOf("supports.fix").map(({ value }) => value);
  const rows = keysOf("supports").map(row); // {name, loaded, fixed: {x, y}, depth}

  function box(label, key) {
    const input = element("input", { type: "checkbox", "aria-label": label, "data-key": key, onchange: onChange });
    return [input, element("td", null, element("label", { class: "tick-reach" }, input))];
  }

  function row({ metric: name, keys }) {
    const own = keys.find(({ metric }) => metric === "rows_mm");
    const [loaded, loadedCell] = box(`${sentence(name)}: loaded`, "loading.edges");
    const boxes = components.map((one) => [one, ...box(`${sentence(name)}: support along ${one}`, `supports.${name}.fix`)]);
    const depth = form.cell(`supports.${name}.${own.name}`, `${sentence(name)}: ${own.label}, ${own.unit}`, "", message);
    depth.needed = false;
    return { name, own, loaded, fixed: Object.fromEntries(boxes.map(([one, input]) => [one, input])), depth,
      node: element("tr", null, element("th", { scope: "row" }, sentence(name)), loadedCell, boxes.map(([, , cell]) => cell), depth.node) };
  }

  const { label, unit } = rows[0].own;
  const heads = ["Side", keyOf("loading", "edges").label, ...components.map((one) => `Support along ${one}`), `${label}, ${unit}`];
  const fixOf = ({ fixed }) => components.filter((one) => fixed[one].checked);
  const body = element("tbody");
  show(body, rows.map(({ node }) => node));

  return {
    element: element("details", { "data-rows": "sides" }, element("summary", null, "Loaded and supported sides"),
      element("p", { class: "hint" }, "Default: tension on top and bottom. A supported side carries no load."),
      element("div", { class: "table-scroll" }, element("table", null, element("caption", { class: "visually-hidden" }, "Sides of the plate"),
        element("thead", null, element("tr", null, heads.map((title) => element("th", { scope: "col" }, title)))), body)), message),
    edges() {
      const loaded = rows.filter((one) => one.loaded.checked).map((one) => one.name);
      return loaded.length > 0 ? loaded : undefined;
    },
    supports() {
      const given = rows.filter((one) => fixOf(one).length > 0).map((one) => [one.name, compact({ [one.own.name]: numberIn(one.depth), fix: fixOf(one) })]);
      return given.length > 0 ? Object.fromEntries(given) : undefined;
    },
    /** False when they say what no field shows. */
    fill({ edges = [] }, supports = {}) {
      for (const one of rows) {
        one.loaded.checked = edges.includes(one.name);
        for (const axis of components) one.fixed[axis].checked = supports[one.name]?.fix?.includes(axis) ?? false;
        fillIn(one.depth, toShown(one.own, supports[one.name]?.rows_mm));
      }
      this.element.open = edges.length > 0 || Object.keys(supports).length > 0;
      const names = rows.map(({ name }) => name);
      return edges.every((one) => names.includes(one)) && hasOnly(supports, names);
    },
  };
}
