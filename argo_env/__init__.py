"""The site: geometry, navigation, the robot, what it senses, mission runs and their reports.

What common jobs need is here by name, and imported when it is first used:

- a site that is ready for work: `open_site`;
- a run on it: `simulate` a `RunSpec`, which gives a `RunRecord`; or step and steer a `Simulation`;
- many runs, and what they say: `Evaluation`, `Variation`, `read_results`, `compare_plans`;
- what is left of it: `write_report`, `write_overview`, `write_film`, `read_recording`;
- faults from a file: `read_faults`.

With this import Gymnasium knows the environments, `argo/Route-v0` and its siblings, and notebooks
show missions, machines and records.
"""

import logging
from typing import TYPE_CHECKING

from argo_compiler.base.lazy_names import lazy_names
from argo_env.envs.registration import register_with_gymnasium
from argo_env.notebooks import register_with_ipython

__all__ = [
    "Evaluation",
    "EvaluationResults",
    "Navigator",
    "OpenedSite",
    "RunRecord",
    "RunSpec",
    "Simulation",
    "Site",
    "Variation",
    "compare_plans",
    "open_site",
    "read_faults",
    "read_recording",
    "read_results",
    "simulate",
    "site_names",
    "write_film",
    "write_overview",
    "write_report",
]

if TYPE_CHECKING:
    from argo_env.evaluation.comparison import compare_plans
    from argo_env.evaluation.evaluation import Evaluation
    from argo_env.evaluation.folder import read_results
    from argo_env.evaluation.results import EvaluationResults
    from argo_env.evaluation.worlds import Variation
    from argo_env.faults.loading import read_faults
    from argo_env.navigation import Navigator
    from argo_env.pictures import write_film, write_overview
    from argo_env.planning import OpenedSite, open_site
    from argo_env.recording.reader import read_recording
    from argo_env.report import write_report
    from argo_env.run.record import RunRecord
    from argo_env.run.session import simulate
    from argo_env.run.simulation import Simulation
    from argo_env.run.spec import RunSpec
    from argo_env.site import Site, site_names
else:
    __getattr__, __dir__ = lazy_names(
        __name__,
        {
            "evaluation.comparison": ["compare_plans"],
            "evaluation.evaluation": ["Evaluation"],
            "evaluation.folder": ["read_results"],
            "evaluation.results": ["EvaluationResults"],
            "evaluation.worlds": ["Variation"],
            "faults.loading": ["read_faults"],
            "navigation": ["Navigator"],
            "pictures": ["write_film", "write_overview"],
            "planning": ["OpenedSite", "open_site"],
            "recording.reader": ["read_recording"],
            "report": ["write_report"],
            "run.record": ["RunRecord"],
            "run.session": ["simulate"],
            "run.simulation": ["Simulation"],
            "run.spec": ["RunSpec"],
            "site": ["Site", "site_names"],
        },
    )

register_with_gymnasium()
register_with_ipython()

# What a library logs is shown where its user asks for it.
logging.getLogger(__name__).addHandler(logging.NullHandler())
