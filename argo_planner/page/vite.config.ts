import { defineConfig } from "vitest/config";

const SERVED = "test/state/*.test.ts";

export default defineConfig({
  base: "./",
  build: { target: "es2022", assetsInlineLimit: 0, chunkSizeWarningLimit: 2000, modulePreload: false },
  test: {
    environment: "happy-dom",
    projects: [
      // Their service has to be there before the page's client is loaded, so each loads its own.
      { extends: true, test: { name: "with a service", include: [SERVED] } },
      {
        extends: true,
        test: { name: "alone", include: ["test/**/*.test.ts"], exclude: [SERVED], isolate: false },
      },
    ],
  },
});
