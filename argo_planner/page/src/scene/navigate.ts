/** The navigation tool: a ghost of the robot that can be placed where the robot can stand. */

import { computed, effect, signal } from "@preact/signals-core";
import type { Ray, Vector3 } from "three";

import { addPlace, lacksStart } from "../list/adding";
import { floorOf, type GroundVerdict } from "../model/standing-map";
import { mission } from "../state/plan";
import { shownFloor, tool } from "../state/view";
import { world } from "../state/world";
import { t } from "../texts";
import { dependOn } from "../state/depend-on";
import type { Site } from "./site";
import { mapsRead, readMaps, standingVerdict } from "./standing-maps";

export interface GhostPose {
  readonly x: number;
  readonly y: number;
  readonly z: number;
  readonly yaw: number;
  readonly floor: number;
  /** null: not known yet */
  readonly verdict: GroundVerdict | null;
}

/** Cells per step with Shift. */
export const FAST_CELLS = 5;
const TURN = Math.PI / 4;
/** m: height differences that belong to the same ground */
const STEP_UP = 0.3;
/** Highest number of stair steps that a ray passes through, and their thickness (m). */
const MOST_STEPS = 12;
const THROUGH = 0.02;

const ghostPose = signal<Omit<GhostPose, "verdict" | "floor"> | null>(null);
let yaw = 0;

/** Pose of the ghost and whether the robot can stand there; null: there is no ghost. */
export const ghost = computed<GhostPose | null>(() => {
  const at = ghostPose.value;
  const site = world.value;
  if (at === null || site === null) return null;
  dependOn(mapsRead);
  return withVerdict(at, standingVerdict(at.x, at.y, at.z, at.yaw));
});

function withVerdict(at: Omit<GhostPose, "verdict" | "floor">, verdict: GroundVerdict | null): GhostPose {
  const z = verdict !== null && Math.abs(verdict.z - at.z) < STEP_UP ? verdict.z : at.z;
  return { ...at, z, floor: floorOf(world.peek()?.floors ?? [], z)?.number ?? 1, verdict };
}

/** Select the tool: load the maps. */
export function activateNavigation(): void {
  const site = world.value;
  if (site !== null) readMaps(site, shownFloor.peek() ?? site.floors.at(-1)?.number ?? 1);
}

export function hideGhost(): void {
  ghostPose.value = null;
}

/** Move the ghost to where a ray hits the ground. The ray passes through stairs on which the robot can't
 * stand if it can stand behind them. */
export function moveGhostToRay(ray: Ray, site: Site): void {
  const first = site.hitWays(ray);
  let hit = first;
  for (let tries = 0; hit !== null && tries < MOST_STEPS && isStep(hit.point); tries++)
    hit = site.hitWays(ray, hit.distance + THROUGH);
  const behind = hit !== null && hit !== first && groundAt(hit.point) === "reached";
  const meant = behind ? hit : first;
  ghostPose.value = meant && { x: meant.point.x, y: meant.point.y, z: meant.point.z, yaw };
}

/** Return whether a point is above its floor's deck and the robot can't stand there. */
function isStep(point: Vector3): boolean {
  const floor = floorOf(world.peek()?.floors ?? [], point.z);
  return floor !== undefined && point.z > floor.z + STEP_UP && groundAt(point) !== "reached";
}

function groundAt({ x, y, z }: Vector3): string | undefined {
  return standingVerdict(x, y, z, yaw)?.ground;
}

/** Place the ghost, if there is none. */
export function beginGhostAt(x: number, y: number, z: number): void {
  ghostPose.value ??= { x: cellMiddle(x), y: cellMiddle(y), z, yaw };
}

/** Turn the ghost counter-clockwise by steps of 45°. */
export function turnGhost(steps: number): void {
  yaw = Math.atan2(Math.sin(yaw + steps * TURN), Math.cos(yaw + steps * TURN));
  if (ghostPose.value !== null) ghostPose.value = { ...ghostPose.value, yaw };
}

/** Move the ghost by cells, along its ground. */
export function moveGhost(columns: number, rows: number): void {
  const at = ghostPose.value;
  const cell = world.value?.cell ?? 0.1;
  if (at === null) return;
  const steps = Math.max(Math.abs(columns), Math.abs(rows));
  let { x, y, z } = at;
  for (let i = 0; i < steps; i++) {
    x += Math.sign(columns) * cell;
    y += Math.sign(rows) * cell;
    const there = standingVerdict(x, y, z, at.yaw);
    if (there !== null && there.ground !== "none" && Math.abs(there.z - z) < STEP_UP) z = there.z;
  }
  ghostPose.value = { x: cellMiddle(x), y: cellMiddle(y), z, yaw: at.yaw };
}

/** Move the ghost to another floor. */
export function liftGhost(z: number): void {
  if (ghostPose.value !== null) ghostPose.value = { ...ghostPose.value, z };
}

/** Return the middle of the cell, so that steps go from cell to cell. */
function cellMiddle(value: number): number {
  const cell = world.value?.cell ?? 0.1;
  return Math.round((Math.floor(value / cell + 1e-6) + 0.5) * cell * 1e6) / 1e6;
}

/** Whether the next click sets the start. */
export const setsStart = computed(() => mission.value !== null && lacksStart(mission.value));

/** Add a task at the ghost, if the robot can stand there. Returns whether it was added. */
export async function placeGhost(): Promise<boolean> {
  const at = await ghostWithVerdict();
  if (at?.verdict?.ground !== "reached") return false;
  const rounded = (value: number) => Math.round(1000 * value) / 1000;
  const pose = { x: rounded(at.x), y: rounded(at.y), z: rounded(at.z), yaw: at.yaw };
  return addPlace(pose, lacksStart);
}

/** Return the ghost with its verdict. Right after the tool was selected, the maps may still be loading. */
function ghostWithVerdict(): Promise<GhostPose | null> {
  const at = ghostPose.peek();
  return new Promise((resolve) => {
    const stop = effect(() => {
      dependOn(mapsRead);
      const verdict = at && standingVerdict(at.x, at.y, at.z, at.yaw);
      const gone = tool.value !== "navigate";
      if (at !== null && verdict === null && !gone) return;
      resolve(at === null || gone ? null : withVerdict(at, verdict));
      queueMicrotask(() => stop());
    });
  });
}

/** Return the verdict on the ghost in words. */
export function verdictWords(at: GhostPose | null): string {
  const texts = t().scene;
  if (at === null) return texts.offSite;
  if (at.verdict === null) return texts.checking;
  const text = texts.grounds[at.verdict.ground];
  return at.verdict.ground !== "reached" && standsTurned(at) ? `${text} – ${texts.turnIt}` : text;
}

/** Return whether the robot could stand there with another heading. */
function standsTurned({ x, y, z }: GhostPose): boolean {
  return world.peek()?.headings.some((other) => standingVerdict(x, y, z, other)?.ground === "reached") ?? false;
}

/** Describe the pose of the ghost. */
export function ghostWords(at: GhostPose): string {
  const texts = t().scene;
  const eighth = Math.round(at.yaw / TURN);
  const facing = texts.directions[((eighth % 8) + 8) % 8] ?? "";
  return texts.ghostAt(at.x.toFixed(1), at.y.toFixed(1), at.floor, facing);
}
