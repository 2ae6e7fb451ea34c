/** The result of an evaluation: success rate and interval, results by fault, failed runs. */

import { svg } from "lit";

import type { EvaluationJob, EvaluationStanding, FailedRun, RateTold } from "../api/types";
import { rateCurve } from "../model/curves";
import { faultsByCase, givenFields } from "../model/faults";
import { faultSummary } from "../run/fault-words";
import { mayPlan } from "../state/session";
import { t } from "../texts";
import { said } from "../texts/messages";
import { options, valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { dateAndTime, figure, percent, seconds } from "../ui/figures";
import { icon } from "../ui/icons";
import { styled } from "../ui/styled";
import {
  cancelEvaluation,
  chooseEvaluation,
  evaluation,
  evaluationIsStale,
  evaluations,
  deleteEvaluation,
  resumeEvaluation,
  replayRun,
  replaying,
} from "./evaluation";

const [WIDTH, HEIGHT] = [300, 110];
@customElement("argo-evaluate-result")
export class EvaluateResult extends PageElement {
  static override styles = css`
    section {
      display: grid;
      grid-template-columns: minmax(0, 1fr);
      gap: 10px;
    }
    .rate {
      font-size: 26px;
      font-weight: 600;
      font-variant-numeric: tabular-nums;
    }
    .rate span {
      font-size: 14px;
      font-weight: 400;
    }
    .numbers {
      font-size: 13px;
      font-variant-numeric: tabular-nums;
    }
    progress {
      width: 100%;
      height: 8px;
      accent-color: var(--accent);
    }
    figure {
      margin: 0;
    }
    svg.chart {
      display: block;
      width: 100%;
      height: 110px;
      border: 1px solid var(--line);
      border-radius: 6px;
      background: var(--sunken);
    }
    .band {
      fill: color-mix(in srgb, var(--accent) 25%, transparent);
    }
    .line {
      fill: none;
      stroke: var(--accent);
      stroke-width: 2;
      vector-effect: non-scaling-stroke;
    }
    .wanted {
      stroke: var(--warn);
      stroke-width: 1;
      stroke-dasharray: 5 4;
      vector-effect: non-scaling-stroke;
    }
    figcaption,
    .small {
      font-size: 12px;
      color: var(--dim);
    }
    .axis {
      display: flex;
      justify-content: space-between;
    }
    .verdict {
      padding: 8px;
      border-radius: var(--round);
      border-left: 4px solid var(--warn);
      background: var(--sunken);
    }
    .verdict.met {
      border-left-color: var(--good);
    }
    .verdict.missed {
      border-left-color: var(--bad);
    }
    table {
      width: 100%;
      border-collapse: collapse;
      font-size: 13px;
    }
    th {
      text-align: left;
      font-weight: 400;
    }
    caption {
      text-align: left;
    }
    thead th:not(:first-child) {
      text-align: right;
    }
    thead th {
      color: var(--dim);
      font-size: 12px;
    }
    td {
      text-align: right;
      font-variant-numeric: tabular-nums;
      white-space: nowrap;
    }
    tbody th {
      overflow-wrap: anywhere;
    }
    .bar {
      position: relative;
      height: 10px;
      margin-top: 2px;
      border-radius: 3px;
      background: var(--sunken);
    }
    .bar div {
      position: absolute;
      top: 0;
      bottom: 0;
    }
    .bar .span {
      border-radius: 3px;
      background: color-mix(in srgb, var(--accent) 45%, transparent);
    }
    .bar .mark {
      width: 3px;
      margin-left: -1px;
      background: var(--accent);
    }
    li button {
      display: grid;
      justify-content: stretch;
      width: 100%;
      padding: 6px 8px;
      text-align: left;
    }
    li .reason {
      color: var(--dim);
      font-size: 12px;
      overflow-wrap: anywhere;
    }
    li b {
      font-weight: 600;
    }
    .warn {
      padding: 8px;
      border-radius: var(--round);
      background: var(--warn-ground);
      color: var(--warn);
      overflow-wrap: anywhere;
    }
  `;

  override render() {
    const job = evaluation.value;
    if (job === null) return nothing;
    const texts = t().evaluate;
    const standing = job.standing ?? null;
    const why = mayPlan() ? nothing : texts.mayNotPlan;
    const resumable = job.state === "cancelled" || job.state === "interrupted";
    const button = (id: string, sign: unknown, label: string, act: (id: string) => unknown, look = "") =>
      html`<button id=${id} class=${look} title=${why} ?disabled=${!mayPlan()} @click=${() => act(job.id)}>
        ${sign} ${label}
      </button>`;
    return html`<section aria-label=${texts.found} data-state=${job.state}>
      ${this.choice(job)}
      <h2 role="status">${texts.found}: ${texts.states[job.state]}</h2>
      ${job.problem ? html`<p class="warn">${said(job.problem, job.problem_wording)}</p>` : nothing}
      ${evaluationIsStale.value ? html`<p class="small">${texts.stale}</p>` : nothing}
      ${job.state === "running" && standing === null ? html`<progress></progress>` : nothing}
      ${standing === null ? nothing : this.standing(job, standing)}
      ${job.state === "running" ? button("cancel", icon("stop"), texts.cancel, cancelEvaluation) : nothing}
      ${resumable ? button("go-on", icon("play"), texts.goOn, resumeEvaluation) : nothing}
      ${job.state === "done" || (resumable && standing !== null)
        ? html`<a href=${`/api/jobs/${job.id}/report`} target="_blank" rel="noopener">
            ${icon("flag", 14)} ${texts.report}
          </a>`
        : nothing}
      ${job.state === "running" ? nothing : button("forget", icon("bin", 14), texts.forget, deleteEvaluation, "bare")}
    </section>`;
  }

  /** The choice among several evaluations of the mission. */
  private choice(job: EvaluationJob) {
    const texts = t().evaluate;
    const all = evaluations.value;
    if (all.length < 2) return nothing;
    return html`<label>
      ${texts.which}
      <select id="which" @change=${(event: Event) => chooseEvaluation(valueOf(event))}>
        ${options(
          all.map(({ id, begun, state }) => {
            const when = dateAndTime(begun, "short", "medium");
            return [id, texts.begun(when, texts.states[id === job.id ? job.state : state])];
          }),
          job.id,
        )}
      </select>
    </label>`;
  }

  private standing(job: EvaluationJob, now: EvaluationStanding) {
    const texts = t().evaluate;
    const running = job.state === "running";
    const lost = (now.outcomes.error ?? 0) + (now.outcomes.died ?? 0);
    return html`
      ${now.rate.value === null
        ? nothing
        : html`<p class="rate" id="rate">${share(now.rate.value)} <span>${texts.success}</span></p>`}
      <p class="numbers">
        ${texts.interval(share(now.rate.low), share(now.rate.high))}
        <span class="small" id="kind">${this.kind(job, now)}</span><br />
        <span id="done">${this.runs(job, now)}</span>${running && now.remaining
          ? html`, ${texts.left(seconds(Math.ceil(now.remaining)))}`
          : nothing}
      </p>
      ${running ? html`<progress max=${now.most} value=${now.done} aria-label=${texts.runs}></progress>` : nothing}
      ${this.chart(job, now)} ${now.requirements.map(
        (one) =>
          html`<p class="verdict ${one.verdict === "not decided" ? "" : one.verdict}" data-verdict=${one.verdict}>
            <b>${texts.required(one.requirement, percentOf)}</b>: ${texts.verdicts[one.verdict]}
            <span class="small">(${share(one.low)} – ${share(one.high)})</span>
            ${one.verdict === "not decided" ? html`<br /><span class="small">${texts.moreWorlds}</span>` : nothing}
          </p>`,
      )}
      ${lost === 0 ? nothing : html`<p class="warn">${texts.lost(lost)}</p>`}
      ${now.times
        ? html`<p class="numbers">
            ${texts.times(seconds(now.times.least), seconds(now.times.median), seconds(now.times.most))}
          </p>`
        : nothing}
      ${now.by_faults.length > 1 ? this.byFaults(job, now) : nothing} ${this.failing(job, now)}
    `;
  }

  private chart(job: EvaluationJob, now: EvaluationStanding) {
    const texts = t().evaluate;
    const curve = rateCurve(now.curve, now.most, WIDTH, HEIGHT);
    if (curve === null) return nothing;
    const wanted = job.asked.require.flatMap((one) => /^success >= ([\d.]+)$/.exec(one)?.[1] ?? []);
    return html`<figure>
      <svg class="chart" viewBox="0 0 ${WIDTH} ${HEIGHT}" preserveAspectRatio="none" role="img" aria-label=${texts.chart}>
        ${svg`<path class="band" d=${curve.band} /><path class="line" d=${curve.rate} />`}
        ${wanted.map((one) => {
          const y = HEIGHT * (1 - Number(one));
          return svg`<path class="wanted" d="M0 ${y}H${WIDTH}" />`;
        })}
      </svg>
      <figcaption>
        <span class="axis"><span>0 ${texts.runs}, 0–100 %</span><span>${figure(now.most)}</span></span>
      </figcaption>
    </figure>`;
  }

  /** Return the description of the interval's kind, which says what it claims. */
  private kind(job: EvaluationJob, now: EvaluationStanding): string {
    const kinds = t().evaluate.kinds;
    const cases = job.asked.faults.length + (job.asked.without_faults ? 1 : 0);
    if (now.rate.method === "Wilson") return cases > 1 ? kinds.whileMixed : kinds.while;
    if (now.rate.method === "Clopper-Pearson") return kinds.exact;
    if (job.state !== "done") return kinds.cutShort(figure(now.rate.runs));
    return now.by_faults.length > 1 ? kinds.worlds : kinds.anyTime;
  }

  /** Return the number of runs, done and planned, and why there are no more. */
  private runs(job: EvaluationJob, now: EvaluationStanding): string {
    const texts = t().evaluate;
    const text =
      job.state === "done" && now.done < now.planned
        ? texts.enough(figure(now.done), figure(now.planned))
        : texts.runsOf(figure(now.done), figure(job.state === "done" ? now.done : now.most));
    return job.state === "running" || now.rate.runs === now.done ? text : `${text}, ${texts.count(figure(now.rate.runs))}`;
  }

  private byFaults(job: EvaluationJob, now: EvaluationStanding) {
    const texts = t().evaluate;
    const faults = faultsByCase(job.asked.faults);
    const summary = (name: string) => {
      const fault = faults.get(name);
      return fault === undefined ? nothing : html`<br /><span class="small">${faultSummary(givenFields(fault))}</span>`;
    };
    return html`<table>
      <caption class="small">${texts.byFaults}</caption>
      <thead>
        <tr><th scope="col">${texts.what}</th><th scope="col">${texts.share}</th><th scope="col">${texts.runs}</th></tr>
      </thead>
      <tbody>
        ${now.by_faults.map(
          ({ name, rate }) =>
            html`<tr>
              <th scope="row">${texts.faultsNamed(name)}${summary(name)} ${this.bar(rate)}</th>
              <td>${rate.value === null ? "–" : share(rate.value)}</td>
              <td>${figure(rate.runs)}</td>
            </tr>`,
        )}
      </tbody>
    </table>`;
  }

  private bar(rate: RateTold) {
    const [left, width] = [`${100 * rate.low}%`, `${100 * (rate.high - rate.low)}%`];
    return html`<div class="bar" aria-hidden="true">
      <div class="span" ${styled({ left, width })}></div>
      ${rate.value === null ? nothing : html`<div class="mark" ${styled({ left: `${100 * rate.value}%` })}></div>`}
    </div>`;
  }

  private failing(job: EvaluationJob, now: EvaluationStanding) {
    const texts = t().evaluate;
    if (now.failing.length === 0)
      return job.state === "done" ? html`<p class="dim">${texts.noFailure}</p>` : nothing;
    return html`<div>
      <h3>${texts.failing}</h3>
      <ul id="failing">
        ${now.failing.map((one) => this.run(job, one, now.by_faults.length > 1))}
      </ul>
      ${now.more_failing > 0 ? html`<p class="small">${texts.more(now.more_failing)}</p>` : nothing}
    </div>`;
  }

  private run(job: EvaluationJob, one: FailedRun, withFaults: boolean) {
    const texts = t().evaluate;
    const again = replaying.value === one.key;
    return html`<li>
      <button class="bare" data-key=${one.key} ?disabled=${replaying.value !== null} @click=${() => replayRun(job, one)}>
        <b>${texts.failed(one.seed, withFaults ? texts.faultsNamed(one.faults) : null)}</b>
        <span class="reason">${again ? texts.replaying : one.verdict.length > 0 ? t().verdict.verdict(one.verdict) : said(one.reason)}</span>
      </button>
    </li>`;
  }
}

function share(part: number): string {
  return percent(part, 1);
}

/** Format a share as a percentage with the digits that the person gave. */
function percentOf(part: number): string {
  return percent(part, 4);
}
