/** The mission sheet: facts, tasks, plans of the visited floors, and the script, for paper. */

import { legsOf, boundsOf } from "../model/legs";
import { outline, ownName, type Row } from "../model/outline";
import { analysis, findings, mission, missionHasErrors, planName, revision } from "../state/plan";
import { preview, previewIsNew } from "../state/preview";
import { service } from "../state/session";
import { groupDetail, stepNumbers, taskDetail, taskTitle } from "../state/task-labels";
import { checkpointsById, world } from "../state/world";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { bound, dateAndTime, metres, percent, seconds, timeBounds, unitText } from "../ui/figures";
import { drawingStyles, floorDrawing, legend } from "./drawing";
import { drawnFloors } from "./floors";
import { visited, writtenScript } from "./state";

/** Room of a plan (px): the width of A4 without its margins, at 96 px an inch; two plans fit on a page. */
const [WIDTH, HEIGHT] = [690, 400];

@customElement("argo-mission-sheet")
export class MissionSheet extends PageElement {
  static override styles = [
    drawingStyles,
    css`
      /* Paper is white in both themes. */
      :host {
        color-scheme: light;
        --surface: #ffffff;
        --raised: #ffffff;
        --sunken: #e7ebf1;
        --line: #c9d1dc;
        --text: #17202b;
        --dim: #52606f;
        --accent: #0b5cad;
        --good: #18703a;
        --warn: #8a5300;
        --bad: #b3261e;
        background: var(--surface);
        color: var(--text);
        font-size: 13px;
      }
      header {
        padding-bottom: 8px;
        border-bottom: 2px solid var(--text);
      }
      h1,
      td,
      dd {
        overflow-wrap: anywhere;
      }
      h2 {
        margin: 20px 0 8px;
        break-after: avoid;
      }
      dl {
        display: grid;
        grid-template-columns: repeat(auto-fill, minmax(150px, 1fr));
        gap: 8px 16px;
        margin: 12px 0 0;
      }
      dt {
        color: var(--dim);
        font-size: 11px;
      }
      dd {
        margin: 0;
        font-weight: 600;
      }
      table {
        width: 100%;
        border-collapse: collapse;
      }
      th {
        padding: 4px 8px 4px 0;
        border-bottom: 1px solid var(--text);
        text-align: left;
        font-weight: 600;
        font-size: 11px;
        vertical-align: bottom;
      }
      td {
        padding: 5px 8px 5px 0;
        border-bottom: 1px solid var(--line);
        vertical-align: top;
      }
      tr,
      figure {
        break-inside: avoid;
      }
      .number {
        width: 34px;
        font-weight: 700;
      }
      .figures {
        white-space: nowrap;
      }
      .group td {
        font-weight: 600;
        background: color-mix(in srgb, var(--sunken) 60%, var(--surface));
      }
      .said {
        color: var(--dim);
        font-weight: 400;
      }
      .bad {
        margin-top: 10px;
        color: var(--bad);
      }
      figure {
        margin: 18px 0 0;
      }
      figcaption {
        margin-bottom: 6px;
        font-weight: 600;
        font-size: 15px;
      }
      pre {
        margin: 0;
        padding: 10px;
        border: 1px solid var(--line);
        font: 11px/1.5 ui-monospace, "DejaVu Sans Mono", monospace;
        white-space: pre-wrap;
        overflow-wrap: anywhere;
      }
      figure svg {
        margin: 0 auto;
      }
      .signed {
        break-before: avoid;
        margin-top: 36px;
        width: 60%;
        padding-top: 4px;
        border-top: 1px solid var(--text);
        font-size: 11px;
        break-inside: avoid;
      }
    `,
  ];

  override render() {
    const open = mission.value;
    if (open === null) return nothing;
    const texts = t().floorplan;
    const floors = drawnFloors(visited.value, WIDTH, HEIGHT);
    return html`<header>
        <h1>${planName.value}</h1>
        <p class="dim">${texts.sheet} · ${world.value?.title ?? ""}</p>
      </header>
      ${this.facts()} ${this.problems()}
      <h2>${t().list.tasks}</h2>
      ${this.tasks()} ${this.reactions()}
      ${floors.map(
        (floor) =>
          html`<figure>
            <figcaption>${texts.page(floor.plan.number)}</figcaption>
            ${floorDrawing(floor)}
          </figure>`,
      )}
      ${floors.length > 0 ? legend(floors) : nothing}
      <h2>${texts.readBack}</h2>
      <p class="dim">${texts.readBackHint}</p>
      ${this.script()}
      <p class="signed">${texts.signed}</p>`;
  }

