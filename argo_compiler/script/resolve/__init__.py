"""From syntax tree to mission: names are looked up, commands are carried out."""
