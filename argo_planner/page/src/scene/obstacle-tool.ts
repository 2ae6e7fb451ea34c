/** The obstacle tool: two corners span a box on the ground. */

import { computed, signal } from "@preact/signals-core";

import type { Obstacle } from "../api/types";
import { tool } from "../state/view";
import { addObstacle } from "../state/world";
import type { Hit } from "./site";

interface Corner {
  readonly x: number;
  readonly y: number;
  readonly z: number;
}

/** m */
const LEAST = 0.1;
const MOST = 20;
/** m per key press */
const STEP = 0.1;
export const FIRST_HEIGHT = 0.5;

/** The clicked corners, and the one under the pointer. */
export const corners = signal<{
  readonly first: Corner | null;
  readonly second: Corner | null;
  readonly pointed: Corner | null;
} | null>(null);
export const height = signal(FIRST_HEIGHT);

/** The box that would be added. */
export const spannedBox = computed<Pick<Obstacle, "pose" | "size"> | null>(() => {
  const { first = null, second = null, pointed = null } = corners.value ?? {};
  const other = second ?? pointed;
  if (other === null) return null;
  if (first === null) return { pose: { ...other, yaw: 0 }, size: [LEAST, LEAST, height.value] };
  const side = (a: number, b: number) => Math.min(MOST, Math.max(LEAST, rounded(Math.abs(a - b))));
  return {
    pose: { x: rounded((first.x + other.x) / 2), y: rounded((first.y + other.y) / 2), z: first.z, yaw: 0 },
    size: [side(first.x, other.x), side(first.y, other.y), height.value],
  };
});

export function pointCorner(hit: Hit | null): void {
  const now = corners.value;
  if (now?.second) return;
  corners.value = { first: now?.first ?? null, second: null, pointed: hit && cornerOf(hit) };
}

export function clickCorner(hit: Hit | null): void {
  if (hit !== null) takeCorner(cornerOf(hit));
}

/** Set the corner that the keys have moved. */
export function setPointedCorner(): void {
  const at = corners.value?.pointed;
  if (at) takeCorner(at);
}

/** Place the moved corner, if there is none. */
export function beginCorner(at: Corner): void {
  const now = corners.value;
  if (now?.second || now?.pointed) return;
  const pointed = now?.first ?? { x: rounded(at.x), y: rounded(at.y), z: rounded(at.z) };
  corners.value = { first: now?.first ?? null, second: null, pointed };
}

/** Move the corner by steps along x and y. */
export function moveCorner(columns: number, rows: number): void {
  const now = corners.value;
  if (!now?.pointed || now.second) return;
  const { x, y, z } = now.pointed;
  corners.value = { ...now, pointed: { x: rounded(x + STEP * columns), y: rounded(y + STEP * rows), z } };
}

/** Move the corner to another floor (m). */
export function liftCorner(z: number): void {
  const now = corners.value;
  if (now?.pointed && now.first === null) corners.value = { ...now, pointed: { ...now.pointed, z } };
}

function takeCorner(corner: Corner): void {
  const now = corners.value;
  if (now?.second) return;
  corners.value = now?.first
    ? { ...now, second: corner, pointed: null }
    : { first: corner, second: null, pointed: null };
}

export function hideCorners(): void {
  corners.value = null;
}

/** Add the box as an obstacle. Returns whether it was added. */
export async function addSpannedBox(name: string): Promise<boolean> {
  const box = spannedBox.value;
  if (box === null) return false;
  const done = await addObstacle({ ...box, name });
  if (done) {
    hideCorners();
    tool.value = "select";
  }
  return done;
}

function cornerOf({ point }: Hit): Corner {
  return { x: rounded(point.x), y: rounded(point.y), z: rounded(point.z) };
}

function rounded(value: number): number {
  return Math.round(100 * value) / 100;
}
