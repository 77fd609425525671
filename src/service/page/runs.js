// List of all runs with their answers: open, cancel, delete, and tick predictions to compare them.

import { getJson } from "./api.js";
import { button, byId, element, show } from "./dom.js";
import { count, cycles, duration, fixed, lifeOf, moment, percent, scientific, words } from "./format.js";
import { cancelJob, confirmDelete, hrefOf, isFinal, kindOf, nameOf, stateBadge } from "./job.js";
import { problemBox } from "./notices.js";

const PAGE = 20;
const COLLECTIONS = ["predictions", "calibrations", "scenes", "sweeps", "sif"];
const REFRESH_MS = 3000;
export const COMPARE_MAX = 8;

/** Builds the view; gives {open(query), close()}. */
const BEGINNINGS = { calibrations: ["#/measure", "Calibrate from measured curves"], predictions: ["#/predict", "Predict a plate"] };

export function createRunsView() {
  const [kind, state, search, place, pager, compareBar] = ["runs-kind", "runs-state", "runs-search", "runs-list", "runs-pager", "compare-bar"].map(byId);
  const ticked = new Map(); // id to name, over all pages of the list
  let pages = [""]; // `after` of every page up to the one shown
  let next = null;
  let items = []; // of the page shown
  let timer = 0;
  let running = null;
  let shown = "";

  /** A page of one kind; of all kinds the newest, since their pages do not go together. */
  async function fetchPage(signal) {
    const query = new URLSearchParams({ limit: PAGE });
    if (pages.at(-1)) query.set("after", pages.at(-1));
    if (state.value) query.set("state", state.value);
    if (kind.value) return getJson(`/v1/${kind.value}?${query}`, signal);
    const lists = await Promise.all(COLLECTIONS.map((one) => getJson(`/v1/${one}?${query}`, signal)));
    const items = lists.flatMap((list) => list.items).sort((one, other) => other.created.localeCompare(one.created));
    return { items: items.slice(0, 2 * PAGE), next: null };
  }

  async function load({ quietly = false } = {}) {
    clearTimeout(timer);
    running?.abort();
    const own = new AbortController();
    running = own;
    if (!quietly) {
      shown = "";
      show(place, element("p", { class: "quiet", role: "status" }, "Loading …"));
    }
    try {
      const list = await fetchPage(own.signal);
      if (own.signal.aborted) return;
      next = list.next;
      items = list.items;
      render();
      if (list.items.some((job) => !isFinal(job))) timer = setTimeout(() => load({ quietly: true }), REFRESH_MS);
    } catch (error) {
      if (own.signal.aborted) return;
      shown = "";
      show(place, problemBox(error, () => load()));
    }
  }

  function render() {
    const wanted = search.value.trim().toLowerCase();
    const found = items.filter((job) => nameOf(job).toLowerCase().includes(wanted));
    const text = JSON.stringify([kind.value, found]);
    if (text === shown) return; // nothing new: no flicker, and the focus stays
    shown = text;
    const focused = document.activeElement?.dataset?.focus;
    show(place, found.length > 0 ? tableOf(found) : items.length === 0 ? empty() : element("p", { class: "empty" }, "None of these has that in its name."));
    if (focused) place.querySelector(`[data-focus="${CSS.escape(focused)}"]`)?.focus();
    byId("runs-newer").disabled = pages.length === 1;
    byId("runs-older").disabled = !next;
    pager.hidden = pages.length === 1 && !next;
    drawCompare();
  }

  function empty() {
    const what = kind.value ? kind.selectedOptions[0].text.toLowerCase() : "runs";
    if (state.value || pages.length > 1) return element("p", { class: "empty" }, `No ${state.value} ${what} here.`);
    const [href, title] = BEGINNINGS[kind.value || "predictions"] ?? ["/docs", "Programs submit them: the interface"];
    return element("div", { class: "empty" }, element("p", null, `No ${what} yet.`),
      element("p", null, element("a", { href, class: "button" }, title)));
  }

  function tableOf(items) {
    const predictions = items.some((job) => job.kind === "prediction");
    const heads = [predictions && ["Compare", ""], ["Name", ""], ["State", ""], ["Answer", ""], ["Submitted", ""], ["Took", "number"], ["Actions", ""]].filter(Boolean);
    const what = kind.value ? kind.value : "runs";
    return element("div", { class: "table-scroll", tabindex: "0", role: "region", "aria-label": `List of ${what}` },
      element("table", { class: "runs" },
        element("caption", { class: "visually-hidden" }, `List of ${what}, newest first`),
        element("thead", null, element("tr", null, heads.map(([title, type]) => element("th", { scope: "col", class: type || null }, title)))),
        element("tbody", null, items.map((job) => row(job, predictions)))));
  }

  /** What came of a run, in a line or two; nothing while it is not done. */
  function answerOf({ kind: of, summary: s }) {
    if (!s) return "";
    if (of === "prediction") {
      const why = s.refused ? "refused" : s.stop_meaning ?? words(s.stop_reason);
      return [element("strong", null, s.life_cycles === null || s.refused ? lifeOf(s) : `${lifeOf(s)} cycles`), element("span", { class: "row-unit" }, why)];
    }
    if (of === "calibration" && s.paris_m) {
      return [element("strong", null, `m ${fixed(s.paris_m, 3)}`),
        element("span", { class: "row-unit" }, `${scientific(s.rate_at_pivot_mm_per_cycle, 4)} mm/cycle at the pivot, rms of lives ${percent(s.rms_life_error, 2)}`)];
    }
    const factors = (s.tips ?? []).flatMap((tip) => Object.values(tip.methods ?? {}).map((read) => read.k_i_mpa_sqrt_m)).filter(Number.isFinite);
    if (of === "sif" && factors.length > 0) return element("strong", null, `K up to ${fixed(Math.max(...factors), 2)} MPa√m`);
    if (of === "sweep" && s.life_cycles?.p50) return element("strong", null, `median ${cycles(Math.round(s.life_cycles.p50))} cycles`);
    return words(s.stop_reason ?? "");
  }

  function row(job, predictions) {
    const took = job.started && job.finished ? (new Date(job.finished) - new Date(job.started)) / 1000 : NaN;
    return element("tr", { "data-job": job.id, "data-job-state": job.state },
      predictions && element("td", { class: "tick" }, job.kind === "prediction" && tick(job)),
      element("th", { scope: "row" }, element("a", { href: hrefOf(job), "data-focus": `open-${job.id}` }, nameOf(job)),
        !kind.value && element("span", { class: "row-unit" }, kindOf(job))),
      element("td", null, stateBadge(job), job.state === "running" && job.progress ? ` ${percent(job.progress.share, 0)}` : null),
      element("td", null, answerOf(job)),
      element("td", { class: "nowrap" }, moment(job.created)), element("td", { class: "number" }, Number.isFinite(took) ? duration(took) : ""),
      element("td", null, isFinal(job) ? action(job, "Delete", remove) : action(job, "Cancel", cancel)));
  }

  function mayTick(jobState, isTicked) {
    return jobState === "succeeded" && (isTicked || ticked.size < COMPARE_MAX);
  }

  function tick(job) {
    const box = element("input", { type: "checkbox", "data-focus": `tick-${job.id}` });
    box.checked = ticked.has(job.id);
    box.disabled = !mayTick(job.state, box.checked);
    box.addEventListener("change", () => {
      if (box.checked) ticked.set(job.id, nameOf(job));
      else ticked.delete(job.id);
      shown = "";
      drawCompare();
      place.querySelectorAll(".tick input").forEach((other) => {
        other.disabled = !mayTick(other.closest("tr").dataset.jobState, other.checked);
      });
    });
    return element("label", { class: "tick-reach" }, box, element("span", { class: "visually-hidden" }, `Compare ${nameOf(job)}`));
  }

  function action(job, title, work) {
    return button(title, () => work(job), {
      class: "button small", "aria-label": `${title} ${nameOf(job)}`, "data-focus": `act-${job.id}`, "data-action": title.toLowerCase(),
    });
  }

  async function guarded(work) {
    show(byId("runs-problem"));
    try {
      await work();
      await load({ quietly: true });
    } catch (error) {
      show(byId("runs-problem"), problemBox(error));
    }
  }

  const cancel = (job) => guarded(() => cancelJob(job));
  const remove = (job) => guarded(async () => {
    if (await confirmDelete(job)) ticked.delete(job.id);
  });

  function drawCompare() {
    // There before anything is ticked, so that the list does not move under the hand.
    compareBar.hidden = place.querySelector(".tick") === null;
    byId("compare-clear").hidden = ticked.size === 0;
    const told = [...ticked.values()];
    byId("compare-count").textContent = ticked.size < 2
      ? `${told.length > 0 ? `${told[0]} is ticked: tick another one` : "Tick two or more predictions"} to compare them.`
      : `${count(ticked.size, "prediction")} ticked${ticked.size === COMPARE_MAX ? ", the most that can be compared" : ""}.`;
    const go = byId("compare");
    go.hidden = ticked.size < 2;
    go.href = `#/compare/${[...ticked.keys()].map(encodeURIComponent).join(",")}`;
  }

  function restart() {
    pages = [""];
    load();
  }

  kind.addEventListener("change", () => {
    location.replace(kind.value ? `#/runs?kind=${kind.value}` : "#/runs");
  });
  state.addEventListener("change", restart);
  search.addEventListener("input", render);
  byId("compare-clear").addEventListener("click", () => {
    ticked.clear();
    shown = "";
    load({ quietly: true });
  });
  byId("runs-older").addEventListener("click", () => {
    pages.push(next);
    load();
  });
  byId("runs-newer").addEventListener("click", () => {
    pages.pop();
    load();
  });

  return {
    open(query) {
      const wanted = query.get("kind");
      kind.value = [...kind.options].some((one) => one.value === wanted) ? wanted : "";
      restart();
    },
    close() {
      clearTimeout(timer);
      running?.abort();
    },
  };
}
