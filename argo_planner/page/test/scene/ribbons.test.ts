import { describe, expect, it } from "vitest";

import { arrows, ribbon, type RibbonLeg, ribbonPaths, type WayPoint } from "../../src/model/ribbons";

const floorAt = (z: number) => (z < 2.4 ? 1 : 2);

function leg(way: number, places: readonly (readonly [number, number, number?])[], more: Partial<RibbonLeg> = {}): RibbonLeg {
  const points = places.map(([x, y, z = 0], i): WayPoint => [10 * i, x, y, z, 0]);
  return { way, points, start: 0, dashed: false, ...more };
}

describe("paths as ribbons", () => {
  it("follow the path, with the time since the mission's start", () => {
    const [path] = ribbonPaths([leg(0, [[0, 0], [4, 0], [4, 0], [4, 2]], { start: 100 })]);
    const samples = path?.samples ?? [];
    expect(samples[0]).toMatchObject({ x: 0, y: 0, t: 100, along: 0 });
    expect(samples.at(-1)).toMatchObject({ x: 4, y: 2, t: 130, along: 6, dx: 0, dy: 1 });
    expect(Math.max(...samples.map((one, i) => one.along - (samples[i - 1]?.along ?? 0)))).toBeLessThanOrEqual(0.25);
  });

  it("are side by side if they are driven again", () => {
    const paths = ribbonPaths([leg(0, [[0, 0], [6, 0]]), leg(1, [[6, 0], [0, 0]]), leg(2, [[0, 0], [6, 0]])]);
    const middle = paths.map(({ samples }) => samples[Math.floor(samples.length / 2)]?.y ?? 0);
    expect(middle[0]).toBeCloseTo(0);
    expect(Math.abs((middle[1] ?? 0) - (middle[2] ?? 0))).toBeCloseTo(0.26);
    expect(Math.abs(middle[1] ?? 0)).toBeCloseTo(0.13);
  });

  it("stay in the middle if others only cross, or are on another floor", () => {
    const paths = ribbonPaths([leg(0, [[0, 0], [6, 0]]), leg(1, [[3, -3], [3, 3]]), leg(2, [[0, 0, 2.5], [6, 0, 2.5]])]);
    expect(paths[1]?.samples.every((one) => one.x === 3)).toBe(true);
    expect(paths[2]?.samples.every((one) => one.y === 0)).toBe(true);
  });

  it("never shift abruptly", () => {
    const paths = ribbonPaths([leg(0, [[2, 0], [4, 0]]), leg(1, [[0, 0], [6, 0]])]);
    const samples = paths[1]?.samples ?? [];
    for (let i = 1; i < samples.length; i++)
      expect(Math.abs((samples[i]?.y ?? 0) - (samples[i - 1]?.y ?? 0))).toBeLessThan(0.05);
  });

  it("are split by floor, with stairs on the lower one", () => {
    const [path] = ribbonPaths([leg(0, [[0, 0, 0], [4, 0, 2.5], [8, 0, 2.5]])]);
    const parts = ribbon(path as NonNullable<typeof path>, 0.2, 0, floorAt);
    expect([...parts.keys()]).toEqual([1, 2]);
    for (const { corners, times } of parts.values()) expect(corners.length).toBe(3 * times.length);
    const lower = parts.get(1)?.corners.filter((_, i) => i % 3 === 2) ?? [];
    expect(Math.max(...lower)).toBeLessThanOrEqual(2.5);
  });

  it("have gaps if they are not driven by default", () => {
    const count = (dashed: boolean) => {
      const [path] = ribbonPaths([leg(0, [[0, 0], [6, 0]], { dashed })]);
      return ribbon(path as NonNullable<typeof path>, 0.1, 0, floorAt).get(1)?.times.length ?? 0;
    };
    expect(count(true)).toBeLessThan(0.7 * count(false));
  });

  it("have arrows in the direction of motion", () => {
    const [path] = ribbonPaths([leg(0, [[0, 0], [0, 6]])]);
    const { corners = [] } = arrows(path as NonNullable<typeof path>, 0.2, 1.5, 0, floorAt).get(1) ?? {};
    expect(corners.length / 9).toBe(4);
    expect(corners[7]).toBeGreaterThan(corners[1] ?? 0);
  });

  it("are empty if nothing is driven", () => {
    expect(ribbonPaths([leg(0, [])])[0]?.samples).toEqual([]);
    expect(ribbonPaths([leg(0, [[1, 1], [1, 1]])])[0]?.samples).toEqual([]);
  });
});
