"""German, in the same grammar: what a German sentence means is what its English one means."""

from collections.abc import Callable

import pytest

from argo_compiler.base.catalog import Catalog
from argo_compiler.il import EventKind
from tests.argo_compiler.script.conftest import filled, measured, refusals
from tests.whole_scripts import import_whole

PAIRS = [
    ("Prüfe Kontrollpunkt 3.", "Check checkpoint 3."),
    ("Pruefe Kontrollpunkt 3.", "Check checkpoint 3."),
    ("Prüfen Sie Kontrollpunkt 3.", "Check checkpoint 3."),
    ("Prüfen Sie bitte Kontrollpunkt 3.", "Check checkpoint 3."),
    ("Bitte Kontrollpunkt 3 prüfen.", "Check checkpoint 3."),
    ("Kontrollpunkt 3 prüfen.", "Check checkpoint 3."),
    ("Der Roboter prüft Kontrollpunkt 3.", "Check checkpoint 3."),
    ("Der Roboter soll Kontrollpunkt 3 prüfen.", "Check checkpoint 3."),
    ("Kontrollpunkt 3 ablesen.", "Check checkpoint 3."),
    ("Lies Kontrollpunkt 3 ab.", "Check checkpoint 3."),
    ("Lesen Sie Kontrollpunkt 3 ab.", "Check checkpoint 3."),
    (
        "Kontrollpunkt 3 prüfen, danach zurück zur Dockingstation fahren.",
        "Check checkpoint 3, then return to the docking station.",
    ),
    (
        "Kontrollpunkt 3 prüfen, Ventil R25 ablesen und zur Dockingstation zurückkehren.",
        "Check checkpoint 3, check valve R25 and return to the docking station.",
    ),
    ("Prüfe Kontrollpunkt 3 und fahre nach Hause.", "Check checkpoint 3 and go home."),
    ("Prüfe Kontrollpunkt 3 und kehre zurück.", "Check checkpoint 3 and return."),
    ("Prüfe die Kontrollpunkte 3, 5 und 8.", "Check checkpoints 3, 5 and 8."),
    ("Druckmanometer 1, 5 und 8 prüfen.", "Check pressure gauges 1, 5 and 8."),
    ("Prüfe die Manometer 1, 5 und 8.", "Check pressure gauges 1, 5 and 8."),
    ("Prüfe Manometer 1 bis 3.", "Check pressure gauges 1 to 3."),
    ("Prüfe Kontrollpunkte 3 bis 6.", "Check checkpoints 3 to 6."),
    ("Prüfe alle Ventile im zweiten Stock.", "Check all valves on the second floor."),
    ("Prüfe alle Ventile im 2. Stock.", "Check all valves on the second floor."),
    (
        "Alle Ventile im dritten Stock außer R7 prüfen.",
        "Check all valves on the third floor except R7.",
    ),
    (
        "Alle Druckanzeigen im ersten und zweiten Stock prüfen.",
        "Check all pressure gauges on the first and second floor.",
    ),
    (
        "Alle Manometer im 1. und 2. Stock ablesen.",
        "Check all pressure gauges on the first and second floor.",
    ),
    (
        "Danach geht es in den zweiten Stock zu Ventil R12, das ebenfalls geprüft wird.",
        "Then go to the second floor to valve R12, which is checked as well.",
    ),
    ("Prüfe Ventil R12 im zweiten Stock.", "Check valve R12 on the second floor."),
    (
        "Im zweiten Stock alle Kontrollpunkte in dieser Reihenfolge prüfen, außer Ventil R12.",
        "Check all checkpoints on the second floor in this order, except valve R12.",
    ),
    ("Im zweiten Stock wird das Ventil geprüft.", "On the second floor, check the valve."),
    (
        "Mit höchstens 0,3 m/s zu Ventil R9 fahren und es prüfen.",
        "Go to valve R9 at no more than 0.3 m/s and check it.",
    ),
    (
        "1. Prüfe Kontrollpunkt 2.\n2. Wenn er über 60 % liegt, überspringe den nächsten Schritt.\n"
        "3. Prüfe Kontrollpunkt 3.\n4. Prüfe Kontrollpunkt 4.",
        "1. Check checkpoint 2.\n2. If it is above 60 %, skip the next step.\n"
        "3. Check checkpoint 3.\n4. Check checkpoint 4.",
    ),
    (
        "Für die Vorführung am Freitag prüfe bitte Kontrollpunkt 3.",
        "For the demo on Friday please check checkpoint 3.",
    ),
    ("Wie besprochen: prüfe Kontrollpunkt 3.", "As discussed: check checkpoint 3."),
    ("Prüfe jedes Ventil im obersten Stock.", "Check each valve on the top floor."),
    ("Prüfe Kontrollpunkt 3 zweimal.", "Check checkpoint 3 twice."),
    ("Prüfe zweimal Kontrollpunkt 3.", "Check checkpoint 3 twice."),
    ("Kontrollpunkt 3 dreimal prüfen.", "Check checkpoint 3 three times."),
    ("Dreimal Kontrollpunkt 3 prüfen.", "Check checkpoint 3 three times."),
    ("Prüfe Kontrollpunkt 3 3x.", "Check checkpoint 3 three times."),
    ("Prüfe Kontrollpunkt 3 3-mal.", "Check checkpoint 3 three times."),
    (
        "Eine Stunde lang alle 10 Minuten Kontrollpunkt 3 prüfen.",
        "Check checkpoint 3 every 10 minutes for an hour.",
    ),
    (
        "Prüfe Kontrollpunkt 3 anderthalb Stunden lang alle zehn Minuten.",
        "Check checkpoint 3 every ten minutes for one and a half hours.",
    ),
    (
        "Kontrollpunkt 3 alle 5 Minuten prüfen, bis der Wert unter 3 fällt, dann zur "
        "Dockingstation fahren.",
        "Check checkpoint 3 every 5 minutes until the value is below 3, then go to the "
        "docking station.",
    ),
    (
        "Prüfe Kontrollpunkt 3. Wenn der Druck über 5 bar liegt, prüfe Ventil R25, "
        "sonst kehre zur Dockingstation zurück.",
        "Check checkpoint 3. If the pressure is above 5 bar, check valve R25, "
        "otherwise return to the docking station.",
    ),
    (
        "Kontrollpunkt 1 prüfen. Wenn der Druck über 5 bar liegt, Ventil R25 prüfen, "
        "sonst zur Dockingstation fahren.",
        "Check checkpoint 1. If the pressure is above 5 bar, check valve R25, "
        "otherwise go to the docking station.",
    ),
    (
        "Kontrollpunkt 1 prüfen. Wenn der Druck 5 bar übersteigt, Ventil R25 prüfen.",
        "Check checkpoint 1. If the pressure is above 5 bar, check valve R25.",
    ),
    (
        "Kontrollpunkt 1 prüfen. Wenn der Wert 3 bar unterschreitet, Ventil R25 prüfen.",
        "Check checkpoint 1. If the value is below 3 bar, check valve R25.",
    ),
    (
        "Prüfe Kontrollpunkt 1. Falls Kontrollpunkt 1 auffällig ist, prüfe Kontrollpunkt 4.",
        "Check checkpoint 1. If checkpoint 1 is abnormal, check checkpoint 4.",
    ),
    (
        "Prüfe Kontrollpunkte 1 und 3. Wenn Kontrollpunkt 1 über 5 bar und "
        "Kontrollpunkt 3 unter 4 bar liegt, prüfe Ventil R25.",
        "Check checkpoints 1 and 3. If checkpoint 1 is above 5 bar and checkpoint 3 is "
        "below 4 bar, check valve R25.",
    ),
    (
        "Prüfe Kontrollpunkte 1 und 3. Wenn Kontrollpunkt 1 oder Kontrollpunkt 3 "
        "auffällig ist, prüfe Ventil R25.",
        "Check checkpoints 1 and 3. If checkpoint 1 or checkpoint 3 is abnormal, check valve R25.",
    ),
    (
        "Prüfe Kontrollpunkt 1 und Kontrollpunkt 3, wenn Kontrollpunkt 6 über 5 bar liegt.",
        "Check checkpoint 1 and checkpoint 3 if checkpoint 6 is above 5 bar.",
    ),
    ("Fahre zu Startbereich 2.", "Go to starting area 2."),
    ("Fahre in den zweiten Stock.", "Go to the second floor."),
    ("Zum zweiten Stock fahren.", "Go to the second floor."),
    ("Fahre mit 0,3 m/s zu Startbereich 2.", "Go to starting area 2 at 0.3 m/s."),
    ("Mit 0,3 m/s zu Startbereich 2 fahren.", "Go to starting area 2 at 0.3 m/s."),
    ("Prüfe Kontrollpunkt 3 mit 1,08 km/h.", "Check checkpoint 3 at 0.3 m/s."),
    ("Warte 5 Minuten, dann prüfe Kontrollpunkt 3.", "Wait 5 minutes, then check checkpoint 3."),
    ("5 Minuten warten, dann Kontrollpunkt 3 prüfen.", "Wait 5 minutes, then check checkpoint 3."),
    ("Eine Viertelstunde warten.", "Wait a quarter of an hour."),
    ("Warte eine Dreiviertelstunde.", "Wait three quarters of an hour."),
    ("Warte zweieinhalb Stunden.", "Wait two and a half hours."),
    ("Warte hundertfünf Sekunden.", "Wait 105 s."),
    ("Warte einundzwanzig Minuten.", "Wait 21 minutes."),
    ("Warte zweitausenddreihundertvierzehn Sekunden.", "Wait 2314 s."),
    ("Warte auf Entwarnung.", "Wait for the all-clear."),
    ("Auf Entwarnung warten.", "Wait for the all-clear."),
    ("Warte bis zur Entwarnung.", "Wait until all-clear."),
    ("Patrouilliere den ersten Stock 10 Minuten lang.", "Patrol the first floor for 10 minutes."),
    ("Den ersten Stock zweimal patrouillieren.", "Patrol the first floor twice."),
    (
        "Prüfe Kontrollpunkt 3. Wird ein Gasleck erkannt, fahre nach Hause und beende die Mission.",
        "Check checkpoint 3. If a gas leak is detected, go home and end the mission.",
    ),
    (
        "Prüfe Kontrollpunkt 3. Bei Plattformalarm die Mission abbrechen.",
        "Check checkpoint 3. If a platform alarm sounds, abort the mission.",
    ),
    (
        "Prüfe Kontrollpunkt 3. Wenn der Akku unter 30 % fällt, lade den Akku auf.",
        "Check checkpoint 3. If the battery is below 30 %, recharge the battery.",
    ),
    (
        "Prüfe Kontrollpunkt 3. Wenn die Verbindung verloren geht, fahre nach Hause.",
        "Check checkpoint 3. If the connection is lost, go home.",
    ),
    ("Prüfe Kontrollpunkt 3, falls Zeit ist.", "Check checkpoint 3 if there is time."),
    ("Prüfe Kontrollpunkt 3 mit Priorität 5.", "Check checkpoint 3 with priority 5."),
    ("Prüfe Kontrollpunkt 3 innerhalb von 10 Minuten.", "Check checkpoint 3 within 10 minutes."),
    (
        "1. Prüfe Kontrollpunkt 3.\n2. Prüfe Kontrollpunkt 4.\n3. Wiederhole Schritte 1 "
        "bis 2 zweimal.",
        "1. Check checkpoint 3.\n2. Check checkpoint 4.\n3. Repeat steps 1 to 2 twice.",
    ),
    ("Prüfe Kontrollpunkt 3 und melde es.", "Check checkpoint 3 and report it."),
    (
        "!Der Roboter startet in Startbereich 1, prüft Kontrollpunkt 3 und fährt "
        "danach zur Dockingstation zurück.",
        "!Start in starting area 1, check checkpoint 3 and then return to the docking station.",
    ),
    ("Danach prüft er Kontrollpunkt 4 zweimal.", "Check checkpoint 4 twice."),
    ("Kontrollpunkt 3 prüft er zweimal.", "Check checkpoint 3 twice."),
    ("Ventil Nr. R25 prüfen", "Check valve R25."),
    (
        "Prüfe Kontrollpunkt 1. Ventil R25 ebenfalls prüfen. Danach nochmals "
        "Kontrollpunkt 1 prüfen.",
        "Check checkpoint 1. Check valve R25. Check checkpoint 1 again.",
    ),
    ("Prüfe den Wert von Manometer 1.", "Check the value of pressure gauge 1."),
    ("Lies den Druck an Manometer 1 ab.", "Read the pressure on pressure gauge 1."),
    ("Prüfe die Stellung des Ventils R25.", "Check the position of valve R25."),
    ("Fahre zu front of the site.", "Go to the front of the site."),
    (
        "Hallo zusammen,\n\nbitte prüft die Kontrollpunkte 3 und 5.\n\nViele Grüße\nJan",
        "Hello all,\n\nplease check checkpoints 3 and 5.\n\nKind regards\nJan",
    ),
    (
        "Maximale Dauer: 20 min\n1. Kontrollpunkt 3 prüfen",
        "Maximum duration: 20 min\n1. Check checkpoint 3",
    ),
    (
        "!Start: Startbereich 1\nEnde: Startbereich 2\n1. Kontrollpunkt 3 prüfen",
        "!Start: starting area 1\nEnd: starting area 2\n1. Check checkpoint 3",
    ),
    (
        "Reihenfolge: beliebig\n- Kontrollpunkt 3\n- Kontrollpunkt 5",
        "Order: any\n- Checkpoint 3\n- Checkpoint 5",
    ),
    (
        "Schritt 1: Kontrollpunkt 3 prüfen\nSchritt 2: zurück zur Dockingstation",
        "Step 1: check checkpoint 3\nStep 2: return to the docking station",
    ),
    (
        "- Kontrollpunkt 3\n- Ventil R25\n- Dockingstation",
        "- Checkpoint 3\n- Valve R25\n- Docking station",
    ),
    (
        "Hinweis: die Treppe ist nass.\n1. Prüfe Kontrollpunkt 3",
        "Note: the stairs are wet.\n1. Check checkpoint 3",
    ),
    (
        "Prüfe Kontrollpunkt 1. Prüfe Kontrollpunkt 3. Wenn Kontrollpunkt 1 über 5 bar "
        "liegt und Kontrollpunkt 3 auffällig ist, Ventil R25 und Ventil R12 prüfen.",
        "Check checkpoint 1. Check checkpoint 3. If checkpoint 1 is above 5 bar and "
        "checkpoint 3 is abnormal, check valve R25 and valve R12.",
    ),
    (
        "Prüfe Kontrollpunkt 1. Prüfe Kontrollpunkt 3. Wenn es nicht normal ist, dann "
        "Ventil R25 prüfen, ansonsten Kontrollpunkt 8 prüfen.",
        "Check checkpoint 1. Check checkpoint 3. If it is not normal, then check valve "
        "R25, otherwise check checkpoint 8.",
    ),
    (
        "Prüfe Kontrollpunkt 1. Prüfe Kontrollpunkt 3. Prüfe ihn noch einmal.",
        "Check checkpoint 1. Check checkpoint 3. Check it once more.",
    ),
    (
        "Kontrollpunkt 3 wird alle zehn Minuten geprüft, insgesamt fünfmal.",
        "Check checkpoint 3 every ten minutes, five times in total.",
    ),
    ("Kontrollpunkt 3 ist zweimal zu prüfen.", "Checkpoint 3 is checked twice."),
    (
        "Es sei denn Kontrollpunkt 1 ist auffällig, prüfe Ventil R25.",
        "Unless checkpoint 1 is abnormal, check valve R25.",
    ),
    (
        "Prüfe Ventil R25, es sei denn, Kontrollpunkt 1 ist auffällig.",
        "Check valve R25 unless checkpoint 1 is abnormal.",
    ),
    (
        "Die Ventile R12, R7 und R25 bitte zweimal ablesen.",
        "Check the valves R12, R7 and R25 twice.",
    ),
    (
        "Prüfe alle Kontrollpunkte auf dem zweiten und dritten Deck.",
        "Check all checkpoints on the second and third deck.",
    ),
    (
        "Warte 1 h 15, dann fahre zur Dockingstation.",
        "Wait 1 h 15, then go to the docking station.",
    ),
    ("Warte 1:30 h.", "Wait 1:30 h."),
    ("Warte 1.000,5 s.", "Wait 1,000.5 s."),
    (
        "Pruefe Fuellstandsanzeige 2 und kehre zur Dockingstation zurueck.",
        "Check liquid level gauge 2 and return to the docking station.",
    ),
    (
        "Prüfe Kontrollpunkt 12. Wenn der Füllstand unter 20 % sinkt, prüfe Ventil R25.",
        "Check checkpoint 12. If the level drops below 20 %, check valve R25.",
    ),
    ("Lies den Füllstand an Füllstandsanzeige 2 ab.", "Read the level on liquid level gauge 2."),
    (
        "Prüfe Kontrollpunkt 3. Wenn ein Gasleck auftritt, kehre zur Dockingstation "
        "zurück, warte auf Entwarnung und fahre dann fort.",
        "Check checkpoint 3. If a gas leak occurs, return to the docking station, wait "
        "for the all-clear and then continue.",
    ),
    (
        "Prüfe Kontrollpunkt 3. Tritt ein Gasleck auf, brich die Mission ab.",
        "Check checkpoint 3. If a gas leak occurs, abort the mission.",
    ),
    (
        "Prüfe Kontrollpunkt 3. Bei Verbindungsverlust zur Dockingstation zurückkehren.",
        "Check checkpoint 3. In case of connection loss return to the docking station.",
    ),
    (
        "Prüfe Kontrollpunkt 3. Sobald die Zeit um ist, fahre nach Hause und beende die Mission.",
        "Check checkpoint 3. When the time is up, go home and end the mission.",
    ),
    (
        "Zunächst Kontrollpunkt 3, danach Kontrollpunkt 5 prüfen.",
        "First check checkpoint 3, then checkpoint 5.",
    ),
    (
        "Zuerst prüfst du Kontrollpunkt 3, dann liest du Ventil R25 ab.",
        "First check checkpoint 3, then check valve R25.",
    ),
    ("Wir möchten, dass der Roboter Kontrollpunkt 3 prüft.", "Check checkpoint 3."),
    (
        "Es müssen die Kontrollpunkte 3 und 5 geprüft werden.",
        "Checkpoints 3 and 5 must be checked.",
    ),
    (
        "Kontrollpunkt 3 muss vor Kontrollpunkt 5 geprüft werden. Prüfe Kontrollpunkt 3 und 5.",
        "Checkpoint 3 must be checked before checkpoint 5. Check checkpoint 3 and 5.",
    ),
    ("Prüfe Kontrollpunkt 3 mit hoher Priorität.", "Check checkpoint 3 with high priority."),
    (
        "Die Mission darf höchstens 20 Minuten dauern. Prüfe Kontrollpunkt 3.",
        "The mission may take at most 20 minutes. Check checkpoint 3.",
    ),
    ("Prüfe beide Ventile im dritten Stock.", "Check both valves on the third floor."),
    (
        "Prüfe alle drei Kontrollpunkte im vierten Stock.",
        "Check all three checkpoints on the fourth floor.",
    ),
    (
        "Prüfe Kontrollpunkt 3. Falls das fehlschlägt, versuche es bis zu dreimal.",
        "Check checkpoint 3. If this fails, try again up to three times.",
    ),
    (
        "Prüfe Manometer 4 und dann Manometer 6. Wenn weder Manometer 4 noch Manometer 6 auffällig "
        "ist, prüfe Ventil R12.",
        "Check #9 and then #13. If neither #9 nor #13 is abnormal, check valve R12.",
    ),
    (
        "Prüfe Manometer 4 und dann Manometer 6. Wenn keiner von beiden über 5 bar liegt, prüfe "
        "Ventil R12.",
        "Check #9 and then #13. If neither of them is above 5 bar, check valve R12.",
    ),
    (
        "Prüfe Manometer 4. Wenn der Wert außerhalb von 3,5 bis 4,5 bar liegt, prüfe Ventil R12.",
        "Check #9. If the value is outside 3.5 to 4.5 bar, check valve R12.",
    ),
    (
        "Prüfe Füllstandsanzeige 2. Wenn der Wert außerhalb des Nennbereichs liegt, prüfe Ventil "
        "R12. Manometer 3 ablesen, und zwar in jedem Fall.",
        "Check #7. If the value is abnormal, check valve R12. Read pressure gauge 3.",
    ),
    (
        "Prüfe die Checkpoints 5 bis 8 in dieser Reihenfolge. Danach prüfe dieselben noch einmal "
        "in umgekehrter Reihenfolge.",
        "Check #5 to #8 in this order. Check #8, #7, #6 and #5.",
    ),
    (
        "!Der Roboter steht am Anfang in der Dockingstation von Startbereich 2. Prüfe Ventil R12.",
        "!The robot starts docked in starting area 2. Check valve R12.",
    ),
    # Words of both languages do not mislead.
    # `not` is no denial in German, `was` no verb, `also` and `so` say nothing in either.
    (
        "Prüfe Kontrollpunkt 3. Bei Not-Halt anhalten.",
        "Check checkpoint 3. If the emergency stop is pressed, stop.",
    ),
    ("Prüfe also Kontrollpunkt 3.", "Check checkpoint 3."),
    ("Prüfe so auch Kontrollpunkt 3.", "So check checkpoint 3 as well."),
    # `an` is an article in English and a preposition in German, `in` is one in both.
    ("Lies den Wert an Kontrollpunkt 3 ab.", "Read the value on an checkpoint 3."),
    ("Alle Ventile in Etage 2 prüfen.", "Check all valves in floor 2."),
    # `die` is no verb of the grammar, `no` and `nr` are `number`.
    ("Prüfe die Ventile R25 und R12.", "Check the valves R25 and R12."),
    ("Prüfe Kontrollpunkt no. 3.", "Check checkpoint no. 3."),
    # `Halt` stops in both.
    (
        "Prüfe Kontrollpunkt 3. Bei Gasleck: halt.",
        "Check checkpoint 3. If a gas leak is detected, halt.",
    ),
]
"""in German and in English; `!` stands before a script that says itself where it starts"""

