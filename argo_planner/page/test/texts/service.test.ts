import { expect, test } from "vitest";

import { service } from "../../src/texts/service";

test("known parts of a verdict are German, and the rest is unchanged", () => {
  const { verdict } = service.de;
  expect(verdict("it took 1:14:51 h of at most 20:00 min")).toBe(
    "die Fahrt dauerte 1:14:51 h, erlaubt sind höchstens 20:00 min",
  );
  expect(verdict("the mission was aborted; failed: A, B; something else")).toBe(
    "die Mission wurde vorzeitig beendet; fehlgeschlagen: A, B; something else",
  );
  expect(verdict("the robot has stood still since 00:40, paused, and nothing more occurs")).toBe(
    "der Roboter steht seit 00:40, die Mission ist angehalten, und es geschieht nichts mehr",
  );
  expect(verdict("failed: the mission was aborted")).toBe("fehlgeschlagen: the mission was aborted");
});

test("a headline names what was noticed", () => {
  const { outcome, headline } = service.de;
  expect(outcome("Done, 1 contact, 2 mishaps")).toBe("Fertig, 1 Berührung, 2 Zwischenfälle");
  expect(headline("failed: A. 2 findings, 1 contact: gas leak at 00:12; hot spot at 01:00")).toBe(
    "fehlgeschlagen: A. 2 Befunde, 1 Berührung: gas leak at 00:12; hot spot at 01:00",
  );
  expect(headline("gas leak at 00:12. The mission was completed; passed over: A")).toBe(
    "gas leak at 00:12. Die Mission wurde abgeschlossen; durch eine Bedingung ausgelassen: A",
  );
  expect(headline("everything was done as planned")).toBe("alles wurde wie geplant erledigt");
});

test("English stays as the service writes it", () => {
  expect(service.en.headline("failed: A")).toBe("failed: A");
});
