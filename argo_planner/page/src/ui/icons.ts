/** Icons as lines in a 24 × 24 grid, in the colour of the text. */

import { svg } from "lit";
import { html } from "./element";

const PATHS = {
  above: "M12 4v12M7 11l5 5 5-5M5 20h14",
  add: "M12 5v14M5 12h14",
  arrow: "M6 3l12 9-6 1-3 6z",
  back: "M15 5l-7 7 7 7",
  bin: "M4 7h16M9 7V4h6v3M6 7l1 13h10l1-13M10 11v6M14 11v6",
  camera: "M4 8h3l2-3h6l2 3h3v11H4zM12 10a3.5 3.5 0 1 0 .01 0",
  check: "M5 13l4 4L19 7",
  "circle-left": "M5 12a7 7 0 1 0 3-6M8 2v4h4",
  "circle-right": "M19 12a7 7 0 1 1-3-6M16 2v4h-4",
  clock: "M12 3a9 9 0 1 0 .01 0M12 7v5l3.5 2",
  close: "M6 6l12 12M18 6L6 18",
  copy: "M9 9h11v11H9zM5 15H4V4h11v1",
  down: "M6 9l6 6 6-6",
  drive: "M4 18c6 0 2-10 8-10s2 10 8 10M17 15l3 3-3 3",
  flag: "M6 21V4h12l-3 4 3 4H6",
  floors: "M12 4l9 4-9 4-9-4zM3 12l9 4 9-4M3 16l9 4 9-4",
  folder: "M3 19V5h6l2 3h10v11z",
  gauge: "M4 17a9 9 0 1 1 16 0M12 14l4-5",
  group: "M4 6h16M8 12h12M8 18h12",
  hand: "M8 12V6a1.5 1.5 0 0 1 3 0v5V4.500a1.500 1.500 0 0 1 3 0V11V6a1.500 1.500 0 0 1 3 0v8c0 4-2 7-6 7s-5-2-7-6l-1-2c1-1 3-1 5 1",
  keys: "M3 7h18v10H3zM7 11h.01M11 11h.01M15 11h.01M8 14h8",
  menu: "M4 7h16M4 12h16M4 17h16",
  minus: "M5 12h14",
  moon: "M20 14A8 8 0 0 1 10 4a8 8 0 1 0 10 10z",
  more: "M5 12h.01M12 12h.01M19 12h.01",
  obstacle: "M4 20l4-12h8l4 12zM6.500 13h11",
  pause: "M8 5v14M16 5v14",
  play: "M7 4l13 8-13 8z",
  plan: "M4 4h16v16H4zM4 12h7M11 12v3M14 4v8h6",
  print: "M7 8V3h10v5M7 17H4V8h16v9h-3M7 14h10v7H7z",
  question: "M9 9a3 3 0 1 1 4.500 2.600c-1 .6-1.500 1.200-1.500 2.400M12 18h.01M12 3a9 9 0 1 0 .01 0",
  reaction: "M13 3L5 14h6l-1 7 8-11h-6z",
  redo: "M19 9h-9a5 5 0 0 0 0 10h4M15 5l4 4-4 4",
  right: "M9 6l6 6-6 6",
  route: "M6 19a2 2 0 1 0 .01 0M18 5a2 2 0 1 0 .01 0M6 17V9a4 4 0 0 1 8 0v6a4 4 0 0 0 4 0V9",
  search: "M10.500 4a6.500 6.500 0 1 0 .01 0M15 15l6 6",
  script: "M6 3h9l4 4v14H6zM9 11h7M9 15h7",
  settings: "M4 7h10M18 7h2M4 17h2M10 17h10M16 5v4M8 15v4",
  skip: "M5 5l9 7-9 7zM18 5v14",
  stop: "M6 6h12v12H6z",
  sun: "M12 8a4 4 0 1 0 .01 0M12 2v2M12 20v2M2 12h2M20 12h2M5 5l1.500 1.500M17.500 17.500L19 19M5 19l1.500-1.500M17.500 6.500L19 5",
  "turn-left": "M5 9h8a5 5 0 0 1 5 5v5M9 5L5 9l4 4",
  "turn-right": "M19 9h-8a5 5 0 0 0-5 5v5M15 5l4 4-4 4",
  up: "M6 15l6-6 6 6",
  undo: "M5 9h9a5 5 0 0 1 0 10h-4M9 5L5 9l4 4",
  wait: "M7 3h10M7 21h10M8 3c0 5 8 5 8 9s-8 4-8 9M16 3c0 5-8 5-8 9s8 4 8 9",
  wand: "M4 20L15 9M13 7l4 4M18 3v4M16 5h4M20 13v3M18.500 14.500h3",
  warning: "M12 4l9 16H3zM12 10v4M12 17h.01",
  whole: "M4 9V4h5M15 4h5v5M20 15v5h-5M9 20H4v-5",
} as const;

export type Icon = keyof typeof PATHS;

/** Render an icon. Its meaning is given beside it or by the label of its button. */
export function icon(name: Icon, size = 18) {
  return html`<svg
    viewBox="0 0 24 24"
    width=${size}
    height=${size}
    fill="none"
    stroke="currentColor"
    stroke-width="2"
    stroke-linecap="round"
    stroke-linejoin="round"
    aria-hidden="true"
  >
    ${svg`<path d=${PATHS[name]} />`}
  </svg>`;
}
