"""`argo/Drive-v0` in batches: many robots at once, spread over all cores."""

from argo_env.envs.batch import SpreadVectorEnv
from argo_env.envs.drive import DriveEnv


class DriveVectorEnv(SpreadVectorEnv):
    """Many robots at once, as `gymnasium.make_vec("argo/Drive-v0", num_envs=8)` makes them: each on
    a site of its own. Arguments and options are those of `DriveEnv`, and `processes`."""

    single = DriveEnv
    _title = "argo/Drive-v0"
