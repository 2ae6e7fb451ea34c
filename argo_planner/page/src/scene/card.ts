/** A card beside the clicked object, with the actions that it offers. */

import type { Obstacle, Pose, WorldCheckpoint } from "../api/types";
import { addMeasures, addStart, addTask } from "../list/adding";
import { faultSummary } from "../run/fault-words";
import { faultsOf, openedFault, removeFault, type FaultList } from "../state/faults";
import { mayPlan } from "../state/session";
import { look as lookSignal } from "../state/view";
import { removeObstacle, world } from "../state/world";
import { t } from "../texts";
import { faultText } from "../texts/fault-names";
import { said } from "../texts/messages";
import { iconButton } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, property } from "../ui/element";
import { bound, figure, unitText } from "../ui/figures";
import { icon } from "../ui/icons";
import { dependOn } from "../state/depend-on";
import { type Mark, openMark } from "./marks";
import { setsStart } from "./navigate";
import { floating } from "./style";
import type { SceneView } from "./view";

const [WIDTH, BESIDE, MARGIN] = [250, 26, 8];

@customElement("argo-scene-card")
export class SceneCard extends PageElement {
  static override styles = [
    floating,
    css`
      :host {
        top: 0;
        left: 0;
        z-index: 3;
        width: 250px;
      }
      .panel {
        display: grid;
        gap: 4px;
        padding: 8px 10px 10px;
        background: var(--raised);
      }
      h2 {
        overflow-wrap: anywhere;
      }
      .head {
        display: flex;
        align-items: start;
        gap: 6px;
      }
      .head button {
        min-height: 24px;
        width: 24px;
      }
      .buttons {
        display: flex;
        flex-wrap: wrap;
        gap: 6px;
        margin-top: 4px;
      }
      .bad {
        color: var(--bad);
        overflow-wrap: anywhere;
      }
      .good {
        color: var(--good);
      }
    `,
  ];

  @property({ attribute: false }) view: SceneView | null = null;

  override render() {
    const { view } = this;
    if (view === null) return nothing;
    dependOn(view.frames);
    const mark = view.markOf(openMark.value);
    if (mark === null) return nothing;
    this.stand(view, mark);
    return html`<div class="panel" role="group" aria-label=${mark.text} @keydown=${this.onKey}>
      <div class="head">
        <h2 class="grow">${mark.text}</h2>
        ${iconButton("close", t().scene.close, () => (openMark.value = null), { title: nothing, size: 14 })}
      </div>
      ${this.content(mark)}
    </div>`;
  }

  private content(mark: Mark) {
    const { subject } = mark;
    if (subject.kind === "checkpoint") return this.checkpoint(mark, subject.checkpoint);
    if (subject.kind === "place") return this.place(subject.name, subject.pose, subject.dock);
    if (subject.kind === "fault") return this.fault(subject.list, subject.index);
    return subject.kind === "obstacle" ? this.obstacle(subject.obstacle) : nothing;
  }

  private checkpoint(mark: Mark, one: WorldCheckpoint) {
    const texts = t().scene;
    const { nominal, stands } = one;
    return html`<p class="dim">${t().words.checkpoint[one.kind]} · ${texts.floor(one.floor)}</p>
      <p>${texts.nominal(bound(nominal.low), bound(nominal.high), unitText(one.unit))}</p>
      ${mark.value === "" ? nothing : html`<p class=${mark.tone}>${texts.reading(mark.value)}</p>`}
      ${mark.numbers === "" ? nothing : html`<p class="dim">${texts.inMission(mark.numbers)}</p>`}
      ${one.problem ? html`<p class="bad">${texts.cannotRead} ${said(one.problem, one.problem_wording)}</p>` : nothing}
      <div class="buttons">
        <button class="main" id="measure" ?disabled=${!mayPlan()} @click=${() => added(addMeasures([String(one.id)]))}>
          ${icon("gauge", 16)} ${texts.measure}
        </button>
        ${stands ? this.stands(texts.driveHere, stands, "WAYPOINT") : nothing}
        <button @click=${() => (lookSignal.value = { kind: "checkpoint", id: String(one.id) })}>${texts.look}</button>
      </div>`;
  }

  private place(name: string, pose: Pose, dock: number | null) {
    const texts = t().scene;
    const area = world.value?.docks.find((one) => one.area === dock)?.area;
    return html`<div class="buttons">
      ${this.stands(texts.driveHere, pose, dock === null ? name : "DOCK")}
      ${setsStart.value
        ? html`<button ?disabled=${!mayPlan()} @click=${() => added(addStart(pose, area))}>
            ${icon("flag", 16)} ${texts.startHere}
          </button>`
        : nothing}
    </div>`;
  }

  private stands(label: string, pose: Pose, name: string) {
    return html`<button ?disabled=${!mayPlan()} @click=${() => added(addTask("WAYPOINT", name, { pose }))}>
      ${icon("drive", 16)} ${label}
    </button>`;
  }

  private obstacle({ id, size: [x, y, z] }: Obstacle) {
    const texts = t().scene;
    return html`<p class="dim">${texts.size(figure(x), figure(y), figure(z))}</p>
      <div class="buttons">
        <button class="danger" ?disabled=${!mayPlan()} @click=${() => void removeObstacle(id)}>
          ${icon("bin", 16)} ${texts.remove}
        </button>
      </div>`;
  }

  private fault(list: FaultList, index: number) {
    const fault = faultsOf(list)[index];
    if (fault === undefined) return nothing;
    const name = faultText(fault.kind);
    const edit = () => {
      openedFault.value = { list, index };
      openMark.value = null;
    };
    return html`<p class="dim">${faultSummary(fault)}</p>
      <div class="buttons">
        <button @click=${edit}>${t().faults.edit(name)}</button>
        <button class="danger" @click=${() => removeFault(list, index)}>${icon("bin", 16)} ${t().scene.remove}</button>
      </div>`;
  }

  /** Place the card beside its object, completely inside the view. */
  private stand(view: SceneView, mark: Mark): void {
    const seen = view.stage.project(mark.at);
    const { width, height } = view.stage.size;
    const tall = Math.max(120, this.clientHeight);
    const right = (seen?.x ?? 0) + BESIDE;
    const left = right + WIDTH + MARGIN > width ? (seen?.x ?? 0) - BESIDE - WIDTH : right;
    const within = (at: number, most: number) => Math.round(Math.max(MARGIN, Math.min(at, most)));
    const x = within(left, width - WIDTH - MARGIN);
    const y = within((seen?.y ?? 0) - 30, height - tall - MARGIN);
    this.style.setProperty("transform", `translate(${x}px, ${y}px)`);
  }

  private onKey(event: KeyboardEvent): void {
    if (event.key !== "Escape") return;
    openMark.value = null;
    event.stopPropagation();
    event.preventDefault();
  }
}

/** Close the card once a task is added: it would cover the list and the site where the task appears. */
function added(adding: Promise<boolean>): void {
  void adding.then((done) => {
    if (done) openMark.value = null;
  });
}
