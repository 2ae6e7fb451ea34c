/** The progress and result of a search, beside the current order. */

import { svg } from "lit";

import type { OrderJob } from "../api/types";
import { convergence } from "../model/curves";
import { compareOrders, type ComparedTask } from "../model/order-comparison";
import { taskKey } from "../model/outline";
import { select, tasksByName } from "../state/plan";
import { mayPlan } from "../state/session";
import { taskLabel } from "../state/task-labels";
import { t } from "../texts";
import { said, saidAll, saidIfAny } from "../texts/messages";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { leastSeconds, percent, seconds } from "../ui/figures";
import { icon } from "../ui/icons";
import { acceptOrder, cancelSearch, job, jobIsStale, closeSearch } from "./search";

const [WIDTH, HEIGHT] = [300, 90];

@customElement("argo-route-result")
export class RouteResult extends PageElement {
  static override styles = css`
    section {
      display: grid;
      gap: 10px;
    }
    figure {
      margin: 0;
    }
    svg.chart {
      display: block;
      width: 100%;
      height: 90px;
      border: 1px solid var(--line);
      border-radius: 6px;
      background: var(--sunken);
    }
    .chart path {
      fill: none;
      stroke-width: 2;
      vector-effect: non-scaling-stroke;
    }
    .best {
      stroke: var(--accent);
    }
    .bound {
      stroke: var(--good);
      stroke-dasharray: 5 4;
    }
    figcaption {
      display: flex;
      flex-wrap: wrap;
      gap: 2px 12px;
      font-size: 12px;
      font-variant-numeric: tabular-nums;
    }
    .key::before {
      content: "";
      display: inline-block;
      width: 16px;
      margin-right: 4px;
      border-top: 2px solid var(--accent);
      vertical-align: middle;
    }
    .key.low::before {
      border-top: 2px dashed var(--good);
    }
    .saving {
      font-size: 16px;
      font-weight: 600;
      color: var(--good);
    }
    .both,
    .decide {
      display: grid;
      grid-template-columns: 1fr 1fr;
      gap: 8px;
    }
    h3 span {
      display: block;
      font-size: 16px;
      font-variant-numeric: tabular-nums;
    }
    ol {
      margin-top: 4px;
      counter-reset: place;
    }
    li button {
      justify-content: start;
      width: 100%;
      min-height: 26px;
      padding: 0 6px;
      overflow: hidden;
      text-align: left;
      text-overflow: ellipsis;
      font-size: 13px;
    }
    .both li {
      counter-increment: place;
      border-left: 3px solid transparent;
    }
    .both li button::before {
      content: counter(place);
      color: var(--dim);
      font-size: 11px;
    }
    .both li.moved {
      border-left-color: var(--accent);
      background: var(--chosen);
    }
    .both li.out {
      border-left-color: var(--bad);
      text-decoration: line-through;
      color: var(--bad);
    }
    .warn {
      padding: 8px;
      border-radius: var(--round);
      background: var(--warn-ground);
      color: var(--warn);
    }
    .decide button {
      min-height: 40px;
    }
    ul {
      margin-top: 4px;
      padding-left: 18px;
      list-style: disc;
      font-size: 13px;
    }
  `;

  override render() {
    const now = job.value;
    if (now === null) return nothing;
    const texts = t().route;
    return html`<section aria-label=${texts.found} data-state=${now.state}>
      ${this.chart(now)}
      ${now.state === "running"
        ? html`<button id="cancel" ?disabled=${!mayPlan()} @click=${cancelSearch}>${icon("stop")} ${texts.cancel}</button>`
        : nothing}
      ${now.state === "cancelled" ? html`<p class="dim">${texts.cancelled}</p>` : nothing}
      ${now.state === "failed" ? html`<p class="warn">${texts.noneFound}: ${saidIfAny(now.problem, now.problem_wording)}</p>` : nothing}
      ${now.state === "done" && now.problem ? html`<p class="warn">${said(now.problem, now.problem_wording)}</p>` : nothing}
      ${now.state === "done" ? this.done(now) : nothing}
    </section>`;
  }

