/** The floors as a stack of small plans; a click shows the site up to that floor. */

import { svg } from "lit";

import type { WorldFloor } from "../api/types";
import { floorOf } from "../model/standing-map";
import { shownRun } from "../state/run";
import { shownFloor } from "../state/view";
import { checkpointsById, world } from "../state/world";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement, property, state } from "../ui/element";
import { icon } from "../ui/icons";
import { measuring } from "./marks";
import { floating } from "./style";
import type { SceneView } from "./view";

const MANY = 8;

@customElement("argo-scene-floors")
export class SceneFloors extends PageElement {
  static override styles = [
    floating,
    css`
      :host {
        inset: 8px auto auto 8px;
      }
      .panel {
        display: grid;
        gap: 1px;
        max-height: calc(100cqh - 76px);
        padding: 3px;
        overflow: auto;
      }
      button {
        justify-content: start;
        gap: 8px;
        min-height: 28px;
        padding: 1px 8px 1px 4px;
        border-color: transparent;
        background: none;
        font-size: 12px;
      }
      svg {
        flex: none;
        width: 46px;
        height: 24px;
        transform: skewX(-22deg);
      }
      .few svg {
        height: 28px;
      }
      rect {
        fill: var(--line);
      }
      .hides rect {
        opacity: 0.35;
      }
      [aria-checked="true"] {
        background: var(--chosen);
        border-color: var(--accent);
        font-weight: 600;
      }
      [aria-checked="true"] rect {
        fill: var(--accent);
      }
      circle {
        fill: var(--text);
      }
      .unfold {
        display: none;
      }
      @container (max-width: 560px) or (max-height: 300px) {
        .unfold {
          display: block;
          width: max-content;
          margin-bottom: 4px;
        }
        [role="radiogroup"] {
          max-height: calc(100cqh - 60px);
          box-sizing: border-box;
        }
        .folded {
          display: none;
        }
      }
      circle.robot {
        fill: var(--warn);
      }
    `,
  ];

  @property({ attribute: false }) view: SceneView | null = null;
  /** Whether the floors are shown in a small scene. */
  @state() private unfolded = false;

  constructor() {
    super();
    this.listen("pointerdown", (event) => {
      if (!event.composedPath().includes(this)) this.unfolded = false;
    });
  }

  override render() {
    const site = world.value;
    if (site === null) return nothing;
    const texts = t().scene;
    const floors = [...site.floors].reverse();
    const shown = shownFloor.value;
    const now = shown === null ? texts.allFloors : texts.floor(shown);
    return html`<div class="panel unfold">
        <button
          aria-label=${`${texts.floors}: ${now}`}
          title=${texts.floors}
          aria-expanded=${this.unfolded}
          @click=${() => (this.unfolded = !this.unfolded)}
        >
          ${icon("floors", 18)} ${shown ?? texts.allFloors}
        </button>
      </div>
      <div
      class="panel ${floors.length <= MANY ? "few" : ""} ${this.unfolded ? "" : "folded"}"
      role="radiogroup"
      aria-label=${texts.floors}
      @keydown=${this.onKey}
    >
      ${this.button(null, shown === null, html`${texts.allFloors}`, false)}
      ${floors.map((floor) =>
        this.button(
          floor.number,
          shown === floor.number,
          html`${this.plan(floor)} ${floor.number}`,
          shown !== null && floor.number > shown,
        ),
      )}
    </div>`;
  }

  private button(number: number | null, checked: boolean, content: unknown, hides: boolean) {
    const label = number === null ? t().scene.allFloors : t().scene.floor(number);
    return html`<button
      role="radio"
      class=${hides ? "hides" : ""}
      aria-checked=${checked}
      aria-label=${label}
      title=${label}
      data-floor=${number ?? ""}
      tabindex=${checked ? 0 : -1}
      @click=${() => this.show(number)}
    >
      ${content}
    </button>`;
  }

  /** Render the plates of a floor, the mission's checkpoints there, and the robot. */
  private plan(floor: WorldFloor) {
    const site = world.value;
    if (site === null) return nothing;
    const [x0, y0, x1, y1] = site.ground;
    const run = shownRun.value;
    const robot = run !== null && floorOf(site.floors, run.pose[2])?.number === floor.number ? run.pose : null;
    const planned = [...measuring.value.keys()].flatMap((id) => checkpointsById.value.get(id) ?? []);
    const size = Math.max(x1 - x0, y1 - y0) / 16;
    return html`<svg viewBox="0 0 ${x1 - x0} ${y1 - y0}" preserveAspectRatio="none" aria-hidden="true">
      ${floor.plates.map(
        ([a, b, c, d]) => svg`<rect x=${a - x0} y=${y1 - d} width=${c - a} height=${d - b} />`,
      )}
      ${planned
        .filter((one) => one.floor === floor.number)
        .map(({ position: [x, y] }) => svg`<circle cx=${x - x0} cy=${y1 - y} r=${size} />`)}
      ${robot ? svg`<circle class="robot" cx=${robot[0] - x0} cy=${y1 - robot[1]} r=${1.6 * size} />` : nothing}
    </svg>`;
  }

  private show(number: number | null): void {
    shownFloor.value = number;
    this.view?.camera.toFloor(world.value?.floors.find((floor) => floor.number === number) ?? null);
  }

  private onKey(event: KeyboardEvent): void {
    const by = { ArrowUp: -1, ArrowDown: 1, ArrowLeft: -1, ArrowRight: 1 }[event.key];
    const all = [...this.renderRoot.querySelectorAll<HTMLElement>("[role=radio]")];
    const next = by === undefined ? undefined : all[all.indexOf(event.target as HTMLElement) + by];
    if (!next) return;
    next.click();
    next.focus();
    event.preventDefault();
    event.stopPropagation();
  }
}
