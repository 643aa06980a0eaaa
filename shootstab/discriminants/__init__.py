"""Floor 3: the discriminant D(σ), whose zeros are the modes. Searches see D(σ) and nothing else."""
