/** Comparison of two orders of the same tasks. */

export interface ComparedTask {
  readonly name: string;
  /** Whether the task has changed its position relative to the tasks that stay. */
  readonly moved: boolean;
}

export interface TwoOrders {
  readonly before: readonly ComparedTask[];
  readonly after: readonly ComparedTask[];
}

/** Mark the tasks that have moved, as few as possible. Tasks that are left out appear in the first order
 * only, and are marked there. */
export function compareOrders(before: readonly string[], after: readonly string[]): TwoOrders {
  const at = new Map(after.map((name, place) => [name, place]));
  const places = before.flatMap((name) => at.get(name) ?? []);
  const stay = new Set(longestIncreasing(places).map((place) => after[place]));
  const placed = (name: string): ComparedTask => ({ name, moved: !stay.has(name) });
  return { before: before.map(placed), after: after.map(placed) };
}

/** Return a longest increasing subsequence. */
export function longestIncreasing(numbers: readonly number[]): number[] {
  const ends: number[] = []; // for each length, the index of the smallest last number
  const behind = new Array<number>(numbers.length).fill(-1);
  numbers.forEach((number, place) => {
    let low = 0;
    let high = ends.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if ((numbers[ends[middle] as number] as number) < number) low = middle + 1;
      else high = middle;
    }
    behind[place] = low > 0 ? (ends[low - 1] as number) : -1;
    ends[low] = place;
  });
  const found: number[] = [];
  for (let place = ends.at(-1) ?? -1; place >= 0; place = behind[place] as number)
    found.push(numbers[place] as number);
  return found.reverse();
}
