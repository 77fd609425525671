// Entry of the page: finds the view that belongs to the address, and keeps what all views share.

import { getJson, onWaiting } from "./api.js";
import { createCalibrateView } from "./calibrate.js";
import { openCalibration } from "./calibration_page.js";
import { openComparison } from "./compare.js";
import { byId, element, show, showPage } from "./dom.js";
import { count } from "./format.js";
import { loadKeys } from "./keys.js";
import { problemBox } from "./notices.js";
import { openOther } from "./other_page.js";
import { createNewRunView } from "./new_run.js";
import { createPredictView } from "./predict.js";
import { openPrediction } from "./prediction_page.js";
import { createRunsView } from "./runs.js";
import { forgetToken, readToken } from "./token.js";
import { startUnits } from "./units.js";

startUnits(byId("shown-units"));

const views = { runs: createRunsView() }; // the others once their keys are known
const OTHERS = { scenes: "Fracture scene", sweeps: "Sweep", sif: "Stress intensity factors" };
const PAGES = {
  calibrations: openCalibration, predictions: openPrediction,
  ...Object.fromEntries(Object.keys(OTHERS).map((name) => [name, openOther(name)])),
};
const TITLES = {
  measure: "Calibrate", predict: "Predict", runs: "Runs", new: "New run",
  calibrations: "Calibration", predictions: "Prediction", compare: "Comparison", ...OTHERS,
};
const NAVIGATION = { measure: "measure", predict: "predict" }; // all others belong to the runs

const FORMS = ["measure", "predict", "new"];

let leaving = new AbortController();
let lastPlace = null;

/** "#/predictions/7?x=1" to its parts. */
function address() {
  const [path, query = ""] = location.hash.replace(/^#\/?/, "").split("?");
  const [name = "", rest = ""] = path.split("/");
  return { name: name in TITLES ? name : "new", rest, query: new URLSearchParams(query) };
}

async function route() {
  leaving.abort();
  leaving = new AbortController();
  const { signal } = leaving;
  const { name, rest, query } = address();
  const place = FORMS.includes(name) || name in views ? name : "run";
  views.runs.close();
  byId("start-problem").hidden = !FORMS.includes(place);
  for (const section of document.querySelectorAll("section.view")) section.hidden = section.id !== `view-${place}`;
  for (const link of document.querySelectorAll("nav a")) {
    if (link.dataset.view === (NAVIGATION[name] ?? "runs")) link.setAttribute("aria-current", "page");
    else link.removeAttribute("aria-current");
  }
  document.title = `${TITLES[name]} – perilife`;
  if (place === "run") await openRun(byId("view-run"), name, rest, signal);
  else {
    announce(place);
    if (place !== "runs") await formsReady;
    if (!signal.aborted) views[name]?.open?.(query);
  }
}

async function openRun(root, name, rest, signal) {
  show(root, element("h1", { tabindex: "-1" }, TITLES[name]), element("p", { class: "quiet", role: "status" }, "Loading …"));
  announce("run");
  try {
    const ids = rest.split(",").map(decodeURIComponent);
    const work = name === "compare" ? openComparison(root, ids, signal) : PAGES[name](root, ids[0], signal);
    await work;
  } catch (error) {
    if (signal.aborted || error.name === "AbortError") return;
    showPage(root, element("h1", { tabindex: "-1" }, TITLES[name]), problemBox(error, error.status === 404 ? null : route),
      element("p", null, element("a", { href: "#/runs" }, "All runs")));
  }
}

/**
 * After a change of view the reading goes on at its heading. Not at the very first, where the page starts at its top, nor
 * within a view, where the focus is on what was changed.
 */
function announce(place) {
  if (lastPlace !== null && (place === "run" || place !== lastPlace)) {
    byId(`view-${place}`).querySelector("h1").focus({ preventScroll: true });
    scrollTo(0, 0);
  }
  lastPlace = place;
}

/** Builds the forms from the keys and materials that the service has. */
async function buildForms() {
  try {
    const [{ materials }] = await Promise.all([getJson("/v1/materials"), loadKeys()]);
    views.predict = createPredictView(materials);
    Object.assign(views, { measure: createCalibrateView(materials), new: createNewRunView({ predict: views.predict }) });
    show(byId("start-problem"));
  } catch (error) {
    show(byId("start-problem"), problemBox(error, () => buildForms().then(route)));
  }
}

async function loadService() {
  try {
    const service = await getJson("/v1/service");
    const facts = [`${service.name} ${service.version}`, count(service.workers, "worker"), service.role && `your role: ${service.role}`];
    byId("service-facts").textContent = facts.filter(Boolean).join(", ");
  } catch {
    byId("service-facts").textContent = ""; // the materials say what is wrong
  }
}

onWaiting((words) => {
  const banner = byId("waiting");
  banner.textContent = words ?? "";
  banner.hidden = words === null;
});
document.addEventListener("token", ({ detail: given }) => {
  byId("forget-token").hidden = !given;
  if (given) loadService(); // the role comes with the token
});
byId("forget-token").hidden = readToken() === null;
byId("forget-token").addEventListener("click", () => {
  forgetToken();
  location.reload();
});
// The address names the view, so the skip link must not change it.
document.querySelector(".skip").addEventListener("click", (event) => {
  event.preventDefault();
  byId("main").focus();
});
window.addEventListener("hashchange", route);

const formsReady = buildForms();
loadService();
route();
