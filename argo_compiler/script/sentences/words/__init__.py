"""From text to words: what each word, number and sign of a sentence is, in any language."""
