/** Focus restoration: if the focused element disappears or is disabled, the nearest remaining element gets
 * the focus. Otherwise keys and screen readers would start at the top again. */

const FOCUSABLE = "button, a[href], input, select, textarea, summary, [tabindex]";

/** The last focused element and its ancestors, from the inside out. */
let last: readonly HTMLElement[] = [];
let checkPending = false;

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
