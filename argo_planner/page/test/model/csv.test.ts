import { expect, test } from "vitest";

import { csv } from "../../src/model/csv";

test("lines end with CR and LF, and empty cells are empty", () => {
  expect(csv([["a", "b (s)"], [1.5, null]])).toBe("a,b (s)\r\n1.5,\r\n");
});

test("commas, quotes and line ends are quoted", () => {
  expect(csv([["a,b", 'say "x"', "two\nlines"]])).toBe('"a,b","say ""x""","two\nlines"\r\n');
});

test("a text that looks like a formula stays a text, a negative number stays a number", () => {
  expect(csv([["=1+1", "+x", "-x", "@x", "\tx", -2]])).toBe("'=1+1,'+x,'-x,'@x,'\tx,-2\r\n");
  expect(csv([['=HYPERLINK("x")']])).toBe(`"'=HYPERLINK(""x"")"\r\n`);
});
