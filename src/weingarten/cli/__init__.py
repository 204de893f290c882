"""The `weingarten` command: one file per verb, each with `add(subparsers)` and `run(arguments)`."""
