import { describe, expect, it } from "vitest";

import { client, Refusal, responseData, Unreached } from "../../src/api/client";

/** Return an answer to any request: a response with this body. */
function answering(body: BodyInit, status = 200) {
  const headers = { "Content-Type": "application/json" };
  const fetch = () => Promise.resolve(new Response(body, { status, headers }));
  return responseData(client.GET("/api/service", { fetch }));
}

/** Return a body whose connection is lost after its first bytes. */
function lostBody(): ReadableStream {
  return new ReadableStream({
    pull(controller) {
      controller.enqueue(new TextEncoder().encode('{"site": '));
      controller.error(new TypeError("Failed to fetch"));
    },
  });
}

describe("responseData", () => {
  it("returns the data of an answer", async () => {
    expect(await answering('{"site": "umad"}')).toEqual({ site: "umad" });
  });

  it("throws Unreached if the connection is lost before the answer", async () => {
    const fetch = () => Promise.reject(new TypeError("Failed to fetch"));
    await expect(responseData(client.GET("/api/service", { fetch }))).rejects.toBeInstanceOf(Unreached);
  });

  it("throws Unreached if the connection is lost within the answer", async () => {
    await expect(answering(lostBody())).rejects.toBeInstanceOf(Unreached);
    await expect(answering(lostBody(), 409)).rejects.toBeInstanceOf(Unreached);
  });

  it("throws Refusal if the service refuses, and Unreached if it is full", async () => {
    const problem = { code: "stale-revision", detail: "The plan is newer.", diagnostics: [] };
    await expect(answering(JSON.stringify(problem), 409)).rejects.toBeInstanceOf(Refusal);
    await expect(answering(JSON.stringify({ ...problem, code: "full" }), 503)).rejects.toBeInstanceOf(Unreached);
  });
});
