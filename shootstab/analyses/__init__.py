"""What users ask: refine, verify, count, find, critical points, sweeps, work against precision."""
