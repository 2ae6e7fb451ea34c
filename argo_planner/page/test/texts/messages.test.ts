import { afterAll, beforeAll, describe, expect, test } from "vitest";

import type { Wording } from "../../src/api/types";
import { language } from "../../src/texts";
import { loadGerman, said, saidAll, saidIfAny } from "../../src/texts/messages";
import examples from "./message-examples.json";

const EXAMPLES = examples as unknown as readonly { text: string; wording: Wording | null; german: string }[];
const wording = (template: string, parameters: Wording["parameters"] = {}): Wording => ({ template, parameters });

describe("in German", () => {
  beforeAll(async () => {
    language.value = "de";
    await loadGerman();
  });
  afterAll(() => {
    language.value = "en";
  });

  test.each(EXAMPLES)("a message is worded as by the command: $text", ({ text, wording: known, german }) => {
    expect(said(text, known)).toBe(german);
  });

  test.each([
    ["{s:.1f} s", 45.72, "45,7 s"],
    ["{s:.0%}", 0.033, "3 %"],
    ["{s:,}", 12345, "12.345"],
    ["{s:+.1f}", 2, "+2,0"],
    ["{s:.3g}", 0.5, "0,5"],
    ["{s}", 0.25, "0,25"],
    ["{{s}} {s}", 1, "{s} 1"],
  ])("%s of %d is %s", (template, s, german) => {
    expect(said("", wording(template, { s }))).toBe(german);
  });

  test("names stay as they are", () => {
    expect(said("after task 'remove it'", wording("after task '{task}'", { task: "remove it" }))).toBe(
      "nach Aufgabe „remove it“",
    );
  });

  test("several messages, and none", () => {
    expect(saidAll(["remove it", "x"], [null, wording("remove it")])).toEqual(["entfernen Sie das", "entfernen Sie das"]);
    expect(saidIfAny(null)).toBe("");
  });
});

describe("in English", () => {
  test.each(EXAMPLES.filter(({ text }) => !/gas_leak/.test(text)))("$text", ({ text, wording: known }) => {
    expect(said(text, known)).toBe(text);
  });

  test("the page has words for identifiers", () => {
    const one = wording("there is more than one reaction to {event}", { event: wording("gas_leak") });
    expect(said("there is more than one reaction to gas_leak", one)).toBe("there is more than one reaction to gas leak");
    expect(said("give the reaction a `pose`")).toBe("give the reaction a target");
  });
});