FRAMED_PAIRS = {
    ("Prüfe Kontrollpunkt 3. {}", "Check checkpoint 3. {}"): [
        (
            "Wenn ein Gasleck erkannt wird, kehre zur Dockingstation zurück und beende die "
            "Mission.",
            "If a gas leak is detected, return to the docking station and end the mission.",
        ),
        (
            "Bei Gasleck zur Dockingstation zurückkehren und die Mission beenden.",
            "If a gas leak is detected, return to the docking station and end the mission.",
        ),
        (
            "Bei einem Gasleck oder einer heißen Stelle: nach Hause fahren und Mission beenden.",
            "If a gas leak or a hot spot is detected, go home and end the mission.",
        ),
        ("Wenn der Akku schwach ist, lade ihn auf.", "If the battery is low, recharge."),
        ("Bei einer Störung anhalten und warten.", "If a dysfunction occurs, pause and wait."),
        (
            "Falls das misslingt, fahre zur Dockingstation zurück und beende die Mission.",
            "If this fails, return to the docking station and end the mission.",
        ),
        ("Die Reihenfolge ist egal.", "The order does not matter."),
        ("Bei einem positiven Hindernis anhalten.", "If a positive obstacle is detected, pause."),
    ],
    ("Prüfe Kontrollpunkt 1. {}", "Check checkpoint 1. {}"): [
        ("Bei mehr als 5 bar prüfe Kontrollpunkt 4.", "At more than 5 bar, check checkpoint 4."),
        ("Auf jeden Fall prüft er dann Kontrollpunkt 4.", "In any case it checks checkpoint 4."),
        (
            "Wenn der Wert nicht zwischen 3 und 5 bar liegt, Kontrollpunkt 8 prüfen.",
            "If the value is not between 3 and 5 bar, check checkpoint 8.",
        ),
        ("Wenn das fehlschlägt, versuche es noch einmal.", "If this fails, try again."),
        (
            "Prüfe Kontrollpunkt 3. Falls er höher als 5 bar ist, prüfe Ventil R25.",
            "Check checkpoint 3. If it is higher than 5 bar, check valve R25.",
        ),
        (
            "Prüfe Kontrollpunkt 3. Wenn der Wert unlesbar ist, prüfe Kontrollpunkt 3 nochmals.",
            "Check checkpoint 3. If the value is unreadable, check checkpoint 3 again.",
        ),
        ("Prüfe Kontrollpunkt 3. Prüfe beide nochmals.", "Check checkpoint 3. Check both again."),
    ],
    ("Prüfe Kontrollpunkt 1. {}, prüfe Ventil R25.", "Check checkpoint 1. {}, check valve R25."): [
        ("Wenn der Druck mindestens 5 bar beträgt", "If the pressure is at least 5 bar"),
        ("Wenn der Wert 5 bar oder mehr beträgt", "If the value is 5 bar or more"),
    ],
    (
        "Prüfe Kontrollpunkt 1. {}, prüfe Kontrollpunkt 8.",
        "Check checkpoint 1. {}, check checkpoint 8.",
    ): [
        ("Liegt der Wert über 4,5 bar", "If the value is above 4.5 bar"),
        ("Ist der Wert auffällig", "If the value is abnormal"),
        ("Ist der Wert nicht zwischen 3 und 5 bar", "If the value is not between 3 and 5 bar"),
    ],
    ("1. Kontrollpunkt 3 prüfen.\n2. {}", "1. Check checkpoint 3.\n2. {}"): [
        ("Kontrollpunkt 4 prüfen.\n3. Lösche Schritt 2.", "Check checkpoint 4.\n3. Delete step 2."),
        ("Füge Kontrollpunkt 5 nach Schritt 1 ein.", "Add checkpoint 5 after step 1."),
        ("Ersetze Schritt 1 durch Kontrollpunkt 5.", "Replace step 1 by checkpoint 5."),
    ],
    (
        "1. Kontrollpunkt 3 prüfen.\n2. Kontrollpunkt 4 prüfen.\n3. {}",
        "1. Check checkpoint 3.\n2. Check checkpoint 4.\n3. {}",
    ): [
        ("Schritte 1 und 2 zweimal wiederholen.", "Repeat steps 1 and 2 twice."),
        ("Führe die Schritte 1 bis 2 dreimal aus.", "Run steps 1 to 2 three times."),
        ("Verschiebe Schritt 2 vor Schritt 1.", "Move step 2 before step 1."),
        ("Alles zweimal wiederholen.", "Repeat everything twice."),
    ],
    ("Prüfe Kontrollpunkt {}", "Check checkpoint {}"): [
        ("3 und kehre zur Dockingstation zurück.", "3 and return to the docking station."),
        ("3 alle 10 Minuten eine Stunde lang.", "3 every 10 minutes for an hour."),
        ("3 alle halbe Stunde viermal.", "3 every half hour four times."),
        ("3, bis der Wert unter 3 bar fällt.", "3 until the value is below 3."),
        ("3 alle 10 Minuten, bis er unter 3 fällt.", "3 every 10 minutes until it is below 3."),
        ("3 spätestens 10 Minuten nach dem Start.", "3 not later than 10 minutes after the start."),
        ("3 höchstens 5 Minuten lang.", "3 for at most 5 minutes."),
    ],
    (
        "1. Kontrollpunkt 3 prüfen.\n2. Kontrollpunkt 6 prüfen. Wenn der Druck über 5 bar liegt, "
        "{}.\n3. Kontrollpunkt 8 prüfen.\n4. Ventil R7 prüfen.",
        "1. Check checkpoint 3.\n2. Check checkpoint 6. If the pressure is above 5 bar, {}.\n"
        "3. Check checkpoint 8.\n4. Check valve R7.",
    ): [
        ("springe zu Schritt 4", "skip to step 4"),
        ("fahre mit Schritt 4 fort", "continue with step 4"),
    ],
}


