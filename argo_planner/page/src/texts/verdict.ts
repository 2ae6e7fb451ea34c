/** Texts of the verdict on a run, made from its data. `argo_env/run/verdict.py` and `verdict_line.py` have those of
 * the command, the report and the film; examples in the tests compare the English ones. */

import type { Headline, Noticed, VerdictPart } from "../api/types";
import { both } from "./both";
import { words } from "./words";

type Code = VerdictPart["code"];
type PartTexts = { readonly [code in Code]: string | ((part: VerdictPart) => string) };

/** What differs between the languages. */
interface Grammar {
  readonly locale: string;
  readonly words: typeof words.en;
  readonly endings: { readonly [ending in Headline["ending"]]: string };
  /** the name of a kind of noticed things, in the singular and the plural */
  readonly kinds: { readonly [kind in Noticed["kind"]]: readonly [string, string] };
  readonly parts: PartTexts;
  readonly abnormal: (checkpoint: string, value: string) => string;
  readonly at: (what: string, time: string) => string;
  readonly over: (time: string) => string;
  readonly unanswered: string;
  readonly notBegun: string;
  readonly answered: (response: string) => string;
  readonly late: (task: string) => string;
  readonly touched: (link: string, element: string) => string;
  readonly trouble: { readonly [trouble in NonNullable<Noticed["trouble"]>]: string };
  readonly times: (text: string, count: number) => string;
  readonly more: (count: number) => string;
}

const NAMED = 3;

const joined = (part: VerdictPart) => part.names.join(", ");
const first = (part: VerdictPart) => part.times[0] ?? 0;
const area = (part: VerdictPart, index = 0) => String(part.numbers[index] ?? "");

/** Format a time (s) as `04:59`, or `74:51` (no hours). */
function clock(s: number): string {
  const whole = Math.round(s);
  return `${String(Math.floor(whole / 60)).padStart(2, "0")}:${String(whole % 60).padStart(2, "0")}`;
}

/** Format a time (s) as `34 s`, `4:59 min` or `1:14:51 h`. */
const rounded = (s: number) => words.en.seconds(Math.round(s));

/** Format two times (s), which get decimals if their texts would be equal otherwise. */
function distinct(times: readonly number[], locale: string): [string, string] {
  const [one = 0, other = 0] = times;
  if (rounded(one) !== rounded(other) || one === other) return [rounded(one), rounded(other)];
  for (let digits = 0; ; digits++) {
    const style = { minimumFractionDigits: digits, maximumFractionDigits: digits, useGrouping: false };
    const [a, b] = [one.toLocaleString(locale, style), other.toLocaleString(locale, style)];
    if (a !== b || digits === 5) return [`${a} s`, `${b} s`];
  }
}

const endedEn = (part: VerdictPart) =>
  part.event ? `the reaction to ${words.en.event[part.event]} ended the mission` : "the mission was aborted";
const stoodEn = (why: string) => (part: VerdictPart) =>
  `the robot has stood still since ${clock(first(part))}, ${why}, and nothing more occurs`;

