/** The colours of the scene, which follow the page's theme. */

import { effect, type Signal, signal } from "@preact/signals-core";

import { theme } from "../state/session";

export interface Colours {
  readonly dark: boolean;
  readonly sky: string;
  readonly skyLight: string;
  readonly groundLight: string;
  readonly text: string;
  readonly accent: string;
  readonly good: string;
  readonly warn: string;
  readonly bad: string;
  readonly person: string;
  readonly dim: string;
}

export const colours: Signal<Colours> = signal(read("light"));

effect(() => {
  const now = theme.value;
  // The page's style changes in the same task.
  queueMicrotask(() => (colours.value = read(now)));
});

function read(now: "light" | "dark"): Colours {
  const dark = now === "dark";
  const style = getComputedStyle(document.documentElement);
  const of = (name: string) => style.getPropertyValue(`--${name}`).trim() || "#808080";
  return {
    dark,
    sky: dark ? "#131a22" : "#e3eaf2",
    skyLight: dark ? "#c4d4ea" : "#ffffff",
    groundLight: dark ? "#39434f" : "#9aa4b0",
    text: of("text"),
    accent: of("accent"),
    good: of("good"),
    warn: of("warn"),
    bad: of("bad"),
    person: of("person"),
    dim: of("dim"),
  };
}
