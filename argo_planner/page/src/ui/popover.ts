/** Menus that the browser itself opens and closes. */

/** Closes a menu that the focus has left. */
export function closeLeft(event: FocusEvent): void {
  const menu = event.currentTarget as HTMLElement;
  const to = event.relatedTarget;
  if (!(to instanceof Element) || menu.contains(to)) return;
  if (!to.matches("[popovertarget]")) menu.hidePopover(); // its button closes it by itself
}

/** Gives the focus back to the button of a menu that was closed with the focus in it. */
export function closed(event: ToggleEvent): void {
  const menu = event.currentTarget as HTMLElement;
  const root = menu.getRootNode() as ShadowRoot;
  if (event.newState === "closed" && menu.contains(root.activeElement))
    root.querySelector<HTMLElement>(`[popovertarget="${menu.id}"]`)?.focus();
}
