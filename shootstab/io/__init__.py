"""Files: scenes, spectra in everybody's formats, JSON."""
