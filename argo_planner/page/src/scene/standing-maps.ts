/** The maps of where the robot can stand, loaded once for each state of the site. */

import { signal } from "@preact/signals-core";

import { fetchFile, delay, Unreached } from "../api/client";
import type { World } from "../api/types";
import { floorOf, readStandingMap, type GroundVerdict, type StandingMap, verdictAt } from "../model/standing-map";
import { world } from "../state/world";

const AT_ONCE = 4;
const RETRY_MS = 1_000;
const maps = new Map<string, StandingMap>();
let digest = "";
let reading = "";

/** Number of loaded maps, a signal for their users. */
export const mapsRead = signal(0);

/** Load the maps of all floors, beginning with `first`, so that no request is needed while the pointer moves. */
export function readMaps(site: World, first: number): void {
  if (reading === site.digest) return;
  reading = digest = site.digest;
  maps.clear();
  const numbers = site.floors.map((floor) => floor.number);
  numbers.sort((a, b) => Math.abs(a - first) - Math.abs(b - first));
  const waiting = numbers.flatMap((floor) => site.headings.map((_, heading) => `${floor} ${heading}`));
  for (let worker = 0; worker < AT_ONCE; worker++) void read(site.digest, waiting);
}

async function read(of: string, waiting: string[]): Promise<void> {
  for (let key = waiting.shift(); key !== undefined; key = waiting.shift()) {
    const [floor = "", heading = ""] = key.split(" ");
    try {
      const map = await readStandingMap(await fetchFile(`/api/world/floors/${floor}/standing/${heading}`));
      if (of !== digest) return;
      maps.set(key, map);
      mapsRead.value++;
    } catch (error) {
      if (!(error instanceof Unreached)) throw error;
      waiting.push(key);
      await delay(RETRY_MS);
      if (of !== digest) return;
    }
  }
}

/** Return whether the robot can stand at a pose (m, rad); null: unknown yet. */
export function standingVerdict(x: number, y: number, z: number, yaw: number): GroundVerdict | null {
  const site = world.peek();
  if (site === null || site.digest !== digest) return null;
  const floor = floorOf(site.floors, z);
  if (floor === undefined) return null;
  return verdictAt((heading) => maps.get(`${floor.number} ${heading}`), site.headings, x, y, z, yaw);
}
