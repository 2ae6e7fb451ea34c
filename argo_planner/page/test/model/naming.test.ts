import { expect, test } from "vitest";

import { freeName, hasOwnName, numberedName } from "../../src/model/naming";
import { task } from "./missions";

test.each([
  ["MEASURE 14", "MEASURE", "14", false],
  ["MEASURE 14 (2)", "MEASURE", "14", false],
  ["MEASURE 14", "MEASURE", "8", true], // another checkpoint was chosen since
  ["valve", "MEASURE", "14", true],
  ["START", "START", null, false],
  ["Gate", "START", null, true],
  ["WAYPOINT 3", "WAYPOINT", null, false],
  ["DOCK (2)", "WAYPOINT", null, false],
  ["WAYPOINT three", "WAYPOINT", null, true],
  ["WAIT", "WAIT", null, false],
  ["WAIT for Ann", "WAIT", null, true],
] as const)("%s, %s %s: a name of its own is %s", (name, action, object_id, own) => {
  expect(hasOwnName(task(name, { action, object_id }))).toBe(own);
});

test("a taken name gets the first free number", () => {
  expect(freeName("DOCK", new Set(["DOCK", "DOCK (2)"]))).toBe("DOCK (3)");
  expect(numberedName("WAYPOINT", new Set(["WAYPOINT 1"]))).toBe("WAYPOINT 2");
});
