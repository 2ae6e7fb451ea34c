"""Policies for Argo's environments, with their training, comparison and plots."""
