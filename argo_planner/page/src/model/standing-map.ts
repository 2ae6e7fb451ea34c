/** Maps of the poses at which the robot can stand, read without further requests to the service. */

import type { WorldFloor } from "../api/types";

export type Ground = "none" | "too_near" | "too_steep" | "cut_off" | "closed" | "reached";

/** The cells of a floor for one heading. Cells above each other are in layers, the lower one first. */
export interface StandingMap {
  readonly floor: number;
  readonly heading: number;
  /** rad */
  readonly yaw: number;
  /** m, the corner of the first cell with the least x and y */
  readonly origin: readonly [number, number];
  /** m, edge of a cell */
  readonly cell: number;
  readonly layers: number;
  readonly rows: number;
  readonly columns: number;
  /** m, height of the floor, and the unit of the heights above it */
  readonly z: number;
  readonly step: number;
  /** by code */
  readonly grounds: readonly Ground[];
  readonly codes: Uint8Array;
  readonly heights: Int16Array;
}

/** The verdict on a pose. */
export interface GroundVerdict {
  readonly ground: Ground;
  /** m, height of the ground there, or the given height if there is none */
  readonly z: number;
}

/** Headings within this angle (rad) of a map's heading use that map alone. */
const SAME = 0.01;
const NEWLINE = 10;
/** The order of verdicts: if the neighbouring headings differ, the first one counts. */
const WORST: readonly Ground[] = ["none", "too_near", "too_steep", "closed", "cut_off", "reached"];

interface Header extends Omit<StandingMap, "grounds" | "codes" | "heights"> {
  readonly codes: Readonly<Record<Ground, number>>;
}

/** Parse a map from the service. */
export async function readStandingMap(content: ArrayBuffer): Promise<StandingMap> {
  const bytes = new Uint8Array(content);
  const end = bytes.indexOf(NEWLINE);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(0, end))) as Header;
  const packed = new Blob([bytes.slice(end + 1)]).stream();
  const body = await new Response(packed.pipeThrough(new DecompressionStream("deflate"))).arrayBuffer();
  const count = header.layers * header.rows * header.columns;
  const view = new DataView(body, count);
  const heights = new Int16Array(count);
  for (let cell = 0; cell < count; cell++) heights[cell] = view.getInt16(2 * cell, true);
  const grounds: Ground[] = [];
  for (const [name, code] of Object.entries(header.codes)) grounds[code] = name as Ground;
  return { ...header, grounds, codes: new Uint8Array(body, 0, count), heights };
}

/** Return the verdict of the cell at a point (m); among several layers, of the nearest in height. */
export function cellVerdict(map: StandingMap, x: number, y: number, z: number): GroundVerdict {
  const column = Math.floor((x - map.origin[0]) / map.cell);
  const row = Math.floor((y - map.origin[1]) / map.cell);
  let found: GroundVerdict = { ground: "none", z };
  if (column < 0 || row < 0 || column >= map.columns || row >= map.rows) return found;
  let nearest = Infinity;
  for (let layer = 0; layer < map.layers; layer++) {
    const cell = (layer * map.rows + row) * map.columns + column;
    const ground = map.grounds[map.codes[cell] as number] ?? "none";
    if (ground === "none") continue;
    const height = map.z + (map.heights[cell] as number) * map.step;
    const away = Math.abs(height - z);
    if (away >= nearest) continue;
    nearest = away;
    found = { ground, z: height };
  }
  return found;
}

/** Return the indices of the maps for a heading (rad): one, or those of the two neighbouring headings. */
export function neighbouringHeadings(yaw: number, headings: readonly number[]): number[] {
  const count = headings.length;
  const part = (yaw / (2 * Math.PI)) * count;
  const nearest = Math.round(part);
  const at = (index: number) => ((index % count) + count) % count;
  if (Math.abs(part - nearest) * ((2 * Math.PI) / count) < SAME) return [at(nearest)];
  return [at(Math.floor(part)), at(Math.ceil(part))];
}

/** Return whether the robot can stand at a pose (m, rad); null: the maps are not loaded. */
export function verdictAt(
  map: (heading: number) => StandingMap | undefined,
  headings: readonly number[],
  x: number,
  y: number,
  z: number,
  yaw: number,
): GroundVerdict | null {
  let worst: GroundVerdict | null = null;
  for (const heading of neighbouringHeadings(yaw, headings)) {
    const there = map(heading);
    if (there === undefined) return null;
    const one = cellVerdict(there, x, y, z);
    if (worst === null || WORST.indexOf(one.ground) < WORST.indexOf(worst.ground)) worst = one;
  }
  return worst;
}

/** Return the floor whose map covers a height (m). */
export function floorOf(floors: readonly WorldFloor[], z: number): WorldFloor | undefined {
  return floors.findLast((floor) => floor.z - 0.1 <= z) ?? floors[0];
}
