import { defineConfig } from "vitest/config";

export default defineConfig({
  base: "./",
  build: { target: "es2022", assetsInlineLimit: 0, chunkSizeWarningLimit: 2000, modulePreload: false },
  test: { environment: "happy-dom", include: ["test/**/*.test.ts"] },
});
