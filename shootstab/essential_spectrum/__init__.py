"""Where D is not analytic: the essential (continuous) spectrum of the inside and of the ends."""
