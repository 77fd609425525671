// Readings that are left out, each with its reason: `leave_out` of [measured]. The growth up to a reading and from it on does not count.

import { button, element, show, table } from "./dom.js";
import { cycles, fixed } from "./format.js";
import { editInPlace } from "./job.js";

/** Where a reading that is left out stands. */
export const placeOf = (one) => (one.line ? `${one.file ?? "Row"}, line ${one.line} (${one.value})` : `${one.specimen ?? "All"}, ${cycles(one.from_cycles)} to ${cycles(one.to_cycles)} cycles`);

/** `onChange` is told when another reading is left out. */
export function createLeftOut(onChange) {
  let windows = []; // as in the calibration file: cycles of a specimen, or a row of a file by its line

  /** Cycles from the reading before to the one behind. */
  function windowOf({ specimen, cycles: steps }, index, reason) {
    return { specimen, from_cycles: steps[Math.max(0, index - 1)], to_cycles: steps[Math.min(steps.length - 1, index + 1)], reason };
  }

  const isOut = (curve, index) => {
    const own = windowOf(curve, index);
    return windows.some((one) => (one.specimen ?? curve.specimen) === curve.specimen && one.from_cycles <= own.from_cycles && one.to_cycles >= own.to_cycles);
  };

  function change(next) {
    windows = next;
    onChange();
  }

  function rowOf(curve, index) {
    const place = element("span", null, isOut(curve, index) ? "left out" : button("Leave out", () => editInPlace(place, {
      label: `Why the reading of line ${curve.lines[index]} does not count`, value: "", save: (reason) => change([...windows, windowOf(curve, index, reason)]),
    }), { class: "button small", "data-action": "leave-out", "aria-label": `Leave out the reading of line ${curve.lines[index]}` }));
    return [String(curve.lines[index]), cycles(curve.cycles[index]), fixed(curve.crack_length_mm[index], 3), place];
  }

  return {
    /** All readings of one specimen of a file, shown when they are asked for. */
    readings({ file, curves }) {
      const place = element("div");
      const choice = curves.length > 1 && element("select", { "aria-label": `Specimen of ${file}` }, curves.map((curve, index) => element("option", { value: index }, curve.specimen)));
      const draw = () => {
        const curve = curves[choice ? Number(choice.value) : 0];
        show(place, choice, table(`Readings of ${curve.specimen}`, [{ title: "Line" }, { title: "Cycles", numeric: true }, { title: "a", unit: "mm", numeric: true }, { title: "Why not" }],
          curve.cycles.map((_, index) => rowOf(curve, index)), { hidden: true, name: "readings" }));
      };
      if (choice) choice.addEventListener("change", draw);
      const more = element("details", { ontoggle: () => more.open && draw() }, element("summary", null, "Readings: leave one out"), place);
      return more;
    },
    /** What is left out, with its reasons; nothing where all counts. */
    list: () => windows.length > 0 && element("div", { class: "notice", "data-part": "left-out" }, element("h3", null, "Left out"),
      element("ul", null, windows.map((one) => element("li", null, `${placeOf(one)}: ${one.reason} `,
        button("Take back", () => change(windows.filter((other) => other !== one)), { class: "button small" }))))),
    /** Marks of what is left out, for the chart of all curves. */
    marks(curves) {
      const out = curves.flatMap((curve) => curve.cycles.map((step, index) => [step, curve.crack_length_mm[index], isOut(curve, index)])).filter((point) => point[2]);
      return out.length > 0 ? [{ id: "left-out", name: "left out", kind: "crosses", x: out.map((point) => point[0]), y: out.map((point) => point[1]) }] : [];
    },
    windows: () => (windows.length > 0 ? windows : undefined),
    /** Rows by their lines, without the others. */
    rows: () => windows.filter((one) => one.line),
    addRow: (row) => change([...windows, row]),
    /** A file that is gone or another one has no rows left out. */
    forget(files) {
      windows = windows.filter((one) => !files.includes(one.file));
    },
    clear() {
      windows = [];
    },
    /** Takes over what a calibration file says. */
    take(given) {
      windows = given;
    },
  };
}
