// List of all runs with their answers: opened, renamed, noted, duplicated, archived, cancelled, deleted; lives are ticked to compare them.

import { fleetOf, kindOfMisfit, kindOfVerdict, lifeShown, mark, misfitsOf, quantilesOf } from "./answer.js";
import { getJson } from "./api.js";
import { button, byId, debounce, element, show } from "./dom.js";
import { bandOf, count, cycles, duration, fixed, moment, percent, sentence, words } from "./format.js";
import { cancelJob, changeJob, confirmDelete, describe, editInPlace, hrefOf, isFinal, nameOf, openForm, stateBadge } from "./job.js";
import { problemBox } from "./notices.js";
import { rateShown, sized, spanned } from "./units.js";

const PAGE = 50;
/** Most that a list brings at once: so many are sorted by something else than their time. */
const SORTED_MAX = 200;
const REFRESH_MS = 3000;
const SEARCH_MS = 250;
export const COMPARE_MAX = 8;
const NOUNS = { prediction: "life", calibration: "law", sweep: "sweep", sif: "K", scene: "scene" };
const took = (job) => (job.started && job.finished ? (new Date(job.finished) - new Date(job.started)) / 1000 : NaN);
const behind = (value, least = Infinity) => (Number.isFinite(value) ? value : least);
const ORDERS = {
  name: (one, other) => nameOf(one).localeCompare(nameOf(other), undefined, { numeric: true }),
  life: (one, other) => behind(one.summary?.life_cycles) - behind(other.summary?.life_cycles),
  took: (one, other) => behind(took(other), -1) - behind(took(one), -1),
  owner: (one, other) => one.owner.localeCompare(other.owner),
};

