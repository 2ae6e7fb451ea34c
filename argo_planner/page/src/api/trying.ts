/** Trying again until the service is reached. */

import { Unreached } from "./client";

export function pause(ms: number): Promise<void> {
  return new Promise((resolve) => setTimeout(resolve, ms));
}

/** What a request brings, which is sent again every `ms` while the service is not reached and it is
 * still wanted. Throws `Refusal`, and `Unreached` where it is not wanted any more. */
export async function untilReached<T>(send: () => Promise<T>, wanted: () => boolean, ms: number): Promise<T> {
  for (;;)
    try {
      return await send();
    } catch (error) {
      if (!(error instanceof Unreached) || !wanted()) throw error;
      await pause(ms);
      if (!wanted()) throw error;
    }
}
