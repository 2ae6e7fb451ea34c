/** The strip: time, distance, climb and battery for each leg and in total, with their limits. */

import { mergedLegs, isTooLate, legsOf, type Leg } from "../model/legs";
import { isTaskKey, nameOfKey, taskKey } from "../model/outline";
import { missionHasErrors, mission, select, selection } from "../state/plan";
import { hoveredLeg, preview, previewRefused } from "../state/preview";
import { numberOf, taskLabel } from "../state/task-labels";
import { world } from "../state/world";
import { t } from "../texts";
import { said } from "../texts/messages";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { metres, seconds, share } from "../ui/figures";
import { styled } from "../ui/styled";
import "./totals";

const MOST_BARS = 250;
const MOST_ROWS = 1_000;

@customElement("argo-strip")
export class StripPanel extends PageElement {
  static override styles = css`
    .bar {
      position: relative;
      display: flex;
      gap: 1px;
      height: 28px;
      margin: 6px 0 2px;
      border-radius: 6px;
      background: var(--sunken);
    }
    .bar button {
      display: block;
      flex: none;
      min-width: 3px;
      min-height: 0;
      height: 28px;
      padding: 0 4px;
      overflow: hidden;
      border: 0;
      border-radius: 3px;
      background: color-mix(in srgb, var(--accent) 24%, var(--surface));
      font-size: 12px;
      line-height: 28px;
      text-overflow: ellipsis;
      white-space: nowrap;
    }
    .bar button.thin {
      padding: 0;
    }
    .bar button.late {
      background: var(--bad-ground);
      color: var(--bad);
    }
    .bar button.broken {
      background: repeating-linear-gradient(45deg, var(--bad-ground) 0 4px, var(--surface) 4px 8px);
    }
    .bar button.hovered {
      background: color-mix(in srgb, var(--accent) 50%, var(--surface));
    }
    .bar button[aria-pressed="true"] {
      background: var(--accent);
      color: var(--on-accent);
    }
    .limit {
      position: absolute;
      top: -3px;
      bottom: -3px;
      width: 2px;
      background: var(--bad);
      pointer-events: none;
    }
    table {
      width: 100%;
      border-collapse: collapse;
      font-size: 12px;
    }
    th {
      position: sticky;
      top: 0;
      background: var(--surface);
      color: var(--dim);
      font-weight: normal;
    }
    th,
    td {
      padding: 1px 6px;
      text-align: right;
    }
    th:first-child,
    td:first-child {
      text-align: left;
    }
    tr.hovered td {
      background: var(--chosen);
    }
    tbody tr {
      cursor: pointer;
    }
    .bad {
      color: var(--bad);
    }
    :host {
      max-height: 42vh;
      overflow: auto;
      padding: 8px 12px;
      font-variant-numeric: tabular-nums;
    }
    .said {
      min-height: 20px;
      font-size: 12px;
    }
    summary {
      font-size: 12px;
      color: var(--dim);
    }
    @media (max-width: 719px) {
      :host {
        padding: 4px 8px;
      }
      .said:empty {
        display: none;
      }
      th,
      td {
        padding: 1px 3px;
      }
    }
  `;

  @state() private open = false;

  override render() {
    const texts = t().strip;
    const found = preview.value;
    const there = mission.value;
    if (there === null) return nothing;
    if (found === null || found.ways.length === 0) {
      const reckoned = previewRefused.value ?? (missionHasErrors.value ? texts.broken : texts.outdated);
      return html`<p class="dim said">${there.tasks.length === 0 ? texts.empty : reckoned}</p>`;
    }
    const legs = legsOf(found, there);
    const limit = there.max_duration ?? null;
    return html`<section aria-label=${texts.title}>
      <argo-totals .found=${found}></argo-totals>
      ${barView(legs, limit)}
      <p class="said" aria-live="off">${pointedAt(legs)}</p>
      <details @toggle=${(event: Event) => (this.open = (event.target as HTMLDetailsElement).open)}>
        <summary>${texts.table}</summary>
        ${this.open ? legTable(legs, limit) : nothing}
      </details>
    </section>`;
  }
}

/** Describe the leg under the pointer. */
function pointedAt(legs: readonly Leg[]) {
  const leg = legs.find((one) => one.way === hoveredLeg.value);
  return leg === undefined ? nothing : (leg.problem === null ? legWords(leg) : said(leg.problem.text, leg.problem.wording));
}

/** Render the legs as bars; their widths show the times. */
function barView(legs: readonly Leg[], limit: number | null) {
  const last = legs.at(-1);
  const end = last === undefined ? 0 : last.start + last.time;
  const whole = Math.max(end, limit !== null && limit < 3 * end ? limit : 0, 1e-9);
  const chosen = new Set(selection.value.filter(isTaskKey).map(nameOfKey));
  return html`<div class="bar" @pointerleave=${() => (hoveredLeg.value = null)}>
    ${mergedLegs(legs, MOST_BARS).map((leg) => {
      const part = (100 * leg.time) / whole;
      const marks = [
        leg.problem !== null ? "broken" : isTooLate(leg, limit) ? "late" : "",
        hoveredLeg.value === leg.way ? "hovered" : "",
        part < 4 ? "thin" : "",
      ];
      return html`<button
        class=${marks.join(" ")}
        data-task=${leg.task}
        aria-label=${legWords(leg)}
        aria-pressed=${chosen.has(leg.task)}
        ${styled({ width: `calc(${part}% - 1px)` })}
        @pointerenter=${() => (hoveredLeg.value = leg.way)}
        @focus=${() => (hoveredLeg.value = leg.way)}
        @blur=${() => (hoveredLeg.value = null)}
        @click=${() => select([taskKey(leg.task)])}
      >
        ${part < 2 ? nothing : part < 4 ? numberOf(leg.task) : taskLabel(leg.task)}
      </button>`;
    })}
    ${limit !== null && limit <= whole
      ? html`<span class="limit" ${styled({ left: `${(100 * limit) / whole}%` })}></span>`
      : nothing}
  </div>`;
}

/** Describe a leg. */
function legWords({ task, time, distance, climb, energy }: Leg): string {
  const used = share(energy, world.value?.robot.battery ?? 0);
  return t().strip.leg(taskLabel(task), seconds(time), metres(distance), metres(climb), used);
}

/** Render the legs as table rows. */
function legTable(legs: readonly Leg[], limit: number | null) {
  const texts = t().strip;
  return html`<table>
      <thead>
        <tr>
          <th scope="col">${texts.task}</th>
          <th scope="col">${texts.time}</th>
          <th scope="col">${texts.distance}</th>
          <th scope="col">${texts.climb}</th>
          <th scope="col">${texts.battery}</th>
        </tr>
      </thead>
      <tbody>
        ${legs.slice(0, MOST_ROWS).map(
          (leg) =>
            html`<tr
              class=${hoveredLeg.value === leg.way ? "hovered" : ""}
              title=${leg.problem === null ? nothing : said(leg.problem.text, leg.problem.wording)}
              @pointerenter=${() => (hoveredLeg.value = leg.way)}
              @pointerleave=${() => (hoveredLeg.value = null)}
              @click=${() => select([taskKey(leg.task)])}
            >
              <td>${taskLabel(leg.task)}</td>
              <td class=${isTooLate(leg, limit) ? "bad" : ""}>${seconds(leg.time)}</td>
              <td>${metres(leg.distance)}</td>
              <td>${metres(leg.climb)}</td>
              <td>${share(leg.energy, world.value?.robot.battery ?? 0)}</td>
            </tr>`,
        )}
      </tbody>
    </table>`;
}
