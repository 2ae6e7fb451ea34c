/** The site: what stands on it, and where the robot can stand. */

import { batch, computed, signal } from "@preact/signals-core";

import { answered, client, newId, Unreached } from "../api/client";
import type { Obstacle, World } from "../api/types";
import { tellError, telling } from "./notices";

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
  const older = world.value !== null && obstacles.revision < obstacleRevision.value;
  if (older) return; // another reading was faster
  batch(() => {
    // Those that the revision is of: the other answer may be of a moment before or after.
    world.value = { ...found, obstacles: obstacles.obstacles };
    obstacleRevision.value = obstacles.revision;
  });
}

/** The obstacles may be others: reads the site again if they are. */
export function obstaclesChanged(): void {
  readAgain().catch((error: unknown) => {
    if (!(error instanceof Unreached)) tellError(error); // the connection comes back, and asks again
  });
}

async function readAgain(): Promise<void> {
  const { revision } = await answered(client.GET("/api/world/obstacles"));
  if (world.value === null || revision !== obstacleRevision.value) await readWorld();
}

/** Puts an obstacle on the site. Whether it stands there. */
export function addObstacle(obstacle: Omit<Obstacle, "id">): Promise<boolean> {
  return putObstacles([...(world.value?.obstacles ?? []), { ...obstacle, id: newId() }]);
}

export function removeObstacle(id: string): Promise<boolean> {
  return putObstacles((world.value?.obstacles ?? []).filter((one) => one.id !== id));
}

async function putObstacles(obstacles: readonly Obstacle[]): Promise<boolean> {
  const done = await telling(async () => {
    await answered(
      client.PUT("/api/world/obstacles", {
        params: { header: { "If-Match": `"${obstacleRevision.value}"` } },
        body: { obstacles },
      }),
    );
    await readWorld();
  });
  if (!done) await telling(readWorld);
  return done;
}
