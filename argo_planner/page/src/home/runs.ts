/** The run under way and the latest runs of all missions, each with a link to its mission at that run. */

import type { RunSummary } from "../api/types";
import { modeWords } from "../run/mode-words";
import { run, runIsOn } from "../state/run";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { dateAndTime, seconds } from "../ui/figures";
import { latestRuns, missionNames } from "./state";
import { endingMark, endingStyles } from "./ending";

@customElement("argo-latest-runs")
export class LatestRuns extends PageElement {
  static override styles = [
    endingStyles,
    css`
      li {
        padding: 7px 0;
        border-bottom: 1px solid var(--line);
        overflow-wrap: anywhere;
      }
      li.on {
        margin: 4px 0;
        padding: 8px 10px;
        border: 1px solid var(--line);
        border-left: 4px solid var(--accent);
        border-radius: 6px;
        background: var(--surface);
      }
      a {
        display: -webkit-box;
        overflow: hidden;
        -webkit-box-orient: vertical;
        -webkit-line-clamp: 2;
      }
      .when {
        color: var(--dim);
        font-size: 12px;
      }
      h2 {
        margin-bottom: 4px;
      }
    `,
  ];

  override render() {
    const texts = t().home;
    const all = latestRuns.value;
    return html`<section aria-labelledby="runs">
      <h2 id="runs">${texts.runs}</h2>
      ${all.length === 0 && !runIsOn.value ? html`<p class="dim">${texts.noRuns}</p>` : nothing}
      <ul>
        ${this.underWay()} ${all.filter((one) => !this.isUnderWay(one)).map((one) => this.row(one))}
      </ul>
    </section>`;
  }

  private isUnderWay(one: RunSummary): boolean {
    return runIsOn.value && run.value?.id === one.id;
  }

  private underWay() {
    const state = run.value;
    if (state === null || !runIsOn.value) return nothing;
    return html`<li class="on">
      ${this.link(state)}
      <div>${modeWords(state)} · ${seconds(state.t)}</div>
      <div class="when">${t().home.startedBy(state.by, dateAndTime(state.begun))}</div>
    </li>`;
  }

  private row(one: RunSummary) {
    return html`<li>
      ${this.link(one)}
      <div>${endingMark(one)} · ${seconds(one.t)}</div>
      <div class="when">${t().home.startedBy(one.by, dateAndTime(one.begun))}</div>
    </li>`;
  }

  /** Render a link to the run; without one if its mission is deleted. */
  private link(one: { readonly id: string; readonly plan: string; readonly name: string }) {
    const name = missionNames.value.get(one.plan);
    if (name === undefined) return html`<span>${one.name}</span> <span class="dim">${t().home.deletedMission}</span>`;
    return html`<a href=${`#/missions/${one.plan}/runs/${one.id}`}>${name}</a>`;
  }
}
