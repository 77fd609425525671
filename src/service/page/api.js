// Requests to the service: token, problems in words, waiting when it is busy.

import { element } from "./dom.js";
import { askToken, forgetToken, readToken } from "./token.js";

const READ_ATTEMPTS = 4;
const WAIT_MAX_S = 30;

/** What the service answered when it refused, or what kept us from reaching it (status 0). */
export class Problem extends Error {
  constructor(status, body) {
    super(body?.detail ?? body?.title ?? `The service answered with status ${status}.`);
    this.status = status;
    this.title = body?.title ?? "";
    this.input = body?.input ?? null;
  }

  /** A problem as a job carries it. */
  static ofJob(body) {
    return new Problem(body?.status ?? 500, body ?? { detail: "The run failed, and the service gave no reason." });
  }

  /** Whether the same request may succeed a little later. */
  get passes() {
    return [0, 429, 502, 503, 504].includes(this.status);
  }
}

let notice = () => {};

/** Sets what is called with a sentence while a request waits for the service, and with null after it. */
export function onWaiting(tell) {
  notice = tell;
}

/** Waits, until `signal` is aborted. */
export function sleep(seconds, signal) {
  return new Promise((resolve, reject) => {
    const stop = () => {
      clearTimeout(timer);
      reject(signal.reason);
    };
    const timer = setTimeout(() => {
      signal?.removeEventListener("abort", stop);
      resolve();
    }, seconds * 1000);
    signal?.addEventListener("abort", stop, { once: true });
  });
}

async function refusal(response) {
  const text = await response.text().catch(() => "");
  try {
    return new Problem(response.status, JSON.parse(text));
  } catch {
    const plain = response.status === 503 ? "The service is busy or just being started." : undefined;
    return new Problem(response.status, { detail: plain ?? `The service answered ${response.status} ${response.statusText}.` });
  }
}

async function reach(path, options) {
  try {
    return await fetch(path, options);
  } catch (error) {
    if (options.signal?.aborted) throw error;
    throw new Problem(0, {
      title: "No connection",
      detail: "The service cannot be reached. Check that it is running and that this computer is on its network.",
    });
  }
}

/** One request. A 401 asks for a token and repeats; a problem is thrown. Gives the response. */
export async function request(path, options = {}) {
  for (;;) {
    const token = readToken();
    const headers = { ...options.headers, ...(token ? { Authorization: `Bearer ${token}` } : {}) };
    const response = await reach(path, { ...options, headers });
    if (response.ok) return response;
    const problem = await refusal(response);
    problem.retryAfter = Number(response.headers.get("Retry-After")) || null;
    if (problem.status !== 401) throw problem;
    // Another request may have asked meanwhile: then its token is tried before the user is bothered again.
    if (readToken() === token) {
      forgetToken();
      if (!(await askToken(token ? problem.message : ""))) throw problem;
    }
  }
}

/** A read is harmless to repeat: it waits as long as the service says and tries again. */
async function read(path, options = {}) {
  for (let attempt = 1; ; attempt += 1) {
    try {
      const response = await request(path, options);
      if (attempt > 1) notice(null);
      return response;
    } catch (error) {
      if (!(error instanceof Problem) || !error.passes || error.status === 0 || attempt === READ_ATTEMPTS) {
        notice(null);
        throw error;
      }
      const seconds = Math.min(error.retryAfter ?? 2 ** attempt, WAIT_MAX_S);
      notice(`${error.message} Trying again in ${seconds} s.`);
      await sleep(seconds, options.signal);
    }
  }
}

export async function getJson(path, signal) {
  return (await read(path, { signal })).json();
}

export async function getText(path, signal) {
  return (await read(path, { signal })).text();
}

export async function getBlob(path, signal) {
  return (await read(path, { signal })).blob();
}

export async function postJson(path, body, { key, signal } = {}) {
  const headers = { "Content-Type": "application/json", ...(key ? { "Idempotency-Key": key } : {}) };
  const response = await request(path, { method: "POST", headers, body: JSON.stringify(body ?? {}), signal });
  return response.status === 204 ? null : response.json();
}

/** Changes part of what is there. */
export async function patchJson(path, body) {
  return (await request(path, { method: "PATCH", headers: { "Content-Type": "application/json" }, body: JSON.stringify(body) })).json();
}

export async function postForm(path, form, { key, signal } = {}) {
  const headers = key ? { "Idempotency-Key": key } : {};
  return (await request(path, { method: "POST", headers, body: form, signal })).json();
}

/** Posts {input, name, calibration, files}; with files as a form, so that they go as they are. */
export function postInput(path, { files, ...body }, options) {
  if (!files) return postJson(path, body, options);
  const form = new FormData();
  for (const [name, value] of Object.entries(body)) {
    if (value !== undefined) form.append(name, typeof value === "string" ? value : JSON.stringify(value));
  }
  for (const { name, file } of files) form.append("file", file, name);
  return postForm(path, form, options);
}

export async function remove(path) {
  await request(path, { method: "DELETE" });
}

/** A key for one press of a button. Not crypto.randomUUID: that one is missing where the page comes over plain http from another host. */
export function pressKey() {
  const bytes = crypto.getRandomValues(new Uint8Array(16));
  bytes[6] = (bytes[6] & 0x0f) | 0x40;
  bytes[8] = (bytes[8] & 0x3f) | 0x80;
  const hex = Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
  return hex.replace(/^(.{8})(.{4})(.{4})(.{4})/, "$1-$2-$3-$4-");
}

/** Saves a file of the service under its name; by fetch, since a link would not carry the token. */
export async function download(path, name) {
  const address = URL.createObjectURL(await getBlob(path));
  const link = element("a", { href: address, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(address), 60_000);
}
