import { expect, test } from "vitest";

import type { Mission, Task } from "../../src/api/types";
import { branchesOf } from "../../src/model/branches";
import { outline, visibleRows } from "../../src/model/outline";
import { group, mission } from "./missions";

const ABOVE = { type: "MEASURED_VALUE_GREATER", id: "", object_id: "1", param1: 5, inclusive: false } as const;

/** Change tasks of a mission by their names. */
function changed(open: Mission, changes: Readonly<Record<string, Partial<Task>>>): Mission {
  return { ...open, tasks: open.tasks.map((task) => ({ ...task, ...changes[task.name] })) };
}

function drawn(open: Mission, folded: readonly string[] = []): string[] {
  const rows = visibleRows(outline(open), new Set(folded));
  return branchesOf(open, rows).map(({ from, to, kind, lane }) => `${from}-${to} ${kind} ${lane}`);
}

test("the next task needs no line", () => {
  expect(drawn(changed(mission("a b"), { a: { transitions: [{ target: "b", conditions: [] }] } }))).toEqual([]);
});

test("conditions, jumps and failures are lines of their kinds", () => {
  const open = changed(mission("a b c d"), {
    a: {
      transitions: [
        { target: "c", conditions: [ABOVE] },
        { target: "d", conditions: [] },
      ],
      on_failure: "branch",
      failure_target: "b",
    },
  });
  expect(drawn(open)).toEqual(["0-1 failure 0", "0-2 condition 1", "0-3 onward 2"]);
});

test("lines that do not overlap share a lane", () => {
  const jump = (target: string) => ({ transitions: [{ target, conditions: [ABOVE] }] });
  const open = changed(mission("a b c d e f"), { a: jump("c"), d: jump("f") });
  expect(drawn(open)).toEqual(["0-2 condition 0", "3-5 condition 0"]);
});

test("a folded group stands for its tasks", () => {
  const jump = (target: string) => ({ transitions: [{ target, conditions: [ABOVE] }] });
  const open = changed(mission("a b c d", group("G", "b", "c")), { a: jump("c"), b: jump("c"), c: jump("a") });
  expect(drawn(open, ["group:G"])).toEqual(["0-1 condition 0", "1-0 condition 1"]);
});

test("a target that does not exist is not drawn", () => {
  expect(drawn(changed(mission("a"), { a: { transitions: [{ target: "x", conditions: [ABOVE] }] } }))).toEqual([]);
});
