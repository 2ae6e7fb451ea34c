/** What is asked of the robot: to begin a run, and all that a person may ask of one. */

import { signal } from "@preact/signals-core";

import { answered, client, newId, Refusal, untilReached } from "../api/client";
import type { RequestState, RunAsked, RunQuestion } from "../api/types";
import { settled, withPlan } from "./commands";
import { tellError } from "./notices";
import { revision } from "./plan";
import { quiet, run, takeState } from "./run";

const RETRY_MS = 500;
/** ms after which a question that has not reached the service is given up: what the robot is to do is not
 * to be done when nobody expects it any more. To stand still is never too late. */
const PATIENCE_MS = 3_000;
const PATIENCE_TO_STOP_MS = 60_000;
const STOPS: ReadonlySet<string> = new Set(["pause", "stop", "stop_by_hand"]);

/** Begins a run of the mission as it is. Whether it has begun; a notice says why not. */
export function startRun(asked: Partial<RunAsked>): Promise<boolean> {
  return withPlan(async (id) => {
    const begun = await answered(
      client.POST("/api/missions/{id}/runs", {
        params: { path: { id }, header: { "If-Match": `"${revision.value}"` } },
        body: asked as RunAsked,
      }),
    );
    takeState(begun);
  });
}

/** A question without its id, which is given to it when it is asked. */
export type Question = RunQuestion extends infer One
  ? One extends { readonly id: string }
    ? Partial<Omit<One, "id" | "kind">> & { readonly kind: One extends { readonly kind?: infer K } ? NonNullable<K> : never }
    : never
  : never;

/** Kinds of the questions that have not reached the service yet. */
export const asking = signal<readonly string[]>([]);

/** Asks something of the run. What became of it so far; null if it was refused at once, or did not reach
 * the service in time. `quietly`: no notice says so if nothing comes of it. `wanted`: whether it still
 * is, where it is sent again. */
export function ask(
  question: Question,
  quietly = false,
  wanted: () => boolean = () => true,
): Promise<RequestState | null> {
  const body = { id: newId(), ...question } as unknown as RunQuestion;
  if (quietly) quiet.add(body.id);
  const send = (id: string) =>
    answered(client.POST("/api/runs/{run}/requests", { params: { path: { run: id } }, body }));
  return asked(question.kind, send, quietly, wanted);
}

/** Gives the robot back with the mission as it is edited now. */
export async function giveBackEdited(): Promise<RequestState | null> {
  await settled();
  const body = { id: newId() };
  const header = { "If-Match": `"${revision.value}"` };
  return asked("go_on_edited", (id) =>
    answered(client.POST("/api/runs/{run}/plan", { params: { path: { run: id }, header }, body })),
  );
}

async function asked(
  kind: string,
  send: (run: string) => Promise<RequestState>,
  quietly = false,
  wanted: () => boolean = () => true,
): Promise<RequestState | null> {
  const id = run.value?.id;
  if (id === undefined) return null;
  const end = performance.now() + (STOPS.has(kind) ? PATIENCE_TO_STOP_MS : PATIENCE_MS);
  const goesOn = () => run.value?.id === id && wanted() && performance.now() < end;
  asking.value = [...asking.value, kind];
  try {
    return await untilReached(() => send(id), goesOn, RETRY_MS);
  } catch (error) {
    if (!(quietly && error instanceof Refusal)) tellError(error);
    return null;
  } finally {
    const at = asking.value.indexOf(kind);
    asking.value = asking.value.filter((_, other) => other !== at);
  }
}
