/** Driving by hand: which keys drive, and where to. */

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

/** m ahead of the robot that are asked for, the first that can be driven. Further ones make the robot
 * drive on without standing still in between; whoever lets go of the key stops it anyway. */
export const REACHES: readonly number[] = [2, 1, 0.5, 0.25];
const BACK = 0.5; // of the reach: backwards nobody looks as far
const TURN = Math.PI / 2; // rad
const ROOM = 0.4; // m that a straight way may be longer, as places are on a grid
const LEAST = 0.08; // m
const SOONEST = 0.3; // s: what takes less is no drive and no turn

/** The direction of a key by its `code`; null: it drives nowhere. */
export function directionOf(code: string): Direction | null {
  return KEYS[code] ?? null;
}

/** The pose to ask for: `reach` m on, or turned in place. */
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
      // On stairs it goes on as steeply as the robot stands; its pitch is positive with the front down.
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

/** How many reaches there are to try: a turn is possible or not. */
export function reachesOf(direction: Direction): readonly number[] {
  return direction === "left" || direction === "right" ? [1, 0.5, 0.25] : REACHES;
}

/** Whether a way there is the straight one that was meant: neither a detour round something, nor so
 * short that the robot as good as stands there already. */
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
