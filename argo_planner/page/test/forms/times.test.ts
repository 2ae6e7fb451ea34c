import { expect, test } from "vitest";

import { writeTime } from "../../src/forms/times";

test.each([
  [0, "0 s"],
  [1, "1 s"],
  [60, "1 min"],
  [90, "90 s"],
  [119.5, "119.5 s"],
  [120, "2 min"],
  [600, "10 min"],
  [3600, "1 h"],
  [3910, "1 h 5 min 10 s"],
  [86399, "23 h 59 min 59 s"],
  [1.125, "1.1250 s"],
  [125.0004, "2 min 5 s"],
])("%s s", (seconds, text) => {
  expect(writeTime(seconds)).toBe(text);
});
