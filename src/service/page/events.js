// Server-sent events over fetch, which can send the token (EventSource cannot). Resumes after a break.

import { request } from "./api.js";

const WAITS_S = [0.5, 1, 2, 4, 8, 15];
// The service says something every 15 s, if only a comment: after three times that the line is dead, whatever it looks like.
const SILENCE_S = 45;

/** Splits a stream of text into events {event, id, data}. */
async function* eventsOf(body) {
  const reader = body.pipeThrough(new TextDecoderStream()).getReader();
  let rest = "";
  try {
    for (;;) {
      const { done, value } = await within(SILENCE_S, reader.read());
      if (done) return;
      rest += value;
      // An event ends at an empty line; a carriage return at the very end may be half of a line end.
      const blocks = rest.split(/\r\n\r\n|\n\n|\r\r(?!\n)/);
      rest = blocks.pop();
      for (const block of blocks) {
        const event = parse(block);
        if (event) yield event;
      }
    }
  } finally {
    reader.cancel().catch(() => {});
  }
}

function within(seconds, promise) {
  let timer = 0;
  const silence = new Promise((_, reject) => {
    timer = setTimeout(() => reject(new Error("nothing was heard")), seconds * 1000);
  });
  return Promise.race([promise, silence]).finally(() => clearTimeout(timer));
}

function parse(block) {
  const event = { event: "message", id: null, data: [] };
  for (const line of block.split(/\r\n|\n|\r/)) {
    const match = /^(event|id|data): ?(.*)$/.exec(line);
    if (!match) continue; // comments keep the connection open, retry times are ours
    if (match[1] === "data") event.data.push(match[2]);
    else event[match[1]] = match[2];
  }
  return event.data.length > 0 ? { ...event, data: JSON.parse(event.data.join("\n")) } : null;
}

function pause(seconds, signal) {
  return new Promise((resolve) => {
    const timer = setTimeout(resolve, seconds * 1000);
    signal.addEventListener("abort", () => {
      clearTimeout(timer);
      resolve();
    }, { once: true });
  });
}

/**
 * Follows `path` until `take(name, data)` returns true or `signal` aborts. `connection(live)` is told when the stream
 * breaks and when it is back.
 */
export async function follow(path, { take, connection, signal }) {
  let lastId = null;
  let failures = 0;
  while (!signal.aborted) {
    try {
      const headers = { Accept: "text/event-stream", ...(lastId === null ? {} : { "Last-Event-ID": lastId }) };
      const response = await request(path, { headers, signal, cache: "no-store" });
      connection(true);
      for await (const { event, id, data } of eventsOf(response.body)) {
        failures = 0;
        if (id !== null) lastId = id;
        if (take(event, data)) return;
      }
    } catch (error) {
      if (signal.aborted) return;
      // What the service refuses for good (no such job, no right to see it) will not come back by waiting.
      if (error.status >= 400 && !error.passes) throw error;
    }
    if (signal.aborted) return;
    connection(false);
    await pause(WAITS_S[Math.min(failures, WAITS_S.length - 1)], signal);
    failures += 1;
  }
}
