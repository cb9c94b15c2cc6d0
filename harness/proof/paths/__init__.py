"""Every way that gives a verdict, with effects in published forms that are not the catalogue's, as a user runs it."""
