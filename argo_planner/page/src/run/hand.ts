/** The panel of driving by hand, while a person controls the robot. */

import { plansShown } from "../floorplan/state";
import { isTyping } from "../frame/keys";
import { parseCheckpoint } from "../model/checkpoint-choice";
import { directionOf, type Direction } from "../model/hand-driving";
import { selectedTask, tasksAfterStart, planId } from "../state/plan";
import { sendRequest } from "../state/requests";
import { run } from "../state/run";
import { mayOperate } from "../state/session";
import { taskLabel } from "../state/task-labels";
import { world } from "../state/world";
import { t } from "../texts";
import { options, valueOf } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { icon, type Icon } from "../ui/icons";
import { blocked, drive, wantedDirection } from "./hand-driver";
import { runTaskLabel } from "./labels";
import { checkpointList, parts } from "./parts";

const PAD: readonly (readonly [Direction, Icon, string])[] = [
  ["left", "turn-left", "left"],
  ["forward", "up", "forward"],
  ["right", "turn-right", "right"],
  ["backward", "down", "backward"],
];

@customElement("argo-run-hand")
export class RunHand extends PageElement {
  static override styles = [
    parts,
    css`
      section {
        display: grid;
        gap: 10px;
        padding: 10px;
        border: 1px solid var(--person);
        border-radius: var(--round);
      }
      .pad {
        display: grid;
        grid-template: "left forward right" 44px "stop backward stop2" 44px / 1fr 1fr 1fr;
        gap: 6px;
        touch-action: none;
      }
      .pad button {
        min-height: 44px;
        user-select: none;
      }
      .pad .stop {
        grid-area: stop;
      }
      .forward {
        grid-area: forward;
      }
      .backward {
        grid-area: backward;
      }
      .left {
        grid-area: left;
      }
      .right {
        grid-area: right;
      }
      .line {
        display: grid;
        grid-template-columns: minmax(0, 1fr) auto auto;
        gap: 6px;
      }
      .tasks {
        grid-template-columns: 1fr 1fr;
      }
      .tasks select {
        grid-column: 1 / 3;
      }
      .blocked {
        color: var(--bad);
      }
    `,
  ];

  @state() private withKeys = false;
  /** The task chosen here or selected in the list. */
  @state() private task = "";
  private speedBefore: number | null | undefined;

  constructor() {
    super();
    this.listen("keydown", this.onKey, true);
    this.listen("keyup", this.onKeyUp, true);
    this.listen("blur", this.halt);
    this.listen("visibilitychange", this.halt);
    this.watch(() => {
      // The floor plans are shown in place of the robot, and use the same keys.
      if (plansShown.value !== "off" && this.withKeys) this.driveWithKeys(false);
    });
    this.watch(() => {
      if (selectedTask.value !== null) this.task = selectedTask.value.name;
    });
  }

  override disconnectedCallback(): void {
    super.disconnectedCallback();
    if (this.withKeys) this.driveWithKeys(false);
    else this.halt();
  }

  override render() {
    const state = run.value;
    if (state === null) return nothing;
    const texts = t().run;
    const off = !mayOperate();
    const busy = off || state.moving;
    return html`<section aria-label=${texts.byHand}>
      <button
        id="drive"
        aria-pressed=${this.withKeys}
        ?disabled=${off}
        @click=${() => this.driveWithKeys(!this.withKeys)}
      >
        ${icon("drive")} ${texts.driveWithKeys}
      </button>
      ${this.withKeys ? html`<p class="reason">${texts.drivingOn}</p>` : nothing}
      <div class="pad">
        ${PAD.map(([direction, sign, name]) => this.arrow(direction, sign, name))}
        <button class="stop" id="stand" ?disabled=${off} @click=${this.stand}>
          ${icon("stop")} <span>${texts.standStill}</span>
        </button>
      </div>
      ${this.withKeys ? nothing : html`<p class="reason">${texts.holdToDrive}</p>`}
      ${blocked.value ? html`<p class="blocked" role="status">${texts.noWay}</p>` : nothing}
      <form class="line" @submit=${this.measure}>
        <input
          id="measure-at"
          list="to-measure"
          aria-label=${texts.measureWhat}
          placeholder=${texts.measureWhat}
          autocomplete="off"
        />
        ${checkpointList("to-measure")}
        <button id="measure" ?disabled=${busy}>${icon("gauge", 16)} ${texts.measureHere}</button>
      </form>
      ${state.plan === planId.value ? this.ofTasks(off, busy) : nothing}
      ${state.skipped.length > 0 ? html`<p>${texts.skipped(state.skipped.map(runTaskLabel))}</p>` : nothing}
      <p class="reason">${texts.edited}</p>
    </section>`;
  }

