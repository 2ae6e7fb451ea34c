"""From the parser's trees to the nodes of `syntax.tree`, a file for each kind of phrase."""
