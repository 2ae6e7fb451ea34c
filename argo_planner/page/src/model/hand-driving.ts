/** Driving by hand: keys, goals, and allowed paths. */

import type { Pose } from "../api/types";

export type Direction = "forward" | "backward" | "left" | "right";

const KEYS: Readonly<Record<string, Direction>> = {
  ArrowUp: "forward",
  KeyW: "forward",
  ArrowDown: "backward",
  KeyS: "backward",
  ArrowLeft: "left",
  KeyA: "left",
  ArrowRight: "right",
  KeyD: "right",
};

/** Distances (m) ahead of the robot, tried in this order. With a far goal the robot drives on without
 * stopping in between; letting the key go stops it anyway. */
export const REACHES: readonly number[] = [2, 1, 0.5, 0.25];
const BACK = 0.5; // part of the distance that is used backwards, where the person sees less
const TURN = Math.PI / 2; // rad
const ROOM = 0.4; // m that a straight path may be longer than the distance, as poses are on a grid
const LEAST = 0.08; // m
const SOONEST = 0.3; // s: shorter paths don't move or turn the robot

/** Return the driving direction of a key by its `code`; null: it is no driving key. */
export function directionOf(code: string): Direction | null {
  return KEYS[code] ?? null;
}

/** Return the goal pose: `reach` m ahead, or turned in place. */
export function goalOf(
  pose: readonly [number, number, number, number, number],
  direction: Direction,
  reach: number,
): Pose {
  const [x, y, z, yaw, pitch] = pose;
  switch (direction) {
    case "forward":
    case "backward": {
      const way = direction === "forward" ? reach : -BACK * reach;
      const flat = way * Math.cos(pitch);
      // On stairs the goal follows the robot's pitch, which is positive with the front down.
      const up = -way * Math.sin(pitch);
      return { x: x + flat * Math.cos(yaw), y: y + flat * Math.sin(yaw), z: z + up, yaw };
    }
    case "left":
    case "right": {
      const turned = yaw + (direction === "left" ? TURN : -TURN) * Math.min(1, reach);
      return { x, y, z, yaw: Math.atan2(Math.sin(turned), Math.cos(turned)) };
    }
  }
}

/** Return the distances to try; a turn has only one. */
export function reachesOf(direction: Direction): readonly number[] {
  return direction === "left" || direction === "right" ? [1, 0.5, 0.25] : REACHES;
}

/** Return whether a path leads straight to the goal: it is no detour, and not so short that the robot is
 * already there. */
export function isStraight(
  way: { readonly distance: number; readonly time?: number | null },
  direction: Direction,
  reach: number,
): boolean {
  if (typeof way.time !== "number" || way.time < SOONEST) return false;
  if (direction === "left" || direction === "right") return way.distance < ROOM;
  const meant = direction === "forward" ? reach : BACK * reach;
  return way.distance > LEAST && way.distance < meant + ROOM;
}
