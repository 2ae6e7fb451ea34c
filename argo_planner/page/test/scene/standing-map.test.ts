import { deflateSync } from "node:zlib";

import { describe, expect, it } from "vitest";

import { floorOf, type Ground, neighbouringHeadings, readStandingMap, cellVerdict, type StandingMap, verdictAt } from "../../src/model/standing-map";

const GROUNDS: readonly Ground[] = ["none", "too_near", "too_steep", "cut_off", "closed", "reached"];
const EIGHTHS = Array.from({ length: 8 }, (_, k) => (k * Math.PI) / 4);

/** Create a map of two layers, each 2 rows by 3 columns of 0.5 m cells, from (1, 2) on. */
function map(codes: readonly number[], heights: readonly number[] = []): StandingMap {
  return {
    floor: 1,
    heading: 0,
    yaw: 0,
    origin: [1, 2],
    cell: 0.5,
    layers: 2,
    rows: 2,
    columns: 3,
    z: 10,
    step: 0.001,
    grounds: GROUNDS,
    codes: Uint8Array.from(codes),
    heights: Int16Array.from({ length: 12 }, (_, i) => heights[i] ?? 0),
  };
}

describe("the map of where the robot can stand", () => {
  const one = map([5, 1, 0, 2, 3, 4, 0, 5, 0, 0, 0, 0], [0, 0, 0, 0, 0, 0, 0, 1500]);

  it("has a code for each cell, columns along x", () => {
    expect(cellVerdict(one, 1.01, 2.01, 10)).toEqual({ ground: "reached", z: 10 });
    expect(cellVerdict(one, 1.7, 2.3, 10).ground).toBe("too_near");
    expect(cellVerdict(one, 1.2, 2.6, 10).ground).toBe("too_steep");
    expect(cellVerdict(one, 2.49, 2.99, 10).ground).toBe("closed");
  });

  it("has no ground beyond its edges and in empty cells", () => {
    expect(cellVerdict(one, 0.99, 2.1, 10)).toEqual({ ground: "none", z: 10 });
    expect(cellVerdict(one, 2.51, 2.1, 10).ground).toBe("none");
    expect(cellVerdict(one, 2.2, 2.2, 10).ground).toBe("none");
  });

  it("uses the layer nearest in height", () => {
    expect(cellVerdict(one, 1.7, 2.3, 11.4)).toEqual({ ground: "reached", z: 11.5 });
    expect(cellVerdict(one, 1.7, 2.3, 10.6).ground).toBe("too_near");
  });

  it("is parsed from the service's format", async () => {
    const { grounds, codes, heights, ...header } = one;
    const names = Object.fromEntries(grounds.map((name, code) => [name, code]));
    const body = Buffer.concat([Buffer.from(codes), Buffer.from(heights.buffer)]);
    const line = Buffer.from(`${JSON.stringify({ ...header, codes: names })}\n`);
    const sent = Uint8Array.from(Buffer.concat([line, deflateSync(body)]));
    const read = await readStandingMap(sent.buffer);
    expect(read).toEqual(one);
  });
});

describe("the verdict on a heading", () => {
  it("is that of the map with the heading", () => {
    expect(neighbouringHeadings(Math.PI / 4, EIGHTHS)).toEqual([1]);
    expect(neighbouringHeadings(-Math.PI / 4, EIGHTHS)).toEqual([7]);
    expect(neighbouringHeadings(2 * Math.PI, EIGHTHS)).toEqual([0]);
  });

  it("is the worse one of the neighbouring headings", () => {
    expect(neighbouringHeadings(-0.2, EIGHTHS)).toEqual([7, 0]);
    const maps = [map([5, 5, 5, 5, 5, 5, 0, 0, 0, 0, 0, 0]), map([5, 1, 5, 5, 5, 5, 0, 0, 0, 0, 0, 0])];
    const of = (heading: number) => maps[heading];
    expect(verdictAt(of, EIGHTHS, 1.7, 2.3, 10, 0.3)?.ground).toBe("too_near");
    expect(verdictAt(of, EIGHTHS, 1.7, 2.3, 10, 0)?.ground).toBe("reached");
  });

  it("is unknown before the map is loaded", () => {
    expect(verdictAt(() => undefined, EIGHTHS, 0, 0, 0, 0)).toBeNull();
  });
});

it("finds the same floor of a height as the service", () => {
  const floor = (number: number, z: number) => ({ number, z, name: "", storey: 2.5, bounds: [0, 0, 1, 1] as const, plates: [], corners: [] });
  const floors = [floor(1, 0), floor(2, 2.5)];
  expect(floorOf(floors, -0.03)?.number).toBe(1);
  expect(floorOf(floors, 2.39)?.number).toBe(1);
  expect(floorOf(floors, 2.41)?.number).toBe(2);
  expect(floorOf(floors, -5)?.number).toBe(1);
  expect(floorOf([], 0)).toBeUndefined();
});
