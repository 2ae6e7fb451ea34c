import { expect, test } from "vitest";

import type { Diagnostic, MissionReading } from "../../src/api/types";
import { lineOf, linesBySource, linesBySteps, nameInLine, offsetOf, worstSeverities } from "../../src/model/script-lines";

const TEXT = "Mission Protocol #3\n\n1. Set the start.\n2. Check #4,\n   retry twice.\n10. Return.\n";
const entry = (name: string, step: number | null, line: number | null = null) =>
  ({ name, step, source: line === null ? null : { line, column: 1, length: 1 } }) as unknown as MissionReading["entries"][number];

test("steps are found by their numbers, with their continuation lines", () => {
  const lines = linesBySteps(TEXT, [entry("START", 1), entry("M", 2), entry("DOCK", 10), entry("x", 7), entry("", null)]);
  expect([...lines]).toEqual([
    ["START", { from: 3, to: 3 }],
    ["M", { from: 4, to: 5 }],
    ["DOCK", { from: 6, to: 6 }],
  ]);
  expect([3, 5, 6].map((line) => nameInLine(lines, line))).toEqual(["START", "M", "DOCK"]);
  expect(nameInLine(lines, 2)).toBeNull();
});

test("in a person's own text they are at the source lines of the mission", () => {
  const lines = linesBySource("a\nb\n  c\nd", [entry("x", 1, 2), entry("far", 2, 99), entry("none", 3)]);
  expect([...lines]).toEqual([["x", { from: 2, to: 3 }]]);
});

test("offsets and lines are converted into each other", () => {
  expect(lineOf(TEXT, 0)).toBe(1);
  const at = offsetOf(TEXT, 4, 4);
  expect(TEXT.slice(at, at + 5)).toBe("Check");
  expect(lineOf(TEXT, at)).toBe(4);
  expect(offsetOf(TEXT, 99, 99)).toBe(TEXT.length);
});

test("each line has its worst severity", () => {
  const said = (severity: string, line: number | null) =>
    ({ severity, span: line === null ? null : { line, column: 1, length: 1 } }) as unknown as Diagnostic;
  const found = worstSeverities([said("note", 1), said("error", 2), said("warning", 2), said("warning", 1), said("error", null)]);
  expect([...found]).toEqual([[1, "warning"], [2, "error"]]);
});
