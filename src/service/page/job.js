// What every run has: state, progress, problem, files, cancel and delete.

import { Problem, download, getBlob, getJson, patchJson, postJson, remove } from "./api.js";
import { button, byId, element, show, terms } from "./dom.js";
import { follow } from "./events.js";
import { excerpt } from "./excerpt.js";
import { bytes, count, cycles, duration, moment, percent, sentence } from "./format.js";
import { problemBox } from "./notices.js";
import { isUs, lengthShown } from "./units.js";

export const FINAL = ["succeeded", "failed", "cancelled"];

export const collectionOf = ({ kind }) => (kind === "sif" ? kind : `${kind}s`);
export const hrefOf = (job) => `#/${collectionOf(job)}/${encodeURIComponent(job.id)}`;
export const pathOf = (job) => `/v1/${collectionOf(job)}/${encodeURIComponent(job.id)}`;
export const kindOf = ({ kind }) => (kind === "sif" ? "Stress intensity" : sentence(kind));
export const nameOf = (job) => job.name || job.id;
export const isFinal = (job) => FINAL.includes(job.state);

/** State of a run; one whose life does not count is refused, whatever its worker made of it. */
export function stateBadge({ state, summary }) {
  const shown = state === "succeeded" && summary?.refused ? "refused" : state;
  return element("span", { class: `badge ${shown}`, "data-state": shown }, shown === "succeeded" ? "Done" : sentence(shown));
}

/** The form from which a run can be started again. */
export function openForm(job) {
  const view = { calibration: "measure", prediction: "predict", sif: "predict" }[job.kind] ?? "new";
  return `#/${view}?from=${collectionOf(job)}/${encodeURIComponent(job.id)}`;
}

/** The run that a form starts from, as `openForm` names it; an id alone is that of a prediction. */
export function jobToStartFrom(from) {
  const parts = from.includes("/") ? from.split("/") : ["predictions", from];
  return getJson(`/v1/${parts.map(encodeURIComponent).join("/")}`);
}

/** The files that a run was given, as they go along with its input again. */
export const filesOf = (job) => Promise.all((job.inputs ?? []).map(async ({ name, href }) => ({ name, text: null, file: await getBlob(href) })));

/** The report of a run with its report data, in the units that are shown; `inspection`: query of an interval. */
export function reportOf(job, inspection = "") {
  const query = new URLSearchParams(inspection);
  if (isUs) query.set("units", "us");
  return `${pathOf(job)}/report${query.size > 0 ? `?${query}` : ""}`;
}

/** Renames a run, notes something of it, or puts it away. */
export const changeJob = (job, change) => patchJson(pathOf(job), change);

/** A line to write in, in the place of a name or a note: Enter keeps it, Escape leaves what was there. */
export function editInPlace(place, { label, value, save }) {
  const before = [...place.childNodes];
  const input = element("input", { type: "text", "aria-label": label, value, class: "edit-in-place" });
  let isLeft = false; // taking the line away takes the focus from it
  const leave = () => {
    isLeft = true;
    show(place, before);
  };
  const keep = () => {
    if (isLeft) return;
    const next = input.value.trim();
    leave();
    if (next !== value && (next || label === "Note")) save(next);
  };
  input.addEventListener("keydown", (event) => {
    if (event.key === "Enter") keep();
    else if (event.key === "Escape") leave();
  });
  input.addEventListener("blur", keep);
  show(place, input);
  input.focus();
  input.select();
}

/** Asks before a run is deleted; true when it is gone. */
export async function confirmDelete(job) {
  const dialog = byId("delete-dialog");
  byId("delete-what").textContent = `${kindOf(job)} “${nameOf(job)}” and all its files will be deleted. This cannot be undone.`;
  dialog.returnValue = "";
  dialog.showModal();
  await new Promise((resolve) => {
    dialog.addEventListener("close", resolve, { once: true });
  });
  if (dialog.returnValue !== "delete") return false;
  await remove(pathOf(job));
  return true;
}

