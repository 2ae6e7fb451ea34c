"""What the whole suite shares. Import it as `from tests.conftest import examples`."""

import os


def examples(suite: int) -> int:
    """How many random examples to try: `suite`, or what ARGO_EXAMPLES says for a campaign."""
    return int(os.environ.get("ARGO_EXAMPLES", suite))
