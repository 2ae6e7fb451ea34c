/** Requests to the robot: start a run, and control it. */

import { signal } from "@preact/signals-core";

import { responseData, client, newId, Refusal, retryUntilReached } from "../api/client";
import type { RequestState, RunAsked, RunRequestBody } from "../api/types";
import { allAnswered, tryWithPlan } from "./commands";
import { showError } from "./notices";
import { revision } from "./plan";
import { quietRequests, run, takeState } from "./run";

const RETRY_MS = 500;
/** ms after which a request that has not reached the service is given up: a late motion would surprise
 * people. Stopping is never too late. */
const PATIENCE_MS = 3_000;
const PATIENCE_TO_STOP_MS = 60_000;
const STOPS: ReadonlySet<string> = new Set(["pause", "stop", "stop_by_hand"]);

/** Start a run of the mission in its present state. Returns why it has not begun; null: it has. */
export function startRun(asked: Partial<RunAsked>): Promise<string | null> {
  return tryWithPlan(async (id) => {
    const begun = await responseData(
      client.POST("/api/missions/{id}/runs", {
        params: { path: { id }, header: { "If-Match": `"${revision.value}"` } },
        body: asked as RunAsked,
      }),
    );
    takeState(begun);
  });
}

/** A request without its id, which `sendRequest` adds. */
export type RunRequest = RunRequestBody extends infer One
  ? One extends { readonly id: string }
    ? Partial<Omit<One, "id" | "kind">> & { readonly kind: One extends { readonly kind?: infer K } ? NonNullable<K> : never }
    : never
  : never;

/** Kinds of the requests that have not reached the service yet. */
export const pendingRequests = signal<readonly string[]>([]);

/** Send a request to the run. Returns its state so far; null if it was refused or did not reach the service
 * in time. `quietly`: no notice reports a refusal or failure. `wanted`: whether the request is still wanted
 * when it is sent again. */
export function sendRequest(
  question: RunRequest,
  quietly = false,
  wanted: () => boolean = () => true,
): Promise<RequestState | null> {
  const body = { id: newId(), ...question } as unknown as RunRequestBody;
  if (quietly) quietRequests.add(body.id);
  const send = (id: string) =>
    responseData(client.POST("/api/runs/{run}/requests", { params: { path: { run: id } }, body }));
  return sendUntilReached(question.kind, send, quietly, wanted);
}

/** Give the robot back with the edited mission. */
export async function giveBackEdited(): Promise<RequestState | null> {
  await allAnswered();
  const body = { id: newId() };
  const header = { "If-Match": `"${revision.value}"` };
  return sendUntilReached("go_on_edited", (id) =>
    responseData(client.POST("/api/runs/{run}/plan", { params: { path: { run: id }, header }, body })),
  );
}

async function sendUntilReached(
  kind: string,
  send: (run: string) => Promise<RequestState>,
  quietly = false,
  wanted: () => boolean = () => true,
): Promise<RequestState | null> {
  const id = run.value?.id;
  if (id === undefined) return null;
  const end = performance.now() + (STOPS.has(kind) ? PATIENCE_TO_STOP_MS : PATIENCE_MS);
  const goesOn = () => run.value?.id === id && wanted() && performance.now() < end;
  pendingRequests.value = [...pendingRequests.value, kind];
  try {
    return await retryUntilReached(() => send(id), goesOn, RETRY_MS);
  } catch (error) {
    if (!(quietly && error instanceof Refusal)) showError(error);
    return null;
  } finally {
    const at = pendingRequests.value.indexOf(kind);
    pendingRequests.value = pendingRequests.value.filter((_, other) => other !== at);
  }
}
