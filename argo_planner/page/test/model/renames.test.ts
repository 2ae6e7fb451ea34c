import { expect, test } from "vitest";

import type { Group, Mission, Reaction, Task } from "../../src/api/types";
import { renamesBetween } from "../../src/model/renames";

function mission(tasks: readonly string[], groups: readonly Partial<Group>[] = [], events: readonly string[] = []): Mission {
  return {
    tasks: tasks.map((text) => {
      const [name, object_id = null] = text.split(":");
      return { name, action: "MEASURE", object_id, pose: null, wait: null, velocity: null, retries: 0 } as unknown as Task;
    }),
    groups: groups as Group[],
    reactions: events.map((event) => ({ event }) as Reaction),
  } as unknown as Mission;
}
const found = (before: Mission, after: Mission) => Object.fromEntries(renamesBetween(before, after));

test("a task with a new name in the same place is the same task", () => {
  expect(found(mission(["A:1", "B:2", "C:1"]), mission(["A:1", "X:2", "C:1"]))).toEqual({ "task:B": "task:X" });
});

test("several renames at once", () => {
  const groups = [{ name: "g", start: "A", end: "B" }];
  const after = [{ name: "g", start: "X", end: "Y" }];
  expect(found(mission(["A:1", "B:2"], groups), mission(["X:1", "Y:2"], after))).toEqual({
    "task:A": "task:X",
    "task:B": "task:Y",
  });
});

test.each([
  [["A:1", "B:2"], ["A:1"]],
  [["A:1", "B:2"], ["A:1", "B:2", "C:3"]],
  [["A:1", "B:2"], ["B:2", "A:1"]],
  [["A:1", "B:2"], ["A:1", "X:3"]],
  [["A:1", "B:2"], ["X:1", "A:2"]],
])("%s to %s is no rename", (before, after) => {
  expect(found(mission(before), mission(after))).toEqual({});
});

test("a group with the same tasks is the same group, and so are those in it", () => {
  const before = [
    { name: "g", start: "A", end: "B" },
    { name: "g/h", start: "A", end: "B" },
  ];
  const after = [
    { name: "x", start: "A", end: "B" },
    { name: "x/h", start: "A", end: "B" },
  ];
  expect(found(mission(["A:1", "B:2"], before), mission(["A:1", "B:2"], after))).toEqual({
    "group:g": "group:x",
    "group:g/h": "group:x/h",
  });
});

test("a reaction to another event is the same reaction", () => {
  expect(found(mission([], [], ["gas", "low_battery"]), mission([], [], ["gas", "obstacle"]))).toEqual({
    "reaction:low_battery": "reaction:obstacle",
  });
});
