"""Problems from their equations as they are printed: a grammar, the reduction to first order, and what follows from both."""
