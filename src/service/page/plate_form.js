// Holes, cracks, notches, pins and rollers of a custom plate as tables, with a sketch above them. The numbers are in the cells alone.

import { element } from "./dom.js";
import { createRows } from "./key_fields.js";
import { keyOf, keysOf } from "./keys.js";
import { createSketch } from "./sketch.js";

/** Lists that the tables show. */
export const LISTS = ["cracks", "holes", "notches"];

/** `size()` gives the other values of the plate, `whole()` all its keys for the input; `onChange` is called when something else than typing changed a number. */
export function createPlateForm(form, { size, whole, onChange }) {
  const changed = () => {
    sketch.draw();
    onChange();
  };
  const ofPlate = (metric) => keysOf("specimen", "plate").find((key) => key.metric === metric);
  const rows = Object.fromEntries(LISTS.map((what) => [what, createRows(form, `specimen.${what}`, withoutPaths(ofPlate(what)), { first: ["from_mm", "to_mm"], onChange: changed })]));
  // The input file counts holes from 0, the table from 1.
  const pins = createRows(form, "loading.pins", keyOf("loading", "pins"), { shift: { hole: 1 }, onChange });
  const rollers = createRows(form, "loading.rollers", keyOf("loading", "rollers"), { onChange });
  const canvas = element("div", { class: "sketch" });

  const edits = {
    addCrack: (from, to) => rows.cracks.put([...rows.cracks.values(), { from_mm: from, to_mm: to }]),
    addHole: ([x, y]) => rows.holes.put([...rows.holes.values(), { x_mm: x, y_mm: y, diameter_mm: Number(((size().width_mm || 100) / 10).toPrecision(1)) }]),
    moveCrack: (index, end, point) => rows.cracks.move(index, end, point),
    moveHole(index, [x, y]) {
      rows.holes.move(index, "x_mm", x);
      rows.holes.move(index, "y_mm", y);
    },
    remove: (what, index) => rows[what].put(rows[what].values().filter((_, other) => other !== index)),
  };

  const point = (pair) => pair ?? [NaN, NaN];
  const straight = (list) => list.map((one) => ({ ...one, from_mm: point(one.from_mm), to_mm: point(one.to_mm) }));
  const drawn = () => ({ ...size(), holes: rows.holes.values(), cracks: straight(rows.cracks.values()), notches: straight(rows.notches.values()) });
  const sketch = createSketch(canvas, { plate: drawn, collect: () => ({ ...whole(), files: files() }), edits });
  const folded = element("details", null, element("summary", null, "Notches, pins, rollers"), rows.notches.element, pins.element, rollers.element);
  const node = element("div", { class: "plate-form" }, canvas,
    element("p", { class: "hint" }, "Origin at the plate center; x across, y along the load. A crack may start outside the material; the part outside is trimmed."),
    rows.cracks.element, rows.holes.element, folded);
  node.addEventListener("input", () => sketch.draw());
  const files = () => (form.files().length > 0 ? form.files() : undefined);
  const orNone = (list) => (list.length > 0 ? list : undefined);

  return {
    element: node,
    draw: () => sketch.draw(),
    /** Lists of `[specimen]`; without cracks an empty one. */
    collect: () => ({ holes: orNone(rows.holes.collect()), notches: orNone(rows.notches.collect()), cracks: rows.cracks.collect() }),
    /** Lists of `[loading]`. */
    loads: () => ({ pins: orNone(pins.collect()), rollers: orNone(rollers.collect()) }),
    fill(specimen, loading = {}) {
      const all = [rows.holes.fill(specimen.holes), rows.notches.fill(specimen.notches), rows.cracks.fill(straightCracks(specimen.cracks ?? [])), pins.fill(loading.pins), rollers.fill(loading.rollers)];
      folded.open = [rows.notches, pins, rollers].some((one) => one.values().length > 0);
      sketch.draw();
      return all.every(Boolean);
    },
  };
}

/** Cracks with bends as straight ones that share their corners, which are joined. */
function straightCracks(cracks) {
  return cracks.flatMap((crack) => crack.path_mm?.slice(1).map((to_mm, index) => ({ from_mm: crack.path_mm[index], to_mm })) ?? [crack]);
}

/** The keys of cracks without bends. */
const withoutPaths = (key) => ({ ...key, keys: key.keys.filter(({ metric }) => metric !== "path_mm") });
