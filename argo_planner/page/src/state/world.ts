/** The site and its obstacles. */

import { batch, computed, signal } from "@preact/signals-core";

import { responseData, client, newId, Unreached } from "../api/client";
import type { Obstacle, World } from "../api/types";
import { showError, withErrorNotice } from "./notices";

export const world = signal<World | null>(null);
/** Revision of the obstacles; what depends on them is read again when it changes. */
export const obstacleRevision = signal(0);

export const checkpointsById = computed(
  () => new Map((world.value?.checkpoints ?? []).map((one) => [String(one.id), one])),
);

/** Read the site. Throws `Refusal` or `Unreached`. */
export async function readWorld(): Promise<void> {
  const [found, obstacles] = await Promise.all([
    responseData(client.GET("/api/world")),
    responseData(client.GET("/api/world/obstacles")),
  ]);
  const older = world.value !== null && obstacles.revision < obstacleRevision.value;
  if (older) return; // a newer answer came first
  batch(() => {
    // The obstacles of this revision: the other answer may be older or newer.
    world.value = { ...found, obstacles: obstacles.obstacles };
    obstacleRevision.value = obstacles.revision;
  });
}

/** Read the site again if its obstacles have changed. */
export function obstaclesChanged(): void {
  readAgain().catch((error: unknown) => {
    if (!(error instanceof Unreached)) showError(error); // it is read again when the connection returns
  });
}

async function readAgain(): Promise<void> {
  const { revision } = await responseData(client.GET("/api/world/obstacles"));
  if (world.value === null || revision !== obstacleRevision.value) await readWorld();
}

/** Add an obstacle to the site. Returns whether it was added. */
export function addObstacle(obstacle: Omit<Obstacle, "id">): Promise<boolean> {
  return putObstacles([...(world.value?.obstacles ?? []), { ...obstacle, id: newId() }]);
}

export function removeObstacle(id: string): Promise<boolean> {
  return putObstacles((world.value?.obstacles ?? []).filter((one) => one.id !== id));
}

async function putObstacles(obstacles: readonly Obstacle[]): Promise<boolean> {
  const done = await withErrorNotice(async () => {
    await responseData(
      client.PUT("/api/world/obstacles", {
        params: { header: { "If-Match": `"${obstacleRevision.value}"` } },
        body: { obstacles },
      }),
    );
    await readWorld();
  });
  if (!done) await withErrorNotice(readWorld);
  return done;
}
