/** A fake service: it answers as the test says, and records the requests. */

import { vi } from "vitest";

export interface Asked {
  readonly method: string;
  readonly path: string;
  readonly body: unknown;
  readonly ifMatch: string | null;
}

/** A status with a body; null: the service is not reached. */
export type Answer = readonly [status: number, body: unknown] | null;

/** The parts of a `Request` that the client uses. */
class FakeRequest {
  readonly method: string;
  readonly headers: Headers;
  readonly body: string | null;

  constructor(
    readonly url: string,
    init: { method?: string; headers?: HeadersInit; body?: string | null } = {},
  ) {
    this.method = init.method ?? "GET";
    this.headers = new Headers(init.headers);
    this.body = init.body ?? null;
  }
}
let asked: Asked[] = [];
let answer: (asked: Asked) => Answer = () => null;

function fakeFetch(request: FakeRequest): Promise<unknown> {
  const one = {
    method: request.method,
    path: new URL(request.url).pathname,
    body: request.body === null ? null : (JSON.parse(request.body) as unknown),
    ifMatch: request.headers.get("If-Match"),
  };
  asked.push(one);
  const found = answer(one);
  if (found === null) return Promise.reject(new TypeError("not reached"));
  const [status, body] = found;
  const said = JSON.stringify(body);
  return Promise.resolve({
    status,
    ok: status < 300,
    headers: new Headers({ "content-type": "application/json" }),
    json: () => Promise.resolve(JSON.parse(said) as unknown),
    text: () => Promise.resolve(said),
  });
}

// The client stores both when it is loaded, so this module must be imported before anything of the page.
vi.stubGlobal("Request", FakeRequest);
vi.stubGlobal("fetch", fakeFetch);

/** Set the answers of the service; return the requests that it gets. */
export function fakeService(answers: (asked: Asked) => Answer): Asked[] {
  answer = answers;
  asked = [];
  return asked;
}

/** Return a refusal of the service. */
export function problem(status: number, code: string, more: object = {}) {
  return [status, { status, code, detail: code, diagnostics: [], remedies: [], ...more }] as const;
}