/** Ends a run; with `?keep=true` a prediction with the curve so far. */
export const cancelJob = (job, how = "") => postJson(`${pathOf(job)}/cancel${how}`);

/** Shows a run in `body`: what is `announced` until it ends, then why it has no result, or what `finish` makes of it. */
export async function showAtEnd(job, { head, body, announced, finish, signal }) {
  function end(last) {
    const whole = { ...job, ...last, input: job.input };
    if (whole.state === "succeeded") return finish(whole);
    return show(body, failureOf(whole), inputText(whole));
  }

  if (isFinal(job)) {
    await end(job);
    return;
  }
  show(body, element("p", { class: "quiet" }, announced));
  await follow(`${pathOf(job)}/events`, {
    signal,
    connection: head.connection,
    take(name, data) {
      if (name !== "job") return false;
      head.update(data);
      if (isFinal(data)) end(data);
      return isFinal(data);
    },
  });
}

/** Head of the page of a run: names it, follows its state, lets it be cancelled or deleted. Gives {node, update(job), connection(live)}. */
export function createJobHead(first, { actions = [] } = {}) {
  let job = first;
  let spoken = "";
  const badge = element("span");
  const what = element("p");
  const facts = element("p", { class: "quiet" });
  const bar = element("progress", { max: "1", "aria-label": "Progress" });
  const figures = element("div");
  const link = element("p", { class: "quiet", hidden: true }, "Connection lost; the run continues. Reconnecting …");
  const progress = element("div", { class: "progress" }, bar, figures, link);
  const aloud = element("p", { class: "visually-hidden", "aria-live": "polite" });
  const trouble = element("div");
  const guarded = (work) => async () => {
    show(trouble);
    try {
      await work();
    } catch (error) {
      show(trouble, problemBox(error));
    }
  };
  const cancel = button("Cancel", guarded(async () => {
    update({ ...(await cancelJob(job)), cancel_asked: true });
  }), { "data-action": "cancel" });
  const enough = job.kind === "prediction" && button("Stop here and keep the curve", guarded(async () => {
    enough.disabled = true;
    await cancelJob(job, "?keep=true");
  }), { "data-action": "stop" });
  const discard = button("Delete", guarded(async () => {
    if (await confirmDelete(job)) location.hash = `#/runs?kind=${collectionOf(job)}`;
  }), { "data-action": "delete" });
  const title = element("span", null, nameOf(job));
  const note = element("p", { class: "note" }, job.note);
  const edit = (key, place, label) => () => editInPlace(place, { label, value: job[key] ?? "", save: (value) => guarded(async () => {
    job = { ...job, ...(await changeJob(job, { [key]: value })) };
    show(place, value);
  })() });
  const node = element("header", { class: "job-head", id: "job", "data-job-kind": job.kind },
    element("div", { class: "title-row" }, element("h1", { tabindex: "-1" }, title), badge,
      button("Rename", edit("name", title, "Name"), { class: "button bare", "data-action": "rename" }),
      button("Note", edit("note", note, "Note"), { class: "button bare", "data-action": "note" }),
      element("div", { class: "tool-row end" }, actions, element("a", { class: "button", href: openForm(job), "data-action": "again" }, "Duplicate"), enough, cancel, discard)),
    what, note, facts, progress, aloud, trouble);

  function update(next) {
    job = { ...job, ...next };
    node.dataset.jobState = job.state;
    node.dataset.jobId = job.id;
    show(badge, stateBadge(job));
    const ended = isFinal(job);
    cancel.hidden = ended;
    cancel.disabled = job.cancel_asked === true;
    cancel.textContent = job.cancel_asked ? "Cancelling …" : "Cancel";
    discard.hidden = !ended;
    if (enough) enough.hidden = job.state !== "running" || !(job.progress?.cycles > 0);
    const took = job.started && job.finished ? `, took ${duration((new Date(job.finished) - new Date(job.started)) / 1000)}` : "";
    const again = job.attempts > 1 ? `, attempt ${job.attempts}` : "";
    facts.textContent = `${kindOf(job)} of ${moment(job.created)}${job.owner ? `, by ${job.owner}` : ""}${took}${again}`;
    progress.hidden = ended;
    if (!ended) showProgress();
    speak();
  }

  function showProgress() {
    const p = job.progress;
    if (job.state === "queued" || !p || p.stage) {
      bar.removeAttribute("value");
      const before = job.position > 0 ? `, ${count(job.position, "run")} ahead` : "";
      show(figures, element("p", null, job.state === "queued" ? `Waiting for a free worker${before}.` : p?.stage ? `Starting: ${p.stage} …` : "Starting …"));
      return;
    }
    const prediction = job.kind === "prediction";
    bar.value = p.share ?? 0;
    show(figures, terms([
      ["Progress", percent(p.share, 0)],
      // A fit makes several runs: the progress of one says nothing.
      prediction && ["Cycles", cycles(Math.round(p.cycles))],
      prediction && ["Crack length", lengthShown(p.crack_length_mm, 2)],
      ["Elapsed", duration(p.elapsed_s)],
      // By the growth so far, without the bounds of the error and the files that follow it.
      ["Time left", p.share > 0.995 ? "finishing" : Number.isFinite(p.seconds_left) ? `about ${duration(p.seconds_left)}` : "not known yet"],
    ].filter(Boolean), "progress"));
  }

  /** Said aloud at every quarter and at the end, not four times a second. */
  function speak() {
    const quarter = Math.floor((job.progress?.share ?? 0) * 4) * 25;
    const words = isFinal(job) ? `Run ${job.state}` : job.state === "running" ? `Running, ${quarter} percent done` : "Waiting in the queue";
    if (words !== spoken) aloud.textContent = words;
    spoken = words;
  }

  document.title = `${nameOf(job)} – perilife`;
  update(first);
  return {
    node, update,
    /** Adds a button before the others. */
    offer(own) {
      if (own) node.querySelector(".tool-row.end").prepend(own);
    },
    /** What the run is of, in a sentence. */
    describe(text) {
      what.textContent = text;
    },
    connection(live) {
      link.hidden = live;
    },
    get job() {
      return job;
    },
  };
}

