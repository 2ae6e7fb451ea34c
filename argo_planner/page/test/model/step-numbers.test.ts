import { expect, test } from "vitest";

import type { MissionReading } from "../../src/api/types";
import { countSteps, numbersText, readSteps, sortedNumbers } from "../../src/model/step-numbers";
import { group, mission } from "./missions";

type Entries = MissionReading["entries"];

function entries(...parts: readonly (readonly [part: "task" | "round", name: string, step: number | null])[]): Entries {
  return parts.map(([part, name, step]) => ({ part, name, step, sentences: [], meaning: [], assumed: [] }));
}

const NESTED = mission("a b c d e", group("G", "b", "d"), group("G/H", "c", "d"));

test("a group is counted after its tasks, as a script repeats steps", () => {
  expect([...countSteps(mission("a b c d", group("G", "b", "c")), new Set())]).toEqual([
    ["task:a", "1"],
    ["task:b", "2"],
    ["task:c", "3"],
    ["group:G", "4"],
    ["task:d", "5"],
  ]);
});

test("groups that end together are counted in the order of the mission", () => {
  const numbers = countSteps(NESTED, new Set());
  expect(["group:G", "group:G/H", "task:e"].map((key) => numbers.get(key))).toEqual(["5", "6", "7"]);
});

test("the tasks of a patrol are parts of its step", () => {
  const patrol = mission("a b c d", group("P", "b", "c"));
  const read = readSteps(patrol, entries(["task", "a", 1], ["round", "P", 2], ["task", "d", 3]));
  expect([...read.numbers].sort()).toEqual([
    ["group:P", "2"],
    ["task:a", "1"],
    ["task:b", "2.1"],
    ["task:c", "2.2"],
    ["task:d", "3"],
  ]);
  const longer = mission("a b c d e", group("P", "b", "c"));
  expect(countSteps(longer, read.unusual).get("task:e")).toBe("4"); // before the next reading
});

test("a task that no step states has no number", () => {
  const read = readSteps(mission("a b c"), entries(["task", "a", 1], ["task", "b", 2]));
  expect(read.numbers.has("task:c")).toBe(false);
  expect(countSteps(mission("a b c d"), read.unusual).get("task:d")).toBe("3");
});

test("the numbers are those of the script", () => {
  expect(readSteps(mission("a b"), entries(["task", "a", 3], ["task", "b", 7])).numbers.get("task:b")).toBe("7");
});

test("a mission without tasks has no steps", () => {
  expect(countSteps(mission(""), new Set()).size).toBe(0);
});

test.each([
  [[], ""],
  [["4"], "4"],
  [["1", "2"], "1, 2"],
  [["1", "2", "3", "5", "8", "9"], "1–3, 5, 8, 9"],
  [["3", "4.1", "4.2", "4.3", "5"], "3, 4.1–4.3, 5"],
])("numbers %j are written as %j", (numbers, text) => {
  expect(numbersText(numbers)).toBe(text);
});

test("parts of a step are sorted by their numbers", () => {
  expect(sortedNumbers(["10", "4.10", "4.9", "5"])).toEqual(["4.9", "4.10", "5", "10"]);
});
