"""The instruments of the site over time: what they show changes while a mission runs."""

import math
from collections.abc import Mapping

from argo_env.faults.targets import FaultTargets
from argo_env.run.conditions import ValueProfile
from argo_env.seeding import generator
from argo_env.site import Site, SiteCheckpoint


class Instruments:
    """Lets instruments show what they show at a time. A fault of a value comes before its
    profile."""

    def __init__(
        self, targets: FaultTargets, site: Site, seed: int, profiles: Mapping[int, ValueProfile]
    ) -> None:
        """The profiles are by number of the checkpoint. Raises NotFound for one that the site does
        not have."""
        self._targets = targets
        self._site = site
        self._seed = seed
        self._profiles = {site.checkpoint(id).id: profile for id, profile in profiles.items()}
        self._first = {id: targets.usual[id] for id in self._profiles}

    def look_at(self, checkpoint_id: int, now: float) -> None:
        """Somebody is about to look at the checkpoint, at time `now` (s)."""
        self._targets.sensor.moment = now
        profile = self._profiles.get(checkpoint_id)
        if profile is None:
            return
        checkpoint = self._site.checkpoint(checkpoint_id)
        value = shown_at(checkpoint, self._first[checkpoint_id], profile, self._seed, now)
        as_usual = self._targets.truth[checkpoint_id] == self._targets.usual[checkpoint_id]
        self._targets.usual[checkpoint_id] = value
        if as_usual:
            self._targets.show(checkpoint_id, value)


def shown_at(
    checkpoint: SiteCheckpoint, first: float, profile: ValueProfile, seed: int, now: float
) -> float:
    """What the checkpoint shows at time `now` (s), in its unit, if it showed `first` at 0 s and no
    fault changes it; the `seed` of the run draws what flickers."""
    value = first + profile.drift * now / 3600.0
    value += math.fsum(step.change for step in profile.steps if step.at <= now)
    if profile.noise:
        # Of the moment alone, so that no other look changes it.
        rng = generator(seed, "value", checkpoint.id, round(1000 * now))
        value += profile.noise * float(rng.standard_normal())
    scale = checkpoint.range
    return round(min(max(value, scale.low), scale.high), 3)