  private chart(now: OrderJob) {
    const texts = t().route;
    const lines = convergence(now.progress, WIDTH, HEIGHT);
    const last = now.progress.at(-1);
    const best = last?.best ?? null;
    const gap = best !== null && last !== undefined && best > 0 ? (best - last.bound) / best : null;
    return html`<figure>
      <svg class="chart" viewBox="0 0 ${WIDTH} ${HEIGHT}" preserveAspectRatio="none" role="img" aria-label=${texts.chart}>
        ${lines === null ? nothing : svg`<path class="bound" d=${lines.bound} /><path class="best" d=${lines.best} />`}
      </svg>
      <figcaption>
        <span class="key">${texts.best}: <b>${best === null ? texts.untilNow : seconds(best)}</b></span>
        <span class="key low">${texts.bound}: <b>${last === undefined ? texts.untilNow : leastSeconds(last.bound)}</b></span>
        <span class="dim" role="status">
          ${now.state === "running" ? texts.searching : nothing}
          ${gap === null || gap < 0.0005 ? nothing : texts.gap(percent(gap, 1))}
        </span>
      </figcaption>
    </figure>`;
  }

  private done(now: OrderJob) {
    const texts = t().route;
    const found = now.found;
    if (!found) return nothing;
    const order = found.reordering;
    if (!order)
      return html`<p class="warn">${texts.noneFound}${found.why_none ? `: ${said(found.why_none, found.why_none_wording)}` : ""}</p>
        ${this.reasons(saidAll(found.reasons, found.reasons_wording))}`;
    const out = new Set(found.left_out);
    const lists = compareOrders(order.written, order.order);
    const same = found.left_out.length === 0 && lists.after.every((one) => !one.moved);
    const saved = order.written_duration - order.duration;
    return html`<p class="saving">
        ${saved > 0.5
          ? texts.saves(seconds(saved), percent(saved / order.written_duration, 1))
          : saved < -0.5
            ? texts.takesMore(seconds(-saved))
            : texts.saysNothing}
      </p>
      <p class="dim">${texts.wholeSeconds}</p>
      ${order.proven ? html`<p class="dim">${icon("check", 14)} ${texts.proven}</p>` : nothing}
      <div class="both">
        <div>
          <h3>${texts.asWritten}<span>${seconds(order.written_duration)}</span></h3>
          ${this.order(lists.before, out)}
        </div>
        <div>
          <h3>${texts.suggested}<span>${seconds(order.duration)}</span></h3>
          ${this.order(lists.after, out)}
        </div>
      </div>
      ${found.left_out.length > 0
        ? html`<p class="warn">${texts.leftOut}: ${found.left_out.map(taskLabel).join(", ")}</p>`
        : nothing}
      ${found.warning ? html`<p class="warn">${said(found.warning, found.warning_wording)}</p>` : nothing} ${this.reasons(saidAll(found.reasons, found.reasons_wording))}
      ${jobIsStale.value ? html`<p class="warn" role="alert">${texts.stale}</p>` : nothing}
      <div class="decide">
        <button class="main" id="accept" ?disabled=${!mayPlan() || jobIsStale.value || same} @click=${acceptOrder}>
          ${icon("check")} ${texts.accept}
        </button>
        <button id="leave" @click=${closeSearch}>${texts.leave}</button>
      </div>`;
  }

  private order(places: readonly ComparedTask[], out: ReadonlySet<string>) {
    return html`<ol>
      ${places.map(
        ({ name, moved }) =>
          html`<li class=${out.has(name) ? "out" : moved ? "moved" : ""}>
            <button
              class="bare"
              title=${moved ? `${taskLabel(name)}: ${t().route.moved}` : taskLabel(name)}
              @click=${() => tasksByName.value.has(name) && select([taskKey(name)])}
            >
              ${taskLabel(name)}
            </button>
          </li>`,
      )}
    </ol>`;
  }

  private reasons(lines: readonly string[]) {
    if (lines.length === 0) return nothing;
    return html`<details>
      <summary>${t().route.reasons}</summary>
      <ul>
        ${lines.map((one) => html`<li>${one}</li>`)}
      </ul>
    </details>`;
  }
}
