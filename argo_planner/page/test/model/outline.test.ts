import { expect, test } from "vitest";

import { outline, unfolded } from "../../src/model/outline";
import { group, mission } from "./missions";

const NESTED = mission("a b c d e", group("G", "b", "d"), group("G/H", "c", "d"));

function drawn(rows: ReturnType<typeof outline>): string[] {
  return rows.map((row) => "-".repeat(row.depth) + row.key);
}

test("groups stand before their tasks, nested as they lie in each other", () => {
  expect(drawn(outline(NESTED))).toEqual([
    "task:a",
    "group:G",
    "-task:b",
    "-group:G/H",
    "--task:c",
    "--task:d",
    "task:e",
  ]);
});

test("what is folded hides all that lies in it", () => {
  const rows = unfolded(outline(NESTED), new Set(["group:G"]));
  expect(drawn(rows)).toEqual(["task:a", "group:G", "task:e"]);
});

test("each row knows the innermost group around it", () => {
  const inside = outline(NESTED).map((row) => row.inside);
  expect(inside).toEqual([null, null, "G", "G", "G/H", "G/H", null]);
});

test("groups of tasks that are not there are left out", () => {
  expect(drawn(outline(mission("a", group("G", "x", "y"))))).toEqual(["task:a"]);
});
