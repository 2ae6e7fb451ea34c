/** Where the robot can stand: the maps of the service, read without asking it again. */

import type { WorldFloor } from "../api/types";

export type Ground = "none" | "too_near" | "too_steep" | "cut_off" | "closed" | "reached";

/** A floor's cells with one heading. Cells above each other are in layers, the lower one first. */
export interface StandingMap {
  readonly floor: number;
  readonly heading: number;
  /** rad */
  readonly yaw: number;
  /** m, the corner of least x and y of the first cell */
  readonly origin: readonly [number, number];
  /** m, edge of a cell */
  readonly cell: number;
  readonly layers: number;
  readonly rows: number;
  readonly columns: number;
  /** m, of the floor, and the unit of the heights above it */
  readonly z: number;
  readonly step: number;
  /** by code */
  readonly grounds: readonly Ground[];
  readonly codes: Uint8Array;
  readonly heights: Int16Array;
}

/** What holds somewhere. */
export interface Standing {
  readonly ground: Ground;
  /** m, of the ground there; of where it was asked for, if there is none */
  readonly z: number;
}

/** Headings that are nearer than this (rad) to one of the maps are that one. */
const SAME = 0.01;
const NEWLINE = 10;
/** What is said where the neighbouring headings differ: the first of them. */
const WORST: readonly Ground[] = ["none", "too_near", "too_steep", "closed", "cut_off", "reached"];

interface Header extends Omit<StandingMap, "grounds" | "codes" | "heights"> {
  readonly codes: Readonly<Record<Ground, number>>;
}

/** Reads a map as it comes from the service. */
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

/** What holds for the cell that a place (m) lies in; of several, for the nearest in height. */
export function standingAt(map: StandingMap, x: number, y: number, z: number): Standing {
  const column = Math.floor((x - map.origin[0]) / map.cell);
  const row = Math.floor((y - map.origin[1]) / map.cell);
  let found: Standing = { ground: "none", z };
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

/** The maps of a floor that tell of a heading (rad): one, or those of the headings beside it. */
export function headingsBeside(yaw: number, headings: readonly number[]): number[] {
  const count = headings.length;
  const part = (yaw / (2 * Math.PI)) * count;
  const nearest = Math.round(part);
  const at = (index: number) => ((index % count) + count) % count;
  if (Math.abs(part - nearest) * ((2 * Math.PI) / count) < SAME) return [at(nearest)];
  return [at(Math.floor(part)), at(Math.ceil(part))];
}

/** Whether the robot can stand somewhere with a heading (rad); null: the maps are not there yet. */
export function verdictAt(
  map: (heading: number) => StandingMap | undefined,
  headings: readonly number[],
  x: number,
  y: number,
  z: number,
  yaw: number,
): Standing | null {
  let worst: Standing | null = null;
  for (const heading of headingsBeside(yaw, headings)) {
    const there = map(heading);
    if (there === undefined) return null;
    const one = standingAt(there, x, y, z);
    if (worst === null || WORST.indexOf(one.ground) < WORST.indexOf(worst.ground)) worst = one;
  }
  return worst;
}

/** The floor whose map a height (m) belongs to. */
export function floorOf(floors: readonly WorldFloor[], z: number): WorldFloor | undefined {
  return floors.findLast((floor) => floor.z - 0.1 <= z) ?? floors[0];
}
