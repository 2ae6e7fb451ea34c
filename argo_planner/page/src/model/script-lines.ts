/** The lines of a script and the tasks that they belong to. Lines are counted from 1. */

import type { Diagnostic, MissionReading } from "../api/types";

export interface Lines {
  readonly from: number;
  readonly to: number;
}

type Entry = MissionReading["entries"][number];

/** Return the lines of each task and group in a script that the service wrote, with numbered steps. */
export function linesBySteps(text: string, entries: readonly Entry[]): Map<string, Lines> {
  const lines = text.split("\n");
  const steps = new Map<number, Lines>();
  lines.forEach((line, at) => {
    const step = /^\s*(\d+)\.\s/.exec(line)?.[1];
    if (step !== undefined) steps.set(Number(step), { from: at + 1, to: blockEnd(lines, at) });
  });
  const found = new Map<string, Lines>();
  for (const { name, step } of entries) {
    const there = typeof step === "number" ? steps.get(step) : undefined;
    if (name !== "" && there !== undefined) found.set(name, there);
  }
  return found;
}

/** Return the lines of each task and group in the script that the mission was made from. */
export function linesBySource(text: string, entries: readonly Entry[]): Map<string, Lines> {
  const lines = text.split("\n");
  const found = new Map<string, Lines>();
  for (const { name, source } of entries)
    if (name !== "" && source && source.line <= lines.length)
      found.set(name, { from: source.line, to: blockEnd(lines, source.line - 1) });
  return found;
}

/** Return the last line of a step: indented lines continue it. */
function blockEnd(lines: readonly string[], at: number): number {
  let end = at + 1;
  while (/^\s+\S/.test(lines[end] ?? "") && !/^\s*\d+\.\s/.test(lines[end] ?? "")) end++;
  return end;
}

/** Return the task or group of a line. */
export function nameInLine(lines: ReadonlyMap<string, Lines>, line: number): string | null {
  for (const [name, { from, to }] of lines) if (from <= line && line <= to) return name;
  return null;
}

/** Return the line of an offset in the text. */
export function lineOf(text: string, at: number): number {
  return text.slice(0, at).split("\n").length;
}
/** Return the offset of a line and column in the text. */
export function offsetOf(text: string, line: number, column: number): number {
  const before = text.split("\n").slice(0, line - 1);
  return Math.min(text.length, before.reduce((sum, one) => sum + one.length + 1, 0) + column - 1);
}

/** Return the worst severity of each line. */
export function worstSeverities(diagnostics: readonly Diagnostic[]): Map<number, Diagnostic["severity"]> {
  const rank = { error: 2, warning: 1, note: 0 };
  const found = new Map<number, Diagnostic["severity"]>();
  for (const { span, severity } of diagnostics) {
    if (!span) continue;
    const before = found.get(span.line);
    if (before === undefined || rank[severity] > rank[before]) found.set(span.line, severity);
  }
  return found;
}