const PARTS_EN: PartTexts = {
  as_planned: "everything was done as planned",
  completed: "the mission was completed",
  nothing_given_up: "all that the mission requires was done",
  returned: (part) => `${endedEn(part)}, and the robot returned to its dock`,
  sheltered: (part) => `${endedEn(part)}, and the robot went to a safe area`,
  not_reached: (part) => `${endedEn(part)}, and the robot did not reach the place where it should wait`,
  aborted: endedEn,
  cancelled: "the mission was cancelled by a person",
  not_ended: (part) => `the mission has not ended after ${rounded(first(part))}`,
  run_too_long: (part) => `it was stopped after ${rounded(first(part))}, Argo's limit for a run`,
  battery_empty: (part) => `the battery was empty after ${rounded(first(part))}`,
  waits_in_vain: stoodEn("waiting for an event"),
  stays_paused: stoodEn("paused"),
  never_begun: (part) =>
    `${stoodEn("paused")(part)}: a supervisory mission begins when a person resumes it (the event \`resume\`)`,
  held_by_stop: stoodEn("held by its emergency stop"),
  stopped_by_person: "it was stopped by a person",
  stopped: (part) => `it was stopped after ${rounded(first(part))}`,
  other: (part) => part.text,
  failed: (part) => `failed: ${joined(part)}`,
  window_missed: (part) => `missed the time window: ${joined(part)}`,
  not_done: (part) => `not done: ${joined(part)}`,
  not_done_again: (part) => `not done again: ${joined(part)}`,
  read: ({ numbers: [read = 0, total = 0], names }) => {
    if (read === total) return total === 1 ? "the checkpoint was read" : `all ${total} checkpoints were read`;
    const missing = names.map((name) => `#${name}`).join(", ");
    return `${read} of ${total} checkpoint${total > 1 ? "s" : ""} read, not ${missing}`;
  },
  too_late: (part) => {
    const [took, most] = distinct(part.times, "en");
    return `it took ${took} of at most ${most}`;
  },
  docked: (part) => `the robot is docked in starting area ${area(part)}`,
  not_docked: (part) => `the robot is not docked in starting area ${area(part)}`,
  docked_elsewhere: (part) => `the robot is docked in starting area ${area(part)}, not in ${area(part, 1)}`,
  done_before: (part) => `done before this run: ${joined(part)}`,
  by_hand_before: (part) => `done by hand or skipped before this run: ${joined(part)}`,
  passed_over: (part) => `passed over: ${joined(part)}`,
  reached_all_the_same: (part) => `reached all the same: ${joined(part)}`,
  by_hand: (part) => `done by hand: ${joined(part)}`,
  skipped: (part) => `skipped by a person: ${joined(part)}`,
  optional_failed: (part) => `optional tasks that failed: ${joined(part)}`,
  optional_not_done: (part) => `optional tasks not done: ${joined(part)}`,
};

const endedDe = (part: VerdictPart) =>
  part.event
    ? `die Reaktion auf „${words.de.event[part.event]}“ beendete die Mission`
    : "die Mission wurde vorzeitig beendet";
const stoodDe = (why: string) => (part: VerdictPart) => `der Roboter steht seit ${clock(first(part))}${why}`;
const NOTHING_MORE = ", und es geschieht nichts mehr";