def script(text: str, start: str) -> str:
    return text[1:] if text.startswith("!") else f"{start}\n{text}"


@pytest.mark.parametrize(("german_text", "english_text"), PAIRS + filled(FRAMED_PAIRS))
def test_german_means_what_english_means(
    german_text: str, english_text: str, meaning_of: Callable[[str], object]
) -> None:
    said = meaning_of(script(german_text, "Starte in Startbereich 1."))
    assert said == meaning_of(script(english_text, "Start in starting area 1."))


PHRASES = [
    ("Wenn die Funkverbindung ausfällt, warte.", "If the radio link is lost, wait."),
    ("Wenn ein Gegenstand im Weg liegt, halte an.", "If an object is in the way, stop."),
    ("Wenn ein Hindernis den Weg versperrt, halte an.", "If an object blocks the way, stop."),
    (
        "Bei einer technischen Störung brich alles ab.",
        "In case of a technical fault abort the mission.",
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
    ("Prüfe Kontrollpunkt 4, wenn es noch Zeit gibt.", "Check checkpoint 4 if there is time."),
    ("Wenn Gefahr gebannt ist, melde es.", "If the danger is over, report it."),
    ("Warte, bis der Alarm aufgehoben ist.", "Wait until the alarm is cleared."),
    ("Warte, bis der Akku vollgeladen ist.", "Wait until the battery is fully charged."),
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
        "Prüfe alle zwei Minuten Kontrollpunkt 4, bis er unter 3 liegt.",
        "Check checkpoint 4 every two minutes until it is below 3.",
    ),
    ("Wenn ein Loch im Boden erkannt wird, halte an.", "If a hole in the floor is detected, stop."),
    ("Prüfe Kontrollpunkt 4. Das war es.", "Check checkpoint 4. That is all."),
    ("Wiederhole den ganzen Rundgang zweimal.", "Repeat the whole tour twice."),
]

