// Report of a run: its data (laboratory, customer, persons, test conditions), kept with the run, and the page to print.

import { download } from "./api.js";
import { button, element, show } from "./dom.js";
import { createForm, grid } from "./form.js";
import { changeJob, nameOf, reportOf } from "./job.js";
import { createFields } from "./key_fields.js";
import { keysOf, loadKeys } from "./keys.js";
import { problemBox } from "./notices.js";
import { readToken } from "./token.js";
import { kept } from "./units.js";

/** Items of one report; all others are proposed for the next. */
const OF_ONE = ["number", "revision", "revision_reason", "date"];
/** Test conditions that a laboratory notes above its table. */
const NOTED = ["orientation", "environment", "waveform"];
/** The last item of every report; test conditions follow, which belong to calibrations. */
const LAST = "approver";

/** The button of the report, to be printed and signed; null for runs of earlier versions. `inspection()` gives {words, query, isChosen} or null. */
export function reportButton(job, inspection = () => null) {
  return (job.files ?? []).some(({ name }) => name === "report.html")
    && button("Report", () => openDialog(job, inspection()), { class: "button primary", "data-action": "report" });
}

async function openDialog(job, inspection) {
  await loadKeys();
  const all = keysOf("report");
  const keys = job.kind === "calibration" ? all : all.slice(0, all.findIndex(({ metric }) => metric === LAST) + 1);
  const fields = createFields(createForm(() => {}), "report", keys);
  const noted = Object.fromEntries(NOTED.map((name) => [name, job.summary?.test?.[name]]).filter(([, value]) => value));
  fields.fill(job.report ?? { date: new Date().toISOString().slice(0, 10), ...JSON.parse(kept("report") ?? "{}"), ...noted });
  const interval = inspection && element("input", { type: "checkbox", id: "report-interval", checked: inspection.isChosen });
  const trouble = element("div");

  async function print(event) {
    event.preventDefault();
    // Items that the dialog does not show stay.
    const hidden = Object.entries(job.report ?? {}).filter(([metric]) => !keys.some((key) => key.metric === metric));
    const report = { ...Object.fromEntries(hidden), ...fields.collect() };
    const address = reportOf(job, interval?.checked ? inspection.query : "");
    show(trouble);
    try {
      if (all.some(({ metric }) => report[metric] !== job.report?.[metric])) await changeJob(job, { report });
      job.report = report;
      kept("report", JSON.stringify(Object.fromEntries(Object.entries(report).filter(([name]) => !OF_ONE.includes(name)))));
      // A window of its own sends no token.
      if (readToken()) await download(address, `${nameOf(job)}.html`);
      else window.open(address, "_blank", "noopener");
      dialog.close();
    } catch (error) {
      show(trouble, problemBox(error));
    }
  }

  const dialog = element("dialog", { class: "wide-dialog", id: "report-dialog", "aria-labelledby": "report-title", onclose: () => dialog.remove() },
    element("form", { onsubmit: print }, element("h2", { id: "report-title" }, "Report"),
      element("p", { class: "hint" }, "Kept with the run. Empty items are printed as “not recorded”."), grid(...fields.nodes),
      interval && element("div", { class: "field inline" }, interval, element("label", { for: interval.id }, inspection.words)), trouble,
      element("p", { class: "tool-row end" }, element("button", { type: "submit", class: "button primary", "data-action": "open-report" }, "Open report"),
        button("Cancel", () => dialog.close()))));
  document.body.append(dialog);
  dialog.showModal();
}