const PARTS_DE: PartTexts = {
  as_planned: "alles wurde wie geplant erledigt",
  completed: "die Mission wurde abgeschlossen",
  nothing_given_up: "alles, was die Mission verlangt, wurde erledigt",
  returned: (part) => `${endedDe(part)}, und der Roboter kehrte zu seiner Ladestation zurück`,
  sheltered: (part) => `${endedDe(part)}, und der Roboter fuhr in einen sicheren Bereich`,
  not_reached: (part) => `${endedDe(part)}, und der Roboter erreichte den Ort nicht, an dem er warten sollte`,
  aborted: endedDe,
  cancelled: "die Mission wurde von einer Person beendet",
  not_ended: (part) => `die Mission war nach ${rounded(first(part))} noch nicht beendet`,
  run_too_long: (part) => `die Fahrt wurde nach ${rounded(first(part))} beendet: Länger darf keine Fahrt dauern`,
  battery_empty: (part) => `die Batterie war nach ${rounded(first(part))} leer`,
  waits_in_vain: stoodDe(" und wartet auf ein Ereignis, aber es geschieht nichts mehr"),
  stays_paused: stoodDe(`, die Mission ist angehalten${NOTHING_MORE}`),
  never_begun: (part) =>
    `${stoodDe(`, die Mission ist angehalten${NOTHING_MORE}`)(part)}: Eine überwachte Mission beginnt, wenn eine Person sie fortsetzt`,
  held_by_stop: stoodDe(`, durch seinen Not-Halt${NOTHING_MORE}`),
  stopped_by_person: "die Fahrt wurde von einer Person beendet",
  stopped: (part) => `die Fahrt wurde nach ${rounded(first(part))} beendet`,
  other: (part) => part.text,
  failed: (part) => `fehlgeschlagen: ${joined(part)}`,
  window_missed: (part) => `Zeitfenster verpasst: ${joined(part)}`,
  not_done: (part) => `nicht erledigt: ${joined(part)}`,
  not_done_again: (part) => `nicht noch einmal erledigt: ${joined(part)}`,
  read: ({ numbers: [read = 0, total = 0], names }) => {
    if (read === total) return total === 1 ? "der Prüfpunkt wurde gemessen" : `alle ${total} Prüfpunkte wurden gemessen`;
    const missing = names.map((name) => `#${name}`).join(", ");
    return `${read} von ${total} ${total > 1 ? "Prüfpunkten" : "Prüfpunkt"} gemessen, nicht ${missing}`;
  },
  too_late: (part) => {
    const [took, most] = distinct(part.times, "de");
    return `die Fahrt dauerte ${took}, erlaubt sind höchstens ${most}`;
  },
  docked: (part) => `der Roboter steht an der Ladestation von Bereich ${area(part)}`,
  not_docked: (part) => `der Roboter steht nicht an der Ladestation von Bereich ${area(part)}`,
  docked_elsewhere: (part) =>
    `der Roboter steht an der Ladestation von Bereich ${area(part)}, nicht an der von Bereich ${area(part, 1)}`,
  done_before: (part) => `vor dieser Fahrt erledigt: ${joined(part)}`,
  by_hand_before: (part) => `vor dieser Fahrt von Hand erledigt oder übersprungen: ${joined(part)}`,
  passed_over: (part) => `durch eine Bedingung ausgelassen: ${joined(part)}`,
  reached_all_the_same: (part) => `trotzdem erreicht: ${joined(part)}`,
  by_hand: (part) => `von Hand erledigt: ${joined(part)}`,
  skipped: (part) => `von einer Person übersprungen: ${joined(part)}`,
  optional_failed: (part) => `fehlgeschlagene optionale Aufgaben: ${joined(part)}`,
  optional_not_done: (part) => `nicht erledigte optionale Aufgaben: ${joined(part)}`,
};

const EN: Grammar = {
  locale: "en",
  words: words.en,
  endings: {
    success: "Success",
    done: "Done",
    completed_with_failures: "Completed with failures",
    interrupted: "Interrupted",
    no_success: "No success",
  },
  kinds: {
    finding: ["finding", "findings"],
    "late task": ["late task", "late tasks"],
    contact: ["contact", "contacts"],
    mishap: ["mishap", "mishaps"],
  },
  parts: PARTS_EN,
  abnormal: (checkpoint, value) => `${checkpoint} abnormal: ${value}`,
  at: (what, time) => `${what} at ${time}`,
  over: (time) => `, over at ${time}`,
  unanswered: "no reaction answers it",
  notBegun: "the reaction to it did not begin",
  answered: (response) => `answered by reaction: ${response}`,
  late: (task) => `${task} ended after its time window`,
  touched: (link, element) => `${link} touched ${element}`,
  trouble: { slipping: "slipping", stuck: "stuck", "tipped over": "tipped over" },
  times: (text, count) => `${text}, ${count} times`,
  more: (count) => `and ${count} more`,
};

