import { expect, test } from "vitest";

import type { Headline, Noticed, VerdictPart } from "../../src/api/types";
import { verdict } from "../../src/texts/verdict";
import examples from "./verdict-examples.json";

const PARTS = examples.parts as unknown as readonly { readonly part: VerdictPart; readonly text: string }[];

const part = (code: VerdictPart["code"], fields: Partial<VerdictPart> = {}): VerdictPart => ({
  code,
  names: [],
  times: [],
  numbers: [],
  text: "",
  ...fields,
});
const headline = (fields: Partial<Headline>): Headline => ({
  word: "Success",
  text: "everything was done as planned",
  tone: "good",
  ending: "success",
  verdict: [part("as_planned")],
  noticed: [],
  ...fields,
});
const noticed = (kind: Noticed["kind"], fields: Partial<Noticed>): Noticed => ({ kind, text: "", answered: false, ...fields });

test.each(PARTS)("$part.code is worded as by the command, and in German: $text", ({ part: one, text }) => {
  expect(verdict.en.verdict([one])).toBe(text);
  const german = verdict.de.verdict([one]);
  if (one.code === "other") {
    expect(german).toBe(text);
    return;
  }
  expect(german).not.toMatch(/undefined|NaN|\b(the|mission was|done|read|not|task|before)\b/);
  for (const name of one.names) expect(german).toContain(name);
});

test("a mission that a reaction ended says in German what was done and what was not", () => {
  const parts = [
    part("returned", { event: "low_battery" }),
    part("read", { numbers: [1, 2], names: ["7"] }),
    part("not_done", { names: ["MEASURE 2"] }),
  ];
  expect(verdict.de.verdict(parts)).toBe(
    "die Reaktion auf „niedriger Ladestand“ beendete die Mission, und der Roboter kehrte zu seiner Ladestation zurück; " +
      "1 von 2 Prüfpunkten gemessen, nicht #7; nicht erledigt: MEASURE 2",
  );
});

test("times that would look the same have decimals, with the sign of the language", () => {
  const late = [part("too_late", { times: [300.04, 300] })];
  expect(verdict.en.verdict(late)).toBe("it took 300.04 s of at most 300.00 s");
  expect(verdict.de.verdict(late)).toBe("die Fahrt dauerte 300,04 s, erlaubt sind höchstens 300,00 s");
});

test("findings have their time, the answer to them and their end", () => {
  const leak = { event: "gas_leak", t: 12 } as const;
  const texts = (fields: Partial<Noticed>) => [verdict.en.noticed(noticed("finding", fields)), verdict.de.noticed(noticed("finding", fields))];
  expect(texts(leak)).toEqual(["gas leak at 00:12 (no reaction answers it)", "Gasleck um 00:12 (keine Reaktion darauf)"]);
  expect(texts({ ...leak, response: "abort" })).toEqual([
    "gas leak at 00:12 (the reaction to it did not begin)",
    "Gasleck um 00:12 (die Reaktion darauf begann nicht)",
  ]);
  expect(texts({ ...leak, response: "abort", answered: true, over_at: 61 })).toEqual([
    "gas leak at 00:12 (answered by reaction: end the mission), over at 01:01",
    "Gasleck um 00:12 (Reaktion: die Mission beenden), vorbei um 01:01",
  ]);
  const value = { checkpoint: "gauge 5 (#8)", value: 9.2, unit: "bar", event: "abnormal_reading", t: 3 } as const;
  expect(texts(value)).toEqual(["gauge 5 (#8) abnormal: 9.2 bar", "gauge 5 (#8) auffällig: 9,2 bar"]);
  expect(texts({ ...value, response: "pause", answered: true })[1]).toBe("gauge 5 (#8) auffällig: 9,2 bar (Reaktion: anhalten und warten)");
});

test("a headline counts what was noticed, and names the first three things", () => {
  const contact = noticed("contact", { link: "forearm", element: "railing 7", t: 12 });
  const stuck = noticed("mishap", { trouble: "stuck", t: 70 });
  const late = noticed("late task", { task: "A" });
  const one = headline({ ending: "done", noticed: [late, contact, contact, stuck, noticed("mishap", { trouble: "slipping", t: 71 })] });
  expect(verdict.en.headline(one)).toBe(
    "Done, 1 late task, 2 contacts, 2 mishaps: A ended after its time window; forearm touched railing 7 at 00:12, 2 times; stuck at 01:10; and 1 more",
  );
  expect(verdict.de.headline(one)).toBe(
    "Fertig, 1 verspätete Aufgabe, 2 Berührungen, 2 Zwischenfälle: A endete nach dem Zeitfenster; forearm berührte railing 7 um 00:12, 2-mal; festgefahren um 01:10; und 1 weitere",
  );
});

test("a headline has the verdict before or behind what was noticed", () => {
  const leak = [noticed("finding", { event: "gas_leak", t: 12 })];
  expect(verdict.de.headline(headline({}))).toBe("Erfolg: alles wurde wie geplant erledigt");
  expect(verdict.de.headline(headline({ ending: "done", verdict: [part("completed"), part("passed_over", { names: ["A"] })], noticed: leak }))).toBe(
    "Fertig, 1 Befund: Gasleck um 00:12 (keine Reaktion darauf). Die Mission wurde abgeschlossen; durch eine Bedingung ausgelassen: A",
  );
  expect(verdict.de.headline(headline({ ending: "no_success", verdict: [part("failed", { names: ["A"] })], noticed: leak }))).toBe(
    "Kein Erfolg: fehlgeschlagen: A. 1 Befund: Gasleck um 00:12 (keine Reaktion darauf)",
  );
});

test("a run without data, of an older version, keeps its English text", () => {
  const old = headline({ word: "No success", text: "failed: A", ending: "no_success", verdict: [] });
  expect([verdict.en.headline(old), verdict.de.headline(old)]).toEqual(["No success: failed: A", "No success: failed: A"]);
});
