"""python -m harness: the command without its script."""

from harness.cli.main import main

if __name__ == "__main__":
    main()
