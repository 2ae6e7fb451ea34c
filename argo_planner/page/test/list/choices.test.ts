import { expect, test } from "vitest";

import type { World } from "../../src/api/types";
import { matchingChoices, typedPose, type Choice } from "../../src/list/choices";

const CHOICES: Choice[] = [
  { label: "4 valve R25", detail: "", checkpoint: "4" },
  { label: "14 valve R18", detail: "", checkpoint: "14" },
  { label: "40 tank gauge", detail: "", checkpoint: "40" },
];

test("a number finds the checkpoint with that number first", () => {
  expect(matchingChoices(CHOICES, "4").map((one) => one.checkpoint)).toEqual(["4", "40", "14"]);
  expect(matchingChoices(CHOICES, "#14")[0]?.checkpoint).toBe("14");
});

test("words are found at any position", () => {
  expect(matchingChoices(CHOICES, "tank").map((one) => one.checkpoint)).toEqual(["40"]);
  expect(matchingChoices(CHOICES, "r18").map((one) => one.checkpoint)).toEqual(["14"]);
});

test("an unknown name finds nothing", () => {
  expect(matchingChoices(CHOICES, "pump")).toEqual([]);
});

const SITE = {
  floors: [
    { number: 1, name: "Floor 1", z: 0 },
    { number: 2, name: "Floor 2", z: 2.5 },
  ],
} as unknown as World;

test.each([
  ["1 1", null, [1, 1, 0]],
  ["1.5 -2", 2, [1.5, -2, 2.5]],
  ["1; 2; 2", null, [1, 2, 2.5]],
])("%s is a pose", (text, floor, [x, y, z]) => {
  expect(typedPose(SITE, text, floor)?.pose).toEqual({ x, y, z, yaw: 0 });
});

test.each(["1", "1 2 9", "dock", "1 2 3 4", ""])("%s is not accepted", (text) => {
  expect(typedPose(SITE, text, null)).toBeNull();
});
