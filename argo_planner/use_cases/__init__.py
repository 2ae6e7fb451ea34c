"""What Argo does for its users, as functions: for the command line, a service or a notebook.

They take text, bytes or models and return models. Nothing is printed, no path is needed, and what
goes wrong is an ArgoError. Import them from their modules: what one needs is loaded with it.
"""
