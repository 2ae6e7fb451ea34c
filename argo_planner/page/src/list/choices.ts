/** What can be typed to name a checkpoint or a place. */

import type { Pose, World } from "../api/types";
import { t } from "../texts";

/** m within which a place is the same one */
const SAME = 0.05;

export interface Choice {
  /** What is typed to find it. */
  readonly label: string;
  readonly detail: string;
  /** The number of a checkpoint. */
  readonly checkpoint?: string;
  readonly pose?: Pose;
  /** What a task there is called. */
  readonly name?: string;
}

export function checkpointChoices(site: World): Choice[] {
  return site.checkpoints.map((one) => ({
    label: `${one.id} ${one.name}`,
    detail: t().list.onFloor(t().words.checkpoint[one.kind], one.floor),
    checkpoint: String(one.id),
  }));
}

/** Docks, places and corners of the floors by name; what is planned already comes last. */
export function placeChoices(site: World, planned: readonly Pose[] = []): Choice[] {
  const isPlanned = ({ pose }: Choice) => planned.some((one) => pose !== undefined && isAt(one, pose));
  const all = namedPlaces(site);
  return [...all.filter((one) => !isPlanned(one)), ...all.filter(isPlanned)];
}

function isAt(a: Pose, b: Pose): boolean {
  return Math.hypot(a.x - b.x, a.y - b.y, a.z - b.z) < SAME;
}

function namedPlaces(site: World): Choice[] {
  return [
    ...site.docks.map((dock) => ({
      label: t().list.dock(dock.area),
      detail: coordinates(dock.pose),
      pose: dock.pose,
      name: "DOCK",
    })),
    ...site.places.map((place) => ({
      label: place.name,
      detail: coordinates(place.pose),
      pose: place.pose,
      name: place.name,
    })),
    ...site.floors.flatMap((floor) =>
      floor.corners.map((pose, at) => ({
        label: t().list.corner(at + 1, floor.number),
        detail: coordinates(pose),
        pose,
      })),
    ),
  ];
}

/** The place that is typed as `x y` or `x y floor` (m, on the floor's deck); null: none is. */
export function typedPlace(site: World, typed: string, floor: number | null): Choice | null {
  const found = /^(-?\d+(?:\.\d+)?)[\s;]+(-?\d+(?:\.\d+)?)(?:[\s;]+(\d+))?$/.exec(typed.trim());
  if (!found) return null;
  const wanted = found[3] === undefined ? (floor ?? site.floors[0]?.number) : Number(found[3]);
  const deck = site.floors.find((one) => one.number === wanted);
  if (!deck) return null;
  const pose = { x: Number(found[1]), y: Number(found[2]), z: deck.z, yaw: 0 };
  return { label: coordinates(pose), detail: deck.name, pose };
}

/** The choices that fit what was typed, the best ones first: a number means that checkpoint. */
export function matching(choices: readonly Choice[], typed: string): Choice[] {
  const text = typed.trim().toLowerCase().replace(/^#\s*/, "");
  if (text === "") return [...choices];
  const rank = (choice: Choice) => {
    const label = choice.label.toLowerCase();
    if (choice.checkpoint === text) return 0;
    if (label.startsWith(text)) return 1;
    if (label.split(/[\s_-]+/).some((word) => word.startsWith(text))) return 2;
    return label.includes(text) ? 3 : 4;
  };
  return choices
    .map((choice, index) => ({ choice, index, rank: rank(choice) }))
    .filter((one) => one.rank < 4)
    .sort((a, b) => a.rank - b.rank || a.index - b.index)
    .map((one) => one.choice);
}

function coordinates(pose: Pose): string {
  return `${pose.x.toFixed(1)}, ${pose.y.toFixed(1)}`;
}
