// One input, two ways to write it: the form, or the TOML text for everything else the program can do.

import { createCheck } from "./check.js";
import { button, element, show } from "./dom.js";
import { writeToml } from "./toml.js";

/**
 * `collect()` gives the input object of the form, `fill(case)` takes one over (false where the form cannot show it), `context()`
 * gives {files, calibration} or a sentence that says what is missing. `fields` is the element of the form, hidden in text mode.
 */
export function createEditor({ host, fields, panel, form, collect, fill, context, onResult, onMode = () => {} }) {
  let textMode = false;
  const area = element("textarea", { id: `${host.id}-toml`, spellcheck: "false", autocapitalize: "off", rows: "26", oninput: () => check.soon() });
  const question = element("div");
  const textPart = element("div", { class: "text-mode", hidden: true },
    element("label", { for: area.id }, "Input as TOML"), area,
    element("p", { class: "hint" }, "Same format as the command line. This text is run."));
  const way = (name, title, act) => button(title, act, { class: "button small", "data-action": name, "aria-pressed": String(name === "form") });
  const buttons = [
    way("form", "Form", () => textMode && backToForm()),
    way("toml", "TOML text", () => textMode || toText(writeToml(collect()))),
  ];
  host.prepend(element("div", { class: "tool-row ways", role: "group", "aria-label": "Way to write the input" }, buttons), question);
  host.append(textPart);

  const body = () => {
    const around = context();
    return typeof around === "string" ? around : { ...around, input: textMode ? area.value : collect() };
  };
  const check = createCheck(panel, { form, collect: body, onResult });

  function setMode(text) {
    textMode = text;
    fields.hidden = text;
    textPart.hidden = !text;
    buttons.forEach((one) => one.setAttribute("aria-pressed", String((one.dataset.action === "toml") === text)));
    show(question);
    onMode();
    check.soon();
  }

  function toText(text) {
    area.value = text;
    setMode(true);
  }

  /** The form takes the text over where it can show all of it; else the user decides. */
  function backToForm() {
    if (area.value === writeToml(collect()) || (check.last?.case && fill(check.last.case))) {
      setMode(false);
      return;
    }
    show(question, element("div", { class: "notice warn", role: "alert" },
      element("p", null, "The form cannot show this text. Switching discards your changes."),
      element("p", { class: "tool-row" },
        button("Keep the text", () => show(question)), button("Discard the text", () => setMode(false)))));
  }

  return {
    check, body,
    /** Starts from the text of another run; shown as a form where the form can show it. */
    async start(text) {
      toText(text);
      if ((await check.now()) && check.last.case && fill(check.last.case)) setMode(false);
    },
    /** Starts from an object. */
    startFrom(input) {
      fill(input);
      setMode(false);
    },
  };
}
