// The plate of a result: outline, holes, slots, pins and loads as the service says them (`plate` of a check and of a result), and the ways of its crack tips coloured by
// cycles. `to(cycles)` shows it at a moment: what has grown in colour, what is to come dotted.

import { shape as node, show, uniqueId } from "./dom.js";
import { inShown, unitShown } from "./units.js";

const STOPS = 5;
const MARKS = [0.25, 0.5, 0.75, 0.9];
const MARGIN = 36; // for load arrows
const LINE = 15; // of words above the plate
const LETTER = 6.8; // width of a letter there
const WORD = 34; // room of a mark's words
const HEIGHT_MAX = 380;
const BAR = 24; // for the rule

/** Colour of a share of life, mixed between the stops of the style sheet. */
function colourOf(share) {
  const at = Math.min(0.9999, Math.max(0, share)) * (STOPS - 1);
  const first = Math.floor(at);
  return `color-mix(in oklab, var(--n${first}) ${(100 * (1 - at + first)).toFixed(0)}%, var(--n${first + 1}))`;
}

const boxOf = (points) => [Math.min(...points.map((p) => p[0])), Math.min(...points.map((p) => p[1])),
  Math.max(...points.map((p) => p[0])), Math.max(...points.map((p) => p[1]))];

/** Loads of pins have one place. */
const isPin = ({ from_mm: from, to_mm: to }) => from[0] === to[0] && from[1] === to[1];

/** Place on a path of [cycles, x, y] at a number of cycles. */
export function at(path, cycles) {
  const next = path.findIndex((point) => point[0] >= cycles && point[0] > 0);
  if (next <= 0) return path[next < 0 ? path.length - 1 : 0];
  const [from, to] = [path[next - 1], path[next]];
  const share = to[0] === from[0] ? 1 : Math.max(0, (cycles - from[0]) / (to[0] - from[0]));
  return from.map((value, index) => value + share * (to[index] - value));
}

/** The part that cracks and their ways take, with air around it; null where that is most of the plate. */
function frameOf(shape, paths) {
  const points = [...shape.cracks_mm.flat(), ...paths.flat().map((point) => point.slice(1))];
  if (points.length === 0) return null;
  const whole = boxOf(shape.outline_mm);
  const box = boxOf(points);
  const air = Math.max(0.15 * (box[2] - box[0]), 0.15 * (box[3] - box[1]), 0.03 * (whole[2] - whole[0]));
  const frame = [Math.max(whole[0], box[0] - air), Math.max(whole[1], box[1] - air), Math.min(whole[2], box[2] + air), Math.min(whole[3], box[3] + air)];
  const height = Math.max(frame[3] - frame[1], 0.3 * (frame[2] - frame[0]));
  const middle = 0.5 * (frame[1] + frame[3]);
  [frame[1], frame[3]] = [Math.max(whole[1], middle - 0.5 * height), Math.min(whole[3], middle + 0.5 * height)];
  const share = ((frame[2] - frame[0]) * (frame[3] - frame[1])) / ((whole[2] - whole[0]) * (whole[3] - whole[1]));
  return share < 0.5 ? frame : null;
}

/** Draws the whole plate, no higher than `height` pixels, and the part with the cracks below where they are small in it. Gives {set(plate, paths, life), to(cycles), destroy()}. */
export function createPlatePath(container, label, height = HEIGHT_MAX) {
  let now = null;
  let data = null;
  const views = [createView(label, true, height), createView(`${label}: the framed part`, false, height)];
  show(container, views.map((view) => view.svg));
  const observer = new ResizeObserver(draw);
  observer.observe(container);

  function draw() {
    const width = Math.floor(container.clientWidth);
    if (!data || width === 0) return;
    const frame = frameOf(data.shape, data.paths);
    views[0].draw(data, boxOf(data.shape.outline_mm), frame, width);
    views[1].svg.style.display = frame ? "block" : "none";
    if (frame) views[1].draw(data, frame, null, width);
    views.forEach((view) => view.to(now ?? data.life));
  }

  return {
    /** `paths`: of every tip its points [cycles, x, y], mm. */
    set(shape, paths, life) {
      data = shape && { shape, paths: paths.filter((path) => path.length > 0), life };
      draw();
    },
    to(cycles) {
      now = cycles;
      if (data) views.forEach((view) => view.to(cycles));
    },
    destroy: () => observer.disconnect(),
  };
}

