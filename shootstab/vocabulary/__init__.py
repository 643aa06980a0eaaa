"""Floor 0: the nouns that every other floor speaks of, and the numbers they are made of."""
