/** Placement of labels beside their points, so that none covers another one. */

export interface LabelRequest {
  readonly key: string;
  /** px, the labelled point */
  readonly x: number;
  readonly y: number;
  /** px */
  readonly width: number;
  readonly height: number;
  /** labels with a higher weight are placed first */
  readonly weight: number;
}

export type Side = "right" | "left" | "above" | "below";

/** px, from the top left corner */
export interface LabelBox {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
}

export interface PlacedLabel extends LabelBox {
  readonly key: string;
  readonly side: Side;
}

const SIDES: readonly Side[] = ["right", "left", "above", "below"];
/** px from the point, and between labels */
const AWAY = 9;
const ABOVE = 13;
const BETWEEN = 2;
/** px, edge of a cell of the grid in which neighbours are searched */
const CELL = 120;

/** Place labels in a view of the given size (px). A label keeps its side of `before` if possible, so that it
 * doesn't jump while the camera moves. No label covers a box of `taken`. */
export function declutter(
  wishes: readonly LabelRequest[],
  width: number,
  height: number,
  before: ReadonlyMap<string, Side> = new Map(),
  most = Infinity,
  taken: readonly LabelBox[] = [],
): PlacedLabel[] {
  const grid = new Map<string, LabelBox[]>();
  for (const box of taken) occupy(grid, box);
  const placed: PlacedLabel[] = [];
  const had = (wish: LabelRequest) => (before.has(wish.key) ? 0.5 : 0);
  const order = [...wishes].sort(
    (a, b) => b.weight + had(b) - a.weight - had(a) || (a.key < b.key ? -1 : 1),
  );
  for (const wish of order) {
    if (placed.length >= most) break;
    const first = before.get(wish.key);
    const sides = first === undefined ? SIDES : [first, ...SIDES.filter((side) => side !== first)];
    const options = sides.map((side) => boxAt(wish, side));
    const box = options.find((one) => isInside(one, width, height) && !isTaken(grid, one));
    if (box === undefined) continue;
    placed.push(box);
    occupy(grid, box);
  }
  return placed;
}

function occupy(grid: Map<string, LabelBox[]>, box: LabelBox): void {
  for (const cell of cellsOf(box)) {
    const there = grid.get(cell);
    if (there) there.push(box);
    else grid.set(cell, [box]);
  }
}

function boxAt({ key, x, y, width, height }: LabelRequest, side: Side): PlacedLabel {
  const left = side === "right" ? x + AWAY : side === "left" ? x - AWAY - width : x - width / 2;
  const top = side === "above" ? y - ABOVE - height : side === "below" ? y + ABOVE : y - height / 2;
  return { key, side, left: Math.round(left), top: Math.round(top), width, height };
}

function isInside(box: PlacedLabel, width: number, height: number): boolean {
  return box.left >= 0 && box.top >= 0 && box.left + box.width <= width && box.top + box.height <= height;
}

function isTaken(grid: ReadonlyMap<string, readonly LabelBox[]>, box: LabelBox): boolean {
  for (const cell of cellsOf(box))
    for (const other of grid.get(cell) ?? []) if (overlap(box, other)) return true;
  return false;
}

export function overlap(a: LabelBox, b: LabelBox): boolean {
  return (
    a.left < b.left + b.width + BETWEEN &&
    b.left < a.left + a.width + BETWEEN &&
    a.top < b.top + b.height + BETWEEN &&
    b.top < a.top + a.height + BETWEEN
  );
}

function* cellsOf(box: LabelBox): Generator<string> {
  const last = (from: number, size: number) => Math.floor((from + size + BETWEEN) / CELL);
  for (let i = Math.floor((box.left - BETWEEN) / CELL); i <= last(box.left, box.width); i++)
    for (let j = Math.floor((box.top - BETWEEN) / CELL); j <= last(box.top, box.height); j++)
      yield `${i} ${j}`;
}
