import { describe, expect, it } from "vitest";

import { hull, nearness, outlineData, projected, silhouette, type Point } from "../../src/model/axonometry";

describe("the picture of a site", () => {
  it("draws what is higher further up", () => {
    const [x, low] = projected(3, 2, 0);
    expect(projected(3, 2, 4)).toEqual([x, expect.closeTo(low - 4 * 1.35)]);
  });

  it("draws what is nearer further down", () => {
    const points: Point[] = [[0, 0], [4, 0], [0, 4], [4, 4]];
    const byNearness = [...points].sort((a, b) => nearness(a[0], a[1]) - nearness(b[0], b[1]));
    const heights = byNearness.map(([x, y]) => projected(x, y, 0)[1]);
    expect(heights).toEqual([...heights].sort((a, b) => a - b));
  });

  it("has a hull without inner points", () => {
    const square: Point[] = [[0, 0], [2, 0], [1, 1], [2, 2], [0, 2], [1, 0]];
    expect(hull(square).map(String).sort()).toEqual(["0,0", "0,2", "2,0", "2,2"]);
  });

  it("draws a body around its base and its lid", () => {
    const base: Point[] = [[0, 0], [1, 0], [1, 1], [0, 1]];
    const drawn = silhouette(base, 0, 2);
    expect(drawn).toHaveLength(6);
    const heights = drawn.map(([, y]) => y);
    expect(Math.max(...heights) - Math.min(...heights)).toBeGreaterThan(2 * 1.35);
  });

  it("writes closed outlines with two decimals, without lines of two points", () => {
    expect(outlineData([[[0, 0], [1.2345, 0], [1, 1]], [[0, 0], [1, 1]]])).toBe("M0 0L1.23 0L1 1Z");
  });
});
