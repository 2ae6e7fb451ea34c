import { expect, test } from "vitest";

import { readTime, writeTime } from "../../src/forms/times";

test.each([
  ["90", 90],
  ["90 s", 90],
  ["1:30", 90],
  ["1:30 min", 90],
  ["1:05:00", 3900],
  ["10 min", 600],
  ["1.5 h", 5400],
  ["1,5 h", 5400],
  ["2 h 30 min", 9000],
  ["1h5m10s", 3910],
  ["0", 0],
  ["10 Minuten", 600],
  ["20'", 1200],
  ["1' 30\"", 90],
])("%s is parsed", (text, seconds) => {
  expect(readTime(text)).toBe(seconds);
});

test.each(["", "soon", "-5", "10 parsecs", "1:2:3:4", "min", "5 min later"])("%s is not accepted", (text) => {
  expect(readTime(text)).toBeNull();
});

test.each([0, 1, 59, 60, 90, 119.5, 120, 600, 3600, 3910, 86399])("%s s is parsed again after formatting", (seconds) => {
  expect(readTime(writeTime(seconds))).toBe(seconds);
});
