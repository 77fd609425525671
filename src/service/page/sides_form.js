// The sides of a drawn plate: which are loaded, and along what each is held. Sides and directions are those that the service lists.

import { element, show } from "./dom.js";
import { compact, fillIn, numberIn } from "./form.js";
import { sentence } from "./format.js";

/** Gives {element, setKinds(kinds), edges(), supports(), fill(loading, supports)}. */
export function createSides(form, onChange) {
  const body = element("tbody");
  const head = element("tr");
  const message = element("p", { class: "field-problem", hidden: true });
  let components = [];
  let rows = []; // {name, loaded, held: {x, y}, depth}

  function box(label, key) {
    const input = element("input", { type: "checkbox", "aria-label": label, "data-key": key, onchange: onChange });
    return [input, element("td", null, element("label", { class: "tick-reach" }, input))];
  }

  function setKinds(kinds) {
    if (rows.length > 0) return;
    const names = (key) => kinds.filter((one) => one.key === key).map((one) => one.name);
    components = names("supports.fix");
    show(head, ["Side", "Loaded", ...components.map((one) => `Held along ${one}`), "Held to a depth of, mm"].map((title) => element("th", { scope: "col" }, title)));
    rows = names("loading.edges").map((name) => {
      const [loaded, loadedCell] = box(`${sentence(name)} is loaded`, "loading.edges");
      const boxes = components.map((one) => [one, ...box(`${sentence(name)} is held along ${one}`, `supports.${name}.fix`)]);
      const depth = form.cell(`supports.${name}.rows_mm`, `Depth to which ${name} is held, mm`, "", message);
      depth.needed = false;
      return { name, loaded, held: Object.fromEntries(boxes.map(([one, input]) => [one, input])), depth,
        node: element("tr", null, element("th", { scope: "row" }, sentence(name)), loadedCell, boxes.map(([, , cell]) => cell), depth.node) };
    });
    show(body, rows.map((row) => row.node));
  }

  const fixOf = ({ held }) => components.filter((one) => held[one].checked);

  return {
    element: element("details", { "data-rows": "sides" }, element("summary", null, "Sides: loaded, held"),
      element("p", { class: "hint" }, "Nothing ticked: top and bottom pull, each with the same load. A side that is held is not loaded."),
      element("div", { class: "table-scroll" }, element("table", null, element("caption", { class: "visually-hidden" }, "Sides of the plate"), element("thead", null, head), body)), message),
    setKinds,
    edges() {
      const loaded = rows.filter((row) => row.loaded.checked).map((row) => row.name);
      return loaded.length > 0 ? loaded : undefined;
    },
    supports() {
      const held = rows.filter((row) => fixOf(row).length > 0).map((row) => [row.name, compact({ rows_mm: numberIn(row.depth), fix: fixOf(row) })]);
      return held.length > 0 ? Object.fromEntries(held) : undefined;
    },
    /** False when they say what no field shows. */
    fill({ edges = [] }, supports = {}) {
      const names = rows.map((row) => row.name);
      if ([...edges, ...Object.keys(supports)].some((name) => !names.includes(name))) return false;
      for (const row of rows) {
        row.loaded.checked = edges.includes(row.name);
        components.forEach((one) => {
          row.held[one].checked = supports[row.name]?.fix?.includes(one) ?? false;
        });
        fillIn(row.depth, supports[row.name]?.rows_mm);
      }
      this.element.open = edges.length > 0 || Object.keys(supports).length > 0;
      return true;
    },
  };
}
