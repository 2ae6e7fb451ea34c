import { describe, expect, test } from "vitest";

import { outline, type Row } from "../../src/model/outline";
import { moveEdits, positionForNew, stepTarget } from "../../src/model/task-positions";
import { group, mission } from "./missions";

const PLAN = mission("a b c d e", group("G", "b", "c"));
const ROWS = outline(PLAN);

function row(key: string): Row {
  const found = ROWS.find((one) => one.key === key);
  if (!found) throw new Error(key);
  return found;
}

describe("a new task goes", () => {
  test("to the end if nothing is selected", () => {
    expect(positionForNew(ROWS, [])).toEqual({});
  });
  test("after the last selected task, into its group", () => {
    expect(positionForNew(ROWS, ["task:a", "task:c"])).toEqual({ after: "c", into: "G" });
  });
  test("after a selected group", () => {
    expect(positionForNew(ROWS, ["group:G"])).toEqual({ after: "c" });
  });
});

describe("the selection moves", () => {
  test("in its order", () => {
    expect(moveEdits(PLAN, ROWS, ["task:e", "task:a"], row("task:c"), "after")).toEqual([
      { kind: "move_task", name: "a", after: "c", into: "G" },
      { kind: "move_task", name: "e", after: "a", into: "G" },
    ]);
  });
  test("not beside itself", () => {
    expect(moveEdits(PLAN, ROWS, ["task:a"], row("task:a"), "after")).toEqual([]);
    expect(moveEdits(PLAN, ROWS, ["group:G"], row("task:b"), "after")).toEqual([]);
  });
  test("as a group with its content", () => {
    const edits = moveEdits(PLAN, ROWS, ["group:G"], row("task:e"), "after");
    expect(edits.map((one) => one.kind)).toEqual([
      "dissolve_group",
      "move_task",
      "move_task",
      "wrap_tasks",
    ]);
  });
  test("relative to another task if the target moves as well", () => {
    expect(moveEdits(PLAN, ROWS, ["task:b"], row("group:G"), "before")).toEqual([
      { kind: "move_task", name: "b", before: "c" },
    ]);
  });
});

describe("one step", () => {
  test("up passes the task above", () => {
    expect(stepTarget(ROWS, ["task:e"], "up")).toMatchObject({ target: { key: "task:d" }, side: "before" });
  });
  test("up enters the group above at its end", () => {
    expect(stepTarget(ROWS, ["task:d"], "up")).toMatchObject({ target: { key: "task:c" }, side: "after" });
  });
  test("up leaves a group from its first task", () => {
    expect(stepTarget(ROWS, ["task:b"], "up")).toMatchObject({ target: { key: "group:G" }, side: "before" });
  });
  test("down enters the group below, and leaves it at its end", () => {
    expect(stepTarget(ROWS, ["task:a"], "down")).toMatchObject({ target: { key: "group:G" }, side: "into" });
    expect(stepTarget(ROWS, ["task:c"], "down")).toMatchObject({ target: { key: "group:G" }, side: "after" });
  });
  test("there is no step beyond the ends", () => {
    expect(stepTarget(ROWS, ["task:a"], "up")).toBeNull();
    expect(stepTarget(ROWS, ["task:e"], "down")).toBeNull();
    expect(stepTarget(ROWS, [], "up")).toBeNull();
  });
});