FRAMED_PHRASES = {
    ("Wenn {}, prüfe Kontrollpunkt 8.", "If {}, check checkpoint 8."): [
        ("Kontrollpunkt 4 nicht in Ordnung ist", "checkpoint 4 is abnormal"),
        ("Kontrollpunkt 4 im grünen Bereich ist", "checkpoint 4 is in the green"),
        ("Kontrollpunkt 4 außerhalb der Toleranz liegt", "checkpoint 4 is abnormal"),
        ("Kontrollpunkt 4 unleserlich ist", "checkpoint 4 is illegible"),
        ("Kontrollpunkt 4 nicht unter 5 liegt", "checkpoint 4 is not below 5"),
        ("Kontrollpunkt 4 im Bereich von 3 bis 5 liegt", "checkpoint 4 is in the range of 3 to 5"),
        ("Kontrollpunkt 4 einen Wert über 5 aufweist", "checkpoint 4 has a value above 5"),
    ],
    ("Wenn {}, kehre zur Dockingstation zurück.", "If {}, return to the docking station."): [
        ("der Akku fast leer ist", "the battery is almost empty"),
        ("die Batterie zu niedrig ist", "the battery is too low"),
        ("das Zeitlimit erreicht ist", "the time limit is reached"),
        ("die maximale Dauer überschritten ist", "the maximum duration is over"),
    ],
    ("Wenn {}, melde es.", "If {}, report it."): [
        ("die Verbindung wiederhergestellt wird", "the connection is restored"),
        ("ein Messwert außerhalb des Normalbereichs liegt", "a reading is out of range"),
    ],
    ("Wenn {}, brich die Mission ab.", "If {}, abort the mission."): [
        ("ein Fehler am Roboter festgestellt wurde", "a fault of the robot was found"),
        ("ein Gasleck entdeckt wurde", "a gas leak was detected"),
    ],
    ("Prüfe Kontrollpunkt 4, {}.", "Check checkpoint 4 {}."): [
        ("falls noch genug Zeit ist", "if there is enough time"),
        ("außer falls Kontrollpunkt 2 auffällig ist", "unless checkpoint 2 is abnormal"),
    ],
}


