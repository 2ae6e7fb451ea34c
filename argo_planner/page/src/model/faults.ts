/** Rules of faults that a person describes: their fields, limits and places. */

import type { FaultDescription, FaultField, NumberLimits, World, WorldCheckpoint } from "../api/types";
import { floorOf } from "./standing-map";

export type FaultValue = number | string | readonly number[];
/** A fault as a request has it. Fields that are left out are drawn by the random seed, or have a default. */
export interface FaultDraft {
  readonly kind: string;
  readonly [field: string]: FaultValue | undefined;
}

export type FaultProblem =
  | { readonly kind: "limits"; readonly limits: NumberLimits; readonly unit: string | null }
  | { readonly kind: "ends early" }
  | { readonly kind: "no floor" }
  | { readonly kind: "no deck"; readonly floor: number }
  | { readonly kind: "off site" }
  | { readonly kind: "wrong corners" }
  | { readonly kind: "off scale" | "normal"; readonly low: number; readonly high: number; readonly unit: string };

type Site = Pick<World, "floors" | "checkpoints" | "ground" | "ground_z">;
type Point = readonly [x: number, y: number, z: number];
/** What is clicked in the site. */
export interface FaultClick {
  readonly point: Point;
  /** id of the clicked checkpoint; null: none is there */
  readonly checkpoint: number | null;
}

/** How a click gives a fault its place: at a checkpoint, at a point, on the deck, or by two corners of an area. */
export type PlaceForm = "checkpoint" | "point" | "deck" | "area";

/** Kinds whose place on the deck needs the number of the floor. */
const ON_A_FLOOR: ReadonlySet<string> = new Set(["brick", "missing_plate"]);
/** m: edge of an area that is placed by a checkpoint, before a person changes it */
const EDGE = 1;

export function placeForm({ fields }: FaultDescription): PlaceForm | null {
  const count = (name: string) => fields.find((field) => field.name === name)?.numbers.length;
  if (count("rect") === 4) return "area";
  if (count("place") === 3) return "point";
  if (count("place") === 2) return "deck";
  return fields.some((field) => field.name === "checkpoint") ? "checkpoint" : null;
}

/** Return a fault with another value of a field; undefined: the field is left out. */
export function withField(fault: FaultDraft, name: string, value: FaultValue | undefined): FaultDraft {
  const others = Object.entries(fault).filter(([field]) => field !== name);
  return Object.fromEntries(value === undefined ? others : [...others, [name, value]]) as unknown as FaultDraft;
}

/** Return a fault at a clicked place; null: this kind can't be there. */
export function placedAt(
  fault: FaultDraft,
  description: FaultDescription,
  click: FaultClick,
  corner: Point | null,
  site: Site,
): FaultDraft | null {
  const checkpoint = site.checkpoints.find((one) => one.id === click.checkpoint);
  const [x, y, z] = click.point.map(rounded) as unknown as Point;
  const floor = floorOf(site.floors, z)?.number;
  switch (placeForm(description)) {
    case "checkpoint":
      return checkpoint === undefined ? null : withField(fault, "checkpoint", checkpoint.id);
    case "point":
      return withField(fault, "place", checkpoint === undefined ? [x, y, z] : checkpoint.position);
    case "deck":
      return withFloor(withField(fault, "place", [x, y]), floor);
    case "area": {
      const [u, v] = corner ?? [x, y];
      const rect = [Math.min(u, x), Math.min(v, y), Math.max(u, x), Math.max(v, y)].map(rounded);
      return withFloor(withField(fault, "rect", rect), floor);
    }
    case null:
      return null;
  }
}

/** Return a fault at a checkpoint: on its face, or where the robot stands to read it. */
export function atCheckpoint(fault: FaultDraft, description: FaultDescription, id: number, site: Site): FaultDraft {
  const checkpoint = site.checkpoints.find((one) => one.id === id);
  if (checkpoint === undefined) return fault;
  const form = placeForm(description);
  const { position } = checkpoint;
  if (form === "checkpoint") return withField(fault, "checkpoint", id);
  if (form === "point") return withField(fault, "place", position);
  const { x, y } = checkpoint.stands ?? { x: position[0], y: position[1] };
  if (form === "deck") return withFloor(withField(fault, "place", [rounded(x), rounded(y)]), checkpoint.floor);
  const rect = [x - EDGE / 2, y - EDGE / 2, x + EDGE / 2, y + EDGE / 2].map(rounded);
  return withFloor(withField(fault, "rect", rect), checkpoint.floor);
}

/** Return the id of the checkpoint at which a fault is, as `atCheckpoint` places it; null: at none. */
export function checkpointOf(fault: FaultDraft, description: FaultDescription, site: Site): number | null {
  if (placeForm(description) === "checkpoint") return (fault["checkpoint"] as number | undefined) ?? null;
  const at = JSON.stringify([fault["place"], fault["rect"]]);
  const found = site.checkpoints.find(({ id }) => {
    const there = atCheckpoint(fault, description, id, site);
    return JSON.stringify([there["place"], there["rect"]]) === at && there["floor"] === fault["floor"];
  });
  return hasPlace(fault) ? (found?.id ?? null) : null;
}

/** Return whether a fault has a place or area with coordinates. */
export function hasPlace(fault: FaultDraft): boolean {
  return fault["place"] !== undefined || fault["rect"] !== undefined;
}

