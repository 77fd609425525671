// A pass of a spectrum drawn: how often its maxima are exceeded, and how many of its cycles have which range. The service says both
// (`spectrum` of a check, `spectrum.curves` of a result).

import { createChart } from "./chart.js";
import { element, show } from "./dom.js";
import { significant } from "./format.js";

/** Counts that differ by more than this are drawn over a logarithmic axis. */
const FAR_APART = 50;

/** Gives {set(curves), destroy()}; `curves` is null where the loads are none. */
export function createSpectrumPicture(container) {
  const places = [element("div"), element("div")];
  show(container, places);
  let charts = [];
  let drawn = "null";

  function destroy() {
    charts.forEach((chart) => chart.destroy());
    charts = [];
  }

  return {
    destroy,
    set(curves) {
      const wanted = JSON.stringify(curves ?? null);
      if (wanted === drawn) return;
      drawn = wanted;
      destroy();
      container.hidden = !curves;
      if (!curves) return;
      charts = [maxima(places[0], curves), ranges(places[1], curves)];
    },
  };
}

/** Maxima over how many of a pass are as large or larger, a stair. */
function maxima(place, { maxima: levels }) {
  const stair = levels.flatMap(([level, count], index) => (index > 0 ? [[levels[index - 1][1], level], [count, level]] : [[count, level]]));
  const chart = createChart(place, {
    name: "exceedances", title: "Exceedances of a pass", label: "Maxima of a pass of the spectrum over their exceedances",
    x: { label: "Exceedances per pass", scale: "log", format: (value) => significant(value, 4) },
    y: { label: "Maximum / largest load", from: 0, format: (value) => significant(value, 3) },
  });
  chart.set([{ id: "maxima", name: "maxima", kind: "line", tone: 0, x: stair.map(([count]) => count), y: stair.map(([, level]) => level) }]);
  return chart;
}

/** Cycles of a pass by their range, a bar for each part of the largest. */
function ranges(place, { cycles_by_range: counts, largest_range: largest }) {
  const some = counts.filter((count) => count > 0);
  const isFar = Math.max(...some) > FAR_APART * Math.min(...some);
  const floor = isFar ? Math.min(...some) / 2 : 0;
  const width = largest / counts.length;
  const chart = createChart(place, {
    name: "ranges", title: "Ranges of a pass", label: "Cycles of a pass of the spectrum by their range",
    x: { label: "Range / largest load", from: 0, to: largest, format: (value) => significant(value, 3) },
    y: { label: "Cycles of a pass", scale: isFar ? "log" : "linear", from: floor, format: (value) => significant(value, 4) },
  });
  chart.set(counts.map((count, index) => ({
    id: `range-${index}`, name: `bar ${index + 1}`, kind: "band", tone: 0,
    x: [(index + 0.08) * width, (index + 0.92) * width], y: [floor, floor], y2: [count, count],
  })).filter(({ y2 }) => y2[0] > 0));
  return chart;
}
