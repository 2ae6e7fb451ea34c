import { expect, test } from "vitest";

import type { Entry } from "../../src/api/types";
import { countUntil, momentAt, outcomesOf, readingsOf } from "../../src/model/replay";

function entry(t: number, more: object = {}): Entry {
  return { t, pose: [t, 0, 0, 0, 0], distance: t, climbed: 0, charge: 1 - t / 100, events: [], ...more } as unknown as Entry;
}
const reading = (checkpoint: number, value: number) => ({ checkpoint, value });

const ENTRIES = [
  entry(0),
  entry(2, { running: "a" }),
  entry(4, { running: "a", task: { task: "a", outcome: "done", by_hand: false }, reading: reading(7, 1) }),
  entry(4, { events: [{ kind: "pause" }] }),
  entry(8, { running: "b", task: { task: "b", outcome: "failed", by_hand: false } }),
  entry(9, { running: "b", task: { task: "b", outcome: "done", by_hand: true }, reading: reading(7, 2) }),
  entry(10, { events: [{ kind: "give_back", by_hand: [{ task: "c", skipped: true }] }] }),
];

test("entries are counted up to and including a time", () => {
  expect([-1, 0, 3, 4, 5, 99].map((t) => countUntil(ENTRIES, t))).toEqual([0, 1, 2, 4, 4, 7]);
});

test("poses between two entries are interpolated", () => {
  const moment = momentAt(ENTRIES, 3);
  expect(moment?.pose[0]).toBe(3);
  expect(moment?.task).toBe("a");
  expect(moment?.outcomes.size).toBe(0);
  expect(momentAt(ENTRIES, -1)).toBeNull();
  expect(momentAt([], 3)).toBeNull();
});

test("headings are interpolated over the smaller angle", () => {
  const turned = [entry(0, { pose: [0, 0, 0, 3, 0] }), entry(1, { pose: [0, 0, 0, -3, 0] })];
  expect(momentAt(turned, 0.5)?.pose[3]).toBeCloseTo(Math.PI);
});

test("outcomes and readings are the last ones up to that time", () => {
  const half = momentAt(ENTRIES, 8);
  expect(half?.outcomes).toEqual(new Map([["a", "done"], ["b", "failed"]]));
  expect(half?.readings.map((one) => one.value)).toEqual([1]);
  expect(outcomesOf(ENTRIES)).toEqual(new Map([["a", "done"], ["b", "by hand"], ["c", "skipped"]]));
  expect(readingsOf(ENTRIES).map((one) => one.value)).toEqual([2]);
  expect(momentAt(ENTRIES, Infinity)?.t).toBe(10);
});

test("who had the robot is told of that moment, not of the end", () => {
  const entries = [
    entry(0),
    entry(2, { events: [{ kind: "take_over" }] }),
    entry(5, { events: [{ kind: "give_back", by_hand: [{ task: "c", skipped: true }] }] }),
    entry(6, { events: [{ kind: "pause" }] }),
    entry(7, { events: [{ kind: "resume" }] }),
    entry(9, { events: [], ended: true }),
  ];
  const at = (t: number) => momentAt(entries, t);
  expect([0, 2, 4, 5, 6, 8, 9].map((t) => at(t)?.control)).toEqual([
    "autonomous",
    "supervised",
    "supervised",
    "autonomous",
    "paused",
    "autonomous",
    "ended",
  ]);
  expect([at(4), at(6)].map((moment) => moment?.outcomes.get("c"))).toEqual([undefined, "skipped"]);
});
