/** The focus stays near where it was: where the element that has it goes, or can't be used any more, it
 * goes to what is left beside it. Without that, keys and screen readers begin anew at the top. */

const FOCUSABLE = "button, a[href], input, select, textarea, summary, [tabindex]";

/** The element that had the focus last, and all around it, from the inside out. */
let last: readonly HTMLElement[] = [];
let asked = false;

/** Notes what has the focus in a shadow tree. A move within a tree is not told outside of it, so each of them
 * is listened to. */
export function noteFocus(event: Event): void {
  const at = event.composedPath()[0];
  if (at instanceof HTMLElement && at === event.target) last = [...around(at)];
}

function* around(element: HTMLElement): Generator<HTMLElement> {
  for (let at: Node | null = element; at !== null; at = at instanceof ShadowRoot ? at.host : at.parentNode)
    if (at instanceof HTMLElement) yield at;
}

/** Looks, once all is drawn, whether the focus was lost. */
export function keepFocus(): void {
  if (asked) return;
  asked = true;
  requestAnimationFrame(() => {
    asked = false;
    const [had] = last;
    if (had === undefined || document.activeElement !== document.body) return;
    if (had.isConnected && !had.matches(":disabled") && had.checkVisibility()) return; // it was let go
    const beside = nearest();
    if (beside) beside.focus();
    else dispatchEvent(new CustomEvent("focus-list"));
  });
}

/** What is left beside it in the same part of the page. */
function nearest(): HTMLElement | undefined {
  for (const part of last.slice(1)) {
    if (part.localName === "main" || part.localName === "argo-app") return undefined;
    if (!part.isConnected) continue;
    const found = [...within(part)].find(isUsable);
    if (found) return found;
    if (isUsable(part)) return part;
  }
  return undefined;
}

/** All that could have the focus in an element, shadow trees included, in the order of the page. */
function* within(element: HTMLElement): Generator<HTMLElement> {
  for (const inner of (element.shadowRoot ?? element).querySelectorAll<HTMLElement>("*")) {
    if (inner.matches(FOCUSABLE)) yield inner;
    if (inner.shadowRoot) yield* within(inner);
  }
}

function isUsable(element: HTMLElement): boolean {
  return element.matches(FOCUSABLE) && !element.matches(":disabled") && element.checkVisibility();
}
