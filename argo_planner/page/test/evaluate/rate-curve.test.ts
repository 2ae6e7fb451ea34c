import { expect, test } from "vitest";

import { rateCurve } from "../../src/model/curves";
import { t } from "../../src/texts";

test("the interval is a closed band around the rate, scaled to all runs", () => {
  const points = [
    { runs: 0, value: null, low: 0, high: 1 },
    { runs: 50, value: 1, low: 0.9, high: 1 },
    { runs: 100, value: 0.5, low: 0.4, high: 0.6 },
  ];
  expect(rateCurve(points, 200, 400, 100)).toEqual({
    band: "M100 0L200 40L200 60L100 10Z",
    rate: "M100 0L200 50",
  });
});

test("nothing is drawn before a run counts", () => {
  expect(rateCurve([], 10, 1, 1)).toBeNull();
  expect(rateCurve([{ runs: 0, value: null, low: 0, high: 1 }], 10, 1, 1)).toBeNull();
});

test("sets of faults have names in words, unknown ones keep theirs", () => {
  const { faultsNamed } = t().evaluate;
  expect(faultsNamed("none")).toBe("no faults");
  expect(faultsNamed("gas_leak")).toBe("gas leak");
  expect(faultsNamed("gas_leak 2")).toBe("gas leak 2");
  expect(faultsNamed("somebody's own")).toBe("somebody's own");
});