const DE: Grammar = {
  locale: "de",
  words: words.de,
  endings: {
    success: "Erfolg",
    done: "Fertig",
    completed_with_failures: "Mit Fehlschlägen abgeschlossen",
    interrupted: "Unterbrochen",
    no_success: "Kein Erfolg",
  },
  kinds: {
    finding: ["Befund", "Befunde"],
    "late task": ["verspätete Aufgabe", "verspätete Aufgaben"],
    contact: ["Berührung", "Berührungen"],
    mishap: ["Zwischenfall", "Zwischenfälle"],
  },
  parts: PARTS_DE,
  abnormal: (checkpoint, value) => `${checkpoint} auffällig: ${value}`,
  at: (what, time) => `${what} um ${time}`,
  over: (time) => `, vorbei um ${time}`,
  unanswered: "keine Reaktion darauf",
  notBegun: "die Reaktion darauf begann nicht",
  answered: (response) => `Reaktion: ${response}`,
  late: (task) => `${task} endete nach dem Zeitfenster`,
  touched: (link, element) => `${link} berührte ${element}`,
  trouble: { slipping: "Ketten rutschen", stuck: "festgefahren", "tipped over": "umgekippt" },
  times: (text, count) => `${text}, ${count}-mal`,
  more: (count) => `und ${count} weitere`,
};

/** Return the functions that make texts in a language. */
function textsOf(language: Grammar) {
  const part = (one: VerdictPart): string => {
    const text = language.parts[one.code];
    return typeof text === "string" ? text : text(one);
  };
  const verdict = (parts: readonly VerdictPart[]) => parts.map(part).join("; ");

  const finding = (one: Noticed): string => {
    const { response, answered } = one;
    let answer = language.unanswered;
    if (response) answer = answered ? language.answered(language.words.response[response]) : language.notBegun;
    if (typeof one.checkpoint === "string") {
      const value = Number((one.value ?? NaN).toPrecision(4)).toLocaleString(language.locale, {
        maximumSignificantDigits: 4,
        useGrouping: false,
      });
      const what = language.abnormal(one.checkpoint, `${value} ${one.unit ?? ""}`);
      return answered ? `${what} (${answer})` : what;
    }
    const name = one.event ? language.words.event[one.event] : one.text;
    const end = typeof one.over_at === "number" ? language.over(clock(one.over_at)) : "";
    return `${language.at(name, clock(one.t ?? 0))} (${answer})${end}`;
  };
  const noticed = (one: Noticed): string => {
    switch (one.kind) {
      case "finding":
        return finding(one);
      case "late task":
        return language.late(one.task ?? "");
      case "contact":
        return language.at(language.touched(one.link ?? "", one.element ?? ""), clock(one.t ?? 0));
      case "mishap":
        return language.at(one.trouble ? language.trouble[one.trouble] : "", clock(one.t ?? 0));
    }
  };
  const summary = (all: readonly Noticed[]): string => {
    const counts = countsOf(all.map(noticed));
    const named = counts.slice(0, NAMED).map(([text, count]) => (count === 1 ? text : language.times(text, count)));
    const more = counts.slice(NAMED).reduce((sum, [, count]) => sum + count, 0);
    return [...named, ...(more > 0 ? [language.more(more)] : [])].join("; ");
  };
  const headline = (one: Headline): string => {
    // Old records have no data, only English text.
    if (one.verdict.length === 0) return `${one.word}: ${one.text}`;
    const counts = countsOf(one.noticed.map(({ kind }) => kind))
      .map(([kind, count]) => `${count} ${language.kinds[kind][count === 1 ? 0 : 1]}`)
      .join(", ");
    const word = language.endings[one.ending];
    const text = verdict(one.verdict);
    if (counts === "") return `${word}: ${text}`;
    if (one.ending !== "done") return `${word}: ${text}. ${counts}: ${summary(one.noticed)}`;
    const plain = one.verdict.length === 1 && one.verdict[0]?.code === "as_planned";
    const rest = plain ? "" : `. ${text.charAt(0).toUpperCase()}${text.slice(1)}`;
    return `${word}, ${counts}: ${summary(one.noticed)}${rest}`;
  };
  const ending = (one: Headline["ending"]) => language.endings[one];
  return { verdict, noticed, headline, ending };
}

/** Count equal items, in the order of their first occurrence. */
function countsOf<Item>(items: readonly Item[]): [Item, number][] {
  const counts = new Map<Item, number>();
  for (const item of items) counts.set(item, (counts.get(item) ?? 0) + 1);
  return [...counts];
}

export const verdict = both(textsOf(EN), textsOf(DE));
