/** The outlines of the floors, read once: obstacles are not among them. */

import { signal } from "@preact/signals-core";

import { client, responseData, retryUntilReached } from "../api/client";
import type { FloorPlan } from "../api/types";

/** The plans that are read so far, by the number of the floor. */
export const floorPlans = signal<ReadonlyMap<number, FloorPlan>>(new Map());
const RETRY_MS = 2_000;
const asked = new Set<number>();

/** Read the plans of these floors, unless they were read before. Throws `Refusal`. */
export async function readFloorPlans(floors: readonly number[]): Promise<void> {
  const missing = floors.filter((floor) => !asked.has(floor));
  for (const floor of missing) asked.add(floor);
  try {
    const found = await Promise.all(missing.map(readFloorPlan));
    if (found.length > 0)
      floorPlans.value = new Map([...floorPlans.value, ...found.map((plan) => [plan.number, plan] as const)]);
  } catch (error) {
    for (const floor of missing) asked.delete(floor);
    throw error;
  }
}

function readFloorPlan(floor: number): Promise<FloorPlan> {
  const read = () => responseData(client.GET("/api/world/floors/{floor}/plan", { params: { path: { floor } } }));
  return retryUntilReached(read, () => true, RETRY_MS);
}
