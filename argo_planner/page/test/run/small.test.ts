import { expect, test } from "vitest";

import type { RequestState, RunState, WorldCheckpoint } from "../../src/api/types";
import { checkpointSuggestion, parseCheckpoint } from "../../src/model/checkpoint-choice";
import { isUnderWay, shownMode, shownRequests } from "../../src/model/run-mode";
import { drawnScale, shareOfScale } from "../../src/model/scale";

function run(more: object): RunState {
  return { status: "running", mode: "autonomous", moving: true, requests: [], ...more } as unknown as RunState;
}

test("a pausing run is not paused before the robot stands", () => {
  expect(shownMode(run({}))).toBe("autonomous");
  expect(shownMode(run({ mode: "paused" }))).toBe("stopping");
  expect(shownMode(run({ mode: "paused", moving: false }))).toBe("paused");
  expect(shownMode(run({ status: "interrupted" }))).toBe("interrupted");
  expect(shownMode(run({ status: "ended", headline: { tone: "bad" } }))).toBe("bad");
  expect(shownMode(run({ status: "ended" }))).toBe("notice");
});

test("open requests are shown, and the last finished ones, newest first", () => {
  const asked = (id: string, progress: string) => ({ id, kind: id, progress }) as unknown as RequestState;
  const all = [asked("a", "confirmed"), asked("b", "under way"), asked("c", "refused"), asked("d", "failed")];
  expect(shownRequests(all, 2).map((one) => one.id)).toEqual(["b", "d", "c"]);
  expect(shownRequests(all, 0).map((one) => one.id)).toEqual(["b"]);
  expect(isUnderWay(run({ requests: all }), "b")).toBe(true);
  expect(isUnderWay(run({ requests: all }), "c")).toBe(false);
});

test("a checkpoint is chosen by number, suggestion or part of its name", () => {
  const all = [
    { id: 4, name: "valve R25" },
    { id: 14, name: "valve R18" },
    { id: 8, name: "pressure gauge 5" },
  ] as unknown as WorldCheckpoint[];
  const found = (typed: string) => parseCheckpoint(typed, all)?.id;
  expect(all.map(checkpointSuggestion).map(found)).toEqual([4, 14, 8]);
  expect(found("#14")).toBe(14);
  expect(found(" 8 ")).toBe(8);
  expect(found("r18")).toBe(14);
  expect(found("valve")).toBeUndefined();
  expect(found("99")).toBeUndefined();
  expect(found("")).toBeUndefined();
});

test("values are drawn on the instrument's scale, or on one with room for all values", () => {
  const range = { low: 0, high: 10 };
  expect(drawnScale(range, { low: 3, high: 5 }, 4)).toBe(range);
  const own = drawnScale(null, { low: 3, high: 5 }, 7);
  expect(own.low).toBeLessThan(3);
  expect(own.high).toBeGreaterThan(7);
  expect([-1, 0, 5, 11].map((value) => shareOfScale(range, value))).toEqual([0, 0, 0.5, 1]);
});
