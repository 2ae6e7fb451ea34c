/** Times, distances, climbs and battery of the way, leg by leg and altogether, against the limits. */

import { boundsOf, gathered, isTooLate, legsOf, limited, type BoundShown, type Leg, type Limited } from "../model/legs";
import { isTaskKey, nameOfKey, taskKey } from "../model/outline";
import { analysis, findings, mission, revision, select, selection } from "../state/plan";
import { hoveredLeg, preview } from "../state/preview";
import { world } from "../state/world";
import { language, t } from "../texts";
import { css, customElement, html, look, nothing, PageElement, state } from "../ui/element";
import { icon } from "../ui/icons";
import { styled } from "../ui/styled";

const MOST_BARS = 250;
const MOST_ROWS = 1_000;

@customElement("argo-strip")
export class StripPanel extends PageElement {
  static override styles = [
    look,
    css`
      :host {
        max-height: 42vh;
        overflow: auto;
        padding: 8px 12px;
        font-variant-numeric: tabular-nums;
      }
      .totals {
        display: flex;
        flex-wrap: wrap;
        align-items: baseline;
        gap: 2px 18px;
      }
      .total b {
        font-size: 15px;
      }
      .bad,
      .bad b {
        color: var(--bad);
      }
      .warn {
        color: var(--warn);
      }
      .total button {
        display: inline;
        min-height: 0;
        padding: 0 4px;
        font-size: 12px;
        text-decoration: underline dotted;
        text-underline-offset: 3px;
      }
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
      .said {
        min-height: 20px;
        font-size: 12px;
      }
      .old {
        opacity: 0.6;
      }
      ol {
        display: flex;
        flex-wrap: wrap;
        gap: 4px;
        margin: 4px 0;
        padding: 0;
        list-style: none;
      }
      li button {
        min-height: 24px;
        padding: 0 8px;
        font-size: 12px;
      }
      summary {
        font-size: 12px;
        color: var(--dim);
        cursor: pointer;
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
      @media (max-width: 800px) {
        :host {
          padding: 4px 8px;
        }
        details,
        .said {
          display: none;
        }
      }
    `,
  ];

  @state() private open = false;
  @state() private path: BoundShown["kind"] | null = null;

  override render() {
    const texts = t().strip;
    const found = preview.value;
    const there = mission.value;
    if (there === null) return nothing;
    if (found === null || found.ways.length === 0) {
      const wrong = findings.value.diagnostics.some((one) => one.severity === "error");
      const said = there.tasks.length === 0 ? texts.empty : wrong ? texts.broken : texts.outdated;
      return html`<p class="dim said">${said}</p>`;
    }
    const legs = legsOf(found, there);
    const limit = there.max_duration ?? null;
    const time = limited(found.time, limit);
    const energy = limited(found.energy, world.value?.robot.battery);
    const bounds = boundsOf(analysis.value, { time: time.limit, energy: energy.limit });
    const atLeast = found.at_least.length > 0 ? "≥ " : "";
    return html`<section aria-label=${texts.title}>
      <div class="totals">
        ${this.total("time", atLeast + seconds(time.value), time, bounds)}
        ${this.total("energy", atLeast + this.share(energy.value), energy, bounds)}
        <span class="total">${texts.distance} <b id="total-distance">${metres(found.distance)}</b></span>
        <span class="total">${texts.climb} <b id="total-climb">${metres(found.climb)}</b></span>
        ${found.at_least.length > 0
          ? html`<span class="dim" title=${found.at_least.join("\n")}>${icon("clock", 13)} ${found.at_least[0]}</span>`
          : nothing}
      </div>
      ${this.witness(bounds)} ${this.bar(legs, limit)}
      <p class="said" aria-live="off">${this.pointedAt(legs)}</p>
      ${this.table(legs, limit)}
    </section>`;
  }

  private total(kind: BoundShown["kind"], said: string, of: Limited, bounds: readonly BoundShown[]) {
    const texts = t().strip;
    const isTime = kind === "time";
    const write = isTime ? seconds : (wh: number) => this.share(wh);
    const bound = bounds.find((one) => one.kind === kind);
    const problem = isTime ? texts.tooLong : texts.tooMuch;
    return html`<span class="total ${of.broken ? "bad" : ""}" title=${of.broken ? problem : nothing}>
      ${of.broken ? icon("warning", 14) : nothing} ${isTime ? texts.time : texts.battery}
      <b id=${`total-${kind}`}>${said}</b>
      ${isTime && of.limit !== null ? `/ ${write(of.limit)}` : nothing}
      ${bound === undefined ? nothing : this.bound(bound, write, said)}
    </span>`;
  }

  /** What it may be on any path; a click shows the path on which it is most. */
  private bound(bound: BoundShown, write: (value: number) => string, said: string) {
    const texts = t().strip;
    const old = analysis.value?.revision !== revision.value;
    const least = bound.least === null ? texts.noBound : write(bound.least);
    const most = bound.most === null ? texts.noBound : write(bound.most);
    return html`<button
      class="bare ${bound.broken ? "warn" : "dim"} ${old ? "old" : ""}"
      title=${old ? texts.outdated : texts.allPaths}
      aria-expanded=${this.path === bound.kind}
      ?disabled=${bound.path.length === 0}
      @click=${() => this.showPath(bound)}
    >
      ${bound.broken ? icon("warning", 12) : nothing}
      ${said === most && said === least ? icon("route", 14) : texts.between(least, most)}
      <span class="unseen">${texts.allPaths}</span>
    </button>`;
  }

