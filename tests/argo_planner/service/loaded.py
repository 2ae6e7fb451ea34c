"""What processes of services under test are forked with: all that each of them would load late and
work out anew. Without this they do the same, and take longer.
"""

from importlib import import_module

from argo_compiler.script import import_script
from argo_env.pictures import overview
from argo_env.planning import open_site
from argo_env.run.session import simulate
from argo_env.run.spec import RunSpec
from argo_planner.use_cases.reporting import report_files

LOADED_LATE = (
    "argo_env.evaluation.report.page",
    "argo_env.remote.robot",
    "matplotlib.backends.backend_svg",
    "pandas",
    "pyarrow.parquet",
)
SCRIPT = (
    "Mission Protocol #1\n1. Set the starting point in starting area 1.\n2. Check valve R18.\n"
    "3. Check valve R25.\n4. Return to the docking station in starting area 1.\n"
)

# Most of what a report takes is the picture of the site, and these tests do not look at pictures.
overview.SIZE, overview._FINER, overview._SHADOW_MAP = (400, 300), 1, 200

for _module in LOADED_LATE:
    import_module(_module)
_site = open_site("umad").prepare()
_mission = import_script(SCRIPT, _site.catalog).mission
_spec = RunSpec(mission=_mission, site=_site.reference, drive="route")
report_files(simulate(_spec, _site), _site.site, _site.robot)