@pytest.mark.parametrize(("german_text", "english_text"), PHRASES + filled(FRAMED_PHRASES))
def test_phrases_of_german_mean_what_english_ones_mean(
    german_text: str, english_text: str, meaning_of: Callable[[str], object]
) -> None:
    said = meaning_of(f"Starte in Startbereich 1. Prüfe Kontrollpunkt 1.\n{german_text}")
    assert said == meaning_of(f"Start in starting area 1. Check checkpoint 1.\n{english_text}")


# ---- which language


def test_a_german_sentence_in_an_english_script(catalog: Catalog) -> None:
    text = "Start in starting area 1.\nCheck checkpoint 3.\nVentil R25 zweimal ablesen."
    assert measured(text, catalog) == ["3", "4"]


def test_an_english_sentence_in_a_german_script(catalog: Catalog) -> None:
    text = "Starte in Startbereich 1.\nKontrollpunkt 3 prüfen.\nRead valve R25 twice."
    assert measured(text, catalog) == ["3", "4"]


def test_labels_may_be_english_in_a_german_script(catalog: Catalog) -> None:
    text = "Maximum duration: 20 min\nStart: Startbereich 1\nEnd: Startbereich 2\n"
    mission = import_whole(text + "1. Kontrollpunkt 3 prüfen", catalog).mission
    assert (mission.max_duration, mission.start_area, mission.end_area) == (1200, 1, 2)


