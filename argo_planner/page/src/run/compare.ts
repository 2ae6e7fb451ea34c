/** Two runs of the mission side by side. */

import { computed } from "@preact/signals-core";

import type { Fault, Noticed, RunState } from "../api/types";
import { csv } from "../model/csv";
import { givenFields } from "../model/faults";
import {
  compareNoticed,
  compareReadings,
  compareTasks,
  isApart,
  runSum,
  type FinishedRun,
  type Measured,
  type NoticedRow,
  type ReadingRow,
  type TaskRow,
} from "../model/run-comparison";
import { comparedRuns, compareRuns, stopComparing } from "../state/compared-runs";
import { readFaultKinds } from "../state/faults";
import { withErrorNotice } from "../state/notices";
import { checkpointsById } from "../state/world";
import { t } from "../texts";
import { faultText } from "../texts/fault-names";
import { options, valueOf } from "../ui/controls";
import { downloadText } from "../ui/download";
import { css, customElement, html, nothing, PageElement, property, state } from "../ui/element";
import { bound, dateAndTime, figure, metres, percent, seconds, unitText } from "../ui/figures";
import { icon } from "../ui/icons";
import { faultSummary } from "./fault-words";
import { modeWords } from "./mode-words";
import { parts } from "./parts";
import { comparedReadingsTable, comparedTasksTable } from "./tables";

type Cells = readonly [first: unknown, second: unknown, difference: unknown];

interface Row {
  readonly head: unknown;
  readonly cells: Cells;
  readonly differs: boolean;
}

const found = computed(() => {
  const both = comparedRuns.value;
  if (both === null) return null;
  const [first, second] = both;
  return {
    both,
    readings: compareReadings(first, second, checkpointsById.value),
    tasks: compareTasks(first, second),
    noticed: compareNoticed(noticedIn(first), noticedIn(second)),
  };
});

@customElement("argo-run-compare")
export class RunCompare extends PageElement {
  static override styles = [
    parts,
    css`
      .inner {
        gap: 12px;
      }
      table {
        width: 100%;
        border-collapse: collapse;
        font-size: 13px;
        table-layout: fixed;
      }
      caption {
        padding: 4px 0;
        font-weight: 600;
        text-align: left;
      }
      thead th {
        color: var(--dim);
        font-size: 12px;
        font-weight: 400;
      }
      th,
      td {
        padding: 1px 4px;
        overflow-wrap: anywhere;
        text-align: left;
        vertical-align: top;
        font-variant-numeric: tabular-nums;
      }
      tbody th {
        padding-top: 5px;
        border-top: 1px solid var(--line);
        font-weight: 400;
      }
      tbody td {
        padding-bottom: 5px;
      }
      tr.differs + tr td,
      tr.differs th {
        background: var(--warn-ground);
      }
      tr.differs th {
        border-left: 4px double var(--warn);
      }
      tr.differs + tr td:first-child {
        border-left: 4px double var(--warn);
      }
      .sign {
        display: inline-flex;
        align-items: center;
        gap: 3px;
        color: var(--warn);
        font-size: 12px;
        font-weight: 600;
      }
      .small {
        font-size: 12px;
        color: var(--dim);
      }
      .off {
        color: var(--bad);
        font-weight: 600;
      }
      .files {
        display: flex;
        flex-wrap: wrap;
        gap: 6px;
      }
      .check {
        display: flex;
        align-items: center;
        gap: 6px;
        color: var(--text);
        font-size: 13px;
      }
      .check input {
        width: auto;
      }
    `,
  ];

