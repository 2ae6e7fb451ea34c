/** Requests to the service. Errors of any kind become a `Refusal` or an `Unreached`. */

import createClient from "openapi-fetch";

import type { paths } from "./schema";
import type { Problem } from "./types";

/** The service has refused a request, and has said why. */
export class Refusal extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail);
  }
}

/** No answer has come: the service is not there, or the network is not. */
export class Unreached extends Error {}

/** The code of a service that has too much to do for now. */
const FULL = "full";

let author = "";

/** Says who is working, with each request from now on. */
export function workAs(name: string): void {
  author = name;
}

export const client = createClient<paths>({ baseUrl: location.origin });

client.use({
  onRequest({ request }) {
    if (author !== "") request.headers.set("Argo-Author", encodeURIComponent(author));
    return request;
  },
  onError({ error }) {
    return new Unreached(error instanceof Error ? error.message : String(error));
  },
});

interface Answer<T> {
  data?: T;
  error?: unknown;
  response: Response;
}

/** What a request has brought. Throws `Refusal` or `Unreached`. */
export async function answered<T>(asked: Promise<Answer<T>>): Promise<T> {
  const { data, error, response } = await asked;
  if (response.ok) return data as T;
  if (isProblem(error) && error.code !== FULL) throw new Refusal(error);
  throw new Unreached(`${response.status} ${response.statusText}`);
}

function isProblem(found: unknown): found is Problem {
  return typeof found === "object" && found !== null && "code" in found && "detail" in found;
}

/** A file of the service. Throws `Unreached`. */
export async function fetched(path: string): Promise<ArrayBuffer> {
  try {
    const response = await fetch(path);
    if (response.ok) return await response.arrayBuffer();
    throw new Unreached(`${path}: ${response.status}`);
  } catch (error) {
    throw error instanceof Unreached ? error : new Unreached(`${path}: ${String(error)}`);
  }
}

/** An id for a command or a request, which nobody else has. */
export function newId(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(12));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Who is working, as sockets are told it. */
export function authorQuery(): string {
  return author === "" ? "" : `author=${encodeURIComponent(encodeURIComponent(author))}`;
}

export function pause(ms: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}

/** What a request brings, which is sent again every `ms` while the service is not reached and it is
 * still wanted. Throws `Refusal`, and `Unreached` where it is not wanted any more. */
export async function untilReached<T>(send: () => Promise<T>, wanted: () => boolean, ms: number): Promise<T> {
  for (;;)
    try {
      return await send();
    } catch (error) {
      if (!(error instanceof Unreached) || !wanted()) throw error;
      await pause(ms);
      if (!wanted()) throw error;
    }
}
