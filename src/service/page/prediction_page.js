// Page of one prediction: while it runs the curve, the crack path and the damage field grow; afterwards the life and what follows from it.

import { getBlob, getJson, getText, postJson } from "./api.js";
import { createChart } from "./chart.js";
import { warningList } from "./check.js";
import { button, element, readCsv, section, show, showPage, terms } from "./dom.js";
import { follow } from "./events.js";
import { bandOf, count, cycles, deserved, duration, fixed, lifeOf, scientific, sentence, significant, whole, words } from "./format.js";
import { createJobHead, downloadList, failureOf, inputText, isFinal, pathOf } from "./job.js";
import { problemBox } from "./notices.js";
import { createPicture, showBlob } from "./picture.js";
import { createPlatePicture } from "./plate_drawing.js";
import { createRemaining } from "./remaining.js";

export async function openPrediction(root, id, signal) {
  const job = await getJson(`/v1/predictions/${encodeURIComponent(id)}`, signal);
  const address = `#/predict?from=${encodeURIComponent(id)}`;
  const again = element("a", { class: "button", href: address, "data-action": "again" }, "Start a new one from this");
  const head = createJobHead(job, { actions: [again] });
  const outcome = element("div", { class: "job-body" });
  const below = element("div", { class: "job-body" });
  const chartPlace = element("div");
  const ratePlace = element("div");
  const picturePlace = element("div");
  const { node: damage, image } = createPicture("Damage or stress over the plate, with the crack path");
  const imageNote = element("p", { class: "quiet" }, "No picture yet.");
  const rates = section("rates", "Growth rate", ratePlace);
  rates.hidden = true;
  const pictures = element("div", { class: "columns wide-left" },
    element("div", { class: "stack" }, section("curve", "Crack length against cycles", chartPlace),
      section("damage", "Plate", damage, imageNote)),
    element("div", { class: "stack" }, section("path", "Crack path", picturePlace), rates));
  showPage(root, head.node, outcome, pictures, below);

  const chart = createChart(chartPlace, {
    name: "life",
    label: "Predicted crack length against cycles",
    x: { label: "Cycles N", format: (value) => cycles(Math.round(value)), from: 0 },
    y: { label: "Crack length a", unit: "mm", from: 0, format: (value) => fixed(value, 2) },
  });
  const plate = createPlatePicture(picturePlace, "The plate with its cracks and the way every crack tip has gone");
  signal.addEventListener("abort", () => {
    chart.destroy();
    plate.destroy();
  });
  const curve = { id: "curve", name: "Predicted", kind: "line", tone: 0, x: [], y: [] };
  const today = { id: "today", name: "Today", kind: "points", tone: 1, x: [], y: [] };
  chart.set([curve]);
  drawSpecimen();

  /** The job says what was submitted as text; the check reads it and gives the specimen to draw. */
  async function drawSpecimen() {
    try {
      const body = { input: job.input, ...(job.calibration ? { calibration: job.calibration } : {}) };
      const specimen = job.case?.specimen ?? (await postJson("/v1/check", body, { signal })).case?.specimen;
      plate.setSpecimen(specimen);
    } catch (error) {
      // An input with files of its own cannot be read again here: the path then stands in the damage picture alone.
      if (error.name === "AbortError") return;
      const words = "The outline of this plate cannot be drawn from its input; the damage picture shows the path.";
      picturePlace.prepend(element("p", { class: "quiet" }, words));
    }
  }

  let paths = [];
  function grow({ from, cycles: steps, crack_length_mm: lengths, tips }) {
    if (from < curve.x.length) {
      curve.x.length = from;
      curve.y.length = from;
      paths = paths.map((path) => path.slice(0, from));
    }
    if (curve.x.length === 0) chart.set([curve]);
    chart.extend("curve", steps, lengths);
    for (const entry of tips ?? []) {
      entry.forEach((point, tip) => {
        paths[tip] ??= [];
        paths[tip].push(point);
      });
    }
    plate.setPaths(paths);
  }

  let revision = -1;
  async function showPicture({ revision: next, href, cycles: at, crack_length_mm: length }) {
    if (next <= revision) return;
    revision = next;
    try {
      const blob = await getBlob(href, signal);
      if (revision !== next) return; // a newer one is on its way
      await showBlob(image, blob);
      imageNote.textContent = `At ${cycles(Math.round(at))} cycles, crack length ${fixed(length, 2)} mm.`;
    } catch {
      // The next picture comes soon; the run itself is not touched by this.
    }
  }

  async function finish(last) {
    const whole = { ...job, ...last, input: job.input };
    if (whole.state !== "succeeded") show(outcome, failureOf(whole));
    else show(outcome, result(whole.summary), checksOf(whole.summary), whole.summary.warnings?.length > 0
      && element("details", { class: "quiet" }, element("summary", null, "All that was noticed"), warningList(whole.summary.warnings)));
    const special = { "a_n.csv": curveChoices };
    show(below, downloadList(whole, special), inputText(whole));
    await loadFiles(whole);
    // A run that failed or was cancelled before its first block has nothing to show.
    pictures.hidden = curve.x.length === 0;
  }

  async function loadFiles(whole) {
    const has = (name) => whole.files?.some((file) => file.name === name);
    const path = (name) => `${pathOf(whole)}/files/${name}`;
    try {
      if (has("a_n.csv")) {
        const columns = readCsv(await getText(path("a_n.csv"), signal));
        Object.assign(curve, { x: columns.cycles, y: columns.crack_length_mm });
        chart.set([curve, today]);
        drawRates(columns);
        if (whole.state === "succeeded" && !whole.summary.refused) {
          outcome.append(createRemaining(whole, columns, (at, length) => {
            Object.assign(today, { x: at === null ? [] : [at], y: at === null ? [] : [length] });
            chart.set([curve, today]);
          }, signal));
        }
      }
      if (has("crack_path.csv")) plate.setPaths(pathsOf(readCsv(await getText(path("crack_path.csv"), signal))));
      const picture = Object.keys(PICTURES).find(has);
      if (picture) {
        revision = Infinity;
        await showBlob(image, await getBlob(path(picture), signal));
        imageNote.textContent = PICTURES[picture];
      } else if (isFinal(whole)) {
        imageNote.textContent = "A hand calculation has no field.";
      }
    } catch (error) {
      if (error.name !== "AbortError") below.prepend(problemBox(error, () => finish(whole)));
    }
  }

  function drawRates({ delta_k_mpa_sqrt_m: k = [], da_dn_mm_per_cycle: rate = [] }) {
    const good = k.map((value, index) => [value, rate[index]]).filter(([value, other]) => value > 0 && other > 0);
    rates.hidden = good.length < 3;
    if (rates.hidden) return;
    const rateChart = createChart(ratePlace, {
      name: "rates",
      label: "Growth rate against range of stress intensity, logarithmic axes",
      x: { label: "ΔK", unit: "MPa√m", scale: "log", format: (value) => significant(value, 4) },
      y: { label: "da/dN", unit: "mm/cycle", scale: "log", format: (value) => scientific(value, 3) },
    });
    signal.addEventListener("abort", () => rateChart.destroy());
    rateChart.set([{ id: "rate", name: "Predicted", kind: "points", tone: 0, x: good.map((pair) => pair[0]), y: good.map((pair) => pair[1]) }]);
  }

  if (isFinal(job)) {
    await finish(job);
    return;
  }
  await follow(`${pathOf(job)}/events`, {
    signal,
    connection: head.connection,
    take(name, data) {
      if (name === "growth") grow(data);
      if (name === "picture") showPicture(data);
      if (name !== "job") return false;
      head.update(data);
      if (isFinal(data)) finish(data);
      return isFinal(data);
    },
  });
}

