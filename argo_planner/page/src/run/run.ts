/** The panel of the run: start it, watch it, control it, go back in time. */

import { client, responseData } from "../api/client";
import type { FailedRun, RunState } from "../api/types";
import { withErrorNotice } from "../state/notices";
import { planId } from "../state/plan";
import { csv } from "../model/csv";
import { pastRun, run, runIsOn, shownEntries, showRun, shownRunState } from "../state/run";
import { panel } from "../state/view";
import { t } from "../texts";
import { options, valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { dateAndTime } from "../ui/figures";
import { icon } from "../ui/icons";
import "./band";
import { csvButton } from "./compare";
import "./controls";
import "./events";
import "./hand";
import { modeWords } from "./mode-words";
import { parts } from "./parts";
import "./readings";
import "./start";
import { readingsTable } from "./tables";
import "./tell";
import "./time";

@customElement("argo-run")
export class RunPanel extends PageElement {
  static override styles = [
    parts,
    css`
      :host {
        padding: 12px;
      }
      .all {
        display: flex;
        flex-direction: column;
        gap: 14px;
      }
      argo-run-controls {
        position: sticky;
        z-index: 2;
        top: -12px; /* the padding above */
        padding: 6px 0;
        background: var(--surface);
      }
      .busy {
        padding: 8px 10px;
        border-radius: var(--round);
        background: var(--warn-ground);
        color: var(--warn);
      }
      .evaluated {
        display: grid;
        gap: 6px;
        padding: 8px 10px;
        border-left: 3px solid var(--accent);
        background: var(--sunken);
        overflow-wrap: anywhere;
      }
      .evaluated button {
        justify-self: start;
      }
      .files {
        display: flex;
        flex-wrap: wrap;
        align-items: center;
        justify-content: space-between;
        gap: 6px 12px;
      }
      .busy a {
        color: inherit;
      }
    `,
  ];

  @state() private past: readonly RunState[] = [];
  private listed = "";

  constructor() {
    super();
    this.listen("open-run", () => this.focusMain());
  }

  /** Move the focus to the next likely button: start, continue, give back, or pause. */
  private focusMain(): void {
    for (const part of this.renderRoot.querySelectorAll("argo-run-start, argo-run-controls")) {
      const main = part.shadowRoot?.querySelector<HTMLElement>("button.main:not(:disabled)");
      if (main) return main.focus();
    }
  }

  override render() {
    const texts = t().run;
    const shown = shownRunState.value;
    const here = shown !== null && shown.plan === planId.value;
    const other = run.value !== null && runIsOn.value && run.value.plan !== planId.value;
    void this.list();
    return html`<div class="all">
      ${other && run.value !== null
        ? html`<p class="busy">
            ${texts.robotBusy(run.value.by, run.value.name)}
            <a href=${`#/missions/${run.value.plan}`}>${texts.openThat}</a>
          </p>`
        : nothing}
      ${!runIsOn.value && pastRun.value === null ? html`<argo-run-start></argo-run-start>` : nothing}
      ${here || other
        ? html`${pastRun.value?.evaluated ? this.evaluated(pastRun.value.evaluated) : nothing}
            <argo-run-band></argo-run-band>
            ${shown?.status === "ended"
              ? html`<div class="files">${pastRun.value?.evaluated ? nothing : this.report(shown)} ${this.file(shown)}</div>`
              : nothing}
            ${this.steering()} ${this.choice()}
            <argo-run-time></argo-run-time>
            <argo-run-readings></argo-run-readings>
            <argo-run-events></argo-run-events>
            ${this.isSteered() ? html`<argo-run-tell></argo-run-tell>` : nothing}`
        : this.choice()}
      <argo-run-compare .runs=${this.past.filter((one) => one.status === "ended")}></argo-run-compare>
    </div>`;
  }

  private isSteered(): boolean {
    return pastRun.value === null && runIsOn.value;
  }

  private steering() {
    if (!this.isSteered()) return nothing;
    const byHand = run.value?.mode === "supervised" && run.value.status === "running";
    return html`<argo-run-controls></argo-run-controls>
      ${byHand ? html`<argo-run-hand></argo-run-hand>` : nothing}`;
  }

  /** Render the choice among the runs of this mission. */
  private choice() {
    const texts = t().run;
    const others = this.past.filter((one) => one.id !== run.value?.id);
    if (others.length === 0 || pastRun.value?.evaluated) return nothing;
    const shown = pastRun.value?.state.id ?? "";
    return html`<label>
      ${texts.shownRun}
      <select id="past" @change=${this.choose}>
        ${options([["", texts.robotsRun], ...others.map((one) => [one.id, this.named(one)] as const)], shown)}
      </select>
    </label>`;
  }

  private named(one: RunState): string {
    return t().run.pastRunOf(dateAndTime(one.begun), modeWords(one));
  }

  /** Render the description of an evaluation's run, and a button that leads back. */
  private evaluated(one: FailedRun) {
    const texts = t().evaluate;
    return html`<div class="evaluated" id="evaluated">
      <p>${texts.replayed(one.seed, texts.faultsNamed(one.faults))}</p>
      ${pastRun.value?.state.sensor === "camera" ? html`<p class="reason">${texts.noPictures}</p>` : nothing}
      <button id="to-evaluation" @click=${this.toEvaluation}>${icon("back")} ${texts.back}</button>
    </div>`;
  }

  private readonly toEvaluation = (): void => {
    void showRun(null);
    panel.value = "evaluate";
  };

  private report(shown: RunState) {
    return html`<a href=${`/api/runs/${shown.id}/report/report.html`} target="_blank" rel="noopener">
      ${icon("flag", 14)} ${t().run.report}
    </a>`;
  }

  /** Render a button that stores the readings of the shown run. */
  private file(shown: RunState) {
    const { csvOfRun, fileReadings } = t().compare;
    return csvButton("csv", csvOfRun, () => [
      `${fileReadings}-${shown.id}.csv`,
      csv(readingsTable(shown.id, shown.revision, shownEntries.value)),
    ]);
  }

  private async choose(event: Event): Promise<void> {
    const id = valueOf(event);
    await withErrorNotice(() => showRun(id === "" ? null : id));
  }

  /** Read the runs of this mission again if a run has begun or ended. */
  private async list(): Promise<void> {
    const about = `${planId.value ?? ""} ${run.value?.id ?? ""} ${run.value?.status ?? ""}`;
    if (about === this.listed) return;
    this.listed = about;
    const plan = planId.value;
    await withErrorNotice(async () => {
      const { runs } = await responseData(client.GET("/api/runs"));
      this.past = runs.filter((one) => one.plan === plan);
    });
  }
}
