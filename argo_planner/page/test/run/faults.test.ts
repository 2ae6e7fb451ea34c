import { expect, test } from "vitest";

import service from "../../../../docs/openapi.json";
import { faultKinds } from "../../src/run/faults";
import { run } from "../../src/texts/run";

const known = Object.keys(service.components.schemas.BeginFault.properties.fault.discriminator.mapping);

test("the page offers and names all kinds of faults that the service knows, and no other", () => {
  expect([...faultKinds()].sort()).toEqual(known.sort());
  for (const texts of [run.en, run.de]) expect(Object.keys(texts.fault)).toEqual(faultKinds());
});
