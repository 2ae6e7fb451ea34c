/** The requirements of the best order, and the search for it. */

import type { FormField } from "../forms/field";
import { timeField } from "../forms/parts";
import { writeTime } from "../forms/times";
import { parts } from "../run/parts";
import { edit } from "../state/commands";
import { missionHasErrors, tasksAfterStart, mission } from "../state/plan";
import { extensionsOf, mayPlan } from "../state/session";
import { taskLabel } from "../state/task-labels";
import { t } from "../texts";
import { choice, iconButton, options } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { icon } from "../ui/icons";
import "./result";
import { job, search, type Asked } from "./search";

const LIMITS = [5, 10, 30, 120, 600] as const; // s

@customElement("argo-route")
export class RoutePanel extends PageElement {
  static override styles = [
    parts,
    css`
      :host {
        padding: 12px;
      }
      .all {
        display: grid;
        gap: 12px;
      }
      .line {
        display: grid;
        gap: 6px;
      }
      .pair {
        grid-template-columns: minmax(0, 1fr) auto minmax(0, 1fr) auto;
        align-items: center;
      }
      .window {
        grid-template-columns: minmax(0, 1fr) minmax(0, 1fr) auto;
        align-items: start;
      }
      .window argo-field {
        margin-bottom: 0;
      }
      .window button {
        margin-top: 18px;
      }
      .window select {
        grid-column: 1 / -1;
      }
      .line select {
        min-width: 0;
      }
      h3 {
        margin-bottom: 4px;
      }
    `,
  ];

  @state() private pairsAsked: Asked["before"] = [];
  @state() private windows: Asked["windows"] = [];
  @state() private wrong: string | null = null;
  @state() private budget: number | null = null;
  @state() private earliest: number | null = null;
  @state() private latest: number | null = null;

  override render() {
    const texts = t().route;
    const why = this.whyNot();
    const running = job.value?.state === "running";
    return html`<div class="all">
      <form class="all" @submit=${this.search}>
        <div class="begin">
          <button class="main" id="search" ?disabled=${why !== null || running}>
            ${icon("route", 20)} ${texts.search}
          </button>
          ${choice(texts.timeLimit, "limit", LIMITS.map((s) => [s, writeTime(s)]), 10)}
        </div>
        ${why === null ? nothing : html`<p class="reason">${why}</p>`}
        ${this.wrong === null ? nothing : html`<p class="wrong" role="alert">${this.wrong}</p>`} ${this.fixed()}
        <details>
          <summary>${texts.requirements}</summary>
          <div class="inner">
            <div id="budget">
              ${timeField(texts.budget, this.budget, (budget) => this.take({ budget }))}
              <span class="reason">${texts.budgetHint}</span>
            </div>
            ${this.pairs()} ${this.times()} ${this.solvers()}
          </div>
        </details>
      </form>
      <argo-route-result></argo-route-result>
    </div>`;
  }

  /** Render a button that allows other orders, if the mission fixes its order. */
  private fixed() {
    if (mission.value === null || mission.value.order === "any" || tasksAfterStart.value.length < 2) return nothing;
    return html`<div class="row">
      <p class="grow reason">${t().route.fixed}</p>
      <button
        type="button"
        id="free"
        ?disabled=${!mayPlan()}
        @click=${() => edit({ kind: "set_header", order: "any" })}
      >
        ${t().route.free}
      </button>
    </div>`;
  }

  private pairs() {
    const texts = t().route;
    return html`<section>
      <h3>${texts.before}</h3>
      <ul>
        ${this.pairsAsked.map((pair, at) =>
          this.item(texts.pair(...(pair.map(taskLabel) as [string, string])), () => {
            this.pairsAsked = this.pairsAsked.filter((_, other) => other !== at);
          }),
        )}
      </ul>
      <div class="line pair">
        ${this.choice("first", texts.first)} <span>${texts.isBefore}</span>
        ${this.choice("second", texts.second)} ${iconButton("add", texts.add, this.addPair, { look: "" })}
      </div>
    </section>`;
  }

