/** A service that answers what a test says, and keeps what it was asked. */

import { vi } from "vitest";

export interface Asked {
  readonly method: string;
  readonly path: string;
  readonly body: unknown;
  readonly ifMatch: string | null;
}

/** What is answered: a status with a body, or nothing, as the service is not reached. */
export type Answer = readonly [status: number, body: unknown] | null;

/** What a request is made of, as the client makes it. */
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

// The client keeps both as it is made: whoever imports this does so before anything of the page.
vi.stubGlobal("Request", FakeRequest);
vi.stubGlobal("fetch", fakeFetch);

/** From now on the service answers so; what it is asked. */
export function fakeService(answers: (asked: Asked) => Answer): Asked[] {
  answer = answers;
  asked = [];
  return asked;
}

/** A refusal of the service. */
export function problem(status: number, code: string, more: object = {}) {
  return [status, { status, code, detail: code, diagnostics: [], remedies: [], ...more }] as const;
}
