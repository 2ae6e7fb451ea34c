"""From text to syntax tree: noise is healed, statements are parsed."""
