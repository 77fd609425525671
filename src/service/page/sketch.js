// The plate as a sketch to draw in, over the drawing of the service: new cracks and holes by pointer, ends and centers to drag or to move by arrow keys.
// The tables have the numbers; the sketch only changes them.

import { postInput } from "./api.js";
import { button, debounce, element, shape, show } from "./dom.js";
import { plain } from "./format.js";
import { createPlate } from "./plate.js";
import { inShown, unitShown } from "./units.js";

const TOOLS = [["move", "Move"], ["crack", "Draw a crack"], ["hole", "Place a hole"]];

const HINTS = {
  move: "",
  crack: "Drag from one crack end to the other.",
  hole: "Click to place the hole center.",
};
const WAIT_MS = 60;
const REACH = 16; // of a handle, pixels
/** What a plate is drawn with whose form is not filled: none of it shows. */
const REST = {
  material: { youngs_modulus_gpa: 70, poisson_ratio: 0.3 }, loading: { kind: "constant_amplitude", stress_max_mpa: 1, stress_ratio: 0 },
  fatigue: { paris_c_mm_per_cycle: 1e-10, paris_m: 3 },
};

/**
 * `plate()` gives the specimen as it stands in the form, `collect()` its keys and {files}; `edits` are {addCrack(from, to), addHole(x, y),
 * moveCrack(index, end, point), moveHole(index, point), remove(what, index)}.
 */
