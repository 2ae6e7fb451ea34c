/** The run that the robot is in or was in last, as the service tells it. */

import { batch, computed, signal } from "@preact/signals-core";

import { answered, authorQuery, client, newId, Unreached } from "../api/client";
import { LiveConnection } from "../api/live";
import type {
  Entry,
  RequestState,
  RunAsked,
  RunMessage,
  RunQuestion,
  RunState,
} from "../api/types";
import { tell, tellError } from "./notices";
import { planId, revision } from "./plan";

export interface RobotPose {
  readonly t: number;
  /** x, y, z (m), yaw, pitch (rad) */
  readonly pose: readonly [number, number, number, number, number];
  readonly charge: number | null;
}

export const run = signal<RunState | null>(null);
export const robotPose = signal<RobotPose | null>(null);
/** What has happened in the run, in order. */
export const entries = signal<readonly Entry[]>([]);
/** Whether a run is under way, or waits to go on. */
export const runIsOn = computed(() => run.value !== null && run.value.status !== "ended");
export const robotConnected = signal(false);

const RETRY_MS = 1_000;
let live: LiveConnection<RunMessage> | null = null;

/** Follows whatever the robot does, from now on. */
export function followRobot(): void {
  live ??= new LiveConnection<RunMessage>({
    address: () => `/api/robot/live?${[since(), authorQuery()].filter(Boolean).join("&")}`,
    heard,
    changed: (there) => (robotConnected.value = there),
  });
}

function since(): string {
  return entries.value.length > 0 ? `since=${entries.value.length}` : "";
}

/** Begins a run of the mission as it is. Whether it has begun; a notice says why not. */
export async function startRun(asked: Partial<RunAsked>): Promise<boolean> {
  const id = planId.value;
  if (id === null) return false;
  try {
    const begun = await answered(
      client.POST("/api/missions/{id}/runs", {
        params: { path: { id }, header: { "If-Match": `"${revision.value}"` } },
        body: asked as RunAsked,
      }),
    );
    takeState(begun);
    return true;
  } catch (error) {
    tellError(error);
    return false;
  }
}

/** A question without its id, which is given to it when it is asked. */
export type Question = RunQuestion extends infer One
  ? One extends { readonly id: string }
    ? Partial<Omit<One, "id" | "kind">> & { readonly kind: One extends { readonly kind?: infer K } ? NonNullable<K> : never }
    : never
  : never;

/** Asks something of the run. What became of it so far; null if it was refused at once. */
export function ask(question: Question): Promise<RequestState | null> {
  const body = { id: newId(), ...question } as unknown as RunQuestion;
  return asked((id) =>
    answered(client.POST("/api/runs/{run}/requests", { params: { path: { run: id } }, body })),
  );
}

/** Gives the robot back with the mission as it is edited now. */
export function giveBackEdited(): Promise<RequestState | null> {
  const body = { id: newId() };
  return asked((id) =>
    answered(
      client.POST("/api/runs/{run}/plan", {
        params: { path: { run: id }, header: { "If-Match": `"${revision.value}"` } },
        body,
      }),
    ),
  );
}

async function asked(
  send: (run: string) => Promise<RequestState>,
): Promise<RequestState | null> {
  const id = run.value?.id;
  while (id !== undefined && run.value?.id === id) {
    try {
      return await send(id);
    } catch (error) {
      if (!(error instanceof Unreached)) {
        tellError(error);
        return null;
      }
      await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
    }
  }
  return null;
}

function takeState(state: RunState | null): void {
  batch(() => {
    if (state?.id !== run.value?.id) {
      entries.value = [];
      robotPose.value = null;
    }
    run.value = state;
  });
}

function heard(message: RunMessage): void {
  switch (message.kind) {
    case "state":
      takeState(message.state);
      break;
    case "pose":
      if (message.run === run.value?.id)
        robotPose.value = { t: message.t, pose: message.pose, charge: message.charge };
      break;
    case "entry":
      if (message.number === entries.value.length + 1)
        entries.value = [...entries.value, message.entry];
      break;
    case "request":
      if (message.request.reason && message.request.progress !== "confirmed")
        tell("warn", message.request.reason);
      break;
  }
}
