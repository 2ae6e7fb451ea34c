import { expect, test } from "vitest";

import service from "../../../../docs/openapi.json";
import { faultKinds } from "../../src/run/faults";
import { faults } from "../../src/texts/faults";
import { run } from "../../src/texts/run";

const known = Object.keys(service.components.schemas.BeginFault.properties.fault.discriminator.mapping);

test("the page offers and names all kinds of faults that the service knows, and no other", () => {
  expect([...faultKinds()].sort()).toEqual(known.sort());
  for (const texts of [run.en, run.de]) expect(Object.keys(texts.fault)).toEqual(faultKinds());
});

test("the page names all fields of faults, and the parts of those with several numbers", () => {
  const { mapping } = service.components.schemas.BeginFault.properties.fault.discriminator;
  const schemas = service.components.schemas as unknown as Record<string, { properties: Record<string, unknown> }>;
  const fields = Object.values(mapping).flatMap((reference) => {
    const { properties = {} } = schemas[reference.split("/").at(-1) ?? ""] ?? {};
    return Object.keys(properties).filter((name) => !["kind", "seed"].includes(name));
  });
  for (const texts of [faults.en, faults.de]) {
    expect(Object.keys(texts.fields).sort()).toEqual([...new Set(fields)].sort());
    expect(Object.keys(texts.axes).sort()).toEqual(["offset", "place", "rect", "size"]);
  }
});
