"""Results, regions, numbers and power series: the nouns of every other package."""
