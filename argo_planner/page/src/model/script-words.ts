/** The words of an imported script that its tasks and groups come from. */

import type { MissionReading } from "../api/types";

/** A part of a line, and the task or group that asks for it; null: none. */
export interface LineWords {
  readonly text: string;
  readonly name: string | null;
}

type Entry = MissionReading["entries"][number];

interface Range {
  readonly from: number;
  readonly to: number;
  readonly name: string;
}

/** Split each line of a script at the words of tasks and groups. Columns are counted in Unicode code points. */
export function linesWithWords(text: string, entries: readonly Entry[]): readonly (readonly LineWords[])[] {
  const byLine = new Map<number, Range[]>();
  for (const { name, source } of entries) {
    if (name === "" || !source) continue;
    const from = source.column - 1;
    const to = source.length > 1 ? from + source.length : Infinity;
    byLine.set(source.line, [...(byLine.get(source.line) ?? []), { from, to, name }]);
  }
  return text.split(/\r\n?|\n/).map((line, at) => splitLine(Array.from(line), byLine.get(at + 1) ?? []));
}

/** A sentence that a person has decided on has a place, but no length: its words go on to the next ones. */
function splitLine(characters: readonly string[], ranges: readonly Range[]): readonly LineWords[] {
  const sorted = [...ranges].sort((one, other) => one.from - other.from);
  const parts: LineWords[] = [];
  let end = 0;
  const add = (from: number, to: number, name: string | null) => {
    if (to > from) parts.push({ text: characters.slice(from, to).join(""), name });
  };
  sorted.forEach(({ from, to, name }, at) => {
    const begin = Math.min(from, characters.length);
    if (begin < end) return; // several tasks of the same words: the first one has them
    const next = sorted.find((other, later) => later > at && other.from > from)?.from ?? characters.length;
    const after = Math.min(to === Infinity ? next : to, characters.length);
    add(end, begin, null);
    add(begin, after, name);
    end = Math.max(begin, after);
  });
  add(end, characters.length, null);
  return parts;
}
