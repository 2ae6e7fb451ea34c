/** Uploads of files to import. */

import { client } from "./client";

const LONGEST_NAME = 200;

/** Send a file. The answer is the summary of its mission, or the draft of a script of which lines are left. */
export function uploadFile(
  name: string,
  content: ArrayBuffer | string,
  areas: { start_area?: number; end_area?: number } = {},
) {
  return client.POST("/api/imports", {
    params: { query: { filename: name.slice(-LONGEST_NAME), ...areas } },
    body: content as never,
    bodySerializer: (body) => body,
    headers: { "Content-Type": "application/octet-stream" },
  });
}
