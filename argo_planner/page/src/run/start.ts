/** The form of a run: its settings. */

import type { RunAsked } from "../api/types";
import { checkpointSuggestion, parseCheckpoint } from "../model/checkpoint-choice";
import { storeSetting, storedSetting, mayOperate, withExtensions } from "../state/session";
import { missionHasErrors, mission } from "../state/plan";
import { faultsOf } from "../state/faults";
import { startRun } from "../state/requests";
import { world } from "../state/world";
import { t } from "../texts";
import { choice, iconButton } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { icon } from "../ui/icons";
import { figure, unitText } from "../ui/figures";
import "./faults";
import type { FaultChoice } from "./faults";
import { checkpointList, parts, readSpeed, SPEEDS, speedName } from "./parts";

const DRIVES = ["kinematic", "tracked", "route", "remote"] as const;
const SENSORS = ["ideal", "camera"] as const;

@customElement("argo-run-start")
export class RunStart extends PageElement {
  static override styles = [
    parts,
    css`
      form {
        display: grid;
        gap: 10px;
      }
      .begin button {
        font-size: 16px;
      }
      .value {
        display: grid;
        grid-template-columns: 1fr 90px auto;
        gap: 6px;
      }
    `,
  ];

  @state() private starting = false;
  @state() private wrong: string | null = null;
  @state() private values: ReadonlyMap<number, number> = new Map();

  override render() {
    const texts = t().run;
    const reason = this.whyNot();
    return html`<form @submit=${this.start}>
      <div class="begin">
        <button
          class="main"
          id="start"
          aria-disabled=${reason !== null || this.starting}
          aria-describedby=${reason === null ? nothing : "reason"}
        >
          ${icon("play", 20)} ${this.starting ? texts.starting : texts.start}
        </button>
        ${choice(texts.speed, "speed", SPEEDS.map((speed) => [speed, speedName(speed)]), readSpeed(storedSetting("speed") ?? "1"))}
      </div>
      ${reason === null ? nothing : html`<p class="reason" id="reason">${reason}</p>`}
      ${this.wrong === null ? nothing : html`<p class="wrong" role="alert">${this.wrong}</p>`}
      <details>
        <summary>${texts.how}</summary>
        <div class="inner">
          ${choice(texts.drive, "drive", withExtensions(DRIVES, texts.drives, "drive"))}
          <div class="pair">
            ${choice(texts.sensor, "sensor", withExtensions(SENSORS, texts.sensors, "sensor"))}
            <label>
              ${texts.seed}
              <input name="seed" type="number" min="0" max="2147483648" step="1" value="0" required />
            </label>
          </div>
          ${this.valueList()}
          <argo-faults list="run" .refusal=${this.wrong}></argo-faults>
        </div>
      </details>
    </form>`;
  }

  private valueList() {
    const texts = t().run;
    const checkpoints = world.value?.checkpoints ?? [];
    return html`<section>
      <h2>${texts.values}</h2>
      <ul>
        ${[...this.values].map(([id, value]) => {
          const checkpoint = checkpoints.find((one) => one.id === id);
          const name = checkpoint === undefined ? `#${id}` : checkpointSuggestion(checkpoint);
          return html`<li class="row">
            <span class="grow">${name}: ${figure(value)} ${unitText(checkpoint?.unit ?? "")}</span>
            ${iconButton("close", texts.remove(name), () => this.dropValue(id), { size: 16 })}
          </li>`;
        })}
      </ul>
      <div class="value">
        <input
          id="value-of"
          list="checkpoints"
          aria-label=${texts.checkpoint}
          placeholder=${texts.checkpoint}
          @keydown=${this.onValueKey}
        />
        <input
          id="value"
          type="number"
          step="any"
          aria-label=${texts.value}
          placeholder=${texts.value}
          @keydown=${this.onValueKey}
        />
        ${iconButton("add", texts.addValue, this.addValue, { look: "" })}
      </div>
      ${checkpointList("checkpoints")}
    </section>`;
  }

  private dropValue(id: number): void {
    this.values = new Map([...this.values].filter(([other]) => other !== id));
  }

  /** Return why no run can start now. The button can have the focus nevertheless: keys reach it before the
   * check is done, and a screen reader announces the reason there. */
  private whyNot(): string | null {
    const texts = t().run;
    if (!mayOperate()) return texts.mayNotOperate;
    if ((mission.value?.tasks.length ?? 0) === 0) return texts.noTasks;
    return missionHasErrors.value ? texts.hasErrors : null;
  }

  private onValueKey(event: KeyboardEvent): void {
    if (event.key !== "Enter") return;
    event.preventDefault();
    this.addValue();
  }

  private addValue(): void {
    const of = this.renderRoot.querySelector<HTMLInputElement>("#value-of");
    const field = this.renderRoot.querySelector<HTMLInputElement>("#value");
    const checkpoint = parseCheckpoint(of?.value ?? "", world.value?.checkpoints ?? []);
    if (!of || !field) return;
    if (checkpoint === null) return of.focus();
    if (field.value === "" || !Number.isFinite(field.valueAsNumber)) return field.focus();
    this.values = new Map(this.values).set(checkpoint.id, field.valueAsNumber);
    of.value = field.value = "";
    of.focus();
  }

  private async start(event: SubmitEvent): Promise<void> {
    event.preventDefault();
    const sent = event.target as HTMLFormElement;
    if (this.starting || this.whyNot() !== null) return;
    if ((await this.renderRoot.querySelector<FaultChoice>("argo-faults")?.settle()) === false) {
      this.wrong = t().faults.mend;
      const settings = this.renderRoot.querySelector("details");
      if (settings) settings.open = true;
      return;
    }
    const form = new FormData(sent);
    const speed = form.get("speed") as string;
    storeSetting("speed", speed);
    const asked: Partial<RunAsked> = {
      speed: readSpeed(speed),
      drive: form.get("drive") as string,
      sensor: form.get("sensor") as string,
      seed: Number(form.get("seed")),
      values: Object.fromEntries(this.values),
      faults: faultsOf("run") as unknown as RunAsked["faults"],
    };
    this.starting = true;
    this.wrong = null;
    this.wrong = await startRun(asked);
    this.starting = false;
  }
}
