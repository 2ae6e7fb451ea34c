import { describe, expect, it } from "vitest";

import type { Diagnostic, DraftedLine } from "../../src/api/types";
import {
  decidedByOthers,
  isDone,
  isRefused,
  type LineAct,
  messagesByLine,
  nextLeft,
  splitUnused,
  stillApplies,
  toRequest,
  withActs,
} from "../../src/model/draft-lines";

function line(label: string, state: DraftedLine["state"], more: Partial<DraftedLine> = {}): DraftedLine {
  return {
    label,
    line: Number(label),
    last_line: Number(label),
    column: 1,
    place: "",
    text: "I need R25, please",
    state,
    sentences: [],
    steps: [],
    unused: [],
    reason: "",
    hint: "",
    choices: [],
    names_nothing: false,
    act: null,
    ...more,
  };
}

const proposed = line("2", "proposed", { sentences: ["Check checkpoint 4."], unused: ["please"] });
const open = line("3", "open", { choices: [["Check checkpoint 14."], []], reason: "not understood" });
const confirm: LineAct = { kind: "confirm", label: "2", sentences: ["Check checkpoint 4."] };

describe("lines with acts that are being sent", () => {
  it("shows what the service will answer", () => {
    const [shown] = withActs([proposed], [confirm]);
    expect(shown).toMatchObject({ state: "understood", act: "confirmed", sentences: ["Check checkpoint 4."], sending: true });
    const chosen = withActs([open], [{ kind: "choose", label: "3", number: 1, sentences: ["Check checkpoint 14."] }]);
    expect(chosen[0]).toMatchObject({ state: "understood", act: "chosen", sentences: ["Check checkpoint 14."] });
    const aside = withActs([open], [{ kind: "choose", label: "3", number: 2, sentences: [] }]);
    expect(aside[0]).toMatchObject({ state: "set aside", act: "set aside" });
  });

  it("does not guess what other words become", () => {
    const [shown] = withActs([open], [{ kind: "say", label: "3", sentences: ["Check R7."] }]);
    expect(shown).toMatchObject({ state: "open", sentences: ["Check R7."], reading: true });
  });

  it("keeps lines without acts the same objects", () => {
    expect(withActs([proposed, open], [confirm])[1]).toBe(withActs([proposed, open], [])[1]);
  });
});

describe("acts that wait for an answer", () => {
  it("confirm a proposal, not a line", () => {
    expect(stillApplies(confirm, proposed)).toBe(true);
    expect(stillApplies(confirm, { ...proposed, sentences: ["Check checkpoint 5."] })).toBe(false);
    expect(stillApplies(confirm, { ...proposed, state: "open" })).toBe(false);
    expect(stillApplies(confirm, undefined)).toBe(false);
  });

  it("choose a meaning, not a number", () => {
    const act: LineAct = { kind: "choose", label: "3", number: 1, sentences: ["Check checkpoint 14."] };
    expect(stillApplies(act, open)).toBe(true);
    expect(stillApplies(act, { ...open, choices: [[], ["Check checkpoint 14."]] })).toBe(false);
  });

  it("of one kind are sent as one, in their order", () => {
    const acts: LineAct[] = [confirm, { ...confirm, label: "4" }, { kind: "undo", label: "2", sentences: [] }, confirm];
    expect(toRequest(acts)).toEqual([
      { kind: "confirm", labels: ["2", "4"] },
      { kind: "undo", labels: ["2"] },
      { kind: "confirm", labels: ["2"] },
    ]);
  });
});

describe("decisions of somebody else", () => {
  const aside = { ...open, state: "set aside", act: "set aside" } as const;
  const confirmed = { ...proposed, state: "understood", act: "confirmed" } as const;

  it("are those that no own act has made", () => {
    expect([...decidedByOthers([proposed, open], [confirmed, aside], [])]).toEqual(["2", "3"]);
    expect([...decidedByOthers([proposed, open], [confirmed, aside], [confirm])]).toEqual(["3"]);
    expect([...decidedByOthers([confirmed, open], [confirmed, open], [])]).toEqual([]);
    expect([...decidedByOthers([confirmed], [proposed], [])]).toEqual(["2"]);
  });

  it("are none of one's own whose answer was lost before the next act", () => {
    const undo: LineAct = { kind: "undo", label: "2", sentences: [] };
    expect([...decidedByOthers([proposed], [confirmed], [confirm, undo])]).toEqual([]);
    expect(isDone(undo, confirmed)).toBe(false);
  });

  it("differ from the same act", () => {
    const say: LineAct = { kind: "say", label: "3", sentences: ["  Check   R7. "] };
    expect(isDone(say, { ...open, act: "said", sentences: ["Check R7."] })).toBe(true);
    expect(isDone(say, { ...open, act: "said", sentences: ["Check R8."] })).toBe(false);
    expect(isDone({ kind: "set_aside", label: "3", sentences: [] }, aside)).toBe(true);
    expect(isDone({ kind: "choose", label: "3", number: 2, sentences: [] }, aside)).toBe(true);
    expect(isDone(confirm, confirmed)).toBe(true);
    expect(isDone(confirm, proposed)).toBe(false);
  });
});

describe("words that are not used", () => {
  it("are split from the others", () => {
    expect(splitUnused("I need R25, please", ["I need", "please"])).toEqual([
      { text: "I need", unused: true },
      { text: " R25, ", unused: false },
      { text: "please", unused: true },
    ]);
  });

  it("that are not in the text leave it whole", () => {
    expect(splitUnused("I need R25", ["zorg", ""])).toEqual([{ text: "I need R25", unused: false }]);
  });
});

describe("the next line that is left", () => {
  const lines = [line("1", "understood"), proposed, open, line("4", "set aside")];
  it("follows, and then begins again at the top", () => {
    expect(nextLeft(lines, 1)).toBe(2);
    expect(nextLeft(lines, 2)).toBe(1);
    expect(nextLeft(lines, 1, -1)).toBe(2);
    expect(nextLeft([line("1", "understood")], 0)).toBe(-1);
  });
  it("is one that is being read only if there is no other", () => {
    const read = withActs(lines, [{ kind: "say", label: "2", sentences: ["Check R7."] }]);
    expect(nextLeft(read, 0)).toBe(2);
    expect(nextLeft([...read.slice(0, 2)], 0)).toBe(1);
  });
});

describe("messages", () => {
  const first = line("3", "understood", { label: "3.1" });
  const second = line("3", "understood", { label: "3.2", column: 20, last_line: 4 });
  const third = line("4", "open", { label: "4.1", column: 9 });
  const at = (number: number, column: number) => ({ code: "c", span: { line: number, column } }) as unknown as Diagnostic;

  it("belong to the part of the line in which they begin", () => {
    const found = messagesByLine([first, second, third], [at(3, 1), at(3, 19), at(3, 20), at(4, 8), at(4, 9), at(5, 1)]);
    expect([...found].map(([label, messages]) => [label, messages.length])).toEqual([
      ["3.1", 2],
      ["3.2", 2],
      ["4.1", 1],
    ]);
  });

  it("before the first part are about that", () => {
    expect([...messagesByLine([{ ...first, column: 4 }, second], [at(3, 1)]).keys()]).toEqual(["3.1"]);
  });
});

describe("other words that are not understood", () => {
  it("are those of an open line once they have been read", () => {
    const [shown] = withActs([{ ...open, act: "said", sentences: ["Chek"] }], []);
    expect(shown && isRefused(shown)).toBe(true);
    const [sending] = withActs([open], [{ kind: "say", label: "3", sentences: ["Chek"] }]);
    expect(sending && isRefused(sending)).toBe(false);
  });
});