function pathsOf({ tip, x_mm: xs, y_mm: ys }) {
  const byTip = new Map();
  tip.forEach((name, index) => {
    if (!byTip.has(name)) byTip.set(name, []);
    byTip.get(name).push([xs[index], ys[index]]);
  });
  return [...byTip.values()];
}

/** Pictures of the end of a run, by the model that has them. */
const PICTURES = {
  "damage.png": "Share of bonds cut by initial cracks or broken, at the end of the run.",
  "von_mises.png": "Von Mises stress at maximum load, at the end of the run.",
  "plate.svg": "The plate to scale, its load, the first crack and its way, coloured by cycles.",
};

/** How wrong the life may be as a solution of its case; nothing of runs before such bounds were stated. */
function errorWords(s) {
  if (typeof s.error_estimate_percent === "number") {
    const path = s.path_error_estimate_mm > 0 ? `, ${s.path_error_estimate_mm} mm of the path` : "";
    return `at most ${s.error_estimate_percent} % of life${path}`;
  }
  return s.no_error_estimate && `not stated: ${s.no_error_estimate}`;
}

function result(s) {
  const life = [
    [s.stop_reason === "entered_hole" ? "Cycles to the hole" : "Life", element("strong", { class: "large", "data-value": "life_cycles" }, lifeWords(s))],
    [s.band ? "Band" : "No band", bandWords(s)],
  ];
  return element("section", { class: "result", "aria-labelledby": "result-title", "data-part": "result" },
    element("h2", { id: "result-title", class: "visually-hidden" }, "Result"),
    s.refused && element("p", { class: "notice bad", "data-value": "refused" }, element("strong", null, "No life: "), s.refused),
    terms([
      ...(s.refused ? [] : life),
      ["Crack length", lengthWords(s)],
      s.critical && ["Critical crack length", `${fixed(s.critical.crack_length_mm, 2)} mm: ${words(s.critical.criterion)}`],
      ["Stopped because", sentence(s.stop_meaning ?? words(s.stop_reason))],
      !s.refused && errorWords(s) && ["Numerical error", errorWords(s)],
      ["Computed", `${whole(s.points)} points in ${duration(s.wall_s)}`],
    ].filter(Boolean), "result"));
}

