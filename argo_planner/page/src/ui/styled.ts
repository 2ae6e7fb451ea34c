/** Computed styles: `<div ${styled({ width: "40%" })}>`. Lit's own `styleMap` first writes an attribute,
 * which the page's content security policy forbids. */

import { noChange, type ElementPart } from "lit";
import { Directive, directive } from "lit/directive.js";

type Styles = Readonly<Record<string, string>>;

class Styled extends Directive {
  override render(styles: Styles) {
    return styles; // for its type: `update` does the work
  }

  override update({ element }: ElementPart, [styles]: [Styles]) {
    const own = (element as HTMLElement | SVGElement).style;
    for (const [name, value] of Object.entries(styles)) own.setProperty(name, value);
    return noChange;
  }
}

export const styled = directive(Styled);
