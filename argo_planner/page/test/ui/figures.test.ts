import { describe, expect, it } from "vitest";

import { leastSeconds, mostSeconds, seconds } from "../../src/ui/figures";

describe("times", () => {
  it("are rounded to the nearest second, or tenth of a second", () => {
    expect([59.62, 59.96, 90.6, 3725.4].map(seconds)).toEqual(["59.6 s", "1:00 min", "1:31 min", "1:02:05 h"]);
  });

  it("are rounded to the side of a bound", () => {
    expect([59.99, 90.6, 3725.9].map(leastSeconds)).toEqual(["59.9 s", "1:30 min", "1:02:05 h"]);
    expect([59.91, 90.4, 3725.1].map(mostSeconds)).toEqual(["1:00 min", "1:31 min", "1:02:06 h"]);
  });

  it("ignore errors of sums in bounds", () => {
    expect([leastSeconds(89.99999999999), mostSeconds(90.00000000001)]).toEqual(["1:30 min", "1:30 min"]);
  });
});
