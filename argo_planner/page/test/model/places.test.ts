import { describe, expect, test } from "vitest";

import { outline, type Row } from "../../src/model/outline";
import { moves, placeForNew, step } from "../../src/model/places";
import { group, mission } from "./missions";

const PLAN = mission("a b c d e", group("G", "b", "c"));
const ROWS = outline(PLAN);

function row(key: string): Row {
  const found = ROWS.find((one) => one.key === key);
  if (!found) throw new Error(key);
  return found;
}

describe("a new task goes", () => {
  test("to the end where nothing is selected", () => {
    expect(placeForNew(ROWS, [])).toEqual({});
  });
  test("behind the one that was selected last, into its group", () => {
    expect(placeForNew(ROWS, ["task:a", "task:c"])).toEqual({ after: "c", into: "G" });
  });
  test("behind a group that is selected", () => {
    expect(placeForNew(ROWS, ["group:G"])).toEqual({ after: "c" });
  });
});

describe("what is selected moves", () => {
  test("in its order, one behind the other", () => {
    expect(moves(PLAN, ROWS, ["task:e", "task:a"], row("task:c"), "after")).toEqual([
      { kind: "move_task", name: "a", after: "c", into: "G" },
      { kind: "move_task", name: "e", after: "a", into: "G" },
    ]);
  });
  test("not beside itself", () => {
    expect(moves(PLAN, ROWS, ["task:a"], row("task:a"), "after")).toEqual([]);
    expect(moves(PLAN, ROWS, ["group:G"], row("task:b"), "after")).toEqual([]);
  });
  test("as a group with all that lies in it", () => {
    const edits = moves(PLAN, ROWS, ["group:G"], row("task:e"), "after");
    expect(edits.map((one) => one.kind)).toEqual([
      "dissolve_group",
      "move_task",
      "move_task",
      "wrap_tasks",
    ]);
  });
  test("beside another task where the place's own one moves too", () => {
    expect(moves(PLAN, ROWS, ["task:b"], row("group:G"), "before")).toEqual([
      { kind: "move_task", name: "b", before: "c" },
    ]);
  });
});

describe("one step", () => {
  test("up leads past the task above", () => {
    expect(step(ROWS, ["task:e"], "up")).toMatchObject({ target: { key: "task:d" }, side: "before" });
  });
  test("up leads into the group above, to its end", () => {
    expect(step(ROWS, ["task:d"], "up")).toMatchObject({ target: { key: "task:c" }, side: "after" });
  });
  test("up leads out of the group of which it is the first", () => {
    expect(step(ROWS, ["task:b"], "up")).toMatchObject({ target: { key: "group:G" }, side: "before" });
  });
  test("down leads into the group below, and out of it at its end", () => {
    expect(step(ROWS, ["task:a"], "down")).toMatchObject({ target: { key: "group:G" }, side: "into" });
    expect(step(ROWS, ["task:c"], "down")).toMatchObject({ target: { key: "group:G" }, side: "after" });
  });
  test("there is none beyond the ends", () => {
    expect(step(ROWS, ["task:a"], "up")).toBeNull();
    expect(step(ROWS, ["task:e"], "down")).toBeNull();
    expect(step(ROWS, [], "up")).toBeNull();
  });
});
