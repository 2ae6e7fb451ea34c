/** Requests to the service. Every error becomes a `Refusal` or an `Unreached`. */

import createClient from "openapi-fetch";

import type { paths } from "./schema";
import type { Problem } from "./types";

/** An error of a request that the service refused, with its reason. */
export class Refusal extends Error {
  constructor(readonly problem: Problem) {
    super(problem.detail);
  }
}

/** An error of a request that got no answer: the service or the network is not available. */
export class Unreached extends Error {}

/** The error code of an overloaded service. */
const FULL = "full";

let author = "";

/** Set the name of the person that all further requests carry. */
export function setAuthor(name: string): void {
  author = name;
}

export const client = createClient<paths>({ baseUrl: location.origin });

client.use({
  onRequest({ request }) {
    if (author !== "") request.headers.set("Argo-Author", encodeURIComponent(author));
    return request;
  },
});

interface Answer<T> {
  data?: T;
  error?: unknown;
  response: Response;
}

/** Return the data of a response. Throws `Refusal` or `Unreached`. */
export async function responseData<T>(asked: Promise<Answer<T>>): Promise<T> {
  // An error here is the network's, also one while the body arrives.
  const { data, error, response } = await asked.catch((lost: unknown) => {
    throw new Unreached(String(lost));
  });
  if (response.ok) return data as T;
  if (isProblem(error) && error.code !== FULL) throw new Refusal(error);
  throw new Unreached(`${response.status} ${response.statusText}`);
}

function isProblem(found: unknown): found is Problem {
  return typeof found === "object" && found !== null && "code" in found && "detail" in found;
}

/** Download a file of the service. Throws `Unreached`. */
export async function fetchFile(path: string): Promise<ArrayBuffer> {
  try {
    const response = await fetch(path);
    if (response.ok) return await response.arrayBuffer();
    throw new Unreached(`${path}: ${response.status}`);
  } catch (error) {
    throw error instanceof Unreached ? error : new Unreached(`${path}: ${String(error)}`);
  }
}

/** Create a unique id for a command or a request. */
export function newId(): string {
  const bytes = crypto.getRandomValues(new Uint8Array(12));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Return the part of a socket's query that names the person. */
export function authorQuery(): string {
  return author === "" ? "" : `author=${encodeURIComponent(encodeURIComponent(author))}`;
}

export function delay(ms: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}

/** Send a request, and repeat it every `ms` while the service can't be reached and the request is still
 * wanted. Throws `Refusal`, or `Unreached` if the request is no longer wanted. */
export async function retryUntilReached<T>(send: () => Promise<T>, wanted: () => boolean, ms: number): Promise<T> {
  for (;;)
    try {
      return await send();
    } catch (error) {
      if (!(error instanceof Unreached) || !wanted()) throw error;
      await delay(ms);
      if (!wanted()) throw error;
    }
}
