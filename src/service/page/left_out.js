// Excluded readings, each with its reason: `leave_out` of [measured]. The growth up to such a reading and from it on is not used.

import { button, element, show, table } from "./dom.js";
import { cycles, fixed } from "./format.js";
import { editInPlace } from "./job.js";

/** Place of an excluded reading. */
export const placeOf = (one) => (one.line ? `${one.file ?? "Row"}, line ${one.line} (${one.value})` : `${one.specimen ?? "All"}, ${cycles(one.from_cycles)} to ${cycles(one.to_cycles)} cycles`);

/** `onChange` is called when another reading is excluded. */
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
    const place = element("span", null, isOut(curve, index) ? "excluded" : button("Exclude", () => editInPlace(place, {
      label: `Reason to exclude line ${curve.lines[index]}`, value: "", save: (reason) => change([...windows, windowOf(curve, index, reason)]),
    }), { class: "button small", "data-action": "leave-out", "aria-label": `Exclude the reading of line ${curve.lines[index]}` }));
    return [String(curve.lines[index]), cycles(curve.cycles[index]), fixed(curve.crack_length_mm[index], 3), place];
  }

  return {
    /** All readings of one specimen of a file, shown when they are asked for. */
    readings({ file, curves }) {
      const place = element("div");
      const choice = curves.length > 1 && element("select", { "aria-label": `Specimen of ${file}` }, curves.map((curve, index) => element("option", { value: index }, curve.specimen)));
      const draw = () => {
        const curve = curves[choice ? Number(choice.value) : 0];
        show(place, choice, table(`Readings of ${curve.specimen}`, [{ title: "Line" }, { title: "Cycles", numeric: true }, { title: "a", unit: "mm", numeric: true }, { title: "Reason" }],
          curve.cycles.map((_, index) => rowOf(curve, index)), { hidden: true, name: "readings" }));
      };
      if (choice) choice.addEventListener("change", draw);
      const more = element("details", { ontoggle: () => more.open && draw() }, element("summary", null, "Exclude readings"), place);
      return more;
    },
    /** Excluded readings with their reasons. */
    list: () => windows.length > 0 && element("div", { class: "notice", "data-part": "left-out" }, element("h3", null, "Excluded"),
      element("ul", null, windows.map((one) => element("li", null, `${placeOf(one)}: ${one.reason} `,
        button("Restore", () => change(windows.filter((other) => other !== one)), { class: "button small" }))))),
    /** Marks of excluded readings for the chart. */
    marks(curves) {
      const out = curves.flatMap((curve) => curve.cycles.map((step, index) => [step, curve.crack_length_mm[index], isOut(curve, index)])).filter((point) => point[2]);
      return out.length > 0 ? [{ id: "left-out", name: "excluded", kind: "crosses", x: out.map((point) => point[0]), y: out.map((point) => point[1]) }] : [];
    },
    windows: () => (windows.length > 0 ? windows : undefined),
    /** Rows by their lines, without the others. */
    rows: () => windows.filter((one) => one.line),
    addRow: (row) => change([...windows, row]),
    /** Forgets rows of files that are gone or replaced. */
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
