// Page of one prediction: the answer first, then one place along the life for plate, curve and K. While it runs, curve and path grow.

import { answerCard, byError, errorWords, leadOf, quantilesOf } from "./answer.js";
import { getBlob, getJson, getText, postInput } from "./api.js";
import { createChart } from "./chart.js";
import { warningList } from "./check.js";
import { button, element, readCsv, show, showPage, terms } from "./dom.js";
import { follow } from "./events.js";
import { foundFurther, furtherCards } from "./further.js";
import { count, cycles, deserved, duration, fixed, scientific, sentence, significant, whole, words } from "./format.js";
import { createJobHead, describe, downloadList, failureOf, filesOf, inputText, isFinal, pathOf } from "./job.js";
import { problemBox } from "./notices.js";
import { createPicture, filePicture, showBlob, unitsOf } from "./picture.js";
import { createPlate } from "./plate.js";
import { partThroughTerms, spectrumCard, spectrumTerms } from "./prediction_more.js";
import { createRemaining, fleetInspection } from "./remaining.js";
import { reportButton } from "./report.js";
import { curveChoices } from "./resample.js";
import { inShown, lengthAlone, lengthShown, levelShown, rateShown, sized, spanned, unitShown } from "./units.js";

const STEPS = 1000;
const PLAY_MS = 5000;
/** Share of the life that is shown first: most of the path has its colours there. */
const START = 0.9;
const PLATE = "plate.svg";
/** The section of a crack that is not through, with its fronts. */
const SECTION = "section.svg";
/** Pictures of the end of a run, by the model that has them. */
const FIELDS = { "stress.svg": "Stress at maximum load near the end of life (deformed).", "damage.svg": "Fraction of broken bonds at the end of the run." };

