"""Floor 4: zeros of D(σ): found by Newton and Muller, counted by the argument principle. Nothing here knows what D is made of."""