/** Builds the view; gives {open(query), close()}. */
export function createRunsView() {
  const [state, search, order, archived, place, pager, compareBar] =
    ["runs-state", "runs-search", "runs-order", "runs-archived", "runs-list", "runs-pager", "compare-bar"].map(byId);
  const ticked = new Map(); // id to name, over all pages of the list
  let kind = "";
  let pages = [""]; // `after` of every page up to the one shown
  let list = { items: [], next: null };
  let timer = 0;
  let running = null;
  let shown = "";

  async function load({ quietly = false } = {}) {
    clearTimeout(timer);
    running?.abort();
    const own = new AbortController();
    running = own;
    if (!quietly) {
      shown = "";
      show(place, element("p", { class: "quiet", role: "status" }, "Loading …"));
    }
    const query = new URLSearchParams({ limit: order.value ? SORTED_MAX : PAGE });
    const asked = { after: pages.at(-1), state: state.value, text: search.value.trim(), archived: archived.checked && "true" };
    for (const [key, value] of Object.entries(asked)) if (value) query.set(key, value);
    try {
      list = await getJson(`/v1/${kind || "jobs"}?${query}`, own.signal);
      if (own.signal.aborted) return;
      if (ORDERS[order.value]) list.items.sort(ORDERS[order.value]);
      render();
      if (list.items.some((job) => !isFinal(job))) timer = setTimeout(() => load({ quietly: true }), REFRESH_MS);
    } catch (error) {
      if (own.signal.aborted) return;
      shown = "";
      show(place, problemBox(error, () => load()));
    }
  }

  function render() {
    const text = JSON.stringify([kind, list.items]);
    // Nothing new: no flicker, and the focus stays; nor under the hand of who is writing a name.
    if (text === shown || place.querySelector(".edit-in-place, :popover-open")) return;
    shown = text;
    const focused = document.activeElement?.dataset?.focus;
    show(place, list.items.length > 0 ? tableOf(list.items) : empty());
    if (focused) place.querySelector(`[data-focus="${CSS.escape(focused)}"]`)?.focus();
    byId("runs-newer").disabled = pages.length === 1;
    byId("runs-older").disabled = !list.next;
    pager.hidden = pages.length === 1 && !list.next;
    byId("runs-sorted").hidden = !order.value || !list.next;
    drawCompare();
  }

  function empty() {
    const isNarrowed = state.value || search.value.trim() || pages.length > 1;
    return element("div", { class: "empty" }, element("p", null, isNarrowed ? "No matching runs." : "No runs yet."),
      !isNarrowed && element("p", null, element("a", { href: "#/new", class: "button" }, "New run")));
  }

  function tableOf(items) {
    const predictions = items.some((job) => job.kind === "prediction");
    const owners = items.some((job) => job.owner);
    const heads = [predictions && "Compare", "Name", "Answer", "Ends by", "Validity", owners ? "By, at" : "At", "More"].filter(Boolean);
    const isSpoken = (title) => ["Compare", "More"].includes(title);
    return element("table", { class: "runs" },
      element("caption", { class: "visually-hidden" }, "Runs"),
      element("thead", null, element("tr", null, heads.map((title) => element("th", { scope: "col" }, element("span", { class: isSpoken(title) ? "visually-hidden" : null }, title))))),
      element("tbody", null, items.map((job) => row(job, predictions))));
  }

  function row(job, predictions) {
    const name = element("div", null, element("a", { href: hrefOf(job), "data-focus": `open-${job.id}` }, nameOf(job)));
    const note = element("div", { class: "row-unit" }, job.note);
    const [answer, why, valid] = answerOf(job);
    return element("tr", { "data-job": job.id, "data-job-state": job.state, class: job.archived ? "archived" : null },
      predictions && element("td", { class: "tick" }, job.kind === "prediction" && tick(job)),
      element("th", { scope: "row" }, name, element("span", { class: "row-unit" }, describe(job.summary ?? {})), element("span", { class: "row-unit" }, NOUNS[job.kind] ?? words(job.kind), job.archived && ", archived"), note),
      element("td", null, answer), element("td", null, why), element("td", null, valid),
      element("td", { class: "by" }, job.owner && `${job.owner}, `, moment(job.created, true), Number.isFinite(took(job)) && element("span", { class: "row-unit" }, `took ${duration(took(job))}`)),
      element("td", { class: "act" }, menuOf(job, name, note)));
  }

  function menuOf(job, name, note) {
    const edit = (key, where, label) => editInPlace(where, { label, value: job[key] ?? "", save: (value) => guarded(() => changeJob(job, { [key]: value })) });
    const item = (title, action, work) => button(title, () => {
      menu.hidePopover();
      work();
    }, { class: "button bare", "data-action": action });
    const menu = element("div", { class: "menu", popover: "auto", role: "group", "aria-label": `More for ${nameOf(job)}` },
      item("Rename", "rename", () => edit("name", name, "Name")),
      item(job.note ? "Change the note" : "Add a note", "note", () => edit("note", note, "Note")),
      element("a", { class: "button bare", href: openForm(job), "data-action": "duplicate" }, "Duplicate"),
      item(job.archived ? "Restore" : "Archive", "archive", () => guarded(() => changeJob(job, { archived: !job.archived }))),
      isFinal(job) ? item("Delete", "delete", () => guarded(async () => (await confirmDelete(job)) && ticked.delete(job.id)))
        : item("Cancel", "cancel", () => guarded(() => cancelJob(job))));
    const more = button("⋯", () => {
      menu.showPopover();
      const box = more.getBoundingClientRect();
      menu.style.left = `${Math.max(8, box.right - menu.offsetWidth)}px`;
      menu.style.top = `${Math.min(box.bottom + 4, innerHeight - menu.offsetHeight - 8)}px`;
      menu.querySelector("button").focus();
    }, { class: "button bare", "aria-label": `More for ${nameOf(job)}`, "aria-haspopup": "true", "data-focus": `more-${job.id}`, "data-action": "more" });
    return [more, menu];
  }

  function tick(job) {
    const box = element("input", { type: "checkbox", "data-focus": `tick-${job.id}` });
    const may = (jobState, isTicked) => jobState === "succeeded" && (isTicked || ticked.size < COMPARE_MAX);
    box.checked = ticked.has(job.id);
    box.disabled = !may(job.state, box.checked);
    box.addEventListener("change", () => {
      if (box.checked) ticked.set(job.id, nameOf(job));
      else ticked.delete(job.id);
      shown = "";
      drawCompare();
      place.querySelectorAll(".tick input").forEach((other) => {
        other.disabled = !may(other.closest("tr").dataset.jobState, other.checked);
      });
    });
    return element("label", { class: "tick-reach" }, box, element("span", { class: "visually-hidden" }, `Compare ${nameOf(job)}`));
  }

  async function guarded(work) {
    show(byId("runs-problem"));
    try {
      await work();
    } catch (error) {
      show(byId("runs-problem"), problemBox(error));
    }
    shown = "";
    await load({ quietly: true });
  }

  function drawCompare() {
    // There before anything is ticked, so that the list does not move under the hand.
    compareBar.hidden = place.querySelector(".tick") === null;
    byId("compare-clear").hidden = ticked.size === 0;
    const told = [...ticked.values()];
    byId("compare-count").textContent = ticked.size < 2
      ? `${told.length > 0 ? `${told[0]} is selected: select another one` : "Select two or more lives"} to compare them.`
      : `${count(ticked.size, "life", "lives")} ticked${ticked.size === COMPARE_MAX ? ", the most that can be compared" : ""}.`;
    const go = byId("compare");
    go.hidden = ticked.size < 2;
    go.href = `#/compare/${[...ticked.keys()].map(encodeURIComponent).join(",")}`;
  }

  function restart() {
    pages = [""];
    load();
  }

  [state, order, archived].forEach((input) => input.addEventListener("change", restart));
  search.addEventListener("input", debounce(restart, SEARCH_MS));
  byId("compare-clear").addEventListener("click", () => {
    ticked.clear();
    shown = "";
    load({ quietly: true });
  });
  byId("runs-older").addEventListener("click", () => {
    pages.push(list.next);
    load();
  });
  byId("runs-newer").addEventListener("click", () => {
    pages.pop();
    load();
  });

  return {
    open(query) {
      const links = [...byId("runs-kinds").children];
      const wanted = links.find((link) => link.dataset.kind === (query.get("kind") ?? "")) ?? links[0];
      kind = wanted.dataset.kind;
      links.forEach((link) => (link === wanted ? link.setAttribute("aria-current", "true") : link.removeAttribute("aria-current")));
      restart();
    },
    close() {
      clearTimeout(timer);
      running?.abort();
    },
  };
}

