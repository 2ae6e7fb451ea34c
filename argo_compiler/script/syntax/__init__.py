"""From text to syntax tree: noise is healed, lines become sentences, sentences are parsed."""
