import { expect, test } from "vitest";

import type { AnalysisFound, Mission, PreviewedMission } from "../../src/api/types";
import { boundsOf, mergedLegs, isTooLate, legsOf, withLimit, type Leg } from "../../src/model/legs";

const way = (time: number | null, more = {}) => ({ time, distance: 2, climb: 1, energy: 3, problem: null, ...more });
const PREVIEW = {
  ways: [
    { kind: "default", source: null, target: "a", way: way(10) },
    { kind: "default", source: "a", target: "w", way: way(0) },
    { kind: "branch", source: "a", target: "b", way: way(99) },
    { kind: "default", source: "w", target: "b", way: way(null, { problem: "no way" }) },
  ],
} as unknown as PreviewedMission;
const MISSION = {
  tasks: [
    { name: "a", action: "MEASURE" },
    { name: "w", action: "WAIT", wait: { duration: 30 } },
    { name: "b", action: "MEASURE" },
  ],
} as unknown as Mission;

test("the legs are those of the default path, including waits", () => {
  const legs = legsOf(PREVIEW, MISSION);
  expect(legs.map((leg) => [leg.way, leg.task, leg.start, leg.time])).toEqual([
    [0, "a", 0, 10],
    [1, "w", 10, 30],
    [3, "b", 40, 0],
  ]);
  expect(legs[2]?.problem?.text).toBe("no way");
  expect(legs.map((leg) => isTooLate(leg, 35))).toEqual([false, true, true]);
  expect(isTooLate(legs[2] as Leg, null)).toBe(false);
});

test("a limit is exceeded by higher values; without one nothing is exceeded", () => {
  expect(withLimit(5, 5).broken).toBe(false);
  expect(withLimit(6, 5).broken).toBe(true);
  expect(withLimit(6, null)).toEqual({ value: 6, limit: null, broken: false });
});

test("bounds over all executions, with the execution of the highest value", () => {
  const found = {
    revision: 1,
    analysis: {
      duration: { least: { value: 10, path: [] }, most: { value: 20, path: [{ task: "a", rounds: 1, missed: false, until: 20 }] } },
      energy: { least: { value: 1, path: [] }, most: { value: null, path: [] } },
    },
  } as unknown as AnalysisFound;
  const [time, energy] = boundsOf(found, { time: 15, energy: 9 });
  expect(time).toMatchObject({ kind: "time", least: 10, most: 20, broken: true });
  expect(time?.path[0]).toMatchObject({ task: "a", group: null });
  expect(energy?.broken).toBe(true);
  expect(boundsOf(found, { time: null, energy: null }).map((one) => one.broken)).toEqual([false, false]);
  expect(boundsOf(null, { time: 1, energy: 1 })).toEqual([]);
  expect(boundsOf({ revision: 1, problem: "x" }, { time: 1, energy: 1 })).toEqual([]);
});

test("many legs are merged without loss", () => {
  const legs = Array.from({ length: 10 }, (_, at) => ({ way: at, task: `t${at}`, time: 1, start: at, distance: 1, climb: 0, energy: 2, problem: at === 3 ? { text: "no way", wording: null } : null }));
  expect(mergedLegs(legs, 10)).toEqual(legs);
  const few = mergedLegs(legs, 4);
  expect(few.map((leg) => [leg.task, leg.time, leg.energy])).toEqual([["t0", 3, 6], ["t3", 3, 6], ["t6", 3, 6], ["t9", 1, 2]]);
  expect(few[1]?.problem?.text).toBe("no way");
});
