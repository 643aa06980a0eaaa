"""The command line: commands, tables, plots."""
