"""Floor 5: what users ask: refine, count, verify."""
