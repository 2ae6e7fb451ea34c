/** Lines of a draft with acts that the service has not answered yet. */

import type { Diagnostic, DraftAct, DraftedLine } from "../api/types";

/** An act of a person on one line; `sentences` are what the person saw or wrote. */
export interface LineAct {
  readonly kind: "confirm" | "set_aside" | "say" | "choose" | "undo";
  readonly label: string;
  readonly sentences: readonly string[];
  /** Number of the choice, from 1. */
  readonly number?: number;
}

export interface ShownLine extends DraftedLine {
  /** Whether an act on the line is being sent. */
  readonly sending: boolean;
  /** Whether it is unknown what the line becomes until the service answers. */
  readonly reading: boolean;
}

/** Return whether a person still has to decide on a line. */
export function isLeft(line: DraftedLine): boolean {
  return line.state === "proposed" || line.state === "open";
}

/** Return the lines as they are once the acts have been carried out, as far as that is known. */
export function withActs(lines: readonly DraftedLine[], acts: readonly LineAct[]): readonly ShownLine[] {
  const byLabel = new Map<string, LineAct>();
  for (const act of acts) byLabel.set(act.label, act);
  return lines.map((line) => shownLine(line, byLabel.get(line.label)));
}

/** the lines that are shown without an act, so that unchanged ones stay the same objects */
const withoutAct = new WeakMap<DraftedLine, ShownLine>();

function shownLine(line: DraftedLine, act: LineAct | undefined): ShownLine {
  if (act === undefined) {
    const known = withoutAct.get(line) ?? { ...line, sending: false, reading: false };
    withoutAct.set(line, known);
    return known;
  }
  const decided = { ...line, reason: "", hint: "", sentences: act.sentences, sending: true, reading: false };
  if (act.kind === "confirm") return { ...decided, state: "understood", act: "confirmed", choices: [] };
  if (act.kind === "set_aside" || (act.kind === "choose" && act.sentences.length === 0))
    return { ...decided, state: "set aside", act: "set aside", sentences: [], choices: [], unused: [] };
  if (act.kind === "choose") return { ...decided, state: "understood", act: "chosen", choices: [], unused: [] };
  return { ...line, sentences: act.sentences, sending: true, reading: true };
}

/** Return whether an act is still about what the person saw: a confirmation is of a proposal. */
export function stillApplies(act: LineAct, line: DraftedLine | undefined): boolean {
  if (line === undefined) return false;
  if (act.kind === "confirm") return line.state === "proposed" && same(line.sentences, act.sentences);
  if (act.kind === "choose") return same(line.choices[(act.number ?? 0) - 1], act.sentences);
  return true;
}

/** Return whether a line is as an act makes it. */
export function isDone(act: LineAct, line: DraftedLine): boolean {
  const made = line.act ?? null;
  if (act.kind === "undo") return made === null;
  if (act.kind === "set_aside" || (act.kind === "choose" && act.sentences.length === 0)) return made === "set aside";
  const wanted = { confirm: "confirmed", choose: "chosen", say: "said" }[act.kind];
  return made === wanted && same(line.sentences, act.sentences.map(plain));
}

/** Return the labels of the lines whose decisions differ from those before, and are not those of pending acts: somebody
 * else has decided on them. */
export function decidedByOthers(
  before: readonly DraftedLine[],
  after: readonly DraftedLine[],
  pending: readonly LineAct[],
): ReadonlySet<string> {
  const known = new Map(before.map((line) => [line.label, line]));
  const found = after.filter((line) => {
    const old = known.get(line.label);
    if (old === undefined || sameDecision(old, line)) return false;
    return !pending.some((act) => act.label === line.label && isDone(act, line)); // its answer was lost
  });
  return new Set(found.map((line) => line.label));
}

function sameDecision(one: DraftedLine, other: DraftedLine): boolean {
  const [before, after] = [one.act ?? null, other.act ?? null];
  return before === after && (after === null || same(one.sentences, other.sentences));
}

/** Return a text with single blanks, as the service stores it. */
function plain(text: string): string {
  return text.trim().split(/\s+/).join(" ");
}

function same(one: readonly string[] | undefined, other: readonly string[]): boolean {
  return one !== undefined && one.length === other.length && one.every((text, at) => text === other[at]);
}

/** Return acts as the service takes them; neighbouring ones of a kind become one. */
export function toRequest(acts: readonly LineAct[]): DraftAct[] {
  const found: DraftAct[] = [];
  for (const { kind, label, sentences, number } of acts) {
    const last = found.at(-1);
    if (kind === "say") found.push({ kind, label, sentences: [...sentences] });
    else if (kind === "choose") found.push({ kind, label, number: number ?? 1 });
    else if (last?.kind === kind && last.labels) found[found.length - 1] = { ...last, labels: [...last.labels, label] };
    else found.push({ kind, labels: [label] });
  }
  return found;
}

/** A part of a line's text. */
export interface TextPart {
  readonly text: string;
  readonly unused: boolean;
}

/** Split the text of a line at the words that its proposal does not use. */
export function splitUnused(text: string, unused: readonly string[]): readonly TextPart[] {
  const marked: [from: number, to: number][] = [];
  let from = 0;
  for (const words of unused) {
    const at = text.indexOf(words, from);
    const found = at >= 0 ? at : text.indexOf(words);
    if (found < 0 || words === "") continue;
    marked.push([found, found + words.length]);
    from = found + words.length;
  }
  marked.sort(([one], [other]) => one - other);
  const parts: TextPart[] = [];
  let end = 0;
  for (const [begin, after] of marked) {
    if (begin < end) continue;
    if (begin > end) parts.push({ text: text.slice(end, begin), unused: false });
    parts.push({ text: text.slice(begin, after), unused: true });
    end = after;
  }
  if (end < text.length) parts.push({ text: text.slice(end), unused: false });
  return parts;
}

/** Return the index of the next line that is left, after `from` and then from the top; -1: none. One that is being
 * read comes last, as it may be left no more. */
export function nextLeft(lines: readonly (DraftedLine & { reading?: boolean })[], from: number, step: 1 | -1 = 1): number {
  const count = lines.length;
  let read = -1;
  for (let offset = 1; offset <= count; offset++) {
    const at = (((from + step * offset) % count) + count) % count;
    const line = lines[at];
    if (!line || !isLeft(line)) continue;
    if (line.reading !== true) return at;
    if (read < 0) read = at;
  }
  return read;
}

/** Return the messages about each line, by its label. */
export function messagesByLine(lines: readonly DraftedLine[], messages: readonly Diagnostic[]): ReadonlyMap<string, readonly Diagnostic[]> {
  const found = new Map<string, readonly Diagnostic[]>();
  for (const message of messages) {
    if (!message.span) continue;
    const { line: at, column } = message.span;
    const [first, ...others] = lines.filter((one) => one.line <= at && at <= one.last_line);
    const about = others.findLast((one) => one.line < at || one.column <= column) ?? first;
    if (about) found.set(about.label, [...(found.get(about.label) ?? []), message]);
  }
  return found;
}

/** Return whether a person has written other words for a line, and they are not understood. */
export function isRefused(line: ShownLine): boolean {
  return line.state === "open" && line.act === "said" && !line.sending;
}
