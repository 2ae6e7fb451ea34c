"""Example of a package that extends Argo, with one extension of each kind."""