/** Cells of a run: answer, what ends it, validity; its progress while it is not done. */
function answerOf({ kind, state, progress, problem, summary: s, ...job }) {
  const two = (first, second) => [element("strong", null, first), second && element("span", { class: "row-unit" }, second)];
  const sign = (name, text) => [mark(name), " ", text];
  if (!s) {
    const left = Number.isFinite(progress?.seconds_left) ? `about ${duration(progress.seconds_left)} left` : "";
    const shown = stateBadge({ ...job, state });
    return state === "running" ? [[shown, progress && ` ${percent(progress.share, 0)}`, element("span", { class: "row-unit" }, left)]] : [shown, problem?.title];
  }
  if (kind === "prediction") {
    const band = quantilesOf(s);
    const life = s.refused ? "not computed" : s.life_cycles === null ? "no growth" : `${s.fleet ? fleetOf(s)[0] : lifeShown(s)} cycles`;
    const beside = s.fleet ? `5 % of ${s.fleet.plates} plates; median ${fleetOf(s)[1]}` : band ? bandOf(band) : "no band";
    return [two(life, s.refused || s.life_cycles === null ? "" : beside),
      sentence(words(s.stop_reason)), s.verdict_kind && sign(kindOfVerdict(s.verdict_kind), s.verdict.split(":")[0])];
  }
  if (kind === "calibration" && s.paris_m) {
    const fit = kindOfMisfit(...misfitsOf(s));
    const range = `ΔK ${spanned(s.delta_k_min_mpa_sqrt_m, s.delta_k_max_mpa_sqrt_m, "MPa√m", 3)}`;
    return [two(`m ${fixed(s.paris_m, 2)}`, `${rateShown(s.rate_at_pivot_mm_per_cycle, 3)} at ΔK ${sized(s.pivot_delta_k_mpa_sqrt_m, "MPa√m", 3)}`), "", fit ? sign(fit, range) : range];
  }
  const factors = (s.tips ?? []).flatMap((tip) => Object.values(tip.methods ?? {})).filter((read) => Number.isFinite(read.k_i_mpa_sqrt_m));
  if (kind === "sif" && factors.length > 0) {
    const most = factors.reduce((one, other) => (other.k_i_mpa_sqrt_m > one.k_i_mpa_sqrt_m ? other : one));
    return [two(sized(most.k_i_mpa_sqrt_m, "MPa√m", 4), `K II ${sized(Math.abs(most.k_ii_mpa_sqrt_m) < 1e-6 * most.k_i_mpa_sqrt_m ? 0 : most.k_ii_mpa_sqrt_m, "MPa√m", 3)}`), ""];
  }
  if (kind === "sweep" && s.life_cycles?.p50) {
    const figure = (value) => cycles(Math.round(value));
    const open = (s.failed ?? 0) + (s.missing ?? 0);
    return [two(`${figure(s.life_cycles.p50)} cycles`, `${figure(s.life_cycles.p05)} to ${figure(s.life_cycles.p95)}, ${count(s.cases, "case")}`), "",
      sign(open === 0 ? "ok" : "note", open === 0 ? "whole" : `${open} without a life`)];
  }
  return [stateBadge({ ...job, state, summary: s }), words(s.stop_reason === "done" ? "" : s.stop_reason ?? s.law ?? "")];
}
