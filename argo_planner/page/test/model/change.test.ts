import { expect, test } from "vitest";

import type { Mission, MissionChange } from "../../src/api/types";
import { applyChange } from "../../src/model/change";
import { mission, task } from "./missions";

function names(found: Mission): string {
  return found.tasks.map((one) => one.name).join(" ");
}

function tasksChange(put: string[], gone: string[], placed: [string, string | null][]): MissionChange {
  return { tasks: { put: put.map((name) => task(name)), gone, placed } };
}

test("removed tasks disappear, placed ones follow the named task", () => {
  const change = tasksChange(["x", "y"], ["b"], [["x", null], ["y", "c"]]);
  expect(names(applyChange(mission("a b c d"), change))).toBe("x a c y d");
});

test("placements are applied one after the other", () => {
  const change = tasksChange([], [], [["d", null], ["c", "d"]]);
  expect(names(applyChange(mission("a b c d"), change))).toBe("d c a b");
});

test("a replaced task keeps its position", () => {
  const change: MissionChange = {
    tasks: { put: [task("b", { retries: 3 })], gone: [], placed: [] },
  };
  const after = applyChange(mission("a b c"), change);
  expect(names(after)).toBe("a b c");
  expect(after.tasks[1]?.retries).toBe(3);
});

test("header fields take their new values", () => {
  const change = { header: { kind: "set_header", designation: "Night" } } as MissionChange;
  expect(applyChange(mission("a"), change).designation).toBe("Night");
});
