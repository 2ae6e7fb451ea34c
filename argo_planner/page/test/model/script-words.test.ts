import { expect, it } from "vitest";

import { linesWithWords } from "../../src/model/script-words";

function entry(name: string, line: number, column: number, length: number) {
  return { part: "step" as const, name, sentences: [], meaning: [], assumed: [], source: { line, column, length } } as never;
}

it("splits lines at the words of tasks", () => {
  const lines = linesWithWords("Hi\r\nCheck R25 now.", [entry("A", 2, 1, 9)]);
  expect(lines).toEqual([
    [{ text: "Hi", name: null }],
    [
      { text: "Check R25", name: "A" },
      { text: " now.", name: null },
    ],
  ]);
});

it("takes the words of a decided sentence up to the next one", () => {
  const lines = linesWithWords("R25 please. R7 too.", [entry("B", 1, 13, 1), entry("A", 1, 1, 1)]);
  expect(lines).toEqual([
    [
      { text: "R25 please. ", name: "A" },
      { text: "R7 too.", name: "B" },
    ],
  ]);
});

it("counts columns in code points, and leaves what is beyond the text", () => {
  expect(linesWithWords("🔧🔧 R25", [entry("A", 1, 4, 3), entry("B", 9, 1, 3), entry("C", 1, 40, 2)])).toEqual([
    [
      { text: "🔧🔧 ", name: null },
      { text: "R25", name: "A" },
    ],
  ]);
});
