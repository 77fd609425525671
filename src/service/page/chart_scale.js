// Scales and ticks of a chart: 1-2-5 steps on linear axes, decades (with 2 and 5 where there is room) on logarithmic ones.

import { fixed, plain, powerOf } from "./format.js";

/** Domain that holds all values and the ends a chart asks for (`from`, `to`). */
export function domainOf(values, scale, fixedEnds = {}) {
  let [low, high] = [Infinity, -Infinity];
  for (const list of values) {
    for (const value of list) {
      if (!Number.isFinite(value) || (scale === "log" && value <= 0)) continue;
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  if (low > high) [low, high] = scale === "log" ? [1, 10] : [0, 1];
  low = Math.min(fixedEnds.from ?? low, low);
  high = Math.max(fixedEnds.to ?? high, high);
  if (scale === "log") {
    const room = Math.max(0.04 * Math.log10(high / low), 0.02);
    return [low / 10 ** room, high * 10 ** room];
  }
  if (low === high) [low, high] = [low - Math.max(1, Math.abs(low) * 0.1), high + Math.max(1, Math.abs(high) * 0.1)];
  // A quantity that starts near nought is shown from nought. The ends lie on half steps: while a curve grows, the axes then
  // change now and then only, not with every point.
  if (low >= 0 && low < 0.25 * high) low = 0;
  const step = niceStep(high - low, 5) / 2;
  return [Math.floor(low / step + 1e-6) * step, Math.ceil(high / step - 1e-6) * step];
}

/** Step of 1, 2 or 5 times a power of ten that gives about `count` intervals. */
export function niceStep(span, count) {
  const raw = span / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(raw));
  const mantissa = raw / power;
  return power * (mantissa <= 1.0001 ? 1 : mantissa <= 2.0001 ? 2 : mantissa <= 5.0001 ? 5 : 10);
}

function linearTicks([low, high], count) {
  const step = niceStep(high - low, count);
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const ticks = [];
  for (let index = Math.ceil(low / step - 1e-9); index * step <= high + 1e-9 * step; index += 1) {
    const value = index * step;
    ticks.push({ value, label: decimals > 6 ? plain(value, 3) : fixed(Math.abs(value) < step / 2 ? 0 : value, decimals), strong: true });
  }
  return ticks;
}

function logTicks([low, high], count) {
  const [first, last] = [Math.floor(Math.log10(low)), Math.ceil(Math.log10(high))];
  const decades = Math.log10(high / low);
  const mantissas = decades < 1.2 ? [1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9] : decades < 2.5 && count >= 4 ? [1, 2, 5] : [1];
  const skip = decades > count ? Math.ceil(decades / count) : 1;
  const ticks = [];
  for (let power = first; power <= last; power += 1) {
    if ((power - first) % skip !== 0) continue;
    for (const mantissa of mantissas) {
      const value = mantissa * 10 ** power;
      if (value < low * (1 - 1e-9) || value > high * (1 + 1e-9)) continue;
      ticks.push({ value, label: logLabel(mantissa, power), strong: mantissa === 1 });
    }
  }
  return thinned(ticks, Math.max(count, 2));
}

function logLabel(mantissa, power) {
  if (power >= -2 && power <= 3) return plain(mantissa * 10 ** power, 2);
  return mantissa === 1 ? `10${powerOf(power)}` : `${mantissa}·10${powerOf(power)}`;
}

/** All lines stay; of the labels only as many as there is room for. */
function thinned(ticks, count) {
  if (ticks.length <= count + 1) return ticks;
  const keep = new Set([1, 2, 5]);
  const first = (value) => Number(value.toExponential(0).split("e")[0]);
  const few = ticks.filter((tick) => tick.strong || keep.has(first(tick.value)));
  return ticks.map((tick) => (few.includes(tick) ? tick : { ...tick, label: "" }));
}

/** Maps a domain to pixels: {at(value), ticks(count)}. */
export function scaleOf(kind, domain, [start, end]) {
  const position = kind === "log" ? Math.log10 : (value) => value;
  const [low, high] = domain.map(position);
  return {
    at: (value) => (kind === "log" && value <= 0 ? NaN : start + ((position(value) - low) / (high - low)) * (end - start)),
    ticks: (count) => (kind === "log" ? logTicks(domain, count) : linearTicks(domain, count)),
  };
}
