// Numbers, times and names as engineers read them. A no-break thin space groups thousands, so that no number
// is torn apart at the end of a line and no comma can be taken for a decimal sign.

const GROUP = "\u202f";
const SUPERSCRIPT = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹" };

export const NONE = "–";

function group(digits) {
  return digits.length < 5 ? digits : digits.replace(/\B(?=(\d{3})+$)/g, GROUP);
}

function withMinus(text) {
  return text.replace(/^-/, "−");
}

/** Whole number with grouped thousands: 190 396. */
export function whole(value) {
  if (!Number.isFinite(value)) return NONE;
  const text = Math.round(value).toString();
  return withMinus(/e/.test(text) ? scientific(value, 3) : text.replace(/\d+/, group));
}

/** Fixed number of decimals, thousands grouped. */
export function fixed(value, decimals) {
  if (!Number.isFinite(value)) return NONE;
  const text = value.toFixed(decimals);
  // No minus before nought.
  const [head, tail] = (Number(text) === 0 ? text.replace("-", "") : text).split(".");
  return withMinus(head.replace(/\d+/, group) + (tail ? `.${tail}` : ""));
}

/** Significant digits, without exponent between 0.001 and a million. */
export function significant(value, digits = 4) {
  if (!Number.isFinite(value)) return NONE;
  if (value === 0) return "0";
  const magnitude = Math.floor(Math.log10(Math.abs(Number(value.toPrecision(digits)))));
  if (magnitude < -3 || magnitude > 8) return scientific(value, digits);
  return fixed(value, Math.max(0, digits - 1 - magnitude));
}

/** Like significant(), without zeros at the end: for ticks and echoed input. */
export function plain(value, digits = 6) {
  const text = significant(value, digits);
  return text.includes(".") && !text.includes("×") ? text.replace(/\.?0+$/, "") : text;
}

/** 2.185 × 10⁻⁴ */
export function scientific(value, digits = 4) {
  if (!Number.isFinite(value)) return NONE;
  const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
  return `${withMinus(mantissa)} × 10${powerOf(Number(exponent))}`;
}

/** Exponent as superscript. */
export function powerOf(exponent) {
  return String(exponent).replace(/./g, (sign) => SUPERSCRIPT[sign]);
}

/** Cycles: whole above a hundred, else with decimals. */
export function cycles(value) {
  return Math.abs(value) >= 100 || Number.isInteger(value) ? whole(value) : significant(value, 3);
}

/** Cycles with the digits that their band deserves: two where its half width is above 10 %, three above 1 %, else four; with those of `of` where it is given. */
export function deserved(value, [low, middle, high], toWhole = Math.round, of = value) {
  const half = (high - low) / 2 / middle;
  const digits = half > 0.1 ? 2 : half > 0.01 ? 3 : 4;
  const unit = 10 ** (Math.floor(Math.log10(of)) + 1 - digits);
  return value > 0 ? cycles(Number((toWhole(value / unit) * unit).toPrecision(12))) : "0";
}

/** Half width of a life of which no error is stated, percent. */
const UNSTATED = 1;

/** The band that the stated error of a life, percent, leaves it. */
export function bandOfError(percent) {
  const half = (percent ?? UNSTATED) / 100;
  return [1 - half, 1, 1 + half];
}

/** The ends of a band in words. */
export function bandOf(band) {
  return `90 % of specimens ${deserved(band[0], band)} to ${deserved(band[2], band)}`;
}

/** Share as percent. */
export function percent(share, decimals = 1) {
  return Number.isFinite(share) ? `${fixed(100 * share, decimals)} %` : NONE;
}

/** Percent with its sign, for deviations. */
export function deviation(share, decimals = 2) {
  if (!Number.isFinite(share)) return NONE;
  const rounded = Number((100 * share).toFixed(decimals));
  return rounded === 0 ? percent(0, decimals) : `${rounded > 0 ? "+" : ""}${percent(share, decimals)}`;
}

/** Seconds in words: 4 s, 2 min 5 s, 1 h 3 min. */
export function duration(seconds) {
  if (!Number.isFinite(seconds)) return NONE;
  if (seconds < 10) return `${fixed(seconds, 1)} s`;
  const total = Math.round(seconds);
  if (total < 60) return `${total} s`;
  const [hours, minutes] = [Math.floor(total / 3600), Math.floor(total / 60) % 60];
  return hours > 0 ? `${hours} h ${minutes} min` : `${minutes} min ${total % 60} s`;
}

/** A moment, local time; in a list that of today is its hour. */
export function moment(text, inList = false) {
  const date = new Date(text ?? "");
  if (Number.isNaN(date.getTime())) return NONE;
  if (inList && date.toDateString() === new Date().toDateString()) return date.toLocaleTimeString(undefined, { hour: "2-digit", minute: "2-digit" });
  return date.toLocaleString(undefined, { year: "numeric", month: "short", day: "2-digit", hour: "2-digit", minute: "2-digit" });
}

/** Bytes of a file. */
export function bytes(count) {
  if (!Number.isFinite(count)) return "";
  if (count < 1000) return `${count} B`;
  return count < 1e6 ? `${fixed(count / 1e3, 1)} kB` : `${fixed(count / 1e6, 1)} MB`;
}

/** Kinds that are called otherwise than their key. */
const CALLED = { element_free_galerkin: "nodes", peridynamics: "points and bonds", ring: "interaction integral", nasgro: "NASGRO", library: "library growth data" };

/** A key or kind in words: crack_length_reached becomes "crack length reached". */
export function words(name) {
  return CALLED[name] ?? String(name ?? "").replaceAll("_", " ");
}

/** First letter large, for labels and starts of sentences. */
export function sentence(text) {
  const line = String(text ?? "");
  // A file, a key and a unit keep their name: kN, mm/cycle.
  if (/^\S*[._]\S/.test(line) || /^(mm|um|nm|m|in|kN|lbf|kip|kgf|ksi)(\/| sqrt|$)/.test(line)) return line;
  return line.charAt(0).toUpperCase() + line.slice(1);
}

/** Count with its noun: 1 point, 3 points. */
export function count(number, noun, plural = `${noun}s`) {
  return `${whole(number)} ${number === 1 ? noun : plural}`;
}

/** A number as typed: decimal comma allowed where it cannot be a thousands separator. NaN when it is none. */
export function parseNumber(text) {
  const trimmed = text.trim().replaceAll(/[\u202f\u00a0 ]/g, "").replace("−", "-");
  const decimal = /^[^,.]*,[^,.]*$/.test(trimmed) ? trimmed.replace(",", ".") : trimmed;
  return decimal !== "" && /^[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i.test(decimal) ? Number(decimal) : NaN;
}
