// Measured files: reads them through the service, shows what was recognized, readings and wrong lines.

import { postForm } from "./api.js";
import { createChart } from "./chart.js";
import { createColumns } from "./columns.js";
import { button, byId, element, show, table, takeDrops } from "./dom.js";
import { excerpt } from "./excerpt.js";
import { createForm } from "./form.js";
import { count, cycles, fixed, plain } from "./format.js";
import { editInPlace } from "./job.js";
import { createFields } from "./key_fields.js";
import { keysOf } from "./keys.js";
import { createLeftOut } from "./left_out.js";
import { problemBox } from "./notices.js";
import { inShown, isUs, unitShown } from "./units.js";

const LENGTHS = { mm: "millimeters", inch: "inches", m: "meters" };
const CYCLES = { cycles: "single cycles", kilocycles: "thousands of cycles", megacycles: "millions of cycles" };
const LAYOUTS = { long: "one reading a row", wide: "one column of cycles for every specimen",
  paired: "two columns for every specimen" };

/** Keys that say how files are written. */
export const OF_FILES = ["length_unit", "cycle_unit", "load_unit", "decimal", "sheet"];

/** `onChange` is called when the curves change. Gives {files(), said(), window(), load(files)}. */
export function createMeasured(onChange) {
  const root = byId("measured");
  const input = byId("measured-input");
  const drop = byId("measured-drop");
  // What is said of the files, by keys of [measured].
  const said = createFields(createForm(() => read()), "measured", keysOf("measured").filter(({ metric }) => OF_FILES.includes(metric)));
  show(byId("units"), said.group("Units and format", OF_FILES));
  const columns = createColumns(() => read());
  const [result, chartPlace] = [byId("measured-result"), byId("measured-chart")];
  const out = createLeftOut(() => read());
  let files = []; // {name, file, text}
  let answer = []; // the files as the service read them
  let running = null;
  let chart = null;

  async function add(list) {
    const fresh = await Promise.all([...list].map(keep));
    if (fresh.length === 0) return;
    // The same name again is a corrected file.
    out.forget(fresh.map((one) => one.name));
    files = [...files.filter((old) => !fresh.some((one) => one.name === old.name)), ...fresh];
    read();
  }

  /** The file as it is now: what is run must be what is shown, whatever becomes of the file meanwhile. */
  async function keep(file) {
    const bytes = await file.arrayBuffer();
    // Quotation marks and line ends do not come through a form as they are.
    const name = file.name.replace(/["\r\n]/g, "'");
    const isTable = /\.(xlsx|xlsm)$/i.test(name);
    return { name, file: new Blob([bytes]), text: isTable ? null : new TextDecoder().decode(bytes) };
  }

  async function read() {
    running?.abort();
    const own = new AbortController();
    running = own;
    root.dataset.measured = files.length > 0 ? "reading" : "empty";
    if (files.length === 0) {
      answer = [];
      draw();
      return;
    }
    const form = new FormData();
    for (const { name, file } of files) form.append("file", file, name);
    for (const [key, value] of Object.entries(said.collect())) form.append(key, value);
    if (columns.names()) form.append("columns", JSON.stringify(columns.names()));
    if (out.rows().length > 0) form.append("leave_out", JSON.stringify(out.rows()));
    if (answer.length === 0) show(result, element("p", { class: "quiet", role: "status" }, "Reading …"));
    try {
      const found = await postForm("/v1/measured", form, { signal: own.signal });
      if (own.signal.aborted) return;
      answer = found.files;
      draw();
    } catch (error) {
      if (own.signal.aborted) return;
      answer = [];
      draw();
      show(result, problemBox(error, read));
      root.dataset.measured = "problem";
    }
  }

  const curves = () => answer.flatMap((file) => file.curves);
  const problems = () => answer.flatMap((file) => file.problems);

  function draw() {
    root.dataset.measured = files.length === 0 ? "empty" : problems().length > 0 ? "problem" : "ok";
    byId("units").hidden = files.length === 0;
    byId("example-note").hidden = !files.some((file) => file.example);
    show(result, answer.map(describe), out.list(), problems().length > 0 && problemTable(), files.map(wrongLines), warnings());
    drawChart();
    onChange();
  }

  function describe(answered) {
    const { file, columns: understood, curves: found } = answered;
    const readings = found.reduce((sum, curve) => sum + curve.cycles.length, 0);
    const names = found.map((curve) => curve.specimen);
    const list = names.length > 6 ? `${names.slice(0, 6).join(", ")} …` : names.join(", ");
    const words = understood && [
      LAYOUTS[understood.layout] ?? understood.layout,
      understood.separator && `columns separated by ${understood.separator}`,
      understood.decimal_comma ? "decimal commas" : "decimal points",
      `crack length in ${LENGTHS[understood.length_unit] ?? understood.length_unit}`,
      `cycles counted in ${CYCLES[understood.cycle_unit] ?? understood.cycle_unit}`,
    ].filter(Boolean).join(", ");
    const summary = `${count(found.length, "specimen")} (${list}), ${count(readings, "reading")}`;
    return element("div", { class: "file-card", "data-file": file },
      element("div", null, element("h3", null, file),
        element("p", null, found.length > 0 ? `${summary}: ${ranges(found)}.` : "No readings found."),
        words && element("p", { class: "quiet" }, `Recognized: ${words}.`),
        columns.show(answered), found.length > 0 && out.readings(answered)),
      button("Remove", () => {
        files = files.filter((one) => one.name !== file);
        out.forget([file]);
        if (files.length === 0) {
          columns.clear();
          out.clear();
        }
        read();
      }, { class: "button small", "aria-label": `Remove ${file}` }));
  }

  function ranges(found) {
    const lengths = found.flatMap((curve) => curve.crack_length_mm);
    const last = Math.max(...found.map((curve) => curve.cycles.at(-1) ?? 0));
    return `${[Math.min(...lengths), Math.max(...lengths)].map((length) => plain(inShown(length, "mm"), isUs ? 5 : 6)).join(" to ")} ${unitShown("mm")}, up to ${cycles(last)} cycles`;
  }

  /** Whether a problem is with what the columns are, which can be chosen here. */
  const isOfColumns = (problem) => problem.key === "header" || (problem.key ?? "").startsWith("measured.columns");

  /** Without the first rows, which are shown above with the choices. */
  const remedyOf = (problem) => (problem.remedy ?? "").replace(/;?\s*read so far[\s\S]*$/, "");

  function problemTable() {
    const list = problems();
    const rows = list.map((one) => [
      one.line ? button(`${one.file}:${one.line}`, () => jump(one), { class: "link" }) : one.file,
      one.key ?? "", one.value ?? "", one.problem ?? "", remedyOf(one), isOfColumns(one) ? "" : takeOut(one),
    ]);
    const columns = ["File and line", "Column", "Value", "Problem", "Fix", "Action"].map((title) => ({ title }));
    return element("div", { class: "notice bad", role: "alert", "data-problems": list.length },
      element("h3", null, list.length >= 100 ? "First 100 problems" : count(list.length, "problem")),
      element("p", null, list.some(isOfColumns) && "Assign columns above and units under “Units and format”, or correct the file. ",
        !list.some(isOfColumns) && "Exclude a line (with a reason), or correct the file and drop it again.", curves().length > 0 && " The chart shows the readings that are right."),
      table("Problems of the measured files", columns, rows, { hidden: true, name: "problems" }));
  }

  /** A line that is wrong stays in the file as it was dropped: `leave_out` names it, its value and the reason. */
  function takeOut({ file, line, value }) {
    if (!line) return "";
    const place = element("span", null, button("Exclude", () => editInPlace(place, { label: `Reason to exclude line ${line}`, value: "",
      save: (reason) => out.addRow({ file, line, value: value ?? '""', reason }),
    }), { class: "button small", "data-action": "take-out", "aria-label": `Exclude line ${line}` }));
    return place;
  }

  function wrongLines({ name, text }) {
    const lines = problems().filter((one) => one.file === name && one.line).map((one) => one.line);
    return lines.length > 0 && text !== null && excerpt(text, lines, name);
  }

  function jump({ file, line }) {
    const figure = [...result.querySelectorAll(".excerpt")].find((one) => one.textContent.includes(file));
    const target = figure?.querySelector(`[data-line="${Number(line)}"]`);
    target?.scrollIntoView({ block: "center" });
    figure?.querySelector(".excerpt-lines").focus({ preventScroll: true });
  }

  function warnings() {
    // Most of them say the file themselves.
    const named = (file, line) => (line.includes(`${file}:`) ? line : `${file}: ${line}`);
    // Whoever has said what the columns are knows which are not read.
    const isNews = (line) => !(columns.names() && line.includes(": ignored columns: "));
    const list = answer.flatMap((file) => file.warnings.filter(isNews).map((line) => named(file.file, line)));
    return list.length > 0 && element("div", { class: "notice warn" }, element("ul", null, list.map((line) => element("li", null, line))));
  }

  function drawChart() {
    chartPlace.hidden = curves().length === 0;
    if (chartPlace.hidden) return;
    chart ??= createChart(chartPlace, {
      name: "measured",
      label: "Measured crack length against cycles",
      x: { label: "Cycles N", format: cycles, from: 0 },
      y: { label: "Crack length a", unit: "mm", from: 0, format: (value) => fixed(value, 2) },
    });
    const all = answer.flatMap((file) => file.curves.map((curve) => ({ file: file.file, curve })));
    const isMany = all.length > 6; // more have no tone of their own
    chart.set([...all.map(({ file, curve }, index) => ({
      id: `${file}/${curve.specimen}`, name: isMany ? undefined : curve.specimen, kind: isMany ? "thin" : "points", x: curve.cycles, y: curve.crack_length_mm, tone: isMany ? 2 : 2 + index,
    })), ...out.marks(all.map(({ curve }) => curve))]);
  }

  input.addEventListener("change", () => {
    add(input.files);
    input.value = ""; // the same file may be chosen again after a correction
  });
  takeDrops(drop, add);
  // A file dropped outside the field must not replace the page.
  for (const name of ["dragover", "drop"]) window.addEventListener(name, (event) => event.preventDefault());
  root.dataset.measured = "empty";

  return {
    /** The files {name, file, text}, as a calibration takes them; null before anything is there. */
    files: () => (curves().length === 0 ? null : files),
    names: () => files.map((file) => file.name),
    /** The first file as the service read it. */
    first: () => (curves().length === 0 ? null : answer[0]),
    /** What is said of them, as keys of [measured]. */
    said: () => ({ ...said.collect(), columns: columns.names(), leave_out: out.windows() }),
    /** Crack lengths that every curve covers. */
    window() {
      const given = curves().map((curve) => curve.crack_length_mm).filter((lengths) => lengths.length > 0);
      if (given.length === 0) return null;
      // Without the last bits that a change of unit leaves.
      const tidy = (value) => Number(value.toPrecision(9));
      const starts = given.map((lengths) => Math.min(...lengths));
      const ends = given.map((lengths) => Math.max(...lengths));
      return [tidy(Math.max(...starts)), tidy(Math.min(...ends))];
    },
    specimens: () => curves().length,
    /** Keys of [loading] that the files say, all the same. */
    loading() {
      const said = [...new Set(answer.map((file) => JSON.stringify(file.loading ?? {})))];
      return said.length === 1 ? JSON.parse(said[0]) : {};
    },
    loadExample(name, text) {
      return this.load([{ name, text, file: new Blob([text], { type: "text/csv" }), example: true }]);
    },
    /** Takes files over, with what [measured] of a calibration says of them. */
    load(next, { columns: names, leave_out: windows = [], ...others } = {}) {
      files = next;
      said.fill(Object.fromEntries(OF_FILES.map((key) => [key, others[key]])));
      columns.choose(names);
      out.take(windows);
      return read();
    },
  };
}
