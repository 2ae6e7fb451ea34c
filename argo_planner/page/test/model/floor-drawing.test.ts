import { describe, expect, it } from "vitest";

import type { MissionWay, PreviewedMission, Task, World, WorldFloor } from "../../src/api/types";
import {
  boxOutline,
  floorData,
  floorsVisited,
  frameOf,
  inFrame,
  northTurn,
  pathsOnFloors,
  scaleBar,
  stepPlaces,
} from "../../src/model/floor-drawing";
import { countSteps } from "../../src/model/step-numbers";
import { mission, task } from "./missions";

const FLOORS = [
  { number: 1, z: 0 },
  { number: 2, z: 3 },
] as unknown as readonly WorldFloor[];
const SITE = {
  floors: FLOORS,
  checkpoints: [{ id: 8, name: "gauge", floor: 2, position: [5, 6, 4], facing: 0 }],
  docks: [
    { area: 1, pose: { x: 0, y: 0, z: 0, yaw: 0 } },
    { area: 2, pose: { x: 9, y: 9, z: 0, yaw: 0 } },
  ],
} as unknown as World;

function open(...tasks: ReturnType<typeof task>[]) {
  return { ...mission(""), start_area: 2, tasks };
}
const at = (x: number, y: number, z: number) => ({ x, y, z, yaw: 0 });
const drive = (name: string, x: number, y: number, z = 0) => task(name, { action: "WAYPOINT", object_id: null, pose: at(x, y, z) });

describe("the frame of a floor", () => {
  it("is as large as possible in its room, with north up", () => {
    const frame = frameOf([0, 0, 10, 5], 200, 300);
    expect([frame.width, frame.height, frame.scale]).toEqual([200, 100, 20]);
    expect(inFrame(frame, 0, 5)).toEqual([0, 0]);
    expect(inFrame(frame, 10, 0)).toEqual([200, 100]);
    expect(floorData(frame, [[[0, 0], [1, 0], [1, 1]]])).toBe("M0 100L20 100L20 80Z");
  });

  it.each([
    [20, 100, 5, 100],
    [20, 99, 2, 40],
    [1000, 50, 0.1, 100],
  ])("has a bar of a round length: %d px for 1 m in %d px", (scale, longest, length, width) => {
    expect(scaleBar({ width: 1, height: 1, scale, left: 0, top: 0 }, longest)).toEqual({ length, width });
  });

  it("turns the arrow to the north", () => {
    expect(northTurn(Math.PI / 2)).toBeCloseTo(0);
    expect(northTurn(0)).toBeCloseTo(90); // north is to the right
  });
});

function placesOf(...tasks: Task[]) {
  const mission = open(...tasks);
  return stepPlaces(mission, SITE, countSteps(mission, new Set()));
}

describe("the places of tasks", () => {
  it("are at the checkpoint, at the pose, or at the dock of the start area", () => {
    const start = task("START", { action: "START", object_id: null });
    const places = placesOf(start, task("read", { object_id: "8" }), drive("go", 2, 3, 3));
    expect(places.map(({ numbers, x, y, floor }) => [numbers, x, y, floor])).toEqual([
      [["1"], 9, 9, 1],
      [["2"], 5, 6, 2],
      [["3"], 2, 3, 2],
    ]);
    expect(places.map(({ checkpoint }) => checkpoint?.id ?? null)).toEqual([null, 8, null]);
  });

  it("have all tasks that are done there", () => {
    const places = placesOf(drive("a", 2, 3), drive("b", 7, 7), drive("c", 2.01, 3), drive("d", 2, 3, 3));
    expect(places.map((place) => place.numbers)).toEqual([["1", "3"], ["2"], ["4"]]);
  });

  it("leave out tasks without a place, which keep their numbers", () => {
    const wait = task("wait", { action: "WAIT", object_id: null });
    const unknown = task("unknown", { object_id: "99" });
    expect(placesOf(wait, unknown, drive("a", 1, 1)).map((place) => place.numbers)).toEqual([["3"]]);
  });
});

function way(kind: MissionWay["kind"], time: number, ...points: (readonly [number, number, number, number])[]): MissionWay {
  const drawn = points.map(([t, x, y, z]) => [t, x, y, z, 0] as const);
  return { source: null, target: "x", kind, way: { points: drawn, time, work: 0, distance: 0, climb: 0, energy: 0 } };
}

describe("the paths on floors", () => {
  const preview = {
    ways: [
      way("default", 10, [0, 0, 0, 0], [4, 4, 0, 0], [8, 4, 0, 3], [10, 8, 0, 3]),
      way("failure", 5, [0, 0, 0, 0], [5, 0, 4, 0]),
    ],
  } as unknown as PreviewedMission;
  const flat = {
    ways: [way("default", 10, [0, 0, 0, 0], [4, 4, 0, 0], [8, 6, 0, 3], [10, 8, 0, 3])],
  } as unknown as PreviewedMission;
  const frame = frameOf([0, 0, 10, 10], 100, 100);
  const frames = new Map([
    [1, frame],
    [2, frame],
  ]);

  it("are split by floor and coloured by time", () => {
    const found = pathsOnFloors(flat, FLOORS, frames);
    const shares = (floor: number) => [...(found.get(floor)?.timed.keys() ?? [])];
    expect(shares(1)[0]).toBe(0);
    expect(Math.max(...shares(1))).toBeLessThan(Math.max(...shares(2)));
    expect(found.get(1)?.timed.get(0)?.line.startsWith("M0 100L")).toBe(true);
    expect(found.get(1)?.crossings.map((one) => one.floor)).toEqual([2]);
    expect(found.get(2)?.crossings.map((one) => one.floor)).toEqual([1]);
  });

  it("keep each bend", () => {
    const bent = { ways: [way("default", 0, [0, 0, 0, 0], [1, 4, 0, 0], [2, 4, 4, 0])] } as unknown as PreviewedMission;
    const lines = [...(pathsOnFloors(bent, FLOORS, frames).get(1)?.timed.values() ?? [])].map((one) => one.line);
    expect(lines).toEqual(["M0 100L40 100L40 60"]);
  });

  it("are drawn separately if they are driven in some cases only", () => {
    expect(pathsOnFloors(preview, FLOORS, frames).get(1)?.other).toContain("L0 60");
    expect(pathsOnFloors(flat, FLOORS, frames).get(1)?.other).toBe("");
  });

  it("name the floors that the mission visits", () => {
    expect(floorsVisited([], preview, SITE)).toEqual([1, 2]);
    expect(floorsVisited(placesOf(drive("up", 1, 1, 3)), null, SITE)).toEqual([2]);
  });
});

it("draws a turned box", () => {
  const corners = boxOutline({ x: 1, y: 1, z: 0, yaw: Math.PI / 2 }, [2, 1, 1]);
  expect(corners.map((point) => point.map((value) => value.toFixed(1)).join(" "))).toEqual(["0.5 2.0", "0.5 0.0", "1.5 -0.0", "1.5 2.0"]);
});
