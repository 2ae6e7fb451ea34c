"""The grammar of sentences, its parser and the parser's saved tables."""
