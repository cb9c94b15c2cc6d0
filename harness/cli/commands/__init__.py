"""One command a file; each defines ``command``. A file that is here is a command that is listed."""