  /** Render the choice of a task to do or to skip. */
  private ofTasks(off: boolean, busy: boolean) {
    const texts = t().run;
    const tasks = tasksAfterStart.value;
    const chosen = tasks.includes(this.task) ? this.task : (tasks[0] ?? "");
    return html`<div class="line tasks">
      <select id="task" aria-label=${texts.whichTask} @change=${(event: Event) => (this.task = valueOf(event))}>
        ${options(tasks.map((name) => [name, taskLabel(name)]), chosen)}
      </select>
      <button id="do" ?disabled=${busy || chosen === ""} @click=${() => sendRequest({ kind: "do_task", task: chosen })}>
        ${texts.doTask}
      </button>
      <button id="skip" ?disabled=${off || chosen === ""} @click=${() => sendRequest({ kind: "skip", task: chosen })}>
        ${icon("skip", 16)} ${texts.skip}
      </button>
    </div>`;
  }

  private arrow(direction: Direction, sign: Icon, name: string) {
    const label = t().run[name as "forward"];
    return html`<button
      class=${direction}
      aria-label=${label}
      title=${label}
      aria-pressed=${wantedDirection.value === direction}
      ?disabled=${!mayOperate()}
      @pointerdown=${(event: PointerEvent) => {
        (event.target as Element).setPointerCapture(event.pointerId);
        drive(direction);
      }}
      @pointerup=${this.halt}
      @pointercancel=${this.halt}
      @contextmenu=${(event: Event) => event.preventDefault()}
      @keydown=${(event: KeyboardEvent) => this.onPadKey(event, direction)}
      @keyup=${this.halt}
    >
      ${icon(sign, 22)}
    </button>`;
  }

  private onPadKey(event: KeyboardEvent, direction: Direction): void {
    if (event.key !== "Enter" && event.key !== " ") return;
    event.preventDefault();
    if (!event.repeat) drive(direction);
  }

  /** Switch driving by keys on or off. It sets the simulation to real time, as nobody can steer a faster robot. */
  private driveWithKeys(on: boolean): void {
    this.withKeys = on;
    if (!on) drive(null);
    const now = run.value?.speed ?? null;
    if (on && (now === null || now > 1)) {
      this.speedBefore = now;
      void sendRequest({ kind: "speed", speed: 1 }, true);
    } else if (!on && this.speedBefore !== undefined) {
      void sendRequest({ kind: "speed", speed: this.speedBefore }, true);
      this.speedBefore = undefined;
    }
  }

  private readonly halt = (): void => drive(null);

  private readonly stand = (): void => {
    drive(null);
    if (run.value?.moving) void sendRequest({ kind: "stop_by_hand" }, true);
  };

  private readonly onKey = (event: KeyboardEvent): void => {
    if (!this.withKeys || isTyping(event) || event.ctrlKey || event.metaKey || event.altKey) return;
    const direction = directionOf(event.code);
    if (direction !== null) {
      if (!event.repeat) drive(direction);
    } else if (event.code === "Space") this.stand();
    else if (event.code === "Escape") {
      this.driveWithKeys(false);
    } else return;
    event.preventDefault();
    event.stopImmediatePropagation();
  };

  private readonly onKeyUp = (event: KeyboardEvent): void => {
    if (this.withKeys && directionOf(event.code) !== null && directionOf(event.code) === wantedDirection.value)
      this.halt();
  };

  private async measure(event: SubmitEvent): Promise<void> {
    event.preventDefault();
    const field = this.renderRoot.querySelector<HTMLInputElement>("#measure-at");
    const checkpoint = parseCheckpoint(field?.value ?? "", world.value?.checkpoints ?? []);
    if (checkpoint === null) return field?.focus();
    await sendRequest({ kind: "measure", checkpoint: String(checkpoint.id) });
  }
}
