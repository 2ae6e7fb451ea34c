import { afterEach, beforeEach, expect, test, vi } from "vitest";

import { type Answer, type Asked, fakeService, problem } from "./fake-service";

import type { DraftedLine, DraftState } from "../../src/api/types";
import { actsSaved, closeDraft, decide, followOthers, openDraft, openedDraft, returnedTexts, shownLines } from "../../src/draft/state";
import { notices } from "../../src/state/notices";

const OPEN: DraftedLine = {
  label: "1",
  line: 1,
  last_line: 1,
  column: 1,
  place: "",
  text: "Photograph the pump",
  state: "open",
  sentences: [],
  steps: [],
  unused: [],
  reason: "",
  hint: "",
  choices: [[]],
  names_nothing: true,
  act: null,
};
const ASIDE: DraftedLine = { ...OPEN, state: "set aside", act: "set aside", choices: [], names_nothing: false };

/** A service with one draft; somebody else may change it between two requests. */
let stored: DraftState | null;

function draftOf(revision: number, ...lines: DraftedLine[]): DraftState {
  return { id: "d1", name: "Round", revision, lines, diagnostics: [], areas_to_choose: [] } as unknown as DraftState;
}

function answer(asked: Asked): Answer {
  if (asked.path === "/api/drafts") return [200, { drafts: stored === null ? [] : [stored] }];
  if (stored === null) return problem(404, "not-found");
  if (asked.method === "GET") return [200, stored];
  if (asked.ifMatch !== `"${stored.revision}"`) return problem(412, "stale-revision");
  const { acts } = asked.body as { acts: { kind: string; label?: string; labels?: string[]; sentences?: string[] }[] };
  const lines = stored.lines.map((line): DraftedLine => {
    const act = acts.findLast((one) => one.label === line.label || one.labels?.includes(line.label));
    if (act === undefined) return line;
    if (act.kind === "set_aside") return { ...ASIDE, label: line.label };
    return { ...line, state: "understood", act: "said", sentences: act.sentences ?? [] };
  });
  stored = draftOf(stored.revision + 1, ...lines);
  return [200, stored];
}

const texts = () => notices.value.map((one) => [one.text, ...one.details].join(" "));
const two = () => draftOf(1, OPEN, { ...OPEN, label: "2" });

beforeEach(async () => {
  vi.useFakeTimers();
  notices.value = [];
  localStorage.clear();
  location.hash = "#/drafts/d1";
  stored = two();
  fakeService(answer);
  await openDraft("d1", () => true);
});
afterEach(() => {
  closeDraft();
  vi.useRealTimers();
});

test("a decision on a line that somebody else has decided on is not sent, and is told", async () => {
  stored = draftOf(2, ASIDE, { ...OPEN, label: "2" });
  decide([{ kind: "say", label: "1", sentences: ["Check R7."] }]);
  decide([{ kind: "set_aside", label: "2", sentences: [] }]);
  await vi.advanceTimersByTimeAsync(100);
  expect(actsSaved.value).toBe(true);
  expect(shownLines.value.map((line) => line.act)).toEqual(["set aside", "set aside"]);
  expect(stored.revision).toBe(3);
  expect(stored.lines[0]?.sentences).toEqual([]);
  expect(texts().join()).toContain("“Check R7.”");
  expect([...returnedTexts.value]).toEqual([["1", "Check R7."]]);
  expect(notices.value).toHaveLength(1);
});

test("a text that the service refuses is returned", async () => {
  fakeService((asked) => (asked.method === "POST" ? problem(422, "invalid") : answer(asked)));
  decide([{ kind: "say", label: "2", sentences: ["Check R7."] }]);
  await vi.advanceTimersByTimeAsync(100);
  expect(actsSaved.value).toBe(true);
  expect([...returnedTexts.value]).toEqual([["2", "Check R7."]]);
});

test("a decision whose answer was lost is not taken for that of somebody else", async () => {
  let lost = true;
  fakeService((asked) => {
    const found = answer(asked);
    const isLost = lost && asked.method === "POST";
    if (isLost) lost = false;
    return isLost ? null : found;
  });
  decide([{ kind: "set_aside", label: "1", sentences: [] }]);
  await vi.advanceTimersByTimeAsync(2_000);
  expect(actsSaved.value).toBe(true);
  expect(shownLines.value[0]?.act).toBe("set aside");
  expect(texts().join()).not.toContain("omebody");
});

test("the changes of others are shown while one does nothing", async () => {
  const end = followOthers();
  stored = draftOf(2, ASIDE, { ...OPEN, label: "2" });
  await vi.advanceTimersByTimeAsync(4_000);
  expect(shownLines.value[0]?.act).toBe("set aside");
  expect(texts()).toEqual(["Somebody else has decided on line 1."]);
  end();
  stored = draftOf(3, ASIDE, { ...ASIDE, label: "2" });
  await vi.advanceTimersByTimeAsync(10_000);
  expect(shownLines.value[1]?.act).toBeNull();
});

test("a draft that is gone is left with a message", async () => {
  const end = followOthers();
  stored = null;
  await vi.advanceTimersByTimeAsync(10_000);
  expect(openedDraft.value).toBeNull();
  expect(location.hash).toBe("");
  expect(texts().join()).toContain("made this draft a mission, or deleted it");
  end();
});

test("a decision on a draft that is gone is told as well", async () => {
  stored = null;
  decide([{ kind: "set_aside", label: "1", sentences: [] }]);
  await vi.advanceTimersByTimeAsync(100);
  expect(openedDraft.value).toBeNull();
  expect(texts().join()).toContain("made this draft a mission, or deleted it");
});

test("decisions that were not sent before a reload give way to those of others", async () => {
  fakeService(() => null);
  decide([{ kind: "say", label: "1", sentences: ["Check R7."] }]);
  decide([{ kind: "set_aside", label: "2", sentences: [] }]);
  const unsent = localStorage.getItem("argo.acts.d1") ?? "";
  expect(unsent).toContain("Check R7.");
  closeDraft();
  await vi.advanceTimersByTimeAsync(5_000);
  localStorage.setItem("argo.acts.d1", unsent);
  stored = draftOf(2, ASIDE, { ...OPEN, label: "2" });
  fakeService(answer);
  await openDraft("d1", () => true);
  await vi.advanceTimersByTimeAsync(100);
  expect(shownLines.value.map((line) => line.act)).toEqual(["set aside", "set aside"]);
  expect(texts().join()).toContain("“Check R7.”");
});
