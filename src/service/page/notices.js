// Problems and loading states, the same everywhere.

import { button, element, show } from "./dom.js";
import { sentence } from "./format.js";

/** A problem in full: sentence, place, remedy; with a button where trying again makes sense. */
export function problemBox(problem, retry) {
  const { file, line, key, value, remedy } = problem.input ?? {};
  const given = (thing) => thing !== undefined && thing !== null && thing !== "";
  const setting = given(key) && (given(value) ? `${key} = ${value}` : key);
  const place = [given(file) && `file ${file}`, given(line) && `line ${line}`, setting].filter(Boolean);
  // The sentence usually ends with the remedy; it is not said twice.
  const untold = given(remedy) && !problem.message.includes(remedy);
  return element("div", { class: "notice bad", role: "alert", "data-problem": problem.status ?? "" },
    element("p", null, element("strong", null, titleOf(problem)), " ", sentence(problem.message)),
    place.length > 0 && element("p", { class: "quiet" }, `At ${place.join(", ")}`),
    untold && element("p", null, `Fix: ${remedy}`),
    retry && element("p", null, button("Try again", () => retry())));
}

function titleOf(problem) {
  if (problem.status === 0) return "No connection.";
  if (problem.status === 403) return "Not allowed.";
  if (problem.status === 429) return "Too many requests.";
  if (problem.status === 503) return "Service not available.";
  const title = problem.title || "Problem";
  return /[.!?]$/.test(title) ? title : `${title}.`;
}

/** Fills `place` by `work`; shows that it is loading, and a problem with a way to try again. */
export async function loadInto(place, work, words = "Loading …") {
  show(place, element("p", { class: "quiet", role: "status" }, words));
  try {
    await work();
  } catch (error) {
    if (error.name === "AbortError") return;
    show(place, problemBox(error, () => loadInto(place, work, words)));
  }
}
