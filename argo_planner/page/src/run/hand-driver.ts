/** Driving while a key is held: request a pose ahead, and stop the robot when the key is released. */

import { effect, signal } from "@preact/signals-core";

import { responseData, client, Refusal, Unreached } from "../api/client";
import type { Pose } from "../api/types";
import { goalOf, isStraight, reachesOf, type Direction } from "../model/hand-driving";
import { isOver } from "../model/run-mode";
import { sendRequest } from "../state/requests";
import { robotPose, run } from "../state/run";

/** The wanted direction; null: none. */
export const wantedDirection = signal<Direction | null>(null);
/** Whether there is no drivable path in the wanted direction. */
export const blocked = signal(false);

let driving = false;

/** Drive in a direction from now on; null: stop. */
export function drive(direction: Direction | null): void {
  if (wantedDirection.value === direction) return;
  wantedDirection.value = direction;
  blocked.value = false;
  if (direction !== null && !driving) {
    driving = true;
    void driveOn().finally(() => (driving = false));
  }
}

async function driveOn(): Promise<void> {
  for (;;) {
    const direction = wantedDirection.value;
    if (direction === null || run.value?.mode !== "supervised") break;
    blocked.value = !(await driveStep(direction));
    if (blocked.value) await directionChange(direction);
  }
  wantedDirection.value = null;
}

/** Drive in a direction until it is no longer wanted or the goal is reached. Returns whether there was a path. */
async function driveStep(direction: Direction): Promise<boolean> {
  for (const reach of reachesOf(direction)) {
    const from = robotPose.value;
    if (from === null) return false;
    const goal = goalOf(from.pose, direction, reach);
    if (!(await isFree(from.pose, goal, direction, reach))) continue;
    if (wantedDirection.value !== direction) return true;
    const asked = await sendRequest({ kind: "drive_to", pose: goal }, true, () => wantedDirection.value === direction);
    if (asked === null) return false;
    const how = await requestEnd(asked.id, direction);
    if (wantedDirection.value !== direction) {
      const stop = await sendRequest({ kind: "stop_by_hand" }, true);
      if (stop !== null) await requestEnd(stop.id, null);
      return true;
    }
    if (how === null) return false;
    if (how === "confirmed") return true;
  }
  return false;
}

/** Return whether the robot would drive straight to the goal. The navigator avoids obstacles, but a person
 * who holds a key expects no detour. */
async function isFree(
  from: readonly [number, number, number, number, number],
  goal: Pose,
  direction: Direction,
  reach: number,
): Promise<boolean> {
  const [x, y, z, yaw] = from;
  try {
    const body = { start: { x, y, z, yaw }, goal };
    const way = await responseData(client.POST("/api/world/way", { body }));
    return isStraight(way, direction, reach);
  } catch (error) {
    if (error instanceof Refusal || error instanceof Unreached) return false;
    throw error;
  }
}

/** Wait for the end of a request; null: another direction is wanted, or the run has ended. */
function requestEnd(id: string, direction: Direction | null): Promise<string | null> {
  return untilFound(() => {
    const found = run.value?.requests.find((one) => one.id === id);
    if (found && isOver(found)) return { value: found.progress };
    if (direction !== null && wantedDirection.value !== direction) return { value: null };
    return run.value === null || run.value.status !== "running" ? { value: null } : null;
  });
}

function directionChange(direction: Direction): Promise<null> {
  return untilFound(() => (wantedDirection.value === direction ? null : { value: null }));
}

/** Wait until `found` returns a value. */
function untilFound<T>(found: () => { readonly value: T } | null): Promise<T> {
  return new Promise((resolve) => {
    let done = false;
    const stop = effect(() => {
      const one = found();
      if (one === null || done) return;
      done = true;
      resolve(one.value);
      queueMicrotask(() => stop());
    });
  });
}
