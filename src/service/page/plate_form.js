// Tables of holes and cracks of a drawn plate, with the sketch above them. The cells are the one place where the numbers are.

import { button, element, show } from "./dom.js";
import { fillIn, numberIn } from "./form.js";
import { straightCracks } from "./plate_drawing.js";
import { createSketch } from "./sketch.js";

const LISTS = {
  holes: {
    title: "Holes", one: "Hole", add: "Add a hole", at: "specimen.holes", unit: "mm",
    columns: [["x_mm", "x"], ["y_mm", "y"], ["diameter_mm", "Diameter"]],
  },
  cracks: {
    title: "Cracks", one: "Crack", add: "Add a crack", at: "specimen.cracks", unit: "mm",
    columns: [["from_mm[0]", "x₁"], ["from_mm[1]", "y₁"], ["to_mm[0]", "x₂"], ["to_mm[1]", "y₂"]],
  },
  pins: {
    title: "Pins that pull in holes, loaded by a force", one: "Pin", add: "Add a pin", at: "loading.pins", unit: "",
    columns: [["hole", "Hole No."], ["direction[0]", "Way x"], ["direction[1]", "Way y"]],
  },
};
const SPOKEN = { "x₁": "start x", "y₁": "start y", "x₂": "end x", "y₂": "end y" };

/** `size()` gives width_mm and length_mm of the plate; `onChange` is told when something else than typing changed a number. */
export function createPlate(form, { size, onChange }) {
  const each = (make) => Object.fromEntries(Object.keys(LISTS).map((what) => [what, make(what)]));
  const rows = each(() => []);
  const bodies = each(() => element("tbody"));
  const messages = each(() => element("p", { class: "field-problem", hidden: true }));
  const canvas = element("div", { class: "sketch" });

  function addRow(what, values) {
    const number = rows[what].length;
    const cells = LISTS[what].columns.map(([key, title], index) => {
      const name = [`${LISTS[what].one} ${number + 1}`, SPOKEN[title] ?? title, LISTS[what].unit].filter(Boolean).join(", ");
      return form.cell(`${LISTS[what].at}[${number}].${key}`, name, values[index] === undefined ? "" : String(values[index]), messages[what]);
    });
    rows[what].push(cells);
  }

  function render(what) {
    show(bodies[what], rows[what].map((cells, index) => element("tr", null,
      element("th", { scope: "row" }, String(index + 1)), cells.map((cell) => cell.node),
      element("td", { class: "cell-button" }, button("Remove", () => edits.remove(what, index), {
        class: "button small", "aria-label": `Remove ${LISTS[what].one.toLowerCase()} ${index + 1}`,
      })))));
    if (rows[what].length === 0) {
      show(bodies[what], element("tr", null, element("td", { class: "quiet", colspan: LISTS[what].columns.length + 2 }, "none")));
    }
  }

  const values = (what) => rows[what].map((cells) => cells.map(numberIn));

  /** New rows, since their numbers are part of their keys. */
  function rebuild(what, lists) {
    form.drop(rows[what].flat());
    rows[what] = [];
    lists.forEach((list) => addRow(what, list));
    render(what);
  }

  function changed() {
    sketch.draw();
    onChange();
  }

  const edits = {
    addCrack(from, to) {
      rebuild("cracks", [...values("cracks"), [...from, ...to]]);
      changed();
    },
    addHole([x, y]) {
      const { width_mm: width } = size();
      rebuild("holes", [...values("holes"), [x, y, Number(((width || 100) / 10).toPrecision(1))]]);
      changed();
    },
    moveCrack(index, end, [x, y]) {
      const first = end === "from_mm" ? 0 : 2;
      fillIn(rows.cracks[index][first], x);
      fillIn(rows.cracks[index][first + 1], y);
      changed();
    },
    moveHole(index, [x, y]) {
      fillIn(rows.holes[index][0], x);
      fillIn(rows.holes[index][1], y);
      changed();
    },
    remove(what, index) {
      rebuild(what, values(what).filter((_, other) => other !== index));
      changed();
    },
  };

  function collect() {
    const holes = values("holes").map(([x_mm, y_mm, diameter_mm]) => ({ x_mm, y_mm, diameter_mm }));
    const cracks = values("cracks").map(([x1, y1, x2, y2]) => ({ from_mm: [x1, y1], to_mm: [x2, y2] }));
    return { holes, cracks };
  }

  function listOf(what) {
    const { title, add, columns, unit } = LISTS[what];
    const head = columns.map(([, name]) => element("th", { scope: "col" }, name, element("span", { class: "unit" }, ` ${unit}`)));
    const last = element("th", { scope: "col" }, element("span", { class: "visually-hidden" }, "Remove"));
    return element("div", { class: "row-table", "data-rows": what },
      element("div", { class: "table-scroll" },
        element("table", null, element("caption", null, title),
          element("thead", null, element("tr", null, element("th", { scope: "col" }, "No."), head, last)),
          bodies[what])),
      messages[what],
      button(add, () => {
        rebuild(what, [...values(what), []]);
        changed();
        rows[what].at(-1)[0].input.focus();
      }, { class: "button small" }));
  }

  const sketch = createSketch(canvas, { plate: () => ({ ...size(), ...collect() }), edits });
  const node = element("div", { class: "plate-form" }, canvas,
    element("p", { class: "hint" }, "The origin is the middle of the plate; x runs across, y along the load. ",
      "A crack may start at an edge or in a hole: what lies outside the material is cut off."),
    listOf("cracks"), listOf("holes"), listOf("pins"));
  node.addEventListener("input", () => sketch.draw());
  Object.keys(LISTS).forEach(render);

  return {
    element: node,
    draw: () => sketch.draw(),
    /** Lists for the input file; without holes none are named. */
    collect() {
      const { holes, cracks } = collect();
      const known = (one) => JSON.parse(JSON.stringify(one, (_, value) => (value === undefined ? undefined : value)));
      return { holes: holes.length > 0 ? holes.map(known) : undefined, cracks: cracks.map(known) };
    },
    /** Pins for `loading`; the file counts holes from 0, the table from 1. */
    pins() {
      const pins = values("pins").map(([hole, x, y]) => ({ hole: hole - 1, direction: [x, y] }));
      return pins.length > 0 ? pins : undefined;
    },
    fill({ holes = [], cracks = [] }, { pins = [] } = {}) {
      rebuild("pins", pins.map(({ hole, direction: [x, y] }) => [hole + 1, x, y]));
      rebuild("holes", holes.map((hole) => [hole.x_mm, hole.y_mm, hole.diameter_mm]));
      rebuild("cracks", straightCracks(cracks).map((crack) => [...crack.from_mm, ...crack.to_mm]));
      sketch.draw();
    },
  };
}
