/** The run at a glance: who controls the robot, what it does, and its progress. */

import type { Outcome } from "../model/replay";
import { shownMode, type ShownMode } from "../model/run-mode";
import { mission, planId, revision } from "../state/plan";
import { presentMode, shownRun, shownRunState, shownTime } from "../state/run";
import { t } from "../texts";
import { said } from "../texts/messages";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { icon, type Icon } from "../ui/icons";
import { styled } from "../ui/styled";
import { percent, seconds } from "../ui/figures";
import { runTaskLabel } from "./labels";
import { knownModeWords, modeWords } from "./mode-words";
import { parts } from "./parts";

const SIGNS: Record<ShownMode, Icon> = {
  unknown: "question",
  preparing: "clock",
  autonomous: "play",
  stopping: "pause",
  paused: "pause",
  supervised: "hand",
  reacting: "reaction",
  interrupted: "warning",
  good: "check",
  notice: "flag",
  bad: "warning",
};
/** Share of the battery below which the robot should return. */
const LOW_CHARGE = 0.2;

@customElement("argo-run-band")
export class RunBand extends PageElement {
  static override styles = [
    parts,
    css`
      /* Who controls the robot stays visible while the panel scrolls. */
      :host {
        display: contents;
      }
      .band {
        position: sticky;
        z-index: 2;
        top: 0;
        display: flex;
        align-items: center;
        gap: 10px;
        padding: 10px 12px;
        border-radius: var(--round);
        border: 1px solid var(--tone);
        border-left: 6px solid var(--tone);
        background: color-mix(in srgb, var(--tone) 12%, var(--surface));
      }
      .band svg {
        color: var(--tone);
      }
      .word {
        font-size: 16px;
        font-weight: 600;
      }
      .what {
        overflow-wrap: anywhere;
      }
      .preparing,
      .unknown,
      .past {
        --tone: var(--dim);
      }
      .autonomous {
        --tone: var(--accent);
      }
      .stopping,
      .paused,
      .notice {
        --tone: var(--warn);
      }
      .supervised {
        --tone: var(--person);
      }
      .reacting,
      .interrupted,
      .bad {
        --tone: var(--bad);
      }
      .good {
        --tone: var(--good);
      }
      .paused,
      .stopping,
      .unknown {
        border-style: dashed;
        border-left-style: solid;
      }
      dl {
        display: grid;
        grid-template-columns: auto 1fr auto;
        align-items: center;
        gap: 4px 8px;
        margin: -6px 0 0;
        font-size: 13px;
      }
      dt {
        color: var(--dim);
      }
      dd {
        margin: 0;
        font-variant-numeric: tabular-nums;
        text-align: right;
      }
      .gauge {
        height: 8px;
        border-radius: 4px;
        background: var(--sunken);
        overflow: hidden;
      }
      .gauge div {
        height: 100%;
        border-radius: 4px;
        background: var(--accent);
      }
      .gauge.broken div {
        background: var(--bad);
      }
      .broken + dd {
        color: var(--bad);
        font-weight: 600;
      }
      .problem {
        color: var(--bad);
        overflow-wrap: anywhere;
      }
    `,
  ];

  override render() {
    const run = shownRunState.value;
    if (run === null) return nothing;
    const texts = t().run;
    const now = shownRun.value;
    const past = shownTime.value !== null;
    const mode = past ? (now?.mode ?? shownMode(run)) : presentMode(run);
    return html`<div class="band ${past ? "past" : mode}" id="mode" data-mode=${mode} role="status">
        ${icon(past ? "clock" : SIGNS[mode], 26)}
        <div class="grow">
          <p class="word">${past ? texts.pastShown : modeWords(run)}</p>
          <p class="what">${this.doing()}</p>
        </div>
      </div>
      ${run.problem && !past ? html`<p class="problem">${said(run.problem, run.problem_wording)}</p>` : nothing}
      ${typeof run.silent_since === "number" && !past
        ? html`<p class="problem">${texts.silent(t().words.seconds(run.silent_since))}</p>`
        : nothing}
      <dl>
        ${this.time(now?.t ?? run.t, run.max_duration ?? null)} ${this.charge()} ${this.tasks()}
      </dl>`;
  }

  private doing() {
    const run = shownRunState.value;
    const now = shownRun.value;
    const texts = t().run;
    if (run === null) return "";
    if (run.status === "ended" && shownTime.value === null)
      return run.headline ? t().verdict.headline(run.headline) : "";
    const text: string[] = [];
    if (shownTime.value !== null && now !== null) text.push(texts.modes[now.mode]);
    else if (presentMode(run) === "unknown") text.push(texts.lastKnown(knownModeWords(run)));
    if (run.reaction && now?.live) text.push(texts.reactsTo(t().words.event[run.reaction]));
    const task = now?.task ?? null;
    if (task === null) text.push(run.status === "running" ? texts.standing : "");
    else text.push(run.by_hand && now?.live ? texts.byHandAt(runTaskLabel(task)) : texts.at(runTaskLabel(task)));
    if (now?.live)
      for (const [group, round] of Object.entries(run.rounds ?? {})) text.push(texts.round(group, round));
    return text.filter(Boolean).join(" · ");
  }

  private time(value: number, limit: number | null) {
    const { time, ofLimit } = t().run;
    if (limit === null) return this.row("time", time, seconds(value));
    return this.row("time", time, ofLimit(seconds(value), seconds(limit)), value / limit, value >= limit);
  }

  private charge() {
    const charge = shownRun.value?.charge ?? null;
    if (charge === null) return nothing;
    return this.row("charge", t().run.battery, percent(charge), charge, charge < LOW_CHARGE);
  }

  private tasks() {
    const run = shownRunState.value;
    const now = shownRun.value;
    const there = mission.value;
    if (run === null || now === null || there === null || run.plan !== planId.value) return nothing;
    const all = there.tasks.filter((task) => task.action !== "START");
    const done = all.filter((task) => ["done", "by hand"].includes(now.outcomes.get(task.name) ?? ""));
    const broken = all.some((task) => now.outcomes.get(task.name) === "failed");
    // The number of tasks is unknown if the mission was changed after the run began.
    if (run.revision !== revision.value)
      return this.row("done", t().frame.tasks, t().run.tasksDoneOnly(doneOf(now.outcomes)));
    const part = all.length === 0 ? 0 : done.length / all.length;
    return this.row("done", t().frame.tasks, t().run.tasksDone(done.length, all.length), part, broken);
  }

  /** Render a value with its name, and as a `part` of its limit if that is known. */
  private row(id: string, name: string, text: string, part: number | null = null, broken = false) {
    const width = `${Math.min(100, Math.max(0, 100 * (part ?? 0)))}%`;
    return html`<dt>${name}</dt>
      ${part === null
        ? html`<dd></dd>`
        : html`<dd class="gauge ${broken ? "broken" : ""}" aria-hidden="true">
            <div ${styled({ width })}></div>
          </dd>`}
      <dd id=${id}>${text}</dd>`;
  }
}

function doneOf(outcomes: ReadonlyMap<string, Outcome>): number {
  return [...outcomes.values()].filter((one) => one === "done" || one === "by hand").length;
}
