// The plate as a sketch to draw in: new cracks and holes by pointer, ends and centres to drag or to move by arrow keys.
// The tables have the numbers; the sketch only changes them.

import { button, element, shape, show } from "./dom.js";
import { plain } from "./format.js";
import { createStage, geometryOf } from "./plate_drawing.js";
import { unitShown } from "./units.js";

const TOOLS = [["move", "Move"], ["crack", "Draw a crack"], ["hole", "Place a hole"]];

const HINTS = {
  move: "",
  crack: "Drag from one crack end to the other.",
  hole: "Click to place the hole center.",
};

/**
 * `plate()` gives the specimen as it stands in the form; `edits` are {addCrack(from, to), addHole(x, y),
 * moveCrack(index, end, point), moveHole(index, point), remove(what, index)}.
 */
export function createSketch(container, { plate, edits }) {
  let tool = "move";
  let drag = null; // {move(point), end()}
  let focused = null; // name of the handle that has the focus, to give it back after a redraw

  const canvas = element("div");
  const buttons = TOOLS.map(([name, title]) => button(title, () => choose(name), {
    class: "button small", "aria-pressed": String(name === tool), "data-tool": name,
  }));
  const place = element("output", { class: "quiet sketch-place" }, "");
  show(container, element("div", { class: "tool-row", role: "group", "aria-label": "Sketch tools" }, buttons), canvas, place);
  const stage = createStage(canvas, { label: "Sketch of the plate. The tables below have the same numbers.", role: "group", drawMore: drawHandles });

  function choose(name) {
    tool = name;
    buttons.forEach((one) => one.setAttribute("aria-pressed", String(one.dataset.tool === name)));
    stage.svg.classList.toggle("drawing", name !== "move");
    place.textContent = HINTS[name];
  }

  const grid = () => stepOf(Math.max(plate().width_mm || 1, 1) / 200);
  const snap = ([x, y]) => [x, y].map((value) => Number((Math.round(value / grid()) * grid()).toFixed(6)));
  const inWords = (point) => ["x", "y"].map((axis, part) => `${axis} ${plain(point[part])} ${unitShown("mm")}`).join(", ");
  const say = (point) => {
    place.textContent = inWords(point);
  };

  function pointOf(event) {
    const box = stage.svg.getBoundingClientRect();
    return snap(stage.toMillimetres([event.clientX - box.left, event.clientY - box.top]));
  }

  function handle(name, point, move, remove) {
    const [cx, cy] = stage.toPixels(point);
    const key = (event) => {
      const step = grid() * (event.shiftKey ? 10 : 1);
      const way = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[event.key];
      if (event.key === "Delete" || event.key === "Backspace") remove();
      else if (way) {
        const next = snap([point[0] + way[0], point[1] + way[1]]);
        focused = name;
        move(next);
        say(next);
      } else return;
      event.preventDefault();
    };
    return shape("g", {
      class: "handle", tabindex: "0", role: "button", "data-handle": name,
      "aria-label": `${name}, ${inWords(point)}. Arrow keys move it, Delete removes it.`,
      onkeydown: key,
      onpointerdown: (event) => {
        if (tool !== "move") return;
        event.preventDefault();
        stage.svg.setPointerCapture(event.pointerId);
        focused = name;
        drag = { move, end: () => {} };
      },
    }, shape("circle", { class: "handle-reach", cx, cy, r: 16 }), name.startsWith("Hole")
      ? shape("path", { class: "handle-mark", d: `M${cx - 5} ${cy}h10m-5 -5v10` })
      : shape("circle", { class: "handle-mark", cx, cy, r: 3.5 }));
  }

  function drawHandles() {
    const { holes = [], cracks = [] } = plate();
    const finite = (point) => point.every(Number.isFinite);
    const had = stage.above.contains(document.activeElement) ? document.activeElement.dataset.handle : focused;
    show(stage.above,
      holes.map((hole, index) => finite([hole.x_mm, hole.y_mm]) && handle(`Hole ${index + 1}`, [hole.x_mm, hole.y_mm],
        (point) => edits.moveHole(index, point), () => edits.remove("holes", index))),
      cracks.flatMap((crack, index) => [["from_mm", "start"], ["to_mm", "end"]].map(([end, word]) => finite(crack[end]) &&
        handle(`Crack ${index + 1} ${word}`, crack[end], (point) => edits.moveCrack(index, end, point), () => edits.remove("cracks", index)))));
    focused = null;
    // Not out of a cell of the tables, where somebody is typing.
    if (!had || document.activeElement?.tagName === "INPUT") return;
    [...stage.above.children].find((node) => node.dataset.handle === had)?.focus({ preventScroll: true });
  }

  stage.svg.addEventListener("pointerdown", (event) => {
    if (tool === "move" || !stage.ready) return;
    event.preventDefault();
    const from = pointOf(event);
    if (tool === "hole") {
      edits.addHole(from);
      choose("move");
      return;
    }
    stage.svg.setPointerCapture(event.pointerId);
    const ghost = shape("line", { class: "plate-crack ghost" });
    stage.svg.append(ghost);
    let to = from;
    drag = {
      move(point) {
        to = point;
        const [[x1, y1], [x2, y2]] = [stage.toPixels(from), stage.toPixels(to)];
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
  stage.svg.addEventListener("pointermove", (event) => {
    if (!drag) return;
    const point = pointOf(event);
    say(point);
    drag.move(point);
  });
  const drop = () => {
    drag?.end();
    drag = null;
  };
  stage.svg.addEventListener("pointerup", drop);
  stage.svg.addEventListener("pointercancel", drop);

  return {
    /** After the numbers have changed. */
    draw() {
      stage.setGeometry(geometryOf({ ...plate(), kind: "plate" }));
    },
  };
}

/** The next of 1, 2 or 5 times a power of ten. */
function stepOf(least) {
  const power = 10 ** Math.floor(Math.log10(least));
  return power * [1, 2, 5, 10].find((factor) => factor * power >= least * 0.9999);
}
