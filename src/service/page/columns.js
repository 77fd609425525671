// Columns of a measured file: its first rows, and above each column a choice of what it is. The choices are those of
// `measured.columns` in a calibration file.

import { element, table, uniqueId } from "./dom.js";
import { cycles, parseNumber } from "./format.js";
import { lengthShown } from "./units.js";

const KEYS = [
  ["", "ignore"], ["cycles", "cycles"], ["length", "crack length"], ["specimen", "specimen"],
  ["force_max", "maximum load"], ["force_min", "smallest load"], ["force_range", "range of load"], ["stress_ratio", "stress ratio"],
];

/** A cell, and the value that was read where that differs. */
function withTaken({ columns, taken }, cell, row, index) {
  const value = taken?.[row]?.[index];
  if (!Number.isFinite(value) || parseNumber(cell) === value) return cell;
  return [cell, " ", element("span", { class: "quiet nowrap" }, columns.keys[index] === "length" ? lengthShown(value, 2) : cycles(Math.round(value)))];
}

/** `onChange` is called when another choice was made. Gives {names(), clear(), show(file)}. */
export function createColumns(onChange) {
  let chosen = {}; // key: names of its columns

  /** The key of a column: as the service understood it, or, where it understood nothing, as chosen. */
  const keyOf = (file, index) => file.columns?.keys[index]
    ?? Object.keys(chosen).find((key) => chosen[key].includes(nameOf(file, index))) ?? "";

  /** The name of a column, or its number where the name is missing or double. */
  const nameOf = ({ header }, index) => {
    const name = header[index];
    return name !== "" && header.indexOf(name) === header.lastIndexOf(name) ? name : String(index + 1);
  };

  function choice(file, index, selects) {
    const id = uniqueId("column");
    const select = element("select", { id, "data-column": file.header[index], onchange: () => {
      chosen = {};
      selects.forEach((one, place) => {
        if (one.value !== "") (chosen[one.value] ??= []).push(nameOf(file, place));
      });
      onChange();
    } }, KEYS.map(([value, title]) => element("option", { value }, title)));
    select.value = keyOf(file, index);
    selects.push(select);
    const name = file.header[index] || `column ${index + 1}`;
    return element("span", null, element("label", { class: "visually-hidden", for: id }, `What ${name} is`), select, element("br"), name);
  }

  return {
    /** Columns by key, as `measured.columns`; undefined where nothing was chosen. */
    names() {
      const entries = Object.entries(chosen).map(([key, names]) => [key, key === "length" ? names : names.at(-1)]);
      return entries.length > 0 ? Object.fromEntries(entries) : undefined;
    },
    clear() {
      chosen = {};
    },
    /** Takes over what a calibration file says. */
    choose(names = {}) {
      chosen = Object.fromEntries(Object.entries(names).map(([key, list]) => [key, [list].flat()]));
    },
    /** The first rows of a file as the service cut them. */
    show(file) {
      // A wide table has a specimen in every column.
      if (file.header.length === 0 || ["wide", "paired"].includes(file.columns?.layout)) return null;
      const selects = [];
      const columns = file.header.map((_, index) => ({ title: choice(file, index, selects) }));
      return element("details", { open: file.columns === null || Object.keys(chosen).length > 0 },
        element("summary", null, "Columns"),
        table(`Columns and first rows of ${file.file}`, columns, file.first_rows.map((cells, row) => cells.map((cell, index) => withTaken(file, cell, row, index))),
          { hidden: true, rowHeader: false, name: "columns" }));
    },
  };
}