  private facts() {
    const open = mission.value;
    if (open === null) return nothing;
    const texts = t().floorplan;
    const { facts } = texts;
    const found = preview.value;
    const all: (readonly [string, unknown])[] = [
      [facts.site, service.value?.site ?? ""],
      ...(open.designation ? [[facts.designation, open.designation] as const] : []),
      [facts.revision, revision.value],
      [facts.printed, dateAndTime(new Date().toISOString())],
      [facts.start, open.start_area ?? texts.none],
      [facts.end, open.end_area ?? texts.none],
      ...(open.order === "precise" ? [] : [[facts.order, texts.anyOrder] as const]),
      [facts.limit, typeof open.max_duration === "number" ? seconds(open.max_duration) : texts.none],
      ...this.bounds(),
      ...(found === null ? [] : [[facts.distance, metres(found.distance)] as const]),
    ];
    return html`<dl>
      ${all.map(([name, value]) => html`<div><dt>${name}</dt><dd>${value}</dd></div>`)}
    </dl>`;
  }

  /** Return the bounds over all executions of this revision, as the strip shows them. */
  private bounds(): (readonly [string, string])[] {
    if (analysis.value?.revision !== revision.value) return [];
    const { facts } = t().floorplan;
    const { between, noBound } = t().strip;
    const battery = world.value?.robot.battery ?? 0;
    return boundsOf(analysis.value, { time: null, energy: null }).flatMap(({ kind, least, most }) => {
      if (kind === "time")
        return [[facts.expected, timeBounds(least ?? 0, most)] as const];
      if (battery <= 0) return [];
      const text = between(percent((least ?? 0) / battery), most === null ? noBound : percent(most / battery));
      return [[facts.battery, text] as const];
    });
  }

  private problems() {
    if (!missionHasErrors.value) return nothing;
    const errors = findings.value.diagnostics.filter((one) => one.severity === "error");
    return html`<div class="bad">
      <p>${t().floorplan.broken}</p>
      <ul>
        ${errors.map((one) => html`<li>${one.message}</li>`)}
      </ul>
    </div>`;
  }

  private tasks() {
    const open = mission.value;
    if (open === null) return nothing;
    const texts = t().floorplan;
    const ends = endsOfTasks();
    const number = ({ key }: Row) => html`<td class="number">${stepNumbers.value.get(key)}</td>`;
    return html`<table>
      <thead>
        <tr>
          <th class="number">${texts.number}</th>
          <th>${texts.task}</th>
          <th>${texts.normal}</th>
          <th title=${texts.afterHint}>${texts.after}</th>
        </tr>
      </thead>
      <tbody>
        ${outline(open).map((row) =>
          row.kind === "group"
            ? html`<tr class="group">
                ${number(row)}
                <td colspan="3">${indent(row)}${ownName(row.group.name)} <span class="said">${groupDetail(row.group)}</span></td>
              </tr>`
            : html`<tr>
                ${number(row)}
                <td>
                  ${indent(row)}<b>${taskTitle(row.task)}</b>
                  <div class="said">${indent(row)}${taskDetail(row.task)}</div>
                </td>
                <td class="figures">${normalRange(row.task.object_id)}</td>
                <td class="figures">${ends.get(row.task.name) ?? ""}</td>
              </tr>`,
        )}
      </tbody>
    </table>`;
  }

  private reactions() {
    const reactions = mission.value?.reactions ?? [];
    if (reactions.length === 0) return nothing;
    const { words, list, floorplan } = t();
    return html`<h2>${floorplan.reactions}</h2>
      <table>
        <tbody>
          ${reactions.map(
            (one) =>
              html`<tr>
                <td><b>${list.when(words.event[one.event])}</b></td>
                <td>${words.response[one.response]}</td>
              </tr>`,
          )}
        </tbody>
      </table>`;
  }

  private script() {
    const script = writtenScript.value;
    if (script === null) return html`<p class="dim">${t().script.loading}</p>`;
    return "text" in script ? html`<pre>${script.text}</pre>` : html`<p class="bad">${script.problem}</p>`;
  }
}

function indent(row: Row): string {
  return "\u2003".repeat(row.depth);
}

function normalRange(checkpoint: string | null | undefined): string {
  const found = checkpointsById.value.get(checkpoint ?? "");
  return found ? `${bound(found.nominal.low)} – ${bound(found.nominal.high)} ${unitText(found.unit)}` : "";
}

/** Return when each task has first ended if each is done once; none while the times are being calculated. */
function endsOfTasks(): Map<string, string> {
  const found = new Map<string, string>();
  if (preview.value === null || mission.value === null || !previewIsNew.value) return found;
  for (const leg of legsOf(preview.value, mission.value))
    if (leg.problem === null && !found.has(leg.task)) found.set(leg.task, seconds(leg.start + leg.time));
  return found;
}
