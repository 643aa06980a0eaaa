"""Floor 6: what people and CI jobs meet: scenes, readers, tables, plots, JSON and the command line."""
