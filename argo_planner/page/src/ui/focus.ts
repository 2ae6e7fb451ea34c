/** Focus restoration: if the focused element disappears or is disabled, the nearest remaining element gets
 * the focus. Otherwise keys and screen readers would start at the top again.
 *
 * If it is a field for text, which somebody else's edit may remove while a person types, nothing gets the focus,
 * and what is still typed goes nowhere: neither into another field nor to the keys of the page. */

const TEXT = "input:not([type='checkbox'], [type='radio'], [type='range'], [type='button']), textarea";
/** ms without a key after which the next key no longer continues a text */
const PAUSE_MS = 1_000;
const FOCUSABLE = "button, a[href], input, select, textarea, summary, [tabindex]";

/** The last focused element and its ancestors, from the inside out. */
let last: readonly HTMLElement[] = [];
let checkPending = false;
let lastKeyAt = -Infinity;

addEventListener("keydown", stopLostText, true);
addEventListener("pointerdown", () => (last = []), true);

/** Stop a key that continues a text whose field is gone. Keys that move the focus, and those with Ctrl, go on. */
function stopLostText(event: KeyboardEvent): void {
  const continues = performance.now() - lastKeyAt < PAUSE_MS;
  lastKeyAt = performance.now();
  const types = event.key.length === 1 || ["Enter", "Backspace", "Delete"].includes(event.key);
  if (!continues || !types || event.ctrlKey || event.metaKey || !isTextLost()) return;
  event.preventDefault();
  event.stopImmediatePropagation();
}

function isTextLost(): boolean {
  const [had] = last;
  return document.activeElement === document.body && had?.matches(TEXT) === true && !had.isConnected;
}

/** Record the focused element of a shadow tree. Moves inside a tree are not reported outside, so each tree is
 * listened to. */
export function noteFocus(event: Event): void {
  const at = event.composedPath()[0];
  if (at instanceof HTMLElement && at === event.target) last = [...ancestors(at)];
}

function* ancestors(element: HTMLElement): Generator<HTMLElement> {
  for (let at: Node | null = element; at !== null; at = at instanceof ShadowRoot ? at.host : at.parentNode)
    if (at instanceof HTMLElement) yield at;
}

/** Check after rendering whether the focus was lost, and restore it. */
export function keepFocus(): void {
  if (checkPending) return;
  checkPending = true;
  requestAnimationFrame(() => {
    checkPending = false;
    const [had] = last;
    if (had === undefined || document.activeElement !== document.body) return;
    if (had.isConnected && !had.matches(":disabled") && had.checkVisibility()) return; // the person moved the focus away
    if (had.matches(TEXT) && !had.isConnected) return; // what is typed next must not go to another field
    const beside = nearestUsable();
    if (beside) beside.focus();
    else dispatchEvent(new CustomEvent("focus-list"));
  });
}

/** Return the nearest usable element in the same part of the page. */
function nearestUsable(): HTMLElement | undefined {
  for (const part of last.slice(1)) {
    if (part.localName === "main" || part.localName === "argo-app") return undefined;
    if (!part.isConnected) continue;
    const found = [...focusableIn(part)].find(isUsable);
    if (found) return found;
    if (isUsable(part)) return part;
  }
  return undefined;
}

/** Yield all focusable elements in an element, including shadow trees, in document order. */
function* focusableIn(element: HTMLElement): Generator<HTMLElement> {
  for (const inner of (element.shadowRoot ?? element).querySelectorAll<HTMLElement>("*")) {
    if (inner.matches(FOCUSABLE)) yield inner;
    if (inner.shadowRoot) yield* focusableIn(inner);
  }
}

function isUsable(element: HTMLElement): boolean {
  return element.matches(FOCUSABLE) && !element.matches(":disabled") && element.checkVisibility();
}
