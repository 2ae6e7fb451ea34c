import { describe, expect, it } from "vitest";

import type { PlanSummary, RunSummary } from "../../src/api/types";
import { foldersOf, foundMissions, listedMissions } from "../../src/model/mission-search";

const NAMES = new Map([
  ["4", "valve R25"],
  ["40", "pressure gauge 7"],
]);

function mission(name: string, more: Partial<PlanSummary> = {}): PlanSummary {
  return { id: name, name, revision: 1, tasks: 2, checkpoints: [], folder: "", ...more };
}

function found(query: string, folder: string | null, ...missions: PlanSummary[]): string[] {
  return foundMissions(listedMissions(missions, [], NAMES), query, folder).map((one) => one.summary.name);
}

describe("the search for missions", () => {
  const night = mission("Night *round* ☀", { checkpoints: ["4"], folder: "Weekly" });
  const day = mission("Day ROUND", { checkpoints: ["40"] });

  it("finds all without a query", () => {
    expect(found("  ", null, night, day)).toEqual([night.name, day.name]);
  });

  it("finds each word anywhere, in any case", () => {
    expect(found("round", null, night, day)).toEqual([night.name, day.name]);
    expect(found("ROUND night", null, night, day)).toEqual([night.name]);
    expect(found("r25", null, night, day)).toEqual([night.name]);
    expect(found("weekly", null, night, day)).toEqual([night.name]);
  });

  it("takes signs as they are", () => {
    expect(found("*", null, night, day)).toEqual([night.name]);
    expect(found("☀", null, night, day)).toEqual([night.name]);
    expect(found(".", null, night, day)).toEqual([]);
  });

  it("finds a checkpoint by its whole number", () => {
    expect(found("#4", null, night, day)).toEqual([night.name]);
    expect(found("#40", null, night, day)).toEqual([day.name]);
  });

  it("shows one folder only", () => {
    expect(found("round", "Weekly", night, day)).toEqual([night.name]);
    expect(found("round", "", night, day)).toEqual([day.name]);
  });
});

describe("the list of missions", () => {
  it("has no folders if no mission is in one", () => {
    expect(foldersOf(listedMissions([mission("a")], [], NAMES), "en")).toEqual([]);
  });

  it("counts the missions of folders, sorted by name, those without a folder last", () => {
    const all = ["Week 10", "", "Week 9", "Week 10"].map((folder, at) => mission(String(at), { folder }));
    expect(foldersOf(listedMissions(all, [], NAMES), "en")).toEqual([
      { name: "Week 9", count: 1 },
      { name: "Week 10", count: 2 },
      { name: "", count: 1 },
    ]);
  });

  it("joins each mission with its last run", () => {
    const run = { id: "r", plan: "a" } as RunSummary;
    const [a, b] = listedMissions([mission("a"), mission("b")], [run], NAMES);
    expect([a?.lastRun, b?.lastRun]).toEqual([run, null]);
  });
});