/** In a plate the length of the crack whose tip ends the life comes first, then what all cracks sum to. */
function lengthWords(s) {
  const all = `${fixed(s.crack_length_initial_mm, 2)} to ${fixed(s.crack_length_final_mm, 2)} mm`;
  const tip = (s.tips ?? []).findIndex((one) => one.leads && one.crack !== null && one.crack !== undefined);
  if (tip < 0) return all;
  const { crack_length_initial_mm: from, crack_length_final_mm: to } = s.tips[tip];
  return `${fixed(from, 2)} to ${fixed(to, 2)} mm, the crack of tip ${tip}${new Set(s.tips.map((one) => one.crack)).size > 1 ? `; all cracks ${all}` : ""}`;
}

/** What the life rests on: the verdict, and every condition that does not hold or could not be checked, with its remedy. */
function checksOf({ verdict, checks }) {
  if (!verdict) return null;
  const open = (checks ?? []).filter((check) => check.verdict !== "holds");
  return element("section", { class: "checks", "aria-labelledby": "checks-title", "data-part": "checks" },
    element("h2", { id: "checks-title" }, "Verdict"),
    element("p", { "data-value": "verdict" }, sentence(verdict)),
    open.length > 0 && element("ul", null, open.map((check) => element("li", { "data-check": check.name, "data-verdict": check.verdict },
      check.words, check.remedy && element("span", { class: "quiet" }, ` – ${check.remedy}`)))));
}

/** The life: the median of its band where there is one, with the digits that it deserves. */
function lifeWords(s) {
  if (s.life_cycles === null) return lifeOf(s);
  const band = quantiles(s);
  return band ? `${s.life_is_lower_bound ? "≥ " : ""}${deserved(band[1], band)} cycles` : `${lifeOf(s)} cycles`;
}

function bandWords(s) {
  const band = quantiles(s);
  if (!band) return s.no_band ?? "an earlier version of the program wrote this result";
  const { specimens, assumed_scatter: assumed, lot } = s.band;
  return `${bandOf(band)} cycles: ${count(specimens, "specimen")}, ${lot === "same" ? "their lot" : "another lot"}${assumed ? ", assumed scatter" : ""}`;
}

function quantiles({ band }) {
  return band ? [band.cycles_p05, band.cycles_p50, band.cycles_p95] : null;
}

/** The curve as it was computed, or at equally spaced cycles. */
function curveChoices(file, fetchFile) {
  const amount = element("input", { type: "text", inputmode: "numeric", id: "resample-amount", value: "200" });
  const kind = element("select", { id: "resample-kind" },
    element("option", { value: "points" }, "points in all"), element("option", { value: "every_cycles" }, "cycles apart"));
  const message = element("span", { class: "field-problem", role: "alert" });
  return element("span", { class: "resample" },
    element("label", { for: "resample-amount" }, "or equally spaced, "), amount,
    element("label", { for: "resample-kind", class: "visually-hidden" }, "What the number means"), kind,
    button("Download", () => {
      const number = Number(amount.value.replaceAll(/\s/g, ""));
      const good = number > 0 && (kind.value === "every_cycles" || (Number.isInteger(number) && number >= 2));
      message.textContent = good ? "" : "Give a number above 0; points: a whole number from 2.";
      if (good) fetchFile(`${file.href}?${kind.value}=${number}`, "a_n.csv");
    }, { class: "button small", "data-action": "resample" }), message);
}
