// A plate as the service draws it (`drawing` of a check, `plate.svg` of a result): its parts below each other, in the colors of the page, its ways of cracks up to a
// number of cycles. What is put over it has its places in mm.

import { shape, show } from "./dom.js";
import { plain } from "./format.js";
import { INCH, inShown, isUs } from "./units.js";

const STOPS = 5;

/** Color of a share of life, mixed between the stops of the style sheet. */
function colorOf(share) {
  const at = Math.min(0.9999, Math.max(0, share)) * (STOPS - 1);
  const first = Math.floor(at);
  return `color-mix(in oklab, var(--n${first}) ${(100 * (1 - at + first)).toFixed(0)}%, var(--n${first + 1}))`;
}

/** The scale bar of a part, of 1, 2 or 5 times a power of ten of an inch; `scale` is in pixels to a mm, `width` in pixels. */
function measureInInches(part, scale, width) {
  const most = (0.25 * width) / scale / INCH;
  const power = 10 ** Math.floor(Math.log10(most));
  const length = [5, 2, 1].map((digit) => digit * power).find((one) => one <= most) ?? power;
  for (const rule of part.querySelectorAll(".plate-rule")) {
    const [line, name] = ["polyline", "text"].map((tag) => rule.querySelector(tag));
    const [[x, top], [, y]] = line.getAttribute("points").split(" ").map((pair) => pair.split(",").map(Number));
    const end = x + length * INCH * scale;
    line.setAttribute("points", [[x, top], [x, y], [end, y], [end, top]].join(" "));
    name.setAttribute("x", end + 6);
    name.textContent = `${plain(length)} inch`;
  }
}

/** A part of the drawing: {svg, over, to(cycles), toPixels([x, y]), toPlate([x, y])}; `over` is drawn above it. */
function viewOf(part, name, sentence) {
  const [left, top, width, height] = part.dataset.box.split(" ").map(Number);
  const [scale, x0, y0] = part.dataset.mm.split(" ").map(Number);
  if (isUs) measureInInches(part, scale, width);
  const over = shape("g");
  const svg = shape("svg", { class: "plate", role: "img", "aria-label": sentence, "data-plate": name, viewBox: part.dataset.box, width, height }, part, over);
  const steps = [...part.querySelectorAll("[data-cycles]")].map((node) => ({ node, cycles: Number(node.dataset.cycles), tip: node.parentNode.dataset.tip }));
  const life = Math.max(...steps.map(({ cycles }) => cycles));
  const pieces = steps.filter(({ tip }) => tip !== undefined);
  const middle = ({ node }) => node.getAttribute("d").split("L")[1].split(" ").map(Number);
  for (const { node, cycles } of pieces) node.style.setProperty("--step", colorOf(cycles / life));
  const per = scale / inShown(1, "mm");
  return {
    svg, over, transform: `translate(${x0} ${y0}) scale(${scale} ${-scale})`,
    to(now) {
      for (const { node, cycles } of steps) node.classList.toggle("to-come", cycles > now + 0.1);
      for (const tip of part.querySelectorAll(".tip")) {
        const own = pieces.filter((piece) => piece.tip === tip.dataset.tip);
        if (own.length === 0) continue;
        const [[x, y], [endX, endY]] = [middle(own.findLast(({ cycles }) => cycles <= now + 0.1) ?? own[0]), middle(own.at(-1))];
        tip.setAttribute("transform", `translate(${x - endX} ${y - endY})`);
      }
    },
    toPixels: ([x, y]) => [x0 + x * per, y0 - y * per],
    /** Place on the plate at a place of the window, in the unit that is shown. */
    toPlate({ clientX, clientY }) {
      const box = svg.getBoundingClientRect();
      const zoom = box.width / width;
      return [((clientX - box.left) / zoom + left - x0) / per, (y0 - top - (clientY - box.top) / zoom) / per];
    },
  };
}

/** Gives {views, set(svg), to(cycles), grow(ways)}; `role` is that of the parts. */
export function createPlate(container, role = "img") {
  let now = Infinity;
  const plate = {
    views: [],
    /** The SVG as text. */
    set(text) {
      const drawn = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
      plate.views = [...drawn.querySelectorAll("g.view")].map((part, index) => viewOf(part, index === 0 ? "whole" : "framed", drawn.getAttribute("aria-label")));
      plate.views.forEach(({ svg }) => svg.setAttribute("role", role));
      show(container, plate.views.map(({ svg }) => svg));
      plate.to(now);
    },
    to(cycles) {
      now = cycles;
      plate.views.forEach((view) => view.to(cycles));
    },
    /** The whole plate with the ways of tips of a run that goes on, each a list of places in mm. */
    grow(ways) {
      plate.views.slice(1).forEach(({ svg }) => svg.remove());
      const [whole] = plate.views;
      if (whole) show(whole.over, ways.map((way) => shape("path", { class: "way growing", d: `M${way.join("L")}`, transform: whole.transform })));
    },
  };
  return plate;
}
