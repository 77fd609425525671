// Lines of a text file around those with problems, the wrong ones marked.

import { element } from "./dom.js";
import { count } from "./format.js";

const AROUND = 2;
const LINES_MAX = 200;

/** `wrong`: numbers of lines, from 1; `name` is that of the file. Null when no such line is there. */
export function excerpt(text, wrong, name) {
  const lines = text.split(/\r\n|\n|\r/);
  const marked = new Set(wrong.filter((line) => line >= 1 && line <= lines.length));
  if (marked.size === 0) return null;
  // The header stays in sight: it says what the columns are.
  const shown = new Set([1]);
  for (const line of marked) {
    for (let near = Math.max(1, line - AROUND); near <= Math.min(lines.length, line + AROUND); near += 1) shown.add(near);
  }
  const numbers = [...shown].sort((first, second) => first - second).slice(0, LINES_MAX);
  const items = numbers.flatMap((line, index) => [
    index > 0 && line > numbers[index - 1] + 1 && element("div", { class: "excerpt-gap" }, "⋯"),
    element("div", { class: marked.has(line) ? "excerpt-line marked" : "excerpt-line", "data-line": line, "data-marked": marked.has(line) },
      element("span", { class: "excerpt-number" }, marked.has(line) && element("span", { class: "visually-hidden" }, "wrong: "), String(line)),
      element("code", null, lines[line - 1] === "" ? " " : lines[line - 1])),
  ]);
  return element("figure", { class: "excerpt" },
    element("figcaption", null, `${name}, ${count(marked.size, "wrong line")} marked`),
    element("div", { class: "excerpt-lines", tabindex: "0", role: "region", "aria-label": name }, items));
}