export async function openPrediction(root, id, signal) {
  const job = await getJson(`/v1/predictions/${encodeURIComponent(id)}`, signal);
  const head = createJobHead(job);
  const outcome = element("div", { class: "job-body" });
  const below = element("div", { class: "job-body" });
  const [curvePlace, factorPlace] = [0, 1].map(() => element("div"));
  const platePlace = element("div", { class: "plate-parts" });
  const { node: field, image } = createPicture("Stress or damage over the plate, with the crack path");
  const fieldNote = element("figcaption");
  const fieldFigure = element("figure", { class: "card figure", "data-part": "damage", hidden: true }, element("div", { class: "chart-head" }, element("h2", null, "Field")), field, fieldNote);
  const curveFigure = element("div", { class: "card figure" }, curvePlace);
  const factors = element("div", { class: "card figure", hidden: true }, factorPlace);
  const plateFigure = element("figure", { class: "card figure", "data-part": "path" },
    element("div", { class: "chart-head" }, element("h2", null, "Crack path")), platePlace,
    element("figcaption", null, "Color: share of life; marks at 25, 50, 75, 90 %. Thin: future growth."));
  const pictures = element("div", { class: "pictures" }, element("div", { class: "stack" }, plateFigure, fieldFigure),
    element("div", { class: "stack" }, curveFigure, factors));
  showPage(root, head.node, outcome, element("div", { class: "job-body" }, pictures), below);

  const lengthAxis = { label: "Crack length a", unit: "mm", format: (value) => fixed(value, 2) };
  const chart = createChart(curvePlace, {
    name: "life", title: "Crack length over cycles", label: "Predicted crack length against cycles",
    x: { label: "Cycles N", format: (value) => cycles(Math.round(value)), from: 0 },
    y: lengthAxis,
  });
  const plate = createPlate(platePlace);
  signal.addEventListener("abort", () => chart.destroy());
  const curve = { id: "curve", name: "computed", kind: "line", tone: 0, x: [], y: [] };
  let paths = []; // of every tip, as it grows
  chart.set([curve]);

  /** The plate of the finished run with its paths, or as it was before the first cycle. */
  async function drawPlate(file) {
    try {
      const files = await filesOf(job);
      const body = { input: job.input, ...(job.calibration ? { calibration: job.calibration } : {}), files: files.length > 0 ? files : undefined };
      const svg = file ? await getText(file, signal) : (await postInput("/v1/check", body, { signal })).drawing;
      plateFigure.hidden = !svg;
      if (svg) plate.set(svg);
    } catch (error) {
      plateFigure.hidden = error.name !== "AbortError";
    }
  }

  function grow({ from, cycles: steps, crack_length_mm: lengths, tips }) {
    if (from < curve.x.length) {
      curve.x.length = from;
      curve.y.length = from;
      paths = paths.map((path) => path.slice(0, from));
    }
    chart.extend("curve", steps, lengths);
    (tips ?? []).forEach((entry, row) => entry.forEach(([x, y], tip) => {
      paths[tip] ??= [];
      paths[tip].push(`${x} ${y}`);
    }));
    plate.grow(paths);
  }

  let revision = -1;
  async function showPicture({ revision: next, href, cycles: moment, crack_length_mm: length }) {
    if (next <= revision) return;
    revision = next;
    try {
      const blob = await getBlob(href, signal);
      if (revision !== next) return; // a newer one is on its way
      fieldFigure.hidden = false;
      await showBlob(image, blob);
      fieldNote.textContent = `At ${cycles(Math.round(moment))} cycles, crack length ${lengthShown(length, 2)}.`;
    } catch {
      // The next picture comes soon; the run itself is not touched by this.
    }
  }

  async function finish(last) {
    const done = { ...job, ...last, input: job.input };
    show(below, downloadList(done, { "a_n.csv": curveChoices }), inputText(done));
    try {
      if (done.state === "succeeded") await showResult(done);
      else show(outcome, failureOf(done));
      await showCurves(done);
      // A run that failed or was cancelled before its first block has nothing to show; of one that never began to grow the plate alone.
      pictures.hidden = curve.x.length === 0;
      curveFigure.hidden = !(curve.x.at(-1) > 0);
    } catch (error) {
      if (error.name !== "AbortError") below.prepend(problemBox(error, () => finish(done)));
    }
  }

  const has = (done, name) => done.files?.some((file) => file.name === name);
  const pathTo = (done, name) => `${pathOf(done)}/files/${name}`;
  let [result, remaining] = [null, null];

  async function showResult(done) {
    result = has(done, "result.json") ? JSON.parse(await getText(pathTo(done, "result.json"), signal)) : done.summary;
    show(outcome, answerCard({ ...done.summary, ...result }, [...partThroughTerms(result), ...spectrumTerms(result)]));
    head.offer(reportButton(done, () => remaining?.wanted()));
    head.describe(describe(result));
    const messages = result.warnings ?? [];
    below.prepend(element("div", { class: "two" }, howComputed(done, result),
      messages.length > 0 && element("div", { class: "card" }, warningList(messages, "Messages"))));
    const spectrum = spectrumCard(result);
    if (!spectrum) return;
    below.prepend(spectrum.node);
    signal.addEventListener("abort", spectrum.destroy);
  }

  async function showCurves(done) {
    if (!has(done, "a_n.csv")) return;
    const columns = readCsv(await getText(pathTo(done, "a_n.csv"), signal));
    const lead = result ? leadOf(result) : null;
    const lengths = lead === null ? columns.crack_length_mm : lengthsOfTip(columns, result.tips, lead);
    Object.assign(curve, { x: columns.cycles, y: lengths, smooth: "y" });
    await drawPlate(has(done, PLATE) && pathTo(done, PLATE));
    const picture = Object.keys(FIELDS).find((name) => has(done, name));
    fieldFigure.hidden = !picture;
    if (picture) {
      revision = Infinity;
      const blob = await getBlob(pathTo(done, picture), signal);
      await showBlob(image, blob);
      fieldNote.textContent = [FIELDS[picture], await unitsOf(blob)].filter(Boolean).join(" ");
    }
    if (has(done, SECTION)) {
      factors.after(element("figure", { class: "card figure", "data-part": "section" }, element("div", { class: "chart-head" }, element("h2", null, "Section through the crack")),
        filePicture(done, SECTION, "Section through the crack with its front at quarters of the cycles", signal),
        element("figcaption", null, "Front at quarters of the cycles to breakthrough, or to the end; gray: at the start.")));
    }
    // Of a crack that is not through both lengths: its depth ends where it is.
    const depths = columns.crack_depth_mm;
    if (depths) {
      lengthAxis.label = "Length c, depth a";
      curve.name = "c";
    }
    const deep = depths && { id: "depth", name: "a", kind: "line", smooth: "y", tone: 1, dashed: true, x: columns.cycles, y: depths };
    chart.set([...bandOf(columns, lengths), curve, ...(deep ? [deep] : []), ...limitsOf(result), endOf(columns.cycles, lengths)]);
    const factorChart = drawFactors(columns, lengths, lead ?? 0);
    if (done.state === "succeeded" && !result.refused && columns.cycles.at(-1) > 0) {
      const place = createPlace({ columns, lengths, lead: lead ?? 0, result, chart, factorChart, plate });
      outcome.append(place.node);
      // The interval of a fleet is that of its plates, not of the one that was run.
      if (!result.fleet) {
        remaining = createRemaining(done, { columns, lengths, lead }, place.go, signal);
        place.onLength(remaining.setLength);
      }
      below.prepend(...[remaining?.node ?? fleetInspection(result)].filter(Boolean), ...foundFurther(done, result, signal), ...await furtherCards(done, result, remaining?.wanted));
    }
  }

  function drawFactors(columns, lengths, tip) {
    const [k, kk] = [columns[`tip${tip}_k_i_mpa_sqrt_m`], columns[`tip${tip}_k_ii_mpa_sqrt_m`]];
    factors.hidden = !k || k.filter(Number.isFinite).length < 3;
    if (factors.hidden) return null;
    const { delta_k_min_mpa_sqrt_m: least, delta_k_max_mpa_sqrt_m: most } = result?.law ?? {};
    const made = createChart(factorPlace, {
      name: "factors", title: "Stress intensity over crack length", label: `K_I and K_II of tip ${tip} at maximum load over crack length`,
      x: { label: "Crack length a", unit: "mm", format: (value) => fixed(value, 2) },
      y: { label: "K", unit: "MPa√m", format: (value) => significant(value, 4) },
      note: `At maximum load.${least || most ? " Hatched: outside the tested ΔK." : ""} Gaps: K not computed.`,
    });
    signal.addEventListener("abort", () => made.destroy());
    const ratio = columns.delta_k_mpa_sqrt_m[0] / Math.hypot(k[0], kk[0] ?? 0);
    const share = Number.isFinite(ratio) && ratio <= 1.001 ? ratio : 1;
    made.set([
      least && { id: "below", kind: "outside", name: "below the tested ΔK", y2: [least / share] },
      most && { id: "above", kind: "outside", name: "above the tested ΔK", y: [most / share] },
      { id: "k1", name: "K_I", kind: "line", smooth: "x", tone: 0, x: lengths, y: k },
      columns.depth_k_i_mpa_sqrt_m && { id: "depth", name: "K_a", kind: "line", smooth: "x", tone: 2, dashed: true, x: lengths, y: columns.depth_k_i_mpa_sqrt_m },
      kk && { id: "k2", name: "K_II", kind: "line", smooth: "x", tone: 1, dashed: true, x: lengths, y: kk },
    ].filter(Boolean));
    return made;
  }

  if (isFinal(job)) {
    await finish(job);
    return;
  }
  drawPlate();
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

/** Length of the crack that a tip ends, row by row, mm: with the growth of its other end. */
function lengthsOfTip(columns, tips, lead) {
  const same = tips.map((_, tip) => tip).filter((tip) => tips[tip].crack === tips[lead].crack);
  return columns.cycles.map((_, row) => same.reduce((sum, tip) => sum + columns[`tip${tip}_growth_mm`][row], tips[lead].crack_length_initial_mm));
}

const bandOf = ({ cycles_p05: low, cycles_p95: high }, lengths) => (low ? [{ id: "band", name: "Scatter band (90 %)", kind: "band", tone: 0, x: low, x2: high, y: lengths }] : []);

/** Where small-scale yielding ends, or begins where the crack was too short: length of the governing crack. */
function limitsOf(result) {
  const begins = result?.plastic_zone?.too_large_to_mm;
  const from = begins ?? result?.plastic_zone?.too_large_from_mm;
  return from ? [{ id: "yielding", kind: "limit", name: `small-scale yielding ${begins ? "begins" : "ends"}, ${lengthShown(from, 1)}`, y: [from] }] : [];
}

const endOf = (steps, lengths) => ({ id: "end", kind: "end", name: lengthShown(lengths.at(-1), 1), x: [steps.at(-1)], y: [lengths.at(-1)] });

function howComputed(job, r) {
  const law = r.law ?? {};
  const rate = law.rate_at_pivot_mm_per_cycle && `da/dN ${rateShown(law.rate_at_pivot_mm_per_cycle, 3)} at ΔK ${sized(law.pivot_delta_k_mpa_sqrt_m, "MPa√m", 4)}`;
  const given = !rate && law.paris_c_mm_per_cycle && `da/dN = ${scientific(levelShown(law.paris_c_mm_per_cycle, law.paris_m), 4)} ΔK^m ${unitShown("mm/cycle")} (ΔK in ${unitShown("MPa√m")})`;
  const paris = law.paris_m && `m ${significant(law.paris_m, 4)}${law.paris_m_error ? ` ± ${significant(law.paris_m_error, 2)}` : ""}`;
  const range = law.delta_k_min_mpa_sqrt_m && `ΔK ${spanned(law.delta_k_min_mpa_sqrt_m, law.delta_k_max_mpa_sqrt_m, "MPa√m", 4)}`;
  const isNodes = r.model?.method === "element_free_galerkin";
  const model = r.points > 0 ? `${count(r.points, isNodes ? "node" : "point")}, ${count(r.solves, "solution")}, ${duration(r.wall_s)}` : `hand calculation, ${duration(r.wall_s)}`;
  return element("section", { class: "card", "aria-labelledby": "computed-title" }, element("h2", { id: "computed-title" }, "Method"),
    terms([
      ["Growth law", [rate || given, paris].filter(Boolean).join(", ") || (law.source === "inline" ? "constants entered by the user" : words(law.source))],
      range && ["Calibrated", range],
      ["Model", `${sentence(words(r.model?.method))}: ${r.model?.why?.method ?? ""}`],
      ["", model],
      errorWords(r) && ["Numerical error", errorWords(r)],
      r.cross_check && ["Cross-check", `${whole(r.cross_check.life_cycles)} cycles by ${words(r.cross_check.method)}`],
      ["Record", `perilife ${r.version}, run ${job.id}`],
    ].filter(Boolean), "computed"));
}

/** One place along the life that moves plate, curve and K. Gives {node, go(cycles), onLength(take)}. */
function createPlace({ columns, lengths, lead, result, chart, factorChart, plate }) {
  const band = quantilesOf(result);
  const steps = columns.cycles;
  const life = steps.at(-1);
  const cell = (name, wide) => [name, element("dd"), wide];
  const cells = { a: cell("Crack length"), k: cell(["K", element("sub", null, "I"), " at maximum load"]), kk: cell(["K", element("sub", null, "II")], true), left: cell(result.fleet ? "Remaining, nominal" : "Remaining life"), band: cell("Scatter band (90 %)", true) };
  const told = element("b");
  const share = element("span");
  const slider = element("input", { type: "range", id: "place", min: "0", max: String(STEPS), value: "0" });
  let listener = () => {};

  /** A column at a number of cycles, linear between rows. */
  function value(column, at) {
    if (!column) return NaN;
    const found = steps.findIndex((step) => step >= at);
    const next = found < 0 ? steps.length - 1 : Math.max(found, 1);
    const part = (at - steps[next - 1]) / (steps[next] - steps[next - 1] || 1);
    return column[next - 1] + part * (column[next] - column[next - 1]);
  }

  function go(at, isOwn = false) {
    const here = Math.min(Math.max(at, 0), life);
    const [a, k, kk] = [value(lengths, here), value(columns[`tip${lead}_k_i_mpa_sqrt_m`], here), value(columns[`tip${lead}_k_ii_mpa_sqrt_m`], here)];
    chart.move(here, [[here, a]]);
    factorChart?.move(a, [[a, k], [a, kk]]);
    plate.to(here);
    const unit = (text, of) => [text, " ", element("small", null, of)];
    told.textContent = cycles(Math.round(here));
    share.textContent = `${Math.round((100 * here) / life)} % of life`;
    const factor = (value) => (Number.isFinite(value) ? unit(fixed(inShown(value, "MPa√m"), 1), unitShown("MPa√m")) : "not read");
    show(cells.a[1], unit(lengthAlone(a, 2), unitShown("mm")));
    show(cells.k[1], factor(k));
    show(cells.kk[1], factor(kk));
    const quantiles = band && ["05", "50", "95"].map((name) => value(columns[`remaining_cycles_p${name}`], here));
    show(cells.left[1], unit(quantiles?.[1] > 0 ? deserved(quantiles[1], quantiles) : byError(life - here, result), "cycles"));
    show(cells.band[1], quantiles?.[1] > 0 ? `${deserved(quantiles[0], quantiles)} to ${deserved(quantiles[2], quantiles)}` : "no band");
    slider.setAttribute("aria-valuetext", `${cycles(Math.round(here))} cycles, crack length ${lengthShown(a, 2)}`);
    if (document.activeElement !== slider || !isOwn) slider.value = String(Math.round((STEPS * here) / life));
    if (isOwn) listener(a);
  }

  let playing = 0;
  const play = button("▶", () => {
    if (playing) {
      cancelAnimationFrame(playing);
      playing = 0;
      play.textContent = "▶";
      return;
    }
    const began = performance.now();
    play.textContent = "❚❚";
    const step = (time) => {
      const part = Math.min(1, (time - began) / PLAY_MS);
      go(life * part, part === 1);
      playing = part < 1 ? requestAnimationFrame(step) : 0;
      if (!playing) play.textContent = "▶";
    };
    playing = requestAnimationFrame(step);
  }, { "aria-label": "Play" });
  slider.addEventListener("input", () => go((life * Number(slider.value)) / STEPS, true));
  chart.pick((at) => go(at, true));
  factorChart?.pick((length) => {
    const next = lengths.findIndex((one) => one >= length);
    go(next < 0 ? life : steps[next], true);
  });
  const node = element("section", { class: "card place", "aria-label": "Position along the life", "data-part": "place" },
    element("div", { class: "play" }, play, element("div", null, element("label", { for: "place" }, element("span", null, "Cycles ", told), share), slider)),
    element("dl", { class: "read" }, Object.values(cells).map(([name, of, isWide]) => element("div", { class: isWide ? "wide-only" : null }, element("dt", null, name), of))));
  go(START * life);
  return {
    node,
    go,
    onLength(take) {
      listener = take;
    },
  };
}
