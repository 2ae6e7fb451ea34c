/** The base of all elements: Lit elements that render again when a signal changes that they have read, with
 * common styles of buttons and fields. */

import { SignalWatcher } from "@lit-labs/preact-signals";
import { effect } from "@preact/signals-core";
import { css, type CSSResultGroup, LitElement } from "lit";

import { keepFocus, noteFocus } from "./focus";

export { css, html, nothing } from "lit";
export { customElement, property, query, state } from "lit/decorators.js";

const look = css`
  :host {
    display: block;
    box-sizing: border-box;
    color: var(--text);
  }
  :host([hidden]),
  [hidden] {
    display: none !important; /* whatever else says how it is laid out */
  }
  *,
  *::before,
  *::after {
    box-sizing: border-box;
  }
  h1,
  h2,
  h3 {
    margin: 0;
    line-height: 1.25;
    font-weight: 600;
  }
  h1 {
    font-size: 20px;
  }
  h2 {
    font-size: 15px;
  }
  h3 {
    font-size: 13px;
  }
  p,
  ul,
  ol {
    margin: 0;
  }
  ul,
  ol {
    padding: 0;
    list-style: none;
  }
  label {
    display: grid;
    gap: 2px;
  }
  summary {
    cursor: pointer;
  }
  button,
  input,
  select,
  textarea {
    font: inherit;
    color: inherit;
  }
  button {
    display: inline-flex;
    align-items: center;
    justify-content: center;
    gap: 6px;
    min-height: 30px;
    padding: 3px 10px;
    border: 1px solid var(--line);
    border-radius: 6px;
    background: var(--raised);
    cursor: pointer;
  }
  button:hover:not(:disabled, [aria-disabled="true"]) {
    border-color: var(--accent);
  }
  button:disabled,
  button[aria-disabled="true"] {
    color: var(--dim);
    background: var(--sunken);
    cursor: default;
  }
  button.main {
    border-color: var(--accent);
    background: var(--accent);
    color: var(--on-accent);
  }
  button.main:disabled,
  button.main[aria-disabled="true"] {
    border-color: var(--line);
    background: var(--sunken);
    color: var(--dim);
  }
  button.danger {
    color: var(--bad);
  }
  button.bare {
    border-color: transparent;
    background: none;
  }
  button.icon {
    width: 30px;
    padding: 0;
  }
  button[aria-pressed="true"] {
    border-color: var(--accent);
    background: var(--chosen);
  }
  input:not([type="checkbox"], [type="radio"], [type="range"]),
  select,
  textarea {
    min-height: 30px;
    padding: 3px 8px;
    border: 1px solid var(--line);
    border-radius: 6px;
    background: var(--surface);
  }
  input[type="checkbox"],
  input[type="radio"],
  input[type="range"] {
    accent-color: var(--accent);
  }
  input:user-invalid {
    border-color: var(--bad);
  }
  :focus-visible {
    outline: 2px solid var(--accent);
    outline-offset: 1px;
  }
  a {
    color: var(--accent);
  }
  [popover] {
    position: fixed;
    margin: 0;
    padding: 12px;
    border: 1px solid var(--line);
    border-radius: var(--round);
    background: var(--raised);
    color: var(--text);
    box-shadow: var(--shadow);
  }
  .dim {
    color: var(--dim);
  }
  .row {
    display: flex;
    align-items: center;
    gap: var(--gap);
  }
  .grow {
    flex: 1;
    min-width: 0;
  }
  .unseen {
    position: absolute;
    width: 1px;
    height: 1px;
    margin: -1px;
    overflow: hidden;
    clip-path: inset(50%);
    white-space: nowrap;
  }
`;

declare global {
  interface WindowEventMap {
    "focus-list": CustomEvent;
    "open-details": CustomEvent<string | undefined>;
    "open-run": CustomEvent;
    visibilitychange: Event;
  }
}

/** An element of the page; its own styles follow the common ones. */
export class PageElement extends SignalWatcher(LitElement) {
  protected static override finalizeStyles(styles: CSSResultGroup = []) {
    return super.finalizeStyles([look, styles]);
  }

  constructor() {
    super();
    this.addController({ hostUpdated: keepFocus });
  }

  protected override createRenderRoot(): HTMLElement | DocumentFragment {
    const root = super.createRenderRoot();
    root.addEventListener("focusin", noteFocus);
    return root;
  }

  /** Listen to an event of the window while the element is connected. */
  protected listen<Type extends keyof WindowEventMap>(
    type: Type,
    heard: (event: WindowEventMap[Type]) => void,
    capture = false,
  ): void {
    this.addController({
      hostConnected: () => addEventListener(type, heard, capture),
      hostDisconnected: () => removeEventListener(type, heard, capture),
    });
  }

  /** Run a function now, and again whenever a signal changes that it reads, while the element is connected. */
  protected watch(work: () => void): void {
    let stop = () => {};
    this.addController({
      hostConnected: () => (stop = effect(work)),
      hostDisconnected: () => stop(),
    });
  }
}