/** One sentence on what was computed: plate, material, load. */
export function describe({ plate }) {
  return plate ? [sentence(plate.specimen), plate.material, plate.load].filter(Boolean).join("; ") : "";
}

/** Why a run failed, with the lines of its input where the problem names one. */
export function failureOf(job) {
  if (job.state === "cancelled") return element("p", { class: "notice" }, "Run canceled.");
  const problem = Problem.ofJob(job.problem);
  const { line, file } = problem.input ?? {};
  const ofInput = line && job.input && !/\.csv$/i.test(file ?? "");
  return element("div", null, problemBox(problem), ofInput && excerpt(job.input, [line], "Input"));
}

/** Everything to take away; `special`: {name: node} where a file has choices of its own. */
export function downloadList(job, special = {}) {
  const trouble = element("div");
  const fetchFile = async (href, name) => {
    show(trouble);
    try {
      await download(href, name);
    } catch (error) {
      show(trouble, problemBox(error));
    }
  };
  const items = (job.files ?? []).map((file) => element("li", { "data-file": file.name },
    button(file.name, () => fetchFile(file.name === "report.html" ? reportOf(job) : file.href, file.name), { class: "link" }),
    element("span", { class: "quiet" }, ` ${bytes(file.bytes)}`), special[file.name]?.(file, fetchFile)));
  return element("section", { "aria-labelledby": "downloads-title" }, element("h2", { id: "downloads-title" }, "Downloads"),
    items.length > 0 ? element("ul", { class: "downloads" }, items) : element("p", { class: "quiet" }, "No files."), trouble);
}

/** The input as it was submitted. */
export function inputText(job) {
  return job.input && element("details", { class: "input-text" }, element("summary", null, "Input as submitted (TOML)"),
    element("pre", { tabindex: "0", role: "region", "aria-label": "Input as submitted" }, job.input));
}
