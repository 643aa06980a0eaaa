"""The physics: granular chutes and a gallery of solved problems. Nothing below this package knows any of it."""
