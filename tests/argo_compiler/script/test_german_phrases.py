"""Phrases of German, and those of English that mean the same."""

from collections.abc import Callable

import pytest

PAIRS = [
    ("Wenn die Funkverbindung ausfällt, warte.", "If the radio link is lost, wait."),
    (
        "Wenn die Verbindung wiederhergestellt wird, melde es.",
        "If the connection is restored, report it.",
    ),
    ("Wenn ein Gegenstand im Weg liegt, halte an.", "If an object is in the way, stop."),
    ("Wenn ein Hindernis den Weg versperrt, halte an.", "If an object blocks the way, stop."),
    (
        "Wenn der Akku fast leer ist, kehre zur Dockingstation zurück.",
        "If the battery is almost empty, return to the docking station.",
    ),
    (
        "Wenn die Batterie zu niedrig ist, kehre zur Dockingstation zurück.",
        "If the battery is too low, return to the docking station.",
    ),
    (
        "Bei einer technischen Störung brich alles ab.",
        "In case of a technical fault abort the mission.",
    ),
    (
        "Wenn ein Fehler am Roboter festgestellt wurde, brich die Mission ab.",
        "If a fault of the robot was found, abort the mission.",
    ),
    (
        "Wenn Kontrollpunkt 4 nicht in Ordnung ist, prüfe Kontrollpunkt 8.",
        "If checkpoint 4 is abnormal, check checkpoint 8.",
    ),
    (
        "Wenn Kontrollpunkt 4 im grünen Bereich ist, prüfe Kontrollpunkt 8.",
        "If checkpoint 4 is in the green, check checkpoint 8.",
    ),
    (
        "Wenn Kontrollpunkt 4 außerhalb der Toleranz liegt, prüfe Kontrollpunkt 8.",
        "If checkpoint 4 is abnormal, check checkpoint 8.",
    ),
    (
        "Wenn Kontrollpunkt 4 unleserlich ist, prüfe Kontrollpunkt 8.",
        "If checkpoint 4 is illegible, check checkpoint 8.",
    ),
    (
        "Wenn Kontrollpunkt 4 nicht unter 5 liegt, prüfe Kontrollpunkt 8.",
        "If checkpoint 4 is not below 5, check checkpoint 8.",
    ),
    (
        "Wenn Kontrollpunkt 4 im Bereich von 3 bis 5 liegt, prüfe Kontrollpunkt 8.",
        "If checkpoint 4 is in the range of 3 to 5, check checkpoint 8.",
    ),
    (
        "Wenn Kontrollpunkt 4 einen Wert über 5 aufweist, prüfe Kontrollpunkt 8.",
        "If checkpoint 4 has a value above 5, check checkpoint 8.",
    ),
    (
        "Prüfe Kontrollpunkt 4. Wenn das nicht möglich ist, prüfe Kontrollpunkt 8.",
        "Check checkpoint 4. If that is not possible, check checkpoint 8.",
    ),
    ("Prüfe alle Manometer in freier Reihenfolge.", "Check all pressure gauges in any order."),
    (
        "Prüfe alle Manometer, egal in welcher Reihenfolge.",
        "Check all pressure gauges in any order.",
    ),
    (
        "Prüfe Kontrollpunkt 4, falls noch genug Zeit ist.",
        "Check checkpoint 4 if there is enough time.",
    ),
    ("Prüfe Kontrollpunkt 4, wenn es noch Zeit gibt.", "Check checkpoint 4 if there is time."),
    ("Wenn Gefahr gebannt ist, melde es.", "If the danger is over, report it."),
    ("Warte, bis der Alarm aufgehoben ist.", "Wait until the alarm is cleared."),
    ("Warte, bis der Akku vollgeladen ist.", "Wait until the battery is fully charged."),
    (
        "Wenn das Zeitlimit erreicht ist, kehre zur Dockingstation zurück.",
        "If the time limit is reached, return to the docking station.",
    ),
    (
        "Wenn die maximale Dauer überschritten ist, kehre zur Dockingstation zurück.",
        "If the maximum duration is over, return to the docking station.",
    ),
    (
        "Wenn ein Gasleck entdeckt wurde, brich die Mission ab.",
        "If a gas leak was detected, abort the mission.",
    ),
    ("Wenn seltsame Geräusche zu hören sind, halte an.", "If strange noises are heard, stop."),
    ("Die maximale Gesamtdauer beträgt 40 Minuten.", "The maximum duration is 40 minutes."),
    ("Der Rundgang darf höchstens 40 Minuten dauern.", "The round may take at most 40 minutes."),
    ("Prüfe die Inspektionspunkte 3 und 4.", "Check checkpoints 3 and 4."),
    (
        "Beobachte Kontrollpunkt 4, bis der Wert unter 3 liegt.",
        "Keep reading checkpoint 4 until the value is below 3.",
    ),
    (
        "Fahre mit 0,3 m/s zu Startbereich 2. Setze den Rundgang fort.",
        "Go to starting area 2 at 0.3 m/s. Go on.",
    ),
    (
        "Prüfe Kontrollpunkt 4, außer falls Kontrollpunkt 2 auffällig ist.",
        "Check checkpoint 4 unless checkpoint 2 is abnormal.",
    ),
    (
        "Prüfe alle zwei Minuten Kontrollpunkt 4, bis er unter 3 liegt.",
        "Check checkpoint 4 every two minutes until it is below 3.",
    ),
    ("Wenn ein Loch im Boden erkannt wird, halte an.", "If a hole in the floor is detected, stop."),
    (
        "Wenn ein Messwert außerhalb des Normalbereichs liegt, melde es.",
        "If a reading is out of range, report it.",
    ),
    ("Prüfe Kontrollpunkt 4. Das war es.", "Check checkpoint 4. That is all."),
    ("Wiederhole den ganzen Rundgang zweimal.", "Repeat the whole tour twice."),
]


@pytest.mark.parametrize(("german_text", "english_text"), PAIRS)
def test_phrases_of_german_mean_what_english_ones_mean(
    german_text: str, english_text: str, meaning_of: Callable[[str], object]
) -> None:
    said = meaning_of(f"Starte in Startbereich 1. Prüfe Kontrollpunkt 1.\n{german_text}")
    assert said == meaning_of(f"Start in starting area 1. Check checkpoint 1.\n{english_text}")
