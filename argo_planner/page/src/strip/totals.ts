/** Totals of time and battery with their limits, their bounds over all executions, and the execution with the
 * highest value. */

import type { PreviewedMission } from "../api/types";
import { boundsOf, withLimit, type BoundShown, type LimitedValue } from "../model/legs";
import { taskKey } from "../model/outline";
import { analysis, missionHasErrors, mission, revision, select } from "../state/plan";
import { previewIsNew } from "../state/preview";
import { groupLabel, taskLabel } from "../state/task-labels";
import { world } from "../state/world";
import { t } from "../texts";
import { saidAll } from "../texts/messages";
import { css, customElement, html, nothing, PageElement, property, state } from "../ui/element";
import { leastSeconds, metres, mostSeconds, seconds, share } from "../ui/figures";
import { icon } from "../ui/icons";

@customElement("argo-totals")
export class StripTotals extends PageElement {
  static override styles = css`
    .totals,
    .once {
      display: flex;
      flex-wrap: wrap;
      align-items: baseline;
      gap: 0 14px;
      min-height: 24px; /* also while nothing is known: what is below does not move */
      line-height: 24px;
    }
    .once {
      min-height: 20px;
      line-height: 20px;
      font-size: 12px;
    }
    .totals b {
      font-size: 15px;
    }
    .bad,
    .bad b {
      color: var(--bad);
    }
    .warn,
    .warn b {
      color: var(--warn);
    }
    .totals button {
      display: inline;
      min-height: 0;
      padding: 0;
      border: 0;
      text-decoration: underline dotted;
      text-underline-offset: 3px;
    }
    .old {
      opacity: 0.6;
    }
    ol {
      display: flex;
      flex-wrap: wrap;
      gap: 4px;
      margin: 4px 0;
    }
    li button {
      min-height: 24px;
      padding: 0 8px;
      font-size: 12px;
    }
  `;

  @property({ attribute: false }) found: PreviewedMission | null = null;
  @state() private path: BoundShown["kind"] | null = null;

  override render() {
    const { found } = this;
    if (found === null) return nothing;
    const texts = t().strip;
    const time = withLimit(found.time, mission.value?.max_duration ?? null);
    const energy = withLimit(found.energy, battery());
    const bounds = boundsOf(analysis.value, { time: time.limit, energy: energy.limit });
    const old = !previewIsNew.value;
    const single = bounds.every((bound) => isOnly(bound, bound.kind === "time" ? time : energy)) && !isPart(found);
    return html`<div class="totals">
        ${bounds.length === 0 && analysis.value?.revision !== revision.value
          ? html`<span class="dim">${texts.mission} ${texts.outdated}</span>`
          : nothing}
        ${bounds.map((bound) => this.bound(bound, bound.kind === "time" ? time : energy))}
      </div>
      <div class="once ${old ? "old" : ""}">
        ${single && bounds.length > 0
          ? nothing
          : html`<span class="dim">${texts.once}</span> ${this.total("time", time, seconds)}
              ${this.total("energy", energy, (wh) => share(wh, battery()))}`}
        <span>${texts.distance} <b id="total-distance">${metres(found.distance)}</b></span>
        <span>${texts.climb} <b id="total-climb">${metres(found.climb)}</b></span>
        ${saidAll(found.at_least, found.at_least_wording).map((least) => html`<span class="dim">${icon("clock", 13)} ${least}</span>`)}
        ${old ? html`<span role="status">${missionHasErrors.value ? texts.before : texts.outdated}</span>` : nothing}
      </div>
      ${this.witness(bounds)}`;
  }

  /** Render a total of the drawn path, which has each task once. */
  private total(kind: BoundShown["kind"], of: LimitedValue, write: (value: number) => string) {
    const texts = t().strip;
    const isTime = kind === "time";
    const problem = isTime ? texts.tooLong : texts.tooMuch;
    return html`<span class=${of.broken ? "bad" : ""} title=${of.broken ? problem : nothing}>
      ${of.broken ? icon("warning", 14) : nothing} ${isTime ? texts.time : texts.battery}
      <b id=${`total-${kind}`}>${write(of.value)}</b>
    </span>`;
  }

  /** Render the bounds over all executions of the mission; a click shows the execution with the highest value. */
  private bound(bound: BoundShown, { limit }: LimitedValue) {
    const texts = t().strip;
    const isTime = bound.kind === "time";
    const energy = (wh: number) => share(wh, battery());
    const [writeLeast, writeMost] = isTime ? [leastSeconds, mostSeconds] : [energy, energy];
    const old = analysis.value?.revision !== revision.value;
    const least = bound.least === null ? texts.noBound : writeLeast(bound.least);
    const most = bound.most === null ? texts.noBound : writeMost(bound.most);
    const never = limit !== null && bound.least !== null && bound.least > limit;
    return html`<span class="${never ? "bad" : bound.broken ? "warn" : ""} ${old ? "old" : ""}">
      ${bound.broken ? icon("warning", 14) : nothing} ${isTime ? texts.mission : texts.battery}
      <button
        class="bare"
        title=${old ? texts.outdated : texts.allPaths}
        aria-expanded=${this.path === bound.kind}
        ?disabled=${bound.path.length === 0}
        @click=${() => this.showPath(bound)}
      >
        <b>${texts.between(least, most)}</b>
      </button>
      ${isTime && limit !== null ? `/ ${seconds(limit)}` : nothing}
    </span>`;
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
    const write = bound.kind === "time" ? mostSeconds : (wh: number) => share(wh, battery());
    return html`<p class="dim">${texts.path(bound.most === null ? texts.noBound : write(bound.most))}</p>
      <ol>
        ${bound.path.map((part) => {
          const name =
            part.task === null
              ? texts.rounds(groupLabel(part.group ?? ""), part.rounds)
              : part.missed
                ? texts.missed(taskLabel(part.task))
                : taskLabel(part.task);
          return html`<li>
            <button ?disabled=${part.task === null} @click=${() => part.task !== null && select([taskKey(part.task)])}>
              ${name} <span class="dim">${write(part.until)}</span>
            </button>
          </li>`;
        })}
      </ol>`;
  }
}

/** Return whether all executions have the value of the drawn path. */
function isOnly({ least, most }: BoundShown, { value }: LimitedValue): boolean {
  return [least, most].every((bound) => bound !== null && Math.abs(bound - value) <= 0.001 * Math.abs(value));
}

/** Return whether the mission may take more than each task once, which the totals do not include. */
function isPart(found: PreviewedMission): boolean {
  const groups = mission.value?.groups ?? [];
  return found.at_least.length > 0 || groups.some((group) => group.max_repeat_count !== 1);
}

/** Return the battery's capacity (Wh). */
function battery(): number {
  return world.value?.robot.battery ?? 0;
}
