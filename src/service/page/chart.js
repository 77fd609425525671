// Charts: lines, points, bands, limits and what is not known, on linear or logarithmic axes, as SVG. Scales, ticks and smooth curves are those
// of d3-scale and d3-shape (vendor/d3.js). A chart is read by pointer, by arrow keys (with a readout that is spoken) and as a table.

import { button, element, shape, show, table, uniqueId } from "./dom.js";
import { plain, powerOf, significant, whole } from "./format.js";
import { axisShown } from "./units.js";

const { d3 } = window;
const TONES = 8;
const TABLE_ROWS = 400;
const POINTER_REACH = 48;
/** Lines that are named at their ends; more of them are named above the chart. */
const NAMED_AT_ENDS = 4;

/** Digits of ticks on a logarithmic axis of more than so many decades, as reports and files have them. */
const TICKS = [[3, [1]], [1.5, [1, 2, 5]], [0.7, [1, 1.5, 2, 3, 4, 5, 7]], [-Infinity, [1, 1.2, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5, 6, 7, 8, 9]]];
/** Room at the ends of a logarithmic axis, as there. */
const LOG_ROOM = 1.12;

const tone = (one) => `tone-${(one.tone ?? 0) % TONES}`;
const finite = ([x, y]) => Number.isFinite(x + y);

/** "K_II" as K with a lowered II. */
function lowered(text) {
  const [head, low] = String(text).split("_");
  return low ? [head, shape("tspan", { dy: "0.3em", "font-size": "0.75em" }, low)] : [text];
}

/** Ticks of a logarithmic axis. */
function logTicks([low, high]) {
  const decades = Math.log10(high / low);
  const [, digits] = TICKS.find(([above]) => decades > above);
  const powers = Array.from({ length: Math.ceil(Math.log10(high / low)) + 2 }, (_, index) => Math.floor(Math.log10(low)) + index);
  return powers.flatMap((power) => digits.map((digit) => Number(`${digit}e${power}`))).filter((value) => value >= low && value <= high);
}

/** A tick; powers of ten on a logarithmic axis that has such ends. */
function tickText(value, scale, [low, high]) {
  const far = scale === "log" && (low < 0.001 || high >= 1e5);
  if (!far) return Math.abs(value) >= 1e4 ? whole(value) : plain(value, 6);
  const [digits, exponent] = value.toExponential(2).split("e");
  const mantissa = plain(Number(digits));
  return `${mantissa === "1" ? "" : `${mantissa}·`}10${powerOf(Number(exponent))}`;
}

