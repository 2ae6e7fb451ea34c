/** Styles of elements over the scene. */

import { css } from "../ui/element";

/** Styles of elements that float over the scene. */
export const floating = css`
  :host {
    position: absolute;
  }
  .panel {
    border: 1px solid var(--line);
    border-radius: var(--round);
    background: color-mix(in srgb, var(--surface) 94%, transparent);
    box-shadow: var(--shadow);
  }
`;

export const sceneStyle = css`
  :host {
    position: relative;
    container-type: size; /* what floats over the scene folds when it is small */
    overflow: hidden;
    user-select: none;
  }
  #picture,
  #picture:focus-visible::after,
  #labels {
    position: absolute;
    inset: 0;
  }
  #picture {
    outline: none;
  }
  #picture:focus-visible::after {
    content: "";
    border: 2px solid var(--accent);
    pointer-events: none;
  }
  canvas {
    position: absolute;
    width: 100%;
    height: 100%;
    touch-action: none;
    cursor: grab;
  }
  canvas:active {
    cursor: grabbing;
  }
  canvas.over {
    cursor: pointer;
  }
  canvas.navigate,
  canvas.obstacle,
  canvas.fault {
    cursor: crosshair;
  }
  #labels {
    overflow: hidden;
    pointer-events: none;
  }
  .label {
    position: absolute;
    display: flex;
    align-items: center;
    gap: 4px;
    height: 20px;
    padding: 0 5px;
    border: 1px solid transparent;
    border-radius: 10px;
    background: color-mix(in srgb, var(--surface) 82%, transparent);
    color: var(--text);
    font-size: 12px;
    line-height: 18px;
    white-space: nowrap;
    will-change: transform;
  }
  .label .name {
    overflow: hidden;
    text-overflow: ellipsis;
  }
  .label .numbers {
    flex: none;
    margin-left: -3px;
    padding: 0 5px;
    border-radius: 8px;
    background: var(--text);
    color: var(--surface);
    font-weight: 600;
    font-size: 11px;
    line-height: 15px;
  }
  .label .value {
    flex: none;
    font-weight: 600;
    color: var(--good);
  }
  .label.plain,
  .label.dim {
    color: var(--dim);
  }
  .label.planned {
    font-weight: 600;
  }
  .label.chosen {
    border-color: var(--accent);
    background: var(--chosen);
    font-weight: 600;
  }
  .label.chosen .numbers {
    background: var(--accent);
    color: var(--on-accent);
  }
  .label.active {
    border-color: var(--warn);
    background: var(--warn-ground);
  }
  .label.bad {
    border-color: var(--bad);
  }
  .label.bad .value {
    color: var(--bad);
  }
  .label.behind {
    opacity: 0.62;
  }
  #frame {
    position: absolute;
    border: 2px dashed var(--accent);
    background: color-mix(in srgb, var(--accent) 12%, transparent);
    pointer-events: none;
  }
  #verdict,
  #robot {
    position: absolute;
    top: 0;
    left: 0;
    background: var(--raised);
    white-space: nowrap;
    pointer-events: none;
  }
  #verdict {
    padding: 2px 8px;
    border-left: 4px solid var(--good);
    border-radius: 4px;
    box-shadow: var(--shadow);
    font-size: 13px;
  }
  #robot {
    padding: 1px 8px;
    border: 2px solid var(--accent);
    border-radius: 6px;
    font-size: 12px;
    font-weight: 600;
  }
  #robot.supervised {
    border-color: var(--person);
    background: var(--person-ground);
    color: var(--person);
  }
  #robot.paused,
  #robot.stopping {
    border-color: var(--warn);
    border-style: dashed;
    background: var(--warn-ground);
    color: var(--warn);
  }
  #robot.reacting,
  #robot.interrupted {
    border-color: var(--bad);
    background: var(--bad-ground);
    color: var(--bad);
  }
  #verdict.bad {
    border-color: var(--bad);
    color: var(--bad);
  }
  .hint,
  .loading {
    position: absolute;
    top: 52px;
    left: 50%;
    translate: -50% 0;
    max-width: 60%;
    padding: 4px 12px;
    border-radius: 14px;
    background: var(--raised);
    box-shadow: var(--shadow);
    text-align: center;
    pointer-events: none;
  }
  .loading {
    top: 45%;
  }
  .nothing {
    padding: 40px;
    text-align: center;
  }
`;