function createView(label, isWhole, heightMax) {
  const [base, grown, words] = [node("g"), node("g"), node("g")];
  const clip = node("clipPath", { id: uniqueId("framed-plate") });
  const svg = node("svg", { role: "img", "aria-label": label, "data-plate": isWhole ? "whole" : "framed" }, node("defs", null, clip), base, grown, words);
  let data = null;
  let pixel = null;
  let lines = []; // words of the load
  if (!isWhole) [base, grown].forEach((group) => group.setAttribute("clip-path", `url(#${clip.id})`));
  const line = (points) => `M${points.map((point) => pixel(point).map((value) => value.toFixed(1)).join(" ")).join("L")}`;

  function draw(next, box, frame, width) {
    data = next;
    const { shape } = data;
    lines = isWhole ? inLines(shape.load, width) : [];
    const margin = isWhole ? MARGIN + LINE * (lines.length - 1) : 1;
    const scale = Math.min((width - 2 * margin) / (box[2] - box[0]), heightMax / (box[3] - box[1]));
    const [across, up] = [(box[2] - box[0]) * scale, (box[3] - box[1]) * scale];
    const left = (width - across) / 2;
    pixel = ([x, y]) => [left + (x - box[0]) * scale, margin + (box[3] - y) * scale];
    const height = Math.round(up + 2 * margin + BAR);
    svg.setAttribute("width", width);
    svg.setAttribute("height", height);
    show(clip, node("rect", { x: left, y: margin, width: across, height: up }));
    show(base,
      !isWhole && node("rect", { class: "window", x: left, y: margin, width: across, height: up }),
      node("path", { class: "plate-body", d: `${line(shape.outline_mm)}z` }),
      shape.holes.map((hole) => holeOf(hole, scale)),
      shape.loads.filter(isPin).flatMap((load) => pinOf(load, scale)).flat(),
      shape.slots_mm.map((slot) => node("path", { class: "plate-hole", d: `${line(slot)}z` })),
      isWhole && [arrows(shape), holds(shape), frame && node("path", { class: "frame", d: `${line([[frame[0], frame[1]], [frame[2], frame[1]], [frame[2], frame[3]], [frame[0], frame[3]]])}z` })],
      ruleOf(scale, left, height, box[2] - box[0]));
  }

  function holeOf({ x_mm: x, y_mm: y, diameter_mm: diameter }, scale) {
    const [cx, cy] = pixel([x, y]);
    return node("circle", { class: "plate-hole", cx, cy, r: (diameter / 2) * scale });
  }

  /** A pin that presses on the rim of its hole, and its way. */
  function pinOf({ from_mm: at, direction }, scale) {
    const hole = data.shape.holes.find((one) => Math.hypot(one.x_mm - at[0], one.y_mm - at[1]) < 1e-6);
    const [[cx, cy], r] = [pixel(at), ((hole?.diameter_mm ?? 0) / 2) * scale];
    const [dx, dy] = [direction[0], -direction[1]];
    return [node("circle", { class: "plate-pin", cx: cx + dx, cy: cy + dy, r: Math.max(r - 2, 1) }),
      arrow([cx + dx * (r + 3), cy + dy * (r + 3)], [dx, dy], 16)];
  }

  /** An arrow from a place, pixels. */
  function arrow([x, y], [dx, dy], length) {
    const [ex, ey] = [x + dx * length, y + dy * length];
    const side = (sign) => `${ex - 6 * dx - sign * 3.5 * dy} ${ey - 6 * dy + sign * 3.5 * dx}`;
    return [node("line", { class: "plate-load", x1: x, y1: y, x2: ex - 5 * dx, y2: ey - 5 * dy }),
      node("path", { class: "load-head", d: `M${ex} ${ey}L${side(1)}L${side(-1)}z` })];
  }

  /** Loads of straight edges, and what they are, once. */
  function arrows(shape) {
    const drawn = shape.loads.filter((load) => !isPin(load)).flatMap(({ from_mm: from, to_mm: to, direction }) => {
      const way = [direction[0], -direction[1]];
      const length = Math.hypot(to[0] - from[0], to[1] - from[1]);
      const [a, b] = [pixel(from), pixel(to)];
      const number = Math.max(2, Math.min(7, Math.round(Math.hypot(b[0] - a[0], b[1] - a[1]) / 50)));
      return length > 0 ? Array.from({ length: number }, (_, index) => {
        const share = (index + 0.5) / number;
        return arrow([a[0] + share * (b[0] - a[0]) + 3 * way[0], a[1] + share * (b[1] - a[1]) + 3 * way[1]], way, 15);
      }).flat() : [];
    });
    const [middle, top] = pixel([0.5 * (boxOf(shape.outline_mm)[0] + boxOf(shape.outline_mm)[2]), boxOf(shape.outline_mm)[3]]);
    return [...drawn, ...lines.map((text, index) => node("text", { class: "strong", x: middle, y: top - 24 - LINE * (lines.length - 1 - index), "text-anchor": "middle" }, text))];
  }

  /** Words in two lines, parted at a comma near their middle, where they are too long for one. */
  function inLines(text, width) {
    const commas = [...text.matchAll(/, /g)].map(({ index }) => index);
    if (LETTER * text.length < width || commas.length === 0) return [text];
    const [at] = commas.sort((one, other) => Math.abs(one - text.length / 2) - Math.abs(other - text.length / 2));
    return [text.slice(0, at + 1), text.slice(at + 2)];
  }

  /** Held stretches are hatched. */
  function holds(shape) {
    return shape.held_mm.flatMap(([from, to]) => {
      const [a, b] = [pixel(from), pixel(to)];
      const length = Math.hypot(b[0] - a[0], b[1] - a[1]);
      return Array.from({ length: Math.floor(length / 8) }, (_, index) => {
        const [x, y] = [a[0] + ((b[0] - a[0]) * 8 * index) / length, a[1] + ((b[1] - a[1]) * 8 * index) / length];
        return node("line", { class: "plate-load", x1: x + 5, y1: y, x2: x - 1, y2: y + (a[1] < svg.height.baseVal.value / 2 ? -7 : 7) });
      });
    });
  }

  function ruleOf(pixels, left, height, whole) {
    const per = inShown(1, "mm");
    const [scale, span] = [pixels / per, whole * per];
    const power = 10 ** Math.floor(Math.log10(0.28 * span));
    const length = [5, 2, 1].map((factor) => factor * power).find((value) => value <= 0.28 * span);
    return node("g", { class: "plate-rule" }, node("path", { d: `M${left + 0.5} ${height - 11}v5h${length * scale}v-5` }),
      node("text", { x: left + length * scale + 6, y: height - 6 }, `${length} ${unitShown("mm")}`));
  }

  function to(cycles) {
    if (!pixel) return;
    const { shape, paths, life } = data;
    const lines = [];
    const above = [];
    paths.forEach((path, number) => {
      const tip = at(path, cycles);
      const coming = [tip, ...path.filter((point) => point[0] > cycles)];
      if (coming.length > 1) lines.push(node("path", { class: "to-come", d: line(coming.map((point) => point.slice(1))) }));
      const past = [...path.filter((point) => point[0] <= cycles && point[0] > 0), tip];
      let last = path.filter((point) => point[0] === 0).at(-1) ?? path[0];
      for (const point of past) {
        if (point === last) continue;
        const piece = node("path", { class: "path", d: line([last.slice(1), point.slice(1)]) });
        piece.style.stroke = colourOf((last[0] + point[0]) / 2 / life);
        lines.push(piece);
        last = point;
      }
      if (!isWhole) above.push(...marksOf(path, cycles, number === 0));
      const [cx, cy] = pixel(tip.slice(1));
      above.push(node("circle", { class: "dot", cx, cy, r: isWhole ? 3.5 : 5 }));
      if (paths.length > 1) above.push(node("text", { class: "halo strong", x: cx + 8, y: cy - 8 }, String(number)));
    });
    lines.push(...shape.cracks_mm.map((crack) => node("path", { class: "flaw", d: line(crack) })));
    show(grown, lines);
    show(words, above);
  }

  /** Places of a tip at shares of the life; of the first one in words, where there is room for them. */
  function marksOf(path, cycles, isNamed) {
    if (!(data.life > 0)) return [];
    const ends = { "-1": -Infinity, 1: -Infinity }; // of the words above and below
    return MARKS.map((share, index) => {
      const [x, y] = pixel(at(path, share * data.life).slice(1));
      const side = index % 2 === 0 ? 1 : -1;
      const hasRoom = isNamed && Math.abs(x - ends[side]) > WORD;
      if (hasRoom) ends[side] = x;
      return node("g", { opacity: share * data.life <= cycles ? 1 : 0.45 },
        hasRoom && node("path", { class: "leader", d: `M${x} ${y}v${30 * side}` }),
        node("circle", { class: "dot", cx: x, cy: y, r: 2.5 }),
        hasRoom && node("text", { class: "strong halo", x, y: y + 30 * side + (side > 0 ? 13 : -4), "text-anchor": "middle" }, `${Math.round(100 * share)} %`));
    });
  }

  return { svg, draw, to };
}
