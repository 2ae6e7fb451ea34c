import { expect, test } from "vitest";

import { copied, pasting, readCopied } from "../../src/model/clipboard";
import { mission, task } from "./missions";

test("what is copied is read again, other text is not", () => {
  expect(readCopied(copied([task("a")]))?.[0]?.name).toBe("a");
  expect(readCopied("some text")).toBeNull();
  expect(readCopied('{"kind": "other"}')).toBeNull();
});

test("copies get free names, one behind the other", () => {
  const { edits, names } = pasting(mission("a b"), [task("a"), task("b")], { after: "b" });
  expect(names).toEqual(["a (2)", "b (2)"]);
  expect(edits).toMatchObject([
    { kind: "add_task", task: { name: "a (2)" }, after: "b" },
    { kind: "add_task", task: { name: "b (2)" }, after: "a (2)" },
  ]);
});

test("ways on conditions lead to the copies, others to what is there, the rest is left out", () => {
  const condition = {
    type: "MEASURED_VALUE_LESS",
    id: "",
    object_id: "1",
    param1: 2,
    inclusive: false,
  } as const;
  const way = (target: string) => ({ target, conditions: [condition] });
  const first = task("a", { transitions: [way("b"), way("c"), way("gone"), { target: "b", conditions: [] }] });
  const { edits } = pasting(mission("b c"), [first, task("b")], {});
  expect(edits.filter((one) => one.kind === "add_transition")).toEqual([
    { kind: "add_transition", task: "a", transition: way("b (2)"), at: 0 },
    { kind: "add_transition", task: "a", transition: way("c"), at: 1 },
  ]);
});

test("a second start is not pasted", () => {
  const there = { ...mission("a"), tasks: [task("START", { action: "START" }), task("a")] };
  expect(pasting(there, [task("START", { action: "START" })], {}).edits).toEqual([]);
});
