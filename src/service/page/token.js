// The access token: kept for this tab only, asked for when the service wants one.

import { byId } from "./dom.js";

const NAME = "perilife.token";

let memory = null;
let asking = null;

export function readToken() {
  try {
    return sessionStorage.getItem(NAME) ?? memory;
  } catch {
    return memory;
  }
}

function keep(token) {
  memory = token;
  try {
    if (token) sessionStorage.setItem(NAME, token);
    else sessionStorage.removeItem(NAME);
  } catch {
    // Storage switched off: the token then lives in memory, as long as the page.
  }
  document.dispatchEvent(new CustomEvent("token", { detail: Boolean(token) }));
}

export function forgetToken() {
  keep(null);
}

/** Opens the dialog, once for all requests that wait; true when a token was given. */
export function askToken(reason) {
  asking ??= new Promise((resolve) => {
    const dialog = byId("token-dialog");
    const input = byId("token");
    const words = byId("token-reason");
    words.textContent = reason;
    words.hidden = reason === "";
    input.value = "";
    dialog.returnValue = "";
    dialog.addEventListener("close", () => {
      const token = input.value.trim();
      const given = dialog.returnValue === "use" && token !== "";
      if (given) keep(token);
      input.value = "";
      asking = null;
      resolve(given);
    }, { once: true });
    dialog.showModal();
    input.focus();
  });
  return asking;
}
