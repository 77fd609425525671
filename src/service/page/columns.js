// Columns of a measured file: its first rows, and above each column a choice of what it is. The choices are those of
// `measured.columns` in a calibration file.

import { element, table, uniqueId } from "./dom.js";

const KEYS = [
  ["", "not read"], ["cycles", "cycles"], ["length", "crack length"], ["specimen", "specimen"],
  ["force_max", "largest load"], ["force_min", "smallest load"], ["force_range", "range of load"], ["stress_ratio", "stress ratio"],
];

/** `onChange` is told when another choice was made. Gives {names(), clear(), show(file)}. */
export function createColumns(onChange) {
  let chosen = {}; // key: names of its columns

  /** The key of a column: as the service understood it, or, where it understood nothing, as chosen. */
  const keyOf = (file, index) => file.columns?.keys[index]
    ?? Object.keys(chosen).find((key) => chosen[key].includes(nameOf(file, index))) ?? "";

  /** A name that stands there twice, or none, is told by its number. */
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
    /** The first rows of a file as the service cut them. */
    show(file) {
      // A wide table has a specimen in every column.
      if (file.header.length === 0 || ["wide", "paired"].includes(file.columns?.layout)) return null;
      const selects = [];
      const columns = file.header.map((_, index) => ({ title: choice(file, index, selects) }));
      return element("details", { open: file.columns === null },
        element("summary", null, "Columns"),
        table(`Columns and first rows of ${file.file}`, columns, file.first_rows, { hidden: true, rowHeader: false, name: "columns" }));
    },
  };
}
