import { expect, test } from "vitest";

import { shownText } from "../../src/model/shown-text";

test.each([
  ["Check checkpoint #4", "Check checkpoint #4"],
  ['Go to step "a\\u002ab"', 'Go to step "a*b"'],
  ['Go to step "\\ud83d\\ude80 1"', 'Go to step "🚀 1"'],
  ['"say \\"hi\\"":\nCheck checkpoint #4', '"say "hi"":\nCheck checkpoint #4'],
  ['"one "\n"two": repeat "x"', '"one two": repeat "x"'],
  ['an open "quote', 'an open "quote'],
  ['"bad \\q"', '"bad \\q"'],
])("%s", (sentence, text) => {
  expect(shownText(sentence)).toBe(text);
});
