// Example data to try the page with: computed, not measured, and said to be so wherever it is shown.

const RATE = 1.1e-7; // mm/cycle at ΔK = 1 MPa√m
const EXPONENT = 2.9;
const STRESS_RANGE = 48.28; // MPa
const WIDTH = 152.4; // mm
// About one percent, as readings through a microscope scatter; fixed, so that everybody sees the same curve.
const SCATTER = [0, 0.6, -0.4, 0.9, -0.8, 0.3, 1.0, -0.6, -0.2, 0.7, -1.0, 0.4, 0.1, -0.5, 0.8, -0.3];

function rate(a) {
  const intensity = STRESS_RANGE * Math.sqrt((Math.PI * a * 1e-3) / Math.cos((Math.PI * a) / WIDTH));
  return RATE * intensity ** EXPONENT;
}

export const EXAMPLE_NAME = "synthetic_middle_tension.csv";

/** Crack length against cycles of a middle-tension panel, by adding up a growth law in small steps. */
export function exampleCsv() {
  const lengths = [];
  for (let a = 9; a < 49.81; a += a < 36.2 ? 0.8 : 1.7) lengths.push(Number(a.toFixed(1)));
  if (lengths.at(-1) !== 49.8) lengths.push(49.8);
  const rows = [];
  let [cycles, written, at] = [0, -1, lengths[0]];
  lengths.forEach((length, index) => {
    const before = cycles;
    const step = 0.01;
    for (; at < length - step / 2; at += step) cycles += step / rate(at + step / 2);
    const noise = 1 + (SCATTER[index % SCATTER.length] / 100) * 1.5;
    const reading = index === 0 ? 0 : Math.max(written + 1, Math.round(before + (cycles - before) * noise));
    rows.push(`example,${reading},${length.toFixed(1)}`);
    written = reading;
  });
  return `specimen,cycles,crack_length_mm\n${rows.join("\n")}\n`;
}

/** The test the example belongs to. */
export const EXAMPLE_TEST = {
  specimen: { kind: "middle_tension", width_mm: WIDTH, length_mm: 300, thickness_mm: 2.54, crack_length_mm: 9 },
  material: { name: "al2024-t3", plane: "stress" },
  loading: { kind: "constant_amplitude", stress_range_mpa: STRESS_RANGE, stress_ratio: 0.2 },
  model: { spacing_mm: 1 },
};