export function createSketch(container, { plate, collect, edits }) {
  let tool = "move";
  let drag = null; // {view, move(point), end()}
  let focused = null; // selector of the handle that has the focus, to give it back after a redraw
  let asked = ""; // what the drawing is of
  let handles = []; // {view, name, point, move}

  const canvas = element("div", { class: "plate-holder", role: "group", "aria-label": "Sketch of the plate. The tables below have the same numbers." });
  const buttons = TOOLS.map(([name, title]) => button(title, () => choose(name), {
    class: "button small", "aria-pressed": String(name === tool), "data-tool": name,
  }));
  const place = element("output", { class: "quiet sketch-place" }, "");
  show(container, element("div", { class: "tool-row", role: "group", "aria-label": "Sketch tools" }, buttons), canvas, place);
  const drawing = createPlate(canvas, "group");

  function choose(name) {
    tool = name;
    buttons.forEach((one) => one.setAttribute("aria-pressed", String(one.dataset.tool === name)));
    canvas.classList.toggle("drawing", name !== "move");
    place.textContent = HINTS[name];
  }

  const grid = () => stepOf(Math.max(plate().width_mm || 1, 1) / 200);
  const snap = ([x, y]) => [x, y].map((value) => Number((Math.round(value / grid()) * grid()).toFixed(6)));
  const inWords = (point) => ["x", "y"].map((axis, part) => `${axis} ${plain(point[part])} ${unitShown("mm")}`).join(", ");
  const say = (point) => {
    place.textContent = inWords(point);
  };

  const selectorOf = (view, name) => `[data-plate="${view.svg.dataset.plate}"] [data-handle="${name}"]`;

  function handle(view, name, point, move, remove) {
    const [cx, cy] = view.toPixels(point);
    const key = (event) => {
      const step = grid() * (event.shiftKey ? 10 : 1);
      const way = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[event.key];
      if (event.key === "Delete" || event.key === "Backspace") remove();
      else if (way) {
        const next = snap([point[0] + way[0], point[1] + way[1]]);
        move(next);
        say(next);
      } else return;
      event.preventDefault();
    };
    handles.push({ view, name, point, move });
    return shape("g", {
      class: "handle", tabindex: "0", role: "button", "data-handle": name,
      "aria-label": `${name}, ${inWords(point)}. Arrow keys move it, Delete removes it.`,
      onkeydown: key,
      onfocus: () => {
        focused = selectorOf(view, name);
      },
    }, shape("circle", { class: "handle-reach", cx, cy, r: REACH }), name.startsWith("Hole")
      ? shape("path", { class: "handle-mark", d: `M${cx - 5} ${cy}h10m-5 -5v10` })
      : shape("circle", { class: "handle-mark", cx, cy, r: 3.5 }));
  }

  function drawHandles() {
    const { holes = [], cracks = [] } = plate();
    const finite = (point) => point.every(Number.isFinite);
    handles = [];
    for (const view of drawing.views) {
      show(view.over,
        holes.map((hole, index) => finite([hole.x_mm, hole.y_mm]) && handle(view, `Hole ${index + 1}`, [hole.x_mm, hole.y_mm],
          (point) => edits.moveHole(index, point), () => edits.remove("holes", index))),
        cracks.flatMap((crack, index) => [["from_mm", "start"], ["to_mm", "end"]].map(([end, word]) => finite(crack[end]) &&
          handle(view, `Crack ${index + 1} ${word}`, crack[end], (point) => edits.moveCrack(index, end, point), () => edits.remove("cracks", index)))));
    }
    // Not out of a cell of the tables, where somebody is typing, nor from another button.
    if (document.activeElement !== document.body) focused = null;
    if (focused) canvas.querySelector(focused)?.focus({ preventScroll: true });
  }

  /** Has the service draw the plate as it is; one that it refuses stays as it was, the check says why. */
  const ask = debounce(async () => {
    const { files, ...own } = collect();
    const specimen = { ...own, ...(Object.keys(own).some((key) => key.startsWith("thickness")) ? {} : { thickness_mm: 1 }) };
    const isBare = !own.cracks?.length && !own.notches?.length;
    if (isBare) specimen.cracks = [hairline()];
    const wanted = JSON.stringify(specimen);
    // A part whose crack is being dragged would move away below the pointer.
    if (wanted === asked || drag?.view.svg.dataset.plate === "framed") return;
    asked = wanted;
    const checked = await postInput("/v1/check", { input: { specimen, ...REST }, files }).catch(() => null);
    if (!checked?.drawing || asked !== wanted) return;
    canvas.classList.toggle("bare", isBare);
    drawing.set(checked.drawing);
    drawHandles();
  }, WAIT_MS);

  /** A crack that does not show, at the left edge: the service checks no plate in which nothing can grow. */
  function hairline() {
    const { width_mm: width, diameter_mm: diameter, outline_mm: [[x, y] = []] = [] } = plate();
    const per = inShown(1, "mm");
    const [left, middle] = x === undefined ? [-(width || diameter) / 2, 0] : [x, y];
    return { from_mm: [left / per, middle / per], to_mm: [0.99 * left / per, 0.99 * middle / per] };
  }

  canvas.addEventListener("pointerdown", (event) => {
    const view = drawing.views.find(({ svg }) => svg.contains(event.target));
    if (!view) return;
    event.preventDefault();
    if (tool === "move") {
      // Handles may lie over each other: the nearest one is meant.
      const [x, y] = view.toPixels(view.toPlate(event));
      const off = ({ point }) => Math.hypot(view.toPixels(point)[0] - x, view.toPixels(point)[1] - y);
      const [nearest] = handles.filter((one) => one.view === view && off(one) < REACH).sort((one, other) => off(one) - off(other));
      if (!nearest) return;
      canvas.setPointerCapture(event.pointerId);
      focused = selectorOf(view, nearest.name);
      drag = { view, move: nearest.move, end: () => {} };
      return;
    }
    const from = snap(view.toPlate(event));
    if (tool === "hole") {
      edits.addHole(from);
      choose("move");
      return;
    }
    canvas.setPointerCapture(event.pointerId);
    const ghost = shape("line", { class: "plate-crack ghost" });
    view.svg.append(ghost);
    let to = from;
    drag = {
      view,
      move(point) {
        to = point;
        const [[x1, y1], [x2, y2]] = [view.toPixels(from), view.toPixels(to)];
        Object.entries({ x1, y1, x2, y2 }).forEach(([name, value]) => ghost.setAttribute(name, value));
      },
      end() {
        ghost.remove();
        // A tap is no crack.
        if (Math.hypot(to[0] - from[0], to[1] - from[1]) < grid()) return;
        edits.addCrack(from, to);
        choose("move");
      },
    };
  });
  canvas.addEventListener("pointermove", (event) => {
    if (!drag) return;
    const point = snap(drag.view.toPlate(event));
    say(point);
    drag.move(point);
  });
  const drop = () => {
    drag?.end();
    drag = null;
    ask();
  };
  canvas.addEventListener("pointerup", drop);
  canvas.addEventListener("pointercancel", drop);

  return {
    /** After the numbers have changed. */
    draw() {
      drawHandles();
      ask();
    },
  };
}

/** The next of 1, 2 or 5 times a power of ten. */
function stepOf(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= least * 0.9999);
}