# ---- what is not clear


UNCLEAR = [
    # Which words belong to the second verb?
    "Prüfe Kontrollpunkt 3, Ventil R25, Ventil R12 ablesen.",
    "Prüfe Ventil R25 und 5.",
    "Prüfe Druck 3.",
    "Prüfe Kontrollpunkt 1. Prüfe Kontrollpunkt 3. Prüfe sie noch einmal.",
    "Warte Minuten.",
    "Prüfe Kontrollpunkt 1. Wenn der Wert genau 5 bar ist, prüfe Ventil R25.",
    "Fahre ab Startbereich 2.",
    "Go from starting area 2.",
    "Prüfe Kontrollpunkt 3 nicht.",
    "Fahre nicht zur Dockingstation.",
    "Wenn kein Gasleck erkannt wird, prüfe Ventil R25.",
    "Bei Gasleck nicht zur Dockingstation zurückkehren.",
    "Prüfe weder Kontrollpunkt 3 noch Kontrollpunkt 4.",
    "Prüfe Kontrollpunkt 3 alle zehn bis fünfzehn Minuten.",
    "Prüfe Kontrollpunkt 3. Wenn der Druck um 5 bar steigt, prüfe Ventil R25.",
    "Prüfe Kontrollpunkt 3 bis 5 bar.",
    "Prüfe Kontrollpunkt 3 oder 4.",
    "Prüfe Kontrollpunkt 3. Wenn er über 5 bar ist.",
    "Warte 1.200 s.",
    "Warte 12:30.",
    "Prüfe Kontrollpunkt 3 blitzschnell.",
    "Prüfe Kontrollpunkt 3 und dann Kontrollpunkt 4 nicht.",
    "Drehe Ventil R25 zu.",
    "Prüfe alle Ventile im neunten Stock.",
    "Prüfe Kontrollpunkt 1 und Kontrollpunkt 3. Wenn er über 5 bar liegt, prüfe Ventil R25.",
    "Prüfe Kontrollpunkt 1. Wenn der Wert über 20 Prozent liegt, prüfe Ventil R25.",
]


