/** At a glance: who has the robot, what it does, how far it is. */

import type { Outcome } from "../model/replay";
import { shownMode, type ShownMode } from "../model/run-mode";
import { mission, planId, revision } from "../state/plan";
import { robotConnected, shownRun, shownRunState, shownTime } from "../state/run";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { icon, type Icon } from "../ui/icons";
import { styled } from "../ui/styled";
import { percent } from "../ui/figures";
import { modeWords } from "./mode-words";
import { parts } from "./parts";

const SIGNS: Record<ShownMode, Icon> = {
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
/** Of the battery: below it a robot should be on its way home. */
const LOW_CHARGE = 0.2;

@customElement("argo-run-band")
export class RunBand extends PageElement {
  static override styles = [
    parts,
    css`
      /* Who has the robot stays in sight, however far down somebody looks. */
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
      .stopping {
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
    const mode = shownMode(run);
    const past = shownTime.value !== null;
    return html`<div class="band ${past ? "past" : mode}" id="mode" data-mode=${mode} role="status">
        ${icon(past ? "clock" : SIGNS[mode], 26)}
        <div class="grow">
          <p class="word">${past ? texts.pastShown : modeWords(run)}</p>
          <p class="what">${this.doing()}</p>
        </div>
      </div>
      ${run.problem ? html`<p class="problem">${run.problem}</p>` : nothing}
      ${typeof run.silent_since === "number"
        ? html`<p class="problem">${texts.silent(t().words.seconds(run.silent_since))}</p>`
        : nothing}
      ${robotConnected.value ? nothing : html`<p class="problem">${texts.notConnected}</p>`}
      <dl>
        ${this.row(texts.time, now?.t ?? run.t, run.max_duration ?? null)} ${this.charge()}
        ${this.tasks()}
      </dl>`;
  }

  private doing() {
    const run = shownRunState.value;
    const now = shownRun.value;
    const texts = t().run;
    if (run === null) return "";
    if (run.status === "ended" && shownTime.value === null)
      return run.headline ? `${run.headline.word}: ${run.headline.text}` : "";
    const said: string[] = [];
    if (run.reaction && now?.live) said.push(texts.reactsTo(t().words.event[run.reaction]));
    const task = now?.task ?? null;
    if (task === null) said.push(run.status === "running" ? texts.standing : "");
    else said.push(run.by_hand && now?.live ? texts.byHandAt(task) : texts.at(task));
    if (now?.live)
      for (const [group, round] of Object.entries(run.rounds ?? {})) said.push(texts.round(group, round));
    return said.filter(Boolean).join(" · ");
  }

  private row(name: string, value: number, limit: number | null) {
    const seconds = (s: number) => t().words.seconds(s);
    const said = limit === null ? seconds(value) : t().run.ofLimit(seconds(value), seconds(limit));
    const part = limit === null ? 0 : value / limit;
    return html`<dt>${name}</dt>
      ${limit === null ? html`<dd></dd>` : this.gauge(part, part >= 1)}
      <dd id="time">${said}</dd>`;
  }

  private charge() {
    const charge = shownRun.value?.charge ?? null;
    if (charge === null) return nothing;
    return html`<dt>${t().run.battery}</dt>
      ${this.gauge(charge, charge < LOW_CHARGE)}
      <dd id="charge">${percent(charge)}</dd>`;
  }

  private tasks() {
    const run = shownRunState.value;
    const now = shownRun.value;
    const there = mission.value;
    if (run === null || now === null || there === null || run.plan !== planId.value) return nothing;
    const all = there.tasks.filter((task) => task.action !== "START");
    const done = all.filter((task) => ["done", "by hand"].includes(now.outcomes.get(task.name) ?? ""));
    const broken = all.some((task) => now.outcomes.get(task.name) === "failed");
    // Of a mission that was changed since, nobody here knows how many tasks it had.
    if (run.revision !== revision.value)
      return html`<dt>${t().frame.tasks}</dt>
        <dd></dd>
        <dd id="done">${t().run.tasksDoneOnly(doneOf(now.outcomes))}</dd>`;
    return html`<dt>${t().frame.tasks}</dt>
      ${this.gauge(all.length === 0 ? 0 : done.length / all.length, broken)}
      <dd id="done">${t().run.tasksDone(done.length, all.length)}</dd>`;
  }

  private gauge(part: number, broken: boolean) {
    const width = `${Math.min(100, Math.max(0, 100 * part))}%`;
    return html`<dd class="gauge ${broken ? "broken" : ""}" aria-hidden="true">
      <div ${styled({ width })}></div>
    </dd>`;
  }
}

function doneOf(outcomes: ReadonlyMap<string, Outcome>): number {
  return [...outcomes.values()].filter((one) => one === "done" || one === "by hand").length;
}
