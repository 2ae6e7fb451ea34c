/** Paths as ribbons on the ground: split by floor, side by side where a path is driven again. */

/** A point of a previewed path: time (s), x, y, z (m), yaw (rad). */
export type WayPoint = readonly [number, number, number, number, number];

export interface RibbonLeg {
  /** index in the preview's `ways` */
  readonly way: number;
  readonly points: readonly WayPoint[];
  /** s from the mission's start to the start of the leg */
  readonly start: number;
  readonly dashed: boolean;
}

export interface Sample {
  /** m, after the sideways shift */
  readonly x: number;
  readonly y: number;
  readonly z: number;
  /** direction of motion, a unit vector */
  readonly dx: number;
  readonly dy: number;
  /** s from the mission's start */
  readonly t: number;
  /** m from the start of the path */
  readonly along: number;
}

export interface RibbonPath extends RibbonLeg {
  readonly samples: readonly Sample[];
}

/** m between samples, between neighbouring ribbons, and within which paths are the same */
const EVERY = 0.25;
const SPACING = 0.13;
const SAME = 0.25;
const STOREY = 0.5;
/** Highest number of ribbons side by side: aisles are narrow. */
const MOST_LANES = 5;
/** Number of samples over which a ribbon shifts sideways. */
const SMOOTH = 4;

/** Return the legs in order, each beside the earlier legs on the same path. */
export function ribbonPaths(legs: readonly RibbonLeg[]): RibbonPath[] {
  const driven = new Map<string, Set<number>>();
  return legs.map((leg) => {
    const plain = sampleLeg(leg);
    const lanes = plain.map((one) => earlierLegs(driven, one));
    for (const one of plain) {
      const key = cell(one, 0, 0);
      const there = driven.get(key);
      if (there === undefined) driven.set(key, new Set([leg.way]));
      else if (there.size < MOST_LANES - 1) there.add(leg.way); // more make no difference
    }
    return { ...leg, samples: shiftedAside(plain, lanes) };
  });
}

/** Return points at even distances; where the robot turns in place there is only one. */
function sampleLeg({ points, start }: RibbonLeg): Sample[] {
  const samples: Sample[] = [];
  let along = 0;
  let last: Sample | null = null;
  for (let i = 1; i < points.length; i++) {
    const [t0, x0, y0, z0] = points[i - 1] as WayPoint;
    const [t1, x1, y1, z1] = points[i] as WayPoint;
    const flat = Math.hypot(x1 - x0, y1 - y0);
    if (flat < 1e-3) continue;
    const [dx, dy] = [(x1 - x0) / flat, (y1 - y0) / flat];
    const steps = Math.max(1, Math.ceil(flat / EVERY));
    for (let step = 0; step <= steps; step++) {
      const part = step / steps;
      const at = (from: number, to: number) => from + (to - from) * part;
      const one: Sample = {
        x: at(x0, x1),
        y: at(y0, y1),
        z: at(z0, z1),
        dx,
        dy,
        t: start + at(t0, t1),
        along: along + flat * part,
      };
      // A bend gets a sample for either direction.
      if (step > 0 || last === null || last.dx !== dx || last.dy !== dy) samples.push(one);
      last = one;
    }
    along += flat;
  }
  return samples;
}

/** Return the number of earlier legs here, in either direction, up to the highest lane. */
function earlierLegs(driven: ReadonlyMap<string, ReadonlySet<number>>, sample: Sample): number {
  const found = new Set<number>();
  for (let i = -1; i <= 1; i++)
    for (let j = -1; j <= 1; j++)
      for (const way of driven.get(cell(sample, i, j)) ?? []) {
        found.add(way);
        if (found.size === MOST_LANES - 1) return found.size;
      }
  return found.size;
}

function cell({ x, y, z, dx, dy }: Sample, i: number, j: number): string {
  // Crossing paths differ in direction; there and back count as the same.
  const turn = Math.round((Math.atan2(dy, dx) / Math.PI) * 4);
  const direction = ((turn % 4) + 4) % 4;
  return `${Math.floor(x / SAME) + i} ${Math.floor(y / SAME) + j} ${Math.round(z / STOREY)} ${direction}`;
}

/** Keep the first ribbon in the middle, and shift the others alternately to its right and left. */
function shiftedAside(samples: readonly Sample[], lanes: readonly number[]): Sample[] {
  const asides = samples.map(({ dx, dy }, i) => {
    const lane = Math.max(...lanes.slice(Math.max(0, i - 2), i + 3));
    const side = (lane % 2 === 0 ? -1 : 1) * Math.ceil(lane / 2) * SPACING;
    // The side depends on the line, not on the direction of motion: there and back don't swap sides.
    const forth = dx > 1e-6 || (Math.abs(dx) <= 1e-6 && dy > 0) ? 1 : -1;
    return [side * forth * dy, -side * forth * dx] as const;
  });
  return samples.map((sample, i) => {
    const near = asides.slice(Math.max(0, i - SMOOTH), i + SMOOTH + 1);
    const mean = (axis: 0 | 1) => near.reduce((sum, one) => sum + one[axis], 0) / near.length;
    return { ...sample, x: sample.x + mean(0), y: sample.y + mean(1) };
  });
}

/** Triangles to draw: corners as x, y, z (m), and the time (s) at each corner. */
export interface Triangles {
  readonly corners: number[];
  readonly times: number[];
}

/** Return the ribbon of a path by floor, `width` m wide. */
export function ribbon(
  path: RibbonPath,
  width: number,
  above: number,
  floorAt: (z: number) => number,
  into: Map<number, Triangles> = new Map(),
): Map<number, Triangles> {
  const { samples, dashed } = path;
  for (let i = 1; i < samples.length; i++) {
    const [a, b] = [samples[i - 1] as Sample, samples[i] as Sample];
    if (dashed && Math.floor(b.along / (1.2 * EVERY)) % 2 === 1) continue;
    const half = width / 2;
    const side = ({ x, y, z, dx, dy }: Sample, to: number) => [x - dy * half * to, y + dx * half * to, z + above] as const;
    const quad = [side(a, 1), side(a, -1), side(b, 1), side(b, 1), side(a, -1), side(b, -1)];
    add(into, floorAt(Math.min(a.z, b.z)), quad, [a.t, a.t, b.t, b.t, a.t, b.t]);
  }
  return into;
}

/** Return arrowheads along a path. */
export function arrows(
  path: RibbonPath,
  size: number,
  every: number,
  above: number,
  floorAt: (z: number) => number,
  into: Map<number, Triangles> = new Map(),
): Map<number, Triangles> {
  let next = every / 2;
  for (const { x, y, z, dx, dy, t, along } of path.samples) {
    if (along < next) continue;
    next = along + every;
    const corner = (ahead: number, aside: number) =>
      [x + dx * ahead * size - dy * aside * size, y + dy * ahead * size + dx * aside * size, z + above] as const;
    add(into, floorAt(z), [corner(-0.5, 0.55), corner(-0.5, -0.55), corner(0.7, 0)], [t, t, t]);
  }
  return into;
}

function add(
  into: Map<number, Triangles>,
  floor: number,
  corners: readonly (readonly number[])[],
  times: readonly number[],
): void {
  const there = into.get(floor) ?? { corners: [], times: [] };
  into.set(floor, there);
  for (const one of corners) there.corners.push(...one);
  there.times.push(...times);
}
