"""Suggestions of an assistant for lines that Argo does not understand: request, answer, claims."""
