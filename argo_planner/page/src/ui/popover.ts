/** Menus that the browser opens and closes (popovers). */

/** Close a menu when it loses the focus. */
export function closeOnFocusLoss(event: FocusEvent): void {
  const menu = event.currentTarget as HTMLElement;
  const to = event.relatedTarget;
  if (!(to instanceof Element) || menu.contains(to)) return;
  if (!to.matches("[popovertarget]")) menu.hidePopover(); // its button closes it by itself
}

/** Return the focus to the button of a menu that was closed with the focus in it. */
export function returnFocus(event: ToggleEvent): void {
  const menu = event.currentTarget as HTMLElement;
  const root = menu.getRootNode() as ShadowRoot;
  if (event.newState === "closed" && menu.contains(root.activeElement))
    root.querySelector<HTMLElement>(`[popovertarget="${menu.id}"]`)?.focus();
}
