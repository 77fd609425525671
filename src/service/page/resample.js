// How a curve comes down: as it was computed, or at equally spaced cycles.

import { button, element } from "./dom.js";

/** The curve as it was computed, or at equally spaced cycles. */
export function curveChoices(file, fetchFile) {
  const amount = element("input", { type: "text", inputmode: "numeric", id: "resample-amount", value: "200" });
  const kind = element("select", { id: "resample-kind" },
    element("option", { value: "points" }, "points in all"), element("option", { value: "every_cycles" }, "cycles apart"));
  const message = element("span", { class: "field-problem", role: "alert" });
  return element("span", { class: "resample" },
    element("label", { for: "resample-amount" }, "or equally spaced, "), amount,
    element("label", { for: "resample-kind", class: "visually-hidden" }, "Sampling"), kind,
    button("Download", () => {
      const number = Number(amount.value.replaceAll(/\s/g, ""));
      const good = number > 0 && (kind.value === "every_cycles" || (Number.isInteger(number) && number >= 2));
      message.textContent = good ? "" : "Give a number above 0; points: a whole number from 2.";
      if (good) fetchFile(`${file.href}?${kind.value}=${number}`, "a_n.csv");
    }, { class: "button small", "data-action": "resample" }), message);
}