  /** the runs of the mission that have ended, the newest first */
  @property({ attribute: false }) runs: readonly RunState[] = [];
  @state() private chosen: readonly [string, string] | null = null;
  @state() private onlyDifferent = false;
  @state() private reading = false;

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    stopComparing();
  }

  override render() {
    if (this.runs.length < 2) return nothing;
    const texts = t().compare;
    const [first, second] = this.pair();
    return html`<details id="compare" @toggle=${this.toggled}>
      <summary>${texts.title}</summary>
      <div class="inner">
        ${this.choice(texts.first, "first", first, (id) => [id, second])}
        ${this.choice(texts.second, "second", second, (id) => [first, id])}
        ${first === second ? html`<p class="wrong" role="alert">${texts.choose}</p>` : nothing}
        ${this.reading ? html`<p class="reason" role="status">${texts.reading}</p>` : nothing} ${this.comparison()}
      </div>
    </details>`;
  }

  /** Return the ids of the compared runs; at first the two newest ones, the older of them first. */
  private pair(): readonly [string, string] {
    const known = this.chosen?.every((id) => this.runs.some((one) => one.id === id)) ? this.chosen : null;
    return known ?? [this.runs[1]?.id ?? "", this.runs[0]?.id ?? ""];
  }

  private choice(label: string, id: string, value: string, pair: (id: string) => readonly [string, string]) {
    const take = (event: Event) => {
      this.chosen = pair(valueOf(event));
      void this.compare();
    };
    return html`<label>
      ${label}
      <select id=${id} @change=${take}>
        ${options(this.runs.map((one) => [one.id, named(one)] as const), value)}
      </select>
    </label>`;
  }

  private toggled(event: Event): void {
    if ((event.target as HTMLDetailsElement).open) void this.compare();
    else stopComparing();
  }

  private async compare(): Promise<void> {
    const [first, second] = (this.chosen = this.pair());
    if (first === second) return stopComparing();
    this.reading = true;
    await withErrorNotice(async () => {
      await Promise.all([compareRuns(first, second), readFaultKinds()]);
    });
    this.reading = false;
  }

  private comparison() {
    if (found.value === null) return nothing;
    const texts = t().compare;
    const { both, readings, tasks, noticed } = found.value;
    const [first, second] = both;
    const file = (kind: string) => `${kind}-${first.state.id}-${second.state.id}.csv`;
    const lacking = both.filter((one) => one.report === null);
    return html`${lacking.map((one) => html`<p class="reason">${texts.noReport(named(one.state))}</p>`)}
      <p class="reason">${texts.paths}</p>
      <div class="files">
        ${csvButton("csv-readings", texts.csvReadings, () => [file(texts.fileReadings), csv(comparedReadingsTable(readings))])}
        ${csvButton("csv-tasks", texts.csvTasks, () => [file(texts.fileTasks), csv(comparedTasksTable(tasks))])}
      </div>
      <label class="check">
        <input
          type="checkbox"
          id="only-different"
          .checked=${this.onlyDifferent}
          @change=${(event: Event) => (this.onlyDifferent = (event.target as HTMLInputElement).checked)}
        />
        ${texts.onlyDifferent}
      </label>
      ${this.table("whole", texts.whole, wholeRows(both))} ${this.table("readings", texts.readings, readings.map(readingRow))}
      ${this.table("tasks", texts.tasks, tasks.map(taskRow))}
      ${noticed.length === 0
        ? html`<p class="reason">${texts.nothingNoticed}</p>`
        : this.table("noticed", texts.noticed, noticed.map(noticedRow), false)}`;
  }

  /** Render a table. The name of a row has a line of its own: the panel is narrow. */
  private table(id: string, caption: string, rows: readonly Row[], withDifference = true) {
    const texts = t().compare;
    const shown = this.onlyDifferent ? rows.filter((row) => row.differs) : rows;
    const columns = withDifference ? 3 : 2;
    return html`<table id=${id}>
      <caption>
        ${caption}
      </caption>
      <thead>
        <tr>
          <th scope="col">${texts.firstShort}</th>
          <th scope="col">${texts.secondShort}</th>
          ${withDifference ? html`<th scope="col">${texts.difference}</th>` : nothing}
        </tr>
      </thead>
      ${shown.length === 0
        ? html`<tbody>
            <tr>
              <td colspan=${columns} class="small">${rows.length === 0 ? texts.nothing : texts.nothingDifferent}</td>
            </tr>
          </tbody>`
        : shown.map(
            ({ head, cells, differs }) => html`<tbody>
              <tr class=${differs ? "differs" : ""}>
                <th colspan=${columns} scope="rowgroup">${differs ? sign() : nothing} ${head}</th>
              </tr>
              <tr>
                ${cells.slice(0, columns).map((cell) => html`<td>${cell}</td>`)}
              </tr>
            </tbody>`,
          )}
    </table>`;
  }
}

/** Render a button that stores a CSV file; `make` returns its name and content. */
export function csvButton(id: string, label: string, make: () => readonly [string, string]) {
  const store = () => {
    const [name, text] = make();
    downloadText(name, text, "text/csv");
  };
  return html`<button type="button" id=${id} @click=${store}>${icon("down", 14)} ${label}</button>`;
}

function sign() {
  const word = t().compare.different;
  return html`<span class="sign"><span aria-hidden="true">≠</span> ${word}:</span>`;
}

function named(one: RunState): string {
  return `${t().run.pastRunOf(dateAndTime(one.begun, "short", "medium"), modeWords(one))} (${t().compare.columns.revision} ${one.revision})`;
}

function noticedIn({ state }: FinishedRun): readonly Noticed[] {
  return state.headline?.noticed ?? [];
}

/** Describe a fault with all that it had, also what was drawn. */
function faultInWords(fault: Fault): string {
  return `${faultText(fault.kind)} (${faultSummary(givenFields(fault))})`;
}

