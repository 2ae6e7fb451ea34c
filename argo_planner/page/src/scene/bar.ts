/** Tools, camera buttons, and display settings. */

import { runIsOn, shownRun } from "../state/run";
import { mayPlan } from "../state/session";
import { following, shownFloor, tool, type Tool } from "../state/view";
import { t } from "../texts";
import { iconButton, options } from "../ui/controls";
import { css, customElement, html, nothing, PageElement, property, state } from "../ui/element";
import type { Icon } from "../ui/icons";
import { chooseFollowing, followChoices } from "./following";
import { floating } from "./style";
import { edgesMove, hidden, hide, labelsShown, pathsShown } from "./settings";
import { HIDEABLE } from "./site";
import type { SceneView } from "./view";
import type { Signal } from "@preact/signals-core";

const TURN = 0.6;
const SIGNS: Readonly<Record<Tool, Icon>> = { select: "arrow", navigate: "drive", obstacle: "obstacle", fault: "warning" };

@customElement("argo-scene-bar")
export class SceneBar extends PageElement {
  static override styles = [
    floating,
    css`
      :host {
        inset: 8px 8px auto auto;
        display: flex;
        gap: 8px;
        align-items: start;
      }
      .panel {
        display: flex;
        padding: 2px;
      }
      .unfold {
        display: none;
      }
      @container (max-width: 560px) {
        :host {
          flex-direction: column;
          align-items: end;
          gap: 4px;
        }
        .unfold {
          display: flex;
        }
        .panel {
          flex-wrap: wrap;
          justify-content: end;
          max-width: 148px;
        }
        .panel.folded {
          display: none;
        }
      }
      .settings {
        position: absolute;
        top: 42px;
        right: 0;
        display: grid;
        gap: 6px;
        width: 250px;
        max-width: calc(100cqw - 16px);
        max-height: calc(100cqh - 60px);
        padding: 10px 12px;
        overflow: auto;
        box-sizing: border-box;
      }
      .settings label {
        display: flex;
        align-items: center;
        gap: 8px;
      }
      select {
        flex: 1;
      }
    `,
  ];

  @property({ attribute: false }) view: SceneView | null = null;
  @state() private open = false;
  /** Whether the buttons are shown in a small scene. */
  @state() private unfolded = false;

  constructor() {
    super();
    this.listen("pointerdown", (event) => {
      if (!event.composedPath().includes(this)) this.open = this.unfolded = false;
    });
  }

  override render() {
    const texts = t().scene;
    const { view } = this;
    if (view === null) return nothing;
    const { camera } = view;
    const folded = this.unfolded ? "" : "folded";
    return html`
      <div class="panel unfold">
        ${iconButton(SIGNS[tool.value], texts.tools, () => (this.unfolded = !this.unfolded), { expanded: this.unfolded })}
      </div>
      <div class="panel ${folded}" role="toolbar" aria-label=${texts.tools}>
        ${this.tool("select", texts.toolSelect, "Esc")} ${this.tool("navigate", texts.toolNavigate, "n")}
        ${this.tool("obstacle", texts.toolObstacle, "o")}
      </div>
      <div class="panel ${folded}" role="toolbar" aria-label=${texts.view}>
        ${iconButton("whole", texts.showAll, () => void camera.showAll(shownFloor.value))}
        ${iconButton("above", texts.fromAbove, () => camera.topView())}
        ${iconButton("circle-left", texts.turnLeft, () => camera.turn(-TURN))}
        ${iconButton("circle-right", texts.turnRight, () => camera.turn(TURN))}
        ${iconButton("add", texts.nearer, () => camera.zoom(1))}
        ${iconButton("minus", texts.farther, () => camera.zoom(-1))}
        ${iconButton("settings", texts.settings, () => (this.open = !this.open), { expanded: this.open })}
      </div>
      ${this.open ? this.settings() : nothing}
    `;
  }

  private tool(which: Tool, label: string, key: string) {
    const may = which === "select" || mayPlan();
    return iconButton(SIGNS[which], label, () => (tool.value = which), {
      title: may ? `${label} (${key})` : t().scene.mayNot,
      pressed: tool.value === which,
      disabled: !may,
    });
  }

  private settings() {
    const texts = t().scene;
    const box = (label: string, value: boolean, set: (on: boolean) => void) =>
      html`<label>
        <input type="checkbox" .checked=${value} @change=${(event: Event) => set((event.target as HTMLInputElement).checked)} />
        ${label}
      </label>`;
    const kept = (one: Signal<boolean>) => (on: boolean) => (one.value = on);
    const canFollow = shownRun.value !== null || runIsOn.value;
    return html`<div
      class="panel settings"
      @keydown=${(event: KeyboardEvent) => {
        if (event.key !== "Escape") return;
        this.open = false;
        this.renderRoot.querySelector<HTMLElement>(".panel:not(.unfold) [aria-expanded]")?.focus();
        event.stopPropagation();
      }}
      @focusout=${(event: FocusEvent) => {
        const to = event.relatedTarget as Element | null;
        if (to !== null && to.closest(".settings, [aria-expanded]") === null) this.open = false;
      }}
    >
      ${HIDEABLE.map((one) => box(texts.hide[one], !hidden.value.has(one), (on) => hide(one, !on)))}
      ${box(texts.labels, labelsShown.value, kept(labelsShown))} ${box(texts.paths, pathsShown.value, kept(pathsShown))}
      ${box(texts.edges, edgesMove.value, kept(edgesMove))}
      <label>
        ${texts.follow}
        <select ?disabled=${!canFollow} @change=${chooseFollowing}>
          ${options(followChoices(), following.value)}
        </select>
      </label>
    </div>`;
  }
}
