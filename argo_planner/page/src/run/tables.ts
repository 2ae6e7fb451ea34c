/** Tables of readings and tasks, as rows of cells for CSV files. */

import type { Entry } from "../api/types";
import type { Cell } from "../model/csv";
import { measurements, type FinishedRun, type Measured, type ReadingRow, type TaskRow } from "../model/run-comparison";
import { checkpointsById } from "../state/world";
import { t } from "../texts";

type Rows = readonly (readonly Cell[])[];

/** Return what a run has measured, in the order of time. The value of each row has the unit that is named beside it. */
export function readingsTable(id: string, revision: number, entries: readonly Entry[]): Rows {
  const { columns } = t().compare;
  const { run, revision: made, time, checkpoint, name, task, result, value, unit, low, high, normal, byHand } = columns;
  const head = [run, made, time, checkpoint, name, task, result, value, unit, low, high, normal, byHand];
  const state = { id, revision } as FinishedRun["state"];
  const rows = [...measurements({ state, entries, report: null }).made].flatMap(([number, all]) =>
    all.flatMap((one) => ("t" in one ? [{ number, one }] : [])),
  );
  const sorted = rows.sort((a, b) => a.one.t - b.one.t);
  return [
    head,
    ...sorted.map(({ number, one }) => {
      const known = checkpointsById.value.get(number);
      const shown = one.kind === "read" ? [yesOrNo(one.normal), yesOrNo(one.byHand)] : [null, null];
      return [
        ...[id, revision, rounded(one.t), numbered(number), known?.name ?? "", one.task, resultOf(one), valueOf(one)],
        ...[known?.unit ?? "", known?.nominal.low ?? null, known?.nominal.high ?? null, ...shown],
      ];
    }),
  ];
}

/** Return the rows of compared readings. */
export function comparedReadingsTable(rows: readonly ReadingRow[]): Rows {
  const { columns } = t().compare;
  const { checkpoint, name, measurement, unit, low, high, result, value, time, difference, different } = columns;
  const ofRun = [result, value, time];
  const head = [
    ...[checkpoint, name, measurement, unit, low, high],
    ...[...ofRun.map(columns.ofFirst), ...ofRun.map(columns.ofSecond), difference, different],
  ];
  const cells = (one: Measured): Cell[] => [resultOf(one), valueOf(one), "t" in one ? rounded(one.t) : null];
  return [
    head,
    ...rows.map((row) => [
      ...[numbered(row.checkpoint), row.name, row.number, row.unit, row.nominal?.low ?? null, row.nominal?.high ?? null],
      ...[...cells(row.runs[0]), ...cells(row.runs[1]), row.difference, yesOrNo(row.differs)],
    ]),
  ];
}

/** Return the rows of compared tasks. */
export function comparedTasksTable(rows: readonly TaskRow[]): Rows {
  const { columns } = t().compare;
  const ofRun = [columns.outcome, columns.visits, columns.duration, columns.distance, columns.climbed];
  const cells = (one: TaskRow["runs"][0]): Cell[] =>
    typeof one === "string"
      ? [t().compare.notVisited[one], 0, null, null, null]
      : [
          one.outcome === null ? null : t().compare.outcomes[one.outcome],
          one.visits,
          ...[one.duration, one.distance, one.climbed].map(rounded),
        ];
  return [
    [columns.task, ...ofRun.map(columns.ofFirst), ...ofRun.map(columns.ofSecond), columns.different],
    ...rows.map((row) => [row.name, ...cells(row.runs[0]), ...cells(row.runs[1]), yesOrNo(row.differs)]),
  ];
}

function resultOf(one: Measured): string {
  return one.kind === "read" ? t().compare.columns.read : t().compare.measured[one.kind];
}

function valueOf(one: Measured): number | null {
  return one.kind === "read" ? one.value : null;
}

function numbered(id: string): Cell {
  return /^\d+$/.test(id) ? Number(id) : id;
}

function yesOrNo(is: boolean): string {
  return is ? t().compare.columns.yes : t().compare.columns.no;
}

function rounded(value: number): number {
  return Math.round(1000 * value) / 1000;
}
