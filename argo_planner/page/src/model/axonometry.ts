/** A picture of a site from above and from the side: its floors, drawn apart from each other. */

export type Point = readonly [x: number, y: number];

/** View from the south-east: rad by which the site is turned, how flat the ground is seen, and how far floors are
 * drawn apart, relative to their heights. */
const TURN = -0.52;
const FLAT = 0.52;
const APART = 1.35;

/** Return where a point of the site (m) is in the picture; y points down. */
export function projected(x: number, y: number, z: number): Point {
  const across = x * Math.cos(TURN) - y * Math.sin(TURN);
  const back = x * Math.sin(TURN) + y * Math.cos(TURN);
  return [across, -back * FLAT - z * APART];
}

/** Return how near a point is to the viewer: what is nearer is drawn later. */
export function nearness(x: number, y: number): number {
  return -(x * Math.sin(TURN) + y * Math.cos(TURN));
}

/** Return the outline of a body with the given outline of its base, from height `low` to `high` (m). */
export function silhouette(base: readonly Point[], low: number, high: number): Point[] {
  return hull(base.flatMap(([x, y]) => [projected(x, y, low), projected(x, y, high)]));
}

/** Return the corners of the convex hull of points (Andrew's monotone chain). */
export function hull(points: readonly Point[]): Point[] {
  const sorted = [...points].sort(([ax, ay], [bx, by]) => ax - bx || ay - by);
  return [...halfHull(sorted), ...halfHull(sorted.reverse())];
}

function halfHull(points: readonly Point[]): Point[] {
  const chain: Point[] = [];
  for (const point of points) {
    while (chain.length > 1 && turn(chain.at(-2) as Point, chain.at(-1) as Point, point) <= 1e-9) chain.pop();
    chain.push(point);
  }
  return chain.slice(0, -1);
}

function turn(a: Point, b: Point, c: Point): number {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/** Return the path data (SVG) of closed outlines. */
export function outlineData(outlines: readonly (readonly Point[])[]): string {
  return outlines
    .filter((one) => one.length > 2)
    .map((one) => `M${one.map(([x, y]) => `${short(x)} ${short(y)}`).join("L")}Z`)
    .join("");
}

/** Format a coordinate with at most two decimals. */
export function short(value: number): string {
  return String(Math.round(100 * value) / 100);
}
