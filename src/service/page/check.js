// Checks the input while the user types: draws the plate, says what was understood, and puts a problem where it belongs.

import { line } from "./answer.js";
import { Problem, postInput } from "./api.js";
import { debounce, element, show, terms } from "./dom.js";
import { excerpt } from "./excerpt.js";
import { sentence, words } from "./format.js";
import { problemBox } from "./notices.js";
import { createPicture, showBlob } from "./picture.js";
import { createPlate } from "./plate.js";
import { createSpectrumPicture } from "./spectrum_picture.js";

const WAIT_MS = 350;
/** What is shown first of the input; all else is folded. */
const FIRST = ["specimen", "crack", "material", "loading", "spectrum", "model", "points", "stop", "computing"];

/**
 * `collect()` gives {input, files, calibration} or a sentence that says what is missing. The result is shown in `panel`.
 * Gives {soon(), now(), last, source}; `onResult(ok)` is called with every outcome.
 */
export function createCheck(panel, { form, collect, onResult = () => {} }) {
  const state = element("p", { class: "check-state", role: "status" });
  const { node: figure, image } = createPicture("Drawing of the scene with cracks, loads and supports");
  const place = element("div", { class: "plate-parts" });
  const plate = createPlate(place);
  const ofSpectrum = element("div", { class: "stack tight", hidden: true });
  const spectrum = createSpectrumPicture(ofSpectrum);
  const details = element("div");
  show(panel, state, place, figure, ofSpectrum, details);

  let last = null; // what the service answered to the present input, null where it refused
  let running = null;

  function tell(words, kind) {
    state.textContent = words;
    state.dataset.check = kind;
  }

  function finish(result, words, kind) {
    last = result;
    tell(words, kind);
    panel.classList.toggle("stale", result === null);
    onResult(result !== null);
  }

  async function now() {
    running?.abort();
    running = null;
    form.clearProblems();
    const body = collect();
    if (typeof body === "string") {
      show(details);
      finish(null, body, "waiting");
      return false;
    }
    // An empty form is no mistake: it is said what is missing before the service is asked.
    const missing = form.missing();
    if (missing.length > 0) {
      show(details);
      finish(null, `Required: ${missing.join(", ")}.`, "waiting");
      return false;
    }
    if (!form.numbersAreGood()) {
      show(details);
      finish(null, "A field is not a number.", "problem");
      return false;
    }
    const own = new AbortController();
    running = own;
    tell("Checking …", "running");
    try {
      const result = await postInput("/v1/check", body, { signal: own.signal });
      if (own.signal.aborted) return false;
      // Tables of rates have no plate; that of a scene is drawn for paper.
      image.hidden = result.kind !== "fracture";
      place.hidden = !image.hidden || !result.drawing;
      if (!place.hidden) plate.set(result.drawing);
      if (!image.hidden) await showBlob(image, new Blob([result.drawing], { type: "image/svg+xml" }));
      spectrum.set(result.spectrum ?? null);
      show(details, result.warnings.length > 0 && warningList(result.warnings), understood(result.understood, result.checks));
      finish(result, "Checked: no errors.", "ok");
      return true;
    } catch (error) {
      if (own.signal.aborted) return false;
      if (!(error instanceof Problem)) throw error;
      const atField = form.showProblem(error.input);
      const text = sourceOf(body, error.input);
      show(details, problemBox(error, error.passes ? now : null), text && excerpt(text.text, [error.input.line], text.name));
      finish(null, atField ? "One field needs a correction." : "The input has errors.", "problem");
      return false;
    }
  }

  return {
    soon: debounce(now, WAIT_MS),
    now,
    get last() {
      return last;
    },
    /** A problem that came with the start of a run, shown like one of a check. */
    refuse(error) {
      const atField = form.showProblem(error.input);
      show(details, problemBox(error));
      finish(null, atField ? "One field needs a correction." : "The run was not started.", "problem");
    },
  };
}

/** What was understood: the plate and its load, what a life will rest on, and all else to be unfolded. */
function understood(lines, checks = []) {
  const pairs = (wanted) => Object.entries(lines).filter(([key]) => FIRST.includes(key) === wanted).map(([key, value]) => [sentence(words(key)), String(value)]);
  const [first, others] = [pairs(true), pairs(false)];
  return [terms(first.length > 0 ? first : others, "understood"),
    checks.length > 0 && element("ul", { class: "checks" }, checks.filter((check) => check.verdict !== "passed").map((check) => line(check))),
    first.length > 0 && others.length > 0 && element("details", { class: "quiet" }, element("summary", null, "All inputs"), terms(others, "understood-all"))];
}

/** The text a problem speaks of: a measured file, or the TOML that was written. */
function sourceOf(body, input) {
  if (!input?.line) return null;
  const name = String(input.file ?? "").split("/").pop();
  const file = body.files?.find((one) => one.name === name);
  if (file) return file.text === null ? null : { name, text: file.text };
  return typeof body.input === "string" ? { name: "input", text: body.input } : null;
}

/** Warnings of the program, word for word: they are part of the answer. */
export function warningList(warnings, title = "Warnings") {
  return element("div", { class: "notice warn", "data-warnings": warnings.length },
    element("p", null, element("strong", null, `${title} (${warnings.length})`)), element("ul", null, warnings.map((line) => element("li", null, sentence(line)))));
}