@pytest.mark.parametrize("text", UNCLEAR)
def test_what_is_not_clear_is_an_error_at_its_line(text: str, catalog: Catalog) -> None:
    lines = f"Starte in Startbereich 1.\n1. Prüfe Kontrollpunkt 8.\n2. {text}"
    errors = refusals(lines, catalog)
    assert {d.span.line for d in errors if d.span is not None} == {3}


EVENTS = {
    EventKind.GAS_LEAK: "ein Gasleck erkannt wird",
    EventKind.HOT_SPOT: "eine heiße Stelle entdeckt wird",
    EventKind.ABNORMAL_SOUND: "ein ungewöhnliches Geräusch zu hören ist",
    EventKind.PLATFORM_ALARM: "der Plattformalarm ertönt",
    EventKind.LOW_BATTERY: "der Akku schwach ist",
    EventKind.CONNECTION_LOST: "die Verbindung verloren geht",
    EventKind.EMERGENCY_STOP: "der Not-Halt gedrückt wird",
    EventKind.DYSFUNCTION: "eine Störung auftritt",
    EventKind.TIME_UP: "die Zeit um ist",
}


@pytest.mark.parametrize(("event", "said"), EVENTS.items())
def test_events(event: EventKind, said: str, catalog: Catalog) -> None:
    text = f"Starte in Startbereich 1.\nPrüfe Kontrollpunkt 3.\nWenn {said}, halte an."
    (reaction,) = import_whole(text, catalog).mission.reactions
    assert reaction.event is event


