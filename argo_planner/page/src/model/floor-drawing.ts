/** The drawing of a floor from above: where things are in it, and what the mission does there. */

import type { Mission, Pose, PreviewedMission, Task, World, WorldCheckpoint, WorldFloor } from "../api/types";
import { outlineData, short, type Point } from "./axonometry";
import { ribbonPaths, type Sample } from "./ribbons";
import { floorOf } from "./standing-map";
import { taskKey } from "./outline";
import type { StepNumbers } from "./step-numbers";

type Bounds = readonly [x0: number, y0: number, x1: number, y1: number];

/** The place of a floor in its drawing, north up as far as y is north. */
export interface DrawingFrame {
  /** px */
  readonly width: number;
  readonly height: number;
  /** px for 1 m */
  readonly scale: number;
  /** m, the upper left corner */
  readonly left: number;
  readonly top: number;
}

/** Return the frame for a rectangle of the site (m), as large as possible in a room (px). */
export function frameOf([x0, y0, x1, y1]: Bounds, width: number, height: number): DrawingFrame {
  const scale = Math.min(width / Math.max(x1 - x0, 1e-6), height / Math.max(y1 - y0, 1e-6));
  return { width: (x1 - x0) * scale, height: (y1 - y0) * scale, scale, left: x0, top: y1 };
}

/** Return where a point (m) is in the drawing (px). */
export function inFrame({ scale, left, top }: DrawingFrame, x: number, y: number): Point {
  return [(x - left) * scale, (top - y) * scale];
}

/** Return the path data of closed outlines (m). */
export function floorData(frame: DrawingFrame, outlines: readonly (readonly Point[])[]): string {
  return outlineData(outlines.map((outline) => outline.map(([x, y]) => inFrame(frame, x, y))));
}

const LENGTHS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];

/** Return the longest round length (m) whose bar is at most `longest` px, and the bar's width (px). */
export function scaleBar({ scale }: DrawingFrame, longest: number): { readonly length: number; readonly width: number } {
  const length = LENGTHS.findLast((one) => one * scale <= longest) ?? 0.1;
  return { length, width: length * scale };
}

/** Return the angle (degrees, clockwise) of an arrow to the north that points up at 0; `north`: rad from the x axis. */
export function northTurn(north: number): number {
  return 90 - (north * 180) / Math.PI;
}

/** A place at which tasks are done. */
export interface StepPlace {
  /** in ascending order; empty for tasks that no step of the script states */
  readonly numbers: readonly string[];
  readonly tasks: readonly string[];
  readonly x: number;
  readonly y: number;
  readonly floor: number;
  /** The checkpoint that is measured; null: the robot drives there or starts there. */
  readonly checkpoint: WorldCheckpoint | null;
}

/** m within which two poses are one place */
const SAME = 0.3;

/** Return the places of a mission's tasks, in the order in which they come first. Tasks without a place, such as
 * waits, have none. */
export function stepPlaces(mission: Mission, site: World, numbers: StepNumbers): StepPlace[] {
  const checkpoints = new Map(site.checkpoints.map((one) => [String(one.id), one]));
  const places = new Map<string, { numbers: string[]; tasks: string[] } & Omit<StepPlace, "numbers" | "tasks">>();
  for (const task of mission.tasks) {
    const at = placeOf(task, mission, site, checkpoints);
    if (at === null) continue;
    const key = at.checkpoint ? `#${at.checkpoint.id}` : `${at.floor} ${Math.round(at.x / SAME)} ${Math.round(at.y / SAME)}`;
    const there = places.get(key) ?? { ...at, numbers: [], tasks: [] };
    const number = numbers.get(taskKey(task.name));
    if (number !== undefined) there.numbers.push(number);
    there.tasks.push(task.name);
    places.set(key, there);
  }
  return [...places.values()];
}

function placeOf(task: Task, mission: Mission, site: World, checkpoints: ReadonlyMap<string, WorldCheckpoint>) {
  const checkpoint = task.action === "MEASURE" ? checkpoints.get(task.object_id ?? "") : undefined;
  if (checkpoint) {
    const [x, y] = checkpoint.position;
    return { x, y, floor: checkpoint.floor, checkpoint };
  }
  const pose = poseOfTask(task, mission, site);
  return pose && { x: pose.x, y: pose.y, floor: floorNumber(site.floors, pose.z), checkpoint: null };
}

/** Return the pose of a task; START without a pose is at the dock of its area. */
export function poseOfTask(task: Task, mission: Mission, site: World): Pose | null {
  if (task.pose) return task.pose;
  if (task.action !== "START") return null;
  return (site.docks.find((dock) => dock.area === mission.start_area) ?? site.docks[0])?.pose ?? null;
}

export function floorNumber(floors: readonly WorldFloor[], z: number): number {
  return floorOf(floors, z)?.number ?? 1;
}

/** The paths of a mission on a floor, as path data. */
export interface FloorPaths {
  /** Lines and arrowheads by time: a share of the mission from 0 to 1. */
  readonly timed: ReadonlyMap<number, { readonly line: string; readonly arrows: string }>;
  /** Lines of paths that are driven only in some cases. */
  readonly other: string;
  readonly crossings: readonly Crossing[];
}

/** A point (m) at which a path leaves a floor, or reaches it. */
export interface Crossing {
  readonly x: number;
  readonly y: number;
  /** number of the other floor */
  readonly floor: number;
}

