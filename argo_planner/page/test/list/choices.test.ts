import { expect, test } from "vitest";

import { matching, type Choice } from "../../src/list/choices";

const CHOICES: Choice[] = [
  { label: "4 valve R25", detail: "", checkpoint: "4" },
  { label: "14 valve R18", detail: "", checkpoint: "14" },
  { label: "40 tank gauge", detail: "", checkpoint: "40" },
];

test("a number means that checkpoint first", () => {
  expect(matching(CHOICES, "4").map((one) => one.checkpoint)).toEqual(["4", "40", "14"]);
  expect(matching(CHOICES, "#14")[0]?.checkpoint).toBe("14");
});

test("words are found wherever they begin", () => {
  expect(matching(CHOICES, "tank").map((one) => one.checkpoint)).toEqual(["40"]);
  expect(matching(CHOICES, "r18").map((one) => one.checkpoint)).toEqual(["14"]);
});

test("nothing fits what nothing is called", () => {
  expect(matching(CHOICES, "pump")).toEqual([]);
});
