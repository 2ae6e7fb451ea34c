"""Where a route waits and charges, held against arrivals that are reckoned by hand."""

import numpy as np

from argo_compiler.route import EnergyBudget, RouteProblem, Tour, Visit, evaluate
from argo_compiler.route.tour_pauses import TourPause, pauses

TRAVEL = np.full((4, 4), 10)


def test_waits_are_those_of_the_visits_with_windows():
    visits = (Visit("a", 5, earliest=12), Visit("b", 5, earliest=50), Visit("c", 5, earliest=3))
    problem = RouteProblem(visits, TRAVEL)
    found = pauses(problem, Tour((2, 0, 1)))
    # c at 10, a at 25, b at 40 if nothing waited
    assert found == {2: (TourPause(10, visit=1),)}
    assert evaluate(problem, Tour((2, 0, 1))).waiting == 10


def test_a_charge_gives_back_what_was_used():
    battery = EnergyBudget(TRAVEL, capacity=35, used=3, overhead=4)
    problem = RouteProblem(
        (Visit("a"), Visit("b", earliest=60)), TRAVEL, battery=battery, chargers=("dock",)
    )
    route = Tour((0, 1), {1: 0, 2: 0})
    # 3 + two ways are used at the first charge (20 to 47); then two ways, at the second one
    assert pauses(problem, route) == {
        1: (TourPause(27, charger=0), TourPause(3, visit=1)),
        2: (TourPause(24, charger=0),),
    }
    assert evaluate(problem, route).duration == 60 + 10 + 24 + 10