  private times() {
    const texts = t().route;
    return html`<section>
      <h3>${texts.windows}</h3>
      <ul>
        ${this.windows.map(({ what, earliest, latest }, at) =>
          this.item(
            texts.window(taskLabel(what), writeTime(earliest), latest === null ? "" : writeTime(latest)),
            () => {
              this.windows = this.windows.filter((_, other) => other !== at);
            },
          ),
        )}
      </ul>
      <div class="line window">
        ${this.choice("what", texts.what)}
        ${timeField(texts.earliest, this.earliest, (earliest) => this.take({ earliest }))}
        ${timeField(texts.latest, this.latest, (latest) => this.take({ latest }))} ${iconButton("add", texts.add, this.addWindow, { look: "" })}
      </div>
    </section>`;
  }

  /** Render the choice of a package's solver, which takes part besides Argo's own; nothing if there is none. */
  private solvers() {
    const all = extensionsOf("route solver");
    if (all.length === 0) return nothing;
    const texts = t().route;
    return choice(texts.solver, "solver", [["", texts.noSolver] as const, ...all.map((name) => [name, name] as const)], "");
  }

  private item(text: string, drop: () => void) {
    return html`<li class="row">
      <span class="grow">${text}</span>
      ${iconButton("close", t().route.remove(text), drop, { size: 16 })}
    </li>`;
  }

  private choice(id: string, label: string) {
    return html`<select id=${id} aria-label=${label}>
      ${options(tasksAfterStart.value.map((name) => [name, taskLabel(name)]))}
    </select>`;
  }

  private addPair(): void {
    const [first, second] = [this.value("first"), this.value("second")];
    if (first === second || first === "" || second === "") return;
    if (!this.pairsAsked.some(([one, other]) => one === first && other === second))
      this.pairsAsked = [...this.pairsAsked, [first, second]];
  }

  private async addWindow(): Promise<void> {
    if (!(await this.settled(".window argo-field"))) return;
    const what = this.value("what");
    const earliest = this.earliest ?? 0;
    const latest = this.latest;
    if (what === "" || (earliest === 0 && latest === null)) return;
    if (latest !== null && latest <= earliest) return;
    this.windows = [...this.windows.filter((one) => one.what !== what), { what, earliest, latest }];
    this.take({ earliest: null, latest: null });
  }

  /** Keep times of the form. Returns null: none is refused. */
  private take(times: { budget?: number | null; earliest?: number | null; latest?: number | null }): null {
    Object.assign(this, times);
    return null;
  }

  /** Save what is typed in the fields. Returns whether nothing is left unsaved. */
  private async settled(selector: string): Promise<boolean> {
    for (const field of this.renderRoot.querySelectorAll<FormField>(selector))
      if (!(await field.settle())) return false;
    return true;
  }

  private value(id: string): string {
    return this.renderRoot.querySelector<HTMLInputElement>(`#${id}`)?.value ?? "";
  }

  private whyNot(): string | null {
    const texts = t().route;
    if (!mayPlan()) return texts.mayNotPlan;
    if (tasksAfterStart.value.length < 2) return texts.nothing;
    return missionHasErrors.value ? texts.hasErrors : null;
  }

  private async search(event: SubmitEvent): Promise<void> {
    event.preventDefault();
    const form = new FormData(event.target as HTMLFormElement);
    if (!(await this.settled("argo-field"))) return;
    const known = new Set(tasksAfterStart.value);
    const asked: Asked = {
      budget: this.budget,
      before: this.pairsAsked.filter((pair) => pair.every((name) => known.has(name))),
      windows: this.windows.filter(({ what }) => known.has(what)),
    };
    const solver = form.get("solver");
    this.wrong = null;
    this.wrong = await search(Number(form.get("limit")), asked, typeof solver === "string" && solver !== "" ? [solver] : []);
  }
}
