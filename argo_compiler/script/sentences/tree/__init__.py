"""What a script says, as a tree: nouns, places, conditions, manners, orders, sentences."""
