// Starts a run: one key for one press of the button, repeated when the answer got lost, so that no press starts two runs.

import { postInput, pressKey, sleep } from "./api.js";
import { hrefOf } from "./job.js";

const ATTEMPTS = 3;

/** Posts `body` to `path` and opens the run; a refusal goes to `refuse`. */
export async function startRun(path, body, { button, status, refuse }) {
  const key = pressKey();
  button.disabled = true;
  status.textContent = "Starting …";
  try {
    for (let attempt = 1; ; attempt += 1) {
      try {
        const job = await postInput(path, body, { key });
        status.textContent = "";
        location.hash = hrefOf(job);
        return;
      } catch (error) {
        if (!error.passes || attempt === ATTEMPTS) throw error;
        const seconds = Math.min(error.retryAfter ?? 2 * attempt, 30);
        status.textContent = `${error.message} Trying again in ${seconds} s.`;
        await sleep(seconds);
      }
    }
  } catch (error) {
    status.textContent = "";
    refuse(error);
  } finally {
    button.disabled = false;
  }
}
