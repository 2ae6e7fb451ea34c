"""What takes long, in processes of its own: the analysis of missions, the search for orders."""
