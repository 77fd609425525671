// Charts of our own: lines, points and bands on linear or logarithmic axes, as SVG. A chart can be read by pointer, by
// arrow keys (with a readout that is spoken) and as a table.

import { domainOf, scaleOf } from "./chart_scale.js";
import { button, element, shape, show, table, uniqueId } from "./dom.js";
import { significant } from "./format.js";

const TONES = 8;
const TABLE_ROWS = 400;
const POINTER_REACH = 48;
const HINT = "Point at the curve, or focus it and use the arrow keys, to read values.";
// Told apart without colour too: every tone has its own marker and, on lines, its own dashes.
const DASHES = ["", "7 4", "2 3", "9 3 2 3", "12 5", "4 2", "1 4", "9 3 2 3 2 3"];

function marker(kind, x, y, r) {
  const [left, top, side] = [x - r, y - r, 2 * r];
  switch (kind % 5) {
    case 0: return `M${left} ${y}a${r} ${r} 0 1 0 ${side} 0a${r} ${r} 0 1 0 ${-side} 0z`;
    case 1: return `M${left} ${top}h${side}v${side}h${-side}z`;
    case 2: return `M${left} ${y + r}h${side}L${x} ${top}z`;
    case 3: return `M${left} ${y}L${x} ${top}L${x + r} ${y}L${x} ${y + r}z`;
    default: return `M${left} ${top}h${side}L${x} ${y + r}z`;
  }
}

const short = (value) => Math.round(value * 10) / 10;

/**
 * Builds a chart in `container`. An axis is {label, unit, scale: "linear" | "log", from, to, format}; a series is
 * {id, name, kind: "line" | "points" | "band" | "rule", x, y, tone, dashed}; a band has a second edge x2, y2; a rule is an
 * upright line at x[0]. Gives {set(series), extend(id, x, y), destroy()}.
 */
