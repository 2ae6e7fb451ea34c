"""`argo/Inspect-v0` in batches: many inspections at once, spread over all cores."""

import numpy as np
from numpy.typing import NDArray

from argo_env.envs.batch import SpreadVectorEnv
from argo_env.envs.inspection import InspectEnv


class InspectVectorEnv(SpreadVectorEnv):
    """Many inspections at once, as `gymnasium.make_vec("argo/Inspect-v0", num_envs=8)` makes them.
    Arguments and options are those of `InspectEnv`, and `processes`."""

    single = InspectEnv
    _title = "argo/Inspect-v0"

    def action_masks(self) -> NDArray[np.bool_]:
        """Which actions are legal now, shape (num_envs, n + d)."""
        return np.stack(self.call("action_masks"))
