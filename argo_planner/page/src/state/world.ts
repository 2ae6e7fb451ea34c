/** The site: what stands on it, and where the robot can stand. */

import { computed, signal } from "@preact/signals-core";

import { answered, client, newId } from "../api/client";
import type { Obstacle, World } from "../api/types";
import { tellError } from "./notices";

export const world = signal<World | null>(null);
/** How often the obstacles have changed; what depends on them is asked for again. */
export const obstacleRevision = signal(0);

export const checkpointsById = computed(
  () => new Map((world.value?.checkpoints ?? []).map((one) => [String(one.id), one])),
);

/** Reads the site. Throws `Refusal` or `Unreached`. */
export async function readWorld(): Promise<void> {
  const [found, obstacles] = await Promise.all([
    answered(client.GET("/api/world")),
    answered(client.GET("/api/world/obstacles")),
  ]);
  world.value = found;
  obstacleRevision.value = obstacles.revision;
}

/** The obstacles are others: reads them. */
export function obstaclesChanged(): void {
  readWorld().catch(tellError);
}

/** Puts an obstacle on the site. Whether it stands there. */
export function addObstacle(obstacle: Omit<Obstacle, "id">): Promise<boolean> {
  return putObstacles([...(world.value?.obstacles ?? []), { ...obstacle, id: newId() }]);
}

export function removeObstacle(id: string): Promise<boolean> {
  return putObstacles((world.value?.obstacles ?? []).filter((one) => one.id !== id));
}

async function putObstacles(obstacles: readonly Obstacle[]): Promise<boolean> {
  try {
    await answered(
      client.PUT("/api/world/obstacles", {
        params: { header: { "If-Match": `"${obstacleRevision.value}"` } },
        body: { obstacles },
      }),
    );
    await readWorld();
    return true;
  } catch (error) {
    tellError(error);
    await readWorld().catch(tellError);
    return false;
  }
}
