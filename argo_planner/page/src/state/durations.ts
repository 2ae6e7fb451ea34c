/** Durations that people type. The service reads them, as it reads those in scripts. */

import { client, responseData } from "../api/client";
import type { DurationReading } from "../api/types";

const KNOWN = new Map<string, DurationReading>();
const MOST_KNOWN = 100;

/** Return what a text says as a duration. Throws `Refusal` or `Unreached`. */
export async function readDuration(text: string): Promise<DurationReading> {
  const known = KNOWN.get(text);
  if (known !== undefined) return known;
  const reading = await responseData(client.GET("/api/durations", { params: { query: { text } } }));
  if (KNOWN.size >= MOST_KNOWN) KNOWN.clear();
  KNOWN.set(text, reading);
  return reading;
}
