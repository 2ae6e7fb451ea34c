/** The floors as they are drawn: their plans, paths and tasks. */

import { computed } from "@preact/signals-core";

import type { World } from "../api/types";
import { frameOf, pathsOnFloors, type DrawingFrame } from "../model/floor-drawing";
import { nameOfKey } from "../model/outline";
import { floorPlans } from "../state/floor-plans";
import { selection } from "../state/plan";
import { preview } from "../state/preview";
import { world } from "../state/world";
import type { DrawnFloor } from "./drawing";
import { places } from "./state";

const chosen = computed(() => new Set(selection.value.map(nameOfKey)));

/** Return what is drawn of floors whose plans are there, each in a room of this size (px). */
export function drawnFloors(numbers: readonly number[], width: number, height: number): DrawnFloor[] {
  const site = world.value;
  if (site === null) return [];
  const plans = numbers.flatMap((number) => floorPlans.value.get(number) ?? []);
  const frames = new Map<number, DrawingFrame>(plans.map((plan) => [plan.number, frameOf(plan.bounds, width, height)]));
  const paths = preview.value === null ? null : pathsOnFloors(preview.value, site.floors, frames);
  return plans.map((plan) => ({
    site,
    plan,
    frame: frames.get(plan.number) as DrawingFrame,
    places: places.value.filter((place) => place.floor === plan.number),
    paths: paths?.get(plan.number) ?? null,
    chosen: chosen.value,
  }));
}

/** Return the numbers of all floors. */
export function allFloors(site: World | null): number[] {
  return (site?.floors ?? []).map((floor) => floor.number);
}
