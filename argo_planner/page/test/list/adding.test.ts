import { expect, test } from "vitest";

import { measureEdits } from "../../src/list/adding";
import { floorChoices, matchingChoices } from "../../src/list/choices";
import type { World } from "../../src/api/types";
import { group, mission } from "../model/missions";

test("checkpoints are measured one after the other, after the selection", () => {
  const { edits, names } = measureEdits(mission("a b c", group("G", "b", "c")), ["task:b"], ["4", "8"]);
  expect(names).toEqual(["MEASURE 4", "MEASURE 8"]);
  expect(edits).toMatchObject([
    { after: "b", into: "G" },
    { after: "MEASURE 4", into: "G" },
  ]);
});

test("a checkpoint that is measured already gets another name", () => {
  const open = mission("a");
  const again = { ...open, tasks: open.tasks.map((task) => ({ ...task, name: "MEASURE 4" })) };
  expect(measureEdits(again, [], ["4", "4"]).names).toEqual(["MEASURE 4 (2)", "MEASURE 4 (3)"]);
});

test("a floor has its checkpoints that can be read", () => {
  const checkpoint = (id: number, floor: number, problem: string | null = null) => ({ id, floor, problem });
  const site = {
    floors: [{ number: 1 }, { number: 2 }, { number: 3 }],
    checkpoints: [checkpoint(1, 1), checkpoint(2, 1, "no pose"), checkpoint(3, 1), checkpoint(4, 2)],
  } as unknown as World;
  const choices = floorChoices(site);
  expect(choices.map(({ label, detail }) => `${label}: ${detail}`)).toEqual([
    "Floor 1: all 2 checkpoints",
    "Floor 2: its checkpoint",
  ]);
  expect(matchingChoices(choices, "floor 1")[0]?.checkpoints).toEqual(["1", "3"]);
});
