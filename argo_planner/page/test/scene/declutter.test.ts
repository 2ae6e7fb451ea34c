import { describe, expect, it } from "vitest";

import { declutter, type LabelRequest, overlap } from "../../src/model/declutter";

function wish(key: string, x: number, y: number, weight = 1): LabelRequest {
  return { key, x, y, width: 80, height: 20, weight };
}

/** Return a generator of the same sequence of numbers between 0 and 1 each time. */
function numbers(): () => number {
  let seed = 7;
  return () => (seed = (seed * 16_807) % 2_147_483_647) / 2_147_483_647;
}

describe("labels", () => {
  it("never cover each other", () => {
    const next = numbers();
    const wishes = Array.from({ length: 400 }, (_, i) => wish(String(i), next() * 900, next() * 700, next() * 9));
    const placed = declutter(wishes, 900, 700);
    expect(placed.length).toBeGreaterThan(60);
    placed.forEach((one, i) => {
      expect(placed.slice(i + 1).some((other) => overlap(one, other))).toBe(false);
      expect(one.left >= 0 && one.top >= 0 && one.left + 80 <= 900 && one.top + 20 <= 700).toBe(true);
    });
  });

  it("are at the right, or elsewhere if there is no room", () => {
    expect(declutter([wish("a", 100, 100)], 900, 700)[0]?.side).toBe("right");
    expect(declutter([wish("a", 880, 100)], 900, 700)[0]?.side).toBe("left");
    const [, second] = declutter([wish("a", 100, 100, 2), wish("b", 110, 100)], 900, 700);
    expect(second?.side).toBe("left");
  });

  it("make room for labels with a higher weight", () => {
    const crowd = Array.from({ length: 9 }, (_, i) => wish(String(i), 300, 300, i));
    const placed = declutter(crowd, 900, 700);
    expect(placed.map((one) => one.key)).toEqual(["8", "7", "6", "5"]);
  });

  it("are at most as many as wanted", () => {
    const wishes = Array.from({ length: 20 }, (_, i) => wish(String(i), 300, 30 * i + 15, i));
    expect(declutter(wishes, 900, 700, new Map(), 5).map((one) => one.key)).toEqual(["19", "18", "17", "16", "15"]);
  });

  it("keep their side", () => {
    const placed = declutter([wish("a", 300, 300)], 900, 700, new Map([["a", "below"]]));
    expect(placed[0]?.side).toBe("below");
  });

  it("cover no box that is taken", () => {
    const taken = [{ left: 105, top: 90, width: 100, height: 20 }];
    expect(declutter([wish("a", 100, 100)], 900, 700, new Map(), Infinity, taken)[0]?.side).toBe("left");
  });
});