/** Ends of an axis that hold all values; a linear one that starts near nought starts there. */
function domainOf(values, axis) {
  let [low, high] = [axis.from ?? Infinity, axis.to ?? -Infinity];
  for (const value of values) {
    if (!Number.isFinite(value) || (axis.scale === "log" && value <= 0)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) [low, high] = axis.scale === "log" ? [1, 10] : [0, 1];
  if (axis.scale === "log") return [low / LOG_ROOM, Math.max(high, 1.2 * low) * LOG_ROOM];
  if (low === high) [low, high] = [low - Math.max(1, 0.1 * Math.abs(low)), high + Math.max(1, 0.1 * Math.abs(high))];
  if (axis.from === undefined && low >= 0 && low < 0.25 * high) low = 0;
  return [low, high];
}

/**
 * Builds a chart in `container`. An axis is {label, unit, scale: "linear" | "log", from, to, format}; a series is {id, name, kind, x, y, tone}:
 * "line" (smooth: "x" | "y"), "thin", "points", "crosses", "band" (second edge x2, y2), "rule" (upright at x[0]), "limit" (at x[0] or y[0], named),
 * "outside" (hatched, above y[0], or below y2[0] down to nought) or "end" (a cross at its last point). `tools`: buttons of its head.
 * Gives {set(series), extend(id, x, y), move(at, dots), pick(take), destroy()}.
 */
export function createChart(container, { name, label, title, x: ofX, y: ofY, ratio = 0.52, tools = [], note }) {
  // Values stay metric; ticks are round, and numbers written, in the units that are shown.
  const [xAxis, yAxis] = [axisShown(ofX), axisShown(ofY)];
  let series = [];
  let width = 0;
  let place = null; // scales of the last drawing
  let cursor = null; // {id, index}
  let shared = null; // [at, dots] of the place that all pictures of a page share
  let taker = null;
  let frame = 0;

  const readoutId = uniqueId("chart-readout");
  const hatch = uniqueId("hatch");
  const clip = uniqueId("clip");
  const marks = shape("g", { "clip-path": `url(#${clip})` });
  const axes = shape("g");
  const above = shape("g");
  const crosshair = shape("g", { class: "chart-cursor" });
  const svg = shape("svg", { tabindex: "0", role: "application", "aria-roledescription": "chart", "aria-label": label, "aria-describedby": readoutId },
    axes, marks, crosshair, above);
  const legend = element("p", { class: "quiet", hidden: true });
  const readout = element("p", { class: "chart-readout", "aria-live": "polite", id: readoutId });
  const sheet = element("div", { hidden: true });
  const toggle = button("Table", () => {
    sheet.hidden = !sheet.hidden;
    toggle.setAttribute("aria-expanded", String(!sheet.hidden));
    drawTable();
  }, { class: "button bare", "aria-expanded": "false" });
  const plot = element("div", null, svg);
  show(container, element("figure", { class: "chart", "data-chart": name },
    element("div", { class: "chart-head" }, title ? element("h2", null, title) : element("span"), element("div", { class: "tool-row" }, tools, toggle)),
    legend, plot, readout, note && element("figcaption", null, note), sheet));

  const observer = new ResizeObserver(([entry]) => {
    const next = Math.floor(entry.contentRect.width);
    if (next === width || next === 0) return;
    width = next;
    draw();
  });
  observer.observe(plot);

  const readable = () => series.filter((one) => ["line", "points"].includes(one.kind) && one.x.length > 0);
  const format = (axis, value) => `${(axis.per === 1 && axis.format ? axis.format : significant)(value * axis.per)}${axis.unit ? ` ${axis.unit}` : ""}`;
  const titleOf = (axis) => (axis.unit ? `${axis.label}, ${axis.unit}` : axis.label);
  const atEnds = () => {
    const lines = series.filter((one) => one.kind === "line" && one.name);
    return lines.length > 1 && lines.length <= NAMED_AT_ENDS ? lines : [];
  };

  /** Many calls between two frames make one drawing. */
  function schedule() {
    cancelAnimationFrame(frame);
    frame = requestAnimationFrame(draw);
  }

  function draw() {
    if (width === 0) return;
    const height = Math.round(Math.min(Math.max(width * ratio, 220), 340));
    svg.setAttribute("width", width);
    svg.setAttribute("height", height);
    const counts = series.filter((one) => !["limit", "outside"].includes(one.kind));
    const all = (...keys) => counts.flatMap((one) => keys.flatMap((key) => Array.from(one[key] ?? [])));
    const scale = (axis, values, range) => {
      const made = (axis.scale === "log" ? d3.scaleLog() : d3.scaleLinear()).domain(domainOf(values, axis)).range(range);
      return axis.scale === "log" ? made : made.nice(axis.from === undefined || axis.to === undefined ? 5 : undefined);
    };
    const y = scale(yAxis, all("y", "y2"), [height - 40, 30]);
    const ticksOf = (axis, own, room) => {
      const made = own.copy().domain(own.domain().map((end) => end * axis.per));
      const ticks = axis.scale === "log" ? logTicks(made.domain()) : made.ticks(Math.max(2, Math.floor(room)));
      return ticks.map((value) => value / axis.per);
    };
    const tick = (value, axis, own) => tickText(axis.per === 1 ? value : Number((value * axis.per).toPrecision(12)), axis.scale, own.domain());
    const up = ticksOf(yAxis, y, (height - 70) / 52);
    const left = 12 + 7 * Math.max(2, ...up.map((value) => tick(value, yAxis, y).length));
    const right = width - (atEnds().length > 0 ? 12 + 7 * Math.max(...atEnds().map((one) => one.name.length)) : 14);
    const x = scale(xAxis, all("x", "x2"), [left, right]);
    const across = ticksOf(xAxis, x, (right - left) / 96);
    place = { x, y, left, right, top: 30, bottom: height - 40 };
    show(axes,
      shape("defs", null,
        shape("pattern", { id: hatch, width: 6, height: 6, patternUnits: "userSpaceOnUse", patternTransform: "rotate(45)" },
          shape("line", { x1: 0, x2: 0, y1: 0, y2: 6, class: "hatch" })),
        shape("clipPath", { id: clip }, shape("rect", { x: left, y: place.top - 4, width: right - left + 4, height: place.bottom - place.top + 4 }))),
      up.map((value) => [shape("line", { class: "grid", x1: left, x2: right, y1: y(value), y2: y(value) }),
        shape("text", { x: left - 8, y: y(value) + 4, "text-anchor": "end" }, tick(value, yAxis, y))]),
      across.map((value) => [
        yAxis.scale === "log" && shape("line", { class: "grid", x1: x(value), x2: x(value), y1: place.top, y2: place.bottom }),
        shape("line", { class: "axis", x1: x(value), x2: x(value), y1: place.bottom, y2: place.bottom + 4 }),
        shape("text", { x: x(value), y: place.bottom + 18, "text-anchor": x(value) > right - 16 ? "end" : "middle" }, tick(value, xAxis, x))]).flat(),
      shape("line", { class: "axis", x1: left, x2: right, y1: place.bottom, y2: place.bottom }),
      shape("text", { class: "axis-title", x: 0, y: 13 }, titleOf(yAxis)),
      shape("text", { class: "axis-title", x: right, y: place.bottom + 36, "text-anchor": "end" }, titleOf(xAxis)));
    const order = { outside: 0, band: 1, thin: 2 };
    const drawn = [...series].sort((one, other) => (order[one.kind] ?? 3) - (order[other.kind] ?? 3));
    show(marks, drawn.map(mark));
    const named = atEnds().map((one) => [one, one.x.map((value, index) => [value, one.y[index]]).filter(finite).at(-1)]).filter(([, last]) => last);
    let lowest = -Infinity; // of the names so far, so that none covers another
    show(above, drawn.map(words), named.sort(([, one], [, other]) => y(one[1]) - y(other[1])).map(([one, last]) => {
      lowest = Math.max(y(last[1]) + 4, lowest + 15);
      return shape("text", { class: "halo strong", x: x(last[0]) + 8, y: lowest }, lowered(one.name));
    }));
    const shown = series.filter((one) => one.name && ["line", "points", "thin", "crosses"].includes(one.kind));
    legend.hidden = atEnds().length > 0 || shown.length < 2;
    show(legend, shown.flatMap((one) => [element("span", { class: "nowrap" },
      shape("svg", { width: 26, height: 10, "aria-hidden": "true" }, swatch(one)), ` ${one.name} `), " "]));
    drawCursor();
    if (shared) move(...shared);
  }

  const swatch = (one) => (one.kind === "crosses" ? shape("path", { class: "series crosses", d: "M8 0l10 10m0 -10l-10 10" }) : one.kind === "points" ? shape("circle", { class: `series points ${tone(one)}`, cx: 13, cy: 5, r: 3.5 })
    : shape("path", { class: `series ${one.kind} ${tone(one)}`, d: "M1 5h24", "stroke-dasharray": dashes(one) }));
  const dashes = (one) => (one.dashed && one.tone > 0 ? ["6 3", "2 3", "9 3 2 3", "12 5", "4 2", "1 4", "9 3 2 3 2 3"][(one.tone - 1) % 7] : null);

  function mark(one) {
    const { x, y, top, bottom, left, right } = place;
    const attributes = { class: `series ${one.kind} ${tone(one)}`, "data-series": one.id };
    const points = Array.from(one.x ?? [], (value, index) => [value, one.y?.[index], one.x2?.[index], one.y2?.[index]]);
    switch (one.kind) {
      case "rule": return points.length > 0 && shape("path", { ...attributes, d: `M${x(one.x[0])} ${top}V${bottom}` });
      case "limit": return shape("path", { ...attributes, d: one.y?.length ? `M${left} ${y(one.y[0])}H${right}` : `M${x(one.x[0])} ${top}V${bottom}` });
      case "outside": {
        const [from, to] = one.y?.length ? [top, y(one.y[0])] : [y(one.y2[0]), Math.min(bottom, yAxis.scale === "log" ? bottom : y(0))];
        return to > from && shape("rect", { x: left, width: right - left, y: from, height: to - from, fill: `url(#${hatch})` });
      }
      case "points": {
        const radius = points.length > 300 ? 1.5 : 3;
        return shape("path", { ...attributes, d: points.filter(finite).map(([px, py]) => {
          const [cx, cy] = [x(px).toFixed(1), y(py).toFixed(1)];
          return `M${cx - radius} ${cy}a${radius} ${radius} 0 1 0 ${2 * radius} 0a${radius} ${radius} 0 1 0 ${-2 * radius} 0z`;
        }).join("") });
      }
      case "crosses": return shape("path", { ...attributes, d: points.filter(finite).map(([px, py]) => `M${x(px) - 5} ${y(py) - 5}l10 10m0 -10l-10 10`).join("") });
      case "band": {
        const area = d3.area().defined(finite).x0((at) => x(at[0])).x1((at) => x(at[2] ?? at[0])).y0((at) => y(at[1])).y1((at) => y(at[3] ?? at[1]));
        return shape("path", { ...attributes, d: area(points) });
      }
      case "end": return null;
      default: {
        // Unknown values leave a gap.
        const line = d3.line().defined(finite).x((at) => x(at[0])).y((at) => y(at[1]));
        if (one.smooth) line.curve(one.smooth === "y" ? d3.curveMonotoneY : d3.curveMonotoneX);
        return shape("path", { ...attributes, "stroke-dasharray": dashes(one), d: line(thinned(points)) ?? "" });
      }
    }
  }

  /** Skips steps below half a pixel: a run of 30 000 blocks draws as fast as one of 300. */
  function thinned(points) {
    if (points.length < 2000) return points;
    let last = [Infinity, Infinity];
    return points.filter((point, index) => {
      const at = [place.x(point[0]), place.y(point[1])];
      const near = Math.abs(at[0] - last[0]) < 0.5 && Math.abs(at[1] - last[1]) < 0.5;
      if (near && index < points.length - 1) return false;
      last = at;
      return true;
    });
  }

  function words(one) {
    const { x, y, top, left, right } = place;
    if (one.kind === "limit" && one.y?.length) return shape("text", { class: "halo remark", x: left + 6, y: y(one.y[0]) - 5 }, one.name);
    if (one.kind === "limit") return shape("text", { class: "halo remark", x: x(one.x[0]) + 6, y: top + 10 }, one.name);
    if (one.kind === "outside") {
      const at = one.y?.length ? top + 14 : y(one.y2[0]) + 13;
      return (one.y?.length ? y(one.y[0]) > top + 18 : Math.abs(y(one.y2[0]) - y(0)) > 18) && shape("text", { class: "halo remark", x: left + 8, y: at }, one.name);
    }
    if (one.kind !== "end" || one.x.length === 0) return null;
    const [cx, cy] = [x(one.x[0]), y(one.y[0])];
    const early = cx > 0.5 * (left + right);
    return [shape("path", { class: "end-mark", d: `M${cx - 5} ${cy - 5}l10 10m0 -10l-10 10` }),
      one.name && shape("text", { class: "halo strong", x: cx + (early ? -10 : 10), y: cy - 8, "text-anchor": early ? "end" : "start" }, one.name)];
  }

  function drawCursor() {
    const one = cursor && readable().find((candidate) => candidate.id === cursor.id);
    const index = one ? Math.min(cursor.index, one.x.length - 1) : -1;
    const at = one ? [one.x[index], one.y[index]] : [NaN, NaN];
    if (!finite(at)) {
      if (!shared) show(crosshair);
      return;
    }
    move(at[0], [at]);
    shared = null;
    const text = `${one.name}: ${xAxis.label} ${format(xAxis, at[0])}, ${yAxis.label} ${format(yAxis, at[1])}`;
    if (readout.textContent !== text) readout.textContent = text;
  }

  /** Shows a place along x and its values. */
  function move(at, dots = []) {
    shared = [at, dots];
    if (!place || !Number.isFinite(at)) return;
    show(crosshair, shape("line", { x1: place.x(at), x2: place.x(at), y1: place.top, y2: place.bottom }),
      dots.filter(finite).map(([px, py]) => shape("circle", { class: "dot", cx: place.x(px), cy: place.y(py), r: 4.5 })));
  }

  function nearest(px, py, candidates, acrossOnly = false) {
    let best = { distance: Infinity };
    for (const one of candidates) {
      for (let index = 0; index < one.x.length; index += 1) {
        const distance = Math.hypot(place.x(one.x[index]) - px, acrossOnly ? 0 : place.y(one.y[index]) - py);
        if (distance < best.distance) best = { distance, id: one.id, index };
      }
    }
    return best;
  }

  svg.addEventListener("pointermove", (event) => {
    if (!place) return;
    const box = svg.getBoundingClientRect();
    if (taker) {
      if (event.buttons) taker(place.x.invert(event.clientX - box.left));
      return;
    }
    const found = nearest(event.clientX - box.left, event.clientY - box.top, readable());
    if (found.distance < POINTER_REACH) [cursor] = [{ id: found.id, index: found.index }];
    drawCursor();
  });

  svg.addEventListener("pointerdown", (event) => {
    if (!taker || !place) return;
    svg.setPointerCapture(event.pointerId);
    taker(place.x.invert(event.clientX - svg.getBoundingClientRect().left));
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
      cursor = { id: one.id, index: Math.min(Math.max(steps[event.key], 0), last) };
    } else if (turn) {
      const other = lines[(at + turn + lines.length) % lines.length];
      cursor = index < 0 ? { id: one.id, index: 0 } : { id: other.id, index: nearest(place.x(one.x[index]), 0, [other], true).index ?? 0 };
    } else if (event.key === "Escape" && cursor) {
      cursor = null;
      readout.textContent = "";
    } else {
      return;
    }
    drawCursor();
    if (taker && cursor) taker(lines.find((line) => line.id === cursor.id).x[cursor.index]);
    event.preventDefault();
  });

  function drawTable() {
    if (sheet.hidden) return;
    const curves = series.filter((one) => ["line", "points", "band", "thin"].includes(one.kind));
    const perCurve = Math.max(20, Math.floor(TABLE_ROWS / Math.max(1, curves.length)));
    const thin = curves.some((one) => one.x.length > perCurve);
    const rows = curves.flatMap((one) => {
      const stride = Math.ceil(one.x.length / perCurve);
      const range = (axis, first, second, index) => {
        const text = (values) => format({ ...axis, unit: "" }, values[index]);
        return second && second[index] !== first[index] ? `${text(first)} to ${text(second)}` : text(first);
      };
      return Array.from(one.x.keys()).filter((index) => index % stride === 0 || index === one.x.length - 1)
        .map((index) => [one.name, range(xAxis, one.x, one.x2, index), range(yAxis, one.y, one.y2, index)]);
    });
    const columns = [{ title: "Curve" }, ...[xAxis, yAxis].map((axis) => ({ title: axis.label, unit: axis.unit, numeric: true }))];
    show(sheet, table(thin ? `${label} (every row is in the download; here a selection)` : label, columns, rows));
  }

  return {
    /** Replaces all series. */
    set(next) {
      series = next;
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
    move,
    /** A press or drag in the chart, or an arrow key on a curve, gives the place along x. */
    pick(take) {
      taker = take;
    },
    destroy() {
      observer.disconnect();
      cancelAnimationFrame(frame);
    },
  };
}
