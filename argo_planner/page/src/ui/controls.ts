/** Buttons and choices that parts of the page have in common. */

import { html, nothing } from "./element";
import { icon, type Icon } from "./icons";

interface IconButton {
  /** What the pointer shows, where it is more or less than the label. */
  readonly title?: string | typeof nothing;
  readonly disabled?: boolean;
  readonly pressed?: boolean;
  readonly expanded?: boolean;
  readonly size?: number;
  /** Id of the menu that it opens. */
  readonly opens?: string;
  /** Further classes. */
  readonly look?: string;
}

/** A button that shows an icon only; the label is what it says to who can't see it. */
export function iconButton(sign: Icon, label: string, act: ((event: Event) => unknown) | null, more: IconButton = {}) {
  return html`<button
    type="button"
    class="icon ${more.look ?? "bare"}"
    aria-label=${label}
    title=${more.title ?? label}
    aria-pressed=${more.pressed ?? nothing}
    aria-expanded=${more.expanded ?? nothing}
    popovertarget=${more.opens ?? nothing}
    ?disabled=${more.disabled ?? false}
    @click=${act}
  >
    ${icon(sign, more.size)}
  </button>`;
}

type Option<Value> = readonly [value: Value, label: unknown];

/** The options of a choice. */
export function options<Value>(all: readonly Option<Value>[], chosen?: Value) {
  return all.map(
    ([value, label]) => html`<option value=${String(value)} .selected=${value === chosen}>${label}</option>`,
  );
}

/** A choice of a form with its label. */
export function choice<Value>(label: string, name: string, all: readonly Option<Value>[], chosen?: Value) {
  return html`<label>
    ${label}
    <select name=${name}>
      ${options(all, chosen)}
    </select>
  </label>`;
}

/** What is chosen or typed in the field that an event comes from. */
export function valueOf(event: Event): string {
  return (event.target as HTMLInputElement | HTMLSelectElement).value;
}
