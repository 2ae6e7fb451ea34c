"""Policies for Argo's environments, and how they are trained, compared and plotted."""
