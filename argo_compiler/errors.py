"""The one exception type that carries a message meant for the user."""


class ArgoError(Exception):
    """Bad input or an impossible request.

    The message names the thing, the place and the way out; the command prints it and exits with
    status 2. Anything else that is raised is a defect of Argo.
    """
