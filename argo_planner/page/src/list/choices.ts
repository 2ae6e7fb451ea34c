/** Checkpoints and poses that can be typed by name, number or coordinates. */

import type { Pose, World } from "../api/types";
import { t } from "../texts";

/** m within which two poses are the same */
const SAME = 0.05;

export interface Choice {
  /** The text that is searched. */
  readonly label: string;
  readonly detail: string;
  /** Id of a checkpoint. */
  readonly checkpoint?: string;
  /** Ids of all checkpoints of a floor. */
  readonly checkpoints?: readonly string[];
  readonly pose?: Pose;
  /** The name that a task there gets. */
  readonly name?: string;
}

export function checkpointChoices(site: World): Choice[] {
  return site.checkpoints.map((one) => ({
    label: `${one.id} ${one.name}`,
    detail: t().list.onFloor(t().words.checkpoint[one.kind], one.floor),
    checkpoint: String(one.id),
  }));
}

/** Return the floors with the checkpoints on them that can be read. */
export function floorChoices(site: World): Choice[] {
  return site.floors.flatMap((floor) => {
    const there = site.checkpoints.filter((one) => one.floor === floor.number && !one.problem);
    if (there.length === 0) return [];
    const detail = t().list.allCheckpoints(there.length);
    return [{ label: t().scene.floor(floor.number), detail, checkpoints: there.map((one) => String(one.id)) }];
  });
}

/** Return docks, locations and corners of the floors by name; poses that are already planned come last. */
export function poseChoices(site: World, planned: readonly Pose[] = []): Choice[] {
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

/** Parse a pose typed as `x y` or `x y floor` (m, on the floor's deck); null: the text is no pose. */
export function typedPose(site: World, typed: string, floor: number | null): Choice | null {
  const found = /^(-?\d+(?:\.\d+)?)[\s;]+(-?\d+(?:\.\d+)?)(?:[\s;]+(\d+))?$/.exec(typed.trim());
  if (!found) return null;
  const wanted = found[3] === undefined ? (floor ?? site.floors[0]?.number) : Number(found[3]);
  const deck = site.floors.find((one) => one.number === wanted);
  if (!deck) return null;
  const pose = { x: Number(found[1]), y: Number(found[2]), z: deck.z, yaw: 0 };
  return { label: coordinates(pose), detail: deck.name, pose };
}

/** Return the choices that match the text, the best ones first: a number means that checkpoint. */
export function matchingChoices(choices: readonly Choice[], typed: string): Choice[] {
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
