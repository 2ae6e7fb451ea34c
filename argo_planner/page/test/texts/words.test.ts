import { expect, test } from "vitest";

import { words } from "../../src/texts/words";

test("times have a unit, and the decimal sign of the language", () => {
  expect([12, 43.14, 59.97, 61, 3_920].map(words.en.seconds)).toEqual([
    "12 s",
    "43.1 s",
    "1:00 min",
    "1:01 min",
    "1:05:20 h",
  ]);
  expect(words.de.seconds(43.14)).toBe("43,1 s");
});
