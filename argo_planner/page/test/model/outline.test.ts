import { expect, test } from "vitest";

import { matchingRows, outline, visibleRows } from "../../src/model/outline";
import { group, mission } from "./missions";

const NESTED = mission("a b c d e", group("G", "b", "d"), group("G/H", "c", "d"));

function drawn(rows: ReturnType<typeof outline>): string[] {
  return rows.map((row) => "-".repeat(row.depth) + row.key);
}

test("groups precede their tasks and are nested", () => {
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

test("a folded group hides its content", () => {
  const rows = visibleRows(outline(NESTED), new Set(["group:G"]));
  expect(drawn(rows)).toEqual(["task:a", "group:G", "task:e"]);
});

test("each row knows the innermost group around it", () => {
  const inside = outline(NESTED).map((row) => row.inside);
  expect(inside).toEqual([null, null, "G", "G", "G/H", "G/H", null]);
});

test("groups of missing tasks are left out", () => {
  expect(drawn(outline(mission("a", group("G", "x", "y"))))).toEqual(["task:a"]);
});

test("what matches is shown with the groups around it", () => {
  const rows = matchingRows(outline(NESTED), ({ key }) => key === "task:c" || key === "task:e");
  expect(drawn(rows)).toEqual(["group:G", "-group:G/H", "--task:c", "task:e"]);
  expect(drawn(matchingRows(outline(NESTED), ({ key }) => key === "group:G"))).toEqual(["group:G"]);
});