function wholeRows(both: readonly [FinishedRun, FinishedRun]): Row[] {
  const texts = t().compare;
  const [a, b] = both.map(runSum) as [ReturnType<typeof runSum>, ReturnType<typeof runSum>];
  const text = (head: string, of: (run: FinishedRun) => string, matters = true): Row => {
    const [first, second] = both.map(of);
    return { head, cells: [first, second, ""], differs: matters && first !== second };
  };
  const number = (head: string, [first, second]: readonly [number, number], show: (value: number) => string, differs: boolean): Row => ({
    head,
    cells: [show(first), show(second), differs ? signed(second - first, show) : "="],
    differs,
  });
  const length = (head: string, pair: readonly [number, number], show: (value: number) => string) =>
    number(head, pair, show, isApart(...pair));
  const count = (head: string, pair: readonly [number, number]) => number(head, pair, String, pair[0] !== pair[1]);
  const faults = ({ report }: FinishedRun) =>
    report === null ? texts.measured.unknown : report.faults.map(faultInWords).join("; ") || texts.none;
  return [
    text(texts.verdict, ({ state }) => (state.headline ? t().verdict.headline(state.headline) : (state.problem ?? ""))),
    length(texts.duration, [a.duration, b.duration], seconds),
    length(texts.distance, [a.distance, b.distance], metres),
    length(texts.climbed, [a.climbed, b.climbed], metres),
    ...(a.charge === null || b.charge === null
      ? []
      : [number(texts.charge, [a.charge, b.charge], (one) => percent(one, 1), isApart(100 * a.charge, 100 * b.charge))]),
    {
      head: texts.tasksDone,
      cells: [texts.ofAll(a.done, a.tasks), texts.ofAll(b.done, b.tasks), a.done === b.done ? "=" : signed(b.done - a.done, String)],
      differs: a.done !== b.done || a.tasks !== b.tasks,
    },
    count(texts.readings, [a.readings, b.readings]),
    count(texts.abnormal, [a.abnormal, b.abnormal]),
    text(texts.revision, ({ state }) => String(state.revision)),
    text(t().run.drive, ({ state }) => state.drive),
    text(t().run.sensor, ({ state }) => (t().run.sensors as Readonly<Record<string, string>>)[state.sensor] ?? state.sensor),
    text(texts.seed, ({ state }) => String(state.seed)),
    text(texts.faults, faults),
    text(texts.begun, ({ state }) => dateAndTime(state.begun, "short", "medium"), false),
    text(texts.by, ({ state }) => state.by, false),
  ];
}

/** Format a difference with its sign. */
function signed(value: number, show: (value: number) => string): string {
  if (value === 0) return "=";
  return `${value > 0 ? "+" : "−"}${show(Math.abs(value))}`;
}

function readingRow(row: ReadingRow): Row {
  const texts = t().compare;
  const unit = unitText(row.unit);
  const { nominal, difference } = row;
  const head = html`#${row.checkpoint} ${row.name}
    <span class="small">
      ${row.count > 1 ? `${texts.measurement(row.number)} · ` : ""}${nominal === null
        ? ""
        : texts.nominal(bound(nominal.low), bound(nominal.high), unit)}
    </span>`;
  const cell = (one: Measured) => {
    if (one.kind !== "read") return html`<i>${texts.measured[one.kind]}</i>`;
    const value = `${figure(one.value)} ${unit}`;
    return one.normal ? value : html`<span class="off">${value}</span> <span class="small">${t().run.abnormal}</span>`;
  };
  const between = difference === null ? "–" : signed(difference, (value) => `${figure(value)} ${unit}`);
  return { head, cells: [cell(row.runs[0]), cell(row.runs[1]), between], differs: row.differs };
}

function taskRow(row: TaskRow): Row {
  const texts = t().compare;
  const [first, second] = row.runs;
  const cell = (one: TaskRow["runs"][0]) => {
    if (typeof one === "string") return html`<i>${texts.notVisited[one]}</i>`;
    const notes = [
      one.outcome === null || one.outcome === "done" ? "" : texts.outcomes[one.outcome],
      one.visits > 1 ? texts.visits(one.visits) : "",
    ].filter(Boolean);
    return html`${seconds(one.duration)}, ${metres(one.distance)}
      ${notes.length === 0 ? nothing : html`<br /><span class="small">${notes.join(", ")}</span>`}`;
  };
  const both = typeof first === "string" || typeof second === "string" ? null : ([first, second] as const);
  const between =
    both === null
      ? "–"
      : [
          isApart(both[0].duration, both[1].duration) ? signed(both[1].duration - both[0].duration, seconds) : "",
          isApart(both[0].distance, both[1].distance) ? signed(both[1].distance - both[0].distance, metres) : "",
        ]
          .filter(Boolean)
          .join(", ") || "=";
  const head = row.redefined ? html`${row.name} <span class="small">${texts.redefined}</span>` : row.name;
  return { head, cells: [cell(first), cell(second), between], differs: row.differs };
}

function noticedRow({ runs, differs }: NoticedRow): Row {
  const [first, second] = runs;
  const cell = (one: Noticed | null) => (one === null ? t().compare.notHere : t().verdict.noticed(one));
  const event = (first ?? second)?.event;
  const head = event ? t().words.event[event] : ((first ?? second)?.task ?? "");
  return { head, cells: [cell(first), cell(second), ""], differs };
}
