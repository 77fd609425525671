// Page of a fit of laws over K: the chosen law with its constants, and all candidates.

import { element, section, table } from "./dom.js";
import { fixed, significant } from "./format.js";

/** Sections of the summary of such a fit. */
export function lawSections(summary) {
  return [section("constants", "Constants", constants(summary)), section("candidates", "Laws", candidates(summary))];
}

function constants({ law, constants: values, standard_errors: errors, aicc_margin: margin, next_best: next, rates }) {
  const rows = Object.entries(values).map(([key, value]) => [
    key, significant(value, 5), key in errors ? `± ${significant(errors[key], 2)}` : "given",
  ]);
  const columns = [{ title: "Constant" }, { title: "Value", numeric: true }, { title: "Std. error", numeric: true }];
  const than = next ? `, ΔAICc ${fixed(margin, 1)} against ${next}` : "";
  return element("div", { class: "stack tight" },
    element("p", null, `${law}, fitted to ${rates} rates${than}.`),
    table("Constants of the chosen law", columns, rows, { hidden: true, name: "constants" }));
}

function candidates({ candidates: list }) {
  const number = (title) => ({ title, numeric: true });
  const columns = [{ title: "Law" }, number("Fitted constants"), number("rms of ln da/dN"), number("delta AICc"), { title: "Not used because" }];
  const shown = (value, digits) => (Number.isFinite(value) ? fixed(value, digits) : "");
  const rows = list.map((one) => [
    one.law, String(one.fitted_constants), shown(one.rms_log_rate, 3), one.left_out ? "" : shown(one.delta_aicc, 1), one.left_out ?? "",
  ]);
  return table("Laws that were fitted to the rates", columns, rows, { hidden: true, name: "candidates" });
}
