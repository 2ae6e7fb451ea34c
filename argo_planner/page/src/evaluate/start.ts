/** The form of an evaluation: number of worlds, their differences, requirements. */

import type { EvaluationAsked } from "../api/types";
import "../run/faults";
import type { FaultChoice } from "../run/faults";
import { parts } from "../run/parts";
import { missionHasErrors, mission } from "../state/plan";
import { faultsOf } from "../state/faults";
import { mayPlan, withExtensions } from "../state/session";
import { t } from "../texts";
import { choice } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { figure } from "../ui/figures";
import { icon } from "../ui/icons";
import { evaluationElsewhere, startEvaluation, evaluation, evaluations } from "./evaluation";

const WORLDS = [20, 100, 300, 1_000, 3_000, 10_000] as const;
const DRIVES = ["route", "kinematic", "tracked"] as const;
/** Names of ranges that are given in percent. */
const SHARES = ["charge", "capacity", "speed"] as const;

@customElement("argo-evaluate-start")
export class EvaluateStart extends PageElement {
  static override styles = [
    parts,
    css`
      form {
        display: grid;
        grid-template-columns: minmax(0, 1fr);
        gap: 10px;
      }
      .check {
        display: flex;
        align-items: center;
        gap: 6px;
        color: var(--text);
        font-size: 14px;
      }
      .check input {
        width: auto;
      }
      .range {
        display: grid;
        grid-template-columns: minmax(0, 1fr) 68px 68px;
        align-items: center;
        gap: 6px;
        font-size: 13px;
      }
      .range input {
        min-width: 0;
      }
      .one {
        grid-template-columns: minmax(0, 1fr) 68px;
      }
    `,
  ];

  @state() private wrong: string | null = null;
  @state() private starting = false;

  override render() {
    const texts = t().evaluate;
    const reason = this.whyNot();
    const other = evaluationElsewhere.value;
    return html`<form @submit=${this.begin}>
      <p class="reason">${texts.hint}</p>
      <div class="begin">
        <button class="main" id="evaluate" aria-disabled=${reason !== null || this.starting} aria-describedby="why-not">
          ${icon("gauge", 20)} ${texts.begin}
        </button>
        ${choice(texts.worlds, "worlds", WORLDS.map((count) => [count, figure(count)]), 100)}
      </div>
      <p class="reason" id="why-not" ?hidden=${reason === null}>
        ${reason}
        ${other === null ? nothing : html`<a href=${`#/missions/${other.mission}`}>${t().run.openThat}</a>`}
      </p>
      <details>
        <summary>${texts.how}</summary>
        <div class="inner">
          <label>
            ${texts.require}
            <input name="require" type="number" min="1" max="99.99" step="any" placeholder="95" />
            <span class="reason">${texts.requireHint}</span>
          </label>
          <label>
            ${texts.width}
            <input name="width" type="number" min="1" max="99" step="any" placeholder="5" />
          </label>
          ${choice(t().run.drive, "drive", [["", texts.neededDrive] as const, ...withExtensions(DRIVES, t().run.drives, "drive")], "")}
          <label>
            ${texts.firstSeed}
            <input name="seed" type="number" min="0" max="2147483648" step="1" value="0" required />
          </label>
          <argo-faults list="evaluate" .refusal=${this.wrong}></argo-faults>
          <label class="check" ?hidden=${faultsOf("evaluate").length === 0}>
            <input type="checkbox" name="ideal" checked /> ${texts.ideal}
          </label>
          ${this.ranges()}
        </div>
      </details>
      ${this.wrong === null ? nothing : html`<p class="wrong" role="alert">${this.wrong}</p>`}
    </form>`;
  }

  private ranges() {
    const texts = t().evaluate;
    return html`<section class="inner">
      <h2>${texts.vary}</h2>
      ${SHARES.map((name) => {
        const text = texts.ranges[name];
        return html`<div class="range">
          <span>${text}</span>
          ${shareField(`${name}-low`, texts.from(text), t().forms.from)} ${shareField(`${name}-high`, texts.to(text), t().forms.to)}
        </div>`;
      })}
      <div class="range one">
        <span>${texts.ranges.offset}</span>
        <input name="offset" type="number" min="0" max="100" step="any" aria-label=${texts.ranges.offset} />
      </div>
    </section>`;
  }

  private whyNot(): string | null {
    const texts = t().evaluate;
    if (!mayPlan()) return texts.mayNotPlan;
    if ((mission.value?.tasks.length ?? 0) === 0) return texts.nothing;
    if (missionHasErrors.value) return texts.hasErrors;
    if (evaluations.value.some((one) => one.state === "running") || evaluation.value?.state === "running")
      return texts.underWay;
    const other = evaluationElsewhere.value;
    return other === null ? null : texts.busy(other.name, other.author);
  }

  private async begin(event: SubmitEvent): Promise<void> {
    event.preventDefault();
    const sent = event.target as HTMLFormElement;
    if (this.whyNot() !== null || this.starting) return;
    if ((await this.renderRoot.querySelector<FaultChoice>("argo-faults")?.settle()) === false) {
      this.wrong = t().faults.mend;
      const settings = this.renderRoot.querySelector("details");
      if (settings) settings.open = true;
      return;
    }
    const form = new FormData(sent);
    const faults = faultsOf("evaluate");
    const variation = this.variation(form);
    if (variation === null) return;
    const share = (name: string) => (number(form, name) ?? 0) / 100;
    const asked = {
      worlds: Number(form.get("worlds")),
      first_seed: Number(form.get("seed")),
      drive: (form.get("drive") as string) || null,
      faults,
      without_faults: faults.length === 0 || form.has("ideal"),
      require: share("require") > 0 ? [`success >= ${share("require")}`] : [],
      width: share("width") > 0 ? share("width") : null,
      variation,
    };
    this.starting = true;
    this.wrong = await startEvaluation(asked as unknown as Partial<EvaluationAsked>);
    this.starting = false;
    if (this.wrong !== null) return;
    await new Promise(requestAnimationFrame);
    // The result stands above the form.
    const root = this.getRootNode() as ShadowRoot;
    root.querySelector("argo-evaluate-result")?.scrollIntoView({ block: "start" });
  }

  /** Read the ranges of the form; null: a range is invalid, and `wrong` names it. */
  private variation(form: FormData): Record<string, readonly [number, number]> | null {
    const texts = t().evaluate;
    const found: Record<string, readonly [number, number]> = {};
    this.wrong = null;
    for (const name of SHARES) {
      const [low, high] = [number(form, `${name}-low`), number(form, `${name}-high`)];
      if (low === null && high === null) continue;
      if (low === null || high === null || low > high) {
        this.wrong = texts.badRange(texts.ranges[name]);
        return null;
      }
      found[name] = [low / 100, high / 100];
    }
    const offset = (number(form, "offset") ?? 0) / 100;
    if (offset > 0) found["ahead"] = found["left"] = [-offset, offset];
    return found;
  }
}

/** Render a field for a percentage. */
function shareField(name: string, label: string, placeholder: string) {
  return html`<input
    name=${name}
    type="number"
    min="0.1"
    max="100"
    step="any"
    aria-label=${label}
    placeholder=${placeholder}
  />`;
}

function number(form: FormData, name: string): number | null {
  const text = form.get(name);
  return typeof text !== "string" || text === "" ? null : Number(text);
}
