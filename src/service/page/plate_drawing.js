// A plate to draw in, to scale: outline, holes, notches, cracks.

import { button, element, shape, show } from "./dom.js";
import { unitShown } from "./units.js";

const MARGIN = 30;
const HEIGHT_MAX = 430;
const RULE_STRIP = 16; // below the picture, so that the rule never covers the load

/** Outline, holes, cracks and notches of a plate of the input file, mm. Null when sizes are missing. */
export function geometryOf(specimen) {
  const { width_mm: w, length_mm: l, diameter_mm: d } = specimen;
  const strip = [[-w / 2, -l / 2], [w / 2, -l / 2], [w / 2, l / 2], [-w / 2, l / 2]];
  const outline = specimen.outline_mm ?? (d > 0 ? disc(d / 2) : w > 0 && l > 0 ? strip : null);
  return outline && { outline, holes: specimen.holes ?? [], cracks: straightCracks(specimen.cracks ?? []), notches: specimen.notches ?? [] };
}

/** Cracks with bends as straight ones that share their corners, which are joined. */
export function straightCracks(cracks) {
  return cracks.flatMap((crack) => crack.path_mm?.slice(1).map((to_mm, index) => ({ from_mm: crack.path_mm[index], to_mm })) ?? [crack]);
}

function disc(radius) {
  return Array.from({ length: 90 }, (_, index) => [radius * Math.cos((index * Math.PI) / 45), radius * Math.sin((index * Math.PI) / 45)]);
}

function boxOf(points) {
  const box = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
  for (const [x, y] of points) {
    box.left = Math.min(box.left, x);
    box.right = Math.max(box.right, x);
    box.bottom = Math.min(box.bottom, y);
    box.top = Math.max(box.top, y);
  }
  return box;
}

/** Part of the plate with its cracks and holes, and air around them; never more than the plate. */
function closeBox(geometry) {
  const points = [...geometry.cracks, ...geometry.notches].flatMap((one) => [one.from_mm, one.to_mm])
    .filter((point) => Number.isFinite(point[0] + point[1]));
  const whole = boxOf(geometry.outline);
  if (points.length === 0) return whole;
  const box = boxOf(points);
  const air = Math.max(0.6 * Math.max(box.right - box.left, box.top - box.bottom), 0.04 * (whole.right - whole.left));
  return {
    left: Math.max(whole.left, box.left - air), right: Math.min(whole.right, box.right + air),
    bottom: Math.max(whole.bottom, box.bottom - air), top: Math.min(whole.top, box.top + air),
  };
}

/** An SVG that fits a plate into its container. `drawMore(stage)` draws over the plate. */
export function createStage(container, { label, role = "img", drawMore }) {
  let geometry = null;
  let width = 0;
  let close = false;
  let view = null;
  const base = shape("g");
  const above = shape("g");
  const svg = shape("svg", { class: "plate", role, "aria-label": label }, base, above);
  const zoom = button("Zoom to the cracks", () => {
    close = !close;
    zoom.setAttribute("aria-pressed", String(close));
    draw();
  }, { class: "button small", "aria-pressed": "false" });
  const holder = element("div", { class: "plate-holder" }, svg);
  show(container, holder, element("div", { class: "plate-tools" }, zoom));

  const observer = new ResizeObserver(([entry]) => {
    const next = Math.floor(entry.contentRect.width);
    if (next === width || next === 0) return;
    width = next;
    draw();
  });
  observer.observe(holder);

  const stage = {
    svg, above,
    setGeometry(next) {
      geometry = next;
      draw();
    },
    draw,
    toPixels: ([x, y]) => [view.x + (x - view.box.left) * view.scale, view.y + (view.box.top - y) * view.scale],
    toMillimetres: ([px, py]) => [(px - view.x) / view.scale + view.box.left, view.box.top - (py - view.y) / view.scale],
    get ready() {
      return view !== null;
    },
    destroy: () => observer.disconnect(),
  };

  function draw() {
    if (!geometry || width === 0) {
      view = null;
      show(base);
      show(above);
      svg.setAttribute("height", 0);
      return;
    }
    const box = close ? closeBox(geometry) : boxOf(geometry.outline);
    const [across, up] = [box.right - box.left, box.top - box.bottom];
    const room = width - 2 * MARGIN;
    const height = Math.min(Math.max((room * up) / across, 150), HEIGHT_MAX - 2 * MARGIN) + 2 * MARGIN;
    const scale = Math.min(room / across, (height - 2 * MARGIN) / up);
    view = { box, scale, x: (width - across * scale) / 2, y: (height - up * scale) / 2 };
    svg.setAttribute("width", width);
    svg.setAttribute("height", Math.round(height) + RULE_STRIP);
    drawPlate();
    drawMore(stage);
  }

  const at = (point) => stage.toPixels(point).map((value) => Math.round(value * 10) / 10);
  const polygon = (points) => `M${points.map((point) => at(point).join(" ")).join("L")}z`;
  const line = (one, attributes) => {
    const [[x1, y1], [x2, y2]] = [at(one.from_mm), at(one.to_mm)];
    return shape("line", { x1, y1, x2, y2, ...attributes });
  };
  const whole = (one) => [...one.from_mm, ...one.to_mm].every(Number.isFinite);

  function drawPlate() {
    const { outline, holes, cracks, notches } = geometry;
    show(base,
      shape("path", { class: "plate-body", d: polygon(outline) }),
      holes.filter((hole) => hole.diameter_mm > 0 && Number.isFinite(hole.x_mm + hole.y_mm)).map((hole) => {
        const [cx, cy] = at([hole.x_mm, hole.y_mm]);
        return shape("circle", { class: "plate-hole", cx, cy, r: (hole.diameter_mm / 2) * view.scale });
      }),
      notches.filter(whole).map((notch) => line(notch, { class: "plate-notch", "stroke-width": notch.width_mm * view.scale })),
      cracks.filter(whole).map((crack) => line(crack, { class: "plate-crack" })),
      rule());
  }

  /** A length to measure by, as long as about a quarter of the picture. */
  function rule() {
    const length = 10 ** Math.floor(Math.log10((width * 0.3) / view.scale));
    const best = [5, 2, 1].map((factor) => factor * length).find((candidate) => candidate * view.scale <= width * 0.3);
    const end = Number(svg.getAttribute("height")) - 4;
    return shape("g", { class: "plate-rule" },
      shape("path", { d: `M4 ${end - 5}v5h${best * view.scale}v-5` }),
      shape("text", { x: 8 + best * view.scale, y: end }, `${best} ${unitShown("mm")}`));
  }

  return stage;
}
