import { expect, test } from "vitest";

import { copiedText, pasteEdits, parseCopied } from "../../src/model/clipboard";
import type { Task } from "../../src/api/types";
import { group, mission, task } from "./missions";

const condition = { type: "MEASURED_VALUE_LESS", id: "", object_id: "1", param1: 2, inclusive: false } as const;
const only = (...tasks: Task[]) => ({ tasks, groups: [] });

test("copied text is parsed, other text is not", () => {
  expect(parseCopied(copiedText(only(task("a"))))?.tasks[0]?.name).toBe("a");
  expect(parseCopied("some text")).toBeNull();
  expect(parseCopied('{"kind": "other"}')).toBeNull();
});

test("copies get free names and follow each other", () => {
  const { edits, names } = pasteEdits(mission("a b"), only(task("a"), task("b")), { after: "b" });
  expect(names).toEqual(["a (2)", "b (2)"]);
  expect(edits).toMatchObject([
    { kind: "add_task", task: { name: "a (2)" }, after: "b" },
    { kind: "add_task", task: { name: "b (2)" }, after: "a (2)" },
  ]);
});

test("conditional transitions lead to copies or existing tasks, others are left out", () => {
  const way = (target: string) => ({ target, conditions: [condition] });
  const first = task("a", { transitions: [way("b"), way("c"), way("gone"), { target: "b", conditions: [] }] });
  const { edits } = pasteEdits(mission("b c"), only(first, task("b")), {});
  expect(edits.filter((one) => one.kind === "add_transition")).toEqual([
    { kind: "add_transition", task: "a", transition: way("b (2)"), at: 0 },
    { kind: "add_transition", task: "a", transition: way("c"), at: 1 },
  ]);
});

test("the transition without conditions is kept", () => {
  const first = task("a", {
    transitions: [
      { target: "b", conditions: [condition] },
      { target: "c", conditions: [] },
    ],
  });
  const { edits } = pasteEdits(mission("a b c"), only(first, task("b"), task("c")), { after: "c" });
  expect(edits.at(-1)).toEqual({
    kind: "set_transitions",
    task: "a (2)",
    transitions: [
      { target: "b (2)", conditions: [condition] },
      { target: "c (2)", conditions: [] },
    ],
  });
});

test("a second start is not pasted", () => {
  const there = { ...mission("a"), tasks: [task("START", { action: "START" }), task("a")] };
  expect(pasteEdits(there, only(task("START", { action: "START" })), {}).edits).toEqual([]);
});

test("groups are copied with their fields under free names, inner ones first", () => {
  const had = mission("a b c");
  const groups = [
    { ...group("Round", "a", "c"), max_repeat_count: 3 },
    { ...group("Round/Twice", "b", "c"), max_repeat_count: 2 },
  ];
  const { edits } = pasteEdits({ ...had, groups }, { tasks: had.tasks, groups }, { after: "c" });
  expect(edits.slice(3)).toMatchObject([
    { kind: "wrap_tasks", group: { name: "Twice (2)", start: "b (2)", end: "c (2)", max_repeat_count: 2 } },
    { kind: "wrap_tasks", group: { name: "Round (2)", start: "a (2)", end: "c (2)", max_repeat_count: 3 } },
  ]);
});
