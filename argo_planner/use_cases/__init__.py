"""The use cases of Argo as functions, for the command line, a service or a notebook.

They take text, bytes or models and return models. They print nothing, need no paths, and raise
ArgoError. Import them from their modules, each of which loads only what it needs.
"""