/** Return where the mark of a fault stands; null: its place is not known before the run. */
export function markPoint(fault: FaultDraft, site: Site): Point | null {
  const { place, rect, checkpoint, floor } = fault;
  const z = site.floors.find((one) => one.number === floor)?.z ?? site.ground_z;
  if (Array.isArray(place)) return [place[0] as number, place[1] as number, (place[2] as number | undefined) ?? z];
  if (Array.isArray(rect)) {
    const [x0 = 0, y0 = 0, x1 = 0, y1 = 0] = rect as readonly number[];
    return [(x0 + x1) / 2, (y0 + y1) / 2, z];
  }
  return site.checkpoints.find((one) => one.id === checkpoint)?.position ?? null;
}

/** Return what is wrong with the fields of a fault, by their names. */
export function faultProblems(
  fault: FaultDraft,
  description: FaultDescription,
  site: Site,
): ReadonlyMap<string, FaultProblem> {
  const found = new Map<string, FaultProblem>();
  for (const field of description.fields) {
    const problem = limitProblem(field, fault[field.name]);
    if (problem !== null) found.set(field.name, problem);
  }
  const { at, until } = fault;
  if (typeof until === "number" && until <= (typeof at === "number" ? at : 0)) found.set("until", { kind: "ends early" });
  const place = placeProblem(fault, site);
  if (place !== null && !found.has(place[0])) found.set(...place);
  const value = valueProblem(fault, site);
  if (value !== null) found.set("value", value);
  return found;
}

function limitProblem({ numbers, unit = null }: FaultField, value: FaultValue | undefined): FaultProblem | null {
  const given = typeof value === "number" ? [value] : Array.isArray(value) ? (value as readonly number[]) : [];
  const at = numbers.findIndex((limits, k) => given[k] !== undefined && !isWithin(given[k], limits));
  const limits = numbers[at];
  return limits === undefined ? null : { kind: "limits", limits, unit };
}

function isWithin(value: number, { least, above, most, below }: NumberLimits): boolean {
  const [low, high] = [least ?? -Infinity, most ?? Infinity];
  return value >= low && value <= high && value > (above ?? -Infinity) && value < (below ?? Infinity);
}

function placeProblem(fault: FaultDraft, site: Site): [string, FaultProblem] | null {
  const { place, rect } = fault;
  const floor = site.floors.find((one) => one.number === fault["floor"]);
  if (Array.isArray(rect)) {
    const [x0 = 0, y0 = 0, x1 = 0, y1 = 0] = rect as readonly number[];
    if (x1 <= x0 || y1 <= y0) return ["rect", { kind: "wrong corners" }];
    if (floor === undefined && ON_A_FLOOR.has(fault.kind)) return ["rect", { kind: "no floor" }];
    const areas = floor?.plates ?? [site.ground];
    if (areas.some(([a, b, c, d]) => x0 < c && x1 > a && y0 < d && y1 > b)) return null;
    return ["rect", floor === undefined ? { kind: "off site" } : { kind: "no deck", floor: floor.number }];
  }
  if (!Array.isArray(place) || place.length !== 2) return null; // other places have limits of their own
  const [x, y] = place as unknown as readonly [number, number];
  if (floor === undefined) return ["place", { kind: "no floor" }];
  if (floor.plates.some(([a, b, c, d]) => x >= a && x <= c && y >= b && y <= d)) return null;
  return ["place", { kind: "no deck", floor: floor.number }];
}

/** Return why a checkpoint can't show the abnormal value of a fault. */
function valueProblem(fault: FaultDraft, site: Site): FaultProblem | null {
  const { value } = fault;
  const checkpoint = site.checkpoints.find((one) => one.id === fault["checkpoint"]);
  if (typeof value !== "number" || checkpoint === undefined) return null;
  const within = ({ low, high }: WorldCheckpoint["range"]) => value >= low && value <= high;
  const { range, nominal, unit } = checkpoint;
  if (!within(range)) return { kind: "off scale", low: range.low, high: range.high, unit };
  return within(nominal) ? { kind: "normal", low: nominal.low, high: nominal.high, unit } : null;
}

/** Return what the service says about one fault of a list, which it names by its number; null: nothing. */
export function refusalOf(refusal: string | null, index: number): string | null {
  const found = refusal?.split("; ").find((one) => one.startsWith(`faults[${index}] `));
  return found === undefined ? null : found.replace(/^faults\[\d+\] \([^)]*\): /, "");
}

/** Return the fault of each case of an evaluation by the case's name: the kind, with a number if it occurs again. */
export function faultsByCase<One extends { readonly kind: string }>(faults: readonly One[]): ReadonlyMap<string, One> {
  const found = new Map<string, One>();
  faults.forEach((fault, at) => {
    const same = faults.filter((other) => other.kind === fault.kind);
    const number = faults.slice(0, at + 1).filter((other) => other.kind === fault.kind).length;
    found.set(same.length === 1 ? fault.kind : `${fault.kind} ${number}`, fault);
  });
  return found;
}

/** Return a fault of the service without the fields that it leaves out. */
export function givenFields(fault: { readonly kind: string }): FaultDraft {
  return Object.fromEntries(Object.entries<unknown>(fault).filter(([, value]) => value !== null)) as unknown as FaultDraft;
}

function withFloor(fault: FaultDraft, floor: number | undefined): FaultDraft {
  return floor === undefined ? fault : withField(fault, "floor", floor);
}

function rounded(value: number): number {
  return Math.round(100 * value) / 100;
}