export function createChart(container, { name, label, x: xAxis, y: yAxis, ratio = 0.58 }) {
  let series = [];
  let size = { width: 0, height: 0 };
  let place = null; // scales of the last drawing
  let cursor = null; // {id, index}
  let axesKey = "";
  let frame = 0;
  const hidden = new Set();
  const drawn = new Map();

  const hintId = uniqueId("chart-hint");
  const axes = shape("g", { class: "chart-axes" });
  const marks = shape("g");
  const crosshair = shape("g", { class: "chart-cursor", visibility: "hidden" },
    shape("line"), shape("line"), shape("circle", { r: 5 }));
  const svg = shape("svg", { tabindex: "0", role: "application", "aria-roledescription": "chart", "aria-label": label, "aria-describedby": hintId },
    axes, marks, crosshair);
  const legend = element("ul", { class: "chart-legend", "aria-label": "Legend: press to hide or show a curve" });
  const readout = element("p", { class: "chart-readout", "aria-live": "polite", id: hintId }, HINT);
  const sheet = element("div", { hidden: true });
  const toggle = button("Show as table", toggleTable, { class: "button small", "aria-expanded": "false" });
  const plot = element("div", { class: "chart-plot" }, svg);
  const figure = element("figure", { class: "chart", "data-chart": name },
    element("div", { class: "chart-head" }, legend, toggle), plot, readout, sheet);
  show(container, figure);

  const observer = new ResizeObserver(([entry]) => {
    const width = Math.floor(entry.contentRect.width);
    if (width === size.width || width === 0) return;
    size = { width, height: Math.round(Math.min(Math.max(width * ratio, 240), 430)) };
    svg.setAttribute("width", size.width);
    svg.setAttribute("height", size.height);
    draw();
  });
  observer.observe(plot);

  const visible = () => series.filter((one) => !hidden.has(one.id));
  const readable = () => visible().filter((one) => (one.kind === "line" || one.kind === "points") && one.x.length > 0);
  const format = (axis, value) => `${(axis.format ?? significant)(value)}${axis.unit ? ` ${axis.unit}` : ""}`;

  /** Many calls between two frames make one drawing. */
  function schedule() {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(draw);
  }

  function draw() {
    if (size.width === 0) return;
    const shown = visible();
    const ends = (axis, first, second) => domainOf(shown.flatMap((one) => [one[first], one[second] ?? []]), axis.scale, axis);
    const domains = [ends(xAxis, "x", "x2"), ends(yAxis, "y", "y2")];
    drawAxes(domains);
    for (const [id, node] of drawn) {
      if (!shown.some((one) => one.id === id)) {
        node.remove();
        drawn.delete(id);
      }
    }
    for (const one of shown) drawSeries(one);
    drawCursor();
  }

  function drawAxes(domains) {
    const rows = Math.max(3, Math.floor(size.height / 56));
    const probe = scaleOf(yAxis.scale, domains[1], [0, 1]).ticks(rows);
    const left = 14 + 7.2 * Math.max(...probe.map((tick) => tick.label.length), 2);
    // The last label across stands half beyond the axis.
    const frameOf = { left, right: size.width - 32, top: 28, bottom: size.height - 42 };
    place = {
      ...frameOf,
      x: scaleOf(xAxis.scale, domains[0], [frameOf.left, frameOf.right]),
      y: scaleOf(yAxis.scale, domains[1], [frameOf.bottom, frameOf.top]),
    };
    const key = JSON.stringify([domains, size]);
    if (key === axesKey) return;
    axesKey = key;
    const across = spaced(place.x.ticks(Math.max(2, Math.floor((frameOf.right - left) / 84))), place.x);
    const up = place.y.ticks(rows);
    const title = (axis) => (axis.unit ? `${axis.label}, ${axis.unit}` : axis.label);
    show(axes,
      across.map(({ value, label: text }) => [
        shape("line", { x1: short(place.x.at(value)), x2: short(place.x.at(value)), y1: place.top, y2: place.bottom, class: "grid" }),
        shape("text", { x: short(place.x.at(value)), y: place.bottom + 17, "text-anchor": "middle" }, text)]),
      up.map(({ value, label: text }) => [
        shape("line", { x1: place.left, x2: place.right, y1: short(place.y.at(value)), y2: short(place.y.at(value)), class: "grid" }),
        shape("text", { x: place.left - 8, y: short(place.y.at(value)) + 4, "text-anchor": "end" }, text)]),
      shape("path", { class: "axis", d: `M${place.left} ${place.top}V${place.bottom}H${place.right}` }),
      shape("text", { class: "axis-title", x: place.right, y: size.height - 6, "text-anchor": "end" }, title(xAxis)),
      shape("text", { class: "axis-title", x: 2, y: 14 }, title(yAxis)));
  }

  /** Labels that would run into each other give way, those between the decades first. */
  function spaced(ticks, scale) {
    const kept = [];
    for (const tick of [...ticks].sort((first, second) => second.strong - first.strong)) {
      const clear = kept.every((other) => Math.abs(scale.at(tick.value) - scale.at(other.value)) > 4 * (tick.label.length + other.label.length) + 8);
      if (clear && tick.label) kept.push(tick);
    }
    return ticks.map((tick) => (kept.includes(tick) ? tick : { ...tick, label: "" }));
  }

  function drawSeries(one) {
    let node = drawn.get(one.id);
    if (!node) {
      node = shape("path", { class: `series ${one.kind} tone-${one.tone % TONES}`, "data-series": one.id });
      if (one.kind === "line" && one.dashed) node.setAttribute("stroke-dasharray", DASHES[one.tone % TONES]);
      drawn.set(one.id, node);
      if (one.kind === "band") marks.prepend(node);
      else marks.append(node);
    }
    node.setAttribute("d", outline(one));
  }

  function outline(one) {
    if (one.kind === "rule") return one.x.length > 0 ? `M${short(place.x.at(one.x[0]))} ${place.top}V${place.bottom}` : "";
    if (one.kind === "points") {
      const radius = one.x.length > 300 ? 1.5 : 3.5;
      return pixels(one.x, one.y, 0).map(([x, y]) => (Number.isFinite(x + y) ? marker(one.tone, x, y, radius) : "")).join("");
    }
    if (one.kind === "band") {
      const edge = [...pixels(one.x, one.y, 0.5), ...pixels(one.x2, one.y2, 0.5).reverse()].filter(([x, y]) => Number.isFinite(x + y));
      return edge.length > 2 ? `M${edge.map((point) => point.join(" ")).join("L")}z` : "";
    }
    let pen = "M";
    return pixels(one.x, one.y, 0.7).map(([x, y]) => {
      if (!Number.isFinite(x + y)) {
        pen = "M"; // unknown values leave a gap
        return "";
      }
      const step = `${pen}${x} ${y}`;
      pen = "L";
      return step;
    }).join("");
  }

  /** Places on the screen, thinned to steps of `least` pixels: a run of 30 000 blocks draws as fast as one of 300. */
  function pixels(xs, ys, least) {
    const result = [];
    let [lastX, lastY] = [Infinity, Infinity];
    for (let index = 0; index < xs.length; index += 1) {
      const [x, y] = [short(place.x.at(xs[index])), short(place.y.at(ys[index]))];
      const near = Math.abs(x - lastX) < least && Math.abs(y - lastY) < least;
      if (near && index < xs.length - 1) continue;
      result.push([x, y]);
      [lastX, lastY] = [x, y];
    }
    return result;
  }

  function drawCursor() {
    const one = cursor && readable().find((candidate) => candidate.id === cursor.id);
    const index = one ? Math.min(cursor.index, one.x.length - 1) : -1;
    const [x, y] = one ? [place.x.at(one.x[index]), place.y.at(one.y[index])] : [NaN, NaN];
    const seen = Number.isFinite(x + y);
    crosshair.setAttribute("visibility", seen ? "visible" : "hidden");
    if (!seen) return;
    const [upright, level, ring] = crosshair.children;
    const set = (node, values) => Object.entries(values).forEach(([key, value]) => node.setAttribute(key, short(value)));
    set(upright, { x1: x, x2: x, y1: place.top, y2: place.bottom });
    set(level, { x1: place.left, x2: place.right, y1: y, y2: y });
    set(ring, { cx: x, cy: y });
    const words = `${one.name}: ${xAxis.label} ${format(xAxis, one.x[index])}, ${yAxis.label} ${format(yAxis, one.y[index])}`;
    if (readout.textContent !== words) readout.textContent = words;
  }

  function moveCursor(next) {
    cursor = next;
    drawCursor();
    if (!next) readout.textContent = HINT;
  }

  function nearest(px, py, candidates, acrossOnly = false) {
    let best = { distance: Infinity };
    for (const one of candidates) {
      for (let index = 0; index < one.x.length; index += 1) {
        const [dx, dy] = [place.x.at(one.x[index]) - px, acrossOnly ? 0 : place.y.at(one.y[index]) - py];
        const distance = Math.hypot(dx, dy);
        if (distance < best.distance) best = { distance, id: one.id, index };
      }
    }
    return best;
  }

  svg.addEventListener("pointermove", (event) => {
    if (!place) return;
    const box = svg.getBoundingClientRect();
    const found = nearest(event.clientX - box.left, event.clientY - box.top, readable());
    if (found.distance < POINTER_REACH) moveCursor({ id: found.id, index: found.index });
  });

  svg.addEventListener("keydown", (event) => {
    const lines = readable();
    if (!place || lines.length === 0) return;
    const at = Math.max(0, lines.findIndex((one) => one.id === cursor?.id));
    const one = lines[at];
    const index = cursor?.id === one.id ? Math.min(cursor.index, one.x.length - 1) : -1;
    const last = one.x.length - 1;
    const leap = Math.max(1, Math.round(last / 10));
    const steps = { ArrowRight: index + 1, ArrowLeft: index - 1, PageUp: index + leap, PageDown: index - leap, Home: 0, End: last };
    const turn = { ArrowUp: -1, ArrowDown: 1 }[event.key];
    if (event.key in steps) {
      moveCursor({ id: one.id, index: Math.min(Math.max(steps[event.key], 0), last) });
    } else if (turn) {
      const other = lines[(at + turn + lines.length) % lines.length];
      moveCursor(index < 0 ? { id: one.id, index: 0 } : { id: other.id, index: nearest(place.x.at(one.x[index]), 0, [other], true).index ?? 0 });
    } else if (event.key === "Escape" && cursor) {
      moveCursor(null);
    } else {
      return;
    }
    event.preventDefault();
  });

  function drawLegend() {
    show(legend, series.map((one) => {
      const sample = shape("svg", { width: 26, height: 14, "aria-hidden": "true" }, swatch(one));
      const press = button([sample, one.name], () => {
        if (!hidden.delete(one.id)) hidden.add(one.id);
        press.setAttribute("aria-pressed", String(!hidden.has(one.id)));
        schedule();
      }, { class: null, "aria-pressed": String(!hidden.has(one.id)) });
      return element("li", null, press);
    }));
  }

  function swatch(one) {
    const attributes = { class: `series ${one.kind} tone-${one.tone % TONES}` };
    if (one.kind === "points") return shape("path", { ...attributes, d: marker(one.tone, 13, 7, 4) });
    if (one.kind === "band") return shape("path", { ...attributes, d: "M1 2h24v10h-24z" });
    if (one.kind === "rule") return shape("path", { ...attributes, d: "M13 0v14" });
    return shape("path", { ...attributes, d: "M1 7h24", "stroke-dasharray": one.dashed ? DASHES[one.tone % TONES] : null });
  }

  function toggleTable() {
    sheet.hidden = !sheet.hidden;
    toggle.setAttribute("aria-expanded", String(!sheet.hidden));
    toggle.textContent = sheet.hidden ? "Show as table" : "Hide table";
    drawTable();
  }

  function drawTable() {
    if (sheet.hidden) return;
    const curves = visible().filter((one) => one.kind !== "rule");
    const perCurve = Math.max(20, Math.floor(TABLE_ROWS / Math.max(1, curves.length)));
    let thinned = false;
    const rows = curves.flatMap((one) => {
      const stride = Math.ceil(one.x.length / perCurve);
      thinned ||= stride > 1;
      const row = (values, others, index) => format({ ...values, unit: "" }, others[index]);
      return one.x.map((_, index) => index).filter((index) => index % stride === 0 || index === one.x.length - 1).map((index) => {
        const range = (axis, first, second) => (one.kind === "band" && second[index] !== first[index]
          ? `${row(axis, first, index)} to ${row(axis, second, index)}` : row(axis, first, index));
        return [one.name, range(xAxis, one.x, one.x2), range(yAxis, one.y, one.y2)];
      });
    });
    const columns = [{ title: "Curve" }, ...[xAxis, yAxis].map((axis) => ({ title: axis.label, unit: axis.unit, numeric: true }))];
    show(sheet, table(thinned ? `${label} (every row is in the download; here a selection)` : label, columns, rows));
  }

  return {
    /** Replaces all curves; those that were hidden stay hidden. */
    set(next) {
      const names = (list) => JSON.stringify(list.map((one) => [one.id, one.name, one.kind, one.tone]));
      const same = names(next) === names(series);
      series = next;
      if (!same) {
        drawn.forEach((node) => node.remove());
        drawn.clear();
        drawLegend();
      }
      drawTable();
      schedule();
    },
    /** Adds points at the end of one curve. */
    extend(id, xs, ys) {
      const one = series.find((candidate) => candidate.id === id);
      xs.forEach((value, index) => {
        one.x.push(value);
        one.y.push(ys[index]);
      });
      schedule();
    },
    destroy() {
      observer.disconnect();
      cancelAnimationFrame(frame);
    },
  };
}
