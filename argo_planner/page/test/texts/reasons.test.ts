import { afterEach, beforeEach, describe, expect, it } from "vitest";

import { language } from "../../src/texts";
import { spokenPlace } from "../../src/texts/place";
import { spoken } from "../../src/texts/reasons";

beforeEach(() => (language.value = "de"));
afterEach(() => (language.value = "en"));

describe("messages about lines in German", () => {
  it.each([
    ["a greeting", "eine Anrede"],
    ["Argo does not understand `or` here", "Argo versteht `or` hier nicht"],
    ["`Tag` is set aside: it is the headings of columns, again", "`Tag` ist beiseitegelegt: noch einmal die Überschriften der Spalten"],
    ["`it` can be read as R7 (#11) or R9 (#19)", "`it` kann R7 (#11) oder R9 (#19) bedeuten"],
    ["`Hi Lena,` is taken for a greeting and has no effect", "`Hi Lena,` gilt als eine Anrede und ist ohne Wirkung"],
    [
      "is `hole` or `hope` meant?; possible here: a number, how often, such as `three times`, `if` or `unless`; say, `check #4`",
      "ist `hole` oder `hope` gemeint?; möglich ist hier: eine Zahl, wie oft, etwa `three times`, `if` oder `unless`; sagen Sie zum Beispiel `check #4`",
    ],
    [
      "`it` can be pressure gauge 3 (#6) or pressure gauge 4 (#9)",
      "`it` kann pressure gauge 3 (#6) oder pressure gauge 4 (#9) sein",
    ],
    [
      "the normal range of pressure gauge 6 is 5 to 7.5 here, but 5 to 7 bar on the site",
      "der Normalbereich von pressure gauge 6 ist hier 5 bis 7.5, aber in der Anlage 5 bis 7 bar",
    ],
  ])("%s", (english, german) => {
    expect(spoken(english)).toEqual({ text: german, lang: "de" });
  });

  it.each([
    "a message that nobody has translated",
    "checkpoint #12 is not in the mission at this point",
    "a greeting; a message that nobody has translated",
    "`x` is taken for something new and has no effect",
  ])("stay English as a whole: %s", (message) => {
    expect(spoken(message)).toEqual({ text: message, lang: "en" });
  });

  it("are not translated in an English page", () => {
    language.value = "en";
    expect(spoken("a greeting")).toEqual({ text: "a greeting", lang: "en" });
  });
});

describe("places in German", () => {
  it.each([
    ["table 1, row 3", "Tabelle 1, Zeile 3"],
    ["page 2, headings", "Seite 2, Überschriften"],
    ["lines 3 to 5", "Zeilen 3 bis 5"],
    ["Round!A7:F7", "Round!A7:F7"],
    ["page!A7", "page!A7"],
  ])("%s", (english, german) => {
    expect(spokenPlace(english)).toBe(german);
  });
});
