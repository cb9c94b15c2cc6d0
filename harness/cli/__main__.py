"""python -m harness.cli: the command without its script."""

from harness.cli.main import main

main()