  private showPath(bound: BoundShown): void {
    this.path = this.path === bound.kind ? null : bound.kind;
    if (this.path === null) return;
    const tasks = bound.path.flatMap((part) => (part.task === null ? [] : [taskKey(part.task)]));
    select([...new Set(tasks)]);
  }

  private witness(bounds: readonly BoundShown[]) {
    const bound = bounds.find((one) => one.kind === this.path);
    if (bound === undefined) return nothing;
    const texts = t().strip;
    const write = bound.kind === "time" ? seconds : (wh: number) => this.share(wh);
    return html`<p class="dim">${texts.path(bound.most === null ? texts.noBound : write(bound.most))}</p>
      <ol>
        ${bound.path.map((part) => {
          const name =
            part.task === null
              ? texts.rounds(part.group ?? "", part.rounds)
              : part.missed
                ? texts.missed(part.task)
                : part.task;
          return html`<li>
            <button ?disabled=${part.task === null} @click=${() => part.task !== null && select([taskKey(part.task)])}>
              ${name} <span class="dim">${write(part.until)}</span>
            </button>
          </li>`;
        })}
      </ol>`;
  }

  private bar(legs: readonly Leg[], limit: number | null) {
    const last = legs.at(-1);
    const end = last === undefined ? 0 : last.start + last.time;
    const whole = Math.max(end, limit !== null && limit < 3 * end ? limit : 0, 1e-9);
    const chosen = new Set(selection.value.filter(isTaskKey).map(nameOfKey));
    return html`<div class="bar" @pointerleave=${() => (hoveredLeg.value = null)}>
      ${gathered(legs, MOST_BARS).map((leg) => {
        const part = (100 * leg.time) / whole;
        const marks = [
          leg.problem !== null ? "broken" : isTooLate(leg, limit) ? "late" : "",
          hoveredLeg.value === leg.way ? "hovered" : "",
          part < 4 ? "thin" : "",
        ];
        return html`<button
          class=${marks.join(" ")}
          data-task=${leg.task}
          aria-label=${this.words(leg)}
          aria-pressed=${chosen.has(leg.task)}
          ${styled({ width: `calc(${part}% - 1px)` })}
          @pointerenter=${() => (hoveredLeg.value = leg.way)}
          @focus=${() => (hoveredLeg.value = leg.way)}
          @blur=${() => (hoveredLeg.value = null)}
          @click=${() => select([taskKey(leg.task)])}
        >
          ${part < 4 ? nothing : leg.task}
        </button>`;
      })}
      ${limit !== null && limit <= whole
        ? html`<span class="limit" ${styled({ left: `${(100 * limit) / whole}%` })}></span>`
        : nothing}
    </div>`;
  }

  private pointedAt(legs: readonly Leg[]) {
    const leg = legs.find((one) => one.way === hoveredLeg.value);
    return leg === undefined ? nothing : (leg.problem ?? this.words(leg));
  }

  private table(legs: readonly Leg[], limit: number | null) {
    const texts = t().strip;
    return html`<details @toggle=${(event: Event) => (this.open = (event.target as HTMLDetailsElement).open)}>
      <summary>${texts.table}</summary>
      ${this.open ? this.rows(legs, limit) : nothing}
    </details>`;
  }

  private rows(legs: readonly Leg[], limit: number | null) {
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
                title=${leg.problem ?? nothing}
                @pointerenter=${() => (hoveredLeg.value = leg.way)}
                @pointerleave=${() => (hoveredLeg.value = null)}
                @click=${() => select([taskKey(leg.task)])}
              >
                <td>${leg.task}</td>
                <td class=${isTooLate(leg, limit) ? "bad" : ""}>${seconds(leg.time)}</td>
                <td>${metres(leg.distance)}</td>
                <td>${metres(leg.climb)}</td>
                <td>${this.share(leg.energy)}</td>
              </tr>`,
          )}
        </tbody>
      </table>`;
  }

  private words(leg: Leg): string {
    const texts = t().strip;
    const { task, time, distance, climb, energy } = leg;
    return texts.leg(task, seconds(time), metres(distance), metres(climb), this.share(energy));
  }

  /** Wh as a share of what the battery gives, which says more. */
  private share(wh: number): string {
    const whole = world.value?.robot.battery ?? 0;
    if (whole <= 0) return `${figure(wh, 0)} Wh`;
    const part = (100 * wh) / whole;
    return `${figure(part, part < 10 ? 1 : 0)} %`;
  }
}

function seconds(s: number): string {
  return t().words.seconds(s);
}

function metres(m: number): string {
  return `${figure(m, m < 10 ? 1 : 0)} m`;
}

function figure(value: number, digits: number): string {
  return value.toLocaleString(language.value, { maximumFractionDigits: digits });
}
