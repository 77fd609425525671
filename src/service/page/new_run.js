// New run: where each kind is begun; a sweep by a form, and any input file by its text.

import { createCheck } from "./check.js";
import { button, byId, element, show } from "./dom.js";
import { createForm } from "./form.js";
import { bytes } from "./format.js";
import { filesOf, jobToStartFrom } from "./job.js";
import { problemBox } from "./notices.js";
import { startRun } from "./submit.js";
import { createSweep } from "./sweep_form.js";

const COLLECTIONS = { case: "predictions", calibration: "calibrations", fracture: "scenes", sweep: "sweeps" };
const SCENE = `# At which load does a plate with a central crack break, pulled in steps?
[specimen]
kind = "plate"
width_mm = 50.0
length_mm = 50.0
thickness_mm = 1.0
cracks = [{ from_mm = [-5.0, 0.0], to_mm = [5.0, 0.0] }]

[material]
youngs_modulus_gpa = 72.0
poisson_ratio = 0.33
fracture_energy_j_m2 = 500.0

[loading]
kind = "displacement"
edges = ["top", "bottom"]
displacement_mm = 0.05
steps = 10

[model]
spacing_mm = 1.0

[damage]
law = "critical_stretch"
`;

/** `predict` is the view with the case that a sweep starts from. Gives {open(query)}. */
export function createNewRunView({ predict }) {
  const area = byId("file-text");
  const list = byId("file-list");
  const [start, factors, status] = [byId("file-start"), byId("file-factors"), byId("file-status")];
  let files = []; // {name, file, text}
  let name = "";
  let sweep = null;
  const check = createCheck(byId("file-check"), {
    form: createForm(() => {}),
    collect: () => (area.value.trim() === "" ? "Paste an input file, or choose one." : { input: area.value, files }),
    onResult: (ok) => {
      start.disabled = !ok;
      factors.hidden = check?.last?.kind !== "case";
      factors.disabled = !ok;
    },
  });

  function showFiles() {
    show(list, files.map((one) => element("li", null, one.name, element("span", { class: "quiet" }, ` ${bytes(one.file.size)} `),
      button("Remove", () => take(files.filter((other) => other !== one)), { class: "button small", "aria-label": `Remove ${one.name}` }))));
  }

  function take(next) {
    files = next;
    showFiles();
    check.now();
  }

  /** The first TOML file is the input while there is none; all others go along. */
  async function add(chosen) {
    const fresh = await Promise.all([...chosen].map(async (file) => ({ name: file.name, file, text: /\.(toml|csv|txt)$/i.test(file.name) ? await file.text() : null })));
    const input = area.value.trim() === "" ? fresh.find((one) => /\.toml$/i.test(one.name)) : null;
    if (input) [area.value, name] = [input.text, input.name.replace(/\.toml$/i, "")];
    const others = fresh.filter((one) => one !== input);
    take([...files.filter((old) => !others.some((one) => one.name === old.name)), ...others]);
  }

  function begin(path) {
    const first = area.value.match(/^#\s*(.{3,80}?)[.:?]?\s*$/m)?.[1];
    startRun(path, { input: area.value, files: files.length > 0 ? files : undefined, name: byId("file-name").value.trim() || name || first || "Input file" }, { button: start, status, refuse: check.refuse });
  }

  async function openFrom(from) {
    const job = await jobToStartFrom(from);
    area.value = job.input;
    name = job.name;
    byId("file-name").value = job.name;
    take(await filesOf(job));
  }

  area.addEventListener("input", check.soon);
  byId("file-input").addEventListener("change", ({ target }) => {
    add(target.files);
  });
  byId("file-scene").addEventListener("click", () => {
    area.value = SCENE;
    take([]);
  });
  start.addEventListener("click", async () => {
    if (await check.now()) begin(`/v1/${COLLECTIONS[check.last.kind]}`);
  });
  factors.addEventListener("click", async () => {
    if (await check.now()) begin("/v1/sif");
  });

  async function openSweep() {
    try {
      sweep ??= createSweep({ host: byId("sweep-editor"), fields: byId("sweep-fields"), panel: byId("sweep-check"), start: byId("sweep-start"), status: byId("sweep-status"),
        base: () => predict.body(), checked: () => predict.checked() });
      await predict.ready();
      sweep.fromBase();
    } catch (error) {
      show(byId("sweep-check"), problemBox(error, openSweep));
    }
  }

  return {
    /** `way`: sweep or file; `from`: a run whose input is shown. */
    async open(query) {
      const from = query.get("from");
      const way = from ? "file" : query.get("way") ?? "";
      byId("new-kinds").hidden = way !== "";
      byId("new-sweep").hidden = way !== "sweep";
      byId("new-file").hidden = way !== "file";
      if (way === "sweep") await openSweep();
      if (way !== "file") return;
      try {
        if (from) await openFrom(from);
        else check.soon();
      } catch (error) {
        check.refuse(error);
      }
    },
  };
}