/** A stretch of a path on one floor and in one colour. */
interface Piece {
  readonly floor: number;
  /** null: a path that is driven only in some cases */
  readonly share: number | null;
  readonly samples: Sample[];
}

/** number of colours */
const SHADES = 24;
/** m between arrowheads, and the largest size of one in m and in px */
const [ARROWS, ARROW, ARROW_PX] = [2.2, 0.3, 8];

/** Return the numbers of the floors of tasks and paths, in ascending order. */
export function floorsVisited(places: readonly StepPlace[], preview: PreviewedMission | null, site: World): number[] {
  const found = new Set(places.map((place) => place.floor));
  for (const { kind, way } of preview?.ways ?? [])
    if (kind === "default") for (const [, , , z] of way.points) found.add(floorNumber(site.floors, z));
  return [...found].sort((a, b) => a - b);
}

/** Return the paths of a mission by floor; `frames` has the frame of each floor that is drawn. */
export function pathsOnFloors(
  preview: PreviewedMission,
  floors: readonly WorldFloor[],
  frames: ReadonlyMap<number, DrawingFrame>,
): Map<number, FloorPaths> {
  const pieces = piecesOf(preview, floors);
  const found = new Map<number, FloorPaths>();
  for (const [floor, frame] of frames) {
    const here = pieces.filter((piece) => piece.floor === floor);
    const timed = new Map<number, { line: string; arrows: string }>();
    let other = "";
    for (const { share, samples } of here) {
      const line = lineData(frame, samples);
      if (share === null) other += line;
      else {
        const before = timed.get(share) ?? { line: "", arrows: "" };
        timed.set(share, { line: before.line + line, arrows: before.arrows + arrowData(frame, samples) });
      }
    }
    found.set(floor, { timed, other, crossings: crossingsOf(pieces, floor) });
  }
  return found;
}

function piecesOf(preview: PreviewedMission, floors: readonly WorldFloor[]): Piece[] {
  let start = 0;
  const legs = preview.ways.map(({ kind, way }, number) => {
    const leg = { way: number, points: way.points, start, dashed: kind !== "default" };
    if (kind === "default") start += way.time ?? 0;
    return leg;
  });
  const pieces: Piece[] = [];
  for (const { samples, dashed } of ribbonPaths(legs)) {
    const own: Piece[] = [];
    for (let at = 1; at < samples.length; at++) {
      const [from, to] = [samples[at - 1] as Sample, samples[at] as Sample];
      const floor = floorNumber(floors, Math.min(from.z, to.z));
      const share = dashed ? null : Math.round((start > 0 ? Math.min(1, from.t / start) : 0) * SHADES) / SHADES;
      const last = own.at(-1);
      if (last?.floor === floor && last.share === share) last.samples.push(to);
      else own.push({ floor, share, samples: [from, to] });
    }
    pieces.push(...own);
  }
  return pieces;
}

function lineData(frame: DrawingFrame, samples: readonly Sample[]): string {
  // A bend has a sample for either direction, and samples on a straight line need not be drawn.
  const apart = samples.filter((one, at) => {
    const before = samples[at - 1];
    return before === undefined || Math.hypot(one.x - before.x, one.y - before.y) > 1e-6;
  });
  const corners = apart.filter((one, at) => {
    const [before, after] = [apart[at - 1], apart[at + 1]];
    if (before === undefined || after === undefined) return true;
    return Math.abs((one.x - before.x) * (after.y - one.y) - (one.y - before.y) * (after.x - one.x)) > 1e-6;
  });
  return `M${corners.map(({ x, y }) => inFrame(frame, x, y).map(short).join(" ")).join("L")}`;
}

/** Return arrowheads at even distances along a path. */
function arrowData(frame: DrawingFrame, samples: readonly Sample[]): string {
  const heads: Point[][] = [];
  const size = Math.min(ARROW, ARROW_PX / frame.scale);
  samples.forEach(({ x, y, dx, dy, along }, at) => {
    const before = samples[at - 1]?.along ?? along;
    if (Math.floor(along / ARROWS - 0.5) === Math.floor(before / ARROWS - 0.5)) return;
    const corner = (ahead: number, aside: number): Point =>
      [x + (dx * ahead - dy * aside) * size, y + (dy * ahead + dx * aside) * size];
    heads.push([corner(-0.5, 0.5), corner(-0.5, -0.5), corner(0.7, 0)]);
  });
  return floorData(frame, heads);
}

function crossingsOf(pieces: readonly Piece[], floor: number): Crossing[] {
  const found = new Map<string, Crossing>();
  pieces.forEach((piece, at) => {
    const before = pieces[at - 1];
    const point = piece.samples[0];
    if (before === undefined || point === undefined || before.floor === piece.floor) return;
    if (before.samples.at(-1) !== point) return; // another leg
    const other = before.floor === floor ? piece.floor : piece.floor === floor ? before.floor : null;
    if (other === null) return;
    const key = `${other} ${Math.round(point.x)} ${Math.round(point.y)}`;
    found.set(key, { x: point.x, y: point.y, floor: other });
  });
  return [...found.values()];
}

/** Return the corners of a box that stands at a pose (m), seen from above. */
export function boxOutline({ x, y, yaw }: Pose, [length, width]: readonly [number, number, number]): Point[] {
  const [cos, sin] = [Math.cos(yaw), Math.sin(yaw)];
  return [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([a = 0, b = 0]) => {
    const [along, aside] = [(a * length) / 2, (b * width) / 2];
    return [x + along * cos - aside * sin, y + along * sin + aside * cos];
  });
}
