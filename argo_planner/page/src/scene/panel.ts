/** The look of what floats over the picture. */

import { css } from "../ui/element";

export const floating = css`
  :host {
    position: absolute;
  }
  .panel {
    border: 1px solid var(--line);
    border-radius: var(--round);
    background: color-mix(in srgb, var(--surface) 94%, transparent);
    box-shadow: var(--shadow);
  }
`;
