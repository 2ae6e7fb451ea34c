/** The compass and the scale bar. */

import { Vector3 } from "three";

import { t } from "../texts";
import { css, customElement, html, nothing, PageElement, property } from "../ui/element";
import { world } from "../state/world";
import { styled } from "../ui/styled";
import { dependOn } from "../state/depend-on";
import { floating } from "./style";
import type { SceneView } from "./view";

const LENGTHS = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50];
const LONGEST_PX = 110;

@customElement("argo-scene-compass")
export class SceneCompass extends PageElement {
  static override styles = [
    floating,
    css`
      :host {
        inset: auto auto 8px 10px;
        display: flex;
        align-items: end;
        gap: 12px;
        pointer-events: none;
        font-size: 12px;
      }
      .needle {
        width: 40px;
        height: 40px;
      }
      .bar {
        height: 6px;
        margin-top: 2px;
        border: 2px solid var(--text);
        border-top: 0;
      }
      .scale {
        text-align: center;
        text-shadow: 0 0 3px var(--ground);
      }
      text {
        fill: var(--text);
        font-size: 11px;
        font-weight: 600;
        text-anchor: middle;
      }
      .face {
        fill: color-mix(in srgb, var(--surface) 80%, transparent);
        stroke: var(--line);
      }
      .north {
        fill: var(--bad);
      }
      .south {
        fill: var(--dim);
      }
    `,
  ];

  @property({ attribute: false }) view: SceneView | null = null;

  override render() {
    const { view } = this;
    if (view === null) return nothing;
    dependOn(view.frames);
    const turn = (view.camera.controls.azimuthAngle * 180) / Math.PI;
    const north = ((world.value?.north ?? Math.PI / 2) * 180) / Math.PI - 90;
    const tilt = Math.max(0.35, Math.cos(view.camera.controls.polarAngle));
    const a = (turn - north).toFixed(1);
    const { length, width } = this.scale(view);
    return html`<svg class="needle" viewBox="-20 -20 40 40" aria-hidden="true">
        <circle class="face" r="19" />
        <g transform="scale(1 ${tilt.toFixed(2)}) rotate(${a})">
          <path class="north" d="M0-13L5 2H-5z" />
          <path class="south" d="M0 13L5 2H-5z" />
        </g>
        <text
          x=${(15 * Math.sin((turn - north) * (Math.PI / 180))).toFixed(1)}
          y=${(4 - 15 * tilt * Math.cos((turn - north) * (Math.PI / 180))).toFixed(1)}
        >
          ${t().scene.north}
        </text>
      </svg>
      <div class="scale">
        <span id="length">${length} m</span>
        <div class="bar" ${styled({ width: `${width}px` })}></div>
      </div>`;
  }

  /** Return the longest round length that fits, at the camera's target. */
  private scale(view: SceneView): { readonly length: number; readonly width: number } {
    const { camera } = view.stage;
    const away = camera.position.distanceTo(view.camera.controls.getTarget(new Vector3()));
    const metre = view.stage.size.height / (2 * away * Math.tan((camera.fov * Math.PI) / 360));
    const length = LENGTHS.findLast((one) => one * metre <= LONGEST_PX) ?? 0.1;
    return { length, width: Math.round(length * metre) };
  }
}
