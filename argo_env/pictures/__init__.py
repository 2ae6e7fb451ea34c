"""Pictures of a run: an image of the whole path, and a film that follows the robot."""

from argo_env.pictures.film import check_film, write_film
from argo_env.pictures.overview import write_overview

__all__ = ["check_film", "write_film", "write_overview"]
