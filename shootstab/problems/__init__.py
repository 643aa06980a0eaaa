"""Floor 2: what is to be solved. A problem knows its equations and nothing of how they are integrated."""
