/** The list of missions: search, folders, and how many rows are shown. */

import type { PlanSummary, RunSummary } from "../api/types";

/** A mission with its last run and all that a search looks at, in lower case. */
export interface ListedMission {
  readonly summary: PlanSummary;
  readonly lastRun: RunSummary | null;
  readonly searched: string;
}

export interface Folder {
  /** Empty: missions in no folder. */
  readonly name: string;
  readonly count: number;
}

/** Join missions with their last runs. `checkpoints` has the name of each checkpoint by its id. */
export function listedMissions(
  missions: readonly PlanSummary[],
  lastRuns: readonly RunSummary[],
  checkpoints: ReadonlyMap<string, string>,
): ListedMission[] {
  const runs = new Map(lastRuns.map((run) => [run.plan, run]));
  return missions.map((summary) => {
    const measured = summary.checkpoints.map((id) => `#${id} ${checkpoints.get(id) ?? ""}`);
    const searched = [summary.name, summary.folder, ...measured].join("\n").toLocaleLowerCase();
    return { summary, lastRun: runs.get(summary.id) ?? null, searched };
  });
}

/** Return the missions that have each word of a query in their name, their folder or a checkpoint.
 * `folder`: only those in this folder; null: in any. */
export function foundMissions(all: readonly ListedMission[], query: string, folder: string | null): ListedMission[] {
  const words = query.toLocaleLowerCase().split(/\s+/).filter(Boolean);
  return all.filter(
    ({ summary, searched }) =>
      (folder === null || summary.folder === folder) && words.every((word) => hasWord(searched, word)),
  );
}

/** Return whether a text has a word; `#4` is checkpoint 4, and not 40. */
function hasWord(searched: string, word: string): boolean {
  if (!/^#\d+$/.test(word)) return searched.includes(word);
  return `${searched}\n`.replaceAll("\n", " ").includes(`${word} `);
}

/** Return all folders by name with the number of their missions, those in no folder last; none if there is no
 * folder. */
export function foldersOf(all: readonly ListedMission[], locale: string): Folder[] {
  const counts = new Map<string, number>();
  for (const { summary } of all) counts.set(summary.folder, (counts.get(summary.folder) ?? 0) + 1);
  const without = counts.get("") ?? 0;
  counts.delete("");
  if (counts.size === 0) return [];
  const byName = new Intl.Collator(locale, { numeric: true });
  const named = [...counts].map(([name, count]) => ({ name, count })).sort((a, b) => byName.compare(a.name, b.name));
  return without > 0 ? [...named, { name: "", count: without }] : named;
}