NUMBERS = {
    "eins": 1,
    "zwei": 2,
    "zwölf": 12,
    "siebzehn": 17,
    "zwanzig": 20,
    "einundzwanzig": 21,
    "dreiunddreißig": 33,
    "neunundneunzig": 99,
    "hundert": 100,
    "hundertfünf": 105,
    "einhundertundelf": 111,
    "zweihundertsechzig": 260,
    "achthundertachtundachtzig": 888,
    "tausend": 1000,
    "eintausendzweihundert": 1200,
    "zwölfhundert": 1200,
    "zweitausenddreihundertvierzehn": 2314,
    "neuntausendneunhundertneunundneunzig": 9999,
}


@pytest.mark.parametrize(("said", "number"), NUMBERS.items())
def test_numbers_in_words(said: str, number: int, meaning_of: Callable[[str], object]) -> None:
    start = "Starte in Startbereich 1.\n"
    words, figures = (f"{start}Warte {n} Sekunden." for n in (said, str(number)))
    assert meaning_of(words) == meaning_of(figures)


@pytest.mark.parametrize(("said", "number"), {"zweimal": 2, "dreimal": 3, "zwölfmal": 12}.items())
def test_how_often_in_words(said: str, number: int, meaning_of: Callable[[str], object]) -> None:
    start = "Starte in Startbereich 1.\n"
    words, figures = (f"{start}Prüfe Kontrollpunkt 3 {n}." for n in (said, f"{number} Mal"))
    assert meaning_of(words) == meaning_of(figures)
